"""A compiled Krasnosel'skii-Pokrovskii kernel: a relay whose switching takes a while."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["kernel"]

Floats = NDArray[np.float64]


@njit(cache=True)
def _kernel(x, begun, width, length, place, out):
    def rising(at):
        return min(max(at - place - width, 0.0), length)

    def falling(at):
        return min(max(at - place, 0.0), length)

    # At rest it is in the middle of what it may be there.
    rest = 0.5 * (rising(0.0) + falling(0.0))
    y = min(max(rest, rising(begun)), falling(begun))
    for i in range(x.size):
        y = min(max(y, rising(x[i])), falling(x[i]))
        out[i] = y - rest


def kernel(x: Floats, width: float, length: float, place: float, begun: float = 0.0) -> Floats:
    """What a kernel adds over ``x`` (n,) to what it is at rest, from a run that begins at ``begun``, shape (n,).

    On the way up it grows with the deflection from ``place`` + ``width`` on by ``length``, on the way back it falls to nothing at
    ``place``, and between the two it stays: Krasnosel'skii and Pokrovskii (Systems with Hysteresis, Springer 1989). All four of
    the unit of ``x``.
    """
    out = np.empty(x.size)
    _kernel(np.ascontiguousarray(x), float(begun), float(width), float(length), float(place), out)
    return out
