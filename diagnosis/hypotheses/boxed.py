"""Least squares of a few unknowns within bounds, many at a time."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["RIDGE", "boxed_least_squares"]

Floats = NDArray[np.float64]
RIDGE = 1e-9
"""Strength of the ridge that keeps equal columns from cancelling each other."""


def boxed_least_squares(gram: Floats, moment: Floats, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
    """Minimise β'Gβ − 2 g'β within lower ≤ β ≤ upper, for a batch.

    Parameters
    ----------
    gram : array, shape (m, k, k)
    moment : array, shape (m, k)
    lower, upper : array, shape (k,)

    Returns
    -------
    coefficients : array, shape (m, k)
    reduction : array, shape (m,)
        2 g'β − β'Gβ, by which the sum of squares falls.
    """
    m, k = moment.shape
    if k == 0:
        return np.zeros((m, 0)), np.zeros(m)
    if k == 1:
        single = np.clip(moment / np.maximum(gram[:, 0], 1e-300), lower, upper)
        return single, np.asarray((2.0 * moment * single - gram[:, 0] * single**2)[:, 0])
    beta, reduction = np.empty((m, k)), np.empty(m)
    _boxed(np.ascontiguousarray(gram), np.ascontiguousarray(moment), lower, upper, beta, reduction)
    return beta, reduction


@njit(cache=True)
def _boxed(gram, moment, lower, upper, beta, reduction):
    k = moment.shape[1]
    norm, wanted, low, high, value, found = np.empty((6, k))
    held, system = np.empty(k, np.bool_), np.empty((k, k))
    for i in range(moment.shape[0]):
        for a in range(k):
            norm[a] = np.sqrt(max(gram[i, a, a], 1e-300))
            wanted[a], low[a], high[a] = moment[i, a] / norm[a], lower[a] * norm[a], upper[a] * norm[a]
            held[a] = lower[a] == upper[a]
            value[a] = low[a] if held[a] and np.isfinite(low[a]) else 0.0
        # Clamp what leaves the box and solve again; each round clamps one more unknown, so k rounds end it.
        for _ in range(k + 1):
            for a in range(k):
                found[a] = value[a] if held[a] else wanted[a]
                for b in range(k):
                    system[a, b] = 1.0 if a == b else 0.0
                    share = gram[i, a, b] / (norm[a] * norm[b])
                    if not held[a] and held[b]:
                        found[a] -= share * value[b]
                    elif not held[a]:
                        system[a, b] = share + (RIDGE if a == b else 0.0)
            _solve(system, found)
            worst, most = -1, 0.0
            for a in range(k):
                excess = max(low[a] - found[a], found[a] - high[a])
                if not held[a] and excess > most:
                    worst, most = a, excess
            for a in range(k):
                value[a] = value[a] if held[a] else found[a]
            if worst < 0:
                break
            value[worst] = min(max(found[worst], low[worst]), high[worst])
            held[worst] = True
        for a in range(k):
            beta[i, a] = value[a] / norm[a]
        reduction[i] = 0.0
        for a in range(k):
            for b in range(k):
                reduction[i] -= beta[i, a] * gram[i, a, b] * beta[i, b]
            reduction[i] += 2.0 * beta[i, a] * moment[i, a]


@njit(cache=True)
def _solve(system, right):
    """Solve for few unknowns in place; positive definite, so without pivots. LAPACK would take most of the time to be called."""
    k = right.size
    for a in range(k):
        for b in range(a + 1, k):
            share = system[b, a] / system[a, a]
            for c in range(a + 1, k):
                system[b, c] -= share * system[a, c]
            right[b] -= share * right[a]
    for a in range(k - 1, -1, -1):
        for b in range(a + 1, k):
            right[a] -= system[a, b] * right[b]
        right[a] /= system[a, a]
