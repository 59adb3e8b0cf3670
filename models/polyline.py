"""Fitting a polyline with free vertices to scattered points of a curve."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.optimize import least_squares

__all__ = ["fit_vertices", "hat_basis"]

Floats = NDArray[np.float64]
BINS = 320


def hat_basis(x: Floats, vertices: Floats) -> Floats:
    """Design matrix, shape (n, m): the polyline through (vertices, v) takes the values ``hat_basis @ v`` at ``x``.

    Outside the vertices the end segments are continued.
    """
    k = np.clip(np.searchsorted(vertices, x) - 1, 0, vertices.size - 2)
    fraction = (x - vertices[k]) / (vertices[k + 1] - vertices[k])
    basis = np.zeros((x.size, vertices.size))
    rows = np.arange(x.size)
    basis[rows, k] = 1.0 - fraction
    basis[rows, k + 1] = fraction
    return basis


@njit(cache=True)
def _segment(x, y, w, segments):
    """Indices of the vertices that minimise the squared error of a polyline through ``segments`` of the points."""
    n = x.size
    # Prefix sums of w, wx, wy, wxx, wxy, wyy make the error of every chord an O(1) expression.
    s = np.zeros((6, n + 1))
    for i in range(n):
        a, b, c = w[i], x[i], y[i]
        values = (a, a * b, a * c, a * b * b, a * b * c, a * c * c)
        for q in range(6):
            s[q, i + 1] = s[q, i] + values[q]
    best = np.full((segments + 1, n), np.inf)
    back = np.zeros((segments + 1, n), dtype=np.int64)
    best[0, 0] = 0.0
    for j in range(1, n):
        for i in range(j):
            slope = (y[j] - y[i]) / (x[j] - x[i])
            level = y[i] - slope * x[i]
            d0 = s[0, j] - s[0, i]
            d1 = s[1, j] - s[1, i]
            d2 = s[2, j] - s[2, i]
            d3 = s[3, j] - s[3, i]
            d4 = s[4, j] - s[4, i]
            d5 = s[5, j] - s[5, i]
            error = d5 - 2 * slope * d4 - 2 * level * d2 + slope * slope * d3 + 2 * slope * level * d1 + level * level * d0
            for q in range(1, segments + 1):
                total = best[q - 1, i] + max(error, 0.0)
                if total < best[q, j]:
                    best[q, j] = total
                    back[q, j] = i
    out = np.empty(segments + 1, dtype=np.int64)
    out[segments] = n - 1
    for q in range(segments, 0, -1):
        out[q - 1] = back[q, out[q]]
    return out


def _bin(x: Floats, y: Floats) -> tuple[Floats, Floats, Floats]:
    """Average the points in equal bins of x, so that noise and uneven sampling do not steer the segmentation."""
    edges = np.linspace(x.min(), x.max(), BINS + 1)
    index = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, BINS - 1)
    count = np.bincount(index, minlength=BINS)
    filled = count > 0
    weight = count[filled].astype(np.float64)
    return (
        np.bincount(index, x, BINS)[filled] / weight,
        np.bincount(index, y, BINS)[filled] / weight,
        weight,
    )


def fit_vertices(x: Floats, y: Floats, segments: int) -> Floats:
    """Abscissae of the vertices, shape (segments + 1,), of the least-squares polyline through scattered points.

    A dynamic programme over binned points finds the global optimum on the bin grid; least squares on all points, with
    the ordinates profiled out, then moves the inner vertices off the grid. The outer two are the extremes of ``x``.

    Raises
    ------
    ValueError
        If there are fewer distinct abscissae than vertices.
    """
    bx, by, weight = _bin(x, y)
    if bx.size < segments + 1:
        raise ValueError(f"{bx.size} distinct abscissae are too few for {segments} segments")
    low, high = float(x.min()), float(x.max())
    inner = bx[_segment(bx, by, weight, segments)][1:-1]
    if not inner.size:
        return np.array([low, high])
    span = high - low
    # Gaps as unknowns (through a softmax-like normalisation) keep the order without constraints.
    gaps = np.maximum(np.diff(np.concatenate([[low], inner, [high]])), 1e-4 * span)

    def vertices(logarithms: Floats) -> Floats:
        parts = np.exp(np.concatenate([logarithms, [0.0]]))
        return low + span * np.concatenate([[0.0], np.cumsum(parts) / parts.sum()])

    def residual(logarithms: Floats) -> Floats:
        basis = hat_basis(x, vertices(logarithms))
        # A tiny ridge keeps the problem defined where a segment holds no points.
        gram = basis.T @ basis + 1e-12 * x.size * np.eye(basis.shape[1])
        return basis @ np.linalg.solve(gram, basis.T @ y) - y

    start = np.log(gaps[:-1] / gaps[-1])
    found = least_squares(residual, start, x_scale=0.1, xtol=1e-12, ftol=1e-14, gtol=1e-14, max_nfev=60)
    result = vertices(found.x)
    result[-1] = high
    return result
