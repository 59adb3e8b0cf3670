"""Fitting a polyline with free vertices to scattered points of a curve."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.optimize import least_squares

__all__ = ["fit_vertices", "hat_basis"]

Floats = NDArray[np.float64]
BINS = 320
ROUNDS = 12


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
            error = (
                d5 - 2 * slope * d4 - 2 * level * d2 + slope * slope * d3 + 2 * slope * level * d1 + level * level * d0
            )
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
    if segments == 1:
        return np.array([low, high])
    vertices = _refine(x, y, bx[_segment(bx, by, weight, segments)])
    error = _profile(x, y, vertices)[1]
    distinct = np.unique(x)
    # A kink between two bins can cost the programme two vertices: give the least useful one to the worst segment.
    for _ in range(ROUNDS):
        refined = [_refine(x, y, trial) for trial in _reallocations(x, y, vertices)]
        # Between samples vertices may bunch where nothing holds their ordinates.
        trials = [trial for trial in refined if np.all(np.diff(np.searchsorted(distinct, trial)) >= 1)]
        if not trials:
            break
        errors = [_profile(x, y, trial)[1] for trial in trials]
        best = int(np.argmin(errors))
        if errors[best] >= 0.999 * error:
            break
        vertices, error = trials[best], errors[best]
    return vertices


def _profile(x: Floats, y: Floats, vertices: Floats) -> tuple[Floats, float]:
    """Residuals and their sum of squares at the best ordinates for these vertices."""
    basis = hat_basis(x, vertices)
    # A tiny ridge keeps the problem defined where a segment holds no points.
    gram = basis.T @ basis + 1e-12 * x.size * np.eye(basis.shape[1])
    residuals = basis @ np.linalg.solve(gram, basis.T @ y) - y
    return residuals, float(residuals @ residuals)


def _refine(x: Floats, y: Floats, vertices: Floats) -> Floats:
    """Move the inner vertices to a least-squares minimum, keeping their order."""
    low, high = float(x.min()), float(x.max())
    span = high - low
    parts = np.diff(np.concatenate([[low], vertices[1:-1], [high]]))
    # Logarithms of the gaps as unknowns keep the order without constraints.
    logarithms = np.log(np.maximum(parts, 1e-4 * span))

    def moved(unknowns: Floats) -> Floats:
        gaps = np.exp(np.concatenate([unknowns, [0.0]]))
        result = low + span * np.concatenate([[0.0], np.cumsum(gaps) / gaps.sum()])
        result[-1] = high
        return result

    def residuals(unknowns: Floats) -> Floats:
        return _profile(x, y, moved(unknowns))[0]

    found = least_squares(
        residuals,
        logarithms[:-1] - logarithms[-1],
        x_scale=0.1,
        xtol=1e-12,
        ftol=1e-14,
        gtol=1e-14,
        max_nfev=60,
    )
    return moved(found.x)


def _reallocations(x: Floats, y: Floats, vertices: Floats) -> list[Floats]:
    """The inner vertex that is missed least is dropped, and one of the two segments with the largest errors split."""
    without = [_profile(x, y, np.delete(vertices, k))[1] for k in range(1, vertices.size - 1)]
    dropped = np.delete(vertices, 1 + int(np.argmin(without)))
    trials = []
    # Where two vertices shared one kink, the other must move there first, or their kink looks like the worst place.
    for kept in (dropped, _refine(x, y, dropped)):
        residuals, _ = _profile(x, y, kept)
        index = np.clip(np.searchsorted(kept, x) - 1, 0, kept.size - 2)
        for worst in np.argsort(np.bincount(index, residuals**2, kept.size - 1))[-2:]:
            inside = index == worst
            if not np.any(inside):
                continue
            # The kink lies where the residual of the chord is largest.
            at = float(x[inside][np.argmax(np.abs(residuals[inside]))])
            margin = 0.02 * (kept[worst + 1] - kept[worst])
            trials.append(np.insert(kept, worst + 1, np.clip(at, kept[worst] + margin, kept[worst + 1] - margin)))
    return trials
