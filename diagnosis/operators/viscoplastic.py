"""A compiled spring whose slider gives way the faster the farther it is beyond its level."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["viscoplastic"]

Floats = NDArray[np.float64]
PARTS = 3
"""Steps to a sample."""


@njit(cache=True)
def _viscoplastic(time, x, level, tau, power, out):
    f = 0.0
    out[0] = 0.0
    for i in range(1, x.size):
        h, step = (time[i] - time[i - 1]) / PARTS, (x[i] - x[i - 1]) / PARTS
        for _ in range(PARTS):
            f += step
            way = 1.0 if f > 0.0 else -1.0
            over = way * f - level
            if over <= 0.0:
                continue
            # It flows for as long as it is beyond, by the exponential Rosenbrock-Euler method: stable however stiff.
            before = max(over - way * step, 0.0)
            pushed = over - before
            share = pushed / abs(step) if before == 0.0 else 1.0
            flow = (before / level) ** power * level / tau if before > 0.0 else 0.0
            middle = before + 0.5 * max(pushed, 0.0)
            rate = power * (middle / level) ** (power - 1.0) / tau * h * share
            gain = (1.0 - np.exp(-rate)) / rate if rate > 1e-9 else 1.0
            f = way * (level + max(before + gain * (pushed - flow * h * share), 0.0))
        out[i] = f


def viscoplastic(time: Floats, x: Floats, level: float, tau: float, power: float) -> Floats:
    """Stretch of a spring in series with a viscoplastic slider over ``x`` (n,) from rest, shape (n,).

    Beyond ``level`` the slider flows at the speed (over/``level``)^``power`` ``level``/``tau``, of how much the stretch is over it, of the unit of
    ``x``; ``tau`` in s (Perzyna, Advances in Applied Mechanics 9, 1966). Of a power of one it is Bingham's.
    """
    out = np.empty(x.size)
    _viscoplastic(np.ascontiguousarray(time), np.ascontiguousarray(x), float(level), float(tau), float(power), out)
    return out
