"""Input motions: each returns (time, x) with time in s from 0."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

__all__ = ["decaying", "reversals", "sines"]

Floats = NDArray[np.float64]


def reversals(points: Sequence[float], speed: float, rate: float, shift: float = 0.0) -> tuple[Floats, Floats]:
    """Motion at constant speed through a list of turning points.

    Parameters
    ----------
    points : sequence of float
        Start, turning points and end.
    speed : float
        |dx/dt|, units of x per s.
    rate : float
        Samples per s.
    shift : float
        Time of the first sample as a fraction of the sampling interval: other samples of the same motion.
    """
    lengths = np.array([abs(b - a) for a, b in pairwise(points)])
    corners = np.concatenate([[0.0], np.cumsum(lengths) / speed])
    time = (np.arange(int(corners[-1] * rate + 1e-9)) + shift) / rate
    return time - time[0], np.interp(time, corners, points)


def decaying(first: float, last: float, half_cycles: int) -> list[float]:
    """Turning points that alternate in sign and shrink geometrically from ``first`` to ``last``, from zero on."""
    sizes = np.geomspace(first, last, half_cycles)
    return [0.0, *(sizes * np.where(np.arange(half_cycles) % 2 == 0, 1.0, -1.0)).tolist()]


def sines(
    amplitudes: Sequence[float], frequencies: Sequence[float], cycles: Sequence[float], rate: float
) -> tuple[Floats, Floats]:
    """Sines of given amplitude, frequency (Hz) and number of cycles one after another, from zero on.

    Whole numbers of cycles join without a jump.
    """
    pieces = []
    for amplitude, frequency, count in zip(amplitudes, frequencies, cycles, strict=True):
        n = round(count / frequency * rate)
        pieces.append(amplitude * np.sin(2.0 * np.pi * frequency * np.arange(n) / rate))
    x = np.concatenate(pieces)
    return np.arange(x.size) / rate, x
