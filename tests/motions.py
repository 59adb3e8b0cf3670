"""Input motions and error measures."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

Floats = NDArray[np.float64]

DECAYING = [0.0, *(np.linspace(1.0, 0.04, 60) * np.where(np.arange(60) % 2 == 0, 1.0, -1.0)).tolist()]
"""Turning points that decay slowly: a recording that tells what a model with memory does."""

NESTED = [0.0, 0.95, -0.8, 0.6, -0.1, 0.5, 0.2, 0.9, -0.97, 0.3, -0.5, 0.15, 0.93, -0.7, 0.4, -0.2, 0.0]
"""Turning points of nested minor loops, none of them a turning point of ``DECAYING``."""


def through(points: Sequence[float], samples: int) -> Floats:
    """Straight motion through ``points`` with so many samples from each to the next."""
    steps = np.arange(samples) / samples
    return np.concatenate([*(a + (b - a) * steps for a, b in pairwise(points)), points[-1:]])


def swelling(size: int = 3500, interval: float = 0.01) -> tuple[Floats, Floats]:
    """Time and deflection of two tones from rest, of which the slower swells and fades, each of shape (n,)."""
    time = np.arange(size) * interval
    x = np.sin(2 * np.pi * 0.31 * time) * (0.55 + 0.35 * np.sin(2 * np.pi * 0.047 * time))
    return time, (x + 0.2 * np.sin(2 * np.pi * 0.83 * time)) * (1.0 - np.exp(-time / 0.5))


def nrmse(found: Floats, wanted: Floats) -> float:
    return float(np.sqrt(np.mean((found - wanted) ** 2)) / np.ptp(wanted))


def turning_points(
    low: float = -1.0, high: float = 1.0, least: int = 2, most: int = 12
) -> st.SearchStrategy[list[float]]:
    """Hypothesis: lists of inputs on a grid, so that returns to earlier inputs and pauses occur."""
    return st.lists(st.integers(0, 40).map(lambda k: low + (high - low) * k / 40.0), min_size=least, max_size=most)
