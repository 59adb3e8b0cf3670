"""A compiled loop of superelastic alloy, whose force follows a back stress that the phase change draws it to."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["superelastic"]

Floats = NDArray[np.float64]
STEP, MOST = 0.1, 200
"""Way of one step, over that within which the force is drawn to its bounds or the back stress turns; and steps to a sample at most."""


@njit(cache=True)
def _superelastic(x, begun, length, power, after, tail, steepness, out):
    force, before = 0.0, begun
    for i in range(x.size):
        step = x[i] - before
        if step != 0.0:
            way = 1.0 if step > 0.0 else -1.0
            count = min(int(abs(step) * (power * (1.0 + after) / length + steepness) / STEP) + 1, MOST)
            h = step / count
            for k in range(count):
                at = before + (k + 0.5) * h
                over = (force - after * (at - force) - tail * math.erf(steepness * at)) / length
                drawn = abs(over) ** (power - 1.0)
                # Half implicit, or wholly where it is stiff: the force is always drawn back, however far it is away.
                pull = abs(h) * power * drawn * (1.0 + after) / length
                force += h * (1.0 - way * over * drawn) / (1.0 + (0.5 if pull < 1.0 else 1.0) * pull)
        before = x[i]
        out[i] = force


def superelastic(
    x: Floats, length: float, power: float, after: float, tail: float, steepness: float, begun: float = 0.0
) -> Floats:
    """Force of a wire of unit stiffness over ``x`` (n,) from rest at ``begun``, shape (n,).

    It is drawn to within about ``length``, rad, of a back stress, by a ``power`` of how far it is from it. That is ``after`` times
    what is not elastic of the deflection and, beyond 1/``steepness`` (1/rad), ``tail``, rad, which brings the force back when
    it is let go (Graesser and Cozzarelli, J. Eng. Mech. 117, 1991).
    """
    out = np.empty(x.size)
    x = np.ascontiguousarray(x)
    _superelastic(x, float(begun), float(length), float(power), float(after), float(tail), float(steepness), out)
    return out
