"""Elements of several kinds of the emulator whose sizes are moved at a time, and how a size is moved."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from ..nonlinear import least
from .kind import Kind

__all__ = ["MORE", "WIDE", "Scale", "Together"]

Floats = NDArray[np.float64]
MORE = 30, 1e-4
"""Steps of the optimiser once all elements are there, and the share by which the last must still make the sum of squares smaller."""
WIDE = 2e-3
"""Step along a size's logarithm for its slope: wide enough to see past the corners where a slider gives way."""
KEPT = 64
"""Columns that are kept: from one derivative to the next only one differs."""


class Scale:
    """Sizes of a kind's elements as what is moved: their logarithms, of those that have a sign their shares of the largest."""

    def __init__(self, kind: Kind, limits: Floats) -> None:
        self._signed, self._unit = np.isin(np.arange(kind.width), kind.signed), limits[1]
        self.moves = ~np.isin(np.arange(kind.width), kind.table)
        """Which sizes are moved at all, shape (m,)."""
        self.shared = list(kind.shared)
        self.ends: Floats = self.logs(limits)

    def logs(self, sizes: Floats) -> Floats:
        """Of sizes (k, m)."""
        return np.where(self._signed, sizes / self._unit, np.log(np.where(self._signed, 1.0, sizes)))

    def sizes(self, logs: Floats) -> Floats:
        """The other way round."""
        return np.where(self._signed, logs * self._unit, np.exp(logs))

    def each(self, moving: NDArray[np.bool_], count: int) -> NDArray[np.bool_]:
        """Which of the sizes of ``count`` elements are moved where those ``moving`` (m,) are, shape (count, m).

        What they share is moved by the first of them.
        """
        which = np.tile(moving, (count, 1))
        which[1:, self.shared] = False
        return which


class Together:
    """Elements of several kinds, all of whose sizes are moved at a time so that they make ``goal`` (rows,) best.

    ``made`` gives the columns of each kind from its sizes, and ``beyond`` what of these the free columns beside them cannot make.
    The weights are eliminated (variable projection: Golub and Pereyra, SIAM J. Numer. Anal. 10, 1973).
    """

    def __init__(
        self,
        scales: Mapping[str, Scale],
        made: Mapping[str, Callable[[Floats], Floats]],
        beyond: Callable[[Floats], Floats],
        goal: Floats,
    ) -> None:
        self._scales, self._goal = scales, goal
        self._column = functools.lru_cache(maxsize=KEPT)(
            lambda name, logs: beyond(made[name](scales[name].sizes(np.array([logs]))))[:, 0]
        )

    def moved(self, placed: Mapping[str, Floats]) -> dict[str, Floats]:
        """Their sizes (k, m) at their best places from those where they were ``placed``."""
        logs = {name: self._scales[name].logs(sizes) for name, sizes in placed.items()}
        moving = [
            (name, k, at)
            for name, rows in logs.items()
            for k, at in np.argwhere(self._scales[name].each(self._scales[name].moves, len(rows))).tolist()
        ]
        low, high = (np.array([self._scales[name].ends[end][at] for name, _, at in moving]) for end in (0, 1))

        def at(values: Floats) -> dict[str, Floats]:
            there = {name: rows.copy() for name, rows in logs.items()}
            for value, (name, k, place) in zip(values.tolist(), moving, strict=True):
                shared = place in self._scales[name].shared
                there[name][slice(None) if shared else k, place] = value
            return there

        last: tuple[bytes, tuple[Floats, Floats, Floats]] = b"", (low, low, low)

        def factored(values: Floats) -> tuple[Floats, Floats, Floats]:
            """The columns and their QR factorisation, kept for the slopes where the residual was just asked for."""
            nonlocal last
            if last[0] != values.tobytes():
                columns = self._columns(at(values))
                last = values.tobytes(), (columns, *np.linalg.qr(columns))
            return last[1]

        def left(values: Floats) -> Floats:
            own = factored(values)[1]
            return np.asarray(self._goal - own @ (own.T @ self._goal))

        def slopes(values: Floats) -> Floats:
            columns, own, upper = factored(values)
            weights = np.linalg.lstsq(upper, own.T @ self._goal, rcond=None)[0]
            changes = np.empty((self._goal.size, values.size))
            # Towards the farther limit.
            for number, step in enumerate(np.where(2.0 * values < low + high, WIDE, -WIDE)):
                further = values.copy()
                further[number] += step
                changes[:, number] = (self._columns(at(further)) - columns) @ weights / step
            return np.asarray(own @ (own.T @ changes) - changes)

        first = np.clip(np.array([logs[name][k, place] for name, k, place in moving]), low, high)
        found, _ = least(left, slopes, first, (low, high), MORE[0], ftol=MORE[1])
        return {name: self._scales[name].sizes(rows) for name, rows in at(found).items()}

    def _columns(self, logs: Mapping[str, Floats]) -> Floats:
        return np.column_stack([self._column(name, tuple(row)) for name in logs for row in logs[name].tolist()])
