"""The elastic law: the output as a rising curve of the input, without memory.

Source: Qin et al., Eqs. 6 and A.4-A.12: the torque of the variable stiffness actuator's belts is T = k h(θ), with h the
virtual deformation of the geometry (l1, l3, x0). With ``geometry`` given and one segment this is that law. A recording
alone does not tell the geometry apart from the curve of any other spring; without it the curve itself is identified.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
from numba import njit

from ..errors import InputError
from .base import Floats, HysteresisModel, Run, parameter_array
from .least_squares import solve
from .maxwell_slip import _deflection, virtual_deformation
from .stepping import KernelStepper

__all__ = ["Elastic"]

LEAST_SLOPE = 1e-3
"""Smallest slope of a segment as a fraction of the mean one, so that the inverse exists."""


def _initial_state(capacity: int) -> Floats:
    return np.zeros(1)


@njit(cache=True)
def _curve(x, vertices_x, vertices_y):
    """The polyline, its end segments continued."""
    k = min(max(np.searchsorted(vertices_x, x) - 1, 0), vertices_x.size - 2)
    slope = (vertices_y[k + 1] - vertices_y[k]) / (vertices_x[k + 1] - vertices_x[k])
    return vertices_y[k] + (x - vertices_x[k]) * slope


@njit(cache=True)
def _step(x, state, params, commit):
    return _curve(x, params[0], params[1])


@njit(cache=True)
def _run(x, vertices_x, vertices_y, out):
    for i in range(x.size):
        out[i] = _curve(x[i], vertices_x, vertices_y)


class Elastic(HysteresisModel):
    """y = f(x), f a polyline that rises; with ``geometry``, y = f(h(x)) with the virtual deformation h of Eq. 6.

    Parameters
    ----------
    segments : int
        Segments of the curve, of equal length; lowered where there are too few samples.
    geometry : tuple of float, optional
        (l1, l3, x0) in one unit of length, for an input in rad; with ``segments=1`` this is the law T = k h(θ) + b.

    Notes
    -----
    ``from_parameters`` takes ``vertices`` (m, 2), both columns increasing, and optionally ``geometry`` (3,).
    """

    id: ClassVar[str] = "elastic"
    title: ClassVar[str] = "Elastic law"
    summary: ClassVar[str] = (
        "a rising curve without memory, or the VSA's elastic law; the baseline for hysteresis models"
    )
    use_for: ClassVar[str] = (
        "springs without noticeable hysteresis, and as the curve that every hysteresis model must beat"
    )
    not_for: ClassVar[str] = "loops of any width: it returns their middle"
    source: ClassVar[str] = "Qin et al., Eqs. 6 and A.4-A.12"
    references: ClassVar[tuple[str, ...]] = ("qin-maxwell-slip-vsa",)
    extended: ClassVar[bool] = True

    def __init__(self, segments: int = 16, geometry: tuple[float, float, float] | None = None) -> None:
        self.segments = segments
        self.geometry = geometry

    def _identify(self, runs: Sequence[Run]) -> dict[str, Any]:
        if self.segments < 1:
            raise InputError(f"segments must be at least 1; it is {self.segments}")
        x, y = (np.concatenate([getattr(run, name) for run in runs]) for name in "xy")
        if self.geometry is not None:
            x = virtual_deformation(x, *self.geometry)
        segments = min(self.segments, max(1, np.unique(x).size // 4))
        edges = np.linspace(x.min(), x.max(), segments + 1)
        # Slopes are the unknowns: the part of the way to x that lies in each segment is a column.
        lengths = np.diff(edges)
        columns = np.clip(x[:, None] - edges[:-1], 0.0, lengths) / lengths
        # The floor keeps the curve rising where data are flat or fall.
        floor = LEAST_SLOPE * max(float(np.ptp(y)), 1e-9 * max(float(np.max(np.abs(y))), 1e-20)) / segments
        target = y - floor * columns.sum(axis=1)
        ones = np.ones((y.size, 1))
        solution = solve(np.hstack([columns, ones]), target, np.arange(segments + 1) < segments)
        held = int(np.sum(solution[:segments] == 0.0))
        if held:
            self.notes_.append(
                f"the output falls or stands still over {held} of {segments} segments; the curve is kept just rising there"
            )
        rises = solution[:segments] + floor
        ordinates = solution[-1] + np.concatenate([[0.0], np.cumsum(rises)])
        parameters: dict[str, Any] = {"vertices": np.column_stack([edges, ordinates])}
        if self.geometry is not None:
            parameters["geometry"] = self.geometry
        return parameters

    @classmethod
    def _check_parameters(cls, vertices: Any, geometry: Any = None) -> dict[str, Any]:
        vertices = parameter_array("vertices", vertices, (None, 2))
        if vertices.shape[0] < 2 or np.any(np.diff(vertices, axis=0) <= 0.0):
            raise InputError("parameter vertices needs at least 2 rows (x, y), both increasing strictly")
        if geometry is not None:
            l1, l3, x0 = parameter_array("geometry", geometry, (3,))
            if not (0 < l1 < l3 and x0 >= 0):
                raise InputError("parameter geometry must be (l1, l3, x0) with 0 < l1 < l3 and x0 >= 0")
            geometry = np.array([l1, l3, x0])
        return {"vertices": vertices, "geometry": geometry}

    def _prepare(self) -> None:
        self._params = tuple(np.ascontiguousarray(column) for column in self.parameters_["vertices"].T)

    def _predict_run(self, x: Floats) -> Floats:
        geometry = self.parameters_["geometry"]
        y = np.empty_like(x)
        _run(x if geometry is None else virtual_deformation(x, *geometry), self._params[0], self._params[1], y)
        return y

    def stepper(self) -> KernelStepper:
        self._require_fitted()
        geometry = self.parameters_["geometry"]

        def run(x: Floats, state: Floats, params: Any, out: Floats) -> None:
            out[:] = self._predict_run(x)

        if geometry is None:
            return KernelStepper(_step, _initial_state, self._params, run)

        def kernel(x: float, state: Floats, params: Any, commit: bool) -> float:
            return float(_step(float(virtual_deformation(x, *geometry)), state, params, commit))

        return KernelStepper(kernel, _initial_state, self._params, run)

    def _invert_run(self, y: Floats, x0: float, approximate: bool) -> Floats:
        x = np.empty_like(y)
        _run(y, self._params[1], self._params[0], x)
        geometry = self.parameters_["geometry"]
        return x if geometry is None else _deflection(x, *geometry)
