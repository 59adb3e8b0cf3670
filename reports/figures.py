"""The report's figures as inline SVG that follows the page's colours, light or dark."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from .advice import accuracy_and_cost
from .ranking import Ranking
from .run_directory import RunDirectory
from .svg import COLOURS, DASHES, INK, MARKERS, MEASURED, STYLE, Drawing, canvas, extremes, thin

__all__ = ["critical_differences", "errors_over_time", "front", "loops", "model_style", "noise_study"]

Floats = NDArray[np.float64]


def model_style(run: RunDirectory, model: str) -> dict[str, Any]:
    """Colour, marker and dashes of a model, the same in every figure."""
    k = run.models.index(model) % len(COLOURS)
    return {"color": COLOURS[k], "marker": MARKERS[k], "linestyle": DASHES[k]}


def _shown(arrays: dict[str, Any]) -> NDArray[np.intp]:
    """Samples of the loop plots: what is scored, of at most three recordings."""
    return np.flatnonzero(arrays["scored"] & (arrays["recording"] <= 2))


def loops(run: RunDirectory, dataset: str) -> Drawing:
    """Measured loop against each model's, one panel a model."""
    condition = run.reference_condition(dataset)
    info = run.dataset(dataset)
    with mpl.rc_context(STYLE):
        columns = 3
        rows = -(-len(run.models) // columns)
        figure, axes = canvas(9.2, 2.75 * rows, rows, columns, sharex=True, sharey=True)
        for axis, model in zip(axes.flat, run.models, strict=False):
            axis.set_title(run.model_title(model), loc="left")
            arrays = run.arrays(model, dataset, condition)
            if "y_pred" not in arrays:
                _say_missing(axis, run, dataset, condition, model)
                continue
            chosen = _shown(arrays)
            for recording in np.unique(arrays["recording"][chosen]):
                part = thin(chosen[arrays["recording"][chosen] == recording])
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
        return Drawing(
            figure,
            f"loops {dataset}",
            f"Loops of {dataset}: {'measured' if info.get('kind') == 'recorded' else 'true'} (wide grey) against each model (thin, coloured)",
        )


def _say_missing(axis: Axes, run: RunDirectory, dataset: str, condition: str, model: str) -> None:
    rows = run.rows(dataset, condition, "forward", model)
    status = rows["status"].iloc[0] if not rows.empty else "not run"
    axis.text(0.5, 0.5, str(status), transform=axis.transAxes, ha="center", va="center", color=MEASURED)


def errors_over_time(run: RunDirectory, dataset: str) -> Drawing:
    """Prediction error over the test samples, one strip a model, on one scale."""
    condition = run.reference_condition(dataset)
    info = run.dataset(dataset)
    with mpl.rc_context(STYLE):
        figure, axes = canvas(9.2, 0.75 * len(run.models) + 0.7, len(run.models), 1, sharex=True, sharey=True)
        for axis, model in zip(axes.flat, run.models, strict=True):
            axis.set_title(run.model_title(model), loc="left", pad=2)
            arrays = run.arrays(model, dataset, condition)
            if "y_pred" not in arrays:
                _say_missing(axis, run, dataset, condition, model)
                continue
            scored = arrays["scored"]
            error = (arrays["y_pred"] - arrays["y_true"])[scored]
            kept = extremes(error)
            axis.axhline(0.0, color=INK, linewidth=0.5)
            axis.plot(kept, error[kept], color=model_style(run, model)["color"], linewidth=0.7)
        figure.supxlabel("scored test sample", fontsize=9)
        figure.supylabel(f"error, {info.get('y_unit', '')}", fontsize=9)
        return Drawing(
            figure, f"errors {dataset}", f"Prediction error of each model over the scored test samples of {dataset}"
        )


def noise_study(run: RunDirectory, datasets: Sequence[str]) -> Drawing:
    """NRMSE of every model against the condition, one panel a dataset."""
    with mpl.rc_context(STYLE):
        columns = min(3, len(datasets))
        rows = -(-len(datasets) // columns)
        figure, axes = canvas(9.2, 2.7 * rows + 0.5, rows, columns, sharey=True)
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
        return Drawing(
            figure, "noise study", "Torque error of each model under each noise condition, one panel a dataset"
        )


def critical_differences(run: RunDirectory, ranking: Ranking, task: str) -> Drawing:
    """Mean ranks with their bootstrap intervals; bars join models nearer than the critical difference (Demšar 2006)."""
    with mpl.rc_context(STYLE):
        count = len(ranking.models)
        bars = _cliques(ranking)
        figure, axes = canvas(9.2, 0.26 * count + 0.2 * len(bars) + 1.1, 1, 1)
        axis = axes[0, 0]
        for place, model in enumerate(ranking.models):
            style = model_style(run, model)
            mean, low, high = (float(v[place]) for v in (ranking.mean, ranking.low, ranking.high))
            if np.isfinite(low):
                axis.plot([low, high], [place, place], color=style["color"], linewidth=1.4, alpha=0.7)
            axis.plot([mean], [place], color=style["color"], marker=style["marker"], markersize=6)
        for row, (first, last) in enumerate(bars):
            y = count - 0.35 + 0.6 * row
            axis.plot(ranking.mean[[first, last]], [y, y], color=INK, linewidth=3.0, solid_capstyle="butt")
        if np.isfinite(ranking.critical_difference):
            axis.plot([1.0, 1.0 + ranking.critical_difference], [-1.0, -1.0], color=INK, linewidth=1.2, marker="|")
            axis.text(1.0, -1.25, f"critical difference {ranking.critical_difference:.2f}", va="bottom", fontsize=8)
        axis.set_yticks(
            range(count), [f"{p}  {run.model_title(m)}" for p, m in zip(ranking.place, ranking.models, strict=True)]
        )
        axis.set_ylim(count - 0.3 + 0.6 * len(bars), -1.9)
        axis.set_xlim(0.8, max(count, 1.0 + np.nan_to_num(ranking.critical_difference)) + 0.2)
        axis.set_xlabel(f"mean rank over {len(ranking.datasets)} datasets, 1 is best")
        axis.grid(axis="y", visible=False)
        return Drawing(
            figure,
            f"ranking {task}",
            "Mean rank of each model with its 95 % interval: "
            + "; ".join(f"{run.model_title(m)} {v:.2f}" for m, v in zip(ranking.models, ranking.mean, strict=True)),
        )


def _cliques(ranking: Ranking) -> list[tuple[int, int]]:
    """Runs of at least two neighbours in the order that the test does not tell apart, none within another."""
    found: list[tuple[int, int]] = []
    for first in range(len(ranking.models)):
        near = np.flatnonzero(ranking.mean - ranking.mean[first] < ranking.critical_difference)
        last = int(near[-1]) if near.size else first
        if last > first and (not found or last > found[-1][1]):
            found.append((first, last))
    return found


def front(run: RunDirectory) -> Drawing | None:
    """Typical error against the time of prediction; a line joins the models that no other beats in both."""
    table = accuracy_and_cost(run)
    if len(table) < 2:
        return None
    with mpl.rc_context(STYLE):
        figure, axes = canvas(9.2, 4.2, 1, 1)
        axis = axes[0, 0]
        best = table[table["front"]].sort_values("time")
        axis.step(best["time"], best["error"], where="post", color=MEASURED, linewidth=1.2, zorder=1)
        for row in table.itertuples():
            style = model_style(run, str(row.model))
            face = style["color"] if row.front else "none"
            axis.plot([row.time], [row.error], marker=style["marker"], color=style["color"], markerfacecolor=face, linestyle="none",
                      label=run.model_title(str(row.model)) + ("" if row.front else " (beaten in both)"))  # fmt: skip
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.margins(0.12)
        axis.set_xlabel("prediction, ns/sample (median over the cells)")
        axis.set_ylabel("NRMSE (geometric mean over the datasets)")
        figure.legend(loc="outside lower center", ncols=3)
        names = ", ".join(run.model_title(m) for m in best["model"])
        return Drawing(figure, "accuracy and cost", f"Error against time of prediction; on the front: {names}")
