"""A joint that is stiffer on one side."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from .base import Columns, Effect, Floats, Form, Parameter, Scene

__all__ = ["StiffnessAsymmetry"]


def _spring(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return np.maximum(scene.signals.smooth_x, 0.0)[:, None]


def _spring_lower(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return np.minimum(scene.signals.smooth_x, 0.0)[:, None]


def _torque(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return np.maximum(scene.torque, 0.0)[:, None]


def _torque_lower(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return np.minimum(scene.torque, 0.0)[:, None]


def _side(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return (scene.torque * (scene.signals.smooth_x > 0.0))[:, None]


def _side_lower(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return (scene.torque * (scene.signals.smooth_x < 0.0))[:, None]


def _both(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return np.abs(scene.signals.smooth_x)[:, None]


def _both_torque(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return (scene.torque * np.sign(scene.signals.smooth_x))[:, None]


def _rounded(side: float) -> Columns:
    """The knee of one side (±1), or of both (0), is not sharp."""

    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        x, width = scene.signals.smooth_x, shape[0]
        if side == 0.0:
            return (x * np.tanh(x / width))[:, None]
        return (0.5 * x * (1.0 + side * np.tanh(x / width)))[:, None]

    return columns


class StiffnessAsymmetry(Effect):
    """Different stiffness for positive and negative deflection."""

    id: ClassVar[str] = "stiffness_asymmetry"
    title: ClassVar[str] = "stiffness asymmetry"
    summary: ClassVar[str] = "stiffer on one side than on the other (unequal springs, one-sided contact)"
    equation: ClassVar[str] = (
        "y += k max(±x, 0), k |x| (sharp or rounded), or g y_sim on one side or of opposite sign on both"
    )
    coordinate: ClassVar[str] = "position"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("extra_stiffness", "N·m/rad", -np.inf, np.inf, "added on one side"),
        Parameter("extra_gain", "1", -1.0, 1.0, "relative difference of one side"),
        Parameter("knee", "rad", 0.0, np.inf, "width over which the stiffness changes"),
    )
    confused_with: ClassVar[tuple[str, ...]] = ("end_stop", "deflection_offset", "torque_gain")

    def forms(self, scene: Scene) -> list[Form]:
        free = (-np.inf,), (np.inf,)
        gain = (-1.0,), (1.0,)
        reach = scene.signals.reach
        rounded = [
            Form(f"spring, {told}, rounded", ("extra_stiffness",), _rounded(side), *free, ("knee",), (),
                 [(1e-3 * reach, 0.3 * reach)], (f"spring, {told}",), lambda shape, coefficients: (0.03 * reach,))
            for side, told in ((1.0, "upper side"), (-1.0, "lower side"), (0.0, "both sides"))
        ]  # fmt: skip
        return [
            *rounded,
            Form("spring, upper side", ("extra_stiffness",), _spring, *free),
            Form("spring, lower side", ("extra_stiffness",), _spring_lower, *free),
            Form("spring, both sides", ("extra_stiffness",), _both, *free),
            Form("positive torque", ("extra_gain",), _torque, *gain),
            Form("negative torque", ("extra_gain",), _torque_lower, *gain),
            Form("torque, upper side", ("extra_gain",), _side, *gain),
            Form("torque, lower side", ("extra_gain",), _side_lower, *gain),
            Form("torque, both sides", ("extra_gain",), _both_torque, *gain),
        ]
