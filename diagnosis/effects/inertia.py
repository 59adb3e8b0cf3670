"""A mass between the torque sensor and the spring."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from scipy.signal import periodogram

from ..recording.signals import Signals
from .base import (
    LOW,
    NOT,
    Columns,
    Effect,
    Floats,
    Form,
    Parameter,
    Scene,
    at_either_end,
    between_ends,
    geometric,
    overdone,
)

__all__ = ["Inertia"]

AT_REST = 0.1
"""Speed, over its standard deviation, that is standing still."""
IN_PROPORTION, EVEN, ANY = (
    np.array([[1.0, 0.0], [0.5, 0.5], [0.0, 1.0]]),
    np.array([[1.0, 0.0], [0.0, 1.0], [1.0, 0.0]]),
    np.eye(3),
)
"""Ways in which an inertia changes over the stroke, by its values above, in the middle and below."""
MOVING = 0.99
"""Share of the speed's power below the end of the band in which the motion is."""
ABOVE = 1.5
"""Natural frequency over that end from which a mass on a spring is an inertia."""


def _band(signals: Signals) -> float:
    """The end of the band in which the motion is, rad/s."""
    run = max(signals.runs, key=lambda each: each.stop - each.start)
    frequency, power = periodogram(signals.speed[run], 1.0 / signals.interval)
    within = np.cumsum(power)
    return float(2.0 * np.pi * frequency[np.searchsorted(within, MOVING * within[-1])])


def _columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return scene.signals.acceleration[:, None]


def _by_position(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return np.column_stack([share * scene.signals.acceleration for share in at_either_end(scene)])


def _lagrangian(places: Floats) -> Columns:
    """J a + J' v² / 2 of an inertia J whose values at the largest deflection, at none and at as much on the other side are tied.

    ``places`` (3, k) makes these values of k parameters; between them J is the parabola.
    """

    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        s = scene.signals
        place, turned = s.smooth_x / s.stroke, 0.5 * np.square(s.speed) / s.stroke
        shares = 0.5 * place * (place + 1.0), 1.0 - np.square(place), 0.5 * place * (place - 1.0)
        slopes = place + 0.5, -2.0 * place, place - 0.5
        made = [share * s.acceleration + slope * turned for share, slope in zip(shares, slopes, strict=True)]
        return np.column_stack(made) @ places

    return columns


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
        "y += J d²x/dt², at t or at t − τ, J constant, linear in x (with or without J' (dx/dt)² / 2), even or any quadratic (with it), or y += z with d²z/dt² + 2ζω dz/dt + ω² z = ω² J d²x/dt²"
    )
    coordinate: ClassVar[str] = "acceleration"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("inertia", "kg·m²", -np.inf, np.inf, "moment of inertia; negative where the simulator has too much"),
        Parameter("inertia_upper", "kg·m²", 0.0, np.inf, "J at the largest deflection, of a mechanism that changes it"),
        Parameter("inertia_lower", "kg·m²", 0.0, np.inf, "the same at as much on the other side"),
        Parameter("inertia_ends", "kg·m²", 0.0, np.inf, "J at the largest deflection either way"),
        Parameter("inertia_middle", "kg·m²", 0.0, np.inf, "the same at none"),
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
        swings = (max(2.0 * acceleration / max(speed, 1e-300), ABOVE * _band(signals)), 0.7 / step)
        free = (0.0,), (np.inf,)
        size = f"{scene.signals.stroke:.8g}"
        ends = "inertia_upper", "inertia_lower"
        changing = f"{between_ends(scene, *ends)} * a"
        turning = f"(inertia_upper - inertia_lower) / {size} / 4 * v**2"
        slope, bend = "(inertia_upper - inertia_lower) / 2", "((inertia_upper + inertia_lower) / 2 - inertia_middle)"
        both, three = ((0.0,) * 2, (np.inf,) * 2), ((0.0,) * 3, (np.inf,) * 3)
        rigid = Form("rigid", ("inertia",), _columns, *free, equation="y += inertia * a")
        made = [
            rigid,
            overdone(rigid),
            Form("by position", ends, _by_position, *both, equation=f"y += {changing}"),
            Form("of a mechanism", ends, _lagrangian(IN_PROPORTION), *both, equation=f"y += {changing} + {turning}"),
            Form("of a symmetric mechanism", ("inertia_ends", "inertia_middle"), _lagrangian(EVEN), *both,
                 equation=f"y += (inertia_middle + (inertia_ends - inertia_middle) * (x / {size})**2) * a "
                 f"+ (inertia_ends - inertia_middle) * x * (v / {size})**2"),
            Form("of a crank", (ends[0], "inertia_middle", ends[1]), _lagrangian(ANY), *three,
                 equation=f"y += (inertia_middle + {slope} * x / {size} + {bend} * (x / {size})**2) * a "
                 f"+ ({slope} + 2 * {bend} * x / {size}) / {size} * v**2 / 2"),
            Form("behind a shaft", ("inertia",), _behind_shaft, *free, ("shaft_lag",), (), [(0.02 * step, longest)], ("rigid",),
                 lambda shape, coefficients: (min(step, 0.5 * longest),), equation="y += inertia * late(a, shaft_lag)"),
        ]  # fmt: skip
        if swings[0] < swings[1]:
            made.append(
                Form("behind a compliant transmission", ("inertia",), _on_spring, *free, ("natural_frequency", "damping_ratio"),
                     [(w, d) for w in geometric(*swings, 10) for d in (0.04, 0.2)], [swings, (0.005, 0.3)],
                     borders=[LOW, NOT], equation="y += inertia * resonator(a, natural_frequency, damping_ratio)")
            )  # fmt: skip
        return made
