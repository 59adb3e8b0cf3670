"""Friction that grows with speed."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from .base import Effect, Floats, Form, Parameter, Scene

__all__ = ["ViscousFriction"]


def _columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
    v = scene.signals.speed
    power = shape[0] if shape else 1.0
    return (np.sign(v) * np.abs(v) ** power)[:, None]


def _quadratic(scene: Scene, shape: tuple[float, ...]) -> Floats:
    v = scene.signals.speed
    return np.column_stack([v, v * np.abs(v)])


class ViscousFriction(Effect):
    """Damping in grease, seals, eddy currents or the structure."""

    id: ClassVar[str] = "viscous_friction"
    title: ClassVar[str] = "viscous friction"
    summary: ClassVar[str] = "torque that opposes motion and grows with speed (grease, seals, damping)"
    equation: ClassVar[str] = "y += c |v|^p sgn(v), or c v + c2 |v| v"
    coordinate: ClassVar[str] = "speed"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("damping", "N·m·(s/rad)^p", 0.0, np.inf, "torque at 1 rad/s"),
        Parameter("damping_2", "N·m·s²/rad²", 0.0, np.inf, "part that grows as the square (churning)"),
        Parameter("power", "1", 0.5, 2.0, "1 for a Newtonian lubricant, less for a shear-thinning one"),
    )
    confused_with: ClassVar[tuple[str, ...]] = ("sensor_delay", "coulomb_friction", "stress_relaxation")

    def forms(self, scene: Scene) -> list[Form]:
        return [
            Form("linear", ("damping",), _columns, (0.0,), (np.inf,)),
            Form("linear and quadratic", ("damping", "damping_2"), _quadratic, (0.0, 0.0), (np.inf, np.inf)),
            Form(
                "power law",
                ("damping",),
                _columns,
                (0.0,),
                (np.inf,),
                ("power",),
                [(0.6,), (0.75,), (1.3,), (1.7,)],
                [(0.5, 2.0)],
            ),
        ]
