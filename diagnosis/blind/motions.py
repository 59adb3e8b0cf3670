"""Motions of the blind check's recordings."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

__all__ = ["MOTIONS"]

Floats = NDArray[np.float64]


def _rich(rng: np.random.Generator, reach: float, seconds: float, rate: float) -> tuple[Floats, Floats]:
    """Bursts of sines of many amplitudes and rates, ramps and holds; smooth, zero at both ends."""
    time = np.arange(int(seconds * rate)) / rate
    knots, values = [0.0], [0.0]
    at = 0.0
    while at < seconds:
        kind = rng.choice(["sine", "hold", "ramp"], p=[0.6, 0.2, 0.2])
        amplitude = reach * rng.choice([1.0, 0.8, 0.6, 0.4, 0.25], p=[0.3, 0.2, 0.2, 0.15, 0.15])
        if kind == "sine":
            period = 1.0 / rng.choice([0.3, 0.5, 0.8, 1.2, 2.0])
            for k in range(int(rng.integers(2, 5))):
                at += 0.5 * period
                knots.append(at)
                values.append(amplitude * (1.0 if k % 2 == 0 else -1.0) * rng.uniform(0.85, 1.0))
        elif kind == "ramp":
            at += rng.uniform(0.8, 3.0)
            knots.append(at)
            values.append(amplitude * rng.choice([-1.0, 1.0]))
        else:
            at += rng.uniform(0.5, 2.0)
            knots.append(at)
            values.append(values[-1])
    return time, PchipInterpolator(knots, values)(time)


def _sweeps(rng: np.random.Generator, reach: float, seconds: float, rate: float) -> tuple[Floats, Floats]:
    """Two chirps and a sum of incommensurate sines under a slow envelope."""
    time = np.arange(int(seconds * rate)) / rate
    u = time / seconds
    chirp = np.sin(2.0 * np.pi * (0.15 * time + 0.5 * (rng.uniform(1.0, 2.0) - 0.15) / seconds * time**2))
    sum_of = (
        sum(
            np.sin(2.0 * np.pi * f * time + p)
            for f, p in zip(rng.uniform(0.1, 1.3, 4), rng.uniform(0.0, 6.28, 4), strict=True)
        )
        / 2.2
    )
    envelope = 0.35 + 0.65 * np.sin(np.pi * rng.uniform(2.0, 3.5) * u + 0.3) ** 2
    blend = 0.5 - 0.5 * np.cos(np.pi * np.clip((u - 0.46) / 0.08, 0.0, 1.0))
    start = 0.5 - 0.5 * np.cos(np.pi * np.clip(time / 0.8, 0.0, 1.0))
    x = envelope * start * ((1.0 - blend) * chirp + blend * sum_of)
    return time, reach * x / float(np.max(np.abs(x)))


def _one_sine(rng: np.random.Generator, reach: float, seconds: float, rate: float) -> tuple[Floats, Floats]:
    time = np.arange(int(seconds * rate)) / rate
    return time, reach * np.sin(2.0 * np.pi * 0.5 * time)


MOTIONS = {"rich": _rich, "sweeps": _sweeps, "one sine": _one_sine}
