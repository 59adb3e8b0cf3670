"""A deflection sensor whose zero is off."""

from __future__ import annotations

from collections.abc import Collection
from typing import ClassVar

from .base import INPUT, Effect, Floats, Form, Parameter, Scene
from .images import is_one_sided_stiffness, is_uniform
from .settling import SETTLING, settled, settling_limits, settling_start

__all__ = ["DeflectionOffset"]


def _columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return scene.torque_change(scene.signals.x + shape[0])[:, None]


def _of_spring(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return scene.spring_change(scene.signals.x + shape[0])[:, None]


def _settling(scene: Scene, shape: tuple[float, ...]) -> Floats:
    offset, *settling = shape
    return scene.spring_change(scene.signals.x + offset * settled(scene, *settling))[:, None]


class DeflectionOffset(Effect):
    """The zero of the encoder, or a preload angle, is not where the simulator has it."""

    id: ClassVar[str] = "deflection_offset"
    title: ClassVar[str] = "deflection offset"
    summary: ClassVar[str] = "constant error of the deflection (encoder zero, preload angle)"
    equation: ClassVar[str] = (
        "x → x + d, or only in the elastic part of y_sim, from the start or with d (1 − q exp(−t/τ))"
    )
    coordinate: ClassVar[str] = "position"
    acts_on: ClassVar[str] = INPUT
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("offset", "rad", -1.0, 1.0, "d, what the simulator's deflection lacks"),
        *SETTLING,
    )
    confused_with: ClassVar[tuple[str, ...]] = ("torque_offset", "stiffness_asymmetry")
    # On a linear spring they are the same.
    image_of: ClassVar[tuple[str, ...]] = ("torque_offset",)

    def imitates(self, signal: Floats, scene: Scene) -> Collection[str]:
        if is_uniform(signal):
            return self.image_of
        return ("stiffness_asymmetry",) if is_one_sided_stiffness(signal, scene) else ()

    def forms(self, scene: Scene) -> list[Form]:
        reach = scene.signals.reach
        made = []
        for sign, told in ((1.0, "positive"), (-1.0, "negative")):
            grid = [(sign * f * reach,) for f in (0.0015, 0.004, 0.01, 0.025, 0.06, 0.15)]
            near, far = sign * 3e-4 * reach, sign * 0.3 * reach
            limits = [(min(near, far), max(near, far))]
            made += [
                Form(told, ("_unit",), _columns, (1.0,), (1.0,), ("offset",), grid, limits,
                     equation="x = x + offset"),
                # A spring hung in with a preload, or friction that has settled there, knows nothing of the shift.
                Form(f"{told}, of the spring", ("_unit",), _of_spring, (1.0,), (1.0,), ("offset",), grid, limits,
                     equation="x = x + offset, in the elastic part alone"),
                # Friction that came from elsewhere, and is where the simulator has it after the first strokes.
                Form(f"{told}, settling", ("_unit",), _settling, (1.0,), (1.0,), ("offset", "unsettled", "settling_time"), (),
                     [*limits, *settling_limits(scene)], (f"{told}, of the spring",),
                     lambda shape, _: (*shape, *settling_start(scene)),
                     equation="x = x + offset * (1 - unsettled * exp(-t / settling_time)), in the elastic part alone"),
            ]  # fmt: skip
        return made
