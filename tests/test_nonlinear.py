"""Nonlinear least squares: scipy's minimum with fewer slopes."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import least_squares

from hystbench.diagnosis.nonlinear import least

T = np.linspace(0.0, 4.0, 300)
TRUTH = np.array([1.3, 0.7, 2.1])
BOUNDS = np.array([0.1, 0.05, 0.5]), np.array([5.0, 3.0, 6.0])


def left(values: np.ndarray) -> np.ndarray:
    size, rate, pitch = values
    made = size * np.exp(-rate * T) * np.cos(pitch * T)
    wanted = TRUTH[0] * np.exp(-TRUTH[1] * T) * np.cos(TRUTH[2] * T)
    return made - wanted + 0.01 * np.sin(37.0 * T)


def slopes(values: np.ndarray) -> np.ndarray:
    size, rate, pitch = values
    wave, decay = np.cos(pitch * T), np.exp(-rate * T)
    return np.column_stack([decay * wave, -T * size * decay * wave, -T * size * decay * np.sin(pitch * T)])


@pytest.mark.parametrize("evaluations", [3, 6, 40])
@pytest.mark.parametrize("ftol", [1e-4, 1e-10])
@pytest.mark.parametrize("first", [(1.0, 1.0, 2.0), (4.0, 0.2, 2.5), (0.3, 2.5, 1.2)])
def test_the_minimum_is_scipys_with_fewer_slopes(first: tuple[float, ...], ftol: float, evaluations: int) -> None:
    asked = 0

    def counted(values: np.ndarray) -> np.ndarray:
        nonlocal asked
        asked += 1
        return slopes(values)

    found, error = least(left, counted, np.array(first), BOUNDS, evaluations, ftol=ftol, xtol=1e-6)
    reference = least_squares(left, first, slopes, bounds=BOUNDS, max_nfev=evaluations, ftol=ftol, xtol=1e-6)
    assert found == pytest.approx(reference.x, rel=1e-9)
    assert error == pytest.approx(reference.fun, abs=1e-9)
    assert asked < reference.njev


def test_where_the_first_place_is_the_best_its_slopes_are_known() -> None:
    best, _ = least(left, slopes, TRUTH, BOUNDS, 40, ftol=1e-12)
    found, _ = least(left, slopes, best, BOUNDS, 40, ftol=1e-12)
    assert found == pytest.approx(best, rel=1e-6)
