"""A mass between the torque sensor and the spring."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from .base import Effect, Floats, Form, Parameter, Scene

__all__ = ["Inertia"]


def _columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return scene.signals.acceleration[:, None]


class Inertia(Effect):
    """Torque that accelerates a moving part which the simulator takes as massless."""

    id: ClassVar[str] = "inertia"
    title: ClassVar[str] = "inertia"
    summary: ClassVar[str] = "torque in proportion to acceleration (unmodelled moving mass, reflected rotor)"
    equation: ClassVar[str] = "y += J d²x/dt²"
    coordinate: ClassVar[str] = "acceleration"
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("inertia", "kg·m²", 0.0, np.inf, "moment of inertia"),)
    confused_with: ClassVar[tuple[str, ...]] = ("torque_gain", "miscalibration", "stress_relaxation")

    def forms(self, scene: Scene) -> list[Form]:
        return [Form("rigid", ("inertia",), _columns, (0.0,), (np.inf,))]
