"""A mass between the torque sensor and the spring."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from .base import Effect, Floats, Form, Parameter, Scene

__all__ = ["Inertia"]


def _columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return scene.signals.acceleration[:, None]


def _behind_shaft(scene: Scene, shape: tuple[float, ...]) -> Floats:
    # Well below its resonance a shaft's twist delays the mass.
    return scene.signals.delayed(scene.signals.acceleration, shape[0])[:, None]


class Inertia(Effect):
    """Torque that accelerates a moving part which the simulator takes as massless."""

    id: ClassVar[str] = "inertia"
    title: ClassVar[str] = "inertia"
    summary: ClassVar[str] = "torque in proportion to acceleration (unmodelled moving mass, reflected rotor)"
    equation: ClassVar[str] = "y += J d²x/dt², at t or at t − τ"
    coordinate: ClassVar[str] = "acceleration"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("inertia", "kg·m²", 0.0, np.inf, "moment of inertia"),
        Parameter("shaft_lag", "s", 0.0, np.inf, "time by which it follows behind a compliant shaft"),
    )
    confused_with: ClassVar[tuple[str, ...]] = ("torque_gain", "miscalibration", "stress_relaxation")

    def forms(self, scene: Scene) -> list[Form]:
        signals = scene.signals
        step = signals.interval
        # A longer lag turns inertia into damping.
        pace = float(np.std(signals.speed)) / max(float(np.std(signals.acceleration)), 1e-300)
        longest = max(0.15 * pace, 0.1 * step)
        free = (0.0,), (np.inf,)
        return [
            Form("rigid", ("inertia",), _columns, *free),
            Form("behind a shaft", ("inertia",), _behind_shaft, *free, ("shaft_lag",), (), [(0.02 * step, longest)], ("rigid",),
                 lambda shape, coefficients: (min(step, 0.5 * longest),)),
        ]  # fmt: skip
