"""Whether what passes for noise is of the motion: a ripple that changes faster than the samples follow, or a rattle."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .noise import STRONGER, at_rest_and_moving
from .signals import Signals

__all__ = ["roughness"]

Floats = NDArray[np.float64]
MATTERS = 1e-3
"""Level at the fastest, over the torque's deviation, from which it is worth a word; less is what rounding of numbers makes."""
KNOWN = 0.5
"""Share of the energy by which it is stronger that the simulator has as well: the measured deflection is rough, not the torque."""


def roughness(signals: Signals) -> float:
    """How many times stronger the noise on the gap is while the joint moves fast than while it hardly moves; 0 if it is not.

    What changes fast with the place passes for noise only where the joint passes it fast.
    """

    def energies(series: Floats) -> tuple[float, float]:
        """Squared levels of the noise on ``series`` (n,) at the slowest and at the fastest."""
        slow, fast = at_rest_and_moving(series, signals.speed, signals.runs, signals.stride)
        return slow**2, fast**2

    least = (MATTERS * float(np.std(signals.y_real))) ** 2
    at_rest, moving = energies(signals.gap)
    at_rest = max(at_rest, 1e-4 * least)
    before, after = energies(signals.y_sim)
    if moving < least or moving <= STRONGER**2 * at_rest or after - before > KNOWN * (moving - at_rest):
        return 0.0
    return float(np.sqrt(moving / at_rest))
