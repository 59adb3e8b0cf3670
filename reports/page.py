"""The page: everything that the template needs, gathered and rendered."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

from markupsafe import Markup

from .. import __version__
from ..bench.metrics import METRICS
from ..bench.results import TASKS
from ..files import write_text
from . import tables
from .advice import advice
from .export import figure_makers, ranking_table, slug
from .ranking import Ranking, rank_models
from .run_directory import RunDirectory, read_run
from .svg import Drawing
from .templating import environment

__all__ = ["render"]


def render(run_dir: str | Path) -> Path:
    """Write ``run_dir/report.html`` from the results there and return its path.

    The page is one file that loads nothing from anywhere; the same results give the same bytes.

    Raises
    ------
    InputError
        If the folder holds no results.
    """
    run = read_run(Path(run_dir))
    templates = environment()
    # A name as Python's shell takes it within double quotes, whatever is in it.
    templates.filters["quoted"] = lambda name: re.sub(r'["$`]', lambda m: f"\\x{ord(m[0]):02x}", repr(name))
    page = templates.get_template("report.html.j2").render(_context(run))
    target = run.path / "report.html"
    write_text(target, page)
    return target


def _context(run: RunDirectory) -> dict[str, Any]:
    document = run.document
    total, done = document.get("cells_total", 0), document.get("cells_done", 0)
    makers = figure_makers(run)
    rankings = {task: ranking for task in TASKS if (ranking := rank_models(run, task)) is not None}
    status = run.table["status"].value_counts()
    part, absent = document.get("part"), document.get("parts_absent", [])
    told = []
    if not document.get("finished", True) or done < total:
        earlier = document.get("cells_earlier", 0)
        kept = f", {earlier} stand as an earlier run left them" if earlier else ""
        told.append(f"{done} of {total} cells are finished{kept}" if done < total else "its diagnoses are not finished")
    if part:
        told.append(f"it is part {part[0]} of {part[1]}; `hystbench report` merges the parts")
    if absent:
        told.append(f"parts {', '.join(absent)} are absent")
    return {
        "version": __version__,
        "run": document,
        "verdict": _verdict(run),
        "incomplete": "; ".join(told),
        "headlines": [(tables.TASK_TITLES[task], tables.headline_table(run, task)) for task in TASKS],
        "papers": [
            (n, t, tables.order_statement(run, n)) for n in (4, 5) if (t := tables.paper_table(run, n)) is not None
        ],
        "metrics": METRICS,
        "datasets": _datasets(run, makers),
        "rankings": [_ranking(run, task, ranking, makers) for task, ranking in rankings.items()],
        "advice": advice(run, rankings),
        "front": _figure(makers, "accuracy and cost"),
        "noise_figure": _figure(makers, "noise study"),
        "reversals": tables.reversal_table(run),
        "compensation": tables.compensation_table(run),
        "diagnoses": tables.diagnosis_table(run),
        "diagnosed": document.get("diagnosed", "none"),
        "timing": tables.timing_table(run),
        "fits": [_fit(run, name) for name in run.models],
        "statuses": [(name, int(count)) for name, count in sorted(status.items())],
        "failures": _failures(run),
    }


def _verdict(run: RunDirectory) -> list[tuple[str, str]]:
    """For each task, on how many datasets each model has the smallest error."""
    told = []
    for task, title in tables.TASK_TITLES.items():
        best = tables.best_models(run, task)
        wins = Counter(best.values())
        ranked = sorted(wins.items(), key=lambda item: (-item[1], run.models.index(item[0])))
        if ranked:
            text = ", ".join(f"{run.model_title(m)} on {count}" for m, count in ranked)
            told.append((title, f"smallest for {text} of {len(best)} datasets"))
    return told


def _figure(makers: dict[str, Callable[[], Drawing | None]], name: str) -> dict[str, Any] | None:
    drawing = makers[name]() if name in makers else None
    return None if drawing is None else {"name": name, "file": slug(name), "svg": Markup(drawing.svg())}


def _ranking(
    run: RunDirectory, task: str, ranking: Ranking, makers: dict[str, Callable[[], Drawing | None]]
) -> dict[str, Any]:
    count = len(ranking.datasets)
    told = "Intervals are the middle 95 % of a bootstrap over datasets and, in each, seeds; models share a place (=) unless the interval of their difference excludes 0."
    if count < 2:
        told = "One dataset tells nothing of others: the order is that of its errors, without an interval."
    elif ranking.p == ranking.p:
        told += f" Friedman's test that all rank alike: p = {tables.number(ranking.p, 2)}."
    return {
        "title": tables.TASK_TITLES[task],
        "table": ranking_table(run, task),
        "figure": _figure(makers, f"ranking {task}"),
        "told": told,
    }


def _datasets(run: RunDirectory, makers: dict[str, Callable[[], Drawing | None]]) -> list[dict[str, Any]]:
    """What the page of each dataset shows."""
    best = tables.best_models(run, "forward")
    anchors: Counter[str] = Counter()
    found = []
    for name in run.datasets:
        anchor = f"dataset-{slug(name)}"
        anchors[anchor] += 1
        # Two names may come to the same once what an address cannot hold is replaced.
        anchor += f"-{anchors[anchor]}" if anchors[anchor] > 1 else ""
        found.append(
            {
                "anchor": anchor,
                "best": run.model_title(best[name]) if name in best else "",
                **_dataset(run, name, makers),
            }
        )
    return found


def _dataset(run: RunDirectory, name: str, makers: dict[str, Callable[[], Drawing | None]]) -> dict[str, Any]:
    return {
        "id": name,
        "info": run.dataset(name),
        "condition": run.reference_condition(name),
        "table": tables.dataset_table(run, name),
        "recordings": tables.recording_table(run, name),
        "diagnosis": tables.diagnosis_table(run, name),
        "causes": _known_causes(run, name),
        "conditions": tables.condition_table(run, name),
        "reversals": tables.reversal_table(run, [name]),
        "loops": _figure(makers, f"loops {name}"),
        "errors": _figure(makers, f"errors {name}"),
        "hash": run.document.get("data", {}).get(name, {}).get("sha256", ""),
    }


def _known_causes(run: RunDirectory, dataset: str) -> list[str]:
    """Why the cause of a gap is known, each reason once."""
    entries = [entry["known_cause"] for entry in run.diagnoses if entry["dataset"] == dataset and entry["known_cause"]]
    return list(dict.fromkeys(f"{tables.words(known['effects'])}: {known['reason']}" for known in entries))


def _fit(run: RunDirectory, model: str) -> dict[str, Any]:
    """What each fit of a model under the reference condition found out about itself."""
    entries = []
    for dataset in run.datasets:
        cells = sorted(
            run.iter_cells(model=model, dataset=dataset, condition=run.reference_condition(dataset)),
            key=lambda c: c["seed"],
        )
        if cells and cells[0].get("fit"):
            entries.append({"dataset": dataset, **cells[0]["fit"]})
    return {"title": run.model_title(model), "info": run.model(model), "entries": entries}


def _failures(run: RunDirectory) -> list[dict[str, Any]]:
    """Failed and timed-out cells, equal reasons together."""
    bad = run.table[run.table["status"].isin(["failed", "timeout"])]
    columns = [bad[name].tolist() for name in ("model", "dataset", "status", "message")]
    counts = Counter(zip(*columns, strict=True))
    return [
        {"model": run.model_title(m), "dataset": d, "status": s, "message": text, "count": count}
        for (m, d, s, text), count in sorted(counts.items())
    ]
