"""Prandtl-Ishlinskii: against a plain loop of play operators, its closed-form inverse, and what a fit finds."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from motions import DECAYING, NESTED, Floats, nrmse, through, turning_points

from hystbench import models
from hystbench.errors import InputError

PI = models.get("prandtl-ishlinskii")


def play_loop(x: Floats, weights: Floats, thresholds: Floats) -> Floats:
    """The definition, operator by operator and sample by sample."""
    play = np.zeros(len(thresholds))
    out = []
    for value in x:
        play = np.clip(play, value - thresholds, value + thresholds)
        out.append(float(weights @ play))
    return np.array(out)


def random_model(seed: int, uniform: bool, invertible: bool = True, operators: int = 12) -> tuple[Any, Floats, Floats]:
    rng = np.random.default_rng(seed)
    thresholds = np.concatenate([[0.0], np.sort(rng.uniform(0.02, 0.9, operators - 1))])
    if uniform:
        thresholds = np.linspace(0.0, 0.9, operators)
    # Partial sums first: positive ones make an inverse, and their differences are weights of either sign.
    partial = rng.uniform(0.3, 3.0, operators) - (0.0 if invertible else 1.5)
    weights = np.diff(partial, prepend=0.0)
    return PI.from_parameters(weights=weights, thresholds=thresholds), weights, thresholds


@given(turning_points(-1.5, 1.5), st.integers(0, 5), st.booleans())
def test_prediction_is_the_sum_of_play_operators(turns: list[float], seed: int, uniform: bool) -> None:
    model, weights, thresholds = random_model(seed, uniform, invertible=False)
    x = through(turns, 7)
    np.testing.assert_allclose(model.predict(x), play_loop(x, weights, thresholds), atol=1e-12)


@pytest.mark.parametrize("uniform", [True, False])
def test_random_walk_far_from_the_virgin_state(uniform: bool) -> None:
    model, weights, thresholds = random_model(3, uniform)
    x = 0.8 + 0.1 * np.random.default_rng(0).normal(size=5000).cumsum()
    np.testing.assert_allclose(model.predict(x), play_loop(x, weights, thresholds), atol=1e-10)


def test_inputs_exactly_on_thresholds_and_repeated_turns() -> None:
    weights, thresholds = np.array([1.0, -0.3, 0.4]), np.array([0.0, 0.25, 0.5])
    x = np.array([0.25, 0.5, 0.0, 0.5, 0.0, 0.5, -0.5, -0.5, 0.5, 1.0, 0.0, -1.0, 1.0, -1.0, 0.25])
    found = PI.from_parameters(weights=weights, thresholds=thresholds).predict(x)
    np.testing.assert_allclose(found, play_loop(x, weights, thresholds), atol=1e-15)


@given(turning_points(-1.5, 1.5), st.integers(0, 5), st.booleans())
def test_the_closed_form_inverse_is_exact(turns: list[float], seed: int, uniform: bool) -> None:
    model, _, _ = random_model(seed, uniform)
    x = through(turns, 5)
    y = model.predict(x)
    found = model.invert(y)
    np.testing.assert_allclose(found, x, atol=1e-11)
    np.testing.assert_allclose(model.predict(found), y, atol=1e-11)


def test_without_a_positive_partial_sum_the_inverse_says_where_and_approximates_on_request() -> None:
    model = PI.from_parameters(weights=[1.0, -1.5, 1.0], thresholds=[0.0, 0.25, 0.5])
    assert not model.conditions_[0].holds
    assert "threshold 0.25" in model.conditions_[0].detail
    y = model.predict(through([0.0, 0.4, -0.4], 10))
    with pytest.raises(models.InverseError, match=r"threshold 0\.25 is -0\.5.*approximate=True"):
        model.invert(y)
    assert np.max(np.abs(model.predict(model.invert(y, approximate=True)) - y)) < 0.05 * np.ptp(y)


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("clockwise", [True, False])
def test_own_kind_predicts_held_out_minor_loops(seed: int, clockwise: bool) -> None:
    rng = np.random.default_rng(seed)
    weights = np.concatenate([[3.0 if clockwise else 1.0], rng.uniform(0.0, 0.2, 14) * (-1.0 if clockwise else 1.0)])
    truth = PI.from_parameters(weights=weights, thresholds=np.concatenate([[0.0], np.sort(rng.uniform(0.01, 0.8, 14))]))
    train, test = through(DECAYING, 60), through(NESTED, 83)
    model = PI().fit(train, truth.predict(train))
    assert nrmse(model.predict(test), truth.predict(test)) < 1e-3
    assert model.conditions_[0].holds
    y = truth.predict(test)
    assert nrmse(truth.predict(model.invert(y)), y) < 2e-3


def test_weights_on_known_thresholds_are_recovered() -> None:
    weights = np.array([2.0, -0.5, 0.3, -0.2, 0.1, -0.1, 0.05, 0.2])
    truth = PI.from_parameters(weights=weights, thresholds=np.arange(8) / 8.0, offset=0.4)
    x = through([0.0, 1.0, -1.0, *DECAYING[3:]], 60)
    model = PI(operators=8).fit(x, truth.predict(x))
    np.testing.assert_allclose(model.parameters_["thresholds"], np.arange(8) / 8.0, atol=1e-12)
    np.testing.assert_allclose(model.parameters_["weights"], weights, atol=1e-6)
    assert model.parameters_["offset"] == pytest.approx(0.4, abs=1e-6)


def test_nonnegative_weights_cannot_make_a_clockwise_loop() -> None:
    truth = PI.from_parameters(weights=[3.0, -1.0, -0.5], thresholds=[0.0, 0.1, 0.3])
    x = through([0.0, 1.0, -1.0, 1.0, -1.0], 100)
    y = truth.predict(x)
    stalled = PI(weights="nonnegative").fit(x, y)
    assert np.all(stalled.parameters_["weights"] >= 0.0)
    assert nrmse(stalled.predict(x), y) > 20 * nrmse(PI().fit(x, y).predict(x), y)


def test_free_weights_fit_a_model_without_an_inverse() -> None:
    truth = PI.from_parameters(weights=[1.0, -1.5, 1.0], thresholds=[0.0, 0.25, 0.5])
    x = through([0.0, 1.0, -1.0, *DECAYING[3:]], 40)
    free = PI(operators=16, weights="free").fit(x, truth.predict(x))
    assert nrmse(free.predict(x), truth.predict(x)) < 1e-6
    assert not free.conditions_[0].holds


def test_noise_moves_the_fit_little_and_several_runs_are_used() -> None:
    truth = PI.from_parameters(weights=[3.0, -0.8, -0.4, -0.2], thresholds=[0.0, 0.1, 0.2, 0.4])
    rng = np.random.default_rng(5)
    runs = [through([0.0, 1.0, -1.0, 0.9, -0.8, 0.7], 150), through([-0.5, -1.0, 1.0, -0.6, 0.5, -0.4], 150)]
    x, groups = np.concatenate(runs), np.repeat([0, 1], [run.size for run in runs])
    y = truth.predict(x, groups=groups)
    model = PI().fit(x + 5e-4 * rng.normal(size=x.size), y + 0.02 * rng.normal(size=x.size), groups=groups)
    test = through(NESTED, 83)
    assert nrmse(model.predict(test), truth.predict(test)) < 5e-3
    one = PI().fit(runs[0], y[: runs[0].size])
    assert not np.array_equal(one.parameters_["weights"], model.parameters_["weights"])


@pytest.mark.parametrize(
    ("parameters", "told"),
    [
        ({"weights": [1.0], "thresholds": [0.1]}, "begin with 0"),
        ({"weights": [1.0, 1.0], "thresholds": [0.0, 0.0]}, "increase strictly"),
        ({"weights": [1.0], "thresholds": [0.0, 0.1]}, r"weights must have shape"),
        ({"weights": [np.inf], "thresholds": [0.0]}, "not finite"),
        ({"weights": [1.0]}, "thresholds"),
    ],
)
def test_bad_parameters_are_named(parameters: dict[str, Any], told: str) -> None:
    with pytest.raises(InputError, match=told):
        PI.from_parameters(**parameters)


@pytest.mark.parametrize("hyper", [{"operators": 0}, {"weights": "positive"}, {"least_slope": 1.0}])
def test_bad_hyperparameters_are_told_at_fit(hyper: dict[str, Any]) -> None:
    x = through([0.0, 1.0, -1.0], 20)
    with pytest.raises(InputError, match=next(iter(hyper))):
        PI(**hyper).fit(x, x)
