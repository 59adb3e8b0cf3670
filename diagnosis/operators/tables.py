"""Compiled curves that are looked up in a table: cubic B-splines about its nodes."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["bumps"]

Floats = NDArray[np.float64]


@njit(cache=True)
def _bumps(x, places, intervals, weights, out):
    for i in range(x.size):
        total = 0.0
        for k in range(places.size):
            d = abs(x[i] - places[k]) / intervals[k]
            if d < 1.0:
                total += weights[k] * (2.0 / 3.0 - d * d * (1.0 - 0.5 * d))
            elif d < 2.0:
                total += weights[k] * (2.0 - d) ** 3 / 6.0
        out[i] = total


def bumps(x: Floats, places: Floats, intervals: Floats, weights: Floats) -> Floats:
    """Sum of cubic B-splines about ``places`` (k,), each four of its ``intervals`` (k,) wide, at ``x`` (n,), shape (n,).

    Those of ``weights`` (k,) one at evenly spaced places add up to one (de Boor, A Practical Guide to Splines, 1978).
    """
    out = np.empty(x.size)
    parts = (x, places, intervals, weights, out)
    _bumps(*(np.ascontiguousarray(part, dtype=np.float64) for part in parts))
    return out
