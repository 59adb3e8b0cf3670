"""Further elements of the emulator: for simulators that stops, bristles, a polynomial and rates do not emulate.

Each kind is one that simulators of joints are made of: springs with kinks, rubber, smooth yielding, masses, viscoelasticity,
friction behind a dashpot or a lag, loops that bend with the place.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .operators import dashed, hardening, hyperbolic, leaky, lowpass, pinched, plays, rms, sliding, smooth, yielding

__all__ = [
    "DIFFERENCES",
    "ELASTIC",
    "KINDS",
    "KINKS",
    "MEMORY",
    "RATE",
    "Extent",
    "Further",
    "Kind",
    "Motion",
    "kinks_moved",
    "stronger_of",
    "tangents",
    "torque_of",
    "uncancelled",
]

Floats = NDArray[np.float64]
Further = Mapping[str, Mapping[str, Any]]
"""By kind: ``sizes`` (k, m) and ``weights`` (k,) of its elements."""
ELASTIC, MEMORY, RATE = "elastic", "memory", "rate"
KINKS = "kinks"
PLACES = 49
"""Places of a kink that are tried."""
MOVED = 0.04
"""Relative error of where a kink is or a slider yields."""


def _backward(series: Floats, time: Floats) -> Floats:
    slope = np.zeros_like(series)
    slope[1:] = np.diff(series) / np.diff(time)
    return slope


DIFFERENCES: Mapping[str, Callable[[Floats, Floats], Floats]] = MappingProxyType({
    "central": np.gradient,
    "backward": _backward,
})  # fmt: skip
"""Derivatives of a series by time that simulators take which do not filter."""


@dataclass(frozen=True)
class Motion:
    """An input: time, deflection and its derivatives, shapes (n,), in runs in each of which memory starts anew."""

    time: Floats
    x: Floats
    speed: Floats
    acceleration: Floats
    runs: Sequence[slice]

    def at(self, samples: NDArray[np.intp]) -> Motion:
        """The motion at some samples (k,) only, the first one of each run among them."""
        edges = [np.searchsorted(samples, (run.start, run.stop)) for run in self.runs]
        runs = [slice(int(a), int(b)) for a, b in edges]
        return Motion(self.time[samples], self.x[samples], self.speed[samples], self.acceleration[samples], runs)

    def differenced(self, derivatives: str) -> Motion:
        """The motion with its derivatives as a simulator takes them: ``"central"`` or ``"backward"`` differences, or these."""
        if derivatives not in DIFFERENCES:
            return self
        speed, acceleration = np.empty_like(self.x), np.empty_like(self.x)
        for run in self.runs:
            for series, of in ((speed, self.x), (acceleration, speed)):
                series[run] = DIFFERENCES[derivatives](of[run], self.time[run])
        return replace(self, speed=speed, acceleration=acceleration)

    def from_rest(self, answer: Callable[..., Floats], *others: Floats, **sizes: float) -> Floats:
        """What an operator of given ``sizes`` answers, shape (n,), where each run comes from zero to where it begins.

        It is asked for the deflection and ``others`` (n,) along it.
        """
        answers = []
        for run in self.runs:
            given = [np.concatenate([[0.0], self.x[run]])] + [np.concatenate([o[run][:1], o[run]]) for o in others]
            answers.append(answer(*given, **sizes)[1:])
        return np.concatenate(answers)


@dataclass(frozen=True)
class Extent:
    """What a recording spans: reach (rad) and standard deviation of the speed (rad/s), interval and duration (s)."""

    reach: float
    fast: float
    interval: float
    duration: float

    @property
    def units(self) -> Floats:
        """Of the sizes of a slider with mass: rad, rad/s, 1, rad/s, s; shape (5,)."""
        return np.array([self.reach, 1.0 / self.interval, 1.0, self.fast, self.interval])

    @property
    def rigid(self) -> Floats:
        """The same of friction that knows the speed alone: rad/s, 1, s; shape (3,)."""
        return np.array([self.fast, 1.0, self.interval])

    @property
    def dashed(self) -> Floats:
        """The same of a slider behind a dashpot: rad, 1, 1, s, s, 1; shape (6,)."""
        return np.array([self.reach, 1.0, 1.0, self.interval, self.interval, 1.0])

    @property
    def metal(self) -> Floats:
        """The same of a slider that hardens: rad, 1, rad, 1, rad, 1, rad; shape (7,)."""
        return np.array([self.reach, 1.0, self.reach, 1.0, self.reach, 1.0, self.reach])


@dataclass(frozen=True)
class Kind:
    """One kind of element.

    Attributes
    ----------
    part : str
        ``ELASTIC``, ``MEMORY`` or ``RATE``: what of the simulator it belongs to.
    one_sign : bool
        Whether all weights have the sign of the simulator's other elements with memory.
    sizes : callable
        ``sizes(extent) -> (k, m)`` of the elements to choose from; of those with memory the first is a length, rad.
    columns : callable
        ``columns(motion, sizes) -> (n, k)``, the torque of each for a weight of one.
    between : mapping of int to (float, float)
        Between which values, themselves left out, a size must lie, by its place; none is negative anyway.
    timed : bool
        Whether it is left out where a recording has no clock. Speed is there in any case: it tells the direction.
    together : callable, optional
        ``together(motion, sizes, weights) -> (n,)``, the torque of all, where that takes less than to make each.
    limits : callable, optional
        ``limits(extent) -> (2, m)``, positive, between which sizes are moved to their best places from those to choose
        from, which are not fine enough to be taken as they are.
    """

    part: str
    one_sign: bool
    sizes: Callable[[Extent], Floats]
    columns: Callable[[Motion, Floats], Floats]
    between: Mapping[int, tuple[float, float]] = field(default_factory=dict)
    timed: bool = False
    together: Callable[[Motion, Floats, Floats], Floats] | None = None
    limits: Callable[[Extent], Floats] | None = None

    def torque(self, motion: Motion, sizes: Floats, weights: Floats) -> Floats:
        """Torque of all elements of these sizes and weights, N·m, shape (n,)."""
        return self.together(motion, sizes, weights) if self.together else self.columns(motion, sizes) @ weights

    @property
    def width(self) -> int:
        """How many sizes an element has."""
        return int(self.sizes(Extent(1.0, 1.0, 0.01, 1.0)).shape[1])


def _by_row(column: Callable[..., Floats]) -> Callable[[Motion, Floats], Floats]:
    """Columns made one by one, each from its sizes."""

    def columns(motion: Motion, sizes: Floats) -> Floats:
        return np.column_stack([column(motion, *row) for row in sizes])

    return columns


def _timeless(answer: Callable[..., Floats]) -> Callable[[Motion, Floats], Floats]:
    """Columns of what an operator of given sizes answers to the deflection alone."""
    return _by_row(lambda motion, *sizes: motion.from_rest(lambda x: answer(x, *sizes)))


def _kink(motion: Motion, place: float) -> Floats:
    return np.asarray(np.maximum(motion.x - place, 0.0) if place > 0.0 else np.minimum(motion.x - place, 0.0))


def _rubber(motion: Motion, length: float) -> Floats:
    return length * motion.from_rest(hyperbolic, length=length)


def _stribeck(motion: Motion, length: float, pace: float, excess: float) -> Floats:
    """A LuGre element that yields at a level which falls with speed, by ``pace`` (rad/s), from 1 + ``excess`` to 1."""
    level = 1.0 + excess * np.exp(-np.square(motion.speed / pace))
    return length * motion.from_rest(yielding, level, length=length)


def _by_speed(motion: Motion, pace: float, corner: float, ahead: float) -> Floats:
    """A sign of the speed that grows linearly up to ``pace`` (rad/s), its corners there rounded over ``corner`` of it.

    With wide ones it is a hyperbolic tangent. Engines for rigid bodies look at the speed that will be: ``ahead`` (s) times
    the acceleration more.
    """
    asked = np.array([[1.0], [-1.0]]) * pace + motion.speed + ahead * motion.acceleration
    size = np.abs(asked) / (corner * pace)
    # Logarithms of cosines, for they overflow.
    beyond, before = size + np.log1p(np.exp(-2.0 * size))
    return np.asarray(0.5 * corner * (beyond - before))


def _lag(motion: Motion, constant: float) -> Floats:
    return np.concatenate([lowpass(motion.time[run], motion.x[run], constant) - motion.x[run] for run in motion.runs])


def _leaky(motion: Motion, level: float, constant: float) -> Floats:
    """A spring in series with a dashpot and a slider."""
    return motion.from_rest(lambda x, time: leaky(time, x, level, constant), motion.time)


def _dashed(motion: Motion, *sizes: float) -> Floats:
    """A slider that yields smoothly, with a dashpot and a spring beside it and another dashpot behind all."""
    return motion.from_rest(lambda x, time: dashed(time, x, *sizes), motion.time)


def _plays(motion: Motion, half_widths: Floats) -> tuple[Floats, NDArray[np.intp]]:
    """Plays (n, k) of the different ones of so many half widths, and which of them each is."""
    different, which = np.unique(half_widths, return_inverse=True)
    return np.concatenate([plays(motion.x[run], different) for run in motion.runs]), which


def _stops(motion: Motion, sizes: Floats) -> Floats:
    played, which = _plays(motion, sizes[:, 0])
    return np.asarray(motion.x[:, None] - played[:, which])


def _lagging(motion: Motion, sizes: Floats) -> Floats:
    """What stops change by when each lags behind by a time constant."""
    played, which = _plays(motion, sizes[:, 0])
    stops = motion.x[:, None] - played
    columns = np.empty((motion.x.size, len(sizes)))
    for k, constant in enumerate(sizes[:, 1]):
        stop = stops[:, which[k]]
        for run in motion.runs:
            columns[run, k] = lowpass(motion.time[run], stop[run], constant) - stop[run]
    return columns


def _lagging_together(motion: Motion, sizes: Floats, weights: Floats) -> Floats:
    """Stops with the same time constant lag as one."""
    played, which = _plays(motion, sizes[:, 0])
    total = np.zeros(motion.x.size)
    for constant in np.unique(sizes[:, 1]):
        shared = np.bincount(which, weights * (sizes[:, 1] == constant), played.shape[1])
        stop = motion.x * shared.sum() - played @ shared
        for run in motion.runs:
            total[run] += lowpass(motion.time[run], stop[run], constant) - stop[run]
    return total


def _sliding(motion: Motion, level: float, frequency: float, damping: float, creep: float, late: float) -> Floats:
    """A spring and a dashpot to a mass with dry friction."""
    return motion.from_rest(lambda x, time: sliding(time, x, level, frequency, damping, creep, late), motion.time)


def _curved(motion: Motion, sizes: Floats) -> Floats:
    """Products of powers of plays and of the deflection."""
    played, which = _plays(motion, sizes[:, 0])
    return np.asarray(played[:, which] ** sizes[:, 1] * motion.x[:, None] ** sizes[:, 2])


def _curved_together(motion: Motion, sizes: Floats, weights: Floats) -> Floats:
    """Plays with the same powers are multiplied as one."""
    played, which = _plays(motion, sizes[:, 0])
    total = np.zeros(motion.x.size)
    for powers in np.unique(sizes[:, 1:], axis=0):
        shared = np.bincount(which, weights * np.all(sizes[:, 1:] == powers, axis=1), played.shape[1])
        total += _power(played, powers[0]) @ shared * _power(motion.x, powers[1])
    return total


def _power(base: Floats, exponent: float) -> Floats:
    # Products take far less than powers.
    return np.asarray(np.prod([base] * int(exponent), axis=0) if exponent in (1.0, 2.0, 3.0) else base**exponent)


def _with(lengths: Floats, *others: tuple[float, ...]) -> Floats:
    """Each length with each of the other sizes, shape (k, m)."""
    return np.array([(length, *other) for length in lengths for other in others])


def _smooth_sizes(extent: Extent) -> Floats:
    others = (1.0, 0.75), (1.0, 0.5), (2.0, 1.0), (2.0, 0.75), (2.0, 0.5)
    return _with(extent.reach * np.geomspace(0.02, 1.0, 6), *others)


def _stribeck_sizes(extent: Extent) -> Floats:
    others = itertools.product((0.03 * extent.fast, 0.1 * extent.fast, 0.3 * extent.fast, extent.fast), (0.5, 1.5))
    return _with(extent.reach * np.array([0.004, 0.012, 0.04, 0.12]), *others)


KINDS: Mapping[str, Kind] = MappingProxyType({
    # A stiffer spring that engages, an end stop, a table.
    KINKS: Kind(
        ELASTIC, False,
        lambda extent: extent.reach * np.linspace(-0.96, 0.96, PLACES)[:, None],
        _by_row(_kink),
    ),
    # Rubber: the friction of Berg (Vehicle System Dynamics 30, 1998).
    "rubber": Kind(
        MEMORY, True,
        lambda extent: extent.reach * np.geomspace(0.01, 1.0, 10)[:, None],
        _by_row(_rubber),
    ),
    # Sliders at sharp deflections between those that are there in any case.
    "a few sharp sliders": Kind(
        MEMORY, True,
        lambda extent: extent.reach * np.geomspace(0.02, 1.0, 12)[:, None],
        _stops,
        limits=lambda extent: extent.reach * np.array([[0.003], [3.0]]),
    ),
    "smooth yielding": Kind(
        MEMORY, True,
        _smooth_sizes,
        _timeless(smooth),
        {1: (0.0, np.inf)},
    ),
    "a few smooth sliders": Kind(
        MEMORY, True,
        _smooth_sizes,
        _timeless(smooth),
        {1: (0.0, np.inf)},
        limits=lambda extent: np.array([[0.004 * extent.reach, 1.0, 0.3], [3.0 * extent.reach, 8.0, 3.0]]),
    ),
    # Timber, bolts and concrete: a loop that is slack in its middle.
    "a few pinched sliders": Kind(
        MEMORY, True,
        lambda extent: _with(
            extent.reach * np.geomspace(0.05, 1.0, 5), *itertools.product((1.0, 2.0), (0.75,), (0.5,), (0.1, 0.3), (0.3,))
        ),
        _timeless(pinched),
        {1: (0.0, np.inf), 3: (0.0, 1.0), 5: (0.01, np.inf)},
        limits=lambda extent: np.array([
            [0.02 * extent.reach, 1.0, 0.3, 0.02, 0.005, 0.08], [3.0 * extent.reach, 4.0, 1.5, 0.95, 0.9, 1.5],
        ]),
    ),
    # Dampers of magnetorheological fluid with their accumulator: Spencer et al. (J. Eng. Mech. 123, 1997).
    "a few sliders behind dashpots": Kind(
        MEMORY, True,
        lambda extent: extent.dashed * _with(
            np.geomspace(0.05, 1.0, 4), *itertools.product((1.0, 2.0), (0.75,), (2.0, 10.0, 50.0), (0.3, 3.0), (0.1,))
        ),
        _by_row(_dashed),
        {1: (0.0, np.inf), 3: (0.0, np.inf)},
        timed=True,
        limits=lambda extent: extent.dashed * [
            [0.004, 1.0, 0.3, 0.5, 0.01, 1e-3], [3.0, 8.0, 3.0, 1000.0, 100.0, 10.0],
        ],
    ),
    # Metal that yields: its back stresses recall themselves.
    "a few hardening sliders": Kind(
        MEMORY, True,
        lambda extent: extent.metal * _with(
            np.geomspace(0.01, 0.4, 9), *itertools.product((0.3, 0.8, 2.0), (0.03, 0.1, 0.3), (0.2,), (1.0,), (0.03,), (3.0,))
        ),
        _timeless(hardening),
        {2: (0.0, np.inf), 4: (0.0, np.inf), 6: (0.0, np.inf)},
        limits=lambda extent: extent.metal * [
            [0.003, 0.02, 0.01, 0.01, 0.1, 1e-3, 0.1], [1.0, 10.0, 1.0, 3.0, 10.0, 3.0, 100.0],
        ],
    ),
    # A simulator with Stribeck friction: Canudas de Wit et al. (IEEE TAC 40, 1995).
    "Stribeck friction": Kind(
        MEMORY, True,
        _stribeck_sizes,
        _by_row(_stribeck),
    ),
    "a few Stribeck sliders": Kind(
        MEMORY, True,
        _stribeck_sizes,
        _by_row(_stribeck),
        limits=lambda extent: np.array([
            [0.001 * extent.reach, 0.003 * extent.fast, 0.02], [extent.reach, 5.0 * extent.fast, 6.0],
        ]),
    ),
    # Joints of an engine for rigid bodies (MuJoCo and its like) have mass, damping and dry friction that creeps.
    "a few sliders with mass": Kind(
        MEMORY, True,
        lambda extent: extent.units * _with(
            np.geomspace(0.02, 1.0, 8),
            *itertools.product((0.1, 0.4, 1.6), (0.3, 2.0), (0.003, 0.05), (0.01,)),
        ),
        _by_row(_sliding),
        {1: (0.0, np.inf), 3: (0.0, np.inf)},
        timed=True,
        limits=lambda extent: extent.units * [
            [0.003, 0.02, 0.02, 0.0005, 0.001], [3.0, 6.0, 20.0, 3.0, 50.0],
        ],
    ),
    # Spreadsheets, and engines for rigid bodies asked for the torque of a given motion: the sign of the speed, made smooth.
    "friction by speed": Kind(
        RATE, False,
        lambda extent: extent.rigid * _with(
            np.geomspace(0.0005, 0.3, 12), *itertools.product((0.2, 5.0), (0.003, 0.3))
        ),
        _by_row(_by_speed),
        {0: (0.0, np.inf), 1: (0.0, np.inf)},
        limits=lambda extent: extent.rigid * [[1e-4, 0.05, 1e-3], [3.0, 50.0, 50.0]],
    ),
    "relaxation": Kind(
        RATE, False,
        lambda extent: np.geomspace(4.0 * extent.interval, extent.duration / 3.0, 7)[:, None],
        _by_row(_lag),
    ),
    # A Maxwell arm whose slider gives way, as in dampers of magnetorheological fluid: Spencer et al. (J. Eng. Mech. 123, 1997).
    "leaky sliders": Kind(
        MEMORY, True,
        lambda extent: _with(
            extent.reach * np.geomspace(0.02, 1.2, 8),
            *((constant,) for constant in np.geomspace(3.0 * extent.interval, extent.duration / 10.0, 6)),
        ),
        _by_row(_leaky),
        {1: (0.0, np.inf)},
        timed=True,
    ),
    # Torque that is told late.
    "lagging stops": Kind(
        MEMORY, False,
        lambda extent: _with(
            extent.reach * np.geomspace(0.02, 0.8, 6),
            *((constant,) for constant in np.geomspace(3.0 * extent.interval, extent.duration / 20.0, 5)),
        ),
        _lagging,
        {1: (0.0, np.inf)},
        timed=True,
        together=_lagging_together,
    ),
    "curved plays": Kind(
        MEMORY, False,
        lambda extent: _with(
            extent.reach * np.geomspace(0.009, 0.55, 6), (2.0, 0.0), (3.0, 0.0), (1.0, 2.0), (2.0, 1.0)
        ),
        _curved,
        together=_curved_together,
    ),
})  # fmt: skip


def torque_of(further: Further, motion: Motion, part: str | None = None) -> Floats:
    """Torque of further elements, or of those that are ``part`` of the simulator, N·m, shape (n,)."""
    total = np.zeros(motion.x.size)
    for kind, sizes, weights in _made(further):
        if part in (None, kind.part):
            total += kind.torque(motion, sizes, weights)
    return total


def stronger_of(further: Further, motion: Motion) -> Floats:
    """Change for a relative change by one of the strength of what has memory, at the same stiffness, N·m, shape (n,)."""
    total = np.zeros(motion.x.size)
    for kind, sizes, weights in _made(further):
        if kind.part == MEMORY:
            total += _stretched(kind, motion, sizes) @ weights
    return total


def tangents(further: Further, motion: Motion) -> tuple[Floats, Floats]:
    """Changes for a relative error of one of some parameter, shapes (n, any): of the fine structure and of the bulk."""
    nothing = np.empty((motion.x.size, 0))
    fine, bulk = [nothing], [nothing]
    for kind, sizes, weights in _made(further):
        torque = kind.columns(motion, sizes) * weights
        if kind.limits:
            # Each of these stands for one of the simulator's own, and its sizes for that one's parameters. A slider yields
            # at a quotient of two of them, which may be off by twice as much.
            bulk += [torque, *_either_way(kind, motion, sizes, weights, MOVED, 2.0 * MOVED)]
            bulk += [_stretched(kind, motion, sizes, at) * weights for at in range(1, kind.width)]
        elif kind.one_sign:
            fine += [torque, _stretched(kind, motion, sizes) * weights]
        elif kind.part == ELASTIC:
            bulk += [torque, *_either_way(kind, motion, sizes, weights, MOVED)]
        else:
            # Elements that differ in one size only are one parameter.
            _, group = np.unique(sizes[:, 1:] if sizes.shape[1] > 1 else sizes, axis=0, return_inverse=True)
            bulk.append(uncancelled(torque @ np.eye(group.max() + 1)[group.ravel()]))
            bulk.append((_stretched(kind, motion, sizes) @ weights)[:, None])
    return np.hstack(fine), np.hstack(bulk)


def kinks_moved(motion: Motion, sizes: Floats, weights: Floats) -> Floats:
    """Change of the torque of each kink when its place moves on by one radian, N·m, shape (n, k)."""
    beyond = np.where(sizes[:, 0] > 0.0, motion.x[:, None] > sizes[:, 0], motion.x[:, None] < sizes[:, 0])
    return np.asarray(beyond * -weights)


def uncancelled(columns: Floats) -> Floats:
    """Columns (n, k) of which none is larger than their sum: what cancels is no parameter of the simulator."""
    whole = rms(columns.sum(axis=1))
    sizes = np.sqrt(np.mean(np.square(columns), axis=0))
    return columns * np.minimum(1.0, whole / np.maximum(sizes, 1e-300))


def _made(further: Further) -> Iterator[tuple[Kind, Floats, Floats]]:
    for name, elements in further.items():
        yield KINDS[name], np.asarray(elements["sizes"], dtype=np.float64), np.asarray(elements["weights"])


def _stretched(kind: Kind, motion: Motion, sizes: Floats, at: int = 0) -> Floats:
    """Change of each element for a relative change by one of its size number ``at``, shape (n, k)."""
    up, down = (kind.columns(motion, _scaled(sizes, at, scale)) for scale in (1.05, 0.95))
    return np.asarray((up - down) / 0.1)


def _either_way(kind: Kind, motion: Motion, sizes: Floats, weights: Floats, *errors: float) -> list[Floats]:
    """The same of the first size for errors up and down: where a corner moves it leaves a ramp, each way its own."""
    here = kind.columns(motion, sizes)
    ways = [way * error for error in errors for way in (1.0, -1.0)]
    return [(kind.columns(motion, _scaled(sizes, 0, 1.0 + way)) - here) * weights / way for way in ways]


def _scaled(sizes: Floats, at: int, scale: float) -> Floats:
    return np.asarray(sizes * np.where(np.arange(sizes.shape[1]) == at, scale, 1.0))
