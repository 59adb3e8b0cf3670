"""Calling one function many times in worker processes."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

from joblib import Parallel, delayed, parallel_config

__all__ = ["DEFAULT_JOBS", "spread"]

T = TypeVar("T")
DEFAULT_JOBS = min(2, os.cpu_count() or 1)


def spread(function: Callable[..., T], arguments: Sequence[tuple[Any, ...]], jobs: int) -> list[T]:
    """``function(*a)`` for each ``a``, in order; with one job in this process, else in ``jobs`` others.

    The others' linear algebra has one thread each: the fits' matrices are small, and threads that wait for each other
    make them several times slower.
    """
    if jobs == 1:
        return [function(*a) for a in arguments]
    with parallel_config(backend="loky", n_jobs=jobs, inner_max_num_threads=1):
        return list(Parallel()(delayed(function)(*a) for a in arguments))
