"""A deflection sensor with a periodic error."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from .base import INPUT, Effect, Floats, Form, Parameter, Scene, geometric

__all__ = ["EncoderEccentricity"]


def _columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
    x = scene.signals.x
    small = 1e-3 * scene.signals.reach
    phase = shape[0] * x
    made = []
    for wave in (np.sin(phase), np.cos(phase)):
        # The mean of the wave would be an offset of deflection, which is an effect of its own.
        made.append((scene.torque_change(x + small * wave) - scene.torque_change(x - small * wave)) / (2.0 * small))
    return np.column_stack(made)


class EncoderEccentricity(Effect):
    """Eccentric disc, magnet or gear: the measured deflection is wrong periodically."""

    id: ClassVar[str] = "encoder_eccentricity"
    title: ClassVar[str] = "encoder eccentricity"
    summary: ClassVar[str] = "periodic error of the deflection (eccentric disc, magnet or gear)"
    equation: ClassVar[str] = "x → x + p sin(N x) + q cos(N x)"
    coordinate: ClassVar[str] = "position"
    acts_on: ClassVar[str] = INPUT
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("error_sin", "rad", -np.inf, np.inf, "p"),
        Parameter("error_cos", "rad", -np.inf, np.inf, "q"),
        Parameter("periods", "1/rad·2π", 0.0, np.inf, "N, periods a turn"),
    )
    confused_with: ClassVar[tuple[str, ...]] = ("deflection_offset", "torque_gain", "miscalibration")

    def forms(self, scene: Scene) -> list[Form]:
        reach = scene.signals.reach
        # At least half a period within the stroke, at most thirty; slower waves are an offset and a gain.
        low, high = 0.5 * np.pi / reach, 30.0 * np.pi / reach
        grid = [(n,) for n in geometric(low, 12.0 * np.pi / reach, 36)]
        wide = 0.06 * reach
        free = (-wide, -wide), (wide, wide)
        return [Form("sine", ("error_sin", "error_cos"), _columns, *free, ("periods",), grid, [(low, high)])]
