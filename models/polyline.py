"""Fitting polylines with free vertices to scattered points of a curve, and of the two branches of a loop."""

from __future__ import annotations

import itertools

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.optimize import least_squares

from .least_squares import solve

__all__ = ["closed_loops", "fit_vertices", "hat_basis"]

Floats = NDArray[np.float64]
COARSE, FINE = 320, 1000
"""Bins in which noise averages out, and bins in which hardly any kink is lost."""
LEAST_SLOPE = 0.01
"""Least slope of a branch's segments in a fit, as a fraction of the loop's mean slope."""
NOTHING = 1e-12
"""Share of the points' sum of squares that counts as no error."""
ROUNDS = 12


def hat_basis(x: Floats, vertices: Floats) -> Floats:
    """Design matrix, shape (n, m): the polyline through (vertices, v) takes the values ``hat_basis @ v`` at ``x``.

    Outside the vertices the end segments are continued.
    """
    return _hats(x, vertices, *_places(x, vertices))


def _places(x: Floats, vertices: Floats) -> tuple[NDArray[np.intp], Floats]:
    """The segment of each point and how far along it the point lies, as a fraction of its width."""
    k = np.clip(np.searchsorted(vertices, x) - 1, 0, vertices.size - 2)
    return k, (x - vertices[k]) / _widths(vertices)[k]


def _widths(vertices: Floats) -> Floats:
    # Vertices that a search has moved into one another share their place.
    return np.maximum(np.diff(vertices), np.finfo(float).tiny)


def _hats(x: Floats, vertices: Floats, k: NDArray[np.intp], fraction: Floats) -> Floats:
    basis = np.zeros((x.size, vertices.size))
    rows = np.arange(x.size)
    basis[rows, k] = 1.0 - fraction
    basis[rows, k + 1] = fraction
    return basis


def _moments(x: Floats, y: Floats, w: Floats) -> Floats:
    """Prefix sums of w, wx, wy, wxx, wxy, wyy, shape (6, n + 1): with them the error of any line is an O(1) expression."""
    s = np.zeros((6, x.size + 1))
    np.cumsum([w, w * x, w * y, w * x * x, w * x * y, w * y * y], axis=1, out=s[:, 1:])
    return s


@njit(cache=True)
def _chords(x, y, s, segments):
    """Indices of the vertices that minimise the squared error of a polyline through ``segments`` of the points."""
    n = x.size
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


@njit(cache=True)
def _divide(s, segments):
    """First point of each of the ``segments`` groups of neighbouring points that straight lines fit with least error."""
    n = s.shape[1] - 1
    best = np.full((segments + 1, n + 1), np.inf)
    back = np.zeros((segments + 1, n + 1), dtype=np.int64)
    best[0, 0] = 0.0
    for j in range(2, n + 1):
        for i in range(j - 1):
            weight = s[0, j] - s[0, i]
            mx = (s[1, j] - s[1, i]) / weight
            my = (s[2, j] - s[2, i]) / weight
            xx = s[3, j] - s[3, i] - weight * mx * mx
            xy = s[4, j] - s[4, i] - weight * mx * my
            yy = s[5, j] - s[5, i] - weight * my * my
            error = max(yy - xy * xy / xx, 0.0) if xx > 0.0 else max(yy, 0.0)
            for q in range(1, segments + 1):
                total = best[q - 1, i] + error
                if total < best[q, j]:
                    best[q, j] = total
                    back[q, j] = i
    out = np.empty(segments, dtype=np.int64)
    at = n
    for q in range(segments, 0, -1):
        at = back[q, at]
        out[q - 1] = at
    return out


def _meeting_points(x: Floats, y: Floats, w: Floats, segments: int) -> Floats:
    """Abscissae at which the lines through neighbouring groups of points meet, with the outermost points at the ends.

    Lines that need not meet at a point find a kink between two points as well as one on a point.
    """
    # Of order one, so that neither sums nor squares of extreme figures leave the range of floats.
    reach = np.max(np.abs(x))
    x, y = x / reach, y / max(np.max(np.abs(y)), 5e-324)
    centre = np.mean(x)
    x, y = x - centre, y - np.average(y, weights=w)
    starts = np.append(_divide(_moments(x, y, w), segments), x.size)
    lines = []
    for part in itertools.starmap(slice, itertools.pairwise(starts)):
        mx, my = np.average(np.stack([x[part], y[part]]), axis=1, weights=w[part])
        slope = np.sum(w[part] * (x[part] - mx) * (y[part] - my)) / np.sum(w[part] * (x[part] - mx) ** 2)
        lines.append((slope, my - slope * mx))
    vertices = [x[0]]
    for (before, at_zero), (after, next_at_zero), start in zip(lines, lines[1:], starts[1:-1], strict=False):
        meeting = (at_zero - next_at_zero) / (after - before) if after != before else x[start]
        vertices.append(float(np.clip(meeting, x[start - 1], x[start])))
    return (np.array([*vertices, x[-1]]) + centre) * reach


def _bin(x: Floats, y: Floats, bins: int) -> tuple[Floats, Floats, Floats]:
    """Average the points in equal bins of x, so that noise and uneven sampling do not steer the segmentation."""
    edges = np.linspace(x.min(), x.max(), bins + 1)
    index = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, bins - 1)
    count = np.bincount(index, minlength=bins)
    filled = count > 0
    weight = count[filled].astype(np.float64)
    return (
        np.bincount(index, x, bins)[filled] / weight,
        np.bincount(index, y, bins)[filled] / weight,
        weight,
    )


def fit_vertices(x: Floats, y: Floats, segments: int) -> list[Floats]:
    """Abscissae of the vertices, each of shape (segments + 1,), of rising polylines that are near to scattered points.

    Two dynamic programmes over binned points find global optima: of the polyline with its vertices on points, which
    noise misleads least, and of lines that meet between points, which finds every kink of clean data. From each, least
    squares on all points with the ordinates profiled out then moves the inner vertices.

    Returns
    -------
    list of ndarray
        One result of each programme, the one with the smaller error first; only that one where its error is nothing.

    Raises
    ------
    ValueError
        If there are fewer distinct abscissae than vertices.
    """
    fine, coarse = _bin(x, y, FINE), _bin(x, y, COARSE)
    if coarse[0].size < segments + 1:
        raise ValueError(f"{coarse[0].size} distinct abscissae are too few for {segments} segments")
    if segments == 1:
        return [np.array([float(x.min()), float(x.max())])]
    results: list[tuple[float, Floats]] = []
    if fine[0].size >= 2 * segments:
        results.append(_improved(x, y, _refine(x, y, _meeting_points(*fine, segments))))
    if not results or results[0][0] > NOTHING * float(np.sum((y - y.mean()) ** 2)):
        vertices = _refine(x, y, coarse[0][_chords(coarse[0], coarse[1], _moments(*coarse), segments)])
        # Mostly both lead to the same place.
        if not results or abs(_rising_error(x, y, vertices) - results[0][0]) > 1e-3 * results[0][0]:
            results.append(_improved(x, y, vertices))
    found = [(error, vertices) for error, vertices in results if np.all(np.diff(vertices) > 0.0)]
    return [vertices for _, vertices in sorted(found or results, key=lambda result: result[0])]


def closed_loops(
    rising: tuple[Floats, Floats], falling: tuple[Floats, Floats], segments: int
) -> list[tuple[Floats, Floats]]:
    """Vertices (segments + 1, 2) of the rising and the falling branch for every division that may serve."""
    low = min(rising[0].min(), falling[0].min())
    high = max(rising[0].max(), falling[0].max())
    grids: list[list[Floats]] = []
    for x, y in (rising, falling):
        divisions = fit_vertices(x, y, segments)
        for vertices in divisions:
            vertices[0], vertices[-1] = low, high
        grids.append(divisions)
    return [_closed_loop(rising, falling, (first, second)) for first, second in itertools.product(grids[0], grids[1])]


def _closed_loop(
    rising: tuple[Floats, Floats], falling: tuple[Floats, Floats], grids: tuple[Floats, Floats]
) -> tuple[Floats, Floats]:
    """Vertices of the rising and the falling branch, fitted together so that they meet at both ends."""
    segments = grids[0].size - 1
    y = np.concatenate([rising[1], falling[1]])
    # Where force follows speed a branch bends back before its end. The model can hold curves that rise only, and these
    # rise at least so much that their inverse stays within reach.
    least = [LEAST_SLOPE * float(np.ptp(y)) * (np.diff(grid) / np.ptp(grid)) for grid in grids]
    up, down = _rising_basis(rising[0], grids[0]), _rising_basis(falling[0], grids[1])
    design = np.block([[up, np.zeros((up.shape[0], segments))], [np.zeros((down.shape[0], segments)), down]])
    # Both branches begin at one level and rise by the same: the last row, which outweighs all others.
    meeting = 1e3 * np.sqrt(y.size) * np.concatenate([np.ones(segments), -np.ones(segments), [0.0]])
    rows = np.vstack([np.column_stack([design, np.ones(y.size)]), meeting])
    floor = np.append(np.concatenate(least), 0.0)
    found = solve(rows, np.append(y, 0.0) - rows @ floor, np.arange(floor.size) < 2 * segments) + floor
    ordinates = [found[-1] + np.insert(np.cumsum(part), 0, 0.0) for part in np.split(found[:-1], 2)]
    top = 0.5 * (ordinates[0][-1] + ordinates[1][-1])
    upper, lower = (np.column_stack([grid, np.append(v[:-1], top)]) for grid, v in zip(grids, ordinates, strict=True))
    return upper, lower


def _improved(x: Floats, y: Floats, vertices: Floats) -> tuple[float, Floats]:
    """Error of the rising polyline and its vertices, after some of these have moved to where they serve better."""
    error = _rising_error(x, y, vertices)
    distinct = np.unique(x)
    # A kink between two bins can cost the programme two vertices: give the least useful one to the worst segment.
    for _ in range(ROUNDS):
        refined = [_refine(x, y, trial) for trial in _reallocations(x, y, vertices)]
        # Between samples vertices may bunch where nothing holds their ordinates.
        trials = [trial for trial in refined if np.all(np.diff(np.searchsorted(distinct, trial)) >= 1)]
        if not trials:
            break
        errors = [_rising_error(x, y, trial) for trial in trials]
        best = int(np.argmin(errors))
        if errors[best] >= 0.999 * error:
            break
        vertices, error = trials[best], errors[best]
    return error, vertices


def _rising_basis(x: Floats, vertices: Floats) -> Floats:
    """Design matrix, shape (n, m − 1), for a polyline's rises from vertex to vertex; its first ordinate is 0."""
    return hat_basis(x, vertices) @ np.tri(vertices.size, vertices.size - 1, k=-1)


def _rising_error(x: Floats, y: Floats, vertices: Floats) -> float:
    """Least sum of squares of a polyline with these vertices that falls nowhere."""
    design = np.column_stack([_rising_basis(x, vertices), np.ones(x.size)])
    residuals = design @ solve(design, y, np.arange(vertices.size) < vertices.size - 1) - y
    return float(residuals @ residuals)


def _profile(x: Floats, y: Floats, vertices: Floats) -> tuple[Floats, float]:
    """Residuals and their sum of squares at the best ordinates for these vertices."""
    basis = hat_basis(x, vertices)
    residuals = _at_best(basis, y)[2]
    return residuals, float(residuals @ residuals)


def _at_best(basis: Floats, y: Floats) -> tuple[Floats, Floats, Floats]:
    """Gram matrix of a design, the best ordinates, and the residuals there."""
    # A tiny ridge keeps the problem defined where a segment holds no points.
    gram = basis.T @ basis + 1e-12 * basis.shape[0] * np.eye(basis.shape[1])
    ordinates = np.linalg.solve(gram, basis.T @ y)
    return gram, ordinates, basis @ ordinates - y


def _profile_slopes(x: Floats, y: Floats, vertices: Floats) -> Floats:
    """Derivatives of the residuals, shape (n, m), by the vertices' abscissae; the best ordinates follow these.

    Variable projection (Golub and Pereyra, 1973): the ordinates c solve GᵀG c = Gᵀy of the design G, so that
    dc = (GᵀG)⁻¹ (−dGᵀ r − Gᵀ dG c).
    """
    k, fraction = _places(x, vertices)
    basis = _hats(x, vertices, k, fraction)
    gram, ordinates, residuals = _at_best(basis, y)
    segments, width = vertices.size - 1, _widths(vertices)
    # A vertex that moves takes the line on either side along: by the line's slope, as far as its hat reaches.
    held = -basis * (np.diff(ordinates) / width)[k][:, np.newaxis]
    left = np.bincount(k, (1.0 - fraction) * residuals, segments) / width
    right = np.bincount(k, fraction * residuals, segments) / width
    turned = np.diag(np.append(left, 0.0) - np.insert(right, 0, 0.0)) + np.diag(right, 1) - np.diag(left, -1)
    result: Floats = held - basis @ np.linalg.solve(gram, turned + basis.T @ held)
    return result


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

    def slopes(unknowns: Floats) -> Floats:
        vertices = moved(unknowns)
        shares = np.diff(vertices) / span
        # A gap that widens pushes the vertices behind it outwards, and shrinks with all others to the same span.
        below = np.tri(vertices.size, unknowns.size, k=-1)
        shifts = (below - ((vertices - low) / span)[:, np.newaxis]) * (span * shares[:-1])
        result: Floats = _profile_slopes(x, y, vertices) @ shifts
        return result

    found = least_squares(
        residuals,
        logarithms[:-1] - logarithms[-1],
        jac=slopes,
        x_scale=0.1,
        xtol=1e-12,
        ftol=1e-12,
        gtol=1e-14,
        max_nfev=60,
    )
    return moved(found.x)


def _reallocations(x: Floats, y: Floats, vertices: Floats) -> list[Floats]:
    """An inner vertex is dropped, and one of the two segments with the largest errors split.

    Dropped is the vertex that is missed least, or one of the two that lie closest together: they may share one kink
    and still be missed more than a vertex at a kink of its own.
    """
    without = np.array([_profile(x, y, np.delete(vertices, k))[1] for k in range(1, vertices.size - 1)])
    between = np.diff(np.searchsorted(np.sort(x), vertices))[1:-1]
    closest = int(np.argmin(between)) if between.size else 0
    bunched = closest + int(np.argmin(without[closest : closest + 2]))
    trials = []
    starts = [np.delete(vertices, 1 + k) for k in {int(np.argmin(without)), bunched}]
    # Where two vertices shared one kink, the other must move there first, or their kink looks like the worst place.
    for kept in [*starts, *(_refine(x, y, start) for start in starts)]:
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
