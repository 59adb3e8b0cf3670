"""What a recording says at each sample: the coordinates in which a gap can show.

Derivatives come from a local cubic (Savitzky-Golay) whose window is the widest that leaves no more than the sensor's
noise behind (the discrepancy principle), so that a clean simulated motion is hardly smoothed and a noisy one enough.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, median_filter
from scipy.signal import savgol_coeffs, savgol_filter

from ...models.motion import directions, noise_level, quantum, turning_points
from ..operators.fractional import fractional
from ..operators.masses import resonated
from ..operators.memory import SAME_STEP, bristle, creeping, lowpass, plays
from .noise import FARTHEST, STRONGER, at_rest_and_moving, independent, noise_levels, rms

__all__ = ["COORDINATES", "TOLD", "Signals", "differentiate"]

Floats = NDArray[np.float64]
COORDINATES = (
    "time", "position", "direction", "speed", "acceleration", "distance_since_reversal", "amplitude", "load", "travel",
)  # fmt: skip
APART = 0.05
"""Radians of the motion's mean frequency between samples whose noise counts as independent."""
TOLD = ("reach", "stroke", "strongest")
"""Names of the sizes whose numbers stand in laws."""
SWING = 0.08
"""Part of the reach that a turn must swing back to be one."""
LEAST_SWING = 0.01
"""The same where small turns count as well."""
ENOUGH_STROKES = 30.0
"""Way of a recording, over half the range of the deflection, of which a thirtieth is a stroke."""
KNOCK, KNOCK_SAMPLES, MOST_KNOCKS = 6.0, 4, 0.35
"""How far a knock leaves the running median (noise levels), how long it lasts at most, and the most of a recording."""
CERTAIN = 2.5
"""Standard deviations of the speed's noise below which there may be no motion at all."""
COUNTED = 0.02
"""Share of the deflection's range up to which a step is an encoder's; longer ones are levels that were gone to."""
HARDLY_MORE, LITTLE_MORE = 1.03, 1.1
"""Noise levels that smoothing may leave of a series, which it bends before its slope, and where its slope is asked for."""
WINDOWS = (5, 7, 9, 13, 17, 23, 31, 41, 55, 75, 101, 137, 185, 251)


@dataclass(frozen=True)
class Signals:
    """One or more recordings end to end, and the simulator's output at their samples.

    Attributes
    ----------
    time, x, y_real, y_sim : array, shape (n,)
        s, rad, N·m, N·m. Time restarts with each recording.
    runs : sequence of slice
        The recordings; memory restarts with each.
    channels : mapping of str to array, shape (n,)
        Further measured channels, such as temperature or pressure.
    unit : str
        Of the output.
    timed : bool
        Whether ``time`` was measured; otherwise it numbers the samples.
    warm_up : bool array, shape (n,), optional
        Samples at which an unrecorded history still shows: they make memory, but are not judged.
    recorded : array, shape (n,), optional
        The deflection as its sensor gave it, rad, where ``x`` is without the sensor's noise.
    jitter : float
        What of that noise smoothing has left makes of the simulator's output, N·m.
    sizes : mapping of str to float, optional
        :attr:`told_in` of the recording on which laws were found that are to be followed on this one.
    """

    time: Floats
    x: Floats
    y_real: Floats
    y_sim: Floats
    runs: Sequence[slice]
    channels: Mapping[str, Floats]
    unit: str = "N·m"
    timed: bool = True
    warm_up: NDArray[np.bool_] | None = None
    recorded: Floats | None = None
    jitter: float = 0.0
    sizes: Mapping[str, float] | None = None

    # ---- what follows from them ------------------------------------------------------------------------------------

    @cached_property
    def gap(self) -> Floats:
        """Recording minus simulator, N·m, shape (n,)."""
        return self.y_real - self.y_sim

    @cached_property
    def judged(self) -> NDArray[np.bool_]:
        """Samples that are not warm-up, shape (n,)."""
        return np.ones(self.x.size, dtype=bool) if self.warm_up is None else ~self.warm_up

    @cached_property
    def noise_floor(self) -> float:
        """Standard deviation of the white noise on the gap, N·m: what no simulator can close."""
        measured = self._noise_levels[self.stride - 1]
        at_rest, moving = at_rest_and_moving(self.gap, self.speed, self.runs, self.stride)
        if at_rest > STRONGER * moving:
            # The joint chatters while it creeps, or turns within few samples.
            measured = min(measured, moving)
        # A noise-free (synthetic) recording still has the resolution of its numbers.
        return max(measured, 1e-5 * float(np.std(self.y_real)), 1e-300)

    @cached_property
    def stride(self) -> int:
        """Samples that lie apart as far as noise is told from structure: densely sampled noise is often filtered."""
        fastest = rms(self.speed) / max(float(np.std(self.smooth_x)), 1e-300)
        dense = int(np.clip(APART / max(fastest * self.interval, 1e-300), 1, FARTHEST))
        return max(dense, self._apart)

    @cached_property
    def correlated(self) -> int:
        """Samples of which noise behind a low pass leaves but one that tells anything new; 1 where it is white or nearly."""
        return self._apart if self._apart > FARTHEST else 1

    @cached_property
    def _apart(self) -> int:
        """Samples apart from where noise is correlated no more; what looks like noise behind a low pass and knows how fast the joint moves is none."""
        apart = independent(self._noise_levels)
        if apart == 1:
            return 1
        at_rest, moving = at_rest_and_moving(self.gap, self.speed, self.runs, 2)
        # Neighbours as near as these do not show a ripple above white noise.
        passed_fast = apart > FARTHEST and moving > STRONGER * at_rest
        chatters = at_rest > STRONGER * moving
        return 1 if passed_fast or chatters else apart

    @cached_property
    def _noise_levels(self) -> list[float]:
        """Noise level of the gap's samples 1, 2, … apart, N·m."""
        return noise_levels(self.gap, self.runs)

    @cached_property
    def knocks(self) -> NDArray[np.bool_]:
        """Samples about moments that no smooth law explains: flanks that meet, a stop that is hit, an outlier; shape (n,).

        There the gap leaves its running median far beyond the noise. Where more than a third of the samples would be
        left out, none are: then the gap is rough by itself.
        """
        wide = 2 * KNOCK_SAMPLES * self.stride + 1
        about = np.zeros(self.gap.size, dtype=bool)
        for run in self.runs:
            away = self.gap[run] - median_filter(self.gap[run], min(wide, run.stop - run.start))
            found = np.abs(away) > KNOCK * self.noise_floor
            about[run] = binary_dilation(found, iterations=(KNOCK_SAMPLES - 1) * self.stride)
        return about if np.mean(about) <= MOST_KNOCKS else np.zeros_like(about)

    @cached_property
    def groups(self) -> NDArray[np.intp]:
        """Number of the recording that each sample belongs to, shape (n,)."""
        return np.repeat(np.arange(len(self.runs)), [run.stop - run.start for run in self.runs])

    @cached_property
    def interval(self) -> float:
        """Median time between samples, s."""
        return float(np.median(np.concatenate([np.diff(self.time[run]) for run in self.runs])))

    @cached_property
    def reach(self) -> float:
        """Half the range of the deflection, rad."""
        return self._size("reach", 0.5 * float(np.ptp(self.x)))

    @cached_property
    def stroke(self) -> float:
        """The largest deflection either way, rad."""
        return self._size("stroke", float(np.max(np.abs(self.smooth_x))))

    @cached_property
    def strongest(self) -> float:
        """The largest torque either way that the simulator tells, N·m."""
        return self._size("strongest", float(np.max(np.abs(self.y_sim))))

    @property
    def told_in(self) -> dict[str, float]:
        """Sizes whose numbers stand in laws."""
        return {name: getattr(self, name) for name in TOLD}

    def _size(self, name: str, own: float) -> float:
        return self.sizes[name] if self.sizes else max(own, 1e-300)

    @property
    def _measured(self) -> Floats:
        """The deflection with its sensor's noise, rad."""
        return self.x if self.recorded is None else self.recorded

    @cached_property
    def _motion(self) -> tuple[Floats, Floats, Floats]:
        parts = [differentiate(self.time[run], self._measured[run]) for run in self.runs]
        smooth, speed, acceleration = (np.concatenate(series) for series in zip(*parts, strict=True))
        return smooth, speed, acceleration

    @property
    def smooth_x(self) -> Floats:
        """The deflection without sensor noise, rad."""
        return self._motion[0]

    @property
    def speed(self) -> Floats:
        """dx/dt, rad/s."""
        return self._motion[1]

    @cached_property
    def smoothing(self) -> list[tuple[float, int]]:
        """Of each recording: standard deviation of the deflection's noise, rad, and samples that its speed is taken over."""
        recorded = (self._measured[run] for run in self.runs)
        levels = ((x, _deviation(x, x)) for x in recorded)
        return [(level, _windows(x, level)[1]) for x, level in levels]

    @cached_property
    def certain_speed(self) -> Floats:
        """dx/dt less what the deflection's noise may have made of it, rad/s: rest is rest, and no creeping to and fro."""
        noise = np.empty_like(self.x)
        for run, (level, window) in zip(self.runs, self.smoothing, strict=True):
            coefficients = savgol_coeffs(window, 3, deriv=1, delta=self.interval)
            noise[run] = level * float(np.linalg.norm(coefficients))
        # Away from rest hardly anything is taken off.
        size = np.abs(self.speed)
        certain = size > CERTAIN * noise
        left = np.sqrt(np.square(size[certain]) - np.square(CERTAIN * noise[certain]))
        speed = np.zeros_like(size)
        speed[certain] = np.sign(self.speed[certain]) * left
        return speed

    @property
    def acceleration(self) -> Floats:
        """d²x/dt², rad/s²."""
        return self._motion[2]

    @cached_property
    def _dead_band(self) -> float:
        noise = max(noise_level(self._measured[run] - self.smooth_x[run]) for run in self.runs)
        return min(3.0 * noise + 1e-4 * self.reach, 0.05 * self.reach)

    @cached_property
    def direction(self) -> Floats:
        """Direction of motion, ±1 (0 before the first motion); a pause keeps it."""
        return self.per_run(lambda run: directions(self.smooth_x[run], self._dead_band).astype(np.float64))

    @cached_property
    def _half_cycles(self) -> tuple[Floats, Floats]:
        since, amplitude = np.empty_like(self.x), np.empty_like(self.x)
        for run in self.runs:
            x = self.smooth_x[run]
            points = turning_points(x, self._dead_band)
            segment = np.clip(np.searchsorted(points, np.arange(x.size), side="right") - 1, 0, max(points.size - 2, 0))
            since[run] = np.abs(x - x[points[segment]])
            last = points[np.minimum(segment + 1, points.size - 1)]
            amplitude[run] = 0.5 * np.abs(x[last] - x[points[segment]])
        return since, amplitude

    @property
    def since_reversal(self) -> Floats:
        """Distance from the last turning point, rad."""
        return self._half_cycles[0]

    @property
    def amplitude(self) -> Floats:
        """Half the stroke of the current half cycle, rad."""
        return self._half_cycles[1]

    @cached_property
    def moved(self) -> Floats:
        """Way since the sample before, rad; 0 where a recording begins."""
        return self.per_run(lambda run: np.diff(self.smooth_x[run], prepend=self.smooth_x[run][0]))

    @cached_property
    def travel(self) -> Floats:
        """Distance covered since the recording began, rad."""
        return self.per_run(lambda run: np.cumsum(np.abs(self.moved[run])))

    @cached_property
    def farthest(self) -> Floats:
        """Largest deflection to either side since the recording began, rad, shape (n,)."""
        return self.per_run(lambda run: np.maximum.accumulate(np.abs(self.smooth_x[run])))

    @cached_property
    def reversals(self) -> Floats:
        """Turns of the motion since the recording began, shape (n,); a small dither between two of them is none."""
        return self._turns_by(SWING * self.reach)

    @cached_property
    def turns(self) -> Floats:
        """The same with all but the smallest of these, shape (n,)."""
        return self._turns_by(max(LEAST_SWING * self.reach, self._dead_band))

    def _turns_by(self, swing: float) -> Floats:
        def counted(run: slice) -> Floats:
            way = directions(self.smooth_x[run], swing)
            return np.cumsum(np.abs(np.diff(way, prepend=way[0])) > 1, dtype=np.float64)

        return self.per_run(counted)

    @cached_property
    def coordinates(self) -> dict[str, Floats]:
        """Every coordinate by its name, further channels included."""
        named = {
            "time": self.time, "position": self.smooth_x, "direction": self.direction, "speed": self.speed,
            "acceleration": self.acceleration, "distance_since_reversal": self.since_reversal,
            "amplitude": self.amplitude, "load": self.y_sim, "travel": self.travel,
        }  # fmt: skip
        return {**named, **{name: values for name, values in self.channels.items() if name not in named}}

    # ---- tools for effects -----------------------------------------------------------------------------------------

    def per_run(self, compute: Callable[[slice], Floats]) -> Floats:
        """``compute`` applied to each recording, joined to shape (n,) or (n, k)."""
        return np.concatenate([compute(run) for run in self.runs])

    @cached_property
    def _spacings(self) -> list[float | Floats]:
        """Of each recording: its one interval, where there is only one, else its times."""
        clocks = [self.time[run] for run in self.runs]
        steps = [np.diff(clock) for clock in clocks]
        return [
            float(step[0]) if np.ptp(step) < SAME_STEP * step[0] else clock
            for step, clock in zip(steps, clocks, strict=True)
        ]

    def slope(self, series: Floats) -> Floats:
        """Derivative of a smooth ``series`` by time, shape (n,)."""
        return np.concatenate(
            [np.gradient(series[run], spacing) for run, spacing in zip(self.runs, self._spacings, strict=True)]
        )

    def bristle(self, length: float) -> Floats:
        """Direction that builds up over ``length`` rad after a turn, shape (n,)."""
        return self.per_run(lambda run: bristle(self.smooth_x[run], length))

    def slipping(self, length: float) -> Floats:
        """Direction from a spring and slider that yields after ``length`` rad, shape (n,)."""
        half = np.array([length])
        return self.per_run(lambda run: (self.smooth_x[run] - plays(self.smooth_x[run], half)[:, 0]) / length)

    def lowpass(self, signal: Floats, tau: float) -> Floats:
        """First-order lag of ``signal`` (n,), time constant ``tau`` s."""
        return self.per_run(lambda run: lowpass(self.time[run], signal[run], tau))

    def creeping(self, signal: Floats, tau: float, power: float, size: float) -> Floats:
        """What a spring holds of ``signal`` (n,) behind a dashpot that yields with a ``power`` of it, ``tau`` s at a ``size``."""
        return self.per_run(lambda run: creeping(self.time[run], signal[run], tau, power, size))

    def fractional(self, signal: Floats, order: float) -> Floats:
        """Derivative of ``signal`` (n,) of an ``order`` between 0 and 1."""
        return self.per_run(lambda run: fractional(self.time[run], signal[run], order))

    def resonated(self, signal: Floats, frequency: float, damping: float) -> Floats:
        """``signal`` (n,) through a resonator of ``frequency`` rad/s and a ``damping`` ratio below one."""
        return self.per_run(lambda run: resonated(self.time[run], signal[run], frequency, damping))

    def delayed(self, signal: Floats, tau: float) -> Floats:
        """``signal`` (n,) as it was ``tau`` s earlier (later if negative); held at a recording's ends."""
        return self.per_run(lambda run: np.interp(self.time[run] - tau, self.time[run], signal[run]))

    @cached_property
    def elapsed(self) -> Floats:
        """Time since the recording began, s."""
        return self.per_run(lambda run: self.time[run] - self.time[run][0])

    def shortest_and_longest(self, grown: Floats) -> tuple[float, float]:
        """How far what grows from zero in each recording, shape (n,), comes where it comes least far, if it grows, and farthest.

        What is so short that a thirtieth of it is less than a stroke tells no more than one where that is a stroke.
        """
        ends = [float(grown[run].max()) for run in self.runs]
        longest = max(ends)
        strokes = float(self.travel.max()) / max(self.reach, 1e-300)
        enough = longest * ENOUGH_STROKES / max(strokes, ENOUGH_STROKES)
        return max(min((end for end in ends if end > 0.0), default=0.0), enough), longest


def _deviation(series: Floats, recorded: Floats) -> float:
    """Standard deviation of a deflection's sensor noise, rad, of samples at even times: of counts at least what counting makes.

    Differences of counts are whole numbers, few where the joint moves by about one count a sample, so that their median may be
    far off.
    """
    level, step = noise_level(series), quantum(recorded)
    if step is None or step > COUNTED * np.ptp(recorded):
        return level
    return max(min(level, rms(np.diff(series, 4)) / np.sqrt(70.0)), step / np.sqrt(12.0))


def _windows(series: Floats, noise: float) -> tuple[int, int]:
    """Samples of the widest local cubics, for the series itself and for its slope, that leave no more than white ``noise``."""
    position = slope = WINDOWS[0]
    for window in WINDOWS[1:]:
        if window > series.size // 2:
            break
        # A local cubic over w samples passes on about 9/(4 w) of the noise's energy.
        left = rms(series - savgol_filter(series, window, 3)) / np.sqrt(1.0 - 2.25 / window)
        if left <= HARDLY_MORE * noise:
            position = window
        if left > LITTLE_MORE * noise:
            break
        slope = window
    return position, slope


def differentiate(time: Floats, x: Floats) -> tuple[Floats, Floats, Floats]:
    """Smoothed deflection and its first two derivatives."""
    steps = np.diff(time)
    step = float(np.median(steps))
    uniform = bool(np.all(np.abs(steps - step) <= 0.02 * step))
    clock = time if uniform else np.linspace(time[0], time[-1], round((time[-1] - time[0]) / step) + 1)
    series = x if uniform else np.interp(clock, time, x)
    noise = _deviation(series, x)
    narrow, window = _windows(series, noise)
    if series.size < 2 * window:
        speed = np.gradient(series, clock)
        found = series, speed, np.gradient(speed, clock)
    else:
        smooth = savgol_filter(series, narrow, 3) if noise > 1e-9 * np.ptp(series) else series
        found = (
            smooth,
            savgol_filter(series, window, 3, deriv=1, delta=step),
            savgol_filter(series, max(window, 7) if series.size > 14 else window, 4, deriv=2, delta=step),
        )
    return found if uniform else tuple(np.interp(time, clock, part) for part in found)  # type: ignore[return-value]
