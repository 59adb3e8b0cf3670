"""Least squares in blocks: the same minimum as NumPy's and SciPy's solvers on all rows at once."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import nnls

from hystbench.models import least_squares


def problem(rows: int, columns: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(rows)
    design = rng.normal(size=(rows, columns)) * 10.0 ** rng.uniform(-6.0, 6.0, columns)
    return design, rng.normal(size=rows)


def test_blocks_cover_every_row_once() -> None:
    for size in (1, least_squares.ROWS, least_squares.ROWS + 1, 5000):
        covered = np.concatenate([np.arange(size)[part] for part in least_squares.blocks(size)])
        np.testing.assert_array_equal(covered, np.arange(size))


@pytest.mark.parametrize("rows", [3, 6, 7, 1024, 1025, 5000])
def test_reduced_rows_keep_the_sum_of_squares_for_any_coefficients(rows: int) -> None:
    design, target = problem(rows, 6)
    stacked = np.column_stack([design, target])
    small = least_squares.reduced(stacked[part] for part in least_squares.blocks(rows))
    assert small.shape[0] <= 7
    for seed in range(3):
        at = np.append(np.random.default_rng(seed).normal(size=6), -1.0)
        assert np.sum((small @ at) ** 2) == pytest.approx(np.sum((stacked @ at) ** 2), rel=1e-10)


def test_digits_are_kept_that_normal_equations_lose() -> None:
    x = np.linspace(-1.0, 1.0, 4000)
    design = np.vander(x, 14, increasing=True)
    wanted = np.random.default_rng(0).normal(size=14)
    found = least_squares.solve(design, design @ wanted, np.zeros(14, dtype=bool))
    np.testing.assert_allclose(found, wanted, atol=1e-9)


@pytest.mark.parametrize("rows", [6, 3000])
def test_solve_is_numpys_without_bounds_and_scipys_with(rows: int) -> None:
    design, target = problem(rows, 6)
    size = np.linalg.norm(design, axis=0)
    free = least_squares.solve(design, target, np.zeros(6, dtype=bool))
    np.testing.assert_allclose(free * size, np.linalg.lstsq(design / size, target)[0], atol=1e-8)
    every = least_squares.solve(design, target, np.ones(6, dtype=bool))
    np.testing.assert_allclose(every * size, nnls(design / size, target)[0], atol=1e-8)
    assert np.all(every >= 0.0)
    some = least_squares.solve(design, target, np.arange(6) < 3)
    assert np.all(some[:3] >= 0.0)
    assert np.sum((design @ some - target) ** 2) <= np.sum((design @ every - target) ** 2) * (1.0 + 1e-12)
