"""A compiled loop of steel that yields again and again, each time less sharply: Giuffrè, Menegotto and Pinto's."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["yielding_again"]

Floats = NDArray[np.float64]
SMOOTHEST = 1.0
"""Exponent of the smoothest bend."""
LEAST = 1e-30
"""Way to where asymptotes meet that is none."""


@njit(cache=True)
def _yielding_again(x, yields, hardening, sharpness, most, half, out):
    way = 0.0
    # Where this branch turned round, how far from there its asymptotes meet, and the farthest that was yielded to on either side.
    turned, pulled, elastic = 0.0, 0.0, 0.0
    up, down, before, force = yields, -yields, 0.0, 0.0
    bend = sharpness
    for i in range(x.size):
        moved = x[i] - before
        if moved != 0.0:
            now = 1.0 if moved > 0.0 else -1.0
            if now != way:
                gone = now * yields
                if way == 0.0:
                    elastic, reached = gone, gone
                else:
                    if way > 0.0:
                        up = max(up, before)
                    else:
                        down = min(down, before)
                    turned, pulled = before, force
                    elastic = gone + (turned * hardening - pulled) / (1.0 - hardening)
                    # As it turns round on the asymptote itself.
                    elastic = elastic if elastic != 0.0 else LEAST
                    reached = up if now > 0.0 else down
                way = now
                far = abs(reached - turned - elastic) / yields
                bend = max(sharpness * (1.0 - most * far / (half + far)), SMOOTHEST)
            along = (x[i] - turned) / elastic
            share = hardening * along + (1.0 - hardening) * along / (1.0 + abs(along) ** bend) ** (1.0 / bend)
            force = pulled + elastic * share
        before = x[i]
        out[i] = force


def yielding_again(x: Floats, yields: float, hardening: float, sharpness: float, most: float, half: float) -> Floats:
    """Torque of a bar of unit stiffness over ``x`` (n,) from rest at zero, shape (n,).

    It yields at ``yields``, rad, to the stiffness ``hardening``, by a bend of the exponent ``sharpness`` that becomes up to the
    share ``most`` smaller, half of that where it was yielded to by ``half`` of ``yields`` on that side (Menegotto and Pinto, IABSE
    Symposium, Lisbon, 1973).
    """
    out = np.empty(x.size)
    sizes = float(yields), float(hardening), float(sharpness), float(most), float(half)
    _yielding_again(np.ascontiguousarray(x), *sizes, out)
    return out
