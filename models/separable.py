"""Separable least squares: few nonlinear parameters searched globally, the linear ones solved for at every trial.

Friction laws and differential equations of hysteresis are linear in their forces once the few constants of their state
are fixed. Profiling the forces out (Golub & Pereyra 1973) leaves two to four unknowns, which a quasi-random global
search followed by least squares finds without a starting guess.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.optimize import least_squares

from .base import Floats, Run, sampling_intervals
from .least_squares import solve
from .motion import auto_dead_band, settled_from, turning_points

__all__ = ["fit_separable", "largest_speed", "powers", "spread_points", "thinned", "unscaled"]

SEARCH_SAMPLES = 2000
"""Samples of the global search; the refinement uses all."""

REFINED = 3
"""Points of the global search that are refined: different constants can give nearly the same loop."""


def powers(u: Floats, degree: int) -> Floats:
    """1, u, …, u^degree as columns, shape (n, degree + 1)."""
    return np.vander(u, degree + 1, increasing=True)


def unscaled(coefficients: Floats, scale: float) -> Floats:
    """Polynomial coefficients in x from those in x / scale."""
    return coefficients / scale ** np.arange(coefficients.size)


def largest_speed(runs: Sequence[Run]) -> float:
    """Largest speed of the input, jumps of single samples left out."""
    speeds = np.concatenate([np.abs(np.diff(r.x)) / sampling_intervals(r.time, r.x.size)[1:] for r in runs])
    return float(np.quantile(speeds, 0.99)) or float(speeds.max())


def thinned(runs: Sequence[Run], samples: int) -> list[Run]:
    """The runs with about ``samples`` samples in all, every turning point kept: memory depends on them."""
    stride = sum(run.x.size for run in runs) // samples
    if stride <= 1:
        return list(runs)
    result = []
    for run in runs:
        kept = np.union1d(np.arange(0, run.x.size, stride), turning_points(run.x, auto_dead_band(run.x)))
        result.append(Run(run.x[kept], run.y[kept], None if run.time is None else run.time[kept]))
    return result


def spread_points(low: Floats, high: Floats, count: int, seed: int) -> Floats:
    """Points of a scrambled Sobol sequence between ``low`` and ``high`` (m,), shape (count, m)."""
    # It takes a quarter of a second to load, which those do not need who only predict.
    from scipy.stats import qmc

    # Sobol points come in powers of two; what is beyond ``count`` is dropped.
    sequence = qmc.Sobol(low.size, seed=seed).random_base2(int(np.ceil(np.log2(count))))[:count]
    return np.asarray(qmc.scale(sequence, low, high))


def fit_separable(
    regressors: Callable[[Floats, Run], Floats],
    runs: Sequence[Run],
    lower: Sequence[float] | Floats,
    upper: Sequence[float] | Floats,
    nonnegative: Sequence[bool],
    starts: int,
    seed: int,
    guesses: Sequence[Floats] = (),
    rounds: int = 40,
    near: Floats | None = None,
) -> tuple[Floats, Floats]:
    """Nonlinear point and linear coefficients that minimise the squared error of ``regressors(point, run) @ c``.

    Parameters
    ----------
    regressors : callable
        Columns, shape (n, m), over one run at a point within ``lower`` and ``upper``.
    nonnegative : sequence of bool, length m
        Coefficients that must not be negative.
    starts : int
        Points of the global search.
    guesses : sequence of array
        Points that are refined as well.
    rounds : int
        Evaluations of each refinement at most, those for its derivatives not counted.
    near : array, optional
        The only point that is refined, instead of a search.
    """
    low, high, sign = np.array(lower), np.array(upper), np.array(nonnegative)

    def residuals(point: Floats, data: Sequence[Run]) -> tuple[Floats, Floats]:
        # Until the whole range was covered the memory depends on an unknown past.
        first = [settled_from(run.x) for run in data]
        design = np.concatenate([regressors(point, run)[k:] for run, k in zip(data, first, strict=True)])
        target = np.concatenate([run.y[k:] for run, k in zip(data, first, strict=True)])
        coefficients = solve(design, target, sign)
        return design @ coefficients - target, coefficients

    def errors(point: Floats, data: Sequence[Run]) -> Floats:
        return residuals(point, data)[0]

    spread = 0.25 * (high - low)

    def searched() -> Floats:
        few = thinned(runs, SEARCH_SAMPLES)
        refined = [np.clip(guess, low, high) for guess in guesses]
        if starts:
            points = spread_points(low, high, starts, seed)
            costs = [np.sum(errors(point, few) ** 2) for point in points]
            refined += [points[k] for k in np.argsort(costs, kind="stable")[:REFINED]]
        found = [
            least_squares(errors, point, bounds=(low, high), x_scale=spread, max_nfev=rounds, args=(few,))
            for point in refined
        ]
        return np.asarray(min(found, key=lambda result: result.cost).x)

    best = least_squares(
        errors, searched() if near is None else np.clip(near, low, high), bounds=(low, high), x_scale=spread, args=(runs,),
        xtol=1e-12, ftol=1e-12, gtol=1e-14, max_nfev=rounds,
    )  # fmt: skip
    return best.x, residuals(best.x, runs)[1]
