"""Noise told from structure: what lasts longer than the few samples over which a filter correlates noise."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ...models.motion import noise_level, rough_differences

__all__ = [
    "FARTHEST",
    "STRONGER",
    "at_rest_and_moving",
    "independent",
    "interleaved",
    "noise_levels",
    "rms",
    "structured_power",
]

Floats = NDArray[np.float64]
SETTLED, FILTERED = 1.04, (1.4, 1.18, 1.1)
"""Factor by which noise grows from one stride to the next that is none, and the most, from each stride, that is noise's own:
with a margin what a filter makes that correlates neighbours by a half."""
FARTHEST = 3
"""Samples; farther apart a hum would pass for noise."""
LOW_PASSED = 7
"""The same of noise behind a low pass, whose level grows steeply first and then stays."""
SHARE = 0.2
"""Share of the samples that are the slowest, and the fastest."""
FEWEST = 100
"""Samples whose level can be told well enough."""
STRONGER = 1.5
"""Noise at the fastest over that at the slowest from which it is of the motion; on 60 recordings with no gap it was 1.2 at most, on
eleven with noise behind a low pass 1.3, on three with a ripple that looked like it 4.7 and more."""
LEVEL, LATER = (0.95, 1.05), (0.9, 1.12)
"""Factors by which such a level may differ from one stride to the next, and to the one after: a hum's falls faster."""


def rms(series: Floats) -> float:
    """Root of the mean square."""
    return float(np.sqrt(np.mean(np.square(series))))


def interleaved(runs: Sequence[slice], stride: int) -> list[slice]:
    """Each recording's samples that are ``stride`` apart, from its first, its second and so on."""
    return [slice(run.start + k, run.stop, stride) for run in runs for k in range(stride)]


def noise_levels(series: Floats, runs: Sequence[slice]) -> list[float]:
    """Noise level of samples of ``series`` (n,) that are 1, 2, … apart, as far as :func:`independent` looks."""

    def apart(stride: int) -> float:
        parts = [series[part] for part in interleaved(runs, stride)]
        squares = np.square([noise_level(part) for part in parts])
        return float(np.sqrt(np.average(squares, weights=[part.size for part in parts])))

    return [apart(stride) for stride in range(1, LOW_PASSED + 3)]


def independent(levels: Sequence[float]) -> int:
    """Samples apart from where noise that is correlated over a few of them, as a filter leaves it, is no more so.

    Its level then grows less and less from stride to stride and stays; that of anything that moves grows on.
    """
    growth = [later / max(level, 1e-300) for level, later in pairwise(levels)]
    for stride, (factor, most) in enumerate(zip(growth, FILTERED, strict=False), start=1):
        if factor < SETTLED:
            return stride
        if factor > most:
            return _behind_low_pass(growth)
    return FARTHEST


def _behind_low_pass(growth: Sequence[float]) -> int:
    """Samples apart from where the level of noise behind a low pass stays; 1 if it does nowhere."""
    for stride, (factor, later) in enumerate(pairwise(growth[: LOW_PASSED + 1]), start=1):
        if LEVEL[0] < factor < LEVEL[1] and LATER[0] < later < LATER[1]:
            return stride
    return 1


def at_rest_and_moving(series: Floats, speed: Floats, runs: Sequence[slice], stride: int) -> tuple[float, float]:
    """Noise level of samples of ``series`` (n,) that are ``stride`` apart where ``speed`` (n,) is least, and where it is most.

    A sensor's noise does not know whether the joint moves. Where too few samples are slow, both are the same.
    """
    pieces = interleaved(runs, stride)
    size = np.concatenate([np.abs(speed[piece])[2:-2] for piece in pieces])
    slow, fast = size <= np.quantile(size, SHARE), size >= np.quantile(size, 1.0 - SHARE)
    differences = np.concatenate([rough_differences(series[piece]) for piece in pieces])
    if np.count_nonzero(slow) < FEWEST:
        slow = fast = np.ones_like(slow)
    return float(np.median(differences[slow])), float(np.median(differences[fast]))


def structured_power(series: Floats, runs: Sequence[slice], stride: int = 1) -> float:
    """Energy of ``series`` that lasts longer than a few times ``stride`` samples: its mean lagged product, free of noise."""
    shortest = min(run.stop - run.start for run in runs)
    lags = [lag for k in (1, 2, 3) if (lag := k * stride) < shortest]
    total = sum(float(series[run][lag:] @ series[run][:-lag]) for run in runs for lag in lags)
    count = sum(run.stop - run.start - lag for run in runs for lag in lags)
    return total / max(count, 1)
