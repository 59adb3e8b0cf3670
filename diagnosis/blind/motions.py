"""Motions of the blind check's recordings."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator
from scipy.ndimage import uniform_filter1d
from scipy.signal import butter, sosfilt

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


def _wander(rng: np.random.Generator, reach: float, seconds: float, rate: float) -> tuple[Floats, Floats]:
    """Noise within a band, from rest."""
    time = np.arange(int(seconds * rate)) / rate
    band = butter(3, [0.05, rng.uniform(0.8, 2.0)], "bandpass", fs=rate, output="sos")
    x = sosfilt(band, rng.standard_normal(time.size)) * (1.0 - np.exp(-time))
    return time, reach * x / float(np.max(np.abs(x)))


def _stairs(rng: np.random.Generator, reach: float, seconds: float, rate: float) -> tuple[Floats, Floats]:
    """Triangles of rising and falling amplitude at three speeds, some of them held at their ends."""
    time = np.arange(int(seconds * rate)) / rate
    knots, values, at = [0.0], [0.0], 0.0
    while at < seconds:
        pace = reach * rng.choice([0.5, 1.2, 3.0])
        for share in rng.permutation([0.2, 0.45, 0.7, 1.0])[:3]:
            for side in (1.0, -1.0):
                target = side * share * reach
                at += abs(target - values[-1]) / pace
                knots.append(at)
                values.append(target)
                if rng.random() < 0.2:
                    at += rng.uniform(0.4, 1.5)
                    knots.append(at)
                    values.append(target)
    x = uniform_filter1d(np.interp(time, knots, values), max(int(0.1 * rate), 3))
    return time, x - x[0]


MOTIONS = {"rich": _rich, "sweeps": _sweeps, "one sine": _one_sine, "wander": _wander, "stairs": _stairs}
