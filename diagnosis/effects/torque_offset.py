"""A torque sensor whose zero is off."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from .base import SENSOR, Effect, Floats, Form, Parameter, Scene

__all__ = ["TorqueOffset"]


def _columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return np.ones((scene.torque.size, 1))


class TorqueOffset(Effect):
    """Constant error of the torque, or a constant load that the simulator does not know."""

    id: ClassVar[str] = "torque_offset"
    title: ClassVar[str] = "torque offset"
    summary: ClassVar[str] = "constant torque error (sensor zero, unmodelled constant load)"
    equation: ClassVar[str] = "y += b"
    coordinate: ClassVar[str] = "load"
    acts_on: ClassVar[str] = SENSOR
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("offset", "N·m", -np.inf, np.inf, "the constant"),)
    confused_with: ClassVar[tuple[str, ...]] = ("deflection_offset", "thermal_drift")

    def forms(self, scene: Scene) -> list[Form]:
        return [Form("constant", ("offset",), _columns, (-np.inf,), (np.inf,))]
