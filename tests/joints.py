"""Joints of known make, for recordings that no code of the package made."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def sliders(x: Floats, elements: Iterable[tuple[float, float]]) -> Floats:
    """Torque of parallel springs with sliders, each of a stiffness and the torque at which it slides, shape (n,)."""
    out = np.zeros_like(x)
    for stiffness, limit in elements:
        force, last = 0.0, 0.0
        for i, value in enumerate(x):
            force = min(max(force + stiffness * (value - last), -limit), limit)
            last = value
            out[i] += force
    return out
