"""A torque sensor whose scale is off."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from .base import SENSOR, Effect, Floats, Form, Parameter, Scene

__all__ = ["TorqueGain"]


def _columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return scene.torque[:, None]


def _curved(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return (scene.torque * (1.0 - shape[0] * np.abs(scene.torque) / scene.signals.strongest))[:, None]


class TorqueGain(Effect):
    """Every torque is larger or smaller by one factor."""

    id: ClassVar[str] = "torque_gain"
    title: ClassVar[str] = "torque gain"
    summary: ClassVar[str] = "torque larger or smaller by one factor (sensor scale, torque constant)"
    equation: ClassVar[str] = "y += g y_sim, or g y_sim (1 − q |y_sim| / Y) with the largest torque Y"
    coordinate: ClassVar[str] = "load"
    acts_on: ClassVar[str] = SENSOR
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("gain_error", "1", -1.0, 1.0, "factor minus one"),
        Parameter("compression", "1", -0.4, 0.4, "q, part of it that is missing at the largest torque"),
    )
    confused_with: ClassVar[tuple[str, ...]] = ("miscalibration", "torque_saturation", "stiffness_asymmetry")

    def forms(self, scene: Scene) -> list[Form]:
        own = ("gain_error",)
        return [
            Form("factor", own, _columns, (-1.0,), (1.0,), equation="y += gain_error * y"),
            Form("compressed factor", own, _curved, (-1.0,), (1.0,), ("compression",), (), [(-0.4, 0.4)], ("factor",),
                 lambda shape, coefficients: (0.1,),
                 equation=f"y += gain_error * y * (1 - compression * abs(y) / {scene.signals.strongest:.8g})"),
        ]  # fmt: skip
