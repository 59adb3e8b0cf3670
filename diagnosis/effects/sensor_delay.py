"""One sensor later than the other."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from ..recording.noise import rms
from .base import SENSOR, Effect, Floats, Form, Parameter, Scene, geometric

__all__ = ["SensorDelay"]


def _delay(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return (scene.signals.delayed(scene.torque, shape[0]) - scene.torque)[:, None]


def _lag(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return (scene.signals.lowpass(scene.torque, shape[0]) - scene.torque)[:, None]


def _lag_twice(scene: Scene, shape: tuple[float, ...]) -> Floats:
    signals = scene.signals
    return (signals.lowpass(signals.lowpass(scene.torque, shape[0]), shape[0]) - scene.torque)[:, None]


def _late_and_filtered(scene: Scene, shape: tuple[float, ...]) -> Floats:
    signals = scene.signals
    return (signals.lowpass(signals.delayed(scene.torque, shape[0]), shape[1]) - scene.torque)[:, None]


def _filtered_deflection(scene: Scene, shape: tuple[float, ...]) -> Floats:
    """The joint is where the filter has yet to get to."""
    signals = scene.signals
    return (scene.torque_at(signals.x + shape[0] * signals.speed) - scene.torque)[:, None]


class SensorDelay(Effect):
    """Torque is recorded later than deflection (positive) or earlier (negative: the encoder is late)."""

    id: ClassVar[str] = "sensor_delay"
    title: ClassVar[str] = "sensor delay"
    summary: ClassVar[str] = "torque and deflection recorded at different times (bus, filter, sampling)"
    equation: ClassVar[str] = "y(t) = y_sim(t − τ), τ dy/dt = y_sim − y, once or twice, or both; or x → x + τ dx/dt"
    coordinate: ClassVar[str] = "speed"
    acts_on: ClassVar[str] = SENSOR
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("delay", "s", -1.0, 1.0, "positive: torque late; negative: deflection late"),
        Parameter("lag", "s", 0.0, 1.0, "time constant of a first-order filter on the torque"),
        Parameter("deflection_lag", "s", 0.0, 1.0, "time constant of one on the deflection"),
    )
    confused_with: ClassVar[tuple[str, ...]] = ("viscous_friction", "stress_relaxation", "backlash")

    def forms(self, scene: Scene) -> list[Form]:
        step = scene.signals.interval
        # Up to 25 samples, or 20 degrees of the motion's mean frequency where it is sampled densely.
        speed = rms(scene.signals.speed)
        high = max(25.0 * step, 0.35 * float(np.std(scene.signals.smooth_x)) / max(speed, 1e-300))
        high = min(high, 0.1 * float(scene.signals.elapsed.max()))
        grid = geometric(0.1 * step, 0.7 * high, 9)
        late = "y = late(y, delay)"
        return [
            Form("late", ("_unit",), _delay, (1.0,), (1.0,), ("delay",), [(t,) for t in grid], [(0.02 * step, high)],
                 equation=late),
            Form("early", ("_unit",), _delay, (1.0,), (1.0,), ("delay",), [(-t,) for t in grid], [(-high, -0.02 * step)],
                 equation=late),
            Form("second-order filter", ("_unit",), _lag_twice, (1.0,), (1.0,), ("lag",), [(0.5 * t,) for t in grid[1::2]],
                 [(0.02 * step, high)], equation="y = lowpass(lowpass(y, lag), lag)"),
            Form("filter", ("_unit",), _lag, (1.0,), (1.0,), ("lag",), [(t,) for t in grid], [(0.02 * step, high)],
                 equation="y = lowpass(y, lag)"),
            Form("late and filtered", ("_unit",), _late_and_filtered, (1.0,), (1.0,), ("delay", "lag"), (),
                 [(0.01 * step, high), (0.01 * step, high)], ("late", "filter", "second-order filter"),
                 lambda shape, _: (0.5 * shape[0], 0.5 * shape[0]), equation="y = lowpass(late(y, delay), lag)"),
            Form("deflection behind a filter", ("_unit",), _filtered_deflection, (1.0,), (1.0,), ("deflection_lag",), (),
                 [(0.02 * step, high)], ("early",), lambda shape, _: (-shape[0],), equation="x = x + deflection_lag * v"),
        ]  # fmt: skip
