"""A report's figures and tables as files of their own, for papers and slides."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pandas as pd

from ..bench.results import TASKS
from ..errors import InputError
from ..files import write_text
from . import figures, tables
from .ranking import rank_models
from .run_directory import RunDirectory, read_run
from .svg import Drawing
from .tables import Table

__all__ = ["export", "figure", "figure_makers", "latex", "ranking_table", "slug"]

FORMATS = ("svg", "pdf", "png")


def figure_makers(run: RunDirectory) -> dict[str, Callable[[], Drawing | None]]:
    """Every figure of the report by its name; it is drawn when called."""
    makers: dict[str, Callable[[], Drawing | None]] = {}
    for task in TASKS:
        if (ranking := rank_models(run, task)) is not None:
            makers[f"ranking {task}"] = lambda r=ranking, t=task: figures.critical_differences(run, r, t)  # type: ignore[misc]
    makers["accuracy and cost"] = lambda: figures.front(run)
    studied = [d for d in run.datasets if len(run.conditions(d)) > 1]
    if studied:
        makers["noise study"] = lambda: figures.noise_study(run, studied)
    for name in run.datasets:
        makers[f"loops {name}"] = lambda d=name: figures.loops(run, d)  # type: ignore[misc]
        makers[f"errors {name}"] = lambda d=name: figures.errors_over_time(run, d)  # type: ignore[misc]
    return makers


def figure(run_dir: str | Path, name: str) -> Drawing:
    """Draw one figure of a run's report again.

    >>> figure("hystbench-report", "accuracy and cost").save("cost.pdf")  # doctest: +SKIP

    Raises
    ------
    InputError
        If the folder holds no results, or the run no such figure.
    """
    makers = figure_makers(read_run(Path(run_dir)))
    drawing = makers[name]() if name in makers else None
    if drawing is None:
        raise InputError(f"{run_dir}: no figure {name!r}; there are {', '.join(map(repr, makers))}")
    return drawing


def _tables(run: RunDirectory) -> dict[str, Table]:
    found = {f"headline {task}": tables.headline_table(run, task) for task in TASKS}
    for task in TASKS:
        if (ranking := ranking_table(run, task)) is not None:
            found[f"ranking {task}"] = ranking
    for name in run.datasets:
        found[f"dataset {name}"] = tables.dataset_table(run, name)
        if (conditions := tables.condition_table(run, name)) is not None:
            found[f"conditions {name}"] = conditions
    found["noise"] = tables.reversal_table(run)
    found["compensation"] = tables.compensation_table(run)
    if (diagnosed := tables.diagnosis_table(run)) is not None:
        found["diagnoses"] = diagnosed
    found["time"] = tables.timing_table(run)
    return found


def ranking_table(run: RunDirectory, task: str) -> Table | None:
    """Places, mean ranks and their intervals."""
    ranking = rank_models(run, task)
    if ranking is None:
        return None
    rows = []
    for k, model in enumerate(ranking.models):
        title, mean, low, high = (
            run.model_title(model),
            *(float(v[k]) for v in (ranking.mean, ranking.low, ranking.high)),
        )
        interval = f"{low:.2f} to {high:.2f}" if low == low else "one dataset: none"
        rows.append(
            [
                tables.Cell(title, sort=title),
                tables.Cell(ranking.place[k], sort=float(ranking.place[k].rstrip("=")), best=ranking.place[k][0] == "1" and len(ranking.place[k].rstrip("=")) == 1),
                tables.Cell(f"{mean:.2f}", sort=mean),
                tables.Cell(interval, sort=low if low == low else mean, muted=low != low),
            ]
        )  # fmt: skip
    return Table(
        f"{tables.TASK_TITLES[task]}: mean rank over {len(ranking.datasets)} datasets",
        ["Model", "Place (= tied)", "Mean rank", "95 % interval"],
        rows,
    )


def export(run_dir: str | Path) -> list[Path]:
    """Write the figures to ``run_dir/figures`` (SVG, PDF, PNG) and the tables to ``run_dir/tables`` (CSV, LaTeX).

    Returns
    -------
    list of Path
        What was written.
    """
    run = read_run(Path(run_dir))
    written = []
    for name, make in figure_makers(run).items():
        drawing = make()
        if drawing is None:
            continue
        for form in FORMATS:
            path = run.path / "figures" / f"{slug(name)}.{form}"
            drawing.save(path)
            written.append(path)
    for name, table in _tables(run).items():
        for suffix, text in (("csv", _csv(table)), ("tex", latex(table))):
            path = run.path / "tables" / f"{slug(name)}.{suffix}"
            write_text(path, text)
            written.append(path)
    return written


def slug(name: str) -> str:
    """A file name from any name: a dataset may be called after a path."""
    return re.sub(r"[^A-Za-z0-9._-]+", "-", name).strip(".-") or "unnamed"


def _headings(table: Table) -> list[str]:
    """Column headings, each with its group's, so that none occurs twice."""
    groups = [text for text, span in table.groups for _ in range(span)] or [""] * len(table.columns)
    return [f"{group}: {column}" if group else column for group, column in zip(groups, table.columns, strict=True)]


def _csv(table: Table) -> str:
    frame = pd.DataFrame([[cell.text for cell in row] for row in table.rows], columns=_headings(table))
    return str(frame.to_csv(index=False, lineterminator="\n"))


def latex(table: Table) -> str:
    """A ``tabular`` for LaTeX's package booktabs, the best figures in bold."""

    def row(texts: list[str]) -> str:
        return " & ".join(texts) + r" \\"

    lines = [
        f"% {' '.join(table.caption.split())}",
        rf"\begin{{tabular}}{{l{'r' * (len(table.columns) - 1)}}}",
        r"\toprule",
    ]
    if table.groups:
        lines.append(row([rf"\multicolumn{{{span}}}{{c}}{{{_tex(text)}}}" for text, span in table.groups]))
        column = 1
        for text, span in table.groups:
            if text:
                lines.append(rf"\cmidrule(lr){{{column}-{column + span - 1}}}")
            column += span
    lines += [row([_tex(column) for column in table.columns]), r"\midrule"]
    for cells in table.rows:
        lines.append(row([rf"\textbf{{{_tex(c.text)}}}" if c.best else _tex(c.text) for c in cells]))
    return "\n".join([*lines, r"\bottomrule", r"\end{tabular}", ""])


TEX = {
    "\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "<": r"\textless{}",
    ">": r"\textgreater{}", "·": r"$\cdot$", "µ": r"$\mu$", "–": "--", **{c: "\\" + c for c in "&%$#_{}"},
}  # fmt: skip


def _tex(text: str) -> str:
    return "".join(TEX.get(character, character) for character in " ".join(text.split()))
