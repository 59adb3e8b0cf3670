"""Slow drift with time or temperature, of the zero or of the stiffness."""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

import numpy as np

from .base import Effect, Floats, Form, Parameter, Scene, geometric

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
    equation: ClassVar[str] = "y += a w  or  y += a w y_sim,  w = 1 − exp(−t/τ), t, lagged |y v| or temperature rise"
    coordinate: ClassVar[str] = "time"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("zero_drift", "N·m, N·m/s, N·m/W or N·m/K", -np.inf, np.inf, "drift of the zero"),
        Parameter("stiffness_drift", "1, 1/s or 1/K", -np.inf, np.inf, "relative drift of the torque"),
        Parameter("time_constant", "s", 0.0, np.inf, "of warming up"),
    )
    confused_with: ClassVar[tuple[str, ...]] = ("cyclic_softening", "torque_gain", "torque_offset")

    def forms(self, scene: Scene) -> list[Form]:
        s = scene.signals
        span = float(s.elapsed.max())
        times = [(t,) for t in geometric(0.05 * span, 1.5 * span, 6)]
        # Warming up that is over within a thirtieth of the recording could not be told from an offset or a gain.
        limits = [(0.03 * span, 3.0 * span)]
        free = (-np.inf,), (np.inf,)
        made = [
            Form("zero, linear", ("zero_drift",), _zero, *free),
            Form("zero, exponential", ("zero_drift",), _zero, *free, ("time_constant",), times, limits),
            Form("zero, self-heating", ("zero_drift",), _self_heating, *free, ("time_constant",), times[1::2], limits),
            Form(
                "stiffness, self-heating",
                ("stiffness_drift",),
                _stiffness_self_heating,
                *free,
                ("time_constant",),
                times[1::2],
                limits,
            ),
            Form("stiffness, linear", ("stiffness_drift",), _stiffness, *free),
            Form("stiffness, exponential", ("stiffness_drift",), _stiffness, *free, ("time_constant",), times, limits),
        ]
        for name, values in s.channels.items():
            if "temp" in name.lower() and np.ptp(values) > 0.0:
                made.append(Form(f"zero by {name}", ("zero_drift",), _channel(name, False), *free))
                made.append(Form(f"stiffness by {name}", ("stiffness_drift",), _channel(name, True), *free))
        return made
