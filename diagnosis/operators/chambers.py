"""A compiled chamber of gas that is compressed by the motion and leaks."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["chamber"]

Floats = NDArray[np.float64]
LEAST = 0.02
"""Least volume of a chamber, over that at rest."""


@njit(cache=True)
def _chamber(time, x, begun, corner, share, pace, exponent, seal, width, out):
    way = 1.0 if share > 0.0 else -1.0
    over, lip, last, before = 0.0, 0.0, begun, max(1.0 + share * begun, LEAST)
    for i in range(x.size):
        volume = max(1.0 + share * x[i], LEAST)
        if volume != before:
            over = (1.0 + over) * (before / volume) ** exponent - 1.0
        dt = time[i] - time[i - 1] if i else 0.0
        over *= np.exp(-dt * pace / (volume * np.sqrt(abs(over) + corner)))
        before = volume
        lip = min(max(lip + (x[i] - last) / width, -1.0), 1.0)
        last = x[i]
        out[i] = seal * abs(over) * lip - way * over


def chamber(
    time: Floats,
    x: Floats,
    corner: float,
    share: float,
    pace: float,
    exponent: float,
    seal: float,
    width: float,
    begun: float = 0.0,
) -> Floats:
    """Torque of a chamber of gas over ``x`` (n,), over that of its pressure at rest at ``begun``, shape (n,).

    Its volume is 1 + ``share`` x, of what it is at zero: a negative share (1/rad) is of one that shrinks as ``x`` grows. It is
    compressed by a polytropic ``exponent``, and leaks at ``pace`` (1/s) times the root of its pressure over that at rest,
    where it is above ``corner``, and in proportion to it below (Beater, Pneumatic Drives, Springer 2007). Its lip seal rubs by
    the share ``seal`` of that pressure, from ``width`` (rad) after a turn on.
    """
    out = np.empty(x.size)
    _chamber(
        np.ascontiguousarray(time), np.ascontiguousarray(x), float(begun), float(corner), float(share), float(pace),
        float(exponent), float(seal), float(width), out,
    )  # fmt: skip
    return out
