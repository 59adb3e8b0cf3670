"""Many runs in the order of their time: what each model's error and time did, and where they changed."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pandas as pd
from markupsafe import Markup
from numpy.typing import ArrayLike, NDArray

from .. import __version__
from ..errors import InputError
from ..files import replacing, write_text
from .run_directory import RunDirectory, read_run
from .svg import COLOURS, DASHES, INK, MARKERS, MEASURED, STYLE, Drawing, canvas
from .tables import number
from .templating import template

__all__ = ["MEASURES", "Change", "change_points", "changes", "history_table", "write_history"]

Floats = NDArray[np.float64]
CELL = ["dataset", "condition", "task", "seed"]
PENALTY = 12.0
"""A step must explain this many times the noise's variance times log n; 1 in 100 series of pure noise then has one."""


@dataclass(frozen=True)
class Measure:
    """What is followed: its column, title, unit, and the smallest change that is worth a mark."""

    column: str
    title: str
    unit: str
    least: float


MEASURES = (
    Measure("nrmse", "Error", "NRMSE, geometric mean over the cells that all runs have", 0.01),
    Measure("predict_ns_per_sample", "Prediction", "ns/sample, median over the same cells", 0.10),
    Measure("fit_s", "Identification", "s, median over the same cells", 0.10),
)


@dataclass(frozen=True)
class Change:
    """A step of one model's measure at run number ``at``: ``ratio`` of the level from there on to that before."""

    model: str
    measure: Measure
    at: int
    ratio: float
    same_session: bool


def change_points(values: ArrayLike, least: float) -> list[int]:
    """Places where the level of a positive series changes: the first index of each new level.

    Binary segmentation on the logarithms: a stretch is cut where that explains most of its squares, if this is more than
    noise explains by chance and the levels differ by more than ``least`` (0.1 for 10 %). The noise is taken from the
    differences of neighbours, which a few steps leave alone. NaN values are skipped.
    """
    series = np.asarray(values, dtype=np.float64)
    kept = np.flatnonzero(np.isfinite(series) & (series > 0))
    logs = np.log(series[kept])
    if logs.size < 2:
        return []
    noise = 1.4826 * float(np.median(np.abs(np.diff(logs)))) / math.sqrt(2.0)
    threshold = PENALTY * max(noise, 0.1 * math.log1p(least)) ** 2 * math.log(max(logs.size, 3))
    found: list[int] = []
    waiting = [(0, logs.size)]
    while waiting:
        start, stop = waiting.pop()
        n = stop - start
        if n < 2:
            continue
        part = logs[start:stop]
        left = np.arange(1, n)
        sums = np.cumsum(part)[:-1]
        steps = (part.sum() - sums) / (n - left) - sums / left
        gains = left * (n - left) / n * steps**2
        best = int(np.argmax(gains))
        if gains[best] > threshold and abs(steps[best]) > math.log1p(least):
            cut = start + best + 1
            found.append(cut)
            waiting += [(start, cut), (cut, stop)]
    return [int(kept[cut]) for cut in sorted(found)]


def history_table(runs: Sequence[RunDirectory]) -> pd.DataFrame:
    """One row per run (in the order given) and model: the measures over the cells that every run with the model has.

    Datasets whose samples differ between the runs are left out.
    """
    changed = _changed_datasets(runs)
    frames = []
    for place, run in enumerate(runs):
        table = run.table[(run.table["status"] == "ok") & ~run.table["dataset"].isin(changed)]
        frames.append(table.assign(run=place))
    everything = pd.concat(frames, ignore_index=True)
    rows = []
    for model, held_by in everything.groupby("model"):
        present = held_by["run"].nunique()
        held = held_by.groupby(CELL)["run"].transform("nunique") == present
        for position, cells in held_by[held].groupby("run"):
            errors = cells["nrmse"].dropna().clip(lower=1e-9)
            row: dict[str, Any] = {"run": int(str(position)), "model": str(model), "cells": len(cells)}
            row["nrmse"] = float(np.exp(np.log(errors).mean())) if len(errors) else math.nan
            for measure in MEASURES[1:]:
                row[measure.column] = float(cells[measure.column].median())
            rows.append(row)
    columns = ["run", "model", "cells", *(m.column for m in MEASURES)]
    table = pd.DataFrame(rows, columns=columns).sort_values(["run", "model"], ignore_index=True)
    labels = _labels(runs)
    table.insert(1, "label", [labels[k] for k in table["run"]])
    table.insert(2, "started", [str(runs[k].document.get("started", "")) for k in table["run"]])
    return table


def _changed_datasets(runs: Sequence[RunDirectory]) -> set[str]:
    hashes: dict[str, set[str]] = {}
    for run in runs:
        for name, entry in run.document.get("data", {}).items():
            hashes.setdefault(name, set()).add(str(entry.get("sha256")))
    return {name for name, found in hashes.items() if len(found) > 1}


def _labels(runs: Sequence[RunDirectory]) -> list[str]:
    """Commits or versions; with the time of the run where several share one."""
    labels = [_label(run) for run in runs]
    return [
        f"{label}, {str(run.document.get('started', ''))[5:16].replace('T', ' ')}" if labels.count(label) > 1 else label
        for label, run in zip(labels, runs, strict=True)
    ]


def _label(run: RunDirectory) -> str:
    commit = str(run.document.get("commit") or "")[:8]
    return commit or str(run.document.get("versions", {}).get("hystbench") or run.path.name)


def changes(table: pd.DataFrame, sessions: Sequence[Any]) -> list[Change]:
    """All changes in a history table; ``sessions`` are those of the runs, see ``run.json``."""
    found = []
    for model, rows in table.groupby("model"):
        places = rows["run"].to_numpy()
        for measure in MEASURES:
            values = rows[measure.column].to_numpy(dtype=float)
            cuts = change_points(values, measure.least)
            for before, cut, after in zip([0, *cuts][:-1], cuts, [*cuts, len(values)][1:], strict=True):
                ratio = float(np.exp(np.nanmean(np.log(values[cut:after])) - np.nanmean(np.log(values[before:cut]))))
                same = sessions[places[cut]] == sessions[places[cut - 1]] and bool(sessions[places[cut]])
                found.append(Change(str(model), measure, int(places[cut]), ratio, same))
    return sorted(found, key=lambda c: (MEASURES.index(c.measure), c.at, c.model))


def _drawing(table: pd.DataFrame, measure: Measure, found: Sequence[Change], labels: Sequence[str]) -> Drawing:
    models = sorted(table["model"].unique())
    with mpl.rc_context(STYLE):
        figure, axes = canvas(9.2, 4.0 + 0.12 * len(models), 1, 1)
        axis = axes[0, 0]
        for k, model in enumerate(models):
            rows = table[table["model"] == model]
            style = {
                "color": COLOURS[k % len(COLOURS)],
                "marker": MARKERS[k % len(MARKERS)],
                "linestyle": DASHES[k % len(DASHES)],
            }
            axis.plot(rows["run"], rows[measure.column], markersize=4, linewidth=1.0, label=model, **style)
            level = rows.set_index("run")[measure.column]
            for change in (c for c in found if c.model == model and c.measure is measure):
                axis.axvline(change.at - 0.5, color=MEASURED, linewidth=0.8, linestyle=(0, (2, 2)), zorder=0)
                axis.plot(
                    [change.at],
                    [level[change.at]],
                    marker="o",
                    markersize=11,
                    markerfacecolor="none",
                    color=INK,
                    linestyle="none",
                )
                axis.annotate(
                    f"×{change.ratio:.2f}",
                    (change.at, level[change.at]),
                    xytext=(6, 7),
                    textcoords="offset points",
                    fontsize=8,
                )
        axis.set_yscale("log")
        step = max(1, len(labels) // 12)
        axis.set_xticks(range(0, len(labels), step), labels[::step], rotation=40, ha="right")
        axis.set_xlim(-0.5, len(labels) - 0.5)
        axis.set_ylabel(measure.unit, wrap=True)
        figure.legend(loc="outside lower center", ncols=4)
        count = sum(c.measure is measure for c in found)
        return Drawing(
            figure, f"history {measure.column}", f"{measure.title} of each model over {len(labels)} runs; changes marked: {count}"
        )  # fmt: skip


def write_history(folders: Sequence[Path], out: Path) -> Path:
    """Write ``out/history.html`` and ``out/history.csv`` from run folders, oldest first, and return the page's path.

    Raises
    ------
    InputError
        If there are fewer than two runs, or a folder holds no results.
    """
    if len(folders) < 2:
        raise InputError("a history needs at least two run folders")
    runs = sorted((read_run(folder) for folder in folders), key=lambda run: str(run.document.get("started", "")))
    table = history_table(runs)
    if table.empty:
        raise InputError("no model has a cell that all of these runs finished: there is nothing to follow")
    labels = _labels(runs)
    sessions = [run.document.get("sessions") for run in runs]
    found = changes(table, sessions)
    drawings = [(m, _drawing(table, m, found, labels)) for m in MEASURES]
    page = template("history.html.j2").render(
        version=__version__,
        runs=[(label, run) for label, run in zip(labels, runs, strict=True)],
        changes=[
            {"model": c.model, "measure": c.measure.title, "label": labels[c.at], "before": labels[c.at - 1],
             "ratio": number(c.ratio), "doubt": c.measure.column != "nrmse" and not c.same_session}
            for c in found
        ],
        changed=sorted(_changed_datasets(runs)),
        figures=[
            {"title": m.title, "svg": Markup(d.svg()), "file": f"history-{m.column}", "description": d.description}
            for m, d in drawings
        ],
    )  # fmt: skip
    with replacing(out / "history.csv") as temporary:
        table.to_csv(temporary, index=False, lineterminator="\n")
    document = [
        {"model": c.model, "measure": c.measure.column, "at": labels[c.at], "run": c.at, "ratio": c.ratio}
        for c in found
    ]
    write_text(
        out / "changes.json", json.dumps({"schema": "hystbench/history/1", "changes": document}, indent=1) + "\n"
    )
    write_text(out / "history.html", page)
    return out / "history.html"
