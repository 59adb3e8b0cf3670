"""What recorded datasets share: thinning, the noise of their sensors, and where their warm-up ends."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..models.motion import noise_level, turning_points
from .base import Recording

__all__ = ["sensor_noise", "thinned", "until_first_turn"]


def sensor_noise(recordings: Sequence[Recording]) -> tuple[float, float]:
    """Standard deviation of the white noise on x and y: the median over recordings, which must not be thinned yet."""
    x, y = ([noise_level(getattr(recording, name)) for recording in recordings] for name in ("x", "y"))
    return float(np.median(x)), float(np.median(y))


def thinned(recording: Recording, stride: int) -> Recording:
    """Every ``stride``-th sample."""
    return replace(
        recording,
        time=recording.time[::stride],
        x=recording.x[::stride],
        y=recording.y[::stride],
        warm_up=-(-recording.warm_up // stride),
        channels={name: values[::stride] for name, values in recording.channels.items()},
    )


def until_first_turn(recording: Recording, share: float) -> Recording:
    """Give the recording a warm-up up to its first turn of more than ``share`` of its range: what was before is unknown."""
    turns = turning_points(recording.x, share * float(np.ptp(recording.x)))
    return replace(recording, warm_up=int(turns[1]))
