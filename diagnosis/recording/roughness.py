"""Whether what passes for noise is of the motion: a ripple that changes faster than the samples follow, or a rattle."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...models.motion import rough_differences
from .noise import interleaved
from .signals import Signals

__all__ = ["roughness"]

Floats = NDArray[np.float64]
SHARE = 0.2
"""Share of the samples that are the slowest, and the fastest."""
FEWEST = 100
"""Samples whose level can be told well enough."""
STRONGER = 1.5
"""Noise at the fastest over that at the slowest from which it is of the motion; on 60 recordings with no gap it was 1.2 at most."""
MATTERS = 1e-3
"""Level at the fastest, over the torque's deviation, from which it is worth a word; less is what rounding of numbers makes."""
KNOWN = 0.5
"""Share of the energy by which it is stronger that the simulator has as well: the measured deflection is rough, not the torque."""


def roughness(signals: Signals) -> float:
    """How many times stronger the noise on the gap is while the joint moves fast than while it hardly moves; 0 if it is not.

    A sensor's noise does not know whether the joint moves. What changes fast with the place passes for noise only where
    the joint passes it fast.
    """
    pieces = interleaved(signals.runs, signals.stride)
    speed = np.concatenate([np.abs(signals.speed[piece])[2:-2] for piece in pieces])
    slow, fast = speed <= np.quantile(speed, SHARE), speed >= np.quantile(speed, 1.0 - SHARE)
    if np.count_nonzero(slow) < FEWEST:
        return 0.0

    def energies(series: Floats) -> tuple[float, float]:
        """Squared levels of the noise on ``series`` (n,) at the slowest and at the fastest."""
        differences = np.concatenate([rough_differences(series[piece]) for piece in pieces])
        return float(np.median(differences[slow])) ** 2, float(np.median(differences[fast])) ** 2

    least = (MATTERS * float(np.std(signals.y_real))) ** 2
    at_rest, moving = energies(signals.gap)
    at_rest = max(at_rest, 1e-4 * least)
    before, after = energies(signals.y_sim)
    if moving < least or moving <= STRONGER**2 * at_rest or after - before > KNOWN * (moving - at_rest):
        return 0.0
    return float(np.sqrt(moving / at_rest))
