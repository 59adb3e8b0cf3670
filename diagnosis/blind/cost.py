"""What a diagnosis costs: seconds and peak memory by the length of the recording."""

from __future__ import annotations

import functools
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np

from ..recording.signals import Signals
from .plants import Case, make

__all__ = ["LENGTHS", "growth", "measure"]

LENGTHS = (5_000, 10_000, 20_000)
RATE = 100.0


def measure(lengths: Sequence[int]) -> list[dict[str, Any]]:
    """Seconds and peak memory so far (MB; None where the system does not tell) of a diagnosis of each length, shortest first.

    In a fresh process, one after the other, when nothing else runs.
    """
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as process:
        return list(process.map(_diagnose, sorted(lengths)))


def growth(measured: Sequence[dict[str, Any]]) -> float:
    """Exponent k of seconds ~ samples^k (least squares in logarithms)."""
    return float(np.polyfit(np.log([m["samples"] for m in measured]), np.log([m["seconds"] for m in measured]), 1)[0])


def _diagnose(samples: int) -> dict[str, Any]:
    from ..diagnosis import diagnose

    _warm()
    signals = _recorded(samples)
    began = time.perf_counter()
    diagnose(signals)
    return {"samples": samples, "seconds": time.perf_counter() - began, "peak_mb": _peak_mb()}


@functools.cache
def _warm() -> None:
    """Kernels are compiled or loaded once an installation; what is measured comes after."""
    from ..diagnosis import diagnose

    diagnose(_recorded(1000))


def _recorded(samples: int) -> Signals:
    return make(Case("asymmetric", ("viscous_friction",), 4.0, 0.0, "rich", 1), samples / RATE, RATE).signals


def _peak_mb() -> float | None:
    status = Path("/proc/self/status")
    if not status.exists():
        return None
    line = next((text for text in status.read_text(encoding="ascii").splitlines() if text.startswith("VmHWM")), None)
    return int(line.split()[1]) / 1000.0 if line else None
