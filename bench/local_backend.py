"""Cells on this machine's cores, each in a worker process that may die without taking the run with it."""

from __future__ import annotations

import os
import sys
import threading
import time
import warnings
from collections.abc import Iterable, Sequence
from concurrent.futures import Executor, Future, as_completed
from pathlib import Path
from typing import Any

from ..errors import InputError
from .cells import Errand, fallback_cell, run_cell
from .results import drop_unfinished, read_cells
from .threads import LIBRARIES

__all__ = ["compute_here", "run_guarded", "worker_pool"]

# Numerical libraries would otherwise start a thread a core in every worker and slow each other down.
THREADS = {f"{library}_NUM_THREADS": "1" for library in LIBRARIES}
LARGEST_BATCH = 20
IDLE = 60.0
"""Seconds after which an idle worker process ends."""


def _start_worker() -> None:
    """Keep whatever plug-ins print away from stdout, which belongs to results, and leave Ctrl-C to the parent."""
    import signal

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    warnings.simplefilter("ignore")


def worker_pool(size: int) -> Executor:
    """``size`` fresh worker processes; :func:`concurrent.futures` in all but that it notices dead ones."""
    from joblib.externals.loky import ProcessPoolExecutor

    return ProcessPoolExecutor(max_workers=size, timeout=IDLE, initializer=_start_worker, env=THREADS)


def _stop(pool: Executor, *, kill: bool) -> None:
    reported = threading.excepthook

    def unless_killed(args: threading.ExceptHookArgs) -> None:
        # Killed with errands in its queue, loky's thread may look up one that it has just dropped, and end by that.
        if not (kill and args.exc_type is KeyError and args.thread and args.thread.name == "ExecutorManagerThread"):
            reported(args)

    threading.excepthook = unless_killed
    try:
        pool.shutdown(wait=True, kill_workers=kill)  # type: ignore[call-arg]  # loky's own argument
    finally:
        threading.excepthook = reported


def compute_here(specs: Sequence[Errand], folder: Path, jobs: int) -> Iterable[dict[str, Any]]:
    """Yield finished cells. A cell whose process dies is tried once more alone; if it dies again it has failed.

    Raises
    ------
    OSError
        If a cell cannot be written (a full disk): that is no model's fault.
    InputError
        If the code changed meanwhile.
    """
    pending = {spec.key: spec for spec in specs}
    while pending:
        pool = worker_pool(min(jobs, len(pending)))
        try:
            futures: dict[Future[list[dict[str, Any]]], Sequence[Errand]] = {
                pool.submit(_run_cells, batch, folder): batch for batch in _batches(list(pending.values()), jobs)
            }
            for future in as_completed(futures):
                for spec, cell in zip(futures[future], future.result(), strict=True):
                    _checked(spec, cell)
                    del pending[spec.key]
                    yield cell
        except (OSError, InputError):
            raise
        except Exception as error:
            suspects = [spec for key, spec in pending.items() if (folder / f".{key}.started").exists()]
            _stop(pool, kill=True)
            # What the dead process and the killed ones had finished lies on disk, whoever was to report it.
            recovered = [
                cell
                for key, cell in read_cells(folder).items()
                if key in pending and cell.get("run") == pending[key].run
            ]
            if not suspects and not recovered:
                raise
            for spec in suspects:
                del pending[spec.key]
                yield _alone(spec, folder, error)
            for cell in recovered:
                if pending.pop(cell["key"], None) is not None:
                    yield cell
        finally:
            # Also reached when the caller stops early (Ctrl-C): nothing may go on computing.
            _stop(pool, kill=bool(pending))
            # A disk that is full should not be made fuller by what the killed ones had begun.
            drop_unfinished(folder)


def _batches(specs: Sequence[Errand], jobs: int) -> list[Sequence[Errand]]:
    """The cells in batches for one errand each: none in small runs, whose cells are long and should spread evenly."""
    size = min(max(len(specs) // (100 * jobs), 1), LARGEST_BATCH)
    return [specs[start : start + size] for start in range(0, len(specs), size)]


def _run_cells(specs: Sequence[Errand], folder: Path) -> list[dict[str, Any]]:
    """In a worker: each cell is on disk before the next one starts."""
    return [run_cell(spec, folder) for spec in specs]


def _checked(spec: Errand, cell: dict[str, Any]) -> dict[str, Any]:
    """The cell, unless its process computed something else than was asked for: it reads the code later than we did."""
    if cell["key"] != spec.key:
        raise InputError(f"{spec.name}: the code or the packages changed while the run was going on; run it again")
    return cell


def _alone(spec: Errand, folder: Path, error: Exception) -> dict[str, Any]:
    finished = read_cells(folder).get(spec.key)
    if finished is not None and finished.get("run") == spec.run and not (folder / f".{spec.key}.started").exists():
        return finished
    pool = worker_pool(1)
    try:
        return _checked(spec, run_guarded(pool, spec, folder))
    finally:
        _stop(pool, kill=True)


def run_guarded(pool: Executor, spec: Errand, folder: Path) -> dict[str, Any]:
    """Compute one cell on a pool of one process; if that dies, the cell has failed (or timed out)."""
    try:
        return pool.submit(run_cell, spec, folder).result()
    except OSError:
        raise
    except Exception as error:
        marker = folder / f".{spec.key}.started"
        # The marker is as old as the cell: starting the process does not count.
        if marker.exists() and time.time() - marker.stat().st_mtime >= spec.time_limit:
            return fallback_cell(
                spec, folder, "timeout", f"took longer than {spec.time_limit:g} s and had to be killed"
            )
        return fallback_cell(spec, folder, "failed", f"its process died ({type(error).__name__})")
