"""Compiled loops that yield smoothly, and such that are pinched.

Their slope is given by where they are and the direction of the motion alone. So as long as that goes one way all of them
run along one curve from -1 to 1, wherever they enter it: it is made once, and where the motion turns it is entered anew.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["pinched", "smooth"]

Floats = NDArray[np.float64]
SETTLED = 1e-5
"""Slope from which on a loop is level, over its first one."""
KNOTS, LONGEST = 0.1, 20_000
"""Steps along the curve, in its own lengths over its steepness and in widths of a pinch, and how many at most to where it is level:
some pinches are never passed."""
ENTERED = 3
"""Newton's steps to where the curve is entered."""


@njit(cache=True)
def _rate(q, way, exponent, share, depth, place, width):
    # Of a smooth loop where it has come from zero by q in the direction of the motion, or, way = -1, has still to go by q to zero.
    level = 1.0 - share * q**exponent
    return level if depth == 0.0 else (1.0 - depth * np.exp(-(((way * q - place) / width) ** 2))) * level


@njit(cache=True)
def _from_zero(h, way, exponent, share, depth, place, width):
    # The loop's curve at steps h from zero on until one, or until it hardly goes on.
    q, made = 0.0, [0.0]
    while q < 1.0 and 1.0 - share * q**exponent > SETTLED and len(made) < LONGEST:
        k1 = _rate(q, way, exponent, share, depth, place, width)
        k2 = _rate(q + 0.5 * h * k1, way, exponent, share, depth, place, width)
        k3 = _rate(q + 0.5 * h * k2, way, exponent, share, depth, place, width)
        k4 = _rate(q + h * k3, way, exponent, share, depth, place, width)
        q += h * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0
        made.append(q)
    return np.array(made)


@njit(cache=True)
def _between(u, first, last, first_slope, last_slope):
    # A cubic with these values and slopes at its ends, u = 0 and 1, and its own slope.
    a, b = first_slope - (last - first), last - first - last_slope
    bent = a * (1.0 - u) + b * u
    value = first + u * (last - first + (1.0 - u) * bent)
    return value, last - first + (1.0 - 2.0 * u) * bent + u * (1.0 - u) * (b - a)


@njit(cache=True)
def _entered(q, curve, slopes):
    # Where the curve is entered, in its steps.
    k = min(max(np.searchsorted(curve, q, side="right") - 1, 0), curve.size - 2)
    u = min(max((q - curve[k]) / (curve[k + 1] - curve[k]), 0.0), 1.0)
    for _ in range(ENTERED):
        there, slope = _between(u, curve[k], curve[k + 1], slopes[k], slopes[k + 1])
        u = min(max(u - (there - q) / max(slope, 1e-300), 0.0), 1.0)
    return k + u


@njit(cache=True)
def _along_curve(x, level, length, exponent, share, depth, place, width, out):
    back = 1.0 - 2.0 * share
    h = KNOTS / (max(1.0, exponent) * max(1.0, abs(back)))
    if depth > 0.0:
        h = min(h, KNOTS * width)
    before = _from_zero(h, -1.0, exponent, back, depth, place, width)
    curve = np.concatenate((-before[:0:-1], _from_zero(h, 1.0, exponent, 1.0, depth, place, width)))
    slopes = np.empty(curve.size)
    for k in range(curve.size):
        way, of = (-1.0, back) if curve[k] < 0.0 else (1.0, 1.0)
        slopes[k] = h * _rate(abs(curve[k]), way, exponent, of, depth, place, width)
    end = curve.size - 1.0
    q, way, at, most = 0.0, 0.0, 0.0, 1.0
    out[0] = 0.0
    for i in range(1, x.size):
        moved = x[i] - x[i - 1]
        if moved != 0.0:
            now, high = 1.0 if moved > 0.0 else -1.0, level[i]
            if now != way or high != most:
                # What it holds it still holds where its level has changed.
                q = (q if now == way else -q) * most / high
                way, most = now, high
                at = _entered(q, curve, slopes)
            step = abs(moved) / (length * most)
            # Where its level fell below what it holds it is off the curve.
            if q > 1.0:
                q = max(q + step * _rate(q, 1.0, exponent, 1.0, depth, place, width), 1.0)
            elif q < -1.0:
                q += step * _rate(-q, -1.0, exponent, back, depth, place, width)
                at = _entered(q, curve, slopes)
            else:
                at = min(at + step / h, end)
                k = max(min(int(at), curve.size - 2), 0)
                q, _ = _between(at - k, curve[k], curve[k + 1], slopes[k], slopes[k + 1])
        out[i] = way * q * length * most


def smooth(x: Floats, length: float, exponent: float, share: float, level: Floats | float = 1.0) -> Floats:
    """Bouc-Wen element of unit stiffness over ``x`` (n,) from rest that saturates at ``length`` times ``level`` (n,), shape (n,).

    ``share`` is that of beta in beta + gamma. It is followed to 5e-5 of its length, in a fraction of the
    time that the registered model takes (Wen, J. Eng. Mech. Div. 102, 1976).
    """
    return pinched(x, length, exponent, share, 0.0, 0.0, 1.0, level)


def pinched(
    x: Floats,
    length: float,
    exponent: float,
    share: float,
    depth: float,
    place: float,
    width: float,
    level: Floats | float = 1.0,
) -> Floats:
    """What :func:`smooth` makes, its stiffness less by the share ``depth`` at ``place`` of ``length`` past zero, shape (n,).

    The pinch is as wide as ``width`` of ``length`` (Baber and Noori, J. Eng. Mech. 111, 1985, 1010–1026).
    """
    out = np.empty(x.size)
    sizes = float(length), float(exponent), float(share), float(depth), float(place), float(width)
    _along_curve(np.ascontiguousarray(x), level * np.ones(x.size), *sizes, out)
    return out
