"""The report's figures as inline SVG that follows the page's colours, light or dark."""

from __future__ import annotations

import hashlib
import io
import re
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from numpy.typing import NDArray

from .run_directory import RunDirectory

__all__ = ["errors_over_time", "loops", "model_style", "noise_study"]

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


def model_style(run: RunDirectory, model: str) -> dict[str, Any]:
    """Colour, marker and dashes of a model, the same in every figure."""
    k = run.models.index(model) % len(COLOURS)
    return {"color": COLOURS[k], "marker": MARKERS[k], "linestyle": DASHES[k]}


def _svg(figure: Figure, name: str, description: str) -> str:
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
    text = re.sub(r"(\d+\.\d{2})\d+", r"\1", text)
    label = _escape(description)
    return re.sub(
        r'<svg ([^>]*?)width="([\d.]+)pt" height="([\d.]+)pt"',
        lambda m: (
            f'<svg {m[1]}role="img" aria-label="{label}" class="figure" style="max-width:{float(m[2]) * 1.34:.0f}px"'
        ),
        text,
        count=1,
    )


def _escape(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;").replace('"', "&quot;")


def _figure(width: float, height: float, rows: int, columns: int, **kwargs: Any) -> tuple[Figure, NDArray[Any]]:
    figure = Figure(figsize=(width, height), layout="constrained")
    figure.patch.set_alpha(0.0)
    axes = figure.subplots(rows, columns, squeeze=False, **kwargs)
    for axis in axes.flat:
        axis.patch.set_alpha(0.0)
    return figure, axes


def _thin(indices: NDArray[np.intp], limit: int = POINTS) -> NDArray[np.intp]:
    """At most ``limit`` of the indices, evenly spread, the last one kept."""
    if indices.size <= limit:
        return indices
    return indices[np.unique(np.linspace(0, indices.size - 1, limit).round().astype(int))]


def _extremes(series: Floats, buckets: int = POINTS // 2) -> NDArray[np.intp]:
    """Indices of the lowest and highest sample of each bucket, so that peaks survive the thinning."""
    if series.size <= 2 * buckets:
        return np.arange(series.size)
    edges = np.linspace(0, series.size, buckets + 1).astype(int)
    kept: set[int] = {0, series.size - 1}
    for start, stop in pairwise(edges):
        kept.add(start + int(np.argmin(series[start:stop])))
        kept.add(start + int(np.argmax(series[start:stop])))
    return np.array(sorted(kept))


def _shown(arrays: dict[str, Any]) -> NDArray[np.intp]:
    """Samples of the loop plots: what is scored, of at most three recordings."""
    return np.flatnonzero(arrays["scored"] & (arrays["recording"] <= 2))


def loops(run: RunDirectory, dataset: str) -> str:
    """Measured loop against each model's, one panel a model."""
    condition = run.reference_condition(dataset)
    info = run.dataset(dataset)
    with mpl.rc_context(STYLE):
        columns = 3
        rows = -(-len(run.models) // columns)
        figure, axes = _figure(9.2, 2.75 * rows, rows, columns, sharex=True, sharey=True)
        for axis, model in zip(axes.flat, run.models, strict=False):
            axis.set_title(run.model_title(model), loc="left")
            arrays = run.arrays(model, dataset, condition)
            if "y_pred" not in arrays:
                _say_missing(axis, run, dataset, condition, model)
                continue
            chosen = _shown(arrays)
            for recording in np.unique(arrays["recording"][chosen]):
                part = _thin(chosen[arrays["recording"][chosen] == recording])
                axis.plot(arrays["x_true"][part], arrays["y_true"][part], color=MEASURED, linewidth=2.2, alpha=0.55)
                axis.plot(
                    arrays["x_true"][part],
                    arrays["y_pred"][part],
                    color=model_style(run, model)["color"],
                    linewidth=0.9,
                )
        for axis in axes.flat[len(run.models) :]:
            axis.set_visible(False)
        figure.supxlabel(f"{info.get('x_name', 'input')}, {info.get('x_unit', '')}", fontsize=9)
        figure.supylabel(f"{info.get('y_name', 'output')}, {info.get('y_unit', '')}", fontsize=9)
        return _svg(
            figure,
            f"loops {dataset}",
            f"Loops of {dataset}: {'measured' if info.get('kind') == 'recorded' else 'true'} (wide grey) against each model (thin, coloured)",
        )


def _say_missing(axis: Axes, run: RunDirectory, dataset: str, condition: str, model: str) -> None:
    rows = run.rows(dataset, condition, "forward", model)
    status = rows["status"].iloc[0] if not rows.empty else "not run"
    axis.text(0.5, 0.5, str(status), transform=axis.transAxes, ha="center", va="center", color=MEASURED)


def errors_over_time(run: RunDirectory, dataset: str) -> str:
    """Prediction error over the test samples, one strip a model, on one scale."""
    condition = run.reference_condition(dataset)
    info = run.dataset(dataset)
    with mpl.rc_context(STYLE):
        figure, axes = _figure(9.2, 0.75 * len(run.models) + 0.7, len(run.models), 1, sharex=True, sharey=True)
        for axis, model in zip(axes.flat, run.models, strict=True):
            axis.set_title(run.model_title(model), loc="left", pad=2)
            arrays = run.arrays(model, dataset, condition)
            if "y_pred" not in arrays:
                _say_missing(axis, run, dataset, condition, model)
                continue
            scored = arrays["scored"]
            error = (arrays["y_pred"] - arrays["y_true"])[scored]
            kept = _extremes(error)
            axis.axhline(0.0, color=INK, linewidth=0.5)
            axis.plot(kept, error[kept], color=model_style(run, model)["color"], linewidth=0.7)
        figure.supxlabel("scored test sample", fontsize=9)
        figure.supylabel(f"error, {info.get('y_unit', '')}", fontsize=9)
        return _svg(
            figure, f"errors {dataset}", f"Prediction error of each model over the scored test samples of {dataset}"
        )


def noise_study(run: RunDirectory, datasets: Sequence[str]) -> str:
    """NRMSE of every model against the condition, one panel a dataset."""
    with mpl.rc_context(STYLE):
        columns = min(3, len(datasets))
        rows = -(-len(datasets) // columns)
        figure, axes = _figure(9.2, 2.7 * rows + 0.5, rows, columns, sharey=True)
        for axis, dataset in zip(axes.flat, datasets, strict=False):
            conditions = run.conditions(dataset)
            for model in run.models:
                places, values = [], []
                for place, condition in enumerate(conditions):
                    found = run.rows(dataset, condition, "forward", model)
                    found = found[found["status"] == "ok"]
                    if not found.empty:
                        places.append(place)
                        values.append(max(float(found["nrmse"].median()), 1e-7))
                axis.plot(
                    places, values, markersize=4, linewidth=1.0, label=run.model_title(model), **model_style(run, model)
                )
            axis.set_title(dataset, loc="left")
            axis.set_yscale("log")
            axis.set_xticks(range(len(conditions)), conditions)
            axis.margins(x=0.15)
        for axis in axes.flat[len(datasets) :]:
            axis.set_visible(False)
        axes.flat[0].set_ylabel("NRMSE of the torque")
        handles, labels = axes.flat[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=3)
        return _svg(figure, "noise study", "Torque error of each model under each noise condition, one panel a dataset")
