"""The generalized Maxwell-slip friction model beside a spring: parallel elements that stick, then slip with a lag.

Source: F. Al-Bender, V. Lampaert, J. Swevers, "The generalized Maxwell-slip model: a novel model for friction
simulation and compensation", IEEE Trans. Automatic Control 50(11), 2005.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
from numba import njit

from ..errors import InputError
from .base import Condition, Floats, HysteresisModel, Run, parameter_array, parameter_number, sampling_intervals
from .inversion import invert_by_search
from .separable import fit_separable, largest_speed, powers, unscaled
from .stepping import ClockedStepper, TimedStepper

__all__ = ["GeneralizedMaxwellSlip"]

# State: last input, started; then for each element its force over its Coulomb friction and the
# direction in which it slips (0: it sticks).
_X, _STARTED, _ELEMENTS = 0, 1, 2

LOWER, UPPER = (1.0, np.log(0.003), 0.0), (3.0, np.log(3.0), np.log(1000.0))
"""Search range of static / coulomb, ln(stribeck_speed / largest speed), ln(attraction · amplitude / largest speed)."""


@njit(cache=True)
def _advance(x, dt, state, params):
    """Move every element to ``x`` at constant speed within ``dt``; returns the speed."""
    rates, static, stribeck, attraction = params
    if state[_STARTED] == 0.0:
        state[_STARTED] = 1.0
        state[_X] = x
    v = (x - state[_X]) / dt if dt > 0.0 else 0.0
    state[_X] = x
    if v == 0.0:
        # Elements slip until the speed goes through zero.
        for i in range(rates.size):
            state[_ELEMENTS + 2 * i + 1] = 0.0
        return v
    sign = 1.0 if v > 0.0 else -1.0
    level = 1.0 + (static - 1.0) * np.exp(-((v / stribeck) ** 2))
    kept = np.exp(-attraction / level * dt)
    for i in range(rates.size):
        force = sign * state[_ELEMENTS + 2 * i]
        if state[_ELEMENTS + 2 * i + 1] == sign:
            force = level + (force - level) * kept
        elif force > level:
            # The level has sunk below the force: the element breaks away at once.
            state[_ELEMENTS + 2 * i + 1] = sign
            force = level + (force - level) * kept
        else:
            force += rates[i] * abs(v) * dt
            state[_ELEMENTS + 2 * i + 1] = 0.0
            if force >= level:
                state[_ELEMENTS + 2 * i + 1] = sign
                force = level
        state[_ELEMENTS + 2 * i] = sign * force
    return v


@njit(cache=True)
def _output(x, v, state, params):
    spring, strength, viscous = params
    y = 0.0
    for k in range(spring.size - 1, -1, -1):
        y = y * x + spring[k]
    y += viscous * v
    for i in range(strength.size):
        y += strength[i] * state[_ELEMENTS + 2 * i]
    return y


@njit(cache=True)
def _step(x, dt, state, params, commit):
    state = state if commit else state.copy()
    return _output(x, _advance(x, dt, state, params[0]), state, params[1])


@njit(cache=True)
def _run(x, dt, state, params, out):
    for i in range(x.size):
        out[i] = _output(x[i], _advance(x[i], dt[i], state, params[0]), state, params[1])


@njit(cache=True)
def _elements(x, dt, state, params, out):
    for i in range(x.size):
        out[i, -1] = _advance(x[i], dt[i], state, params)
        for j in range(out.shape[1] - 1):
            out[i, j] = state[_ELEMENTS + 2 * j]


class GeneralizedMaxwellSlip(HysteresisModel):
    """Spring and generalized Maxwell-slip friction; rate-dependent, so it takes ``time``.

    ``y = Σ spring_k x^k + Σ F_i + viscous v``. Element i sticks, ``dF_i/dt = stiffness_i v``, until F_i reaches
    strength_i s(v); then it slips, ``dF_i/dt = sgn(v) attraction strength_i (1 − F_i / (strength_i s(v)))``, until v
    goes through zero, with ``s(v) = sgn(v) [1 + (static_ratio − 1) exp(−(v / stribeck_speed)²)]``, v = dx/dt. All F_i
    are 0 at the first sample. Between samples v is taken as constant; both laws are then integrated exactly.

    Parameters
    ----------
    elements : int
        Elements to choose from; they break away (at low speed) at fixed distances that grow quadratically up to a quarter of
        the input's range (one that hardly slips is a spring), and those without strength are dropped.
    spring_degree : int
        Degree of the spring's polynomial.
    starts, seed : int
        Points of the global search and its seed.

    Notes
    -----
    ``from_parameters`` takes ``stiffness`` (N,), ``strength`` (N,) (Coulomb friction of each element), ``static_ratio``,
    ``stribeck_speed``, ``attraction`` (1/s), ``viscous`` and optionally ``spring`` (k,), coefficients in increasing powers.
    """

    id: ClassVar[str] = "generalized-maxwell-slip"
    title: ClassVar[str] = "Generalized Maxwell-slip"
    summary: ClassVar[str] = "polynomial spring and parallel stick-slip elements with frictional lag; rate-dependent"
    use_for: ClassVar[str] = (
        "friction with presliding memory and stick-slip beside a spring, when both nested loops and several speeds "
        "were recorded"
    )
    not_for: ClassVar[str] = (
        "recordings without slow motion, which do not show the elements' break-away, and control that needs an "
        "inverse in closed form"
    )
    source: ClassVar[str] = "Al-Bender et al. 2005"
    references: ClassVar[tuple[str, ...]] = ("al-bender2005",)
    rate_independent: ClassVar[bool] = False
    extended: ClassVar[bool] = True

    def __init__(self, elements: int = 8, spring_degree: int = 5, starts: int = 32, seed: int = 0) -> None:
        self.elements = elements
        self.spring_degree = spring_degree
        self.starts = starts
        self.seed = seed

    def _identify(self, runs: Sequence[Run]) -> dict[str, Any]:
        if self.elements < 1 or self.spring_degree < 0 or self.starts < 1:
            raise InputError("generalized-maxwell-slip needs elements >= 1, spring_degree >= 0 and starts >= 1")
        scale = max(float(np.max(np.abs(run.x))) for run in runs)
        amplitude = 0.5 * max(float(np.ptp(run.x)) for run in runs)
        speed = largest_speed(runs)
        breakaway = 0.5 * amplitude * (np.arange(1, self.elements + 1) / self.elements) ** 2

        def constants(point: Floats) -> tuple[Floats, float, float, float]:
            static = float(point[0])
            return (
                static / breakaway,
                static,
                float(np.exp(point[1])) * speed,
                float(np.exp(point[2])) * speed / amplitude,
            )

        def regressors(point: Floats, run: Run) -> Floats:
            forces = np.empty((run.x.size, self.elements + 1))
            intervals = sampling_intervals(run.time, run.x.size)
            _elements(run.x, intervals, np.zeros(_ELEMENTS + 2 * self.elements), constants(point), forces)
            return np.column_stack([powers(run.x / scale, self.spring_degree), forces])

        sign = [False] * (self.spring_degree + 1) + [True] * (self.elements + 1)
        point, found = fit_separable(
            regressors, runs, LOWER, UPPER, sign, self.starts, self.seed, near=self.search_from
        )
        self.search_ended_ = point
        for value, low, high, name in zip(
            point, LOWER, UPPER, ("static_ratio", "stribeck_speed", "attraction"), strict=True
        ):
            if min(value - low, high - value) < 1e-3 * (high - low):
                self.notes_.append(f"{name} is at its bound: this recording does not determine it")
        strength = found[self.spring_degree + 1 : -1]
        # A recording without friction leaves no element; one without force keeps the model defined.
        used = strength > 1e-9 * max(float(np.max(strength)), 1e-20)
        used[0] |= not np.any(used)
        strength = np.maximum(strength[used], 1e-30)
        rates, static, stribeck, attraction = constants(point)
        return {
            "stiffness": strength * rates[used],
            "strength": strength,
            "static_ratio": static,
            "stribeck_speed": stribeck,
            "attraction": attraction,
            "viscous": float(found[-1]),
            "spring": unscaled(found[: self.spring_degree + 1], scale),
        }

    @classmethod
    def _check_parameters(
        cls,
        stiffness: Any,
        strength: Any,
        static_ratio: Any,
        stribeck_speed: Any,
        attraction: Any,
        viscous: Any,
        spring: Any = (0.0,),
    ) -> dict[str, Any]:
        values = {
            "static_ratio": static_ratio, "stribeck_speed": stribeck_speed, "attraction": attraction, "viscous": viscous,
        }  # fmt: skip
        checked: dict[str, Any] = {name: parameter_number(name, value) for name, value in values.items()}
        for name in ("static_ratio", "stribeck_speed", "attraction"):
            if checked[name] <= 0.0:
                raise InputError(f"parameter {name} must be positive; it is {checked[name]}")
        strength = parameter_array("strength", strength, (None,))
        stiffness = parameter_array("stiffness", stiffness, (strength.size,))
        for name, array in (("strength", strength), ("stiffness", stiffness)):
            if np.any(array <= 0.0):
                raise InputError(f"parameter {name} must be positive for every element")
        return {
            "stiffness": stiffness,
            "strength": strength,
            **checked,
            "spring": parameter_array("spring", spring, (None,)),
        }

    def _prepare(self) -> None:
        p = self.parameters_
        self._params = (
            (p["stiffness"] / p["strength"], p["static_ratio"], p["stribeck_speed"], p["attraction"]),
            (p["spring"], p["strength"], p["viscous"]),
        )

    def _check_conditions(self) -> list[Condition]:
        p = self.parameters_
        return [
            Condition("static friction is at least Coulomb friction", p["static_ratio"] >= 1.0,
                      f"static_ratio {p['static_ratio']:.4g}"),
            Condition("viscous friction does not drive the motion", p["viscous"] >= 0.0, f"viscous {p['viscous']:.4g}"),
        ]  # fmt: skip

    def _initial_state(self) -> Floats:
        return np.zeros(_ELEMENTS + 2 * self.parameters_["strength"].size)

    def _predict_timed(self, x: Floats, time: Floats | None) -> Floats:
        y = np.empty_like(x)
        _run(x, sampling_intervals(time, x.size), self._initial_state(), self._params, y)
        return y

    def _invert_timed(self, y: Floats, time: Floats | None, x0: float, approximate: bool) -> Floats:
        clocked = ClockedStepper(self.stepper(), sampling_intervals(time, y.size))
        return invert_by_search(clocked, y, x0, self._input_scale(), approximate)

    def stepper(self) -> TimedStepper:
        self._require_fitted()
        return TimedStepper(_step, self._initial_state, self._params, _run)
