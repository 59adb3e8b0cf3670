"""Nonlinear least squares by scipy's optimiser, without the slopes that it asks for in vain."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

__all__ = ["least"]

Floats = NDArray[np.float64]


def least(
    left: Callable[[Floats], Floats],
    slopes: Callable[[Floats], Floats],
    first: Floats,
    bounds: tuple[Floats, Floats],
    evaluations: int,
    ftol: float,
    xtol: float = 1e-8,
    x_scale: Floats | float = 1.0,
) -> tuple[Floats, Floats]:
    """Where the sum of squares of ``left(values)`` (n,) is least within bounds, from ``first`` (k,) on, and what is left there.

    ``slopes(values)`` has shape (n, k). As :func:`scipy.optimize.least_squares`, which asks for the slopes once more when it
    has made up its mind to stop: these are not made, and with few steps they are a third of all.
    """
    asked, cost = 0, np.inf
    known, there, before = np.empty(0), first, np.inf

    def counted(values: Floats) -> Floats:
        nonlocal asked, cost
        asked += 1
        made = left(values)
        cost = 0.5 * float(made @ made)
        return made

    def needed(values: Floats) -> Floats:
        nonlocal known, there, before
        stopping = (
            asked >= evaluations
            or before - cost < ftol * before
            or np.linalg.norm(values - there) < xtol * (xtol + np.linalg.norm(there))
        )
        if not (known.size and stopping):
            known, there, before = slopes(values), values.copy(), cost
        return known

    found = least_squares(
        counted, first, needed, bounds=bounds, max_nfev=evaluations, xtol=xtol, ftol=ftol, x_scale=x_scale
    )
    return found.x, found.fun
