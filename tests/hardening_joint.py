"""A joint whose spring hardens differently up and down, its motions, and recordings of it."""

from __future__ import annotations

import numpy as np
from joints import sliders
from numpy.typing import NDArray

from hystbench.diagnosis.recording.signals import Signals

Floats = NDArray[np.float64]
NOISE = 0.015


def spring(x: Floats, up: float = 1.2, down: float = 0.7, stiffness: float = 4.0, friction: float = 0.3) -> Floats:
    """A spring that hardens differently up and down, and elastic-plastic elements."""
    out = stiffness * x + up * np.maximum(x, 0.0) ** 3 - down * np.maximum(-x, 0.0) ** 3
    elements = ((0.5, 0.03), (0.3, 0.1), (0.2, 0.25))
    return out + sliders(x, ((share * friction / reach, share * friction) for share, reach in elements))


def rich_motion(size: int = 3000) -> tuple[Floats, Floats]:
    time = np.arange(size) * 0.01
    x = np.sin(2 * np.pi * 0.31 * time) * (0.5 + 0.3 * np.sin(2 * np.pi * 0.043 * time)) + 0.25 * np.sin(
        2 * np.pi * 1.13 * time
    )
    return time, x * (1.0 - np.exp(-time / 0.5))


def one_sine() -> tuple[Floats, Floats]:
    time = np.arange(3000) * 0.01
    return time, 0.8 * np.sin(2 * np.pi * 0.5 * time)


def signals_of(
    time: Floats, x: Floats, y_real: Floats, y_sim: Floats, seed: int = 1, noise_level: float = NOISE
) -> Signals:
    noise = noise_level * np.random.default_rng(seed).standard_normal(x.size)
    return Signals(time, x, y_real + noise, y_sim, [slice(0, x.size)], {})


def relaxing_branch(time: Floats, x: Floats, constant: float) -> Floats:
    """A spring behind a dashpot, exact for a ramp between samples."""
    step = float(time[1] - time[0])
    keep = np.exp(-step / constant)
    out = np.zeros_like(x)
    for i in range(1, x.size):
        out[i] = keep * out[i - 1] + constant / step * (1.0 - keep) * (x[i] - x[i - 1])
    return out
