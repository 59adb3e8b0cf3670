"""Torque that cannot exceed a limit."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from ..operators.memory import plays
from .base import SENSOR, Effect, Floats, Form, Parameter, Scene

__all__ = ["TorqueSaturation"]

UNEQUAL = ((0.95, 0.7), (0.85, 0.6), (0.7, 0.45))
"""Limits on two sides to start from, as shares of the largest torque."""


def _hard(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return (np.clip(scene.torque, -shape[0], shape[0]) - scene.torque)[:, None]


def _unequal(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return (np.clip(scene.torque, -shape[1], shape[0]) - scene.torque)[:, None]


def _soft(scene: Scene, shape: tuple[float, ...]) -> Floats:
    limit, power = shape
    return _soft_unequal(scene, (limit, limit, power))


def _soft_unequal(scene: Scene, shape: tuple[float, ...]) -> Floats:
    # Linear well below the limit and flat above it; a larger exponent makes a sharper knee.
    above, below, power = shape
    limit = np.where(scene.torque > 0.0, above, below)
    magnitude = np.minimum(np.abs(scene.torque) / limit, 1e6 ** (1.0 / power) * 10.0)
    return (scene.torque * ((1.0 + magnitude**power) ** (-1.0 / power) - 1.0))[:, None]


def _smooth(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return (shape[0] * np.tanh(scene.torque / shape[0]) - scene.torque)[:, None]


def _slipping(scene: Scene, shape: tuple[float, ...]) -> Floats:
    """A clutch in series: what it has slipped by is missing until it slips back."""
    return -scene.signals.per_run(lambda run: plays(scene.torque[run], np.array([shape[0]]))[:, 0])[:, None]


def _spring_hard(scene: Scene, shape: tuple[float, ...]) -> Floats:
    """A coupling that gives way before the bearings' friction."""
    return (np.clip(scene.spring, -shape[0], shape[0]) - scene.spring)[:, None]


def _by_speed(scene: Scene, shape: tuple[float, ...]) -> Floats:
    """A motor's voltage limit: the faster it drives, the less is left; what brakes it is limited by the current alone."""
    limit, idle_speed = shape
    v = scene.signals.speed
    left = np.maximum(limit * (1.0 - np.where(scene.torque * v > 0.0, np.abs(v), 0.0) / idle_speed), 0.0)
    return (np.clip(scene.torque, -left, left) - scene.torque)[:, None]


class TorqueSaturation(Effect):
    """Sensor range, current limit or slipping clutch."""

    id: ClassVar[str] = "torque_saturation"
    title: ClassVar[str] = "torque saturation"
    summary: ClassVar[str] = "torque that cannot exceed a limit (sensor range, current limit, slipping clutch)"
    equation: ClassVar[str] = (
        "y = clip(y_sim, ±L) (or a part h of it, or its elastic part) or y_sim/(1 + |y_sim/L|^p)^(1/p), each also with another limit below zero, "
        "L tanh(y_sim/L), L (1 − |v|/V) where it drives, or a clutch that slips: y_sim − p, p = clip(p, y_sim ± L)"
    )
    coordinate: ClassVar[str] = "load"
    acts_on: ClassVar[str] = SENSOR
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("limit", "N·m", 0.0, np.inf, "largest torque L"),
        Parameter("limit_below", "N·m", 0.0, np.inf, "the same below zero, where it differs"),
        Parameter("idle_speed", "rad/s", 0.0, np.inf, "V, speed at which a motor has no torque left"),
        Parameter("held", "1", 0.6, 1.0, "part of the torque beyond the limit that is taken away"),
        Parameter("sharpness", "1", 1.5, 40.0, "exponent p of the knee"),
    )
    confused_with: ClassVar[tuple[str, ...]] = ("torque_gain", "end_stop", "miscalibration")

    def forms(self, scene: Scene) -> list[Form]:
        top = float(np.max(np.abs(scene.torque)))
        if top == 0.0:
            return []
        # Where dry friction makes the loop's edges flat, a limit just below them takes much off.
        grid = [(f * top,) for f in (0.4, 0.5, 0.6, 0.68, 0.75, 0.81, 0.87, 0.92, 0.96, 0.98)]
        wide = [(f * top,) for f in (0.6, 0.8, 1.0, 1.3, 1.7, 2.5, 4.0)]
        fast = max(float(np.max(np.abs(scene.signals.speed))), 1e-300)
        unit = ("_unit",), (1.0,), (1.0,)
        within = (0.2 * top, 0.99 * top)
        return [
            Form("hard", unit[0], _hard, unit[1], unit[2], ("limit",), grid, [within],
                 equation="y = clip(y, -limit, limit)"),
            Form("hard, unequal limits", unit[0], _unequal, unit[1], unit[2], ("limit", "limit_below"),
                 [(a * top, b * top) for high, low in UNEQUAL for a, b in ((high, low), (low, high))], [within] * 2,
                 ("hard",), lambda shape, _: (shape[0], shape[0]), equation="y = clip(y, -limit_below, limit)"),
            Form("hard, leaking", ("held",), _hard, (0.6,), (1.0,), ("limit",), (), [within], ("hard",),
                 equation="y += held * (clip(y, -limit, limit) - y)"),
            Form("soft", unit[0], _soft, unit[1], unit[2], ("limit", "sharpness"),
                 [(f * top, p) for f in (0.6, 0.8, 0.95, 1.15, 1.6) for p in (3.0, 7.0, 16.0)],
                 [(0.3 * top, 6.0 * top), (1.5, 40.0)],
                 equation="y = y / (1 + abs(y / limit)**sharpness)**(1 / sharpness)"),
            Form("soft, unequal limits", unit[0], _soft_unequal, unit[1], unit[2], ("limit", "limit_below", "sharpness"),
                 [(a * top, b * top, 8.0) for f in (0.6, 0.8, 0.95, 1.15) for a, b in ((f, 3.0), (3.0, f))],
                 [(0.3 * top, 6.0 * top), (0.3 * top, 6.0 * top), (1.5, 40.0)],
                 ("hard, unequal limits",), lambda shape, _: (*shape, 16.0),
                 equation="y = y / (1 + abs(y / where(y > 0, limit, limit_below))**sharpness)**(1 / sharpness)"),
            Form("hard, of the spring", unit[0], _spring_hard, unit[1], unit[2], ("limit",), grid, [within],
                 equation="y += clip(y_spring, -limit, limit) - y_spring"),
            Form("hard, of the spring, leaking", ("held",), _spring_hard, (0.6,), (1.0,), ("limit",), (), [within],
                 ("hard, of the spring",), equation="y += held * (clip(y_spring, -limit, limit) - y_spring)"),
            Form("hard, falling with speed", unit[0], _by_speed, unit[1], unit[2], ("limit", "idle_speed"), (),
                 [(0.2 * top, 1.5 * top), (1.02 * fast, 30.0 * fast)], ("hard",), lambda shape, _: (shape[0], 3.0 * fast),
                 equation="y = sign(y) * minimum(abs(y), limit * maximum(1 - where(y * v > 0, abs(v), 0) / idle_speed, 0))"),
            Form("slipping clutch", unit[0], _slipping, unit[1], unit[2], ("limit",), grid, [within],
                 equation="y = y - play(y, limit)"),
            Form("smooth", unit[0], _smooth, unit[1], unit[2], ("limit",), wide, [(0.3 * top, 10.0 * top)],
                 equation="y = limit * tanh(y / limit)"),
        ]  # fmt: skip
