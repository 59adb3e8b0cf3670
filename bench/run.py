"""A run: every model on every dataset under every condition, on several processes, resumable."""

from __future__ import annotations

import hashlib
import json
import os
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Generic, TypeVar
from uuid import uuid4

from .. import datasets, models
from ..datasets import Dataset, DatasetUnavailableError
from ..errors import InputError
from ..files import write_text
from ..plugins import BrokenPluginWarning
from .cells import MEMORY_LIMIT, CellSpec, Errand, data_hash
from .conditions import conditions_for
from .dask_backend import compute_on_dask
from .diagnoses import DiagnosisSpec, best_models, diagnosis_specs, write_diagnoses
from .local_backend import compute_here
from .provenance import describe
from .references import reference_scores
from .results import drop_unfinished, plain, read_cells, read_document, write_results

__all__ = ["Plan", "part_of", "plan_run", "run"]

E = TypeVar("E", bound=Errand)
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
    diagnoses: list[DiagnosisSpec] = field(default_factory=list)
    """What could be diagnosed: every model on every recorded dataset."""
    diagnosed: str = "none"
    """Of these ``none``, ``best`` (each dataset's best model) or ``all``."""

    @property
    def errands(self) -> int:
        """Cells and diagnoses together."""
        chosen = {"none": 0, "best": len({spec.dataset for spec in self.diagnoses}), "all": len(self.diagnoses)}
        return len(self.cells) + chosen[self.diagnosed]


def plan_run(
    model_ids: Sequence[str] | None, dataset_ids: Sequence[str] | None, quick: bool, diagnose: bool | None = False
) -> Plan:
    """Decide which cells to compute.

    Parameters
    ----------
    model_ids, dataset_ids : sequence of str or None
        None: all that are registered; recorded datasets whose files are absent are then left out and named. A
        recording in a file is a dataset too, by its path (see :class:`hystbench.datasets.user_recording.UserRecording`).
    quick : bool
        One seed, fewer conditions, and of the datasets only those that are not extended (unless named).
    diagnose : bool or None
        Whether to diagnose what each model lacks on each recorded dataset; None: what each dataset's best model lacks,
        unless the run is quick.

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
    plan.diagnosed = {True: "all", False: "none", None: "none" if quick else "best"}[diagnose]
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
    plan.diagnoses = diagnosis_specs(chosen, plan.datasets, limit, memory)
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

    The order is that of a hash, so that each part gets some of every model and dataset. Which model is best no part
    knows, so that either all are diagnosed or none is.
    """
    diagnosed = "all" if plan.diagnosed == "all" else "none"
    return replace(
        plan,
        cells=_share(plan.cells, part, parts),
        diagnoses=_share(plan.diagnoses, part, parts),
        diagnosed=diagnosed,
        part=(part, parts),
    )


def _share(specs: Sequence[E], part: int, parts: int) -> list[E]:
    ordered = sorted(specs, key=lambda spec: hashlib.sha256(spec.name.encode()).digest())
    kept = {spec.name for spec in ordered[part - 1 :: parts]}
    return [spec for spec in specs if spec.name in kept]


def run(
    plan: Plan,
    out: Path,
    jobs: int,
    fresh: bool,
    command: list[str],
    advance: Callable[[dict[str, Any]], None],
    scheduler: str | None = None,
) -> Path:
    """Compute the plan's cells and write results.parquet, diagnoses.json and run.json to ``out``.

    On ``jobs`` processes of this machine, or on the workers of the dask scheduler at ``scheduler``.

    Cells that ``out`` holds already are kept unless ``fresh``; ``advance`` is called with each finished cell. A fresh run
    replaces old cells one by one, so that none is lost if it is interrupted; the next fresh run in ``out`` goes on with it.
    """
    previous = read_document(out)
    goes_on = fresh and previous.get("fresh") is True and previous.get("finished") is False
    run_id = str(previous["run"]) if goes_on else uuid4().hex
    only = run_id if fresh else None
    scored, diagnosed = _Work(plan.cells, out / "cells", only), _Work(plan.diagnoses, out / "diagnoses", only)
    document = {
        **_document(plan, command),
        "run": run_id,
        "fresh": fresh,
        # What an earlier run left for these counts until this run has replaced it.
        "superseded": [spec.key for spec in scored.pending if spec.key in scored.known],
    }
    start = time.perf_counter()
    finished = False

    def compute(work: _Work[E], specs: Sequence[E]) -> Iterator[dict[str, Any]]:
        pending = [replace(spec, run=run_id) for spec in specs if spec.key not in work.done]  # type: ignore[type-var]
        yield from [work.done[spec.key] for spec in specs if spec.key in work.done]
        work.folder.mkdir(parents=True, exist_ok=True)
        found = (
            compute_on_dask(pending, work.folder, scheduler) if scheduler else compute_here(pending, work.folder, jobs)
        )
        for cell in found:
            work.done[cell["key"]] = cell
            yield cell

    def save() -> None:
        write_results(out / "results.parquet", scored.held())
        write_diagnoses(out / "diagnoses.json", diagnosed.held())
        _write_document(out, document, scored.done, start, finished=finished)

    _write_document(out, document, scored.done, start, finished=False)
    try:
        for cell in compute(scored, plan.cells):
            advance(cell)
        chosen = {"none": [], "best": best_models(plan.diagnoses, scored.done.values()), "all": plan.diagnoses}
        if chosen[plan.diagnosed]:
            save()
        for cell in compute(diagnosed, chosen[plan.diagnosed]):
            write_diagnoses(out / "diagnoses.json", diagnosed.held())
            advance(cell)
        scored.drop_outdated()
        diagnosed.drop_outdated()
        finished = True
    finally:
        save()
    return out


class _Work(Generic[E]):
    """Work of one kind: what its folder holds of it already, and what is left.

    Parameters
    ----------
    specs : sequence of Errand
    folder : Path
    only : str, optional
        Of what lies there keep only what the run of this id computed.
    """

    def __init__(self, specs: Sequence[E], folder: Path, only: str | None) -> None:
        self.folder = folder
        drop_unfinished(folder)
        self.specs = {spec.key: spec for spec in specs}
        self.known = read_cells(folder)
        self.done = {
            key: self.known[key]
            for key, spec in self.specs.items()
            if key in self.known and self._is_whole(spec) and only in (None, self.known[key].get("run"))
        }

    @property
    def pending(self) -> list[E]:
        return [spec for key, spec in self.specs.items() if key not in self.done]

    def held(self) -> list[dict[str, Any]]:
        """What is finished and, where it is not, what an earlier run left; in the plan's order."""
        cells = self.known | self.done
        return [cells[key] for key in self.specs if key in cells]

    def _is_whole(self, spec: E) -> bool:
        """Whether a kept cell need not be computed again; what failed for want of time or memory may succeed now."""
        succeeded = all(row["status"] in ("ok", "unsupported") for row in self.known[spec.key]["rows"])
        return succeeded and (not spec.keep_arrays or (self.folder / f"{spec.key}.npz").exists())

    def drop_outdated(self) -> None:
        """Remove what older versions or data left for this very work; cells that this run did not ask for stay."""
        if self.known.keys() <= self.specs.keys():
            return
        current = {_identity(spec.blank()): key for key, spec in self.specs.items()}
        for key, cell in self.known.items():
            if current.get(_identity(cell), key) != key:
                for suffix in (".json", ".npz"):
                    (self.folder / f"{key}{suffix}").unlink(missing_ok=True)


def _identity(cell: dict[str, Any]) -> tuple[Any, ...]:
    return tuple(cell[name] for name in ("model", "dataset", "condition", "seed"))


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
        "diagnosed": plan.diagnosed,
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
