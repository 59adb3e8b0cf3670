"""Whether a recorded torque comes in steps."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .signals import Signals

__all__ = ["torque_step"]

Floats = NDArray[np.float64]
SURE = 0.7
"""Mean resultant length of the torque on a circle of one step at which it is taken to come in steps."""
STILL = 0.05
"""Samples that move less than this share of the median are left out: a hold is no step."""
TRIES_A_TURN = 12
FINEST, COARSEST = 0.6, 6.0
"""Steps that are tried, over √12 times the noise."""


def torque_step(signals: Signals) -> float:
    """Step in which the recorded torque comes, N·m; 0 if its steps do not make up most of the noise.

    Rounding to a step q adds about q/√12 of error, of which less passes for noise the longer the torque stays on a step, so
    q is searched from somewhat below √12 times the noise to well beyond. Wound around a circle of circumference q, quantised
    values meet in one place (Rayleigh's test of direction, Mardia & Jupp, 2000).
    """
    y, moved = signals.y_real, np.abs(np.gradient(signals.y_sim))
    moving = y[moved > STILL * np.median(moved)]
    span = float(np.ptp(moving))
    middle = np.sqrt(12.0) * signals.noise_floor
    # Beyond, a slightly wrong step would lose count of the turns within the span.
    if not 4.0 * middle < span < 1e4 * middle:
        return 0.0
    turns = np.arange(span / (COARSEST * middle), span / (FINEST * middle), 1.0 / TRIES_A_TURN)
    # From one number of turns to the next each value turns on by the same angle: no further exponentials.
    wound, on = np.exp(2j * np.pi / span * np.array([[turns[0]], [1.0 / TRIES_A_TURN]]) * moving)
    lengths = np.empty(turns.size)
    for k in range(turns.size):
        lengths[k] = abs(wound.mean())
        wound *= on
    best = int(np.argmax(lengths))
    return float(span / turns[best]) if lengths[best] > SURE else 0.0
