"""Dry friction of constant size."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import ClassVar

import numpy as np

from ..operators.levels import lubricated
from .base import Effect, Floats, Form, Parameter, Scene, at_either_end, between_ends
from .directions import PRESLIDING, DirectionLaw, direction_laws, overdone_friction

__all__ = ["CoulombFriction"]


def _columns(law: DirectionLaw) -> Callable[[Scene, tuple[float, ...]], Floats]:
    return lambda scene, shape: law.signal(scene.signals, shape[0])[:, None]


def _arctan(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return (np.arctan(scene.signals.certain_speed / shape[0]) * (2.0 / np.pi))[:, None]


def _two_sliders(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return np.column_stack([scene.signals.slipping(length) for length in shape])


def _own(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return scene.stronger(shape[0])[:, None]


def _unequal(law: DirectionLaw) -> Callable[[Scene, tuple[float, ...]], Floats]:
    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        sign = law.signal(scene.signals, shape[0])
        return (sign + shape[1] * np.abs(sign))[:, None]

    return columns


def _by_position(law: DirectionLaw) -> Callable[[Scene, tuple[float, ...]], Floats]:
    """A seal or a guide that is tighter towards one end."""
    return lambda scene, shape: np.column_stack(
        [share * law.signal(scene.signals, shape[0]) for share in at_either_end(scene)]
    )


MORE, MOST = 0.08, 5.0
"""Relative gain of the joint's own friction from which it is not only badly calibrated, and the largest one. With 0.15 the strength of a
MuJoCo joint's sliders and of an Iwan pivot's, off by 0.12, was called the simulator's error or nothing known."""


def _lubricated(scene: Scene, shape: tuple[float, ...]) -> Floats:
    s = scene.signals
    return s.per_run(lambda run: lubricated(s.time[run], s.smooth_x[run], *shape))[:, None]


class CoulombFriction(Effect):
    """Dry friction whose size depends on neither speed nor load."""

    id: ClassVar[str] = "coulomb_friction"
    title: ClassVar[str] = "Coulomb friction"
    summary: ClassVar[str] = "constant torque against the direction of motion (bearings, seals, brushes)"
    equation: ClassVar[str] = "y += F (s + q |s|),  s = sgn(v) after presliding, or F linear in x"
    coordinate: ClassVar[str] = "direction"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("friction", "N·m", -np.inf, np.inf, "sliding friction; negative where the simulator has too much"),
        Parameter("friction_upper", "N·m", 0.0, np.inf, "F at the largest deflection, where it depends on that"),
        Parameter("friction_lower", "N·m", 0.0, np.inf, "the same at as much on the other side"),
        Parameter("friction_2", "N·m", 0.0, np.inf, "of a second contact that yields later"),
        *PRESLIDING,
        Parameter("strength_gain", "1", MORE, np.inf, "relative gain of the strength of the joint's own friction"),
        Parameter("inequality", "1", -0.2, 0.2, "half the relative difference between the directions"),
        Parameter("elastic_presliding_2", "rad", 0.0, np.inf, "of the second contact"),
    )
    confused_with: ClassVar[tuple[str, ...]] = ("miscalibration", "stribeck_friction", "load_dependent_friction")

    def forms(self, scene: Scene) -> list[Form]:
        laws = direction_laws(scene)
        elastic = next(law for law in laws if law.parameter == "elastic_presliding")
        made = [
            Form(law.name, ("friction",), _columns(law), (0.0,), (np.inf,), (law.parameter,),
                 [(value,) for value in law.grid], [law.limits], equation=f"y += friction * {law.equation}")
            for law in laws
        ]  # fmt: skip
        two = Form(
            "two contacts", ("friction", "friction_2"), _two_sliders, (0.0, 0.0), (np.inf, np.inf),
            ("elastic_presliding", "elastic_presliding_2"),
            (), [elastic.limits] * 2, (elastic.name,), lambda shape, coefficients: (0.5 * shape[0], 2.0 * shape[0]),
            equation="y += friction * slip(x, elastic_presliding) + friction_2 * slip(x, elastic_presliding_2)",
        )  # fmt: skip
        unequal = [
            Form(f"{law.name}, unequal", ("friction",), _unequal(law), (0.0,), (np.inf,), (law.parameter, "inequality"), (),
                 [law.limits, (-0.2, 0.2)], (law.name,), lambda shape, _: (*shape, 0.02),
                 equation=f"y += friction * ({law.equation} + inequality * abs({law.equation}))")
            for law in laws
        ]  # fmt: skip
        by_position = [
            Form(f"{law.name}, by position", ("friction_upper", "friction_lower"), _by_position(law), (0.0,) * 2, (np.inf,) * 2,
                 (law.parameter,), (), [law.limits], (law.name,),
                 equation=f"y += {between_ends(scene, 'friction_upper', 'friction_lower')} * {law.equation}")
            for law in laws
        ]  # fmt: skip
        steep = next(form for form in made if form.shapes == ("transition_speed",))
        flat = replace(
            steep, name="regularised by arctan", columns=_arctan,
            equation="y += friction * arctan(v / transition_speed) * 2 / pi",
        )  # fmt: skip
        # Simulators with soft constraints have it so.
        behind = Form(
            "regularised, behind a spring", ("friction",), _lubricated, (0.0,), (np.inf,), ("elastic_presliding", "transition_speed"),
            (), [elastic.limits, *steep.limits], (elastic.name,), lambda shape, _: (shape[0], 0.3 * steep.limits[0][1]),
            equation="y += friction * film(x, elastic_presliding, transition_speed)",
        )  # fmt: skip
        own = Form("more of the joint's own", ("_unit",), _own, (1.0,), (1.0,), ("strength_gain",),
                   [(gain,) for gain in (0.1, 0.2, 0.4, 0.8, 1.6)], [(MORE, MOST)],
                   equation="y += stronger(strength_gain)")  # fmt: skip
        return [*made, flat, two, behind, *unequal, *by_position, own, *overdone_friction(made)]
