"""Choi's backlash-based polynomial model of a series elastic actuator's spring.

Source: W. Choi, J. Won, J. Lee, J. Park, "Low stiffness design and hysteresis compensation torque control of SEA for
active exercise rehabilitation robots", Autonomous Robots 41, 2017, appendix 1 (Eqs. 40-43) and appendix 2.

Only the appendices were at hand; they refer to the main text's conditions by number. They are read as: (14) the
ascending curve lies above the descending one; (15) all four functions rise; (19), (20) the transition slopes s+ and s−
exceed every derivative of the curves on their side; (21), which the passivity proof uses, follows from those. The
printed objective of Eqs. 42 and 43 sums signed errors, which large errors of opposite sign minimise as well as a good
fit does; the sum of squares is used instead.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np
from numba import njit
from numpy.polynomial import Polynomial
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from ..errors import InputError
from .base import Condition, Floats, HysteresisModel, InverseError, Run, parameter_array, parameter_number
from .motion import auto_dead_band, directions, settled_from, turning_points
from .stepping import KernelStepper

__all__ = ["ChoiBacklash"]

CURVES = ("ascending_pos", "ascending_neg", "descending_pos", "descending_neg")
STEEPEST = 50.0
"""Transition slopes are searched up to this multiple of the steepest curve: beyond it they act like a jump."""

# State: last input, last output, curve that is followed (+1 ascending, -1 descending, 0 on a line), started.
_X, _Y, _CURVE, _STARTED = 0, 1, 2, 3


def _initial_state(capacity: int) -> Floats:
    return np.zeros(4)


@njit(cache=True)
def _curve(x, rising, curves, stroke):
    """A curve's value: the row of its side of zero within the stroke, below it (4 rows on) or above it (8 rows on)."""
    row = (0 if rising else 2) + (0 if x >= 0.0 else 1) + (4 if x < stroke[0] else 0) + (8 if x > stroke[1] else 0)
    value = 0.0
    for k in range(curves.shape[1] - 1, -1, -1):
        value = value * x + curves[row, k]
    return value


@njit(cache=True)
def _line(x, to, slopes):
    """Rise along the transition line from ``x`` to ``to``: each side of zero has its own slope."""
    up = max(to, 0.0) - max(x, 0.0)
    return slopes[0] * up + slopes[1] * (min(to, 0.0) - min(x, 0.0))


@njit(cache=True)
def _run(x, state, params, out, on_curve):
    # The state is held in local variables meanwhile: through the array each sample would cost many times as much.
    curves, slopes, stroke = params
    slope_pos, slope_neg = slopes
    last = state[_X]
    y = state[_Y]
    followed = state[_CURVE]
    started = state[_STARTED] != 0.0
    for i in range(x.size):
        now = x[i]
        if not started:
            started = True
            y = 0.5 * (_curve(now, True, curves, stroke) + _curve(now, False, curves, stroke))
            last = now
        elif now != last:
            direction = 1.0 if now > last else -1.0
            curve = _curve(now, direction > 0.0, curves, stroke)
            if followed != direction:
                y += slope_pos * (max(now, 0.0) - max(last, 0.0)) + slope_neg * (min(now, 0.0) - min(last, 0.0))
                followed = direction if direction * (y - curve) >= 0.0 else 0.0
            if followed == direction:
                y = curve
            last = now
        out[i] = y
        on_curve[i] = followed
    state[_X] = last
    state[_Y] = y
    state[_CURVE] = followed
    state[_STARTED] = 1.0 if started else 0.0


@njit(cache=True)
def _step(x, state, params, commit):
    one = np.full(1, x)
    _run(one, state if commit else state.copy(), params, one, np.empty(1))
    return one[0]


@njit(cache=True)
def _invert(y, first, state, params, out, reach):
    """Input for each output; returns the index of the first one not reached within ``reach``, or the length."""
    curves, slopes, stroke = params
    _step(first, state, params, True)
    out[0] = first
    for i in range(1, y.size):
        target = y[i]
        rise = target - state[_Y]
        x = state[_X]
        if rise != 0.0:
            direction = 1.0 if rise > 0.0 else -1.0
            on_line = state[_CURVE] != direction
            if on_line:
                # Along the line, to zero with the present side's slope and on from there with the other one's.
                if x * direction >= 0.0:
                    x += rise / (slopes[0] if direction > 0.0 else slopes[1])
                else:
                    to_zero = _line(x, 0.0, slopes)
                    if abs(rise) <= abs(to_zero):
                        x += rise / (slopes[1] if direction > 0.0 else slopes[0])
                    else:
                        x = (rise - to_zero) / (slopes[0] if direction > 0.0 else slopes[1])
                on_line = direction * (_curve(x, rise > 0.0, curves, stroke) - target) >= 0.0
            if not on_line:
                # The curve comes first: its root lies further on.
                low = x
                step = 1e-3 * reach
                high = low + direction * step
                while direction * (_curve(high, rise > 0.0, curves, stroke) - target) < 0.0 and abs(high) < reach:
                    step *= 2.0
                    high = low + direction * step
                if direction * (_curve(high, rise > 0.0, curves, stroke) - target) < 0.0:
                    return i
                for _ in range(200):
                    x = 0.5 * (low + high)
                    if x in (low, high):
                        break
                    if direction * (_curve(x, rise > 0.0, curves, stroke) - target) < 0.0:
                        low = x
                    else:
                        high = x
                x = high
        if abs(x) > reach or abs(_step(x, state, params, True) - target) > 1e-9 * (abs(target) + abs(rise)) + 1e-12:
            return i
        out[i] = x
    return y.size


class ChoiBacklash(HysteresisModel):
    """Two polynomial curves a side of zero, joined by transition lines of constant slope.

    The output moves along a line of the slope of the current sign of x until it meets the ascending curve (rising
    motion) or the descending one (falling motion) and then follows it. It starts midway between the two curves.

    Parameters
    ----------
    degree : int
        Degree of the polynomials; lowered where there are too few points.
    end_margin : float
        Samples nearer than this fraction of the stroke to the last turn are taken as transition at first (the source
        leaves out 0.05 rad); afterwards those that the model itself sees on a line.

    Notes
    -----
    ``from_parameters`` takes ``ascending_pos``, ``ascending_neg``, ``descending_pos``, ``descending_neg``
    (coefficients in increasing powers, any degree), ``slope_pos``, ``slope_neg``, and optionally ``stroke`` (2,),
    outside which the curves continue with their end slopes.
    """

    id: ClassVar[str] = "choi-backlash"
    title: ClassVar[str] = "Choi backlash polynomial"
    summary: ClassVar[str] = "polynomial curves joined by transition lines; few parameters, clockwise loops"
    use_for: ClassVar[str] = (
        "series elastic actuators with backlash: few parameters, each of which can be read off the loop"
    )
    not_for: ClassVar[str] = (
        "loops whose sides of zero differ in more than their polynomials (curves may jump at x = 0), and nested "
        "minor loops"
    )
    source: ClassVar[str] = "Choi et al. 2017, appendix 1, Eqs. 40-43"
    references: ClassVar[tuple[str, ...]] = ("choi2017",)
    search_grid: ClassVar[Mapping[str, Sequence[Any]]] = {"degree": (3, 5, 7)}
    estimated: ClassVar[tuple[str, ...] | None] = (
        "ascending_pos",
        "ascending_neg",
        "descending_pos",
        "descending_neg",
        "slope_pos",
        "slope_neg",
    )

    def __init__(self, degree: int = 5, end_margin: float = 0.1) -> None:
        self.degree = degree
        self.end_margin = end_margin

    # ---- identification --------------------------------------------------------------------------------------------

    def _identify(self, runs: Sequence[Run]) -> dict[str, Any]:
        if self.degree < 1 or not 0.0 <= self.end_margin < 0.5:
            raise InputError("choi-backlash needs degree >= 1 and 0 <= end_margin < 0.5")
        x = np.concatenate([run.x for run in runs])
        y = np.concatenate([run.y for run in runs])
        stroke = np.array([x.min(), x.max()])
        stiffness = float(x @ y / (x @ x))
        self.notes_.append(f"linear stiffness k = {stiffness:.6g} (Eq. 40)")
        dead_bands = [auto_dead_band(run.x) for run in runs]
        direction = np.concatenate([directions(run.x, band) for run, band in zip(runs, dead_bands, strict=True)])
        settled = np.concatenate([np.arange(run.x.size) >= settled_from(run.x) for run in runs])
        since_turn = np.concatenate([_since_turn(run.x, band) for run, band in zip(runs, dead_bands, strict=True)])
        best: tuple[float, dict[str, Any]] | None = None
        # Too small a margin bends the curves towards the lines, too large a one leaves their ends unknown.
        for margin in (self.end_margin, 2.0 * self.end_margin, 3.0 * self.end_margin):
            on_curve = np.where(since_turn > margin * np.ptp(x), direction, 0)
            last = np.inf
            # The model itself tells which samples are on a line, so that only they are left out in the end.
            for _ in range(4):
                try:
                    curves = self._fit_curves(x, y, np.where(settled, on_curve, 0), stroke)
                except InputError:
                    if best is None and margin >= 3.0 * self.end_margin:
                        raise
                    break
                table = _table(curves, stroke)
                slopes = self._fit_slopes(curves, table, runs, settled)
                predicted, on_curve = self._simulate(_kernel_parameters(table, slopes, stroke), runs)
                error = float(np.mean((predicted - y)[settled] ** 2))
                if best is None or error < best[0]:
                    best = (error, {**curves, "slope_pos": slopes[0], "slope_neg": slopes[1]})
                if error >= 0.999 * last:
                    break
                last = error
        if best is None:
            raise InputError("no sample lies on the curves; give a recording with a larger stroke")
        return best[1]

    def _fit_curves(self, x: Floats, y: Floats, on_curve: NDArray[Any], stroke: Floats) -> dict[str, Any]:
        curves: dict[str, Any] = {"stroke": stroke}
        for branch, sign in (("ascending", 1), ("descending", -1)):
            fitted: dict[str, Floats] = {}
            for side, inside in (("pos", x >= 0.0), ("neg", x < 0.0)):
                chosen = inside & (on_curve == sign)
                distinct = np.unique(x[chosen]).size
                if distinct >= 2:
                    degree = min(self.degree, max(1, distinct // 4))
                    fitted[side] = np.asarray(Polynomial.fit(x[chosen], y[chosen], degree).convert().coef, dtype=float)
            if not fitted:
                raise InputError(
                    f"no sample lies on the {branch} curve: every half cycle is shorter than the transition; "
                    "give a recording with a larger stroke or a smaller end_margin"
                )
            for side, other in (("pos", "neg"), ("neg", "pos")):
                if side not in fitted:
                    # Continue the known side straight through zero.
                    known = Polynomial(fitted[other])
                    curves[f"{branch}_{side}"] = np.array([known(0.0), known.deriv()(0.0)])
                    self._note(f"no {branch} samples at {'x >= 0' if side == 'pos' else 'x < 0'}: continued from zero")
                else:
                    curves[f"{branch}_{side}"] = fitted[side]
        return curves

    def _note(self, text: str) -> None:
        if text not in self.notes_:
            self.notes_.append(text)

    def _fit_slopes(
        self, curves: dict[str, Any], table: Floats, runs: Sequence[Run], settled: NDArray[np.bool_]
    ) -> list[float]:
        x = np.concatenate([run.x for run in runs])
        y = np.concatenate([run.y for run in runs])
        least = [_steepest(curves, side) for side in ("pos", "neg")]
        slopes = [2.0 * value for value in least]
        for _ in range(2):
            for side, inside in enumerate((x >= 0.0, x < 0.0)):
                counted = inside & settled
                if not np.any(counted):
                    continue

                def error(logarithm: float, side: int = side, counted: NDArray[np.bool_] = counted) -> float:
                    trial = list(slopes)
                    trial[side] = least[side] * float(np.exp(logarithm))
                    params = _kernel_parameters(table, trial, curves["stroke"])
                    return float(np.mean((self._simulate(params, runs)[0] - y)[counted] ** 2))

                grid = np.linspace(1e-3, np.log(STEEPEST), 16)
                k = int(np.argmin([error(v) for v in grid]))
                bracket = (grid[max(k - 1, 0)], grid[min(k + 1, grid.size - 1)])
                found = minimize_scalar(error, bounds=bracket, method="bounded", options={"xatol": 1e-7})
                slopes[side] = least[side] * float(np.exp(found.x))
        return slopes

    @staticmethod
    def _simulate(params: tuple[Any, ...], runs: Sequence[Run]) -> tuple[Floats, Floats]:
        outputs, states = [], []
        for run in runs:
            y, on_curve = np.empty_like(run.x), np.empty_like(run.x)
            _run(run.x, _initial_state(0), params, y, on_curve)
            outputs.append(y)
            states.append(on_curve)
        return np.concatenate(outputs), np.concatenate(states)

    # ---- parameters ------------------------------------------------------------------------------------------------

    @classmethod
    def _check_parameters(
        cls,
        ascending_pos: Any,
        ascending_neg: Any,
        descending_pos: Any,
        descending_neg: Any,
        slope_pos: Any,
        slope_neg: Any,
        stroke: Any = None,
    ) -> dict[str, Any]:
        curves = dict(zip(CURVES, (ascending_pos, ascending_neg, descending_pos, descending_neg), strict=True))
        checked: dict[str, Any] = {name: parameter_array(name, value, (None,)) for name, value in curves.items()}
        for name, value in (("slope_pos", slope_pos), ("slope_neg", slope_neg)):
            checked[name] = parameter_number(name, value)
            if checked[name] <= 0.0:
                raise InputError(f"parameter {name} must be positive; it is {checked[name]}")
        checked["stroke"] = None
        if stroke is not None:
            checked["stroke"] = parameter_array("stroke", stroke, (2,))
            if checked["stroke"][0] >= checked["stroke"][1]:
                raise InputError("parameter stroke must be (lowest, highest) input")
        return checked

    def _prepare(self) -> None:
        p = self.parameters_
        stroke = np.array([-np.inf, np.inf]) if p["stroke"] is None else p["stroke"]
        self._params = _kernel_parameters(_table(p, stroke), (p["slope_pos"], p["slope_neg"]), stroke)

    def _check_conditions(self) -> list[Condition]:
        p = self.parameters_
        stroke = p["stroke"] if p["stroke"] is not None else np.array([-1.0, 1.0]) * self._input_scale()
        curves = {**{name: p[name] for name in CURVES}, "stroke": stroke}
        gaps, rises = [], []
        for side in ("pos", "neg"):
            grid = _side(stroke, side)
            ascending, descending = (Polynomial(p[f"{branch}_{side}"]) for branch in ("ascending", "descending"))
            gaps += list(zip((ascending(grid) - descending(grid)).tolist(), grid.tolist(), strict=True))
            for curve in (ascending, descending):
                rises += list(zip(curve.deriv()(grid).tolist(), grid.tolist(), strict=True))
        gap, gap_at = min(gaps)
        rise, rise_at = min(rises)
        conditions = [
            Condition("Eq. 14: the ascending curve lies above the descending one", gap >= 0.0,
                      f"smallest gap {gap:.4g} at x = {gap_at:.4g}"),
            Condition("Eq. 15: all four functions rise", rise > 0.0, f"smallest slope {rise:.4g} at x = {rise_at:.4g}"),
        ]  # fmt: skip
        for number, side, sign in ((19, "pos", "+"), (20, "neg", "-")):
            steepest = _steepest(curves, side)
            slope = p[f"slope_{side}"]
            conditions.append(
                Condition(
                    f"Eq. {number}: the transition slope s{sign} exceeds every derivative on its side",
                    slope > steepest,
                    f"s{sign} = {slope:.4g}, steepest derivative {steepest:.4g}",
                )
            )
        return conditions

    # ---- evaluation ------------------------------------------------------------------------------------------------

    def _predict_run(self, x: Floats) -> Floats:
        y = np.empty_like(x)
        _run(x, _initial_state(x.size), self._params, y, np.empty_like(x))
        return y

    def stepper(self) -> KernelStepper:
        self._require_fitted()
        return KernelStepper(
            _step,
            _initial_state,
            self._params,
            lambda x, state, params, out: _run(x, state, params, out, np.empty_like(x)),
        )

    def _invert_run(self, y: Floats, x0: float, approximate: bool) -> Floats:
        # Only the first sample has no line or curve to come from: it lies midway between the curves.
        first = float(super()._invert_run(y[:1], x0, approximate)[0])
        x = np.empty_like(y)
        reach = 4.0 * max(self._input_scale(), abs(x0))
        missed = _invert(y, first, _initial_state(0), self._params, x, reach)
        if missed == y.size:
            return x
        if approximate:
            return super()._invert_run(y, x0, approximate)
        raise InverseError(
            f"no input within {-reach:.4g} .. {reach:.4g} gives the output y[{missed}] = {y[missed]:.6g}: the curve "
            "ahead does not rise to it, or jumps over it at x = 0. "
            "Pass approximate=True (command line: --approximate) to take the nearest."
        )


def _table(curves: dict[str, Any], stroke: Floats) -> Floats:
    """The polynomials as rows of one table in the order of ``CURVES``.

    Beyond the stroke, where a polynomial would explode, a curve continues with its end slope: four rows for each end.
    """
    table = np.zeros((3 * len(CURVES), max(2, *(curves[name].size for name in CURVES))))
    for row, name in enumerate(CURVES):
        table[row, : curves[name].size] = curves[name]
        polynomial = Polynomial(curves[name])
        for beyond, end in zip((4, 8), stroke, strict=True):
            if np.isfinite(end):
                table[row + beyond, 1] = slope = polynomial.deriv()(end)
                table[row + beyond, 0] = polynomial(end) - slope * end
    return table


def _kernel_parameters(table: Floats, slopes: Sequence[float], stroke: Floats) -> tuple[Any, ...]:
    """The table of the polynomials, the transition slopes, the stroke."""
    return table, (float(slopes[0]), float(slopes[1])), (float(stroke[0]), float(stroke[1]))


def _since_turn(x: Floats, dead_band: float) -> Floats:
    """Deflection travelled since the last turn; 0 before the first one, where the memory is unknown."""
    points = turning_points(x, dead_band)
    start = np.zeros(x.size, dtype=np.intp)
    start[points[:-1]] = points[:-1]
    return np.abs(x - x[np.maximum.accumulate(start)])


def _side(stroke: Floats, side: str) -> Floats:
    """Grid over one side of zero of the stroke (its end nearest to zero where the stroke does not reach that side)."""
    low, high = stroke
    if side == "pos":
        return np.linspace(max(low, 0.0), max(high, 0.0), 201)
    return np.linspace(min(low, 0.0), min(high, 0.0), 201)


def _steepest(curves: dict[str, Any], side: str) -> float:
    """Largest derivative of both curves on one side of zero: s_min of Eqs. 19 and 20."""
    grid = _side(curves["stroke"], side)
    slopes = [Polynomial(curves[f"{branch}_{side}"]).deriv()(grid).max() for branch in ("ascending", "descending")]
    return max(*map(float, slopes), 1e-12)
