"""The page of ``hystbench data check``: what is in a recording, with pictures, in one file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from markupsafe import Markup

from .. import __version__
from ..datasets import Recording
from ..datasets.findings import Applicability, Finding
from ..datasets.inspection import Inspection, Loop, classes
from ..files import write_text
from ..models.motion import turning_points
from .svg import COLOURS, DASHES, INK, MARKERS, MEASURED, STYLE, canvas, extremes, svg, thin
from .templating import template

__all__ = ["write_check_page"]

DRAWN_POINTS = 4000
DRAWN_LOOPS = 6


def write_check_page(
    folder: str | Path,
    recording: Recording,
    inspection: Inspection,
    findings: Sequence[Finding],
    models: Sequence[Applicability],
    columns: tuple[str, str],
) -> Path:
    """Write ``folder/check.html``, which loads nothing from anywhere, and return its path.

    Parameters
    ----------
    columns : tuple of str
        Names of the input and the output column, for the axes.
    """
    x_column, y_column = columns
    figures = [
        (
            "Loops",
            loops_figure(recording, inspection, x_column, y_column),
            "Output against input: the whole recording (grey), and the largest loops, or what comes nearest to one.",
        ),
        (
            "Over time",
            time_figure(recording, inspection, x_column, y_column),
            "Dots mark where the input turns, bands where samples are missing.",
        ),
        (
            "What is covered",
            coverage_figure(inspection, x_column),
            "Every half cycle. Models say little of amplitudes and speeds away from the marks.",
        ),
    ]
    changes = changes_figure(inspection, y_column)
    if changes:
        figures.append(
            ("From loop to loop", changes, "Loops between the same inputs; a level line means nothing changes.")
        )
    page = template("check.html.j2").render(
        version=__version__,
        name=recording.name,
        columns=columns,
        findings=findings,
        models=models,
        figures=[(title, Markup(drawn), caption) for title, drawn, caption in figures],
    )
    target = Path(folder) / "check.html"
    write_text(target, page)
    return target


def loops_figure(recording: Recording, inspection: Inspection, x_column: str, y_column: str) -> str:
    """Output against input."""
    with mpl.rc_context(STYLE):
        figure, axes = canvas(6.4, 4.4, 1, 1)
        axis = axes[0, 0]
        part = thin(np.arange(recording.x.size), DRAWN_POINTS)
        axis.plot(recording.x[part], recording.y[part], color=MEASURED, linewidth=0.7, alpha=0.6, label="recording")
        for k, loop in enumerate(inspection.main_loops[:DRAWN_LOOPS]):
            drawn = loop.start + thin(np.arange(loop.end - loop.start + 1))
            axis.plot(
                recording.x[drawn],
                recording.y[drawn],
                color=COLOURS[k % len(COLOURS)],
                linestyle=DASHES[k % len(DASHES)],
                linewidth=1.2,
                label=f"from {recording.time[loop.start]:.4g} s",
            )
        axis.set_xlabel(x_column)
        axis.set_ylabel(y_column)
        figure.legend(loc="outside right upper")
        return svg(figure, "check loops", f"{y_column} against {x_column}, the largest loops marked")


def time_figure(recording: Recording, inspection: Inspection, x_column: str, y_column: str) -> str:
    """Both channels over time."""
    with mpl.rc_context(STYLE):
        figure, axes = canvas(9.2, 4.2, 2, 1, sharex=True)
        turns = turning_points(recording.x, inspection.coverage.dead_band)[1:-1]
        for axis, series, label in zip(axes.flat, (recording.x, recording.y), (x_column, y_column), strict=True):
            kept = extremes(series, 600)
            axis.plot(recording.time[kept], series[kept], color=COLOURS[0], linewidth=0.8)
            axis.set_ylabel(label)
            for gap in inspection.sampling.gaps[:50]:
                axis.axvspan(
                    recording.time[0] + gap.at, recording.time[0] + gap.at + gap.length, color=COLOURS[1], alpha=0.35
                )
        shown = thin(turns)
        axes[0, 0].plot(recording.time[shown], recording.x[shown], "o", color=INK, markersize=2.5)
        axes[1, 0].set_xlabel("time, s")
        return svg(figure, "check time", f"{x_column} and {y_column} over time")


def coverage_figure(inspection: Inspection, x_column: str) -> str:
    """Size and speed of the half cycles."""
    with mpl.rc_context(STYLE):
        figure, axes = canvas(6.4, 3.2, 1, 1)
        axis = axes[0, 0]
        shown = thin(np.arange(inspection.coverage.swings.size))
        axis.plot(
            inspection.coverage.swings[shown],
            inspection.coverage.speeds[shown],
            linestyle="",
            marker=MARKERS[0],
            markersize=4,
            alpha=0.6,
            color=COLOURS[0],
        )
        axis.set_xlim(left=0.0)
        axis.set_ylim(bottom=0.0)
        axis.set_xlabel(f"size of the half cycle ({x_column})")
        axis.set_ylabel("mean speed, a second")
        return svg(figure, "check coverage", "Mean speed against size of every half cycle")


def changes_figure(inspection: Inspection, y_column: str) -> str:
    """Level, height and half width of the loops of each class over their order; empty where nothing repeats."""
    repeated = [group for group in classes([loop for loop in inspection.loops if loop.simple]) if len(group) > 1]
    if not repeated:
        return ""
    with mpl.rc_context(STYLE):
        figure, axes = canvas(9.2, 2.8, 1, 3)
        for axis, attribute in zip(axes.flat, ("level", "height", "half_width"), strict=True):
            for k, group in enumerate(repeated[:DRAWN_LOOPS]):
                axis.plot(
                    range(1, len(group) + 1),
                    [getattr(loop, attribute) for loop in group],
                    color=COLOURS[k % len(COLOURS)],
                    linestyle=DASHES[k % len(DASHES)],
                    marker=MARKERS[k % len(MARKERS)],
                    markersize=3.5,
                    linewidth=0.9,
                    label=_class_name(group),
                )
            axis.set_title(attribute.replace("_", " "), loc="left")
            axis.margins(y=0.25)
            axis.locator_params(axis="x", integer=True)
        axes[0, 0].set_ylabel(y_column)
        axes[0, 1].set_xlabel("loop")
        handles, labels = axes[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=3)
        return svg(figure, "check changes", "Level, height and half width of repeated loops in their order")


def _class_name(group: Sequence[Loop]) -> str:
    return f"{group[0].low:.3g} to {group[0].high:.3g}"
