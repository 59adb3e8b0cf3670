"""An input as the emulator's elements see it, and what a recording of it spans."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

__all__ = ["DIFFERENCES", "Extent", "Motion"]

Floats = NDArray[np.float64]


def _backward(series: Floats, time: Floats) -> Floats:
    slope = np.zeros_like(series)
    slope[1:] = np.diff(series) / np.diff(time)
    return slope


SAME = 1e-9
"""Change of a difference between two samples, over the stroke, that is only rounding."""
SUMMED = "central, summed up"
DIFFERENCES: Mapping[str, Callable[[Floats, Floats], Floats]] = MappingProxyType({
    "central": np.gradient,
    "backward": _backward,
    SUMMED: np.gradient,
})  # fmt: skip
"""Derivatives of a series by time that simulators take which do not filter; memory may sum the speeds up instead of looking at the
deflection."""


def _overshoots(path: Floats, change: Floats) -> NDArray[np.bool_]:
    """Between which two samples, shape (n - 1,), a ``path`` (n,) that differs by a ``change`` from a spline may go beyond both.

    Where it turns itself, or differs by the same now and next: what a clearance holds does not turn wherever the spline does.
    """
    step = np.diff(path)
    alike = np.append(np.abs(np.diff(change)) <= SAME * np.ptp(path), True)
    turns = np.zeros(step.size, dtype=np.bool_)
    turns[1:-1] = step[:-2] * step[2:] < 0.0
    return np.asarray(turns | (alike[:-1] & alike[1:]))


@dataclass(frozen=True)
class Motion:
    """An input: time and deflection, shapes (n,), in runs in each of which memory starts anew, and its derivatives."""

    time: Floats
    x: Floats
    runs: Sequence[slice]
    slopes: Callable[[], tuple[Floats, Floats]]
    """Gives speed and acceleration, shapes (n,), once they are asked for: many simulators never do."""
    course: Floats | None = None
    """The deflection as the simulator's memory knows it, where it differs."""
    recorded: Floats | None = None
    """The deflection that was recorded, where another one is only known at the same samples: it may have corners between them."""

    @property
    def speed(self) -> Floats:
        return self._slopes[0]

    @property
    def acceleration(self) -> Floats:
        return self._slopes[1]

    @functools.cached_property
    def _slopes(self) -> tuple[Floats, Floats]:
        return self.slopes()

    @property
    def path(self) -> Floats:
        """The deflection as what has memory knows it, shape (n,)."""
        return self.x if self.course is None else self.course

    def at(self, samples: NDArray[np.intp]) -> Motion:
        """The motion at some samples (k,) only, the first one of each run among them."""
        edges = [np.searchsorted(samples, (run.start, run.stop)) for run in self.runs]
        runs = [slice(int(a), int(b)) for a, b in edges]
        course, recorded = (None if part is None else part[samples] for part in (self.course, self.recorded))
        return Motion(
            self.time[samples], self.x[samples], runs, lambda: (self.speed[samples], self.acceleration[samples]),
            course, recorded,
        )  # fmt: skip

    def differenced(self, derivatives: str) -> Motion:
        """The motion with its derivatives as a simulator takes them, one of ``DIFFERENCES``; of any other name with these."""
        if derivatives not in DIFFERENCES:
            return self
        speed, acceleration = np.empty_like(self.x), np.empty_like(self.x)
        for run in self.runs:
            for series, of in ((speed, self.x), (acceleration, speed)):
                series[run] = DIFFERENCES[derivatives](of[run], self.time[run])
        seen = replace(self, slopes=lambda: (speed, acceleration))
        return seen._summed_up() if derivatives == SUMMED else seen

    def _summed_up(self) -> Motion:
        """The motion for memory that sums the speeds up, as explicit simulators of friction do."""
        summed = self.path.copy()
        for run in self.runs:
            summed[run][1:] = summed[run][0] + np.cumsum(self.speed[run][1:] * np.diff(self.time[run]))
        return replace(self, course=summed)

    def begun(self) -> Motion:
        """The motion for memory that knows nothing of the way to where each run begins."""
        return replace(self, course=np.concatenate([self.path[run] - self.path[run][0] for run in self.runs]))

    def from_rest(self, answer: Callable[..., Floats], *others: Floats, **sizes: float) -> Floats:
        """What an operator of given ``sizes`` answers, shape (n,), where each run comes from zero to where it begins.

        It is asked for the path and ``others`` (n,) along it.
        """
        along = zip(self.ways, *map(self.along, others), strict=True)
        return np.concatenate([answer(*each, **sizes)[1:] for each in along])

    def along(self, series: Floats) -> list[Floats]:
        """What a ``series`` (n, ...) is on each of the :attr:`ways`: at zero what it is where the run begins."""
        return [np.concatenate([series[run][:1], series[run]]) for run in self.runs]

    @functools.cached_property
    def ways(self) -> list[Floats]:
        """The path of each run from zero on."""
        return [np.concatenate([[0.0], self.path[run]]) for run in self.runs]

    @functools.cached_property
    def splined(self) -> list[Floats]:
        """The path of each run from zero on along a cubic spline, with a place between each two samples, shapes (2 n,).

        The recorded one is smooth between samples, what another differs by need not be.
        """
        ways, smooth = [], self.path if self.recorded is None else self.recorded
        for run in self.runs:
            time, path, bent = self.time[run], self.path[run], smooth[run]
            change = path - bent
            between = 0.5 * (change[1:] + change[:-1])
            if path.size > 1:
                between += CubicSpline(time, bent)(0.5 * (time[1:] + time[:-1]))
                between = np.where(
                    _overshoots(path, change), between, np.clip(between, *np.sort([path[1:], path[:-1]], axis=0))
                )
            ways.append(np.concatenate([[0.0, path[0]], np.column_stack([between, path[1:]]).ravel()]))
        return ways


@dataclass(frozen=True)
class Extent:
    """What a recording spans: reach (rad) and standard deviation of the speed (rad/s), interval and duration (s)."""

    reach: float
    fast: float
    interval: float
    duration: float

    @property
    def body(self) -> Floats:
        """Of the sizes of a slider with mass: rad, rad/s, 1, rad/s, s, s, 1; shape (7,)."""
        return np.array([self.reach, 1.0 / self.interval, 1.0, self.fast, self.interval, self.interval, 1.0])

    @property
    def leaf(self) -> Floats:
        """The same of friction between leaves: rad, 1, 1/rad; shape (3,)."""
        return np.array([self.reach, 1.0, 1.0 / self.reach])

    @property
    def loaded_leaf(self) -> Floats:
        """The same of such friction pressed by a spring: rad, 1, 1/rad, rad, 1/rad²; shape (5,)."""
        return np.array([self.reach, 1.0, 1.0 / self.reach, self.reach, 1.0 / self.reach**2])

    @property
    def lever(self) -> Floats:
        """The same of a slider on a lever that changes with the deflection: rad, 1/rad, 1/rad²; shape (3,)."""
        return np.array([self.reach, 1.0 / self.reach, 1.0 / self.reach**2])

    @property
    def capstan(self) -> Floats:
        """The same of friction of a tendon: rad, 1, 1, 1/rad; shape (4,)."""
        return np.array([self.reach, 1.0, 1.0, 1.0 / self.reach])

    @property
    def geared(self) -> Floats:
        """The same of a bristle that the load presses: rad, rad/s, 1, 1/rad; shape (4,)."""
        return np.array([self.reach, self.fast, 1.0, 1.0 / self.reach])

    @property
    def tendon(self) -> Floats:
        """The same of one whose tension grows by the square: rad, 1, 1, rad, rad; shape (5,)."""
        return np.array([self.reach, 1.0, 1.0, self.reach, self.reach])

    @property
    def magnet(self) -> Floats:
        """The same of a magnet: rad, rad, rad, 1; shape (4,)."""
        return np.array([self.reach, self.reach, self.reach, 1.0])

    @property
    def steel(self) -> Floats:
        """The same of steel that yields again and again: rad, 1, 1, 1, 1; shape (5,)."""
        return np.array([self.reach, 1.0, 1.0, 1.0, 1.0])

    @property
    def stopped(self) -> Floats:
        """The same of one between stops: and rad, 1, rad/s, 1; shape (11,)."""
        return np.array([*self.body, self.reach, 1.0, 1.0 / self.interval, 1.0])

    @property
    def rigid(self) -> Floats:
        """The same of friction that knows the speed alone: rad/s, 1, s; shape (3,)."""
        return np.array([self.fast, 1.0, self.interval])

    @property
    def sided(self) -> Floats:
        """The same of friction that knows the side as well: rad/s, 1, rad, s; shape (4,)."""
        return np.array([self.fast, 1.0, self.reach, self.interval])

    @property
    def sticky(self) -> Floats:
        """The same of a slider that holds better at rest: rad, rad/s, 1, s; shape (4,)."""
        return np.array([self.reach, self.fast, 1.0, self.interval])

    @property
    def slipping(self) -> Floats:
        """The same where the power is told by which the level falls with speed; shape (5,)."""
        return np.array([*self.sticky, 1.0])

    @property
    def wire(self) -> Floats:
        """The same of a superelastic wire: rad, 1, 1, rad, 1/rad; shape (5,)."""
        return np.array([self.reach, 1.0, 1.0, self.reach, 1.0 / self.reach])

    @property
    def dashed(self) -> Floats:
        """The same of a slider behind a dashpot: rad, 1, 1, s, s, 1; shape (6,)."""
        return np.array([self.reach, 1.0, 1.0, self.interval, self.interval, 1.0])

    @property
    def flowing(self) -> Floats:
        """The same of a viscoplastic slider: rad, s, 1; shape (3,)."""
        return np.array([self.reach, self.reach / self.fast, 1.0])

    @property
    def chambered(self) -> Floats:
        """The same of a chamber of gas: 1, 1/rad, 1/s, 1, 1, rad; shape (6,)."""
        return np.array([1.0, 1.0 / self.reach, self.fast / self.reach, 1.0, 1.0, self.reach])

    @property
    def drive(self) -> Floats:
        """The same of a spring that is held inside a drive: rad, rad, 1, s, 1/rad²; shape (5,)."""
        return np.array([self.reach, self.reach, 1.0, self.reach / self.fast, 1.0 / self.reach**2])

    @property
    def load(self) -> Floats:
        """The same of one that is held by a load: rad, rad/s, 1, rad, 1, 1/rad², s, 1, rad/s; shape (9,)."""
        pace = self.fast / self.reach
        return np.array([self.reach, pace, 1.0, self.reach, 1.0, 1.0 / self.reach**2, self.interval, 1.0, self.fast])

    @property
    def sliding_load(self) -> Floats:
        """The same where friction follows the speed: rad, rad/s, 1, rad/s, 1, 1/rad², s; shape (7,)."""
        return np.array([*self.load[:3], self.fast, *self.load[4:7]])

    @property
    def throttled(self) -> Floats:
        """The same of a spring behind a throttle: rad, rad/s, 1; shape (3,)."""
        return np.array([self.reach, self.fast, 1.0])

    @property
    def metal(self) -> Floats:
        """The same of a slider that hardens: rad, 1, rad, 1, rad, 1, rad; shape (7,)."""
        return np.array([self.reach, 1.0, self.reach, 1.0, self.reach, 1.0, self.reach])
