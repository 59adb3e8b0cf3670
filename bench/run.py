"""A run: every model on every dataset under every condition, on several processes, resumable."""

from __future__ import annotations

import json
import os
import sys
import time
import warnings
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Future, as_completed
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from .. import datasets, models
from ..datasets import Dataset, DatasetUnavailableError
from ..errors import InputError
from ..files import write_text
from ..plugins import BrokenPluginWarning
from .cells import CellSpec, data_hash, fallback_cell, run_cell
from .conditions import conditions_for
from .provenance import describe
from .results import plain, read_cells, write_results

__all__ = ["Plan", "plan_run", "run"]

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
    chosen = list(dict.fromkeys(model_ids)) if model_ids else models.ids()
    for name in chosen:
        models.get(name)
    limit = _time_limit()
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
                            timing_time=QUICK_TIMING_TIME if quick else TIMING_TIME,
                        )
                    )
    if not plan.cells:
        raise InputError("nothing to run: no dataset could be loaded; see `hystbench list datasets`")
    return plan


def _time_limit() -> float:
    text = os.environ.get("HYSTBENCH_TIME_LIMIT", str(TIME_LIMIT))
    try:
        limit = float(text)
    except ValueError:
        limit = 0.0
    if not 0.0 < limit < 1e6:
        raise InputError(f"HYSTBENCH_TIME_LIMIT must be a positive number of seconds; it is {text!r}")
    return limit


def run(
    plan: Plan, out: Path, jobs: int, fresh: bool, command: list[str], advance: Callable[[dict[str, Any]], None]
) -> Path:
    """Compute the plan's cells on ``jobs`` processes and write results.parquet and run.json to ``out``.

    Cells that ``out`` holds already are kept unless ``fresh``; ``advance`` is called with each finished cell.
    """
    folder = out / "cells"
    folder.mkdir(parents=True, exist_ok=True)
    for marker in folder.glob(".*.started"):
        marker.unlink(missing_ok=True)
    specs = {spec.key: spec for spec in plan.cells}
    known = {} if fresh else read_cells(folder)
    cells: dict[str, dict[str, Any]] = {}
    document = _document(plan, command)
    start = time.perf_counter()
    _write_document(out, document, cells, start, finished=False)
    try:
        pending = []
        for key, spec in specs.items():
            kept = known.get(key)
            # What failed for want of time or memory may succeed now.
            if (
                kept is not None
                and all(row["status"] in ("ok", "unsupported") for row in kept["rows"])
                and (not spec.keep_arrays or (folder / f"{key}.npz").exists())
            ):
                cells[key] = kept
                advance(kept)
            else:
                pending.append(spec)
        for cell in _compute(pending, folder, jobs):
            cells[cell["key"]] = cell
            advance(cell)
        _drop_outdated(folder, plan.cells)
        finished = True
    except BaseException:
        finished = False
        raise
    finally:
        ordered = [cells[key] for key in specs if key in cells]
        write_results(out / "results.parquet", ordered)
        _write_document(out, document, cells, start, finished=finished)
    return out


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
            }
            for name, dataset in plan.datasets.items()
        },
        "data": {name: {"sha256": digest} for name, digest in plan.data.items()},
        "skipped": plan.skipped,
        "cells_total": len(plan.cells),
        "cells": [spec.key for spec in plan.cells],
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


def _start_worker() -> None:
    """Keep whatever plug-ins print away from stdout, which belongs to results, and leave Ctrl-C to the parent."""
    import signal

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    warnings.simplefilter("ignore")


def _executor(jobs: int) -> Any:
    from joblib.externals.loky import get_reusable_executor

    # Numerical libraries would otherwise start a thread a core in every worker and slow each other down.
    threads = {f"{library}_NUM_THREADS": "1" for library in ("OMP", "OPENBLAS", "MKL", "NUMBA")}
    return get_reusable_executor(max_workers=jobs, timeout=60, initializer=_start_worker, env=threads, reuse=False)


def _compute(specs: Sequence[CellSpec], folder: Path, jobs: int) -> Iterable[dict[str, Any]]:
    """Yield finished cells. A cell whose process dies is tried once more alone; if it dies again it has failed."""
    pending = {spec.key: spec for spec in specs}
    while pending:
        executor = _executor(min(jobs, len(pending)))
        try:
            futures: dict[Future[dict[str, Any]], CellSpec] = {
                executor.submit(run_cell, spec, folder): spec for spec in pending.values()
            }
            for future in as_completed(futures):
                cell = future.result()
                del pending[cell["key"]]
                yield cell
        except Exception as error:
            suspects = [spec for key, spec in pending.items() if (folder / f".{key}.started").exists()]
            if not suspects:
                raise
            executor.shutdown(wait=True, kill_workers=True)
            for spec in suspects:
                del pending[spec.key]
                yield _alone(spec, folder, error)
        finally:
            # Also reached when the caller stops early (Ctrl-C): nothing may go on computing.
            executor.shutdown(wait=True, kill_workers=bool(pending))


def _alone(spec: CellSpec, folder: Path, error: Exception) -> dict[str, Any]:
    finished = read_cells(folder).get(spec.key)
    if finished is not None and not (folder / f".{spec.key}.started").exists():
        return finished
    executor = _executor(1)
    try:
        return executor.submit(run_cell, spec, folder).result()
    except Exception as again:
        # The marker is as old as the cell: starting the process does not count.
        if time.time() - (folder / f".{spec.key}.started").stat().st_mtime >= spec.time_limit:
            return fallback_cell(
                spec, folder, "timeout", f"took longer than {spec.time_limit:g} s and had to be killed"
            )
        return fallback_cell(spec, folder, "failed", f"its process died ({type(again).__name__})")
    finally:
        executor.shutdown(wait=True, kill_workers=True)
