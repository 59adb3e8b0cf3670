"""The Bouc-Wen model: a linear spring beside a hysteretic state with its own differential equation.

Source: R. Bouc 1967; Y.-K. Wen, "Method for random vibration of hysteretic systems", J. Eng. Mech. 102(2), 1976;
conditions on the parameters: F. Ikhouane, J. Rodellar, "Systems with hysteresis", Wiley 2007.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np
from numba import njit
from scipy.optimize import least_squares

from ..errors import InputError
from .base import Condition, Floats, HysteresisModel, Run, parameter_number
from .motion import settled_from
from .separable import spread_points, thinned
from .stepping import KernelStepper

__all__ = ["BoucWen"]

# State: last input, hysteretic state z, started.
_X, _Z, _STARTED = 0, 1, 2

SUBSTEPS = 20_000
"""Bound on the substeps of one sample; only a state that grows without bound needs more."""

NEARLY = 2e-3
"""Rate over the initial one below which the approach to saturation is solved in closed form, to a relative 1e-9."""

GLOBAL_SAMPLES = 3000
LOWER = np.array([np.log(0.05), -3.0, 1.0])
UPPER = np.array([np.log(3000.0), 1.0, 6.0])
"""Search range of ln(beta + gamma), (gamma − beta) / (beta + gamma) and n, for an input of unit amplitude and A = 1."""


def _initial_state(capacity: int) -> Floats:
    return np.zeros(3)


@njit(cache=True)
def _scale(a, largest, n):
    """Size of the state at which the larger of both ``c`` would hold it; infinite where nothing does."""
    return (abs(a) / largest) ** (1.0 / n) if largest > 0.0 and a != 0.0 else np.inf


@njit(cache=True)
def _flow(q, d, a, c_pos, c_neg, n, scale):
    """q after the distance ``d`` along dq/dd = a − c |q|^n, with c = c_pos for q > 0 and c_neg for q < 0.

    ``scale`` is `_scale` of the larger |c|: a power, which one call for a whole recording spares every sample.
    """
    if not np.isfinite(q):
        return q
    if a > 0.0 and (n == 1.0 or n == 2.0):
        # Closed form. q rises through zero at most once: first up to there with c_neg, then on with c_pos.
        for side in range(2):
            c = c_neg if side == 0 else c_pos
            if side == 0 and q >= 0.0:
                continue
            if n == 1.0:
                # Below zero |q| = −q, so the rate is a + c q there and a − c q above.
                rate = c if side == 0 else -c
                if side == 0:
                    inside = 1.0 + rate * q / a
                    to_zero = np.inf
                    if rate == 0.0:
                        to_zero = -q / a
                    elif inside > 0.0:
                        to_zero = -np.log(inside) / rate
                    if d >= to_zero:
                        q = 0.0
                        d -= to_zero
                        continue
                if rate == 0.0:
                    return q + a * d
                return q * np.exp(rate * d) + a * np.expm1(rate * d) / rate
            if c == 0.0:
                if side == 0 and d >= -q / a:
                    d += q / a
                    q = 0.0
                    continue
                return q + a * d
            root = np.sqrt(a * abs(c))
            level = np.sqrt(a / abs(c))
            if c > 0.0:
                if side == 0 and -q < level:
                    to_zero = np.arctanh(-q / level) / root
                    if d >= to_zero:
                        q = 0.0
                        d -= to_zero
                        continue
                t = np.tanh(root * d)
                # Below −level, where nothing holds it, the state reaches minus infinity.
                below = 1.0 + q * t / level
                return (q + level * t) / below if below > 0.0 else -np.inf
            angle = np.arctan(q / level)
            if side == 0 and d >= -angle / root:
                d += angle / root
                q = 0.0
                continue
            angle += root * d
            # Negative c: the state reaches infinity at a quarter turn.
            return level * np.tan(angle) if angle < 0.5 * np.pi else np.inf
        return q
    # Runge-Kutta of fourth order. The step follows the local rate of contraction, and shrinks towards zero, where
    # |q|^n is not smooth; together that keeps the error below 1e-8 of the range of q.
    for _ in range(SUBSTEPS):
        c = c_pos if q > 0.0 else c_neg
        rate = a - c * abs(q) ** n
        # Saturated: the rest of the way changes nothing that the arithmetic can hold.
        if abs(rate) * d <= 1e-16 * abs(q) or (abs(rate) <= 1e-13 * abs(a) and c > 0.0 and q > 0.0):
            return q
        if a > 0.0 and c > 0.0 and q > 0.0 and abs(rate) < NEARLY * a:
            # What is missing, r = 1 − c q^n / a, obeys dr/dd = −n a / level (1 − r)^bent r: closed once linear in r.
            level = (a / c) ** (1.0 / n)
            bent = 1.0 - 1.0 / n
            missing = rate / a
            missing = missing / (1.0 - bent * missing) * np.exp(-n * a / level * d)
            return level * (1.0 - missing / (1.0 + bent * missing)) ** (1.0 / n)
        h = d
        if a != 0.0 and scale < np.inf:
            h = min(h, max(0.5 * abs(q), 2e-4 * scale) / abs(a))
        # The rate of contraction where the step will end, which for large n is much larger than where it begins.
        ahead = min(abs(q) + abs(a) * h, max(abs(q), scale))
        # At most that of the larger c at ``scale``, |a| / scale: where even that is far from the bound no power is taken.
        if a == 0.0 or ahead > scale or h * n * abs(a) > 0.03 * scale:
            bend = n * abs(c) * ahead ** (n - 1.0)
            if bend > 0.0:
                h = min(h, 0.04 / bend)
        k1 = rate
        p = q + 0.5 * h * k1
        k2 = a - (c_pos if p > 0.0 else c_neg) * abs(p) ** n
        p = q + 0.5 * h * k2
        k3 = a - (c_pos if p > 0.0 else c_neg) * abs(p) ** n
        p = q + h * k3
        k4 = a - (c_pos if p > 0.0 else c_neg) * abs(p) ** n
        q += h * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0
        d -= h
        if d <= 0.0:
            return q
    return np.inf


@njit(cache=True)
def _run(x, state, params, out):
    # The state is held in local variables meanwhile: through the array each sample would cost up to four times as much.
    elastic, hysteretic, offset, a, beta, gamma, n = params
    started = state[_STARTED] != 0.0
    last = state[_X]
    z = state[_Z]
    scale = _scale(a, max(abs(gamma + beta), abs(gamma - beta)), n)
    for i in range(x.size):
        now = x[i]
        if not started:
            started = True
            last = now
        if now > last:
            z = _flow(z, now - last, a, gamma + beta, gamma - beta, n, scale)
        elif now < last:
            z = -_flow(-z, last - now, a, gamma + beta, gamma - beta, n, scale)
        last = now
        out[i] = elastic * now + hysteretic * z + offset
    state[_STARTED] = 1.0 if started else 0.0
    state[_X] = last
    state[_Z] = z


@njit(cache=True)
def _step(x, state, params, commit):
    one = np.full(1, x)
    _run(one, state if commit else state.copy(), params, one)
    return one[0]


class BoucWen(HysteresisModel):
    """Bouc-Wen: an elastic spring beside a hysteretic one whose state z obeys a differential equation in x.

    ``y = alpha·stiffness·x + (1 − alpha)·stiffness·z + offset``, ``dz = [A − |z|^n (beta sgn(dx z) + gamma)] dx``.
    The state z is 0 at the first sample. Integration is exact for n = 1 and n = 2 (with A > 0); otherwise its error
    stays below 1e-6 of the range, whatever the sampling.

    Parameters
    ----------
    n : float, optional
        Fix the exponent (at least 1); None identifies it.
    starts : int
        Points of the global search; a power of two.
    seed : int
        Seed of the global search.

    Notes
    -----
    ``from_parameters`` takes ``stiffness``, ``alpha``, ``A``, ``beta``, ``gamma``, ``n`` and optionally ``offset``.
    """

    id: ClassVar[str] = "bouc-wen"
    title: ClassVar[str] = "Bouc-Wen"
    summary: ClassVar[str] = "a differential equation with five parameters; smooth symmetric loops"
    use_for: ClassVar[str] = (
        "smooth symmetric loops of dampers, joints and structures, when a differential equation with few parameters "
        "must go into a simulator"
    )
    not_for: ClassVar[str] = "asymmetric or strongly bent loops, and strict return-point memory: its minor loops drift"
    source: ClassVar[str] = "Wen 1976; Ikhouane & Rodellar 2007"
    references: ClassVar[tuple[str, ...]] = ("wen1976",)
    search_grid: ClassVar[Mapping[str, Sequence[Any]]] = {"n": (None, 1.0, 2.0)}
    estimated: ClassVar[tuple[str, ...] | None] = ("stiffness", "alpha", "beta", "gamma", "n", "offset")

    def __init__(self, n: float | None = None, starts: int = 256, seed: int = 0) -> None:
        self.n = n
        self.starts = starts
        self.seed = seed

    # ---- identification --------------------------------------------------------------------------------------------

    def _identify(self, runs: Sequence[Run]) -> dict[str, Any]:
        if self.n is not None and self.n < 1.0:
            raise InputError(f"n must be at least 1; it is {self.n}")
        if self.starts < 1:
            raise InputError(f"starts must be at least 1; it is {self.starts}")
        amplitude = max(float(np.ptp(run.x)) for run in runs) / 2.0
        scaled = [Run(run.x / amplitude, run.y) for run in runs]
        lower, upper = LOWER.copy(), UPPER.copy()
        if self.n is not None:
            lower[2], upper[2] = self.n - 1e-12, self.n + 1e-12
        sparse = thinned(scaled, GLOBAL_SAMPLES)
        near = self.search_from
        start = self._searched(sparse, lower, upper) if near is None else np.clip(near, lower, upper)
        is_thinned = sum(run.x.size for run in scaled) > sum(run.x.size for run in sparse)
        tolerances: dict[str, Any] = {} if is_thinned else {"xtol": 1e-14, "ftol": 1e-14, "gtol": 1e-14}
        best = least_squares(
            _residuals, start, bounds=(lower, upper), x_scale=(1.0, 0.5, 0.5), args=(scaled,), **tolerances
        )
        self.search_ended_ = best.x
        return self._physical(best.x, scaled, amplitude, lower, upper)

    def _searched(self, runs: Sequence[Run], lower: Floats, upper: Floats) -> Floats:
        """The best point of a search everywhere between the bounds, in the search's coordinates."""
        points = spread_points(lower, upper, self.starts, self.seed)
        costs = [_cost(_residuals(point, runs)) for point in points]
        # Very different parameters give nearly the same loop: refine the best few, keep the best of them.
        found = [
            least_squares(
                _residuals, points[k], bounds=(lower, upper), x_scale=(1.0, 0.5, 0.5), ftol=1e-5, args=(runs,)
            )
            for k in np.argsort(costs, kind="stable")[:4]
        ]
        return np.asarray(min(found, key=lambda result: result.cost).x)

    def _physical(
        self, point: Floats, runs: Sequence[Run], amplitude: float, lower: Floats, upper: Floats
    ) -> dict[str, Any]:
        """From the search's coordinates on the scaled input to the model's parameters."""
        (elastic, hysteretic, offset), _ = _linear(point, runs)
        total, ratio, n = float(np.exp(point[0])), float(point[1]), float(point[2])
        for value, low, high, name in zip(
            point, lower, upper, ("beta + gamma", "(gamma - beta) / (beta + gamma)", "n"), strict=True
        ):
            if high - low > 1e-9 and (value - low < 1e-4 * (high - low) or high - value < 1e-4 * (high - low)):
                self.notes_.append(f"{name} is at its bound: this recording does not determine it")
        self.notes_.append(
            "A is fixed to 1: the equations do not change when z, A, beta and gamma are rescaled together"
        )
        # The state is kept in units of the input, so that A = 1: z = amplitude * z_scaled.
        factor = amplitude**-n
        stiffness = (elastic + hysteretic) / amplitude
        if abs(stiffness) < 1e-12 * (abs(elastic) + abs(hysteretic)) / amplitude:
            stiffness = 1e-12 * (abs(elastic) + abs(hysteretic)) / amplitude
        return {
            "stiffness": stiffness,
            "alpha": elastic / amplitude / stiffness,
            "A": 1.0,
            "beta": 0.5 * total * (1.0 - ratio) * factor,
            "gamma": 0.5 * total * (1.0 + ratio) * factor,
            "n": n if self.n is None else float(self.n),
            "offset": offset,
        }

    # ---- parameters ------------------------------------------------------------------------------------------------

    @classmethod
    def _check_parameters(
        cls,
        stiffness: Any,
        alpha: Any,
        A: Any,
        beta: Any,
        gamma: Any,
        n: Any,
        offset: Any = 0.0,
    ) -> dict[str, Any]:
        values = {
            "stiffness": stiffness, "alpha": alpha, "A": A, "beta": beta, "gamma": gamma, "n": n, "offset": offset,
        }  # fmt: skip
        checked = {name: parameter_number(name, value) for name, value in values.items()}
        if checked["n"] < 1.0:
            raise InputError(f"parameter n must be at least 1; it is {checked['n']}")
        return checked

    def _prepare(self) -> None:
        p = self.parameters_
        self._params = (
            p["alpha"] * p["stiffness"], (1.0 - p["alpha"]) * p["stiffness"], p["offset"],
            p["A"], p["beta"], p["gamma"], p["n"],
        )  # fmt: skip

    def _check_conditions(self) -> list[Condition]:
        p = self.parameters_
        told = f"A = {p['A']:.4g}, beta = {p['beta']:.4g}, gamma = {p['gamma']:.4g}"
        bounded = p["A"] > 0.0 and p["beta"] + p["gamma"] > 0.0 and p["beta"] - p["gamma"] >= 0.0
        dissipates = p["A"] > 0.0 and p["beta"] >= abs(p["gamma"]) and (1.0 - p["alpha"]) * p["stiffness"] >= 0.0
        return [
            Condition(
                "the state stays bounded: A > 0, -beta < gamma <= beta (class I of Ikhouane & Rodellar)", bounded, told
            ),
            Condition("every closed loop dissipates: beta >= |gamma| and (1 - alpha) stiffness >= 0", dissipates, told),
        ]

    def _input_scale(self) -> float:
        p = self.parameters_
        if hasattr(self, "x_scale_") or p["A"] <= 0.0 or p["beta"] + p["gamma"] <= 0.0:
            return super()._input_scale()
        # Ten times the input over which the state would saturate at its initial slope.
        return float(10.0 * (p["A"] / (p["beta"] + p["gamma"])) ** (1.0 / p["n"]) / p["A"])

    # ---- evaluation ------------------------------------------------------------------------------------------------

    def _predict_run(self, x: Floats) -> Floats:
        y = np.empty_like(x)
        _run(x, _initial_state(x.size), self._params, y)
        if not np.isfinite(y[-1]):
            bad = int(np.flatnonzero(~np.isfinite(y))[0])
            raise InputError(
                f"the state z grows without bound at sample {bad} (x = {x[bad]:.6g}): "
                "with beta + gamma < 0 the model only holds for small inputs"
            )
        return y

    def stepper(self) -> KernelStepper:
        self._require_fitted()
        return KernelStepper(_step, _initial_state, self._params, _run)


def _states(point: Floats, runs: Sequence[Run]) -> list[Floats]:
    """The hysteretic state over every run, for A = 1."""
    total, ratio, n = float(np.exp(point[0])), float(point[1]), float(point[2])
    params = (0.0, 1.0, 0.0, 1.0, 0.5 * total * (1.0 - ratio), 0.5 * total * (1.0 + ratio), n)
    states = []
    for run in runs:
        z = np.empty_like(run.x)
        _run(run.x, _initial_state(0), params, z)
        states.append(z)
    return states


def _linear(point: Floats, runs: Sequence[Run]) -> tuple[Floats, Floats]:
    """Best elastic and hysteretic stiffness and offset for a given state equation, and the residuals they leave."""
    states = _states(point, runs)
    parts = [slice(settled_from(run.x), None) for run in runs]
    x = np.concatenate([run.x[part] for run, part in zip(runs, parts, strict=True)])
    y = np.concatenate([run.y[part] for run, part in zip(runs, parts, strict=True)])
    z = np.concatenate([state[part] for state, part in zip(states, parts, strict=True)])
    design = np.column_stack([x, z, np.ones_like(x)])
    if not np.all(np.isfinite(z)):
        return np.zeros(3), np.full(y.size, 1e6 * max(float(np.ptp(y)), 1.0))
    solution = np.linalg.lstsq(design, y, rcond=1e-12)[0]
    return solution, design @ solution - y


def _residuals(point: Floats, runs: Sequence[Run]) -> Floats:
    return _linear(point, runs)[1]


def _cost(residuals: Floats) -> float:
    return float(residuals @ residuals)
