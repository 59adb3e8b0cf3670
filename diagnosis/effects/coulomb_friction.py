"""Dry friction of constant size."""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

import numpy as np

from .base import PRESLIDING, DirectionLaw, Effect, Floats, Form, Parameter, Scene, direction_laws

__all__ = ["CoulombFriction"]


def _columns(law: DirectionLaw) -> Callable[[Scene, tuple[float, ...]], Floats]:
    return lambda scene, shape: law.signal(scene.signals, shape[0])[:, None]


class CoulombFriction(Effect):
    """Dry friction whose size depends on neither speed nor load."""

    id: ClassVar[str] = "coulomb_friction"
    title: ClassVar[str] = "Coulomb friction"
    summary: ClassVar[str] = "constant torque against the direction of motion (bearings, seals, brushes)"
    equation: ClassVar[str] = "y += F s,  s = sgn(v) after presliding"
    coordinate: ClassVar[str] = "direction"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("friction", "N·m", 0.0, np.inf, "sliding friction"),
        *PRESLIDING,
    )
    confused_with: ClassVar[tuple[str, ...]] = ("miscalibration", "stribeck_friction", "load_dependent_friction")

    def forms(self, scene: Scene) -> list[Form]:
        return [
            Form(law.name, ("friction",), _columns(law), (0.0,), (np.inf,), (law.parameter,),
                 [(value,) for value in law.grid], [law.limits])
            for law in direction_laws(scene)
        ]  # fmt: skip
