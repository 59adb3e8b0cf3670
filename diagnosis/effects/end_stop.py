"""A stop that is touched near the ends of the stroke."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from .base import Columns, Effect, Floats, Form, Parameter, Scene

__all__ = ["EndStop"]


def _columns(upper: bool, lower: bool, power: float) -> Columns:
    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        x = scene.signals.smooth_x
        made = []
        if upper:
            made.append(np.maximum(x - shape[0], 0.0) ** power)
        if lower:
            made.append(-(np.maximum(-x - shape[-1], 0.0) ** power))
        return np.column_stack(made)

    return columns


def _damped(side: float, power: float | None) -> Columns:
    """A stop that loses energy: damping while it is touched, by depth (Hunt & Crossley) or not (``power`` None)."""

    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        signals = scene.signals
        depth = np.maximum(side * signals.smooth_x - shape[0], 0.0)
        if power is None:
            return np.column_stack([side * depth, (depth > 0.0) * signals.speed])
        return np.column_stack([side * depth**power, depth**power * signals.speed])

    return columns


class EndStop(Effect):
    """Contact with a stop: stiff beyond a deflection, absent before it."""

    id: ClassVar[str] = "end_stop"
    title: ClassVar[str] = "end stop"
    summary: ClassVar[str] = "contact that stiffens the joint beyond a deflection near the end of the stroke"
    equation: ClassVar[str] = (
        "y += k d^p − k' d'^p,  d = max(x − a, 0), d' = max(−x − a', 0), p = 1 or 1.5; damped: + c v or + c d^p v while touched"
    )
    coordinate: ClassVar[str] = "position"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("stiffness_upper", "N·m/rad^p", 0.0, np.inf, "of the upper stop"),
        Parameter("stiffness_lower", "N·m/rad^p", 0.0, np.inf, "of the lower stop"),
        Parameter("damping", "N·m·s/rad or N·m·s/rad^(p + 1)", 0.0, np.inf, "c, of one stop"),
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
        for side, told, limits in ((1.0, "upper", top), (-1.0, "lower", bottom)):
            names = (f"stiffness_{told}", "damping")
            free = (0.0, 0.0), (np.inf, np.inf), (told,), (), [limits]
            made += [
                Form(f"{told}, damped", names, _damped(side, None), *free, (told,)),
                Form(f"{told}, Hunt-Crossley", names, _damped(side, 1.5), *free, (f"{told}, Hertz",)),
            ]
        return made
