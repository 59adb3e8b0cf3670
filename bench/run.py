"""A run: every model on every dataset under every condition, on several processes, resumable."""

from __future__ import annotations

import hashlib
import json
import os
import time
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any
from uuid import uuid4

from .. import datasets, models
from ..datasets import Dataset, DatasetUnavailableError
from ..errors import InputError
from ..files import write_text
from ..plugins import BrokenPluginWarning
from .cells import MEMORY_LIMIT, CellSpec, data_hash
from .conditions import conditions_for
from .dask_backend import compute_on_dask
from .local_backend import compute_here
from .provenance import describe
from .references import reference_scores
from .results import plain, read_cells, read_document, write_results

__all__ = ["Plan", "part_of", "plan_run", "run"]

SCHEMA = "hystbench/run/1"
SEEDS = (0, 1, 2)
TIME_LIMIT = 120.0
TIMING_TIME = 0.04
QUICK_TIMING_TIME = 0.01
QUICK_CONDITIONS = {"synthetic": ("clean", "kalman"), "recorded": ("recorded",)}
# Conditions without random noise give the same cell for every seed.
SEEDLESS = ("clean", "recorded")


@dataclass
class Plan:
    """The cells of a run and what had to be left out."""

    cells: list[CellSpec]
    datasets: dict[str, Dataset]
    data: dict[str, str]
    models: list[str]
    seeds: list[int]
    skipped: list[dict[str, str]] = field(default_factory=list)
    part: tuple[int, int] | None = None
    """(i, n) if these are the cells of the i-th of n runs that together do the whole."""
    absent: list[str] = field(default_factory=list)
    """Recorded datasets among the skipped whose files are not on this machine."""


def plan_run(model_ids: Sequence[str] | None, dataset_ids: Sequence[str] | None, quick: bool) -> Plan:
    """Decide which cells to compute.

    Parameters
    ----------
    model_ids, dataset_ids : sequence of str or None
        None: all that are registered; recorded datasets whose files are absent are then left out and named. A
        recording in a file is a dataset too, by its path (see :class:`hystbench.datasets.user_recording.UserRecording`).
    quick : bool
        One seed, fewer conditions, and of the datasets only those that are not extended (unless named).

    Raises
    ------
    InputError
        If an id is unknown, or a dataset that was asked for by name is not on this machine.
    """
    chosen = _chosen_models(model_ids)
    for name in chosen:
        models.get(name)
    limit, memory = _limit("TIME", TIME_LIMIT, "seconds"), _limit("MEMORY", MEMORY_LIMIT, "GiB")
    seeds = list(SEEDS[:1] if quick else SEEDS)
    plan = Plan([], {}, {}, chosen, seeds)
    for registry in (models.registry, datasets.registry):
        plan.skipped += [{"what": f"{registry.kind} {name}", "why": why} for name, why in registry.broken.items()]
    for name in list(dict.fromkeys(dataset_ids)) if dataset_ids else datasets.ids():
        if quick and not dataset_ids and getattr(datasets.get(name), "extended", False):
            plan.skipped.append({"what": f"dataset {name}", "why": "left out because the run is quick"})
            continue
        source = datasets.source(name)
        try:
            dataset = source.load()
        except (DatasetUnavailableError, InputError) as error:
            if dataset_ids:
                raise InputError(str(error)) from None
            plan.skipped.append({"what": f"dataset {name}", "why": str(error)})
            if isinstance(error, DatasetUnavailableError):
                plan.absent.append(name)
            else:
                warnings.warn(f"dataset {name} left out: {error}", BrokenPluginWarning, stacklevel=2)
            continue
        except Exception as error:  # a dataset plug-in's failure costs its own cells only
            plan.skipped.append({"what": f"dataset {name}", "why": f"{type(error).__name__}: {error}"})
            warnings.warn(
                f"dataset {name} left out: {type(error).__name__}: {error}", BrokenPluginWarning, stacklevel=2
            )
            continue
        plan.datasets[name] = dataset
        plan.data[name] = data_hash(dataset)
        for condition in conditions_for(dataset):
            if quick and condition not in QUICK_CONDITIONS[dataset.kind]:
                continue
            recorded = dataset.kind == "recorded"
            for seed in seeds[:1] if recorded or condition in SEEDLESS else seeds:
                for model in chosen:
                    plan.cells.append(
                        CellSpec(
                            model,
                            name,
                            condition,
                            seed,
                            plan.data[name],
                            keep_arrays=seed == seeds[0],
                            time_limit=limit,
                            memory_limit=memory,
                            timing_time=QUICK_TIMING_TIME if quick else TIMING_TIME,
                        )
                    )
    if not plan.cells:
        raise InputError("nothing to run: no dataset could be loaded; see `hystbench list datasets`")
    return plan


def _chosen_models(model_ids: Sequence[str] | None) -> list[str]:
    """Those asked for; ``["all"]``: all that stand for themselves; None: of these, all that are not extended."""
    if not model_ids:
        return [name for name in models.benchmarked_ids() if not getattr(models.get(name), "extended", False)]
    return models.benchmarked_ids() if list(model_ids) == ["all"] else list(dict.fromkeys(model_ids))


def _limit(kind: str, default: float, unit: str) -> float:
    """A cell's limit, from the environment variable that users set it by."""
    name = f"HYSTBENCH_{kind}_LIMIT"
    text = os.environ.get(name, str(default))
    try:
        limit = float(text)
    except ValueError:
        limit = 0.0
    if not 0.0 < limit < 1e6:
        raise InputError(f"{name} must be a positive number of {unit}; it is {text!r}")
    return limit


def part_of(plan: Plan, part: int, parts: int) -> Plan:
    """The cells of one of ``parts`` runs that together do the plan; which are whose depends on their names alone.

    The order is that of a hash, so that each part gets some of every model and dataset.
    """
    ordered = sorted(plan.cells, key=lambda spec: hashlib.sha256(spec.name.encode()).digest())
    kept = set(ordered[part - 1 :: parts])
    return replace(plan, cells=[spec for spec in plan.cells if spec in kept], part=(part, parts))


def run(
    plan: Plan,
    out: Path,
    jobs: int,
    fresh: bool,
    command: list[str],
    advance: Callable[[dict[str, Any]], None],
    scheduler: str | None = None,
) -> Path:
    """Compute the plan's cells and write results.parquet and run.json to ``out``.

    On ``jobs`` processes of this machine, or on the workers of the dask scheduler at ``scheduler``.

    Cells that ``out`` holds already are kept unless ``fresh``; ``advance`` is called with each finished cell. A fresh run
    replaces old cells one by one, so that none is lost if it is interrupted; the next fresh run in ``out`` goes on with it.
    """
    folder = out / "cells"
    folder.mkdir(parents=True, exist_ok=True)
    # Marks and half-written files of a run that was killed.
    for left in folder.glob(".*"):
        left.unlink(missing_ok=True)
    specs = {spec.key: spec for spec in plan.cells}
    known = read_cells(folder)
    previous = read_document(out)
    goes_on = fresh and previous.get("fresh") is True and previous.get("finished") is False
    run_id = str(previous["run"]) if goes_on else uuid4().hex
    cells = {
        key: known[key]
        for key, spec in specs.items()
        if key in known and _is_whole(spec, known[key], folder) and (not fresh or known[key].get("run") == run_id)
    }
    pending = [replace(spec, run=run_id) for key, spec in specs.items() if key not in cells]
    document = {
        **_document(plan, command),
        "run": run_id,
        "fresh": fresh,
        # What an earlier run left for these counts until this run has replaced it.
        "superseded": [spec.key for spec in pending if spec.key in known],
    }
    start = time.perf_counter()
    _write_document(out, document, cells, start, finished=False)
    try:
        for kept in list(cells.values()):
            advance(kept)
        finished_cells = (
            compute_on_dask(pending, folder, scheduler) if scheduler else compute_here(pending, folder, jobs)
        )
        for cell in finished_cells:
            cells[cell["key"]] = cell
            advance(cell)
        _drop_outdated(folder, plan.cells)
        finished = True
    except BaseException:
        finished = False
        raise
    finally:
        held = known | cells
        ordered = [held[key] for key in specs if key in held]
        write_results(out / "results.parquet", ordered)
        _write_document(out, document, cells, start, finished=finished)
    return out


def _is_whole(spec: CellSpec, cell: dict[str, Any], folder: Path) -> bool:
    """Whether a kept cell need not be computed again; what failed for want of time or memory may succeed now."""
    succeeded = all(row["status"] in ("ok", "unsupported") for row in cell["rows"])
    return succeeded and (not spec.keep_arrays or (folder / f"{spec.key}.npz").exists())


def _drop_outdated(folder: Path, specs: Sequence[CellSpec]) -> None:
    """Remove what older versions or data left for these very cells; cells that this run did not ask for stay."""
    current = {(s.model, s.dataset, s.condition, s.seed): s.key for s in specs}
    for key, cell in read_cells(folder).items():
        if current.get((cell["model"], cell["dataset"], cell["condition"], cell["seed"]), key) != key:
            for suffix in (".json", ".npz"):
                (folder / f"{key}{suffix}").unlink(missing_ok=True)


def _document(plan: Plan, command: list[str]) -> dict[str, Any]:
    described = {}
    for name in plan.models:
        cls = models.get(name)
        described[name] = {
            "title": getattr(cls, "title", name),
            "summary": getattr(cls, "summary", ""),
            "source": getattr(cls, "source", ""),
            "hyperparameters": {k: repr(v) for k, v in cls().get_params().items()}
            if hasattr(cls, "get_params")
            else {},
        }
    fields = (
        "title",
        "kind",
        "x_name",
        "x_unit",
        "y_name",
        "y_unit",
        "split",
        "source",
        "licence",
        "x_sigma",
        "y_sigma",
    )
    return {
        "schema": SCHEMA,
        **describe(command),
        "seeds": plan.seeds,
        "models": described,
        "datasets": {
            name: {
                **{key: getattr(dataset, key) for key in fields},
                "assumptions": list(dataset.assumptions),
                "n_train": sum(r.x.size for r in dataset.train),
                "n_test": sum(r.x.size for r in dataset.test),
                "test_recordings": [r.name for r in dataset.test],
                "references": reference_scores(dataset),
            }
            for name, dataset in plan.datasets.items()
        },
        "data": {name: {"sha256": digest} for name, digest in plan.data.items()},
        "skipped": plan.skipped,
        "cells_total": len(plan.cells),
        "cells": [spec.key for spec in plan.cells],
        "part": list(plan.part) if plan.part else None,
    }


def _write_document(
    out: Path, document: dict[str, Any], cells: dict[str, dict[str, Any]], start: float, *, finished: bool
) -> None:
    compile_s: dict[str, float] = {}
    for cell in cells.values():
        if "compile_s" in cell:
            compile_s[cell["model"]] = max(cell["compile_s"], compile_s.get(cell["model"], 0.0))
    state = {
        "cells_done": len(cells),
        "finished": finished,
        "elapsed_s": round(time.perf_counter() - start, 3),
        "compile_s": compile_s,
        # Cells kept from an earlier run keep that one's session: their times are as old as they are.
        "sessions": sorted({cell.get("session", "unknown") for cell in cells.values()}),
    }
    write_text(out / "run.json", json.dumps(plain({**document, **state}), indent=1, allow_nan=False) + "\n")
