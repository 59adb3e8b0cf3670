"""What is not all there at the start of a recording."""

from __future__ import annotations

import numpy as np

from .base import Floats, Parameter, Scene

__all__ = ["SETTLING", "settled", "settling_limits", "settling_start"]


SETTLING = (
    Parameter("unsettled", "1", -0.4, 0.4, "q, part that is missing at the start"),
    Parameter("settling_time", "s", 0.0, np.inf, "τ, in which the rest comes"),
)
"""Parameters of what is not all there at the start; they are its shapes."""


def settled(scene: Scene, unsettled: float, settling_time: float) -> Floats:
    """Share that is there of what settles, shape (n,)."""
    return np.asarray(1.0 - unsettled * np.exp(-scene.signals.elapsed / settling_time))


def settling_limits(scene: Scene) -> list[tuple[float, float]]:
    """Limits of the shapes of what settles: what has not, to within a hundredth, when the recording ends is a drift."""
    s = scene.signals
    return [(SETTLING[0].lower, SETTLING[0].upper), (2.0 * s.interval, 0.25 * float(s.elapsed.max()))]


def settling_start(scene: Scene) -> tuple[float, float]:
    """Shapes from which what settles is refined."""
    return 0.1, 0.05 * float(scene.signals.elapsed.max())
