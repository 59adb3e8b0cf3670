"""What is in a recording, measured before any model is fitted: sampling, noise, turns, loops, and what they depend on.

Within a class of loops between the same two inputs, what changes with speed is rate dependence, with the number of loops
before it drift, and with the output's level non-congruency; an output that is not where it was when its loop opened
breaks wiping-out (Mayergoyz, Mathematical Models of Hysteresis, 1991). Every estimate has a 95 % interval, and what a recording cannot tell is None.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, is_dataclass
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as student

from ..models.motion import auto_dead_band, noise_level, quantum, turning_points
from .base import Recording
from .loops import Loop, classes, closed_loops, open_loop

__all__ = [
    "Congruency",
    "Coverage",
    "Estimate",
    "Gap",
    "Inspection",
    "Sampling",
    "Signal",
    "inspect_recording",
    "quantum",
]

Floats = NDArray[np.float64]

GAP = 3.0
"""An interval of this many median ones is a gap."""

OTHER_HISTORY = 0.05
"""Share of the output's range by which equal loops must differ in level for their histories to count as different."""

LEAST_SPEED_RATIO = 1.5


@dataclass(frozen=True)
class Estimate:
    """A value with its 95 % interval, from ``n`` observations."""

    value: float
    low: float
    high: float
    n: int

    @property
    def excludes_zero(self) -> bool:
        return self.low > 0.0 or self.high < 0.0


@dataclass(frozen=True)
class Gap:
    """Missing samples: when they begin (s from the start) and how long they last (s)."""

    at: float
    length: float


@dataclass(frozen=True)
class Sampling:
    """Sampling instants. ``jitter`` is the standard deviation of the intervals, gaps apart, over their median."""

    samples: int
    duration: float
    interval: float
    jitter: float
    gaps: tuple[Gap, ...]


@dataclass(frozen=True)
class Signal:
    """A channel: its range, the deviation of its white noise and, where it has one, the step of its values."""

    low: float
    high: float
    noise: float
    quantum: float | None

    @property
    def span(self) -> float:
        return self.high - self.low


@dataclass(frozen=True)
class Coverage:
    """Turns of the input and what the half cycles between them cover.

    Attributes
    ----------
    turns : int
        Turns of more than ``dead_band``.
    raw_turns : int
        Changes of sign of the differences; those beyond ``turns`` are noise.
    dead_band : float
        In units of x.
    swings, speeds : array, shape (m,)
        Of each half cycle: change of x, and its mean speed.
    """

    turns: int
    raw_turns: int
    dead_band: float
    swings: Floats
    speeds: Floats


@dataclass(frozen=True)
class Congruency:
    """Whether equal input extremes give equal loops whatever came before.

    Attributes
    ----------
    defect : Estimate
        RMS difference in shape, over the loops' output range, of pairs with different histories.
    repeats : float
        The same of pairs with the same history, or what noise alone makes of it.
    """

    defect: Estimate
    repeats: float


@dataclass(frozen=True)
class Inspection:
    """Everything measured on a recording; None stands for what it cannot tell.

    ``rate_width`` and ``rate_stiffness`` are the relative change of the loops' width and slope from the slowest to the
    fastest loop of a class, ``speed_ratio`` being the ratio of these speeds. ``drift``, ``softening`` and ``narrowing``
    are changes from the first to the last loop of a class: of the level and of the height over the loops' output
    range, of the area over itself. ``closing`` and ``wiping_out`` are the mean gap of other and of nested loops over the
    output's range. ``open_loop`` is the piece between the last two turns where no loop was closed.
    """

    sampling: Sampling
    x: Signal
    y: Signal
    coverage: Coverage
    loops: tuple[Loop, ...]
    open_loop: Loop | None
    closing: Estimate | None
    wiping_out: Estimate | None
    congruency: Congruency | None
    speed_ratio: float
    rate_width: Estimate | None
    rate_stiffness: Estimate | None
    drift: Estimate | None
    softening: Estimate | None
    narrowing: Estimate | None

    def document(self) -> dict[str, Any]:
        """Everything but the branches of the loops, as JSON can hold it."""

        def plain(value: Any) -> Any:
            if is_dataclass(value):
                kept = (f.name for f in fields(value) if f.name not in ("up", "down"))
                return {name: plain(getattr(value, name)) for name in kept}
            if isinstance(value, tuple | list):
                return [plain(one) for one in value]
            if isinstance(value, np.ndarray | np.generic):
                return plain(value.tolist())
            return None if isinstance(value, float) and not np.isfinite(value) else value

        return plain(self)

    @property
    def main_loops(self) -> tuple[Loop, ...]:
        """The loops of at least nine tenths of the largest swing; the open one where none was closed."""
        if not self.loops:
            return (self.open_loop,) if self.open_loop else ()
        whole = [loop for loop in self.loops if loop.simple] or self.loops
        largest = max(loop.swing for loop in whole)
        return tuple(loop for loop in whole if loop.swing >= 0.9 * largest)


def inspect_recording(recording: Recording) -> Inspection:
    """Measure everything that needs no model."""
    time, x, y = recording.time, recording.x, recording.y
    signals = [Signal(float(v.min()), float(v.max()), noise_level(v), quantum(v)) for v in (x, y)]
    band = max(auto_dead_band(x), min(2.0 * (signals[0].quantum or 0.0), 0.05 * signals[0].span))
    turns = turning_points(x, band)
    swings = np.abs(np.diff(x[turns]))
    loops = closed_loops(time, x, y, turns)
    gaps = np.array([loop.gap for loop in loops if not loop.nested and np.isfinite(loop.gap)])
    nested = np.array([loop.gap for loop in loops if loop.nested and np.isfinite(loop.gap)])
    span = max(signals[1].span, 1e-300)
    grouped = classes([loop for loop in loops if loop.simple])
    ratio, rate = _rate(grouped)
    drift = _drift(grouped)
    return Inspection(
        sampling=_sampling(time),
        x=signals[0],
        y=signals[1],
        coverage=Coverage(
            turns=turns.size - 2,
            raw_turns=turning_points(x).size - 2,
            dead_band=band,
            swings=swings,
            speeds=swings / np.diff(time[turns]),
        ),
        loops=tuple(loops),
        open_loop=None if loops else open_loop(time, x, y, turns),
        closing=_mean(gaps / span),
        wiping_out=_mean(nested / span),
        congruency=_congruency(grouped, signals[1]),
        speed_ratio=ratio,
        rate_width=rate[0],
        rate_stiffness=rate[1],
        drift=drift[0],
        softening=drift[1],
        narrowing=drift[2],
    )


# ---- one channel ---------------------------------------------------------------------------------------------------


def _sampling(time: Floats) -> Sampling:
    intervals = np.diff(time)
    median = float(np.median(intervals))
    late = intervals > GAP * median
    gaps = tuple(Gap(float(time[k] - time[0]), float(intervals[k])) for k in np.flatnonzero(late))
    jitter = float(np.std(intervals[~late]) / median)
    # What rounding of large time stamps makes is not the sampling's.
    rounding = 4.0 * np.spacing(np.abs(time).max()) / median
    return Sampling(time.size, float(time[-1] - time[0]), median, 0.0 if jitter < rounding else jitter, gaps)


# ---- what the loops depend on --------------------------------------------------------------------------------------


def _mean(values: Floats) -> Estimate | None:
    if values.size < 2:
        return None
    half = student.ppf(0.975, values.size - 1) * np.std(values, ddof=1) / np.sqrt(values.size)
    mean = float(values.mean())
    return Estimate(mean, mean - float(half), mean + float(half), values.size)


def _slope(target: Floats, first: Floats, second: Floats) -> Estimate | None:
    """Least-squares slope of ``target`` over ``first``, with ``second`` held where the data can tell them apart."""
    columns = [np.ones_like(first), first - first.mean()]
    rest = second - second.mean()
    if np.ptp(rest) > 0.0 and abs(np.corrcoef(columns[1], rest)[0, 1]) < 0.95 and target.size > 3:
        columns.append(rest)
    design = np.column_stack(columns)
    freedom = target.size - design.shape[1]
    if freedom < 1:
        return None
    solution = np.linalg.lstsq(design, target, rcond=None)[0]
    variance = float(np.sum((target - design @ solution) ** 2)) / freedom
    deviation = np.sqrt(variance * np.linalg.inv(design.T @ design)[1, 1])
    half = float(student.ppf(0.975, freedom) * deviation)
    return Estimate(float(solution[1]), float(solution[1]) - half, float(solution[1]) + half, target.size)


def _scaled(estimate: Estimate | None, factor: float) -> Estimate | None:
    if estimate is None or not np.isfinite(factor):
        return None
    low, high = sorted((estimate.low * factor, estimate.high * factor))
    return Estimate(estimate.value * factor, low, high, estimate.n)


def _rate(grouped: Sequence[Sequence[Loop]]) -> tuple[float, tuple[Estimate | None, Estimate | None]]:
    """Largest ratio of speeds in a class, and the relative change of width and slope over that ratio."""
    best: Sequence[Loop] = ()
    ratio = 1.0
    for members in grouped:
        speeds = [loop.speed for loop in members]
        if len(members) >= 3 and max(speeds) / min(speeds) > ratio:
            best, ratio = members, max(speeds) / min(speeds)
    if ratio < LEAST_SPEED_RATIO:
        return ratio, (None, None)
    speed = np.log([loop.speed for loop in best])
    order = np.arange(len(best), dtype=np.float64)
    found = []
    width = np.array([loop.half_width for loop in best])
    height = np.array([loop.height for loop in best])
    for series, scale in ((width, abs(float(width.mean()))), (height, float(np.mean([loop.range for loop in best])))):
        # Where speed and order cannot be told apart, drift would pass for rate dependence.
        apart = abs(np.corrcoef(speed, order)[0, 1]) < 0.95
        estimate = _slope(series, speed, order) if apart else None
        found.append(_scaled(estimate, np.log(ratio) / max(scale, 1e-300)))
    return ratio, (found[0], found[1])


def _drift(grouped: Sequence[Sequence[Loop]]) -> tuple[Estimate | None, Estimate | None, Estimate | None]:
    """Change from the first to the last loop of the most frequent class of level, height and area."""
    # Of equally frequent classes the largest loops: they come first.
    members = max(grouped, key=len, default=[])
    if len(members) < 4:
        return None, None, None
    order = np.arange(len(members), dtype=np.float64)
    speed = np.log([loop.speed for loop in members])
    output = float(np.mean([loop.range for loop in members]))
    area = abs(float(np.mean([loop.area for loop in members])))
    found = []
    for values, scale in (
        ([loop.level for loop in members], output),
        ([loop.height for loop in members], output),
        ([loop.area for loop in members], area),
    ):
        found.append(_scaled(_slope(np.array(values), order, speed), order[-1] / max(scale, 1e-300)))
    return found[0], found[1], found[2]


def _congruency(grouped: Sequence[Sequence[Loop]], y: Signal) -> Congruency | None:
    different: list[tuple[float, float]] = []
    equal: list[tuple[float, float]] = []
    for members in grouped:
        shapes = [np.concatenate([loop.up, loop.down]) - loop.level for loop in members]
        for i, j in combinations(range(min(len(members), 40)), 2):
            speeds = members[i].speed, members[j].speed
            if max(speeds) > LEAST_SPEED_RATIO * min(speeds):
                continue
            size = float(0.5 * (np.ptp(shapes[i]) + np.ptp(shapes[j])))
            defect = float(np.sqrt(np.mean((shapes[i] - shapes[j]) ** 2)) / max(size, 1e-300))
            apart = abs(members[i].level - members[j].level) > OTHER_HISTORY * y.span
            (different if apart else equal).append((defect, size))
    if not different:
        return None
    values = np.array([defect for defect, _ in different])
    mean_size = float(np.mean([size for _, size in different]))
    repeats = float(np.median([defect for defect, _ in equal]) if equal else np.sqrt(2.0) * y.noise / mean_size)
    generator = np.random.default_rng(0)
    means = generator.choice(values, (1000, values.size)).mean(axis=1)
    low, high = np.quantile(means, [0.025, 0.975])
    return Congruency(Estimate(float(values.mean()), float(low), float(high), values.size), repeats)
