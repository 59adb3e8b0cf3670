"""A stop that is touched near the ends of the stroke."""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

import numpy as np

from .base import Effect, Floats, Form, Parameter, Scene

__all__ = ["EndStop"]


def _columns(upper: bool, lower: bool, power: float) -> Callable[[Scene, tuple[float, ...]], Floats]:
    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        x = scene.signals.smooth_x
        made = []
        if upper:
            made.append(np.maximum(x - shape[0], 0.0) ** power)
        if lower:
            made.append(-(np.maximum(-x - shape[-1], 0.0) ** power))
        return np.column_stack(made)

    return columns


class EndStop(Effect):
    """Contact with a stop: stiff beyond a deflection, absent before it."""

    id: ClassVar[str] = "end_stop"
    title: ClassVar[str] = "end stop"
    summary: ClassVar[str] = "contact that stiffens the joint beyond a deflection near the end of the stroke"
    equation: ClassVar[str] = "y += k max(x − a, 0)^p − k' max(−x − a', 0)^p,  p = 1 or 1.5"
    coordinate: ClassVar[str] = "position"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("stiffness_upper", "N·m/rad^p", 0.0, np.inf, "of the upper stop"),
        Parameter("stiffness_lower", "N·m/rad^p", 0.0, np.inf, "of the lower stop"),
        Parameter("upper", "rad", -np.inf, np.inf, "deflection a at which the upper stop is touched"),
        Parameter("lower", "rad", -np.inf, np.inf, "−deflection a' at which the lower stop is touched"),
    )
    confused_with: ClassVar[tuple[str, ...]] = ("stiffness_asymmetry", "torque_saturation", "miscalibration")

    def forms(self, scene: Scene) -> list[Form]:
        x = scene.signals.smooth_x
        middle, reach = 0.5 * float(x.max() + x.min()), scene.signals.reach
        shares = (0.45, 0.55, 0.65, 0.72, 0.79, 0.85, 0.9, 0.94, 0.97)
        up = [middle + f * reach for f in shares]
        down = [-middle + f * reach for f in shares]
        top, bottom = (middle + 0.35 * reach, middle + 0.985 * reach), (-middle + 0.35 * reach, -middle + 0.985 * reach)
        made = []
        for power, told in ((1.0, ""), (1.5, ", Hertz")):
            made += [
                Form(f"upper{told}", ("stiffness_upper",), _columns(True, False, power), (0.0,), (np.inf,), ("upper",),
                     [(a,) for a in up], [top]),
                Form(f"lower{told}", ("stiffness_lower",), _columns(False, True, power), (0.0,), (np.inf,), ("lower",),
                     [(a,) for a in down], [bottom]),
                Form(f"both{told}", ("stiffness_upper", "stiffness_lower"), _columns(True, True, power), (0.0, 0.0),
                     (np.inf, np.inf), ("upper", "lower"), list(zip(up, down, strict=True)), [top, bottom]),
            ]  # fmt: skip
        return made
