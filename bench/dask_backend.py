"""Cells on many machines: a dask.distributed scheduler hands them to its workers, the results come back here.

Nothing but the scheduler's address is shared: a worker needs hystbench in the same version and the recorded data, but no
common file system. Each of a worker's threads keeps one process of its own for the cells, so that time limits, pinned
numerical threads and plug-ins that kill their process are dealt with as on one machine.
"""

from __future__ import annotations

import multiprocessing
import threading
from collections.abc import Iterable, Sequence
from concurrent.futures import Executor
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from uuid import uuid4

from ..errors import InputError
from .cells import Errand, fallback_cell, run_cell
from .local_backend import run_guarded, worker_pool
from .results import write_cell

__all__ = ["compute_on_dask"]

CONNECT_TIMEOUT = "15s"
_own = threading.local()


def compute_on_dask(specs: Sequence[Errand], folder: Path, scheduler: str) -> Iterable[dict[str, Any]]:
    """Yield finished cells. What a dying worker had not finished is handed to another one.

    Raises
    ------
    InputError
        If dask.distributed is not installed, the scheduler does not answer, has no worker, or a worker runs another
        version of hystbench or of the packages that results depend on.
    """
    try:
        from distributed import Client, as_completed
    except ImportError:
        raise InputError(
            "--backend dask needs dask.distributed; install it with `pip install 'hystbench[dask]'`"
        ) from None
    try:
        client = Client(scheduler, timeout=CONNECT_TIMEOUT, set_as_default=False)
    except (OSError, TimeoutError, ValueError) as error:
        raise InputError(f"--scheduler {scheduler}: no dask scheduler answers there ({error})") from None
    with client:
        if not client.scheduler_info(n_workers=-1)["workers"]:
            raise InputError(f"--scheduler {scheduler} has no worker; start one with `dask worker {scheduler}`")
        # A name of its own for each run: the scheduler would otherwise hand out what an earlier run computed.
        token = uuid4().hex
        futures = {client.submit(_remote_cell, s, key=f"{s.key}-{token}", pure=False): s for s in specs}
        try:
            for future in as_completed(futures, loop=client.loop):
                spec = futures[future]
                if future.status == "finished":
                    cell, arrays = future.result()
                    yield _store(spec, cell, arrays, folder)
                else:
                    yield _failed(spec, future.exception(), folder)
                # The scheduler may forget the arrays that are stored here.
                future.release()
        finally:
            client.cancel(list(futures), force=True)


def _remote_cell(spec: Errand) -> tuple[dict[str, Any], bytes]:
    """On a worker: compute a cell in a temporary folder and return it with its arrays as they lie on disk."""
    # dask marks its workers as daemons, which may not have children; ours end with them, or soon after, idle.
    multiprocessing.current_process()._config["daemon"] = False  # type: ignore[attr-defined]
    with TemporaryDirectory(prefix="hystbench-") as name:
        folder = Path(name)
        try:
            cell = _pool().submit(run_cell, spec, folder).result()
        except BrokenProcessPool:
            _own.pool = None
            cell = run_guarded(_pool(), spec, folder)
            if cell["rows"][0]["status"] in ("failed", "timeout"):
                _own.pool = None
        arrays = folder / f"{spec.key}.npz"
        return cell, arrays.read_bytes() if arrays.exists() else b""


def _pool() -> Executor:
    if getattr(_own, "pool", None) is None:
        _own.pool = worker_pool(1)
    return _own.pool


def _store(spec: Errand, cell: dict[str, Any], arrays: bytes, folder: Path) -> dict[str, Any]:
    if cell["key"] != spec.key:
        raise InputError(
            "a dask worker computes with another version of hystbench, numpy, scipy or numba than this machine; "
            "install the same versions on all of them"
        )
    write_cell(folder, cell, arrays)
    return cell


def _failed(spec: Errand, error: BaseException | None, folder: Path) -> dict[str, Any]:
    if type(error).__name__ == "KilledWorker":
        return fallback_cell(spec, folder, "failed", "every dask worker that took it died")
    raise InputError(f"{spec.name}: the dask worker could not run it ({type(error).__name__}: {error})")
