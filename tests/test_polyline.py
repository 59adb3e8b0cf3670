"""The polylines from whose vertices Maxwell-slip is identified."""

from __future__ import annotations

import numpy as np
import pytest

from hystbench.models.polyline import _profile, _profile_slopes, fit_vertices


def test_residuals_follow_the_vertices_as_their_derivatives_say() -> None:
    rng = np.random.default_rng(3)
    x = np.sort(rng.uniform(-1.0, 1.0, 400))
    y = np.tanh(3.0 * x) + 0.05 * rng.standard_normal(x.size)
    # The second gap holds few points and the last reaches past them all.
    vertices = np.array([-1.1, -0.4, -0.37, 0.1, 1.2])
    slopes = _profile_slopes(x, y, vertices)
    for k in range(1, vertices.size - 1):
        step = np.zeros(vertices.size)
        step[k] = 1e-7
        difference = (_profile(x, y, vertices + step)[0] - _profile(x, y, vertices - step)[0]) / 2e-7
        np.testing.assert_allclose(slopes[:, k], difference, atol=1e-7 * np.abs(difference).max())


@pytest.mark.parametrize("seed", range(4))
def test_the_kinks_of_a_clean_curve_are_found_exactly(seed: int) -> None:
    rng = np.random.default_rng(seed)
    kinks = np.concatenate([[0.0], np.cumsum(rng.uniform(0.1, 0.4, 6))])
    x = np.sort(rng.uniform(kinks[0], kinks[-1], 700))
    y = np.interp(x, kinks, np.cumsum(rng.uniform(0.2, 2.0, kinks.size)))
    found = fit_vertices(x, y, 6)[0]
    np.testing.assert_allclose(found[1:-1], kinks[1:-1], atol=1e-9)
