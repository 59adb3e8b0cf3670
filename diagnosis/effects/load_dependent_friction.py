"""Friction in proportion to the load."""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

import numpy as np

from .base import PRESLIDING, DirectionLaw, Effect, Floats, Form, Parameter, Scene, direction_laws

__all__ = ["LoadDependentFriction"]
LOAD_WORDS = ("pressure", "load", "force", "tension", "preload", "clamp", "bar")


def _columns(law: DirectionLaw, channel: str | None) -> Callable[[Scene, tuple[float, ...]], Floats]:
    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        load = scene.torque if channel is None else scene.signals.channels[channel]
        return (np.abs(load) * law.signal(scene.signals, shape[0]))[:, None]

    return columns


class LoadDependentFriction(Effect):
    """Friction of gears, joints and belts: Coulomb's law with a normal force that the transmitted load makes."""

    id: ClassVar[str] = "load_dependent_friction"
    title: ClassVar[str] = "load-dependent friction"
    summary: ClassVar[str] = "friction in proportion to the transmitted load (gear teeth, pulleys, pressed seals)"
    equation: ClassVar[str] = "y += μ |y_sim| s   (or |load channel| in place of |y_sim|)"
    coordinate: ClassVar[str] = "load"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("friction_coefficient", "1", 0.0, np.inf, "friction over load"),
        *PRESLIDING,
    )
    confused_with: ClassVar[tuple[str, ...]] = ("coulomb_friction", "miscalibration")

    def forms(self, scene: Scene) -> list[Form]:
        loads: list[str | None] = [None]
        for name, values in scene.signals.channels.items():
            if any(word in name.lower() for word in LOAD_WORDS) and np.ptp(values) > 0.05 * np.max(np.abs(values)):
                loads.append(name)
        return [
            Form(f"by {load or 'torque'}, {law.name}", ("friction_coefficient",), _columns(law, load), (0.0,), (np.inf,),
                 (law.parameter,), [(value,) for value in law.grid], [law.limits])
            for load in loads
            for law in direction_laws(scene)
        ]  # fmt: skip
