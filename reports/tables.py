"""The report's tables as plain data: the template only draws them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pandas as pd

from ..bench.references import scores_by_recording
from ..datasets.published_loop import TABLE_4, TABLE_5
from ..diagnosis.names import spoken
from .run_directory import RunDirectory

__all__ = [
    "Cell",
    "Table",
    "best_models",
    "compensation_table",
    "condition_table",
    "dataset_table",
    "diagnosis_table",
    "headline_table",
    "number",
    "order_statement",
    "paper_table",
    "recording_table",
    "reversal_table",
    "timing_table",
    "words",
]

TASK_TITLES = {"forward": "Torque error", "inverse": "Inverse error", "compensation": "Compensation error"}


@dataclass(frozen=True)
class Cell:
    """One cell: its text, the value that it sorts by, and how it is marked."""

    text: str
    sort: float | str = math.inf
    best: bool = False
    muted: bool = False
    note: str = ""


@dataclass(frozen=True)
class Table:
    """A table with a caption; the first column names the rows."""

    caption: str
    columns: Sequence[str]
    rows: Sequence[Sequence[Cell]]
    groups: Sequence[tuple[str, int]] = field(default_factory=tuple)


def number(value: float, digits: int = 3) -> str:
    """A figure for people: ``digits`` significant ones, no exponent where it can be avoided."""
    if value is None or not math.isfinite(value):
        return "–"
    if value == 0:
        return "0"
    magnitude = math.floor(math.log10(abs(value)))
    if -4 <= magnitude < 6:
        return f"{value:.{max(digits - 1 - magnitude, 0)}f}"
    return f"{value:.{digits - 1}e}"


def _spread(rows: pd.DataFrame, column: str) -> tuple[float, str]:
    """Median over the seeds, and its text with the range where seeds differ."""
    values = rows[column].to_numpy(dtype=float)
    median = float(np.median(values))
    text = number(median)
    if values.size > 1 and np.ptp(values) > 0.005 * abs(median):
        text += f" ({number(values.min(), 2)}–{number(values.max(), 2)})"
    return median, text


def _status_cell(rows: pd.DataFrame) -> Cell:
    """What stands where there is no figure."""
    if rows.empty:
        return Cell("not run", muted=True)
    bad = rows[rows["status"] != "ok"].iloc[0]
    return Cell(str(bad["status"]), muted=True, note=str(bad["message"]))


def _metric(rows: pd.DataFrame, column: str) -> Cell:
    if rows.empty or (rows["status"] != "ok").any():
        return _status_cell(rows)
    median, text = _spread(rows, column)
    return Cell(text, sort=median)


def _mark_best(rows: list[list[Cell]], columns: Iterable[int]) -> list[list[Cell]]:
    """Mark the smallest figure of each given column (ties all)."""
    for column in columns:
        values = [value for row in rows if isinstance(value := row[column].sort, float)]
        least = min((v for v in values if math.isfinite(v)), default=None)
        if least is None:
            continue
        for row in rows:
            cell = row[column]
            if isinstance(cell.sort, float) and cell.sort <= least * (1 + 1e-9):
                row[column] = Cell(cell.text, cell.sort, True, cell.muted, cell.note)
    return rows


def _model_rows(run: RunDirectory, cells: Callable[[str], list[Cell]]) -> list[list[Cell]]:
    return [[Cell(run.model_title(m), sort=run.model_title(m)), *cells(m)] for m in run.models]


def headline_table(run: RunDirectory, task: str) -> Table:
    """NRMSE of every model on every dataset, under each dataset's reference condition."""
    wanted = [d for d in run.datasets if task != "compensation" or run.dataset(d).get("kind") != "recorded"]
    conditions = {d: run.reference_condition(d) for d in wanted}
    rows = _model_rows(run, lambda m: [_metric(run.rows(d, conditions[d], task, m), "nrmse") for d in wanted])
    return Table(
        f"{TASK_TITLES[task]}: NRMSE by dataset; median over the seeds, range in brackets",
        ["Model", *(f"{d} ({conditions[d]})" for d in wanted)],
        _mark_best(rows, range(1, len(wanted) + 1)),
    )


def best_models(run: RunDirectory, task: str) -> dict[str, str]:
    """The model with the smallest NRMSE on each dataset, where any has one."""
    found = {}
    for dataset in run.datasets:
        condition = run.reference_condition(dataset)
        medians = {}
        for model in run.models:
            rows = run.rows(dataset, condition, task, model)
            if not rows.empty and (rows["status"] == "ok").all():
                medians[model] = float(rows["nrmse"].median())
        if medians:
            found[dataset] = min(medians, key=lambda m: medians[m])
    return found


def paper_table(run: RunDirectory, number_: int) -> Table | None:
    """Table 4 (torque) or 5 (deflection) of the first source paper beside this run's figures on its loop."""
    dataset, task, printed = "vsa-published", "forward", TABLE_4
    if number_ == 5:
        task, printed = "inverse", TABLE_5
    if dataset not in run.datasets:
        return None
    unit = run.dataset(dataset).get("y_unit" if number_ == 4 else "x_unit", "")
    condition = run.reference_condition(dataset)
    names = ("mae", "mre", "rmse")

    def cells(model: str) -> list[Cell]:
        paper = printed.get(model, {})
        left = [Cell(number(paper[n]), sort=paper[n]) if n in paper else Cell("–", muted=True) for n in names]
        rows = run.rows(dataset, condition, task, model)
        right = [_metric(rows, n) for n in (*names, "max_abs", "nrmse")]
        clean = _metric(run.rows(dataset, "clean", task, model), "rmse")
        return [*left, *right, clean]

    return Table(
        f"Table {number_}: {'torque' if number_ == 4 else 'deflection'} error on vsa-published ({condition}), in {unit}; "
        "MRE and NRMSE have no unit",
        ["Model", "MAE", "MRE", "RMSE", "MAE", "MRE", "RMSE", "max", "NRMSE", "RMSE, clean"],
        _mark_best(_model_rows(run, cells), range(4, 10)),
        groups=(("", 1), ("printed in the paper", 3), ("this run", 6)),
    )


def order_statement(run: RunDirectory, number_: int) -> str:
    """Whether the paper's order of the three models holds in this run, condition by condition."""
    task = "forward" if number_ == 4 else "inverse"
    names = ("maxwell-slip", "cubic", "bouc-wen")
    holds: list[str] = []
    breaks: list[str] = []
    for condition in run.conditions("vsa-published"):
        values = []
        for model in names:
            rows = run.rows("vsa-published", condition, task, model)
            values.append(
                float(rows["rmse"].median()) if not rows.empty and (rows["status"] == "ok").all() else math.nan
            )
        if any(math.isnan(v) for v in values):
            continue
        ordered = values[0] < values[1] < values[2] if number_ == 4 else values[0] < min(values[1:])
        shown = ", ".join(f"{m} {number(v)}" for m, v in zip(names, values, strict=True))
        (holds if ordered else breaks).append(f"{condition} ({shown})")
    claim = (
        "torque RMSE of maxwell-slip < cubic < bouc-wen"
        if number_ == 4
        else "maxwell-slip has a smaller deflection RMSE than cubic and bouc-wen"
    )
    if not holds and not breaks:
        return ""
    if not breaks:
        return f"The paper's order, {claim}, holds under every condition run: {'; '.join(holds)}."
    text = f"The paper's order, {claim}, does not hold under: {'; '.join(breaks)}."
    if holds:
        text += f" It holds under: {'; '.join(holds)}."
    return text + " The loops and errors on that dataset's page show where each model loses."


def dataset_table(run: RunDirectory, dataset: str) -> Table:
    """All models on one dataset under its reference condition, failed ones included."""
    info = run.dataset(dataset)
    condition = run.reference_condition(dataset)
    y, x = info.get("y_unit", "y"), info.get("x_unit", "x")
    plant = info.get("kind") != "recorded"

    def cells(model: str) -> list[Cell]:
        forward = run.rows(dataset, condition, "forward", model)
        inverse = run.rows(dataset, condition, "inverse", model)
        found = [_metric(forward, n) for n in ("mae", "mre", "rmse", "max_abs", "nrmse")]
        found += [_metric(inverse, n) for n in ("rmse", "max_abs")]
        if plant:
            found.append(_metric(run.rows(dataset, condition, "compensation", model), "rmse"))
        messages = [str(m) for m in (*forward["message"], *inverse["message"]) if m]
        found.append(Cell(messages[0] if messages else "", sort=messages[0] if messages else "", muted=True))
        return found

    def published(scores: dict[str, float]) -> list[Cell]:
        found = [Cell(number(scores[n]), sort=scores[n]) for n in ("mae", "mre", "rmse", "max_abs", "nrmse")]
        blank = [Cell("–", muted=True)] * (3 if plant else 2)
        return [*found, *blank, Cell("as published, scored on the same samples", sort="", muted=True)]

    columns = ["Model", f"MAE, {y}", "MRE", f"RMSE, {y}", f"max, {y}", "NRMSE", f"RMSE, {x}", f"max, {x}"]
    groups = [("", 1), ("torque" if y == "N·m" else "output", 5), ("inverse", 2)]
    if plant:
        columns.append(f"RMSE, {y}")
        groups.append(("compensated", 1))
    rows = _model_rows(run, cells)
    rows += [[Cell(title, sort=title), *published(scores)] for title, scores in info.get("references", {}).items()]
    return Table(
        f"{dataset}, condition {condition}",
        [*columns, "Remark"],
        _mark_best(rows, range(1, len(columns))),
        groups=(*groups, ("", 1)),
    )


def recording_table(run: RunDirectory, dataset: str) -> Table | None:
    """NRMSE on each test recording, beside predictions that the data's authors published; None for a single recording."""
    info = run.dataset(dataset)
    names, references = info.get("test_recordings", []), info.get("references", {})
    if len(names) < 2:
        return None
    condition = run.reference_condition(dataset)
    # Against one published prediction a ratio says more than a figure.
    base = [s["nrmse"] for s in next(iter(references.values()))["recordings"]] if len(references) == 1 else []

    def cell(value: float, place: int) -> Cell:
        ratio = f" ({value / base[place]:.2f})" if base else ""
        return Cell(number(value) + ratio, sort=value)

    def cells(model: str) -> list[Cell]:
        stored = run.arrays(model, dataset, condition)
        if "y_pred" not in stored:
            return [_status_cell(run.rows(dataset, condition, "forward", model))] * len(names)
        scores = scores_by_recording(*(stored[key] for key in ("y_true", "y_pred", "scored", "recording")))
        return [cell(s["nrmse"], k) for k, s in enumerate(scores)]

    rows = _model_rows(run, cells)
    for title, scores in references.items():
        rows.append([Cell(title, sort=title), *(cell(s["nrmse"], k) for k, s in enumerate(scores["recordings"]))])
    note = f"; in brackets as a share of {next(iter(references))}" if base else ""
    return Table(
        f"{dataset}, condition {condition}: NRMSE of the output on each test recording, first seed{note}",
        ["Model", *names],
        _mark_best(rows, range(1, len(names) + 1)),
    )


def condition_table(run: RunDirectory, dataset: str) -> Table | None:
    """NRMSE of every model under each condition of one dataset; None where there is one condition."""
    conditions = run.conditions(dataset)
    if len(conditions) < 2:
        return None
    columns = [(task, condition) for task in ("forward", "inverse") for condition in conditions]
    rows = _model_rows(run, lambda m: [_metric(run.rows(dataset, c, task, m), "nrmse") for task, c in columns])
    return Table(
        f"{dataset}: NRMSE by condition; median over the seeds, range in brackets",
        ["Model", *(condition for _, condition in columns)],
        _mark_best(rows, range(1, len(columns) + 1)),
        groups=(("", 1), ("output", len(conditions)), ("inverse", len(conditions))),
    )


def reversal_table(run: RunDirectory, only: Sequence[str] | None = None) -> Table:
    """What the noise does to the input of all (or only some) datasets before any model sees it."""
    rows = []
    for dataset in run.datasets if only is None else only:
        for condition in run.conditions(dataset):
            found = [c["filter"] for c in run.iter_cells(dataset=dataset, condition=condition) if c.get("filter")]
            if not found:
                continue
            values = [
                float(np.median([f.get(key) if f.get(key) is not None else np.nan for f in found]))
                for key in ("x_noise_rms", "y_noise_rms", "true_reversals", "false_reversals")
            ]
            rows.append(
                [
                    Cell(f"{dataset}, {condition}", sort=f"{dataset} {condition}"),
                    *(Cell(number(v), sort=v) for v in values),
                ]
            )
    return Table(
        "Noise left in the test signals (RMS against the noise-free signal), and reversals that are none",
        ["Dataset, condition", "input noise", "output noise", "true reversals", "false reversals"],
        rows,
    )


def compensation_table(run: RunDirectory) -> Table:
    """Torque error after driving the plant through the inverse, against driving it through a stiffness alone."""
    wanted = [d for d in run.datasets if run.dataset(d).get("kind") != "recorded"]
    without = {}
    for dataset in wanted:
        found = [
            c["uncompensated"]["rmse"]
            for c in run.iter_cells(dataset=dataset, condition=run.reference_condition(dataset))
            if c.get("uncompensated")
        ]
        without[dataset] = float(np.median(found)) if found else math.nan

    def cells(model: str) -> list[Cell]:
        found = []
        for dataset in wanted:
            cell = _metric(run.rows(dataset, run.reference_condition(dataset), "compensation", model), "rmse")
            found.append(cell)
            ratio = (
                cell.sort / without[dataset] if isinstance(cell.sort, float) and math.isfinite(cell.sort) else math.nan
            )
            found.append(Cell(f"{ratio:.0%}", sort=ratio) if math.isfinite(ratio) else Cell("–", muted=True))
        return found

    first = [Cell("without compensation", sort="")]
    for dataset in wanted:
        first += [Cell(number(without[dataset]), sort=without[dataset]), Cell("100%", sort=1.0)]
    columns = ["Model"]
    for dataset in wanted:
        columns += [f"RMSE, {run.dataset(dataset).get('y_unit', '')}", "of without"]
    return Table(
        "Compensation: reference torque → inverse model → plant → torque, against the reference",
        columns,
        [first, *_mark_best(_model_rows(run, cells), range(1, 2 * len(wanted) + 1, 2))],
        groups=(("", 1), *((f"{d} ({run.reference_condition(d)})", 2) for d in wanted)),
    )


def diagnosis_table(run: RunDirectory, only: str | None = None) -> Table | None:
    """What each model lacks on the recorded datasets (or one of them); None where nothing was diagnosed."""
    entries = [
        entry for entry in run.diagnoses if only in (None, entry["dataset"]) and entry["dataset"] in run.datasets
    ]
    if not entries:
        return None
    entries = [e for d in run.datasets for m in run.models for e in entries if (e["dataset"], e["model"]) == (d, m)]
    rows = []
    for entry in entries:
        title = run.model_title(entry["model"])
        place = [] if only else [Cell(entry["dataset"], sort=entry["dataset"])]
        rows.append([Cell(title, sort=title), *place, *_diagnosis_cells(entry)])
    where = [] if only else ["Dataset"]
    return Table(
        "Diagnosis of each model's error on the test recordings"
        + (f" of {only}" if only else "")
        + "; closed: the share of the squared error beyond the noise that the best explanation removes on samples not fitted",
        ["Model", *where, "Lacks", "Known cause", "Agrees", "Confidence", "Closed", "Where", "RMSE (noise)"],
        rows,
    )


def _diagnosis_cells(entry: dict[str, Any]) -> list[Cell]:
    found, known = entry["diagnosis"], entry["known_cause"]
    cause = Cell(words(known["effects"]), sort=words(known["effects"])) if known else Cell("–", sort="", muted=True)
    if found is None:
        blank = [Cell("–", muted=True)] * 4
        return [Cell(str(entry["status"]), sort="", muted=True, note=str(entry["message"])), cause, blank[0], *blank]
    verdict, gap = found["verdict"], found["gap"]
    lacks = words(verdict) if verdict else "nothing beyond the noise"
    where = Cell("–", sort="", muted=True)
    if found["where"]:
        first = found["where"][0]
        low, high = (number(v) for v in first["range"])
        # Further coordinates are the recording's own channels, which keep their names.
        name = spoken(first["coordinate"])
        text = f"{name} {first['share']:.0%}, {low} to {high}"
        where = Cell(text, sort=text)
    agrees = Cell("–", sort="", muted=True)
    if known:
        answer = "yes" if known["agrees"] else "no"
        agrees = Cell(answer, sort=answer)
    return [
        Cell(lacks, sort=lacks),
        cause,
        agrees,
        Cell(f"{found['confidence']:.0%}", sort=found["confidence"]),
        Cell(f"{found['closed']:.0%}", sort=found["closed"]) if verdict else Cell("–", muted=True),
        where,
        Cell(f"{number(gap['rmse'])} ({number(gap['noise_floor'], 2)}) {gap['unit']}", sort=gap["rmse"]),
    ]


def words(names: Sequence[str]) -> str:
    """Ids of effects or coordinates for people."""
    return ", ".join(map(spoken, names))


def timing_table(run: RunDirectory) -> Table:
    """Medians over all cells of a model."""
    compiled = run.document.get("compile_s", {})

    def cells(model: str) -> list[Cell]:
        timings = [c["timing"] for c in run.iter_cells(model=model) if c.get("timing")]
        found = []
        for key, scale in (
            ("fit_s", 1.0),
            ("predict_ns_per_sample", 1.0),
            ("step_ns", 1.0),
            ("invert_ns_per_sample", 1e-3),
        ):
            values = [t[key] * scale for t in timings if t.get(key) is not None]
            if not values:
                found.append(Cell("–", muted=True))
                continue
            median = float(np.median(values))
            found.append(Cell(f"{number(median)} (max {number(max(values), 2)})", sort=median))
        seconds = compiled.get(model)
        found.append(Cell(number(seconds, 2), sort=seconds) if seconds is not None else Cell("–", muted=True))
        return found

    return Table(
        "Time by model: median over the cells, largest in brackets",
        ["Model", "fit, s", "predict, ns/sample", "one step, ns", "inverse, µs/sample", "compile or load, s"],
        _mark_best(_model_rows(run, cells), range(1, 5)),
    )
