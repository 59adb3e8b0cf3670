"""Slow drift with time or temperature, of the zero or of the stiffness."""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

import numpy as np

from .base import Effect, Floats, Form, Parameter, Scene, geometric, inside

__all__ = ["ThermalDrift"]


def _warming(scene: Scene, shape: tuple[float, ...]) -> Floats:
    t = scene.signals.elapsed
    return 1.0 - np.exp(-t / shape[0]) if shape else t


def _zero(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return _warming(scene, shape)[:, None]


def _stiffness(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return (_warming(scene, shape) * scene.torque)[:, None]


def _self_heating(scene: Scene, shape: tuple[float, ...]) -> Floats:
    """Temperature by the joint's own losses, which go with |y v|, against cooling."""
    s = scene.signals
    power = np.abs(scene.torque * s.speed)
    # The lag settles at its first input, so the joint starts cold where the power starts at zero.
    warm = s.lowpass(power, shape[0]) - power[0] * np.exp(-s.elapsed / shape[0])
    return warm[:, None]


def _stiffness_self_heating(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return _self_heating(scene, shape) * scene.torque[:, None]


def _wave(scene: Scene, shape: tuple[float, ...]) -> Floats:
    """Day and night, or a heater that cycles: a slow wave that starts at zero."""
    angle = 2.0 * np.pi * scene.signals.elapsed / shape[0]
    return np.column_stack([np.sin(angle), np.cos(angle) - 1.0])


def _stiffness_wave(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return _wave(scene, shape) * scene.torque[:, None]


def _channel(name: str, stiffness: bool) -> Callable[[Scene, tuple[float, ...]], Floats]:
    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        rise = scene.signals.channels[name] - scene.signals.channels[name][0]
        return (rise * scene.torque if stiffness else rise)[:, None]

    return columns


class ThermalDrift(Effect):
    """The joint or its torque sensor warms up during the recording."""

    id: ClassVar[str] = "thermal_drift"
    title: ClassVar[str] = "thermal drift"
    summary: ClassVar[str] = "zero or stiffness that drifts with time or temperature while the joint warms up"
    equation: ClassVar[str] = (
        "y += a w  or  y += a w y_sim (or a part of it),  w = 1 − exp(−t/τ), t, lagged |y v|, sin(2πt/P) with "
        "b (cos(2πt/P) − 1), or temperature rise"
    )
    coordinate: ClassVar[str] = "time"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("zero_drift", "N·m, N·m/s, N·m/W or N·m/K", -np.inf, np.inf, "drift of the zero"),
        Parameter("stiffness_drift", "1, 1/s or 1/K", -np.inf, np.inf, "relative drift of the torque"),
        Parameter("zero_drift_cos", "N·m", -np.inf, np.inf, "b, cosine part of a slow wave of the zero"),
        Parameter("stiffness_drift_cos", "1", -np.inf, np.inf, "b, cosine part of a slow wave of the torque"),
        Parameter("time_constant", "s", 0.0, np.inf, "of warming up"),
        Parameter("period", "s", 0.0, np.inf, "P of a slow wave"),
    )
    confused_with: ClassVar[tuple[str, ...]] = ("cyclic_softening", "torque_gain", "torque_offset")

    def forms(self, scene: Scene) -> list[Form]:
        s = scene.signals
        span = float(s.elapsed.max())
        times = [(t,) for t in geometric(0.05 * span, 1.5 * span, 6)]
        # Warming up that is over within a thirtieth of the recording could not be told from an offset or a gain.
        limits = [(0.03 * span, 3.0 * span)]
        free = (-np.inf,), (np.inf,)
        both = (-np.inf,) * 2, (np.inf,) * 2
        waves = [(share * span,) for share in (0.6, 1.2, 2.4)]
        slow = [(0.5 * span, 4.0 * span)]
        heated = Form("stiffness, self-heating", ("stiffness_drift",), _stiffness_self_heating, *free,
                      ("time_constant",), times[1::2], limits)  # fmt: skip
        warmed = Form(
            "stiffness, exponential", ("stiffness_drift",), _stiffness, *free, ("time_constant",), times, limits
        )
        waved = Form("stiffness, slow wave", ("stiffness_drift", "stiffness_drift_cos"), _stiffness_wave, *both,
                     ("period",), waves, slow)  # fmt: skip
        made = [
            Form("zero, linear", ("zero_drift",), _zero, *free),
            Form("zero, exponential", ("zero_drift",), _zero, *free, ("time_constant",), times, limits),
            Form("zero, self-heating", ("zero_drift",), _self_heating, *free, ("time_constant",), times[1::2], limits),
            Form("zero, slow wave", ("zero_drift", "zero_drift_cos"), _wave, *both, ("period",), waves, slow),
            heated,
            Form("stiffness, linear", ("stiffness_drift",), _stiffness, *free),
            warmed,
            waved,
            *inside(heated, _self_heating),
            *inside(warmed, _zero),
            *inside(waved, _wave),
        ]
        for name, values in s.channels.items():
            if "temp" in name.lower() and np.ptp(values) > 0.0:
                made.append(Form(f"zero by {name}", ("zero_drift",), _channel(name, False), *free))
                made.append(Form(f"stiffness by {name}", ("stiffness_drift",), _channel(name, True), *free))
        return made
