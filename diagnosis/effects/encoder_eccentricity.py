"""A deflection sensor with a periodic error."""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

import numpy as np

from .base import INPUT, Effect, Floats, Form, Parameter, Scene, geometric

__all__ = ["EncoderEccentricity"]


def _columns(harmonics: int) -> Callable[[Scene, tuple[float, ...]], Floats]:
    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        x = scene.signals.x
        small = 1e-3 * scene.signals.reach
        made = []
        for k in range(1, harmonics + 1):
            for wave in (np.sin(k * shape[0] * x), np.cos(k * shape[0] * x)):
                made.append(scene.torque_change(x + small * wave) / small)
        return np.column_stack(made)

    return columns


def _of_true_angle(scene: Scene, shape: tuple[float, ...]) -> Floats:
    periods, waves = shape[0], shape[1:]
    x = scene.signals.x
    true = x
    # z = x + p sin(N z) + q cos(N z) + … is a contraction as long as the error is small against a period.
    for _ in range(6):
        error = np.zeros_like(x)
        for k in range(len(waves) // 2):
            angle = (k + 1) * periods * true
            error += waves[2 * k] * np.sin(angle) + waves[2 * k + 1] * np.cos(angle)
        true = x + error
    return scene.torque_change(true)[:, None]


def _from_sine(shape: tuple[float, ...], coefficients: Floats) -> tuple[float, ...]:
    return (*shape, float(coefficients[0]), float(coefficients[1]))


def _from_sine_twice(shape: tuple[float, ...], coefficients: Floats) -> tuple[float, ...]:
    return (*_from_sine(shape, coefficients), 0.0, 0.0)


class EncoderEccentricity(Effect):
    """Eccentric disc, magnet or gear: the measured deflection is wrong periodically."""

    id: ClassVar[str] = "encoder_eccentricity"
    title: ClassVar[str] = "encoder eccentricity"
    summary: ClassVar[str] = "periodic error of the deflection (eccentric disc, magnet or gear)"
    equation: ClassVar[str] = (
        "x → z, z = x + p sin(N z) + q cos(N z) [+ p2 sin(2 N z) + q2 cos(2 N z)], or with x on the right for z"
    )
    coordinate: ClassVar[str] = "position"
    acts_on: ClassVar[str] = INPUT
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("error_sin", "rad", -np.inf, np.inf, "p"),
        Parameter("error_cos", "rad", -np.inf, np.inf, "q"),
        Parameter("error_sin_2", "rad", -np.inf, np.inf, "p2, second harmonic"),
        Parameter("error_cos_2", "rad", -np.inf, np.inf, "q2, second harmonic"),
        Parameter("periods", "1/rad·2π", 0.0, np.inf, "N, periods a turn"),
    )
    confused_with: ClassVar[tuple[str, ...]] = ("deflection_offset", "torque_gain", "miscalibration")

    def forms(self, scene: Scene) -> list[Form]:
        reach = scene.signals.reach
        # At least half a period within the stroke, at most thirty; slower waves are an offset and a gain.
        low, high = 0.5 * np.pi / reach, 30.0 * np.pi / reach
        grid = [(n,) for n in geometric(low, 12.0 * np.pi / reach, 36)]
        wide = 0.06 * reach
        names = ("error_sin", "error_cos", "error_sin_2", "error_cos_2")
        return [
            Form("sine", names[:2], _columns(1), (-wide,) * 2, (wide,) * 2, ("periods",), grid, [(low, high)]),
            # The error is a function of the true angle: as one of the measured angle it has harmonics.
            Form(
                "sine of the true angle",
                ("_unit",),
                _of_true_angle,
                (1.0,),
                (1.0,),
                ("periods", "error_sin", "error_cos"),
                (),
                [(low, high), (-wide, wide), (-wide, wide)],
                "sine",
                _from_sine,
            ),
            Form(
                "two harmonics of the true angle",
                ("_unit",),
                _of_true_angle,
                (1.0,),
                (1.0,),
                ("periods", *names),
                (),
                [(low, high), *[(-wide, wide)] * 4],
                "sine",
                _from_sine_twice,
            ),
            Form(
                "two harmonics", names, _columns(2), (-wide,) * 4, (wide,) * 4, ("periods",), (), [(low, high)], "sine"
            ),
        ]
