"""The cubic baseline: one cubic polynomial for rising and one for falling motion.

Source: the "cubic fitted model" that Qin et al. compare their proposed model with (section 4.2).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np
from numba import njit
from numpy.polynomial import Polynomial

from ..errors import InputError
from .base import Condition, Floats, HysteresisModel, InverseError, Run, parameter_array, parameter_number
from .motion import auto_dead_band, directions, settled_from
from .stepping import KernelStepper

__all__ = ["Cubic"]

# State: direction of motion (0 before the first one), lowest and highest input since the last turn, started.
_DIRECTION, _LOW, _HIGH, _STARTED = 0, 1, 2, 3


def _initial_state(capacity: int) -> Floats:
    return np.zeros(4)


@njit(cache=True)
def _advance(x, state, params):
    ascending, descending, dead_band = params
    if state[_STARTED] == 0.0:
        state[_STARTED] = 1.0
        state[_LOW] = x
        state[_HIGH] = x
    state[_LOW] = min(state[_LOW], x)
    state[_HIGH] = max(state[_HIGH], x)
    direction = state[_DIRECTION]
    # The input has turned once it is back from its extreme by more than the dead band.
    if direction >= 0.0 and state[_HIGH] - x > dead_band:
        direction = -1.0
    elif direction <= 0.0 and x - state[_LOW] > dead_band:
        direction = 1.0
    if direction != state[_DIRECTION]:
        state[_DIRECTION] = direction
        state[_LOW] = x
        state[_HIGH] = x
    c = descending if direction < 0.0 else ascending
    return c[0] + x * (c[1] + x * (c[2] + x * c[3]))


@njit(cache=True)
def _step(x, state, params, commit):
    return _advance(x, state if commit else state.copy(), params)


@njit(cache=True)
def _run(x, state, params, out):
    for i in range(x.size):
        out[i] = _advance(x[i], state, params)


class Cubic(HysteresisModel):
    """One cubic per direction of motion; ascending before the first motion, and a pause keeps the branch.

    Parameters
    ----------
    branches : {2, 1}
        1 fits one cubic to both directions: a curve without hysteresis.
    dead_band : float, optional
        The input has turned once it came back by more than this. None: eight times the input's noise, so that noise
        does not switch branches.

    Notes
    -----
    ``from_parameters`` takes ``ascending`` (4,) and ``descending`` (4,), coefficients in increasing powers, and
    optionally ``dead_band`` (0 unless given).
    """

    id: ClassVar[str] = "cubic"
    title: ClassVar[str] = "Cubic per branch"
    summary: ClassVar[str] = (
        "one cubic polynomial per direction of motion; the baseline, no memory beyond the direction"
    )
    use_for: ClassVar[str] = "a first look, and as the baseline that a model with memory must beat"
    not_for: ClassVar[str] = (
        "minor loops, or a motion that turns within the stroke: each reversal makes the output jump from one branch "
        "to the other"
    )
    source: ClassVar[str] = "Qin et al., section 4.2"
    references: ClassVar[tuple[str, ...]] = ("qin-maxwell-slip-vsa",)
    search_grid: ClassVar[Mapping[str, Sequence[Any]]] = {"branches": (2, 1)}
    estimated: ClassVar[tuple[str, ...] | None] = ("ascending", "descending")

    def __init__(self, branches: int = 2, dead_band: float | None = None) -> None:
        self.branches = branches
        self.dead_band = dead_band

    def _identify(self, runs: Sequence[Run]) -> dict[str, Any]:
        if self.branches not in (1, 2):
            raise InputError(f"branches must be 1 or 2; it is {self.branches!r}")
        dead_band = self.dead_band
        if dead_band is None:
            dead_band = max(auto_dead_band(run.x) for run in runs)
        rising, falling = [], []
        for run in runs:
            direction = directions(run.x, dead_band)
            used = np.arange(run.x.size) >= settled_from(run.x)
            rising.append(np.column_stack([run.x, run.y])[used & (direction >= 0)])
            falling.append(np.column_stack([run.x, run.y])[used & (direction < 0)])
        up, down = np.concatenate(rising), np.concatenate(falling)
        if self.branches == 1:
            up = down = np.concatenate([up, down])
        coefficients: dict[str, Any] = {}
        for name, points in (("ascending", up), ("descending", down)):
            distinct = np.unique(points[:, 0]).size
            if distinct == 0:
                # Motion in one direction only: the other branch is unknown, and the nearest guess is this one.
                coefficients[name] = None
                self.notes_.append(f"the recording has no {name} motion; the other branch is used for it")
                continue
            degree = min(3, distinct - 1)
            fitted = Polynomial.fit(points[:, 0], points[:, 1], degree).convert().coef
            coefficients[name] = np.pad(fitted, (0, 4 - fitted.size))
        other = {"ascending": "descending", "descending": "ascending"}
        return {
            **{name: coefficients[other[name]] if c is None else c for name, c in coefficients.items()},
            "dead_band": dead_band,
        }

    @classmethod
    def _check_parameters(cls, ascending: Any, descending: Any, dead_band: Any = 0.0) -> dict[str, Any]:
        dead_band = parameter_number("dead_band", dead_band)
        if dead_band < 0.0:
            raise InputError(f"parameter dead_band must not be negative; it is {dead_band}")
        return {
            "ascending": parameter_array("ascending", ascending, (4,)),
            "descending": parameter_array("descending", descending, (4,)),
            "dead_band": dead_band,
        }

    def _prepare(self) -> None:
        p = self.parameters_
        self._params = (p["ascending"], p["descending"], p["dead_band"])

    def _check_conditions(self) -> list[Condition]:
        grid = np.linspace(-self._input_scale(), self._input_scale(), 401)
        conditions = []
        for name in ("ascending", "descending"):
            slope = Polynomial(self.parameters_[name]).deriv()(grid)
            conditions.append(
                Condition(
                    f"the {name} cubic rises over the stroke (its inverse is unique)",
                    bool(np.all(slope > 0.0)),
                    f"smallest slope {slope.min():.4g} at x = {grid[np.argmin(slope)]:.4g}",
                )
            )
        return conditions

    def _predict_run(self, x: Floats) -> Floats:
        y = np.empty_like(x)
        _run(x, _initial_state(x.size), self._params, y)
        return y

    def stepper(self) -> KernelStepper:
        self._require_fitted()
        return KernelStepper(_step, _initial_state, self._params, _run)

    def _invert_run(self, y: Floats, x0: float, approximate: bool) -> Floats:
        roots = [_real_roots(self.parameters_[name], y) for name in ("ascending", "descending")]
        tolerance = 1e-9 * max(float(np.max(np.abs(y))), 1e-300)
        # One ulp beyond the dead band turns the motion.
        turn = self.parameters_["dead_band"] * (1.0 + 1e-9) + 1e-12 * self._input_scale()
        stepper = self.stepper()
        x = np.empty_like(y)
        here = x0
        for k, target in enumerate(y.tolist()):
            candidates = [here, *roots[0][k], *roots[1][k]]
            errors = [abs(stepper.peek(c) - target) for c in candidates]
            reached = [(abs(c - here), c) for c, e in zip(candidates, errors, strict=True) if e <= tolerance]
            if reached:
                here = min(reached)[1]
            elif approximate:
                candidates += [here - turn, here + turn]
                errors += [abs(stepper.peek(c) - target) for c in candidates[-2:]]
                here = min(zip(errors, candidates, strict=True))[1]
            else:
                raise InverseError(
                    f"no input gives the output y[{k}] = {target:.6g}: from x = {here:.6g} neither branch reaches it in "
                    "its own direction of motion, because the output jumps between the branches at a turn. "
                    "Pass approximate=True (command line: --approximate) to take the nearest."
                )
            x[k] = here
            stepper.step(here)
        return x


def _real_roots(coefficients: Floats, y: Floats) -> list[list[float]]:
    """Real solutions x of ``polynomial(x) = y`` for each sample."""
    c = np.trim_zeros(coefficients, "b")
    if c.size <= 1:
        return [[] for _ in range(y.size)]
    degree = c.size - 1
    companion = np.zeros((y.size, degree, degree))
    companion[:, np.arange(1, degree), np.arange(degree - 1)] = 1.0
    companion[:, :, -1] = -c[:-1] / c[-1]
    companion[:, 0, -1] += y / c[-1]
    found = np.linalg.eigvals(companion)
    # Eigenvalues lose half the digits near a double root; two Newton steps give them back.
    real = np.where(np.abs(found.imag) <= 1e-6 * (1.0 + np.abs(found.real)), found.real, np.nan)
    polynomial, derivative = Polynomial(c), Polynomial(c).deriv()
    for _ in range(2):
        slope = derivative(real)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = np.where(slope != 0.0, (polynomial(real) - y[:, None]) / slope, 0.0)
        real = real - step
    return [row[np.isfinite(row)].tolist() for row in real]
