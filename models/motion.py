"""The direction of motion under noise: which way the input moves, where it turns, and how noisy it is.

Raw differences of a noisy signal change sign at almost every sample, so direction is decided with a dead band: the
input has turned once it has come back from its last extreme by more than the band. This is the play operator's rule.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = [
    "auto_dead_band", "directions", "noise_level", "quantum", "rough_differences", "settled_from", "turning_points",
]  # fmt: skip

Floats = NDArray[np.float64]


def noise_level(signal: Floats) -> float:
    """Standard deviation of white noise on a smooth signal, shape (n,), from its fourth differences.

    Smooth motion has small fourth differences, white noise of deviation s has fourth differences of deviation
    sqrt(70) s; the median makes the estimate blind to corners and jumps. Returns 0.0 for fewer than 9 samples.
    """
    return float(np.median(rough_differences(signal))) if signal.size >= 9 else 0.0


def rough_differences(signal: Floats) -> Floats:
    """Fourth differences, shape (n - 4,), about the samples in their middle, whose median is the deviation of white noise."""
    return np.asarray(np.abs(np.diff(signal, 4)) / (0.6744897501960817 * np.sqrt(70.0)))


def quantum(values: Floats) -> float | None:
    """The step of which all differences of ``values`` are multiples; None where there is none.

    Steps of less than 1e-7 of the range are taken for the rounding of printed digits, and steps that all neighbours in
    time differ by for the speed of an even motion.
    """
    levels = np.unique(values)
    span = float(levels[-1] - levels[0])
    steps = np.diff(levels)
    # The same level in two roundings is one level.
    steps = steps[steps > 1e-9 * span]
    if steps.size < 2 or (levels.size > values.size / 2 and steps.size < 8):
        return None
    found = float(steps.min())
    for _ in range(3):
        multiples = np.round(steps / found)
        found = float(np.median(steps / multiples))
    if found < 1e-7 * span or np.abs(steps / found - np.round(steps / found)).max() > 0.05:
        return None
    moves = np.round(np.abs(np.diff(values)) / found)
    if np.unique(moves, return_counts=True)[1].max() > 0.8 * moves.size and np.median(moves) > 0.0:
        return None
    return found


def auto_dead_band(signal: Floats) -> float:
    """Dead band that white noise on ``signal`` crosses about once in 1e8 samples: eight standard deviations.

    It never exceeds a twentieth of the signal's range, so that real half cycles are not swallowed.
    """
    return min(8.0 * noise_level(signal), 0.05 * float(np.ptp(signal)))


@njit(cache=True)
def _directions(x, dead_band, out):
    low = high = x[0]
    current = 0
    for i in range(x.size):
        v = x[i]
        if current >= 0 and v > high:
            high = v
            if current == 0 and high - low > dead_band:
                current = 1
        if current <= 0 and v < low:
            low = v
            if current == 0 and high - low > dead_band:
                current = -1
        if current == 1 and high - v > dead_band:
            current = -1
            low = v
        elif current == -1 and v - low > dead_band:
            current = 1
            high = v
        out[i] = current


def directions(x: Floats, dead_band: float = 0.0) -> NDArray[np.int8]:
    """Direction of motion at each sample, shape (n,): +1 up, -1 down, 0 before the first motion.

    A pause keeps the direction. With ``dead_band`` > 0 a turn is seen once the input has come back by more than it.
    """
    out = np.empty(x.size, dtype=np.int8)
    _directions(x, float(dead_band), out)
    return out


def turning_points(x: Floats, dead_band: float = 0.0) -> NDArray[np.intp]:
    """Indices of the extremes of ``x``, its first and last sample included, in ascending order.

    Each returned inner index is where the extreme lies, not where the turn was noticed.
    """
    direction = directions(x, dead_band)
    changes = np.flatnonzero((direction[1:] != direction[:-1]) & (direction[:-1] != 0)) + 1
    points = [0]
    for start, change in zip([0, *changes[:-1].tolist()], changes.tolist(), strict=True) if changes.size else ():
        segment = x[start : change + 1]
        points.append(start + int(np.argmax(segment) if direction[change - 1] > 0 else np.argmin(segment)))
    if points[-1] != x.size - 1:
        points.append(x.size - 1)
    return np.array(points, dtype=np.intp)


def settled_from(x: Floats) -> int:
    """Index of the first sample whose memory no longer depends on an unknown past.

    Once the input has covered its whole range, every operator that the run can tell has been wiped. Where that happens
    only in the second half of the run (growing amplitudes), 0 is returned: too little would be left to learn from.
    """
    running = np.maximum.accumulate(x) - np.minimum.accumulate(x)
    first = int(np.argmax(running >= 0.99 * running[-1]))
    return first if first <= x.size // 2 else 0
