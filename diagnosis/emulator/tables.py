"""Springs and friction that a simulator looks up in a table of the deflection: nodes that add up to any smooth curve."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...models.dahl import friction
from ..operators.tables import bumps
from .motion import Extent, Motion

__all__ = ["looked_up", "looked_up_together", "nodes", "rubbing", "rubbing_together"]

Floats = NDArray[np.float64]
INTERVALS = 20
"""Intervals of a table over all that was reached."""


def nodes(extent: Extent) -> Floats:
    """Places of the nodes of a table, rad, and the interval between them, shape (k, 2)."""
    interval = 2.0 * extent.reach / INTERVALS
    places = interval * (np.arange(INTERVALS + 3) - INTERVALS / 2 - 1)
    return np.column_stack([places, np.full(places.size, interval)])


def _within(x: Floats, intervals: Floats) -> Floats:
    """Deflections as far as the table was looked up: what follows is not known, so it goes on as it ends."""
    reach = INTERVALS / 2 * float(np.max(intervals, initial=0.0))
    return np.clip(x, -reach, reach)


def looked_up_together(motion: Motion, sizes: Floats, weights: Floats) -> Floats:
    """A spring with nodes at places, rad, and the intervals between them, of these weights: none at rest."""
    places, intervals = sizes[:, 0], sizes[:, 1]
    at_rest = bumps(np.zeros(1), places, intervals, weights)
    return np.asarray(bumps(_within(motion.x, intervals), places, intervals, weights) - at_rest)


def looked_up(motion: Motion, place: float, interval: float) -> Floats:
    """What one node adds to a spring."""
    return looked_up_together(motion, np.array([[place, interval]]), np.ones(1))


def rubbing_together(motion: Motion, sizes: Floats, weights: Floats) -> Floats:
    """Friction by Dahl laws of a length, rad, and an exponent, as strong as a table says; the interval and the place of each node."""
    total = np.zeros(motion.x.size)
    for length, exponent in np.unique(sizes[:, :2], axis=0):
        at = np.all(sizes[:, :2] == (length, exponent), axis=1)
        strength = bumps(_within(motion.x, sizes[at, 2]), sizes[at, 3], sizes[at, 2], weights[at])
        total += length * strength * motion.from_rest(friction, length=length, exponent=exponent)
    return total


def rubbing(motion: Motion, length: float, exponent: float, interval: float, place: float) -> Floats:
    """What one node adds to friction."""
    return rubbing_together(motion, np.array([[length, exponent, interval, place]]), np.ones(1))
