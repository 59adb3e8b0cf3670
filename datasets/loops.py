"""The loops that a recording's input closes, found by rainflow counting over its turning points.

Endo's four-point rule (ASTM E1049): a loop is closed once the input has come back to where it turned. Loops between the
same two inputs make a class.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

__all__ = ["Loop", "classes", "closed_loops", "open_loop"]

Floats = NDArray[np.float64]

BINS = 24
"""Points along each branch at which loops are compared."""

SAME_INPUT = 0.02
"""Loops whose ends differ by less than this share of their swing are of one class."""

SHORT = 0.03
"""A loop counts as closed if the input comes back to within this share of its swing."""


@dataclass(frozen=True)
class Loop:
    """One closed loop.

    Attributes
    ----------
    start, turn, end : int
        Samples at which it opens, turns and is closed again.
    low, high : float
        The inputs between which it lies.
    speed : float
        Mean speed.
    area : float
        ∮ y dx: positive for a clockwise loop.
    level, height : float
        Mean output of both branches; rise over the swing of the line through both.
    gap : float
        Output where the loop is closed minus output where it was opened; NaN where the input just fell short of it.
    nested : bool
        Whether it lies within a larger half cycle that goes on after it.
    simple : bool
        Whether it has two turns only, so no smaller loops within.
    up, down : array, shape (BINS,)
        Output along the rising and the falling branch, at even inputs from low to high.
    """

    start: int
    turn: int
    end: int
    low: float
    high: float
    speed: float
    area: float
    level: float
    height: float
    gap: float
    nested: bool
    simple: bool
    up: Floats
    down: Floats

    @property
    def swing(self) -> float:
        return self.high - self.low

    @property
    def range(self) -> float:
        """Range of the output over both branches."""
        return float(max(np.ptp(np.concatenate([self.up, self.down])), 1e-300))

    @property
    def half_width(self) -> float:
        """Half the mean distance of the branches."""
        return 0.5 * self.area / self.swing

    @property
    def crossing(self) -> float:
        """Share of the area between the branches that has the other sense of rotation, 0 to 0.5."""
        difference = self.down - self.up
        parts = np.array([difference[difference > 0.0].sum(), -difference[difference < 0.0].sum()])
        return float(parts.min() / parts.sum()) if parts.sum() > 0.0 else 0.0

    @property
    def waist(self) -> float:
        """Mean distance of the branches over the middle third of the input over that of the outer thirds."""
        apart = np.abs(self.down - self.up)
        third = BINS // 3
        outer = float(np.concatenate([apart[:third], apart[-third:]]).mean())
        return float(apart[third:-third].mean()) / max(outer, 1e-300)

    @property
    def asymmetry(self) -> float:
        """RMS difference of the rising branch and the falling one turned by half a turn, over the loop's output range."""
        both = np.concatenate([self.up, self.down])
        odd = self.up + self.down[::-1] - 2.0 * both.mean()
        return float(np.sqrt(np.mean(odd**2)) / self.range)


def closed_loops(time: Floats, x: Floats, y: Floats, turns: NDArray[np.intp]) -> list[Loop]:
    """The loops that the input closes, each once, in the order of closing.

    Parameters
    ----------
    time, x, y : array, shape (n,)
    turns : array of int
        Turning points of x, first and last sample included.
    """
    found = []
    stack: list[int] = []  # places in turns
    for place in range(turns.size):
        stack.append(place)
        while len(stack) >= 3:
            p, q, r = (int(turns[k]) for k in stack[-3:])
            inner, last = abs(x[q] - x[p]), abs(x[r] - x[q])
            if last < (1.0 - SHORT) * inner:
                break
            if len(stack) > 3:
                outer = abs(x[p] - x[turns[stack[-4]]])
                if outer < (1.0 - SHORT) * inner:
                    break
                nested = min(outer, last) > (1.0 + SHORT) * inner
            elif last > (1.0 + SHORT) * inner:
                # Opened at the first turn and left beyond it: nothing says where its output should have been.
                del stack[-3]
                continue
            else:
                nested = False
            loop = _loop(time, x, y, p, q, r, nested, simple=stack[-1] - stack[-3] == 2)
            if loop is not None:
                found.append(loop)
            del stack[-3:-1]
    return found


def _loop(time: Floats, x: Floats, y: Floats, p: int, q: int, r: int, nested: bool, simple: bool) -> Loop | None:
    way = 1.0 if x[p] > x[q] else -1.0
    swing = abs(x[p] - x[q])
    beyond = np.flatnonzero(way * (x[q : r + 1] - x[p]) >= 0.0)
    end = q + int(beyond[0]) if beyond.size else r
    if min(q - p, end - q) < 4:
        return None
    low, high = (float(x[q]), float(x[p])) if way > 0.0 else (float(x[p]), float(x[q]))
    first, second = _branch(x[p : q + 1], y[p : q + 1], low, high), _branch(x[q : end + 1], y[q : end + 1], low, high)
    up, down = (second, first) if way > 0.0 else (first, second)
    part = slice(p, end + 1)
    # The way from the last sample straight to the first closes the contour.
    xs, ys = np.append(x[part], x[p]), np.append(y[part], y[p])
    return Loop(
        simple=simple,
        start=p,
        turn=q,
        end=end,
        low=low,
        high=high,
        speed=float(2.0 * swing / (time[end] - time[p])),
        area=float(np.sum(0.5 * (ys[1:] + ys[:-1]) * np.diff(xs))),
        level=float(0.5 * (up.mean() + down.mean())),
        height=float(BINS * np.polyfit(np.arange(BINS), 0.5 * (up + down), 1)[0]),
        gap=_gap(x, y, p, q, end, way, swing),
        nested=nested,
        up=up,
        down=down,
    )


def open_loop(time: Floats, x: Floats, y: Floats, turns: NDArray[np.intp]) -> Loop | None:
    """What the two last half cycles have in common where the input never came back to a turn: sense and width are there."""
    best = None
    for p, q, r in zip(turns[:-2].tolist(), turns[1:-1].tolist(), turns[2:].tolist(), strict=True):
        way = 1.0 if x[r] > x[q] else -1.0
        inside = np.arange(p, q + 1)[way * (x[p : q + 1] - x[r]) <= 0.0]
        start = int(inside[0]) if inside.size else p
        loop = _loop(time, x, y, start, q, r, nested=True, simple=True)
        if loop is not None and (best is None or loop.swing > best.swing):
            best = replace(loop, gap=float("nan"))
    return best


def _gap(x: Floats, y: Floats, p: int, q: int, end: int, way: float, swing: float) -> float:
    """Output where the loop closes minus that where it opened, both from lines over the last twentieth of the swing.

    Lines over several samples keep noise small and find the output at exactly the input of the turn.
    """
    if way * (x[end] - x[p]) < -0.01 * swing:
        return float("nan")
    near = np.arange(q, end + 1)[way * (x[q : end + 1] - x[p]) >= -0.05 * swing]
    before = p - np.arange(1, 4 * near.size + 8)
    before = before[before >= 0]
    # The way that led to the turn: the same branch as the one that comes back to it.
    stop = np.flatnonzero((way * (x[before] - x[p]) < -0.05 * swing) | (way * (x[before] - x[p]) > 0.01 * swing))
    before = before[: stop[0]] if stop.size else before
    opened = _at(x[before], y[before], x[p]) if before.size >= 3 else float(y[p])
    return _at(x[near], y[near], x[p]) - opened


def _at(x: Floats, y: Floats, place: float) -> float:
    """The line through the samples, read off at ``place``."""
    if x.size < 3 or np.ptp(x) == 0.0:
        return float(y[-1])
    slope = float(np.cov(x, y)[0, 1] / np.var(x, ddof=1))
    return float(y.mean() + slope * (place - x.mean()))


def _branch(x: Floats, y: Floats, low: float, high: float) -> Floats:
    """Mean output at ``BINS`` even inputs, shape (BINS,)."""
    place = np.clip(((x - low) / (high - low) * BINS).astype(int), 0, BINS - 1)
    count = np.bincount(place, minlength=BINS)
    filled = np.flatnonzero(count)
    sums = [np.bincount(place, weights=v, minlength=BINS)[filled] / count[filled] for v in (x, y)]
    order = np.argsort(sums[0])
    grid = low + (high - low) * (np.arange(BINS) + 0.5) / BINS
    return np.interp(grid, sums[0][order], sums[1][order])


def classes(loops: Sequence[Loop]) -> list[list[Loop]]:
    """Loops between the same inputs, the class with the largest swing first."""
    found: list[list[Loop]] = []
    for loop in sorted(loops, key=lambda one: (-one.swing, one.start)):
        for members in found:
            first = members[0]
            if max(abs(first.low - loop.low), abs(first.high - loop.high)) <= SAME_INPUT * first.swing:
                members.append(loop)
                break
        else:
            found.append([loop])
    return [sorted(members, key=lambda one: one.start) for members in found]
