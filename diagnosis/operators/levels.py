"""Compiled bristles and sliders that give way at a level which changes on the way."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["attracted", "elastoplastic", "lubricated", "slid", "slid_together", "yielding"]

Floats = NDArray[np.float64]
BENT, MOST_PARTS, SLIDING = 0.2, 200, 0.98
"""Way of one step of an elasto-plastic bristle, over what stretches it to one, steps to a sample at most, and the share of its level from
which it slides."""


@njit(cache=True)
def _yielding(x, level, length, exponent, out):
    f, bend = 0.0, 1.0 - exponent
    for i in range(1, x.size):
        moved = x[i] - x[i - 1]
        way = abs(moved) / (length * level[i])
        towards = level[i] if moved > 0.0 else -level[i]
        if bend == 0.0:
            left = np.exp(-way)
        else:
            # What is left to the level, u, follows du = -|u|^exponent sgn(u) |dx| / (length level), solved in closed form.
            size = abs(1.0 - f / towards)
            used = bend * way * size**-bend if size > 0.0 else 1.0
            left = np.exp(np.log1p(-used) / bend) if used < 1.0 else 0.0
        f = towards + (f - towards) * left
        out[i] = f


@njit(cache=True)
def _elastic_share(f, step, most, breakaway):
    size = abs(f)
    if f * step <= 0.0 or size <= breakaway:
        return 1.0
    if size >= most or breakaway >= most:
        return 1.0 - size / most
    return 1.0 - 0.5 * (1.0 - np.cos(np.pi * (size - breakaway) / (most - breakaway))) * size / most


@njit(cache=True)
def _elastoplastic(time, x, level, length, breakaway, damping, out):
    f, out[0] = 0.0, 0.0
    for i in range(1, x.size):
        moved, most, dt = (x[i] - x[i - 1]) / length, level[i], time[i] - time[i - 1]
        towards = most if moved > 0.0 else -most
        parts = int(min(np.ceil(abs(moved) / BENT), MOST_PARTS))
        step = moved / max(parts, 1)
        if not abs(step) < most:
            # One step would take it there and beyond.
            f, parts = towards, 0
        for part in range(parts):
            if f * towards >= SLIDING * most * most:
                # It slides: all of the way that is left is plastic.
                f = towards + (f - towards) * np.exp(-abs(step) * (parts - part) / most)
                break
            # The midpoint method: how much of the way is plastic bends with the stretch.
            middle = f + 0.5 * step * _elastic_share(f, step, most, breakaway)
            f += step * _elastic_share(middle, step, most, breakaway)
        out[i] = f
        if damping > 0.0 and dt > 0.0:
            out[i] += damping * _elastic_share(f, moved, most, breakaway) * moved / dt


@njit(cache=True)
def _slid_together(x, level, weights, lengths, out):
    stretch = np.zeros(lengths.size)
    out[0] = 0.0
    for i in range(1, x.size):
        total, moved, high = 0.0, x[i] - x[i - 1], level[i]
        for j in range(lengths.size):
            most = high * lengths[j]
            stretch[j] = min(max(stretch[j] + moved, -most), most)
            total += weights[i, j] * stretch[j]
        out[i] = total


@njit(cache=True)
def _attracted(time, x, level, length, settling, sudden, out):
    f, way, sticks = 0.0, 0.0, True
    out[0] = 0.0
    for i in range(1, x.size):
        moved, most = x[i] - x[i - 1], length * level[i]
        towards = 1.0 if moved > 0.0 else -1.0
        if moved == 0.0 and sudden:
            towards = way
        if (moved == 0.0 and not sudden) or towards != way:
            sticks, way = True, towards
        if sticks:
            f += moved
            if f * towards >= most:
                f, sticks = towards * most, False
            elif sudden and -f * towards > most:
                # The level fell faster than the element was relieved.
                f, sticks = -towards * most, False
        else:
            f = towards * most + (f - towards * most) * np.exp((time[i - 1] - time[i]) / (settling * level[i]))
        out[i] = f


@njit(cache=True)
def _lubricated(time, x, length, speed, out):
    f, out[0] = 0.0, 0.0
    for i in range(1, x.size):
        dt = time[i] - time[i - 1]
        if dt > 0.0:
            # Exact for a steady speed between samples.
            towards = (x[i] - x[i - 1]) / (dt * speed)
            f = towards + (f - towards) * np.exp(-dt * speed / length)
            f = min(max(f, -1.0), 1.0)
        out[i] = f


def yielding(x: Floats, level: Floats, length: float, exponent: float = 1.0) -> Floats:
    """LuGre bristle of stiffness 1/``length`` over ``x`` (n,) that yields at ``level`` (n,), shape (n,).

    With another ``exponent`` than one it does so more or less sharply (Dahl, AIAA Journal 14(12), 1976).
    """
    out = np.zeros(x.size)
    _yielding(np.ascontiguousarray(x), np.ascontiguousarray(level), float(length), float(exponent), out)
    return out


def elastoplastic(
    time: Floats, x: Floats, level: Floats, length: float, breakaway: float, damping: float = 0.0
) -> Floats:
    """The same of an elasto-plastic bristle, which yields by and by from ``breakaway`` on: Dupont et al. (IEEE TAC 47, 2002).

    It resists its own speed by ``damping`` (s) times its stiffness.
    """
    out = np.zeros(x.size)
    _elastoplastic(
        np.ascontiguousarray(time), np.ascontiguousarray(x), np.ascontiguousarray(level), float(length), float(breakaway),
        float(damping), out,
    )  # fmt: skip
    return out


def slid(x: Floats, level: Floats, length: float) -> Floats:
    """Spring of stiffness 1/``length`` over ``x`` (n,) whose slider gives way at ``level`` (n,), shape (n,)."""
    return slid_together(x, level, np.full((x.size, 1), 1.0 / length), np.array([length]))


def lubricated(time: Floats, x: Floats, length: float, speed: float) -> Floats:
    """Spring of stiffness 1/``length`` over ``x`` (n,) behind unit friction that gives way before, shape (n,).

    It moves in proportion to its force, at ``speed`` (rad/s) where it slides: so do the soft constraints of simulators.
    """
    out = np.empty(x.size)
    _lubricated(np.ascontiguousarray(time), np.ascontiguousarray(x), float(length), float(speed), out)
    return out


def slid_together(x: Floats, level: Floats, weights: Floats, lengths: Floats) -> Floats:
    """Torque of many of these of ``lengths`` (k,), whose stiffness is ``weights`` (n, k) on the way, shape (n,)."""
    out = np.empty(x.size)
    x, level, weights = np.ascontiguousarray(x), np.ascontiguousarray(level), np.ascontiguousarray(weights)
    _slid_together(x, level, weights, np.ascontiguousarray(lengths), out)
    return out


def attracted(time: Floats, x: Floats, level: Floats, length: float, settling: float, sudden: bool = False) -> Floats:
    """Maxwell slip element of unit stiffness over ``x`` (n,) from rest that gives way at ``length`` times ``level`` (n,), shape (n,).

    While it slips it approaches that with the time constant ``settling`` (s) times the level; it sticks again where the motion
    turns or stops (Lampaert, Al-Bender and Swevers, IEEE Int. Conf. Physics and Control, 2003: generalised Maxwell slip).

    A ``sudden`` one, as it is often written, slips on where the motion only stops, and gives way either way where the level
    falls faster than it is relieved.
    """
    out = np.empty(x.size)
    time, x, level = np.ascontiguousarray(time), np.ascontiguousarray(x), np.ascontiguousarray(level)
    _attracted(time, x, level, float(length), float(settling), sudden, out)
    return out
