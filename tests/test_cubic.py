"""The cubic baseline: its branches, its inverse, and what a fit finds."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from motions import DECAYING, NESTED, Floats, nrmse, through, turning_points

from hystbench import models
from hystbench.errors import InputError

Cubic = models.get("cubic")

UP, DOWN = [0.1, 4.0, 0.2, 1.5], [-0.1, 4.0, -0.2, 1.5]


def direct(x: Floats) -> Floats:
    """The branch follows the direction of motion; ascending before the first motion, and a pause keeps the branch."""
    direction = 1.0
    out = []
    for k, value in enumerate(x.tolist()):
        if k and value != x[k - 1]:
            direction = np.sign(value - x[k - 1])
        c = UP if direction > 0 else DOWN
        out.append(c[0] + c[1] * value + c[2] * value**2 + c[3] * value**3)
    return np.array(out)


@given(turning_points(-1.5, 1.5, least=1))
def test_prediction_follows_the_direction_of_motion(turns: list[float]) -> None:
    x = np.repeat(np.concatenate([turns, through(turns, 5)]), 2)
    np.testing.assert_allclose(Cubic.from_parameters(ascending=UP, descending=DOWN).predict(x), direct(x), atol=1e-12)


def test_a_dead_band_ignores_small_returns() -> None:
    model = Cubic.from_parameters(ascending=UP, descending=DOWN, dead_band=0.1)
    rises = np.polynomial.Polynomial(UP)
    falls = np.polynomial.Polynomial(DOWN)
    x = np.array([0.0, 0.5, 0.45, 0.5, 0.41, 0.39, 0.45, 0.48, 0.5])
    wanted = [*rises(x[:5]), *falls(x[5:8]), rises(x[8])]
    np.testing.assert_allclose(model.predict(x), wanted, atol=1e-12)


def test_coefficients_are_recovered() -> None:
    x = through([0.0, 1.0, -1.0, 0.8, -0.6], 100)
    model = Cubic().fit(x, direct(x))
    np.testing.assert_allclose(model.parameters_["ascending"], UP, atol=1e-9)
    np.testing.assert_allclose(model.parameters_["descending"], DOWN, atol=1e-9)
    assert all(condition.holds for condition in model.conditions_)


def test_one_branch_is_the_least_squares_cubic() -> None:
    x = through(DECAYING[:20], 40)
    y = direct(x)
    model = Cubic(branches=1).fit(x, y)
    np.testing.assert_array_equal(model.parameters_["ascending"], model.parameters_["descending"])
    first = np.argmax(x <= -0.97)
    wanted = np.polynomial.polynomial.polyfit(x[first:], y[first:], 3)
    np.testing.assert_allclose(model.parameters_["ascending"], wanted, atol=0.02)
    assert nrmse(model.predict(x), y) > 0.01


def test_noise_does_not_switch_the_branches() -> None:
    rng = np.random.default_rng(0)
    x = through(DECAYING[:6], 4000)
    noisy = x + 1e-3 * rng.normal(size=x.size)
    y = direct(x)
    model = Cubic().fit(noisy, y + 0.02 * rng.normal(size=x.size))
    assert 4e-3 < model.parameters_["dead_band"] < 2e-2
    assert nrmse(model.predict(noisy), y) < 0.25 * nrmse(
        Cubic.from_parameters(ascending=UP, descending=DOWN).predict(noisy), y
    )
    np.testing.assert_allclose(model.parameters_["ascending"], UP, atol=0.05)
    clean = through(NESTED, 200)
    assert nrmse(model.predict(clean), direct(clean)) < 0.01


def test_motion_in_one_direction_serves_both_branches_and_says_so() -> None:
    x = np.linspace(-1.0, 1.0, 50)
    model = Cubic().fit(x, direct(x))
    np.testing.assert_array_equal(model.parameters_["descending"], model.parameters_["ascending"])
    assert any("no descending motion" in note for note in model.notes_)


@given(turning_points(-0.95, 0.95))
def test_the_inverse_reaches_every_output_of_the_model(turns: list[float]) -> None:
    model = Cubic.from_parameters(ascending=UP, descending=DOWN)
    x = through([0.0, *turns], 7)
    y = model.predict(x)
    np.testing.assert_allclose(model.predict(model.invert(y)), y, atol=1e-8)


def test_an_output_between_the_branches_has_no_inverse() -> None:
    model = Cubic.from_parameters(ascending=UP, descending=DOWN)
    y = [2.0, 2.1, 2.05]
    # After rising to 2.1 the falling branch begins 0.2 lower: 2.05 lies in the jump.
    with pytest.raises(models.InverseError, match=r"y\[2\] = 2\.05.*jumps between the branches.*approximate=True"):
        model.invert(y)
    near = model.predict(model.invert(y, approximate=True))
    np.testing.assert_allclose(near[:2], y[:2], atol=1e-8)
    assert abs(near[2] - 2.05) <= 0.05 + 1e-8


def test_several_roots_take_the_nearest_input() -> None:
    folded = Cubic.from_parameters(ascending=[0.0, -1.0, 0.0, 1.0], descending=[0.0, -1.0, 0.0, 1.0])
    assert not folded.conditions_[0].holds
    for x0 in (-1.0, 0.0, 1.0):
        assert folded.invert([0.0], x0=x0)[0] == pytest.approx(x0, abs=1e-9)


def test_bad_parameters_and_hyperparameters_are_told() -> None:
    with pytest.raises(InputError, match=r"ascending must have shape"):
        Cubic.from_parameters(ascending=[1.0, 2.0], descending=DOWN)
    with pytest.raises(InputError, match="dead_band must not be negative"):
        Cubic.from_parameters(ascending=UP, descending=DOWN, dead_band=-0.1)
    x = through([0.0, 1.0, -1.0], 20)
    with pytest.raises(InputError, match="branches must be 1 or 2"):
        Cubic(branches=3).fit(x, x)
