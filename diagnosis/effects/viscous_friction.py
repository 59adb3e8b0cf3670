"""Friction that grows with speed."""

from __future__ import annotations

from collections.abc import Collection
from typing import ClassVar

import numpy as np

from ..recording.noise import rms
from .base import Effect, Floats, Form, Parameter, Scene, at_either_end, between_ends, overdone
from .images import is_constant_friction

__all__ = ["ViscousFriction"]


def _columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
    v = scene.signals.speed
    power = shape[0] if shape else 1.0
    return (np.sign(v) * np.abs(v) ** power)[:, None]


def _quadratic(scene: Scene, shape: tuple[float, ...]) -> Floats:
    v = scene.signals.speed
    return np.column_stack([v, v * np.abs(v)])


def _cubic(scene: Scene, shape: tuple[float, ...]) -> Floats:
    v = scene.signals.speed
    return np.column_stack([v, v**3])


def _unequal(scene: Scene, shape: tuple[float, ...]) -> Floats:
    opposing, ahead = _columns(scene, shape), scene.signals.speed[:, None] > 0.0
    return np.hstack([opposing * ahead, opposing * ~ahead])


def _by_position(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return np.column_stack([share * scene.signals.speed for share in at_either_end(scene)])


def _by_distance(scene: Scene, shape: tuple[float, ...]) -> Floats:
    far = (scene.signals.smooth_x / scene.signals.stroke) ** 2
    return np.column_stack([(1.0 - far) * scene.signals.speed, far * scene.signals.speed])


def _eyring(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return np.arcsinh(scene.signals.speed / shape[0])[:, None]


def _saturating(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return np.arctan(scene.signals.speed / shape[0])[:, None]


def _opening(scene: Scene, shape: tuple[float, ...]) -> Floats:
    """A valve that opens at a speed: another damping beyond."""
    v = scene.signals.speed
    below = np.clip(v, -shape[0], shape[0])
    return np.column_stack([below, v - below])


class ViscousFriction(Effect):
    """Damping in grease, seals, eddy currents or the structure."""

    id: ClassVar[str] = "viscous_friction"
    title: ClassVar[str] = "viscous friction"
    summary: ClassVar[str] = "torque that opposes motion and grows with speed (grease, seals, damping)"
    equation: ClassVar[str] = (
        "y += c |v|^p sgn(v), c v + c2 |v| v, c v + c3 v³, either of the first with another c for each direction, c v linear in x or in x², c asinh(v/w) (Eyring), c arctan(v/w), or c v up to a speed and c' v beyond"
    )
    coordinate: ClassVar[str] = "speed"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            "damping", "N·m·(s/rad)^p", -np.inf, np.inf, "torque at 1 rad/s; negative where the simulator has too much"
        ),
        Parameter("damping_2", "N·m·s²/rad²", 0.0, np.inf, "part that grows as the square (churning)"),
        Parameter("damping_3", "N·m·s³/rad³", 0.0, np.inf, "part that grows as the cube"),
        Parameter("damping_back", "N·m·(s/rad)^p", 0.0, np.inf, "c of motion in the negative direction"),
        Parameter("damping_upper", "N·m·s/rad", 0.0, np.inf, "c at the largest deflection"),
        Parameter("damping_lower", "N·m·s/rad", 0.0, np.inf, "the same at as much on the other side"),
        Parameter("damping_middle", "N·m·s/rad", 0.0, np.inf, "c at x = 0, where it changes alike both ways"),
        Parameter("damping_ends", "N·m·s/rad", 0.0, np.inf, "c at the largest deflection, where it does"),
        Parameter("damping_open", "N·m·s/rad", 0.0, np.inf, "c', beyond the speed at which a valve opens"),
        Parameter("opening_speed", "rad/s", 0.0, np.inf, "that speed"),
        Parameter("limit", "N·m", 0.0, np.inf, "c of a grease that thins or saturates"),
        Parameter("thinning_speed", "rad/s", 0.0, np.inf, "w, speed at which it does"),
        Parameter("power", "1", 0.5, 2.0, "1 for a Newtonian lubricant, less for a shear-thinning one"),
    )
    confused_with: ClassVar[tuple[str, ...]] = ("sensor_delay", "coulomb_friction", "stress_relaxation")
    # What saturates soon is constant.
    image_of: ClassVar[tuple[str, ...]] = ("coulomb_friction",)

    def imitates(self, signal: Floats, scene: Scene) -> Collection[str]:
        return self.image_of if is_constant_friction(signal, scene) else ()

    def forms(self, scene: Scene) -> list[Form]:
        fast = rms(scene.signals.speed)
        # What saturates well below the usual speeds is dry friction; a logarithm of the speed never quite does.
        thinning = [
            Form(name, ("limit",), law, (0.0,), (np.inf,), ("thinning_speed",), [(share * fast,) for share in starts],
                 [(least * fast, 5.0 * fast)], equation=f"y += limit * {curve}(v / thinning_speed)")
            for name, curve, law, starts, least in (
                ("Eyring", "arcsinh", _eyring, (0.15, 0.5, 1.2), 0.06),
                ("saturating", "arctan", _saturating, (0.5, 1.2), 0.25),
            )
        ]  # fmt: skip
        both = (0.0,) * 2, (np.inf,) * 2
        below = "clip(v, -opening_speed, opening_speed)"
        linear = Form("linear", ("damping",), _columns, (0.0,), (np.inf,), equation="y += damping * v")
        return [
            linear,
            Form("linear, unequal", ("damping", "damping_back"), _unequal, *both,
                 equation="y += where(v > 0, damping, damping_back) * v"),
            Form("linear, by position", ("damping_upper", "damping_lower"), _by_position, *both,
                 equation=f"y += {between_ends(scene, 'damping_upper', 'damping_lower')} * v"),
            Form("linear, by distance", ("damping_middle", "damping_ends"), _by_distance, *both, (), (), (), ("linear",),
                 equation=f"y += (damping_middle + (x / {scene.signals.stroke:.8g})**2 * (damping_ends - damping_middle)) * v"),
            Form("linear and quadratic", ("damping", "damping_2"), _quadratic, *both,
                 equation="y += damping * v + damping_2 * v * abs(v)"),
            Form("linear and cubic", ("damping", "damping_3"), _cubic, *both, equation="y += damping * v + damping_3 * v**3"),
            Form("power law", ("damping",), _columns, (0.0,), (np.inf,), ("power",), [(0.6,), (0.75,), (1.3,), (1.7,)],
                 [(0.5, 2.0)], equation="y += damping * abs(v)**power * sign(v)"),
            Form("power law, unequal", ("damping", "damping_back"), _unequal, *both, ("power",), (), [(0.5, 2.0)],
                 ("power law", "linear, unequal"), lambda shape, _: shape or (1.0,),
                 equation="y += where(v > 0, damping, damping_back) * abs(v)**power * sign(v)"),
            *thinning,
            Form("linear, a valve that opens", ("damping", "damping_open"), _opening, *both, ("opening_speed",),
                 [(share * fast,) for share in (0.4, 0.7, 1.1)], [(0.3 * fast, 2.0 * fast)],
                 equation=f"y += damping * {below} + damping_open * (v - {below})"),
            # A power of the speed the other way round imitates delays and what falls with speed.
            overdone(linear),
        ]  # fmt: skip
