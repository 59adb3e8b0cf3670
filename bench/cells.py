"""One cell of a run: a model fitted to a dataset under a condition and a seed, then scored on every task."""

from __future__ import annotations

import hashlib
import importlib
import inspect
import json
import sys
import time
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from functools import lru_cache
from importlib.metadata import version
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from .. import datasets, models
from ..datasets import Dataset, Recording, concatenate
from ..errors import InputError
from .arguments import interval_arguments, time_argument
from .conditions import Conditioned, apply
from .isolation import no_other_processes, restored_process_state
from .limits import CellTimeoutError, memory_limit, time_limit
from .metrics import METRIC_VERSION, score
from .results import METRIC_COLUMNS, TASKS, TIME_COLUMNS, plain, write_cell
from .session import session_id
from .timing import seconds_per_call

__all__ = [
    "CellSpec",
    "Errand",
    "data_hash",
    "fallback_cell",
    "fitted_on",
    "load_unchanged",
    "model_identity",
    "run_cell",
]

Floats = NDArray[np.float64]
STEP_BLOCK = 256
"""Samples of one timed call of the stepper: a single step is too short to time and may hit a special case."""

MEMORY_LIMIT = 4.0
"""GiB that a cell may take; ten times what any built-in model needs."""

PACKAGES = ("hystbench", "numpy", "scipy", "numba", "filterpy")


class Errand(Protocol):
    """One piece of work of a run, done in a process of its own and kept under a content hash."""

    @property
    def run(self) -> str: ...
    @property
    def time_limit(self) -> float: ...
    @property
    def memory_limit(self) -> float: ...
    @property
    def keep_arrays(self) -> bool: ...
    @property
    def key(self) -> str: ...
    @property
    def name(self) -> str: ...

    def blank(self) -> dict[str, Any]:
        """The cell before anything is known; its rows have no status yet."""

    def fill(self, cell: dict[str, Any], arrays: dict[str, NDArray[Any]]) -> None:
        """Compute the cell and give its rows a status."""


@dataclass(frozen=True)
class CellSpec:
    """What a cell computes; its key is the content hash of everything the result depends on."""

    model: str
    dataset: str
    condition: str
    seed: int
    data: str
    keep_arrays: bool
    time_limit: float
    timing_time: float
    memory_limit: float = MEMORY_LIMIT
    run: str = ""
    """Id of the run that computes it, so that what an earlier run left under the same key is not taken for its work."""

    @property
    def key(self) -> str:
        document = {
            **model_identity(self.model),
            "metrics": METRIC_VERSION,
            **{k: v for k, v in vars(self).items() if k not in ("timing_time", "time_limit", "memory_limit", "run")},
        }
        return hashlib.sha256(json.dumps(document, sort_keys=True).encode()).hexdigest()[:24]

    @property
    def name(self) -> str:
        return f"{self.model} on {self.dataset} ({self.condition}, seed {self.seed})"

    def blank(self) -> dict[str, Any]:
        """The cell before anything is known."""
        return _empty_cell(self)

    def fill(self, cell: dict[str, Any], arrays: dict[str, NDArray[Any]]) -> None:
        """Fit and score every task."""
        _fill(cell, arrays, self)


def model_identity(model: str) -> dict[str, Any]:
    """What a result depends on of a model: its version, source and hyperparameters, and the packages under it."""
    cls = models.get(model)
    return {
        "model": model,
        "version": getattr(cls, "version", None),
        "code": _code_hash(cls.__module__),
        "hyperparameters": repr(cls().get_params()) if hasattr(cls, "get_params") else None,
        "packages": _packages(),
    }


@lru_cache(maxsize=1)
def _packages() -> dict[str, str]:
    return {name: version(name) for name in PACKAGES}


@lru_cache(maxsize=64)
def _code_hash(name: str) -> str:
    """Hash of the source that a model depends on: a helper that changed must not leave old cells valid.

    That is its own file, the files of its folder that hold no other model, and what these import from the folder.
    """
    module = importlib.import_module(name)
    try:
        folder = Path(inspect.getfile(module)).parent
    except (OSError, TypeError):
        return ""
    others = models.registry.modules()
    siblings = {f"{name.rpartition('.')[0]}.{path.stem}": path for path in folder.glob("*.py")}
    wanted = {other for other in siblings if other not in others} | _imported(name, siblings.keys())
    return hashlib.sha256(b"".join(siblings[other].read_bytes() for other in sorted(wanted))).hexdigest()


def _imported(name: str, siblings: Collection[str]) -> set[str]:
    """The module and those among its siblings from which it has functions or classes, and so on."""
    found: set[str] = set()
    waiting = [name]
    while waiting:
        current = waiting.pop()
        if current in siblings and current not in found:
            found.add(current)
            waiting += [str(getattr(v, "__module__", "")) for v in vars(sys.modules[current]).values() if callable(v)]
    return found


@lru_cache(maxsize=16)
def load_dataset(name: str) -> Dataset:
    """The dataset, loaded once a process."""
    return datasets.source(name).load()


def data_hash(dataset: Dataset, *, channels: bool = False) -> str:
    """SHA-256 over every sample, the split and the assumed noise; over all further channels too if they matter."""
    digest = hashlib.sha256()
    for part in (dataset.train, dataset.test):
        for recording in part:
            digest.update(f"{recording.name}|{recording.warm_up}|".encode())
            for series in (recording.time, recording.x, recording.y):
                digest.update(np.ascontiguousarray(series).tobytes())
            for name in sorted(recording.channels) if channels else ():
                digest.update(name.encode())
                digest.update(np.ascontiguousarray(recording.channels[name]).tobytes())
    digest.update(repr((dataset.x_sigma, dataset.y_sigma)).encode())
    return digest.hexdigest()


def load_unchanged(name: str, data: str, *, channels: bool = False) -> Dataset:
    """The dataset whose hash is ``data``.

    Raises
    ------
    InputError
        If it has another one now.
    """
    dataset = load_dataset(name)
    # A worker may have loaded it long before or after the run was planned; a user's file may have changed in between.
    if data_hash(dataset, channels=channels) != data:
        load_dataset.cache_clear()
        dataset = load_dataset(name)
        if data_hash(dataset, channels=channels) != data:
            raise InputError(f"dataset {name} has changed since the run was planned; run again")
    return dataset


@lru_cache(maxsize=4)
def _conditioned(name: str, data: str, condition: str, seed: int) -> Conditioned:
    return apply(load_unchanged(name, data), condition, seed)


@lru_cache(maxsize=64)
def warm_up(model: str) -> float:
    """Compile the model's kernels on a small loop and return the seconds that took, so that no cell pays for it."""
    start = time.perf_counter()
    cls = models.get(model)
    t = np.linspace(0.0, 4.0 * np.pi, 400)
    x = np.sin(t)
    y = x + 0.2 * np.sign(np.cos(t))
    fitted = cls().fit(x, y)
    fitted.predict(x)
    if hasattr(fitted, "stepper"):
        fitted.stepper().step(0.0)
    if hasattr(fitted, "invert"):
        _invert(fitted, y[:20], Recording("warm-up", t[:20], x[:20], y[:20]))
    return time.perf_counter() - start


def run_cell(spec: Errand, folder: Path) -> dict[str, Any]:
    """Compute one cell, write it to ``folder`` and return it. Never raises for what a model does."""
    cell = spec.blank()
    arrays: dict[str, NDArray[Any]] = {}
    marker = folder / f".{spec.key}.started"
    marker.touch()
    start, cpu = time.perf_counter(), time.process_time()
    try:
        with (
            no_other_processes(),
            restored_process_state(),
            time_limit(spec.time_limit),
            memory_limit(spec.memory_limit),
        ):
            spec.fill(cell, arrays)
    except CellTimeoutError:
        _finish(cell, "timeout", f"took longer than {spec.time_limit:g} s")
    except BaseException as error:  # whatever a model raises costs its own cell only
        _finish(cell, "failed", _one_line(error))
    cell["elapsed_s"], cell["cpu_s"] = time.perf_counter() - start, time.process_time() - cpu
    if "timing" in cell:
        for row in cell["rows"]:
            row.update({column: cell["timing"].get(column, np.nan) for column in TIME_COLUMNS})
    write_cell(folder, cell, arrays if spec.keep_arrays else {})
    marker.unlink(missing_ok=True)
    return cell


def fallback_cell(spec: Errand, folder: Path, status: str, message: str) -> dict[str, Any]:
    """A cell for a model whose process died before it could write one itself."""
    cell = spec.blank()
    _finish(cell, status, message)
    write_cell(folder, cell, {})
    (folder / f".{spec.key}.started").unlink(missing_ok=True)
    return cell


def _empty_cell(spec: CellSpec) -> dict[str, Any]:
    row = {"model": spec.model, "dataset": spec.dataset, "condition": spec.condition, "seed": spec.seed, "n": 0}
    values = dict.fromkeys((*METRIC_COLUMNS, *TIME_COLUMNS), np.nan)
    return {
        "key": spec.key,
        "model": spec.model,
        "dataset": spec.dataset,
        "condition": spec.condition,
        "seed": spec.seed,
        "session": session_id(),
        "run": spec.run,
        "rows": [{**row, "task": task, **values, "status": "", "message": ""} for task in TASKS],
        "fit": None,
        "timing": {},
        "filter": None,
        "uncompensated": None,
    }


def _finish(cell: dict[str, Any], status: str, message: str) -> None:
    """Give every task that has no status yet this one."""
    for row in cell["rows"]:
        if not row["status"]:
            row.update(status=status, message=message)


def _one_line(error: BaseException) -> str:
    told = str(error) or ("more than a cell may take" if isinstance(error, MemoryError) else "no message")
    return " ".join(f"{type(error).__name__}: {told}".split())[:400]


def fitted_on(model: str, train: Sequence[Recording]) -> tuple[Any, float]:
    """A model fitted to recordings, and the seconds that took."""
    x, y, groups = concatenate(train)
    fitted = models.get(model)()
    times = time_argument(fitted.fit, np.concatenate([r.time for r in train]))
    start = time.perf_counter()
    fitted.fit(x, y, groups=groups, **times)
    return fitted, time.perf_counter() - start


def _fill(cell: dict[str, Any], arrays: dict[str, NDArray[Any]], spec: CellSpec) -> None:
    data = _conditioned(spec.dataset, spec.data, spec.condition, spec.seed)
    cell["filter"] = data.filter
    cell["compile_s"] = warm_up(spec.model)
    timing = cell["timing"]
    fitted, timing["fit_s"] = fitted_on(spec.model, data.train)
    cell["fit"] = {
        "parameters": plain(getattr(fitted, "parameters_", {})),
        "conditions": [plain(vars(c)) for c in getattr(fitted, "conditions_", [])],
        "notes": list(getattr(fitted, "notes_", [])),
    }
    _record(arrays, data)
    tasks: dict[str, Callable[..., None]] = {"forward": _forward, "inverse": _inverse, "compensation": _compensate}
    for row in cell["rows"]:
        try:
            tasks[row["task"]](row, cell, arrays, fitted, data, spec)
        except Exception as error:  # a task that fails leaves the others be
            row.update(status="failed", message=_one_line(error))


def _record(arrays: dict[str, NDArray[Any]], data: Conditioned) -> None:
    seen, truth = data.test, data.truth
    arrays["time"] = np.concatenate([r.time for r in truth])
    arrays["recording"] = np.repeat(np.arange(len(truth)), [r.x.size for r in truth])
    arrays["scored"] = _scored(truth)
    arrays["x_seen"] = np.concatenate([r.x for r in seen])
    arrays["x_true"] = np.concatenate([r.x for r in truth])
    arrays["y_true"] = np.concatenate([r.y for r in truth])


def _scored(recordings: Sequence[Recording]) -> NDArray[np.bool_]:
    return np.concatenate([np.arange(r.x.size) >= r.warm_up for r in recordings])


def _score(row: dict[str, Any], truth: Floats, estimate: Floats, recordings: Sequence[Recording], what: str) -> None:
    estimate = np.asarray(estimate, dtype=np.float64)
    if estimate.shape != truth.shape:
        raise ValueError(f"{what} has shape {estimate.shape}, not {truth.shape}")
    bad = np.flatnonzero(~np.isfinite(estimate))
    if bad.size:
        raise ValueError(f"{what} is {estimate[bad[0]]} at sample {bad[0]} ({bad.size} such samples)")
    row.update(score(truth, estimate, _scored(recordings)), status="ok")


def _forward(
    row: dict[str, Any], cell: dict[str, Any], arrays: dict[str, Any], fitted: Any, data: Conditioned, spec: CellSpec
) -> None:
    times = time_argument(fitted.predict, arrays["time"])
    estimate = fitted.predict(arrays["x_seen"], groups=arrays["recording"], **times)
    _score(row, arrays["y_true"], estimate, data.truth, "the prediction")
    arrays["y_pred"] = np.asarray(estimate, dtype=np.float64)
    timing = cell["timing"]
    first = data.test[0]
    x, times = first.x, time_argument(fitted.predict, first.time)
    timing["predict_ns_per_sample"] = (
        1e9 / x.size * seconds_per_call(lambda: fitted.predict(x, **times), spec.timing_time)
    )
    if hasattr(fitted, "stepper"):
        stepper = fitted.stepper()
        further = interval_arguments(stepper.step, first.time)
        block = [(value, *more) for value, more in zip(x[:STEP_BLOCK].tolist(), further, strict=False)]

        def steps() -> None:
            for sample in block:
                stepper.step(*sample)

        timing["step_ns"] = 1e9 / len(block) * seconds_per_call(steps, spec.timing_time)


def _inverse(
    row: dict[str, Any], cell: dict[str, Any], arrays: dict[str, Any], fitted: Any, data: Conditioned, spec: CellSpec
) -> None:
    if not hasattr(fitted, "invert"):
        row.update(status="unsupported", message="the model has no invert")
        return
    estimates = []
    start = time.perf_counter()
    for recording in data.test:
        estimates.append(_invert(fitted, recording.y, recording))
    elapsed = time.perf_counter() - start
    estimate = np.concatenate(estimates)
    _score(row, arrays["x_true"], estimate, data.truth, "the inverse")
    arrays["x_inverse"] = estimate
    cell["timing"]["invert_ns_per_sample"] = 1e9 * elapsed / estimate.size
    wanted = np.concatenate([r.y for r in data.test])
    times = time_argument(fitted.predict, arrays["time"])
    back = fitted.predict(estimate, groups=arrays["recording"], **times)
    share = float(np.mean(np.abs(back - wanted) > 1e-6 * np.ptp(wanted)))
    if share > 0.0:
        row["message"] = f"{share:.1%} of the samples have no exact inverse; the nearest output was taken there"


def _compensate(
    row: dict[str, Any], cell: dict[str, Any], arrays: dict[str, Any], fitted: Any, data: Conditioned, spec: CellSpec
) -> None:
    plant = load_dataset(spec.dataset).plant
    if plant is None:
        row.update(status="unsupported", message="recorded data: there is no plant to drive")
        return
    if not hasattr(fitted, "invert"):
        row.update(status="unsupported", message="the model has no invert")
        return
    x, y, _ = concatenate(data.train)
    slope, level = np.polyfit(x, y, 1)
    compensated, uncompensated = [], []
    for recording in data.truth:
        reference = recording.y
        compensated.append(plant(recording.time, _invert(fitted, reference, recording)))
        # Without a hysteresis model an engineer divides by the stiffness: the best line through the training data.
        uncompensated.append(plant(recording.time, (reference - level) / slope))
    _score(row, arrays["y_true"], np.concatenate(compensated), data.truth, "the compensated torque")
    arrays["y_compensated"] = np.concatenate(compensated)
    arrays["y_uncompensated"] = np.concatenate(uncompensated)
    cell["uncompensated"] = score(arrays["y_true"], arrays["y_uncompensated"], _scored(data.truth))


def _invert(fitted: Any, y: Floats, recording: Recording) -> Floats:
    """The model's inverse, the nearest input where none is exact and the model can offer that."""
    further = time_argument(fitted.invert, recording.time)
    if "approximate" in inspect.signature(fitted.invert).parameters:
        further["approximate"] = True
    return fitted.invert(y, x0=float(recording.x[0]), **further)
