"""The linear spring: against numpy's polynomial fit, and where it has no inverse."""

from __future__ import annotations

import numpy as np
import pytest
from motions import DECAYING, through

from hystbench import models

Linear = models.get("linear")


def test_fit_is_the_least_squares_line() -> None:
    x = 0.4 + through(DECAYING, 9)
    y = 3.0 * x + 0.2 + np.random.default_rng(0).normal(size=x.size)
    model = Linear().fit(x, y)
    slope, level = np.polyfit(x, y, 1)
    assert model.parameters_ == pytest.approx({"stiffness": slope, "offset": level}, rel=1e-9)
    np.testing.assert_allclose(model.invert(model.predict(x)), x, atol=1e-12)


def test_a_slack_spring_has_no_inverse() -> None:
    model = Linear.from_parameters(stiffness=0.0, offset=1.0)
    assert not model.conditions_[0].holds
    np.testing.assert_array_equal(model.invert([1.0, 1.0], x0=0.3), 0.3)
    with pytest.raises(models.InverseError, match=r"y\[1\] = 2: the stiffness is 0"):
        model.invert([1.0, 2.0])
    np.testing.assert_array_equal(model.invert([1.0, 2.0], x0=0.3, approximate=True), 0.3)
