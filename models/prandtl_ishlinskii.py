"""The Prandtl-Ishlinskii model: a weighted sum of play operators, with its inverse in closed form.

Source: K. Kuhnen, H. Janocha, "Inverse feedforward controller for complex hysteretic nonlinearities in smart-material
systems", Control and Intelligent Systems 29(3), 2001; P. Krejci, K. Kuhnen, "Inverse control of systems with
hysteresis and creep", IEE Proc. Control Theory Appl. 148(3), 2001.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, ClassVar

import numpy as np
from numba import njit

from ..errors import InputError
from .base import Condition, Floats, HysteresisModel, InverseError, Run, parameter_array, parameter_number
from .least_squares import blocks, nonnegative, reduced
from .motion import settled_from
from .stepping import KernelStepper

# State: number of stored reversals, last input, last output, last direction, started; then the reversals (x, y).
_COUNT, _X, _Y, _DIRECTION, _STARTED, _STACK = 0, 1, 2, 3, 4, 5


def _initial_state(capacity: int) -> Floats:
    # Setting the whole stack to zero would take as long as a prediction.
    state = np.empty(_STACK + 2 * (capacity + 2))
    state[:_STACK] = 0.0
    return state


@njit(cache=True)
def _run(x, state, params, out):
    # The state is held in local variables meanwhile: through the array each sample would cost ten times as much.
    thresholds, slopes, intercepts, per_step, offset = params
    started = state[_STARTED] != 0.0
    n = int(state[_COUNT])
    last = state[_X]
    y = state[_Y]
    direction = state[_DIRECTION]
    for i in range(x.size):
        now = x[i]
        if not started:
            # From the demagnetised origin the operators have moved to x along the initial loading curve.
            started = True
            direction = np.sign(now)
        elif now != last:
            towards = 1.0 if now > last else -1.0
            if towards == -direction:
                state[_STACK + 2 * n] = last
                state[_STACK + 2 * n + 1] = y
                n += 1
            direction = towards
            # Wiping-out: a minor loop is forgotten once the input passes the reversal at which it began.
            while n >= 2 and direction * (now - state[_STACK + 2 * n - 4]) >= 0.0:
                n -= 2
            if n == 1 and abs(now) >= abs(state[_STACK]):
                n = 0
        else:
            out[i] = y + offset
            continue
        # On the initial loading curve, or on its double that begins at the last reversal.
        way = abs(now) if n == 0 else 0.5 * abs(now - state[_STACK + 2 * n - 2])
        if per_step > 0.0:
            # The bound comes first: a float beyond the integers has no meaningful int().
            k = int(min(way * per_step, thresholds.size - 1.0))
        else:
            k = max(np.searchsorted(thresholds, way) - 1, 0)
        # Initial loading curve: sum of w_i max(way - r_i, 0).
        rise = slopes[k] * way - intercepts[k]
        if n == 0:
            y = rise if now >= 0.0 else -rise
        elif now > state[_STACK + 2 * n - 2]:
            y = state[_STACK + 2 * n - 1] + 2.0 * rise
        else:
            y = state[_STACK + 2 * n - 1] - 2.0 * rise
        last = now
        out[i] = y + offset
    state[_STARTED] = 1.0 if started else 0.0
    state[_COUNT] = n
    state[_X] = last
    state[_Y] = y
    state[_DIRECTION] = direction


@njit(cache=True)
def _step(x, state, params, commit):
    one = np.full(1, x)
    _run(one, state if commit else state.copy(), params, one)
    return one[0]


@njit(cache=True)
def _plays(x, thresholds, state, out):
    """Every play operator's output at every sample, shape (n, N); ``state`` (N,) goes on from call to call."""
    for i in range(x.size):
        for j in range(thresholds.size):
            p = min(max(state[j], x[i] - thresholds[j]), x[i] + thresholds[j])
            state[j] = p
            out[i, j] = p


def _kernel_parameters(
    weights: Floats, thresholds: Floats, offset: float
) -> tuple[Floats, Floats, Floats, float, float]:
    """Prefix sums that make the initial loading curve one multiply-add, and the grid step if thresholds are uniform."""
    steps = np.diff(thresholds)
    uniform = steps.size > 0 and np.allclose(steps, steps[0], rtol=1e-9, atol=0.0)
    per_step = (thresholds.size - 1) / thresholds[-1] if uniform else 0.0
    return thresholds, np.cumsum(weights), np.cumsum(weights * thresholds), per_step, offset


class PrandtlIshlinskii(HysteresisModel):
    """Weighted play operators: y = offset + Σ w_i P_{r_i}[x].

    The play operator P_r follows the input with a dead zone of half width r; before the first sample it is 0, so that
    P(0) = clip(0, x0 − r, x0 + r). Evaluated through the stack of reversals, so the cost of a sample does not depend
    on the number of operators.

    Parameters
    ----------
    operators : int
        Number of play operators; their thresholds divide half the input's range evenly.
    weights : {"invertible", "nonnegative", "free"}
        ``"invertible"`` keeps every partial sum w_0 + … + w_k positive: that is what the inverse needs, and it admits
        negative weights, hence loops of either orientation. ``"nonnegative"`` makes counter-clockwise loops only.
    least_slope : float
        With ``"invertible"``: smallest partial sum, as a fraction of the loop's mean slope. The inverse is as steep as
        this is small.

    Notes
    -----
    ``from_parameters`` takes ``weights`` (N,), ``thresholds`` (N,) increasing from 0, and optionally ``offset``.
    """

    id: ClassVar[str] = "prandtl-ishlinskii"
    title: ClassVar[str] = "Prandtl-Ishlinskii"
    summary: ClassVar[str] = "weighted play operators, closed-form inverse; symmetric loops of either orientation"
    use_for: ClassVar[str] = (
        "symmetric loops with memory (piezo stages, gears, springs with friction), when an inverse in closed form "
        "must run in a controller"
    )
    not_for: ClassVar[str] = "loops that are asymmetric, stiffen or saturate: use modified-prandtl-ishlinskii there"
    source: ClassVar[str] = "Kuhnen & Janocha 2001; Krejci & Kuhnen 2001"
    references: ClassVar[tuple[str, ...]] = ("krejci-kuhnen2001",)
    search_grid: ClassVar[Mapping[str, Sequence[Any]]] = {"operators": (10, 20, 40, 80)}
    estimated: ClassVar[tuple[str, ...] | None] = ("weights", "offset")

    def __init__(self, operators: int = 40, weights: str = "invertible", least_slope: float = 0.1) -> None:
        self.operators = operators
        self.weights = weights
        self.least_slope = least_slope

    def _identify(self, runs: Sequence[Run]) -> dict[str, Any]:
        if self.weights not in ("invertible", "nonnegative", "free"):
            raise InputError(f"weights must be 'invertible', 'nonnegative' or 'free'; it is {self.weights!r}")
        if self.operators < 1:
            raise InputError(f"operators must be at least 1; it is {self.operators}")
        if not 0.0 < self.least_slope < 1.0:
            raise InputError(f"least_slope must lie between 0 and 1; it is {self.least_slope}")
        # Beyond half the largest range a play operator never moves back: its threshold could not be identified.
        reach = 0.5 * max(float(np.ptp(run.x)) for run in runs)
        thresholds = reach * np.arange(self.operators) / self.operators
        weights, offset = self._solve(runs, thresholds)
        return {"weights": weights, "thresholds": thresholds, "offset": offset}

    def _solve(self, runs: Sequence[Run], thresholds: Floats) -> tuple[Floats, float]:
        if self.weights == "free":
            rows = reduced(
                np.column_stack([plays, np.ones(y.size), y]) for _, plays, y in self._settled(runs, thresholds)
            )
            free: Floats = np.asarray(np.linalg.lstsq(rows[:, :-1], rows[:, -1], rcond=1e-10)[0], dtype=np.float64)
            return free[:-1], float(free[-1])
        floor = 0.0
        if self.weights == "invertible":
            # Relative to the loop's mean slope.
            settled = [(run.x[settled_from(run.x) :], run.y[settled_from(run.x) :]) for run in runs]
            x, y = (np.concatenate(parts) for parts in zip(*settled, strict=True))
            floor = self.least_slope * float(np.ptp(y)) / max(float(np.ptp(x)), 1e-300)

        def rows_of(x: Floats, plays: Floats, y: Floats) -> Floats:
            if self.weights == "invertible":
                # In the partial sums W_k the model is Σ W_k (P_k − P_{k+1}) + W_N P_N, so W_k > 0 bounds an unknown;
                # all columns together are P_0, the input.
                plays[:, :-1] -= plays[:, 1:]
                y = y - floor * x
            ones = np.ones(y.size)
            return np.column_stack([plays, ones, -ones, y])

        solution = nonnegative(reduced(rows_of(*part) for part in self._settled(runs, thresholds)))
        weights = solution[:-2] + floor
        if self.weights == "invertible":
            weights = np.diff(weights, prepend=0.0)
        return weights, float(solution[-2] - solution[-1])

    @staticmethod
    def _settled(runs: Sequence[Run], thresholds: Floats) -> Iterator[tuple[Floats, Floats, Floats]]:
        """Input, every play operator's output (n, N) and measured output of all settled samples, in blocks."""
        for run in runs:
            state = np.zeros(thresholds.size)
            first = settled_from(run.x)
            for part in blocks(run.x.size):
                plays = np.empty((part.stop - part.start, thresholds.size))
                _plays(run.x[part], thresholds, state, plays)
                kept = slice(max(first - part.start, 0), None)
                yield run.x[part][kept], plays[kept], run.y[part][kept]

    @classmethod
    def _check_parameters(cls, weights: Any, thresholds: Any, offset: Any = 0.0) -> dict[str, Any]:
        thresholds = parameter_array("thresholds", thresholds, (None,))
        weights = parameter_array("weights", weights, (thresholds.size,))
        if thresholds[0] != 0.0 or np.any(np.diff(thresholds) <= 0.0):
            raise InputError("parameter thresholds must increase strictly and begin with 0")
        return {"weights": weights, "thresholds": thresholds, "offset": parameter_number("offset", offset)}

    def _prepare(self) -> None:
        p = self.parameters_
        self._params = _kernel_parameters(p["weights"], p["thresholds"], p["offset"])

    def _check_conditions(self) -> list[Condition]:
        partial = np.cumsum(self.parameters_["weights"])
        bad = np.flatnonzero(partial <= 0.0)
        detail = f"smallest partial sum {partial.min():.4g}"
        if bad.size:
            detail += f", first at threshold {self.parameters_['thresholds'][bad[0]]:.4g}"
        return [Condition("every partial sum of the weights is positive (the inverse exists)", not bad.size, detail)]

    def _predict_run(self, x: Floats) -> Floats:
        y = np.empty_like(x)
        _run(x, _initial_state(x.size), self._params, y)
        return y

    def stepper(self) -> KernelStepper:
        self._require_fitted()
        return KernelStepper(_step, _initial_state, self._params, _run)

    def _invert_run(self, y: Floats, x0: float, approximate: bool) -> Floats:
        weights, thresholds, offset = (self.parameters_[k] for k in ("weights", "thresholds", "offset"))
        partial = np.cumsum(weights)
        bad = np.flatnonzero(partial <= 0.0)
        if bad.size:
            if approximate:
                return super()._invert_run(y, x0, approximate)
            raise InverseError(
                f"no inverse exists: the partial sum of the weights up to threshold {thresholds[bad[0]]:.4g} is "
                f"{partial[bad[0]]:.4g}, not positive, so the output does not rise with the input there. "
                "Fit with weights='invertible', or pass approximate=True (command line: --approximate)."
            )
        # The inverse is again a sum of play operators: its loading curve is this one's with the axes exchanged.
        inverse_thresholds = partial * thresholds - np.cumsum(weights * thresholds)
        params = _kernel_parameters(np.diff(1.0 / partial, prepend=0.0), inverse_thresholds, 0.0)
        x = np.empty_like(y)
        _run(y - offset, _initial_state(y.size), params, x)
        return x
