"""The LuGre friction model beside a spring: bristles with Stribeck effect, micro-damping and viscous friction.

Source: C. Canudas de Wit, H. Olsson, K. J. Åström, P. Lischinsky, "A new model for control of systems with friction",
IEEE Trans. Automatic Control 40(3), 1995.
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

__all__ = ["LuGre"]

# State: last input, mean deflection of the bristles, started.
_X, _Z, _STARTED = 0, 1, 2

LOWER, UPPER = (np.log(0.3), 1.0, np.log(0.003)), (np.log(1000.0), 3.0, np.log(3.0))
"""Search range of ln(stiffness · amplitude / coulomb), static / coulomb and ln(stribeck_speed / largest speed)."""


def _initial_state() -> Floats:
    return np.zeros(3)


@njit(cache=True)
def _advance(x, dt, state, params):
    """Mean bristle deflection, its rate and the input's rate after moving to ``x`` at constant speed within ``dt``."""
    stiffness, coulomb, static, stribeck = params
    if state[_STARTED] == 0.0:
        state[_STARTED] = 1.0
        state[_X] = x
    v = (x - state[_X]) / dt if dt > 0.0 else 0.0
    rate = 0.0
    if v != 0.0:
        level = coulomb + (static - coulomb) * np.exp(-((v / stribeck) ** 2))
        end = level / stiffness if v > 0.0 else -level / stiffness
        # dz/dt = v − decay z is linear while v is constant: exact however coarse the sampling.
        decay = stiffness * abs(v) / level
        state[_Z] = end + (state[_Z] - end) * np.exp(-decay * dt)
        rate = v - decay * state[_Z]
    state[_X] = x
    return state[_Z], rate, v


@njit(cache=True)
def _output(x, z, rate, v, params):
    spring, stiffness, damping, viscous = params
    y = 0.0
    for k in range(spring.size - 1, -1, -1):
        y = y * x + spring[k]
    return y + stiffness * z + damping * rate + viscous * v


@njit(cache=True)
def _step(x, dt, state, params, commit):
    z, rate, v = _advance(x, dt, state if commit else state.copy(), params[0])
    return _output(x, z, rate, v, params[1])


@njit(cache=True)
def _run(x, dt, state, params, out):
    for i in range(x.size):
        z, rate, v = _advance(x[i], dt[i], state, params[0])
        out[i] = _output(x[i], z, rate, v, params[1])


@njit(cache=True)
def _states(x, dt, state, params, out):
    for i in range(x.size):
        out[i, 0], out[i, 1], out[i, 2] = _advance(x[i], dt[i], state, params)


class LuGre(HysteresisModel):
    """Spring and LuGre friction; rate-dependent, so it takes ``time``.

    ``y = Σ spring_k x^k + stiffness z + damping dz/dt + viscous v``, ``dz/dt = v − stiffness |v| z / g(v)``,
    ``g(v) = coulomb + (static − coulomb) exp(−(v / stribeck_speed)²)``, v = dx/dt; z is 0 at the first sample. Between
    samples v is taken as constant, for which the integration is exact.

    Parameters
    ----------
    spring_degree : int
        Degree of the spring's polynomial.
    starts, seed : int
        Points of the global search and its seed.

    Notes
    -----
    ``from_parameters`` takes ``stiffness``, ``damping``, ``viscous``, ``coulomb``, ``static``, ``stribeck_speed`` and
    optionally ``spring`` (k,), coefficients in increasing powers. Without ``time`` samples are 1 s apart.
    """

    id: ClassVar[str] = "lugre"
    title: ClassVar[str] = "LuGre friction"
    summary: ClassVar[str] = "polynomial spring and bristle friction with Stribeck and viscous parts; rate-dependent"
    use_for: ClassVar[str] = (
        "friction that depends on speed, with a Stribeck fall and a viscous rise, when the recording covers several "
        "speeds"
    )
    not_for: ClassVar[str] = (
        "recordings at one speed, which do not determine its parameters, and quasi-static loops: dahl says the same "
        "with fewer"
    )
    source: ClassVar[str] = "Canudas de Wit et al. 1995"
    references: ClassVar[tuple[str, ...]] = ("canudas1995",)
    rate_independent: ClassVar[bool] = False
    extended: ClassVar[bool] = True

    def __init__(self, spring_degree: int = 5, starts: int = 64, seed: int = 0) -> None:
        self.spring_degree = spring_degree
        self.starts = starts
        self.seed = seed

    def _identify(self, runs: Sequence[Run]) -> dict[str, Any]:
        if self.spring_degree < 0 or self.starts < 1:
            raise InputError("lugre needs spring_degree >= 0 and starts >= 1")
        scale = max(float(np.max(np.abs(run.x))) for run in runs)
        amplitude = 0.5 * max(float(np.ptp(run.x)) for run in runs)
        speed = largest_speed(runs)

        def regressors(point: Floats, run: Run) -> Floats:
            states = np.empty((run.x.size, 3))
            # With a Coulomb friction of 1 the columns are to be weighted with the forces themselves.
            rate = float(np.exp(point[0])) / amplitude
            params = (rate, 1.0, float(point[1]), float(np.exp(point[2])) * speed)
            _states(run.x, sampling_intervals(run.time, run.x.size), _initial_state(), params, states)
            states *= np.array([rate, 1.0, 1.0])
            return np.column_stack([powers(run.x / scale, self.spring_degree), states])

        sign = [False] * (self.spring_degree + 1) + [True] * 3
        point, found = fit_separable(
            regressors, runs, LOWER, UPPER, sign, self.starts, self.seed, near=self.search_from
        )
        self.search_ended_ = point
        for value, low, high, name in zip(
            point, LOWER, UPPER, ("stiffness / coulomb", "static / coulomb", "stribeck_speed"), strict=True
        ):
            if min(value - low, high - value) < 1e-3 * (high - low):
                self.notes_.append(f"{name} is at its bound: this recording does not determine it")
        # A recording without friction leaves the ratios of its constants undefined.
        coulomb = max(float(found[-3]), 1e-12 * float(np.max(np.abs(found))), 1e-30)
        return {
            "stiffness": float(np.exp(point[0])) / amplitude * coulomb,
            "damping": float(found[-2]),
            "viscous": float(found[-1]),
            "coulomb": coulomb,
            "static": float(point[1]) * coulomb,
            "stribeck_speed": float(np.exp(point[2])) * speed,
            "spring": unscaled(found[:-3], scale),
        }

    @classmethod
    def _check_parameters(
        cls,
        stiffness: Any,
        damping: Any,
        viscous: Any,
        coulomb: Any,
        static: Any,
        stribeck_speed: Any,
        spring: Any = (0.0,),
    ) -> dict[str, Any]:
        values = {
            "stiffness": stiffness, "damping": damping, "viscous": viscous, "coulomb": coulomb, "static": static,
            "stribeck_speed": stribeck_speed,
        }  # fmt: skip
        checked: dict[str, Any] = {name: parameter_number(name, value) for name, value in values.items()}
        for name in ("stiffness", "coulomb", "static", "stribeck_speed"):
            if checked[name] <= 0.0:
                raise InputError(f"parameter {name} must be positive; it is {checked[name]}")
        return {**checked, "spring": parameter_array("spring", spring, (None,))}

    def _prepare(self) -> None:
        p = self.parameters_
        self._params = (
            (p["stiffness"], p["coulomb"], p["static"], p["stribeck_speed"]),
            (p["spring"], p["stiffness"], p["damping"], p["viscous"]),
        )

    def _check_conditions(self) -> list[Condition]:
        p = self.parameters_
        # The bristles' power σ0 z ż + (σ1 ż + σ2 v) v is never negative when σ1 (static − coulomb) <= σ2 coulomb
        # (Olsson's thesis, 1996; Barabanov & Ortega 2000).
        needed = p["damping"] * (p["static"] - p["coulomb"]) / p["coulomb"]
        return [
            Condition("static friction is at least Coulomb friction", p["static"] >= p["coulomb"],
                      f"static {p['static']:.4g}, coulomb {p['coulomb']:.4g}"),
            Condition("passive from speed to force: viscous >= damping (static − coulomb) / coulomb >= 0",
                      p["viscous"] >= needed >= 0.0, f"viscous {p['viscous']:.4g}, bound {needed:.4g}"),
        ]  # fmt: skip

    def _predict_timed(self, x: Floats, time: Floats | None) -> Floats:
        y = np.empty_like(x)
        _run(x, sampling_intervals(time, x.size), _initial_state(), self._params, y)
        return y

    def _invert_timed(self, y: Floats, time: Floats | None, x0: float, approximate: bool) -> Floats:
        clocked = ClockedStepper(self.stepper(), sampling_intervals(time, y.size))
        return invert_by_search(clocked, y, x0, self._input_scale(), approximate)

    def stepper(self) -> TimedStepper:
        self._require_fitted()
        return TimedStepper(_step, _initial_state, self._params, _run)
