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
    for i in range(moment.shape[0]):
        norm = np.sqrt(np.maximum(np.diag(gram[i]), 1e-300))
        wanted, low, high = moment[i] / norm, lower * norm, upper * norm
        held = lower == upper
        value = np.where(held & np.isfinite(low), low, 0.0)
        # Clamp what leaves the box and solve again; each round clamps one more unknown, so k rounds end it.
        for _ in range(k + 1):
            system, right = np.eye(k), value.copy()
            for a in range(k):
                if held[a]:
                    continue
                right[a] = wanted[a]
                for b in range(k):
                    share = gram[i, a, b] / (norm[a] * norm[b])
                    if held[b]:
                        right[a] -= share * value[b]
                    else:
                        system[a, b] = share + (RIDGE if a == b else 0.0)
            found = np.linalg.solve(system, right)
            worst, most = -1, 0.0
            for a in range(k):
                excess = max(low[a] - found[a], found[a] - high[a])
                if not held[a] and excess > most:
                    worst, most = a, excess
            value = np.where(held, value, found)
            if worst < 0:
                break
            value[worst] = min(max(found[worst], low[worst]), high[worst])
            held[worst] = True
        beta[i] = value / norm
        reduction[i] = 0.0
        for a in range(k):
            for b in range(k):
                reduction[i] -= beta[i, a] * gram[i, a, b] * beta[i, b]
            reduction[i] += 2.0 * beta[i, a] * moment[i, a]
