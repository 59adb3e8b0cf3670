"""A mass between the torque sensor and the spring."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from .base import LOW, NOT, Effect, Floats, Form, Parameter, Scene, geometric, overdone

__all__ = ["Inertia"]

AT_REST = 0.1
"""Speed, over its standard deviation, that is standing still."""


def _columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return scene.signals.acceleration[:, None]


def _behind_shaft(scene: Scene, shape: tuple[float, ...]) -> Floats:
    # Well below its resonance a shaft's twist delays the mass.
    return scene.signals.delayed(scene.signals.acceleration, shape[0])[:, None]


def _on_spring(scene: Scene, shape: tuple[float, ...]) -> Floats:
    s, driven = scene.signals, scene.signals.acceleration.copy()
    still = AT_REST * np.std(s.speed)
    for run in s.runs:
        # What starts to move at the recording's beginning is swung on; what was moving before is taken as settled.
        if abs(s.speed[run.start]) < still:
            driven[run.start] = 0.0
    return s.resonated(driven, *shape)[:, None]


class Inertia(Effect):
    """Torque that accelerates a moving part which the simulator takes as massless."""

    id: ClassVar[str] = "inertia"
    title: ClassVar[str] = "inertia"
    summary: ClassVar[str] = "torque in proportion to acceleration (unmodelled moving mass, reflected rotor)"
    equation: ClassVar[str] = (
        "y += J d²x/dt², at t or at t − τ, or y += z with d²z/dt² + 2ζω dz/dt + ω² z = ω² J d²x/dt²"
    )
    coordinate: ClassVar[str] = "acceleration"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("inertia", "kg·m²", -np.inf, np.inf, "moment of inertia; negative where the simulator has too much"),
        Parameter("shaft_lag", "s", 0.0, np.inf, "time by which it follows behind a compliant shaft"),
        Parameter("natural_frequency", "rad/s", 0.0, np.inf, "at which it swings on the transmission's compliance"),
        Parameter("damping_ratio", "1", 0.0, 1.0, "of that swinging"),
    )
    confused_with: ClassVar[tuple[str, ...]] = ("torque_gain", "miscalibration", "stress_relaxation")

    def forms(self, scene: Scene) -> list[Form]:
        signals = scene.signals
        step = signals.interval
        # A longer lag turns inertia into damping.
        speed, acceleration = float(np.std(signals.speed)), float(np.std(signals.acceleration))
        pace = speed / max(acceleration, 1e-300)
        longest = max(0.15 * pace, 0.1 * step)
        # Within the motion's band it would be a resonance, which is another matter; faster than sampled, it is rigid.
        swings = (2.0 * acceleration / max(speed, 1e-300), 0.7 / step)
        free = (0.0,), (np.inf,)
        rigid = Form("rigid", ("inertia",), _columns, *free, equation="y += inertia * a")
        return [
            rigid,
            overdone(rigid),
            Form("behind a shaft", ("inertia",), _behind_shaft, *free, ("shaft_lag",), (), [(0.02 * step, longest)], ("rigid",),
                 lambda shape, coefficients: (min(step, 0.5 * longest),), equation="y += inertia * late(a, shaft_lag)"),
            Form("behind a compliant transmission", ("inertia",), _on_spring, *free, ("natural_frequency", "damping_ratio"),
                 [(w, d) for w in geometric(*swings, 10) for d in (0.04, 0.2)], [swings, (0.005, 0.3)],
                 borders=[LOW, NOT], equation="y += inertia * resonator(a, natural_frequency, damping_ratio)"),
        ]  # fmt: skip
