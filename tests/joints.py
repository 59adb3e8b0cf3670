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


def through_a_clearance(
    x: Floats, width: float, stiffness: float, elements: Iterable[tuple[float, float]], soft: float | None = None
) -> Floats:
    """Torque of a spring and sliders behind a clearance that is crossed where the torque is nil, shape (n,).

    It is at the flank to which the torque presses it or, where flanks yield over a torque ``soft``, on the way there.
    """
    elastic, limit = (np.array(part) for part in zip(*elements, strict=True))
    force, last, out = np.zeros(limit.size), 0.0, np.empty_like(x)

    def after(place: float) -> Floats:
        return np.clip(force + elastic * (place - last), -limit, limit)

    for i, value in enumerate(x):
        low, high = value - 0.5 * width, value + 0.5 * width
        for _ in range(32):
            place = 0.5 * (low + high)
            torque = stiffness * place + after(place).sum()
            pressed = np.sign(torque) if soft is None else np.tanh(torque / soft)
            low, high = (low, place) if place + 0.5 * width * pressed > value else (place, high)
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
