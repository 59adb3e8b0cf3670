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


def dahl(x: Floats, friction: float, presliding: float, exponent: float) -> Floats:
    """Dahl's friction, integrated step by step, from rest, shape (n,)."""
    state, last, out = 0.0, 0.0, np.empty_like(x)
    for i, value in enumerate(x):
        step, last = value - last, value
        short = 1.0 - state * np.sign(step)
        state = min(max(state + np.sign(short) * abs(short) ** exponent * step / presliding, -1.0), 1.0)
        out[i] = friction * state
    return out


def through_a_clearance(x: Floats, width: float, stiffness: float, elements: Iterable[tuple[float, float]]) -> Floats:
    """Torque of a spring and sliders behind a clearance that is crossed where the torque is nil, shape (n,)."""
    elastic, limit = (np.array(part) for part in zip(*elements, strict=True))
    force, last, out = np.zeros(limit.size), 0.0, np.empty_like(x)

    def after(place: float) -> Floats:
        return np.clip(force + elastic * (place - last), -limit, limit)

    for i, value in enumerate(x):
        low, high = value - 0.5 * width, value + 0.5 * width
        # Pressed to a flank, or, where the torque is of one sign at either, at the place between them without torque.
        if stiffness * low + after(low).sum() > 0.0:
            place = low
        elif stiffness * high + after(high).sum() < 0.0:
            place = high
        else:
            for _ in range(40):
                middle = 0.5 * (low + high)
                low, high = (low, middle) if stiffness * middle + after(middle).sum() > 0.0 else (middle, high)
            place = 0.5 * (low + high)
        force, last = after(place), place
        out[i] = stiffness * place + force.sum()
    return out


def clearance(x: Floats, torque: Floats, half: float) -> Floats:
    """Position within a clearance of ±``half``, at the side that the torque presses it to, shape (n,).

    Once the torque has changed its sign the motion ``x`` (n,) carries it across.
    """
    at = half * np.sign(torque[0])
    out = np.full_like(x, at)
    for i in range(1, x.size):
        if torque[i] == 0.0 or at != half * np.sign(torque[i]):
            at = min(max(at + x[i] - x[i - 1], -half), half)
        out[i] = at
    return out
