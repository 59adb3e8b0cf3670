"""Linear least squares over more rows than memory should hold, with coefficients that may be bounded below by zero."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls
from threadpoolctl import ThreadpoolController

__all__ = ["blocks", "nonnegative", "reduced", "solve"]

Floats = NDArray[np.float64]
ROWS = 1024
"""Rows of a block: so many stay in the processor's cache, which makes the factorisation several times as fast."""


@functools.cache
def _threads() -> ThreadpoolController:
    return ThreadpoolController()


def blocks(size: int) -> Iterator[slice]:
    """The rows 0 … size − 1 in blocks."""
    return (slice(start, min(start + ROWS, size)) for start in range(0, size, ROWS))


def reduced(rows: Iterable[Floats]) -> Floats:
    """The least-squares problem with as many rows as columns and the same minimum.

    Parameters
    ----------
    rows : iterable of ndarray, shape (any, m + 1)
        Blocks of rows; the last column is the target.

    Returns
    -------
    ndarray, shape (at most m + 1, m + 1)
        R of the QR factorisation, made block by block, so that no digits are lost as by normal equations.
    """
    triangle: Floats | None = None
    # Several threads on so few rows wait for each other: on a busy machine they take ten times as long as one.
    with _threads().limit(limits=1, user_api="blas"):
        for block in rows:
            stacked = block if triangle is None else np.vstack([triangle, block])
            triangle = np.asarray(np.linalg.qr(stacked, mode="r")) if stacked.shape[0] > stacked.shape[1] else stacked
    assert triangle is not None
    return triangle


def nonnegative(rows: Floats) -> Floats:
    """Coefficients ≥ 0 of the columns for the last one as target.

    Columns may differ by orders of magnitude; they are scaled, for the solver stops early otherwise.
    """
    scale = np.linalg.norm(rows[:, :-1], axis=0)
    scale[scale == 0.0] = 1.0
    return np.asarray(nnls(rows[:, :-1] / scale, rows[:, -1], maxiter=100 * scale.size)[0] / scale)


def solve(design: Floats, target: Floats, bounded: NDArray[np.bool_]) -> Floats:
    """Least-squares coefficients, those marked ``bounded`` at least 0."""
    rows = reduced(np.column_stack([design[part], target[part]]) for part in blocks(target.size))
    if not np.any(bounded):
        scale = np.linalg.norm(rows[:, :-1], axis=0)
        scale[scale == 0.0] = 1.0
        return np.linalg.lstsq(rows[:, :-1] / scale, rows[:, -1], rcond=1e-12)[0] / scale
    free = ~bounded
    solution = nonnegative(np.hstack([rows[:, :-1], -rows[:, :-1][:, free], rows[:, -1:]]))
    solution, opposite = solution[: bounded.size], solution[bounded.size :]
    solution[free] -= opposite
    return solution
