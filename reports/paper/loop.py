"""The published loop as curves, and the readings of it that the papers' contradictions allow."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...datasets.published_loop import (
    ASCENDING,
    DESCENDING,
    PRINTED_ELEMENTS,
    PRINTED_Q4_TORQUE,
    TRANSITION_NEG,
    TRANSITION_POS,
    VERTICES,
    lower_branch,
    upper_branch,
)

__all__ = [
    "READINGS",
    "Reading",
    "crossing",
    "curve",
    "derived_limits",
    "element_sum",
    "gap_between_curves",
    "printed_limits",
    "slope",
    "slopes",
    "stiffnesses",
]

Floats = NDArray[np.float64]


def slope(first: str, second: str) -> float:
    """Slope between two vertices of Table 1, N·m per unit of x."""
    (x1, y1), (x2, y2) = VERTICES[first], VERTICES[second]
    return (y2 - y1) / (x2 - x1)


def slopes(transition: Floats) -> Floats:
    """Slopes of a transition's crease lines in the order in which motion passes them, shape (N,)."""
    return np.asarray(np.diff(transition[:, 1]) / np.diff(transition[:, 0]))


def stiffnesses(transition: Floats) -> Floats:
    """Element stiffnesses of Eq. 16: differences of successive crease slopes, the last one alone, shape (N,)."""
    crease = slopes(transition)
    return crease - np.append(crease[1:], 0.0)


def printed_limits(transition: Floats) -> Floats:
    """Limit torques of Eq. 17 as printed, at e = e_0: each k_i times its own crease's length, the last times e_0."""
    lengths = np.abs(np.diff(transition[:, 0]))
    lengths[-1] = abs(transition[-1, 0] - transition[0, 0])
    return stiffnesses(transition) * lengths


def derived_limits(transition: Floats) -> Floats:
    """Limit torques that make the element sum pass the vertices: k_i times the distance from the transition's start.

    Element i slips at vertex i + 1 (Eq. 3), so it has been stretched by |x_{i+1} − x_1|; for i = N this is Eq. 17's
    own last line.
    """
    return stiffnesses(transition) * np.abs(transition[1:, 0] - transition[0, 0])


def element_sum(distance: Floats, k: Floats, eta: Floats) -> Floats:
    """Torque that elements give after ``distance`` from rest (Eqs. 2, 3), shape of ``distance``."""
    return np.asarray(np.minimum(np.multiply.outer(distance, k), eta).sum(axis=-1))


def curve(points: Floats, x: Floats) -> Floats:
    """Torque on a polyline of vertices in increasing x."""
    return np.asarray(np.interp(x, points[:, 0], points[:, 1]))


def gap_between_curves(x: Floats) -> Floats:
    """Ascending minus descending curve of Table 1, N·m, where both are defined (x_I to x_C)."""
    return curve(ASCENDING, x) - curve(DESCENDING[::-1], x)


def crossing() -> tuple[Floats, Floats]:
    """Where the ascending curve runs below the descending one: (x of the two crossings, x and depth of the deepest)."""
    low, high = DESCENDING[-1, 0], ASCENDING[-1, 0]
    vertices = np.union1d(ASCENDING[:, 0], DESCENDING[:, 0])
    grid = np.union1d(vertices[(vertices >= low) & (vertices <= high)], np.linspace(low, high, 4001))
    gap = gap_between_curves(grid)
    deepest = int(np.argmin(gap))
    ends = []
    for step in (-1, 1):
        k = deepest
        while gap[k + step] < 0.0:
            k += step
        # The gap is linear between grid points, because all vertices are on the grid.
        ends.append(grid[k] - gap[k] * (grid[k + step] - grid[k]) / (gap[k + step] - gap[k]))
    return np.array(ends), np.array([grid[deepest], gap[deepest]])


@dataclass(frozen=True)
class Reading:
    """One way to read the printed loop: what rising and falling motion follow, vertices in increasing x."""

    id: str
    title: str
    upper: Floats
    lower: Floats

    def torque(self, x: Floats) -> Floats:
        """Torque over a motion that turns at the ends of the loop only, shape (n,); it jumps where a loop stays open."""
        rising = np.gradient(x) >= 0.0
        return np.where(rising, curve(self.upper, x), curve(self.lower, x))


def _with_elements(k: Floats, eta: Floats) -> Floats:
    """Upper branch whose transition is the element sum from C on."""
    start, end = TRANSITION_POS[0], TRANSITION_POS[-1]
    # The sum bends where elements slip and nowhere else.
    bends = np.unique(np.clip(np.concatenate([eta / k, [end[0] - start[0]]]), 0.0, end[0] - start[0]))
    path = np.column_stack([start[0] + bends, start[1] + element_sum(bends, k, eta)])
    return np.vstack([ASCENDING, path])


def _readings() -> tuple[Reading, ...]:
    upper, lower = upper_branch(), lower_branch()
    printed_q = TRANSITION_NEG.copy()
    printed_q[3, 1] = PRINTED_Q4_TORQUE
    k, eta = (np.array(PRINTED_ELEMENTS[name]) for name in ("k", "eta"))
    return (
        Reading("mended", "Tables 1 and 2 with Q4 = −5.62 (the reading of hystbench)", upper, lower),
        Reading("q4-printed", "Q4 = +5.62 as printed", upper, np.vstack([DESCENDING, printed_q[1:]])[::-1]),
        Reading("table-3-printed", "first transition from Table 3's k and η as printed", _with_elements(k, eta), lower),
        Reading(
            "eq-17-printed",
            "first transition from Eqs. 16 and 17 as printed",
            _with_elements(stiffnesses(TRANSITION_POS), printed_limits(TRANSITION_POS)),
            lower,
        ),
        Reading(
            "chords",
            "transitions as straight chords of slopes k+ and k− (Eqs. 11, 12)",
            np.vstack([ASCENDING, TRANSITION_POS[-1:]]),
            np.vstack([DESCENDING, TRANSITION_NEG[-1:]])[::-1],
        ),
    )


READINGS = _readings()
