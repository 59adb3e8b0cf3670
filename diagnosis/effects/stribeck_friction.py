"""Dry friction that is larger at low speed."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import replace
from typing import ClassVar

import numpy as np

from ..operators.levels import slid, yielding
from ..recording.noise import rms
from .base import LOW, NOT, Columns, Effect, Floats, Form, Parameter, Scene
from .directions import PRESLIDING, DirectionLaw, direction_laws
from .images import is_constant_friction
from .parts import by_strength

__all__ = ["StribeckFriction"]


def _gaussian(ratio: Floats) -> Floats:
    return np.exp(-(ratio**2))


def _exponential(ratio: Floats) -> Floats:
    return np.exp(-ratio)


def _lorentzian(ratio: Floats) -> Floats:
    return 1.0 / (1.0 + ratio**2)


def _blunt(ratio: Floats) -> Floats:
    return np.exp(-np.sqrt(ratio))


def _by_power(ratio: Floats, power: float = 2.0) -> Floats:
    return np.exp(-(np.abs(ratio) ** power))


def _own_friction(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return (scene.friction * _gaussian(scene.signals.speed / shape[0]))[:, None]


def _excess(curve: Callable[[Floats], Floats]) -> Columns:
    """What slides inside the joint does so the later the slower it moves, and is as stiff as ever."""
    return lambda scene, shape: curve(np.abs(scene.signals.speed) / shape[0])[:, None]


HARDLY = 0.08
"""Share of the friction that the excess makes, below which there is hardly any."""
FALLS = 0.03
"""Share by which friction must be larger at low speed than at high speed to fall at all."""
MOST_EXCESS = 30.0
"""Times the friction at high speed that the excess of what follows the curve by its own dynamics may be."""
POWERS = 0.4, 3.0
"""Powers of the speed with which that falls."""
BLUNT = "p = 1/2", "exp(-sqrt(abs(v) / stribeck_speed))", _blunt
CURVES = (
    ("p = 2", "exp(-(v / stribeck_speed)**2)", _gaussian),
    ("p = 1", "exp(-abs(v) / stribeck_speed)", _exponential),
    ("Hess-Soom", "1 / (1 + (v / stribeck_speed)**2)", _lorentzian),
)
"""How the excess falls with speed: what it is called, its equation and itself."""


def _equation(curve: str, law: DirectionLaw) -> str:
    return f"y += (friction + breakaway_excess * {curve}) * {law.equation}"


def _columns(law: DirectionLaw, curve: Callable[[Floats], Floats]) -> Callable[[Scene, tuple[float, ...]], Floats]:
    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        sign = law.signal(scene.signals, shape[1])
        return np.column_stack([sign, curve(np.abs(scene.signals.speed) / shape[0]) * sign])

    return columns


def _of_constant_stiffness(sliding: Callable[[Floats, Floats, float], Floats]) -> Columns:
    """What sticks is as stiff as ever, and slides at a level that follows the curve, whose power may be a fourth shape."""

    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        signals = scene.signals
        speed, length, excess, *power = shape
        level = 1.0 + excess * _by_power(signals.speed / speed, *power)
        return signals.per_run(lambda run: sliding(signals.smooth_x[run], level[run], length))[:, None]

    return columns


def _from_curve(shape: tuple[float, ...], coefficients: Floats) -> tuple[float, ...]:
    return (*shape, float(coefficients[1] / max(coefficients[0], 0.1 * coefficients[1], 1e-300)))


class StribeckFriction(Effect):
    """Boundary lubrication at low speed gives way to a fluid film: friction falls as speed rises."""

    id: ClassVar[str] = "stribeck_friction"
    title: ClassVar[str] = "Stribeck friction"
    summary: ClassVar[str] = "dry friction that falls with speed from breakaway to sliding (stick-slip, hunting)"
    equation: ClassVar[str] = (
        "y += [F + S exp(−(|v| / w)^p)] s, p = 1/2, 1 or 2; [F + S / (1 + (v / w)²)] s; R exp(−(v / w)²) on what has memory, or on the level at which it slides; or LuGre: ℓ df/dx = ±1 − f / (1 + S/F exp(−(v / w)²)), or a spring of 1/ℓ that slides at that level"
    )
    coordinate: ClassVar[str] = "speed"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("friction", "N·m", 0.0, np.inf, "sliding friction at high speed"),
        Parameter("breakaway_excess", "N·m", 0.0, np.inf, "what is added to it at standstill"),
        Parameter(
            "stribeck_speed", "rad/s", 0.0, np.inf, "speed at which the excess has fallen to 1/e (Hess-Soom: to half)"
        ),
        Parameter("power", "1", 0.0, np.inf, "p, of the speed with which the excess falls"),
        Parameter("excess_ratio", "1", 0.0, np.inf, "S over F (LuGre, spring and slider)"),
        Parameter(
            "rise", "1", 0.0, np.inf, "R, relative gain of the joint's own friction, or of its strength, at standstill"
        ),
        *PRESLIDING,
    )
    confused_with: ClassVar[tuple[str, ...]] = ("coulomb_friction", "viscous_friction")
    contains: ClassVar[tuple[str, ...]] = ("coulomb_friction",)
    # With what grows with speed beside it, it is constant.
    image_of: ClassVar[tuple[str, ...]] = ("coulomb_friction",)

    def imitates(self, signal: Floats, scene: Scene) -> Collection[str]:
        return self.image_of if is_constant_friction(signal, scene) else ()

    def is_degenerate(self, parameters: dict[str, float], scene: Scene) -> bool:
        if "rise" in parameters:
            return False
        friction = parameters["friction"]
        excess = parameters.get("breakaway_excess", friction * parameters.get("excess_ratio", 0.0))
        speed = scene.signals.speed
        more = excess * _by_power(speed / parameters["stribeck_speed"], parameters.get("power", 2.0))
        # What the transition of the sign hides at low speed is not there.
        sign = np.tanh(speed / parameters["transition_speed"]) if "transition_speed" in parameters else 1.0
        level = np.abs((friction + more) * sign)
        return rms(more * sign) < HARDLY * rms(level) or float(np.max(level)) < (1.0 + FALLS) * friction

    def forms(self, scene: Scene) -> list[Form]:
        fast = rms(scene.signals.speed)
        speeds = [0.06 * fast, 0.15 * fast, 0.4 * fast, 1.0 * fast]
        laws = direction_laws(scene)
        made = [
            Form(f"{told}, {law.name}", ("friction", "breakaway_excess"), _columns(law, curve), (0.0, 0.0),
                 (np.inf, np.inf), ("stribeck_speed", law.parameter), [(w, d) for w in speeds for d in law.grid[:2]],
                 [(0.02 * fast, 2.0 * fast), law.limits], borders=[LOW, NOT],
                 equation=_equation(equation, law))
            for told, equation, curve in CURVES
            for law in laws
        ]  # fmt: skip
        # The bristle of LuGre follows the Stribeck curve by its own dynamics (Canudas de Wit et al. 1995); so does a slider.
        own_dynamics = []
        for name, function, sliding, law in (
            ("LuGre", "dahl", yielding, laws[0]),
            ("spring and slider", "slip", slid, laws[1]),
        ):
            in_words = f"y += friction * {function}(x, {law.parameter}, 1 + excess_ratio * "
            gaussian = Form(
                name, ("friction",), _of_constant_stiffness(sliding), (0.0,), (np.inf,),
                ("stribeck_speed", law.parameter, "excess_ratio"), (), [(0.02 * fast, 2.0 * fast), law.limits, (0.01, MOST_EXCESS)],
                tuple(f"{CURVES[0][0]}, {simpler.name}" for simpler in laws[:2]), _from_curve,
                equation=f"{in_words}{CURVES[0][1]})",
            )  # fmt: skip
            of_any_power = replace(
                gaussian, name=f"{name}, of any power", shapes=(*gaussian.shapes, "power"), limits=[*gaussian.limits, POWERS],
                refines=(name,), start=lambda shape, coefficients: (*shape, 1.5),
                equation=f"{in_words}exp(-(abs(v) / stribeck_speed)**power))",
            )  # fmt: skip
            own_dynamics += [gaussian, of_any_power]
        blunt = [
            Form(f"{BLUNT[0]}, {law.name}", ("friction", "breakaway_excess"), _columns(law, BLUNT[2]), (0.0, 0.0), (np.inf, np.inf),
                 ("stribeck_speed", law.parameter), (), [(0.005 * fast, 2.0 * fast), law.limits], (f"p = 1, {law.name}",),
                 borders=[LOW, NOT], equation=_equation(BLUNT[1], law))
            for law in laws
        ]  # fmt: skip
        own = Form("of the joint's own friction", ("rise",), _own_friction, (0.0,), (np.inf,), ("stribeck_speed",),
                   [(w,) for w in speeds], [(0.02 * fast, 2.0 * fast)],
                   equation=f"y += rise * {CURVES[0][1]} * y_memory")  # fmt: skip
        inside = []
        for told, equation, curve in (*CURVES, BLUNT):
            columns, about = by_strength(_excess(curve))
            inside.append(
                Form(f"{told}, inside the joint", ("rise",), columns, (0.0,), (np.inf,), ("stribeck_speed",), own.grid, own.limits,
                     about=about, equation=f"y += stronger(rise * {equation})")
            )  # fmt: skip
        return [*made, *blunt, *own_dynamics, own, *inside]
