"""Whether what passes for noise are spikes: lost samples, a loose contact, interference."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .noise import rms

__all__ = ["OUTLIERS", "spikes"]

Floats = NDArray[np.float64]
FAR = 5.0
"""Noise levels beyond which a sample stands out."""
LARGE = 2.0
"""Size of the gap over the noise from which most of its energy is in what stands out."""
OUTLIERS = 3
"""Samples up to which they are outliers of a recording that has no gap otherwise."""


def spikes(gap: Floats) -> float:
    """Share of the samples of a ``gap`` (n,), in noise levels, that stand far out where they make up most of it; 0 otherwise.

    The noise's level is a robust one and what knocks for a moment is cut off, so that spikes pass for noise however
    large they are.
    """
    return float(np.mean(np.abs(gap) > FAR)) if rms(gap) > LARGE else 0.0
