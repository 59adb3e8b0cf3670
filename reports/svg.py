"""Drawing for the pages: inline SVG that follows the page's colours, light or dark, and is the same bytes every time."""

from __future__ import annotations

import hashlib
import io
import re
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..files import replacing

__all__ = ["COLOURS", "DASHES", "INK", "MARKERS", "MEASURED", "STYLE", "Drawing", "canvas", "extremes", "svg", "thin"]

Floats = NDArray[np.float64]
# Okabe and Ito's colours, told apart by the colour-blind and readable on white and on black; never the only mark.
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc6fa5", "#c98a00", "#3aa0dc", "#8b6bd6", "#7a7a00")
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*")
DASHES: tuple[Any, ...] = (
    "-",
    (0, (5, 1.5)),
    (0, (1.5, 1)),
    (0, (6, 1.5, 1.5, 1.5)),
    (0, (3, 1)),
    (0, (8, 2)),
    "-",
    "--",
)
# A colour that nothing else uses stands for the page's own text colour until the SVG is written.
INK = "#010203"
MEASURED = "#8a8a8a"
POINTS = 420
STYLE: Any = {
    "svg.fonttype": "none",
    "font.size": 9.0,
    "axes.titlesize": 9.5,
    "axes.labelsize": 9.0,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "legend.fontsize": 8.0,
    "text.color": INK,
    "axes.labelcolor": INK,
    "axes.edgecolor": INK,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "xtick.color": INK,
    "ytick.color": INK,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "axes.grid": True,
    "grid.color": MEASURED,
    "grid.alpha": 0.25,
    "grid.linewidth": 0.5,
    "legend.frameon": False,
    "path.simplify": True,
    "path.simplify_threshold": 0.3,
}


def svg(figure: Figure, name: str, description: str) -> str:
    """The figure as an inline SVG element, the same bytes for the same figure."""
    stream = io.StringIO()
    with mpl.rc_context({**STYLE, "svg.hashsalt": name}):
        FigureCanvasSVG(figure).print_svg(
            stream, metadata={"Date": None, "Creator": None, "Format": None, "Type": None}
        )
    text = stream.getvalue()
    text = text[text.index("<svg") :]
    # Several figures share one page: their element names must not meet.
    prefix = "f" + hashlib.sha256(name.encode()).hexdigest()[:8]
    text = re.sub(r'\bid="', f'id="{prefix}-', text)
    text = re.sub(r'(xlink:href="#|url\(#)', rf"\1{prefix}-", text)
    text = text.replace(INK, "currentColor")
    text = re.sub(r"font: ([\d.]+)px [^;\"]*", r"font-size: \1px", text)
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.DOTALL)
    text = re.sub(r"\n\s*", "\n", text)
    # Coordinates need no more digits; what is written beside the axes keeps its own.
    text = re.sub(r"<[^>]*>", lambda tag: re.sub(r"(\d+\.\d{2})\d+", r"\1", tag[0]), text)
    label = _escape(description)
    return re.sub(
        r'<svg ([^>]*?)width="([\d.]+)pt" height="([\d.]+)pt"',
        lambda m: (
            f'<svg {m[1]}role="img" aria-label="{label}" class="figure" style="max-width:{float(m[2]) * 1.34:.0f}px"'
        ),
        text,
        count=1,
    )


@dataclass(frozen=True)
class Drawing:
    """A finished figure, its name (unique on a page) and what it shows, for those who cannot see it."""

    figure: Figure
    name: str
    description: str

    def svg(self) -> str:
        """As an inline SVG element."""
        return svg(self.figure, self.name, self.description)

    def save(self, path: str | Path) -> None:
        """As a file of its own, in the format of its suffix, with the text in black and the same bytes every time."""
        path = Path(path)
        metadata = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}.get(path.suffix, {"Software": None})
        white: dict[str, Any] = {"facecolor": "white"} if path.suffix == ".png" else {}
        with mpl.rc_context({**STYLE, "svg.hashsalt": self.name, "pdf.fonttype": 42}), replacing(path) as temporary:
            self.figure.savefig(temporary, dpi=200, metadata=metadata, **white)


def _escape(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;").replace('"', "&quot;")


def canvas(width: float, height: float, rows: int, columns: int, **kwargs: Any) -> tuple[Figure, NDArray[Any]]:
    figure = Figure(figsize=(width, height), layout="constrained")
    figure.patch.set_alpha(0.0)
    axes = figure.subplots(rows, columns, squeeze=False, **kwargs)
    for axis in axes.flat:
        axis.patch.set_alpha(0.0)
    return figure, axes


def thin(indices: NDArray[np.intp], limit: int = POINTS) -> NDArray[np.intp]:
    """At most ``limit`` of the indices, evenly spread, the last one kept."""
    if indices.size <= limit:
        return indices
    return indices[np.unique(np.linspace(0, indices.size - 1, limit).round().astype(int))]


def extremes(series: Floats, buckets: int = POINTS // 2) -> NDArray[np.intp]:
    """Indices of the lowest and highest sample of each bucket, so that peaks survive the thinning."""
    if series.size <= 2 * buckets:
        return np.arange(series.size)
    edges = np.linspace(0, series.size, buckets + 1).astype(int)
    kept: set[int] = {0, series.size - 1}
    for start, stop in pairwise(edges):
        kept.add(start + int(np.argmin(series[start:stop])))
        kept.add(start + int(np.argmax(series[start:stop])))
    return np.array(sorted(kept))
