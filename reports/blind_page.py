"""The page of ``hystbench blind``: one self-contained file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
from markupsafe import Markup

from .. import __version__
from ..diagnosis.blind.scoring import CARRIED
from ..diagnosis.names import spoken
from ..files import write_text
from .svg import COLOURS, MEASURED, STYLE, canvas, svg
from .templating import template

__all__ = ["write_blind"]

OTHER = ("no gap", "unknown", "several")


def write_blind(scores: Mapping[str, Any], rows: Sequence[Mapping[str, Any]], out: Path) -> Path:
    """Write ``out/blind.html`` and return its path.

    Parameters
    ----------
    scores : mapping
        What :func:`hystbench.diagnosis.blind.scoring.score` gives, and ``run``.
    rows : sequence of mapping
        The lines of ``cases.csv``.
    """
    columns, matrix = _matrix(scores["confusion"])
    page = template("blind.html.j2").render(
        version=__version__,
        **{key: scores[key] for key in ("run", "all", "calibration", "seconds", "cost", "plants", "effects")},
        table=[{**row, "shown": _figure(row["value"]), "interval": _interval(row)} for row in scores["table"]],
        groups=list(scores["groups"].items()),
        columns=columns,
        spoken=spoken,
        matrix=matrix,
        reliability=_reliability(scores["calibration"]["bins"]),
        carried=_carried(rows),
        wrong=[row for row in rows if not row["right"]],
    )
    target = out / "blind.html"
    write_text(target, page)
    return target


def _figure(value: float | None) -> str:
    return "" if value is None else f"{value:.3g}"


def _interval(row: Mapping[str, Any]) -> str:
    return "" if row["low"] is None else f"{row['low']:.3g} to {row['high']:.3g}"


def _matrix(confusion: Mapping[str, Mapping[str, int]]) -> tuple[list[str], list[tuple[str, list[int], str]]]:
    """Columns, and for each true effect its counts by column and which verdicts of several effects were given."""
    alone = {verdict for row in confusion.values() for verdict in row if " + " not in verdict}
    columns = [*sorted({*confusion, *alone} - set(OTHER)), *OTHER]
    lines = []
    for truth, row in confusion.items():
        several = {verdict: count for verdict, count in row.items() if " + " in verdict}
        counts = [row.get(name, 0) for name in columns[:-1]] + [sum(several.values())]
        told = "; ".join(f"{verdict.replace('_', ' ')} ({count})" for verdict, count in sorted(several.items()))
        lines.append((truth, counts, told))
    return columns, lines


def _reliability(bins: Sequence[Mapping[str, float]]) -> Markup:
    with mpl.rc_context(STYLE):
        figure, axes = canvas(4.6, 3.6, 1, 1)
        axis = axes[0, 0]
        axis.plot([0, 1], [0, 1], color=MEASURED, linewidth=0.8)
        for b in bins:
            axis.plot([b["stated"]] * 2, [b["low"], b["high"]], color=COLOURS[0], linewidth=0.8)
        axis.plot([b["stated"] for b in bins], [b["right"] for b in bins], color=COLOURS[0], marker="o", linestyle="")
        axis.set_xlabel("stated confidence")
        axis.set_ylabel("frequency right")
        axis.set_xlim(0, 1.02)
        axis.set_ylim(0, 1.02)
        return Markup(svg(figure, "reliability", "Frequency right against stated confidence"))


def _carried(rows: Sequence[Mapping[str, Any]]) -> Markup:
    """Closed share on another motion, found against predicted; empty if nothing was carried over."""
    points = [row for row in rows if row["closed_found"] is not None]
    if not points:
        return Markup("")
    with mpl.rc_context(STYLE):
        figure, axes = canvas(4.6, 3.6, 1, 1)
        axis = axes[0, 0]
        axis.fill_between([0, 1], [-0.1, 0.9], [0.1, 1.1], color=MEASURED, alpha=0.15, linewidth=0)
        axis.plot([0, 1], [0, 1], color=MEASURED, linewidth=0.8)
        for counted, fill in ((True, COLOURS[0]), (False, "none")):
            shown = [row for row in points if (row["group"] in CARRIED) == counted]
            # What closes less than nothing is drawn at the lower edge.
            axis.plot([row["closed_predicted"] for row in shown], [max(row["closed_found"], -0.2) for row in shown],
                      color=COLOURS[0], markerfacecolor=fill, marker="o", markersize=3, alpha=0.7, linestyle="")  # fmt: skip
        axis.set_xlabel("predicted")
        axis.set_ylabel("found")
        axis.set_xlim(0, 1.02)
        axis.set_ylim(-0.22, 1.12)
        return Markup(svg(figure, "carried over", "Closed share on another motion, found against predicted"))
