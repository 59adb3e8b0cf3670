"""The Dahl model of friction beside a spring: bristles that yield gradually, independent of the rate.

Source: P. R. Dahl, "A solid friction model", Aerospace Corporation TOR-158(3107-18), 1968; exponent as in P. R. Dahl,
"Solid friction damping of mechanical vibrations", AIAA Journal 14(12), 1976.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
from numba import njit

from ..errors import InputError
from .base import Condition, Floats, HysteresisModel, Run, parameter_array, parameter_number
from .separable import fit_separable, powers, unscaled
from .stepping import KernelStepper

__all__ = ["Dahl", "friction"]

# State: last input, friction as a fraction of its limit, started.
_X, _Z, _STARTED = 0, 1, 2

LOWER, UPPER = (np.log(0.3), 0.0), (np.log(1000.0), 4.0)
"""Search range of ln(stiffness · amplitude / friction) and of the exponent."""


def _initial_state(capacity: int) -> Floats:
    return np.zeros(3)


@njit(cache=True)
def _run(x, state, params, out):
    # The state is held in local variables meanwhile: through the array each sample would cost several times as much.
    spring, friction, rate, exponent = params
    bend = 1.0 - exponent
    started = state[_STARTED] != 0.0
    last = state[_X]
    z = state[_Z]
    for i in range(x.size):
        now = x[i]
        if not started:
            started = True
            last = now
        if now != last:
            sign = 1.0 if now > last else -1.0
            # What is left to the limit, u = 1 − z sgn(dx), follows du = −rate u^exponent |dx|, solved in closed form.
            left = 1.0 - sign * z
            if left > 0.0:
                way = rate * abs(now - last)
                if bend == 0.0:
                    left *= np.exp(-way)
                else:
                    used = bend * way * left**-bend
                    left = left * np.exp(np.log1p(-used) / bend) if used < 1.0 else 0.0
            z = sign * (1.0 - left)
        last = now
        y = 0.0
        for k in range(spring.size - 1, -1, -1):
            y = y * now + spring[k]
        out[i] = y + friction * z
    state[_STARTED] = 1.0 if started else 0.0
    state[_X] = last
    state[_Z] = z


@njit(cache=True)
def _step(x, state, params, commit):
    one = np.full(1, x)
    _run(one, state if commit else state.copy(), params, one)
    return one[0]


def friction(x: Floats, length: float, exponent: float) -> Floats:
    """Friction over its limit that builds up over ``x`` (n,) from none, shape (n,).

    Its slope is (1 - z sgn(dx))^``exponent`` over ``length``: an exponent of one is a bristle, near zero a stop (Dahl 1976).
    """
    z = np.empty(x.size)
    _run(np.ascontiguousarray(x), _initial_state(0), (np.zeros(1), 1.0, 1.0 / length, float(exponent)), z)
    return z


class Dahl(HysteresisModel):
    """Spring and Dahl friction: ``y = Σ spring_k x^k + F``, ``dF/dx = stiffness |1 − F sgn(dx)/friction|^exponent``.

    F is 0 at the first sample. The integration is exact for any exponent and sampling.

    Parameters
    ----------
    spring_degree : int
        Degree of the spring's polynomial.
    starts, seed : int
        Points of the global search and its seed.

    Notes
    -----
    ``from_parameters`` takes ``stiffness`` (of the bristles, output per input), ``friction`` (the limit of F),
    ``exponent`` (at least 0) and optionally ``spring`` (k,), coefficients in increasing powers.
    """

    id: ClassVar[str] = "dahl"
    title: ClassVar[str] = "Dahl friction"
    summary: ClassVar[str] = (
        "polynomial spring and Dahl's friction; smooth loops from three constants, rate-independent"
    )
    use_for: ClassVar[str] = "friction beside a spring, when three parameters should say how stiff and how strong it is"
    not_for: ClassVar[str] = (
        "rate-dependent friction, and memory of nested loops: only the state of one bristle is kept"
    )
    source: ClassVar[str] = "Dahl 1968, 1976"
    references: ClassVar[tuple[str, ...]] = ("dahl1976",)
    extended: ClassVar[bool] = True

    def __init__(self, spring_degree: int = 5, starts: int = 32, seed: int = 0) -> None:
        self.spring_degree = spring_degree
        self.starts = starts
        self.seed = seed

    def _identify(self, runs: Sequence[Run]) -> dict[str, Any]:
        if self.spring_degree < 0 or self.starts < 1:
            raise InputError("dahl needs spring_degree >= 0 and starts >= 1")
        scale = max(float(np.max(np.abs(run.x))) for run in runs)
        amplitude = 0.5 * max(float(np.ptp(run.x)) for run in runs)
        nothing = np.zeros(1)

        def regressors(point: Floats, run: Run) -> Floats:
            z = np.empty_like(run.x)
            _run(run.x, _initial_state(0), (nothing, 1.0, float(np.exp(point[0])) / amplitude, float(point[1])), z)
            return np.column_stack([powers(run.x / scale, self.spring_degree), z])

        free = [False] * (self.spring_degree + 2)
        point, found = fit_separable(
            regressors, runs, LOWER, UPPER, free, self.starts, self.seed, near=self.search_from
        )
        self.search_ended_ = point
        if point[0] > UPPER[0] - 1e-3:
            self.notes_.append(
                "the friction jumps at each turn: the recording does not determine the bristles' stiffness"
            )
        # A recording without a loop has no friction; the ratio to the stiffness must stay defined.
        least = 1e-12 * max(float(np.max(np.abs(found))), 1e-20)
        friction = float(found[-1]) if abs(found[-1]) > least else least
        return {
            "stiffness": float(np.exp(point[0])) / amplitude * friction,
            "friction": friction,
            "exponent": float(point[1]),
            "spring": unscaled(found[:-1], scale),
        }

    @classmethod
    def _check_parameters(cls, stiffness: Any, friction: Any, exponent: Any, spring: Any = (0.0,)) -> dict[str, Any]:
        checked: dict[str, Any] = {
            "stiffness": parameter_number("stiffness", stiffness),
            "friction": parameter_number("friction", friction),
            "exponent": parameter_number("exponent", exponent),
            "spring": parameter_array("spring", spring, (None,)),
        }
        if checked["friction"] == 0.0 or checked["stiffness"] / checked["friction"] <= 0.0:
            raise InputError("parameters stiffness and friction must have the same sign and not be 0")
        if checked["exponent"] < 0.0:
            raise InputError(f"parameter exponent must be at least 0; it is {checked['exponent']}")
        return checked

    def _prepare(self) -> None:
        p = self.parameters_
        self._params = (p["spring"], p["friction"], p["stiffness"] / p["friction"], p["exponent"])

    def _check_conditions(self) -> list[Condition]:
        friction = self.parameters_["friction"]
        return [Condition("every closed loop dissipates: friction > 0", friction > 0.0, f"friction {friction:.4g}")]

    def _predict_run(self, x: Floats) -> Floats:
        y = np.empty_like(x)
        _run(x, _initial_state(0), self._params, y)
        return y

    def stepper(self) -> KernelStepper:
        self._require_fitted()
        return KernelStepper(_step, _initial_state, self._params, _run)
