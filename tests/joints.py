"""Joints of known make, for recordings that no code of the package made."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def compiled(joint: Callable[..., Floats]) -> Callable[..., Floats]:
    """A joint of a time, a deflection, an error and what else it takes, compiled once for all of its callers."""
    quick = njit(cache=True)(joint)

    @functools.wraps(joint)
    def called(time: Floats, x: Floats, e: float = 0.0, *others: float) -> Floats:
        return np.asarray(quick(np.ascontiguousarray(time), np.ascontiguousarray(x), float(e), *others))

    return called


def sliders(x: Floats, elements: Iterable[tuple[float, float]]) -> Floats:
    """Torque of parallel springs with sliders, each of a stiffness and the torque at which it slides, shape (n,)."""
    return np.asarray(_slid(np.ascontiguousarray(x), np.array(list(elements), dtype=float)))


@njit(cache=True)
def _slid(x: Floats, elements: Floats) -> Floats:
    out = np.zeros_like(x)
    for k in range(len(elements)):
        stiffness, limit = elements[k]
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
    elastic, limit = (np.array(part, dtype=float) for part in zip(*elements, strict=True))
    return np.asarray(_crossed(np.ascontiguousarray(x), float(width), float(stiffness), elastic, limit, soft or 0.0))


@njit(cache=True)
def _after(force: Floats, moved: float, elastic: Floats, limit: Floats) -> Floats:
    return np.minimum(np.maximum(force + elastic * moved, -limit), limit)


@njit(cache=True)
def _crossed(x: Floats, width: float, stiffness: float, elastic: Floats, limit: Floats, soft: float) -> Floats:
    force, last, out = np.zeros(limit.size), 0.0, np.empty_like(x)
    for i, value in enumerate(x):
        low, high, place = value - 0.5 * width, value + 0.5 * width, value
        for _ in range(32):
            place = 0.5 * (low + high)
            torque = stiffness * place + _after(force, place - last, elastic, limit).sum()
            pressed = np.tanh(torque / soft) if soft else np.sign(torque)
            if place + 0.5 * width * pressed > value:
                high = place
            else:
                low = place
        force, last = _after(force, place - last, elastic, limit), place
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
