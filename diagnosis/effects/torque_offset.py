"""A torque sensor whose zero is off."""

from __future__ import annotations

from collections.abc import Collection
from typing import ClassVar

import numpy as np

from .base import HIGH, NOT, SENSOR, Effect, Floats, Form, Parameter, Scene
from .images import is_shifted_spring, is_uniform
from .settling import SETTLING, settled, settling_limits, settling_start

__all__ = ["TorqueOffset"]


def _columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return np.ones((scene.torque.size, 1))


def _shifted(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return (scene.signals.elapsed > shape[0]).astype(np.float64)[:, None]


def _settling(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return settled(scene, *shape)[:, None]


class TorqueOffset(Effect):
    """Constant error of the torque, or a constant load that the simulator does not know."""

    id: ClassVar[str] = "torque_offset"
    title: ClassVar[str] = "torque offset"
    summary: ClassVar[str] = "constant torque error (sensor zero, unmodelled constant load)"
    equation: ClassVar[str] = "y += b, from the start, from a moment soon after, or b (1 − q exp(−t/τ))"
    coordinate: ClassVar[str] = "load"
    acts_on: ClassVar[str] = SENSOR
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("offset", "N·m", -np.inf, np.inf, "the constant"),
        Parameter("moment", "s", 0.0, np.inf, "at which the zero shifted"),
        *SETTLING,
    )
    confused_with: ClassVar[tuple[str, ...]] = ("deflection_offset", "thermal_drift")

    def imitates(self, signal: Floats, scene: Scene) -> Collection[str]:
        # On a linear spring they are the same.
        return ("deflection_offset",) if is_shifted_spring(signal, scene) and not is_uniform(signal) else ()

    def forms(self, scene: Scene) -> list[Form]:
        s = scene.signals
        span, free = float(s.elapsed.max()), ((-np.inf,), (np.inf,))
        # A zero that goes on moving is a drift.
        soon = [(share * span,) for share in (0.01, 0.02, 0.035, 0.05, 0.07, 0.09)]
        return [
            Form("constant", ("offset",), _columns, *free, equation="y += offset"),
            Form("shifted soon", ("offset",), _shifted, *free, ("moment",), soon, [(2.0 * s.interval, 0.12 * span)],
                 borders=[HIGH], equation="y += offset * (t > moment)"),
            Form("settling", ("offset",), _settling, *free, ("unsettled", "settling_time"), (),
                 settling_limits(scene), ("constant",), lambda shape, _: settling_start(scene),
                 borders=[NOT, HIGH], equation="y += offset * (1 - unsettled * exp(-t / settling_time))"),
        ]  # fmt: skip
