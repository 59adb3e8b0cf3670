"""A compiled loop of a magnet, whose domains are pinned: Jiles and Atherton's."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["magnetised"]

Floats = NDArray[np.float64]
STEP, MOST = 0.2, 400
"""Way of one step over that within which the domains align or are pinned, and steps to a sample at most."""
COUPLED = 2
"""Fixed-point steps to the field of domains that see each other: each leaves a tenth or less."""
FIRMEST = 0.1
"""Share of the pinning up to which coupling may make it smaller."""
SMALL = 1e-3
"""Argument below which Langevin's function is its slope."""


@njit(cache=True)
def _langevin(u):
    return u / 3.0 if abs(u) < SMALL else 1.0 / math.tanh(u) - 1.0 / u


@njit(cache=True)
def _aligned(x, pinned, total, shape, coupling, free):
    # Where all domains would be without pins, and where they are.
    at = total
    there = 0.0
    for _ in range(COUPLED):
        there = _langevin((x + coupling * at) / shape)
        at = (1.0 - free) * pinned + free * there
    return there, at


@njit(cache=True)
def _slope(way, there, pinned, pinning, coupling):
    apart = there - pinned
    if apart * way <= 0.0:
        return 0.0
    return way * apart / max(pinning - coupling * abs(apart), FIRMEST * pinning)


@njit(cache=True)
def _magnetised(x, begun, pinning, shape, coupling, free, out):
    pinned, before = 0.0, begun
    there, total = _aligned(begun, 0.0, 0.0, shape, coupling, free)
    for i in range(x.size):
        moved = x[i] - before
        if moved != 0.0:
            way = 1.0 if moved > 0.0 else -1.0
            count = min(int(abs(moved) / (STEP * min(pinning, shape))) + 1, MOST)
            h = moved / count
            for k in range(count):
                start = before + k * h
                half = pinned + 0.5 * h * _slope(way, there, pinned, pinning, coupling)
                there, total = _aligned(start + 0.5 * h, half, total, shape, coupling, free)
                step = h * _slope(way, there, half, pinning, coupling)
                # However strongly they pull each other, they go no farther than all would.
                pinned = way * min(way * (pinned + step), max(way * pinned, way * there))
                there, total = _aligned(start + h, pinned, total, shape, coupling, free)
        before = x[i]
        out[i] = 3.0 * shape * total


def magnetised(x: Floats, pinning: float, shape: float, coupling: float, free: float, begun: float = 0.0) -> Floats:
    """Domains along ``x`` (n,) from none aligned at ``begun``, shape (n,), of about unit stiffness where they are not pinned.

    They align within ``shape``, rad, by Langevin's function; walls between them are held by ``pinning``, rad, and the share
    ``free`` of what is left to align bends without being held. Domains see each other by ``coupling``, rad (Jiles and Atherton,
    J. Magn. Magn. Mater. 61, 1986, 48-60).
    """
    out = np.empty(x.size)
    x = np.ascontiguousarray(x)
    _magnetised(x, float(begun), float(pinning), float(shape), float(coupling), float(free), out)
    return out
