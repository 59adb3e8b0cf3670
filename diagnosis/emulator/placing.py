"""Elements of the emulator whose sizes are moved to where they emulate best: a grid would have to be too fine."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from ..nonlinear import least
from .kind import Kind
from .motion import Extent, Motion
from .selection import CLEARLY, EXACT, WORTHWHILE
from .together import MORE, WIDE, Scale, Together

__all__ = ["Choices", "Placing"]

Floats = NDArray[np.float64]
MOST, MANY = 4, 8
"""Elements that are placed at most; and of those that share all sizes but one."""
NODES = 32
"""Nodes of a table of which columns are kept."""
ALIKE = 0.8
"""Correlation of two elements from which both would lead to the same."""
STEPS = 10, 3e-3
"""Steps of the optimiser for each element that is added, and the share by which the last must still make the sum of squares smaller."""
ROWS = 1400
"""Samples that are enough to place elements by."""
RIDGE = 1e-8
"""Strength of the ridge on the columns beside them."""
HOPELESS, COSTLY, HIDDEN = 0.97, 0.95, 0.9
"""What the best element to choose from leaves of the error where moving it is not worth the time; of the first of those that know
time, and of kinds that would be evident."""
EVIDENTLY = 0.65
"""What one more element of the latter must leave of the error at most."""
TOGETHER, TRIED_AT_ONCE, NOTHING = 0.6, 3, 1e-3
"""What many of those to choose from must leave of the error at most for these to be moved, how many ways to share what they share
are tried, and the weight, over the largest one, below which one is left out."""
RICH, POOR = 8, 0.01
"""From so many sizes on an element is looked for only where so much of the error is left."""


class Choices:
    """Those elements of each kind of which to choose some, along a ``motion`` of a recording that spans ``extent``.

    They are the same whatever stands beside them, so that they are made once however often it is asked for elements.
    """

    def __init__(self, extent: Extent, motion: Motion) -> None:
        self.extent, self.motion = extent, motion
        self.rows = _rows(motion)
        # What is not known is memory all the same.
        self._thin = motion.at(self.rows)
        self._made: dict[str, tuple[Floats, Floats]] = {}

    def columns_of(self, kind: Kind) -> Callable[[Floats], Floats]:
        """What makes elements of a kind from their sizes, on the ``rows`` by which they are placed."""
        if kind.timed or kind.by_speed or kind.all_along:
            return lambda sizes: kind.columns(self.motion, sizes)[self.rows]
        # Most of what knows neither time nor speed needs only the turns of the motion.
        return lambda sizes: kind.columns(self._thin, sizes)

    def limits_of(self, kind: Kind) -> Floats:
        """Between which sizes elements of a kind may be moved, shape (2, m)."""
        assert kind.limits is not None
        return kind.limits(self.extent)

    def of(self, name: str, kind: Kind) -> tuple[Floats, Floats]:
        """Sizes (k, m) of a kind and their columns (rows, k)."""
        if name not in self._made:
            sizes = np.clip(kind.sizes(self.extent), *self.limits_of(kind))
            self._made[name] = sizes, self.columns_of(kind)(sizes)
        return self._made[name]


class Placing:
    """Elements that emulate ``target`` (n,) where it is ``known`` best, of those that may be chosen and moved.

    The weights of those that must have one sign have that of ``sign``.
    """

    def __init__(self, choices: Choices, target: Floats, known: NDArray[np.bool_], sign: float) -> None:
        self._choices, self._target, self._sign = choices, target, sign
        self._kept = known[choices.rows]
        self._rows = choices.rows[self._kept]

    def placed(self, kinds: Mapping[str, Kind], beside: Floats, enough: float = EXACT) -> dict[str, Floats]:
        """Elements of each of these kinds that do so beside free columns (n, any), until that is ``enough``.

        Returns their sizes (k, m) by the kind's name, those with fewer sizes first. Those that are not clearly better than a
        kind before them are left out, and those that are asked last where they are no better.
        """
        beyond = self._beyond(beside)
        goal = self._goal(beyond)

        def maker_of(name: str, kind: Kind, wanted: float) -> _Maker:
            made, limits = self._choices.columns_of(kind), self._choices.limits_of(kind)
            sizes, columns = self._choices.of(name, kind)
            sign = self._sign if kind.one_sign else 0.0
            tried = sizes, beyond(columns[self._kept])
            return _Maker(kind, limits, tried, lambda sizes: beyond(made(sizes)[self._kept]), goal, sign, wanted)

        better: dict[str, Floats] = {}
        useless: set[str] = set()
        least = float(np.linalg.norm(goal))
        for name, kind in sorted(kinds.items(), key=lambda each: (each[1].last, each[1].width)):
            if least < enough:
                break
            # A rich one would take most of the time for what is small already.
            if (kind.width >= RICH and least < POOR) or kind.like in useless:
                continue
            wanted = (1.0 if kind.last else CLEARLY) * least
            sizes, error = maker_of(name, kind, wanted).made()
            if not sizes.size:
                useless.add(name)
            elif error < wanted:
                better[name], least = sizes, error
        return better

    def settled(self, kinds: Mapping[str, Kind], placed: Mapping[str, Floats], beside: Floats) -> dict[str, Floats]:
        """Elements of several kinds, ``placed`` one kind beside another, with all their sizes (k, m) moved together."""
        beyond = self._beyond(beside)
        together = Together(
            {name: Scale(kinds[name], self._choices.limits_of(kinds[name])) for name in placed},
            {name: self._choices.columns_of(kinds[name]) for name in placed},
            lambda columns: beyond(columns[self._kept]),
            self._goal(beyond),
        )
        return together.moved(placed)

    def _beyond(self, beside: Floats) -> Callable[[Floats], Floats]:
        """What of some columns (rows, any) those ``beside`` (n, any) cannot make."""
        rows = self._rows
        others = beside[rows] / np.maximum(np.std(beside[rows], axis=0), 1e-300)
        ridge = np.sqrt(RIDGE * len(others)) * np.eye(others.shape[1])
        basis = np.linalg.qr(np.vstack([others, ridge]))[0]
        seen = np.ascontiguousarray(basis[: len(others)].T)

        def beyond(columns: Floats) -> Floats:
            left = basis @ (seen @ -columns)
            left[: len(columns)] += columns
            return np.asarray(left)

        return beyond

    def _goal(self, beyond: Callable[[Floats], Floats]) -> Floats:
        """What is to be emulated beside them, over the size of all."""
        size = max(float(np.std(self._target)), 1e-300) * np.sqrt(self._rows.size)
        return beyond(self._target[self._rows, None])[:, 0] / size


def _rows(motion: Motion) -> NDArray[np.intp]:
    """Samples spread over the motion: of each block the highest and the lowest, for memory is of the turns."""
    block = 2 * max(motion.x.size // ROWS, 1)
    rows = []
    for run in motion.runs:
        for start in range(run.start, run.stop, block):
            part = motion.path[start : min(start + block, run.stop)]
            rows += [start + int(np.argmin(part)), start + int(np.argmax(part))]
        rows.append(run.start)
    return np.unique(rows)


class _Maker:
    """Elements of one kind, all of whose sizes are moved by least squares, on a scale of logarithms but for signed ones.

    The weights are eliminated from it (variable projection: Golub and Pereyra, SIAM J. Numer. Anal. 10, 1973).
    """

    def __init__(
        self,
        kind: Kind,
        limits: Floats,
        choices: tuple[Floats, Floats],
        columns: Callable[[Floats], Floats],
        goal: Floats,
        sign: float,
        wanted: float,
    ) -> None:
        self._scale = Scale(kind, limits)
        self._low, self._high = self._scale.ends
        self._first = ~np.isin(np.arange(self._low.size), kind.later)
        self._moves, self._shared = self._scale.moves, self._scale.shared
        self._is_table, self._many = bool(kind.table), kind.many
        self._most = MANY if kind.shared else MOST
        self._evident, self._tries, self._pairs = kind.evident, kind.starts, kind.pairs
        self._hopeless_at_first = HIDDEN if kind.evident else COSTLY if kind.timed else HOPELESS
        self._worthwhile = EVIDENTLY if kind.evident else WORTHWHILE
        self._starts, self._tried = self._scale.logs(choices[0]), choices[1]
        self._goal = goal
        self._sign = sign
        self._wanted = wanted
        # From one derivative to the next only the sizes of one element differ.
        self._column = functools.lru_cache(maxsize=2 * (NODES if kind.table or kind.many else self._most))(
            lambda logs: columns(self._sizes(np.array(logs)))[:, 0]
        )
        self._at = np.full(1, np.nan)

    def _columns(self, logs: Floats) -> Floats:
        made = [self._column(tuple(row)) for row in logs.reshape(-1, self._low.size).tolist()]
        return np.column_stack(made) if made else np.empty((self._goal.size, 0))

    def _left(self, logs: Floats) -> Floats:
        own = self._factors(logs)[1]
        return np.asarray(self._goal - own @ (own.T @ self._goal))

    def _factors(self, logs: Floats) -> tuple[Floats, Floats, Floats]:
        """The columns and their QR factorisation, kept for the slopes where the residual was just asked for."""
        if not np.array_equal(logs.ravel(), self._at):
            columns = self._columns(logs)
            self._factored = columns, *np.linalg.qr(columns)
            self._at = logs.ravel().copy()
        return self._factored

    def made(self) -> tuple[Floats, float]:
        """Sizes (k, m) of as many elements as are worthwhile, and the error that they leave."""
        if self._is_table:
            return self._table_made()
        if self._many:
            return self._many_made()
        logs, error = self._grown(np.empty(0), float(np.linalg.norm(self._goal)))
        if self._shared and logs.size > self._low.size and error > EXACT:
            # What they share is not found by a few of them where there are many.
            begun = self._at_once()
            if begun.size:
                together = self._grown(*self._moved(begun, STEPS, self._first))
                logs, error = min((logs, error), together, key=lambda found: found[1])
        if self._pairs and error > EXACT:
            begun = self._best_pair()
            if begun.size:
                together = self._grown(*self._moved(begun, STEPS, self._first))
                logs, error = min((logs, error), together, key=lambda found: found[1])
        if logs.size and error > EXACT:
            logs, error = self._moved(logs, MORE, self._moves)
        return self._of_one_sign(logs, error) if logs.size and self._sign else (self._sizes(logs), error)

    def _table_made(self) -> tuple[Floats, float]:
        """The same of a table, whose nodes are all there."""
        begun = self._at_once()
        if not begun.size:
            return self._sizes(begun), float(np.linalg.norm(self._goal))
        return self._of_one_sign(*self._moved(begun, MORE, self._moves))

    def _grown(self, logs: Floats, error: float) -> tuple[Floats, float]:
        """Elements to which others are added as long as each helps much: logarithms of sizes (any,), and the error that they leave."""
        best = 1.0
        for others in reversed(range(self._most - logs.size // self._low.size)):
            more, smaller = self._added(logs)
            if self._sign and smaller <= self._worthwhile * error:
                # What helps only by a weight that it must not have leads nowhere.
                smaller = self._weighed(more)[1]
            if smaller > self._worthwhile * error:
                break
            logs, error, best = more, smaller, min(best, smaller / error)
            # So many others as good as the best so far would not make it.
            if error < EXACT or error * best**others > self._wanted:
                break
        return logs, error

    def _many_made(self) -> tuple[Floats, float]:
        """The same of many: those that help together, where they do."""
        error = float(np.linalg.norm(self._goal))
        begun = [logs for left, logs in self._begun_at_once()[:TRIED_AT_ONCE] if logs.size and left < TOGETHER * error]
        moved = min(
            (self._settled(logs, STEPS) for logs in begun), key=lambda each: each[1], default=(np.empty(0), error)
        )
        logs, left = self._settled(moved[0], MORE) if moved[0].size else (moved[0], error)
        return self._sizes(logs), left

    def _settled(self, logs: Floats, steps: tuple[int, float]) -> tuple[Floats, float]:
        """Those that are left of many when all are moved, and the error that they leave."""
        moved, _ = self._moved(logs, steps, self._moves)
        weights, left = self._weighed(moved)
        return moved.reshape(-1, self._low.size)[weights > NOTHING * np.max(weights)].ravel(), left

    def _at_once(self) -> Floats:
        """Those to choose from that share what they do and help most together: logarithms of sizes (any,)."""
        return self._begun_at_once()[0][1]

    def _begun_at_once(self) -> list[tuple[float, Floats]]:
        """The same of every way to share it, the best first, each after the error that it leaves."""
        _, group = np.unique(self._starts[:, self._shared], axis=0, return_inverse=True)
        groups = [np.flatnonzero(group.ravel() == k) for k in range(int(group.max()) + 1)]
        found = [nnls(self._sign * self._tried[:, members], self._goal) for members in groups]
        ways = [
            (float(left), np.asarray(self._starts[members[weights > 0.0]].ravel()))
            for members, (weights, left) in zip(groups, found, strict=True)
        ]
        return sorted(ways, key=lambda each: each[0])

    def _sizes(self, logs: Floats) -> Floats:
        return self._scale.sizes(logs.reshape(-1, self._low.size))

    def _of_one_sign(self, logs: Floats, error: float) -> tuple[Floats, float]:
        """Those elements whose weights have the sign that they must have, and the error that they leave."""
        weights, left = self._weighed(logs)
        kept = weights > 0.0
        return (self._sizes(logs), error) if np.all(kept) else (self._sizes(logs)[kept], left)

    def _weighed(self, logs: Floats) -> tuple[Floats, float]:
        """Weights (k,) of elements that have the sign that they must have, without it, and the error that is left with them."""
        _, own, upper = self._factors(logs)
        inside = own.T @ self._goal
        weights, left = nnls(self._sign * upper, inside)
        outside = float(self._goal @ self._goal - inside @ inside)
        return weights, float(np.sqrt(max(outside, 0.0) + left**2))

    def _moved(self, logs: Floats, steps: tuple[int, float], moving: NDArray[np.bool_]) -> tuple[Floats, float]:
        """Those sizes of each element that are ``moving`` (m,) moved from ``logs`` (any,) on in so many steps (see ``STEPS``), and the error."""
        rows = logs.reshape(-1, self._low.size).copy()
        which = self._scale.each(moving, len(rows))
        within = np.tile(self._low, (len(rows), 1))[which], np.tile(self._high, (len(rows), 1))[which]

        def at(moved: Floats) -> Floats:
            rows[which] = moved
            rows[:, self._shared] = rows[0, self._shared]
            return rows

        def left(moved: Floats) -> Floats:
            return self._left(at(moved).ravel())

        def slopes(moved: Floats) -> Floats:
            return self._slopes(at(moved), which)

        found, error = least(left, slopes, rows[which], within, steps[0], ftol=steps[1])
        return at(found).ravel(), float(np.linalg.norm(error))

    def _slopes(self, logs: Floats, which: NDArray[np.bool_]) -> Floats:
        """Slopes of what is left by each size that moves (rows, any), their weights held (Kaufman, BIT 15, 1975)."""
        columns, own, upper = self._factors(logs)
        weights = np.linalg.lstsq(upper, own.T @ self._goal, rcond=None)[0]
        # Towards the farther limit.
        steps = np.where(2.0 * logs < self._low + self._high, WIDE, -WIDE)

        def change(k: int, at: int) -> Floats:
            there = logs[k].copy()
            there[at] += steps[k, at]
            return np.asarray(weights[k] * (self._column(tuple(there.tolist())) - columns[:, k]) / steps[k, at])

        everyone = range(len(logs))
        made = np.column_stack([
            np.sum([change(other, at) for other in everyone], axis=0) if at in self._shared else change(k, at)
            for k, at in np.argwhere(which).tolist()
        ])  # fmt: skip
        return np.asarray(own @ (own.T @ made) - made)

    def _added(self, logs: Floats) -> tuple[Floats, float]:
        """The same with one element more, from where it helps most; without it where it hardly helps."""
        left, basis = self._left(logs), self._factors(logs)[1]
        beyond = self._tried - basis @ (basis.T @ self._tried)
        size, own = np.sum(np.square(beyond), axis=0), np.sum(np.square(self._tried), axis=0)
        along = left @ beyond
        seen = size > 1e-6 * own
        if self._evident:
            seen &= self._sign * along >= 0.0
        gain = np.where(seen, np.square(along) / np.maximum(size, 1e-300), 0.0)
        error = float(np.linalg.norm(left))
        hopeless = HOPELESS if logs.size else self._hopeless_at_first
        if np.max(gain) < (1.0 - hopeless**2) * error**2:
            return logs, error
        found = [self._moved(self._begun(logs, at), STEPS, self._first) for at in _unlike(beyond, gain, self._tries)]
        return min(found, key=lambda each: each[1])

    def _best_pair(self) -> Floats:
        """Those two to choose from that help most together: logarithms of sizes (any,), none where these hardly help."""
        unit = self._tried / np.maximum(np.linalg.norm(self._tried, axis=0), 1e-300)
        along, alike = self._goal @ unit, unit.T @ unit
        # What each pair takes of the goal, by the inverse of their products.
        first, second = np.triu_indices(along.size, 1)
        between = np.where(np.abs(alike) < ALIKE, alike, np.nan)[first, second]
        gain = np.square(along[first]) + np.square(along[second]) - 2.0 * between * along[first] * along[second]
        gain = np.nan_to_num(gain / (1.0 - np.square(between)))
        best = int(np.argmax(gain))
        if gain[best] < (1.0 - HOPELESS**2) * float(self._goal @ self._goal):
            return np.empty(0)
        return np.asarray(self._starts[[first[best], second[best]]].ravel())

    def _begun(self, logs: Floats, at: int) -> Floats:
        """Those elements and one more to choose from, which shares what they share."""
        rows = np.vstack([logs.reshape(-1, self._low.size), self._starts[at]])
        rows[:, self._shared] = rows[0, self._shared]
        return rows.ravel()


def _unlike(columns: Floats, gain: Floats, count: int) -> list[int]:
    """Of columns (n, k) those ``count`` of the largest ``gain`` (k,) that are not nearly the same."""
    unit = columns / np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
    taken: list[int] = []
    for at in np.argsort(-gain).tolist():
        if np.all(np.abs(unit[:, taken].T @ unit[:, at]) < ALIKE):
            taken.append(at)
        if len(taken) == count:
            break
    return taken
