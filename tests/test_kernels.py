"""Searches inside compiled kernels: against NumPy's own, from every guess."""

from __future__ import annotations

import numpy as np
import pytest

from hystbench import models
from hystbench.models.maxwell_slip import _segment


@pytest.mark.parametrize("size", [2, 3, 4, 9, 101])
def test_segment_is_searchsorted_whatever_the_guess(size: int) -> None:
    rng = np.random.default_rng(size)
    vertices = np.concatenate([[-9.0, -8.0], np.sort(rng.uniform(-1.0, 1.0, size)), [8.0, 9.0]])
    first, final = 2, size + 1
    inner = vertices[first : final + 1]
    for x in [*inner, *(inner[:-1] + 0.5 * np.diff(inner)), -1.5, 1.5, *rng.uniform(-1.0, 1.0, 20)]:
        wanted = first + min(max(int(np.searchsorted(inner, x)) - 1, 0), size - 2)
        for guess in {0, first, (first + final) // 2, final - 1, final + 1}:
            assert _segment(x, vertices, guess, first, final) == wanted


@pytest.mark.parametrize("name", models.ids())
def test_steps_and_whole_runs_agree_on_a_noisy_walk_far_beyond_the_range(name: str) -> None:
    cls = models.get(name)
    if not hasattr(cls, "stepper"):
        pytest.skip("no stepper")
    t = np.linspace(0.0, 1.0, 600)
    x = np.sin(40.0 * t) * (1.0 - 0.7 * t)
    truth = models.get("dahl").from_parameters(stiffness=3.0, friction=0.4, exponent=1.0, spring=[0.0, 2.0, 0.0, 0.5])
    model = cls().fit(x, truth.predict(x))
    walk = np.random.default_rng(1).normal(size=1500).cumsum() * 0.05
    wanted = model.predict(walk)
    stepper = model.stepper()
    found = [stepper.step(v) for v in walk.tolist()]
    np.testing.assert_allclose(found, wanted, atol=1e-9 * np.ptp(wanted))
