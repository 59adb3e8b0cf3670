"""A torque sensor whose scale is off."""

from __future__ import annotations

from typing import ClassVar

from .base import SENSOR, Effect, Floats, Form, Parameter, Scene

__all__ = ["TorqueGain"]


def _columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return scene.torque[:, None]


class TorqueGain(Effect):
    """Every torque is larger or smaller by one factor."""

    id: ClassVar[str] = "torque_gain"
    title: ClassVar[str] = "torque gain"
    summary: ClassVar[str] = "torque larger or smaller by one factor (sensor scale, torque constant)"
    equation: ClassVar[str] = "y += g y_sim"
    coordinate: ClassVar[str] = "load"
    acts_on: ClassVar[str] = SENSOR
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("gain_error", "1", -1.0, 1.0, "factor minus one"),)
    confused_with: ClassVar[tuple[str, ...]] = ("miscalibration", "torque_saturation", "stiffness_asymmetry")

    def forms(self, scene: Scene) -> list[Form]:
        return [Form("factor", ("gain_error",), _columns, (-1.0,), (1.0,))]
