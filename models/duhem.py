"""The Duhem model in Coleman and Hodgdon's form: the output relaxes towards a curve over the distance travelled.

Source: B. D. Coleman, M. L. Hodgdon, "A constitutive relation for rate-independent hysteresis in ferromagnetically soft
materials", Int. J. Engineering Science 24(6), 1986; J. Oh, D. S. Bernstein, "Semilinear Duhem model for
rate-independent and rate-dependent hysteresis", IEEE Trans. Automatic Control 50(5), 2005.
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

__all__ = ["Duhem"]

# State: last input, started; then one lag for each coefficient of the loss polynomial.
_X, _STARTED, _LAGS = 0, 1, 2

LOWER, UPPER = (np.log(0.3),), (np.log(1000.0),)
"""Search range of ln(rate · amplitude)."""


@njit(cache=True)
def _advance(x, state, params):
    curve, loss, rate = params
    if state[_STARTED] == 0.0:
        state[_STARTED] = 1.0
        state[_X] = x
    last = state[_X]
    dx = x - last
    y = 0.0
    for k in range(curve.size - 1, -1, -1):
        y = y * x + curve[k]
    if dx != 0.0:
        sign = 1.0 if dx > 0.0 else -1.0
        fade = np.expm1(-rate * abs(dx))
        # Integral of exp(−rate (|dx| − s)) x(s)^j dx over the way, by parts from j = 0 on.
        gain = -sign * fade / rate
        now = before = 1.0
        for j in range(loss.size):
            if j > 0:
                now *= x
                before *= last
                gain = sign / rate * (now - before - before * fade - j * gain)
            state[_LAGS + j] += fade * state[_LAGS + j] + gain
        state[_X] = x
    for j in range(loss.size):
        y += loss[j] * state[_LAGS + j]
    return y


@njit(cache=True)
def _step(x, state, params, commit):
    return _advance(x, state if commit else state.copy(), params)


@njit(cache=True)
def _run(x, state, params, out):
    for i in range(x.size):
        out[i] = _advance(x[i], state, params)


@njit(cache=True)
def _lags(x, state, params, out):
    for i in range(x.size):
        _advance(x[i], state, params)
        for j in range(out.shape[1]):
            out[i, j] = state[_LAGS + j]


class Duhem(HysteresisModel):
    """``y = f(x) + w``, ``dw = b(x) dx − rate w |dx|``, with polynomials f and b; w is 0 at the first sample.

    In Coleman and Hodgdon's terms ``dy = rate |dx| (f(x) − y) + g(x) dx`` with ``g = f' + b``. Where b > 0 loops run clockwise
    (they dissipate), where b < 0 counter-clockwise (magnets). The integration is exact whatever the sampling.

    Parameters
    ----------
    degree : int
        Degree of f.
    loss_degree : int
        Degree of b.
    starts, seed : int
        Points of the global search and its seed.

    Notes
    -----
    ``from_parameters`` takes ``curve`` (k,) and ``loss`` (m,), coefficients of f and b in increasing powers, and
    ``rate`` (one over the distance after which a turn is forgotten).
    """

    id: ClassVar[str] = "duhem"
    title: ClassVar[str] = "Duhem (Coleman-Hodgdon)"
    summary: ClassVar[str] = "relaxes towards a curve over the distance travelled; smooth loops of either orientation"
    use_for: ClassVar[str] = (
        "smooth loops of magnets and seals whose branches bend, from a short recording: it is quickly identified"
    )
    not_for: ClassVar[str] = "nested minor loops: it forgets turns exponentially and has no return-point memory"
    source: ClassVar[str] = "Coleman & Hodgdon 1986; Oh & Bernstein 2005"
    references: ClassVar[tuple[str, ...]] = ("oh-bernstein2005",)
    extended: ClassVar[bool] = True

    def __init__(self, degree: int = 5, loss_degree: int = 2, starts: int = 16, seed: int = 0) -> None:
        self.degree = degree
        self.loss_degree = loss_degree
        self.starts = starts
        self.seed = seed

    def _identify(self, runs: Sequence[Run]) -> dict[str, Any]:
        if self.degree < 0 or self.loss_degree < 0 or self.starts < 1:
            raise InputError("duhem needs degree >= 0, loss_degree >= 0 and starts >= 1")
        scale = max(float(np.max(np.abs(run.x))) for run in runs)
        amplitude = 0.5 * max(float(np.ptp(run.x)) for run in runs) / scale
        unit = np.zeros(self.loss_degree + 1)

        def regressors(point: Floats, run: Run) -> Floats:
            u = run.x / scale
            lags = np.empty((u.size, unit.size))
            _lags(u, np.zeros(_LAGS + unit.size), (unit, unit, float(np.exp(point[0])) / amplitude), lags)
            return np.column_stack([powers(u, self.degree), lags])

        free = [False] * (self.degree + 1 + unit.size)
        point, found = fit_separable(
            regressors, runs, LOWER, UPPER, free, self.starts, self.seed, near=self.search_from
        )
        self.search_ended_ = point
        if min(point[0] - LOWER[0], UPPER[0] - point[0]) < 1e-3:
            self.notes_.append("rate is at its bound: this recording does not determine it")
        return {
            "curve": unscaled(found[: self.degree + 1], scale),
            "loss": unscaled(found[self.degree + 1 :], scale) / scale,
            "rate": float(np.exp(point[0])) / amplitude / scale,
        }

    @classmethod
    def _check_parameters(cls, curve: Any, loss: Any, rate: Any) -> dict[str, Any]:
        checked: dict[str, Any] = {
            "curve": parameter_array("curve", curve, (None,)),
            "loss": parameter_array("loss", loss, (None,)),
            "rate": parameter_number("rate", rate),
        }
        if checked["rate"] <= 0.0:
            raise InputError(f"parameter rate must be positive; it is {checked['rate']}")
        return checked

    def _prepare(self) -> None:
        p = self.parameters_
        self._params = (p["curve"], p["loss"], p["rate"])

    def _check_conditions(self) -> list[Condition]:
        grid = np.linspace(-self._input_scale(), self._input_scale(), 401)
        loss = np.polynomial.Polynomial(self.parameters_["loss"])(grid)
        told = f"b from {loss.min():.4g} to {loss.max():.4g} over the stroke"
        return [
            Condition("every closed loop runs clockwise (dissipates): b >= 0", bool(np.all(loss >= 0.0)), told),
            Condition("every closed loop runs counter-clockwise: b <= 0", bool(np.all(loss <= 0.0)), told),
        ]

    def _initial_state(self, capacity: int) -> Floats:
        return np.zeros(_LAGS + self.parameters_["loss"].size)

    def _predict_run(self, x: Floats) -> Floats:
        y = np.empty_like(x)
        _run(x, self._initial_state(0), self._params, y)
        return y

    def stepper(self) -> KernelStepper:
        self._require_fitted()
        return KernelStepper(_step, self._initial_state, self._params, _run)
