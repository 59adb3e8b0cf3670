"""Timing by pytest-benchmark's own calibration, outside of a test."""

from __future__ import annotations

import time
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

__all__ = ["seconds_per_call"]


class _Silent:
    """Takes pytest-benchmark's log messages and drops them."""

    def debug(self, *args: Any, **kwargs: Any) -> None: ...

    info = warning = debug


def seconds_per_call(function: Callable[[], Any], max_time: float) -> float:
    """Median time of one call of ``function``, s.

    pytest-benchmark calibrates how many calls make one round that its timer resolves, then measures at least five
    rounds and about ``max_time`` seconds of them; the collector is off meanwhile.
    """
    # Importing it pulls in pytest, so only runs that time anything pay for it.
    from pytest_benchmark.fixture import BenchmarkFixture

    benchmark = BenchmarkFixture(
        node=SimpleNamespace(name="cell", nodeid="cell"),
        disable_gc=True,
        timer=SimpleNamespace(target=time.perf_counter),
        min_rounds=5,
        min_time=max_time / 2000.0,
        max_time=max_time,
        precision=None,
        confidence=None,
        warmup=False,
        warmup_iterations=0,
        calibration_precision=10,
        add_stats=lambda stats: None,
        logger=_Silent(),
        warner=None,
        disabled=False,
        cprofile=False,
        cprofile_loops=None,
        cprofile_dump=None,
    )
    benchmark(function)
    return float(benchmark.stats.stats.median)
