"""Preisach: against every relay followed one by one, its laws on discrete relays and on cells, and what a fit finds."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from motions import DECAYING, NESTED, Floats, nrmse, through, turning_points

from hystbench import models
from hystbench.errors import InputError
from hystbench.models.preisach import RELAY_LIMIT, relay_outputs

Preisach = models.get("preisach")


def relays(seed: int, count: int, digits: int) -> dict[str, Any]:
    """Random relays; few digits make repeated thresholds, and alpha = beta among them."""
    rng = np.random.default_rng(seed)
    pairs = np.sort(rng.uniform(-1.0, 1.0, (count, 2)).round(digits), axis=1)
    return {"alpha": pairs[:, 1], "beta": pairs[:, 0], "weights": rng.normal(size=count), "offset": 0.3}


def brute_force(x: Floats, p: dict[str, Any]) -> Floats:
    """The definition in CONTRACT's words, independent of the module's own helper."""
    state = [1.0 if a + b <= 0.0 else -1.0 for a, b in zip(p["alpha"], p["beta"], strict=True)]
    out = []
    for value in x:
        for i, (a, b) in enumerate(zip(p["alpha"], p["beta"], strict=True)):
            if value >= a:
                state[i] = 1.0
            if value <= b:
                state[i] = -1.0
        out.append(p["offset"] + float(np.dot(p["weights"], state)))
    return np.array(out)


def cells(seed: int, count: int, clockwise: bool = False, smooth: bool = False) -> dict[str, Any]:
    """Square cells over -1 .. 1."""
    rng = np.random.default_rng(seed)
    width = 2.0 / count
    centres = width * (np.arange(count) + 0.5 - count // 2)
    alpha, beta = (v.ravel() for v in np.meshgrid(centres, centres, indexing="ij"))
    alpha, beta = alpha[alpha >= beta], beta[alpha >= beta]
    weights = rng.uniform(0.0, 1.0, alpha.size)
    if smooth:
        weights = 0.1 + np.exp(-(((alpha - beta) / 2 - 0.3) ** 2) / 0.1 - ((alpha + beta) / 2) ** 2 / 0.2)
    weights /= weights.sum()
    if clockwise:
        weights = np.where(alpha > beta, -weights, 30.0 * weights)
    return {"alpha": alpha, "beta": beta, "weights": weights, "offset": 0.1, "width": width}


# ---- evaluation against the definition -----------------------------------------------------------------------------


@given(turning_points(-1.2, 1.2), st.integers(0, 7), st.sampled_from([1, 6]))
def test_discrete_relays_equal_the_definition(turns: list[float], seed: int, digits: int) -> None:
    # Turning points are multiples of 0.06: with one digit many of them and of the samples lie exactly on thresholds.
    parameters = relays(seed, 25, digits)
    parameters["alpha"] = np.maximum(parameters["alpha"], parameters["beta"] + 10.0**-digits)
    x = np.concatenate([turns, through(turns, 5)]).round(2)
    model = Preisach.from_parameters(**parameters)
    wanted = brute_force(x, parameters)
    np.testing.assert_allclose(model.predict(x), wanted, atol=1e-12)
    np.testing.assert_allclose(
        0.3 + relay_outputs(x, parameters["alpha"], parameters["beta"]) @ parameters["weights"], wanted, atol=1e-12
    )


@pytest.mark.parametrize("start", [-2.0, -0.5, 0.0, 0.5, 2.0])
def test_random_inputs_from_any_start(start: float) -> None:
    parameters = relays(11, 60, 1)
    parameters["alpha"] = np.maximum(parameters["alpha"], parameters["beta"] + 0.1)
    x = np.concatenate([[start], np.random.default_rng(2).uniform(-1.3, 1.3, 2000).round(1)])
    model = Preisach.from_parameters(**parameters)
    np.testing.assert_allclose(model.predict(x), brute_force(x, parameters), atol=1e-12)


def test_the_demagnetised_start() -> None:
    parameters = {"alpha": [0.5, 0.2, 0.3], "beta": [-0.6, -0.1, -0.3], "weights": [1.0, 10.0, 100.0], "offset": 0.0}
    # alpha + beta: below zero up, above zero down, zero up.
    assert Preisach.from_parameters(**parameters).predict([0.0]) == pytest.approx([1.0 - 10.0 + 100.0])


def test_repeated_relays_add_up() -> None:
    x = through(NESTED, 20)
    three = Preisach.from_parameters(alpha=[0.3] * 3, beta=[-0.2] * 3, weights=[1.0, 2.0, -0.5], offset=0.0)
    one = Preisach.from_parameters(alpha=[0.3], beta=[-0.2], weights=[2.5], offset=0.0)
    np.testing.assert_array_equal(three.predict(x), one.predict(x))


@pytest.mark.parametrize("clockwise", [False, True])
def test_cells_are_the_limit_of_fine_relays(clockwise: bool) -> None:
    parameters = cells(4, 8, clockwise)
    x = through([0.3, *DECAYING[:12], *NESTED], 53)
    wanted = Preisach.from_parameters(**parameters).predict(x)
    errors = []
    for fine in (4, 16):
        errors.append(np.max(np.abs(Preisach.from_parameters(**_divided(parameters, fine)).predict(x) - wanted)))
    scale = np.ptp(wanted)
    # A fine relay switches at once what the cell spreads over its width: the difference shrinks with that width.
    assert errors[0] < 0.15 * scale
    assert errors[1] < 0.3 * errors[0]


def _divided(parameters: dict[str, Any], fine: int) -> dict[str, Any]:
    """Each cell's weight spread over fine x fine relays; those of a diagonal cell lie on the diagonal itself."""
    width = parameters["width"]
    inner = width * ((np.arange(fine) + 0.5) / fine - 0.5)
    alpha = parameters["alpha"][:, None, None] + inner[None, :, None] + np.zeros((1, 1, fine))
    beta = parameters["beta"][:, None, None] + inner[None, None, :] + np.zeros((1, fine, 1))
    diagonal = parameters["alpha"] == parameters["beta"]
    beta[diagonal] = alpha[diagonal]
    weights = np.repeat(parameters["weights"] / fine**2, fine**2)
    beta = beta.ravel()
    # A relay with alpha = beta exactly would depend on which of its two rules comes last; a hair below is one switch.
    beta = np.where(beta == alpha.ravel(), beta - 1e-12, beta)
    return {"alpha": alpha.ravel(), "beta": beta, "weights": weights, "offset": parameters["offset"]}


@given(turning_points(), st.integers(0, 5))
def test_cells_make_a_continuous_output_that_does_not_depend_on_sampling(turns: list[float], seed: int) -> None:
    model = Preisach.from_parameters(**cells(seed, 10))
    dense = model.predict(through(turns, 40))
    np.testing.assert_allclose(dense[::10], model.predict(through(turns, 4)), atol=1e-12)
    # 2/40 of the range of a cell grid with total weight 1 can change the output by little more than that share.
    assert np.max(np.abs(np.diff(dense)), initial=0.0) < 0.35


@pytest.mark.parametrize("width", [False, True])
def test_the_virgin_curve_rises_for_nonnegative_weights(width: bool) -> None:
    parameters = cells(1, 12)
    if not width:
        parameters |= {"beta": parameters["beta"] - 1e-9, "width": 0.0}
    model = Preisach.from_parameters(**parameters)
    up, down = model.predict(np.linspace(0.0, 1.2, 500)), model.predict(np.linspace(0.0, -1.2, 500))
    assert np.all(np.diff(up) >= 0.0)
    assert np.all(np.diff(down) <= 0.0)
    assert up[-1] == pytest.approx(0.1 + 1.0)
    assert down[-1] == pytest.approx(0.1 - 1.0)


# ---- identification ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("clockwise", [False, True])
@pytest.mark.parametrize("count", [8, 12])
def test_own_kind_smooth_predicts_held_out_minor_loops(count: int, clockwise: bool) -> None:
    truth = Preisach.from_parameters(**cells(0, count, clockwise, smooth=True))
    train, test = through(DECAYING, 70), through(NESTED, 83)
    model = Preisach().fit(train, truth.predict(train))
    assert nrmse(model.predict(test), truth.predict(test)) < 1e-3
    off = model.parameters_["weights"][model.parameters_["alpha"] > model.parameters_["beta"]]
    assert np.all(off <= 0.0) if clockwise else np.all(off >= 0.0)


@pytest.mark.parametrize("levels", [6, 20])
def test_own_kind_relays_are_found_with_their_thresholds(levels: int) -> None:
    rng = np.random.default_rng(levels)
    grid = np.linspace(-0.93, 0.91, levels)
    alpha, beta = (v.ravel() for v in np.meshgrid(grid, grid - 0.013, indexing="ij"))
    alpha, beta = alpha[alpha >= beta], beta[alpha >= beta]
    weights = rng.uniform(0.0, 1.0, alpha.size) / alpha.size
    truth = Preisach.from_parameters(alpha=alpha, beta=beta, weights=weights, offset=0.2)
    train, test = through(DECAYING, 70), through(NESTED, 83)
    model = Preisach().fit(train, truth.predict(train))
    np.testing.assert_allclose(np.unique(model.parameters_["alpha"]), grid, atol=2e-3)
    assert nrmse(model.predict(test), truth.predict(test)) < 1e-3


def test_uneven_relay_thresholds_are_found_between_the_samples() -> None:
    truth = Preisach.from_parameters(
        alpha=[-0.4, 0.13, 0.31, 0.62], beta=[-0.81, -0.22, 0.05, -0.5], weights=[1.0, 2.0, 0.5, 1.5], offset=0.0
    )
    x = through(DECAYING, 70)
    model = Preisach().fit(x, truth.predict(x))
    assert model.parameters_["width"] == 0.0
    np.testing.assert_allclose(np.unique(model.parameters_["alpha"]), [-0.4, 0.13, 0.31, 0.62], atol=0.03)
    np.testing.assert_allclose(model.predict(x), truth.predict(x), atol=1e-2)


def test_more_thresholds_than_can_be_identified_fall_back_to_cells() -> None:
    grid = np.linspace(-0.95, 0.95, 60)
    alpha, beta = (v.ravel() for v in np.meshgrid(grid, grid - 0.01, indexing="ij"))
    alpha, beta = alpha[alpha >= beta], beta[alpha >= beta]
    assert alpha.size > RELAY_LIMIT
    truth = Preisach.from_parameters(alpha=alpha, beta=beta, weights=np.full(alpha.size, 1.0 / alpha.size), offset=0.0)
    x = through([0.0, 1.0, -1.0, 0.9, -0.8, 0.7, -0.6], 600)
    model = Preisach().fit(x, truth.predict(x))
    assert model.parameters_["width"] > 0.0
    assert any("too many" in note for note in model.notes_)
    assert nrmse(model.predict(x), truth.predict(x)) < 2e-2


def test_relays_that_no_recording_can_tell_are_noted() -> None:
    truth = Preisach.from_parameters(**cells(0, 10, smooth=True))
    x = through([0.0, 1.0, -1.0, 1.0], 200)
    notes = Preisach().fit(x, truth.predict(x)).notes_
    assert any("counter-clockwise" in note for note in notes)
    off_range = through([0.5, 1.0, 0.5, 0.9, 0.6], 200)
    model = Preisach().fit(off_range, truth.predict(off_range))
    assert nrmse(model.predict(off_range)[200:], truth.predict(off_range)[200:]) < 0.03


@pytest.mark.parametrize("signs", ["nonnegative", "clockwise", "free"])
def test_signs_are_kept(signs: str) -> None:
    x = through(DECAYING[:20], 60)
    y = Preisach.from_parameters(**cells(3, 10, clockwise=True)).predict(x)
    model = Preisach(levels=12, signs=signs).fit(x, y)
    weights, off = model.parameters_["weights"], model.parameters_["alpha"] > model.parameters_["beta"]
    if signs == "nonnegative":
        assert np.all(weights >= 0.0)
    elif signs == "clockwise":
        assert np.all(weights[off] <= 0.0)
        assert np.all(weights[~off] >= 0.0)
    else:
        assert nrmse(model.predict(x), y) < 0.02


def test_noisy_runs_from_other_starts_are_fitted_together() -> None:
    truth = Preisach.from_parameters(**cells(0, 12, clockwise=True, smooth=True))
    rng = np.random.default_rng(3)
    runs = [through(DECAYING[:30], 60), 0.9 * through([-0.6, *DECAYING[1:30]], 60)]
    x, groups = np.concatenate(runs), np.repeat(["a", "b"], [run.size for run in runs])
    y = truth.predict(x, groups=groups)
    noise = 0.01 * np.ptp(y)
    model = Preisach().fit(x, y + noise * rng.normal(size=y.size), groups=groups)
    test = through(NESTED, 83)
    assert nrmse(model.predict(test), truth.predict(test)) < 0.01


# ---- inverse -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("clockwise", [False, True])
def test_the_inverse_on_cells_is_exact_and_quick(clockwise: bool) -> None:
    model = Preisach.from_parameters(**cells(0, 12, clockwise, smooth=True))
    y = model.predict(through([0.0, 0.9, -0.8, 0.7, -0.1, 0.5, -0.6], 100))
    model.invert(y[:3])
    x = model.invert(y)
    np.testing.assert_allclose(model.predict(x), y, atol=1e-6 * np.ptp(y))


def test_the_inverse_reaches_thresholds_in_any_unit() -> None:
    degrees = cells(0, 12, smooth=True)
    degrees |= {name: 57.3 * degrees[name] for name in ("alpha", "beta", "width")}
    model = Preisach.from_parameters(**degrees)
    y = model.predict(57.3 * through([0.0, 0.9, -0.8, 0.7], 30))
    np.testing.assert_allclose(model.predict(model.invert(y)), y, atol=1e-6)


def test_a_plateau_has_no_inverse_and_the_nearest_is_offered() -> None:
    model = Preisach.from_parameters(alpha=[0.5, 0.2], beta=[-0.1, 0.0], weights=[1.0, 1.0], offset=0.0)
    with pytest.raises(models.InverseError, match=r"y\[1\] = 0\.5.*nearest output is off by 0\.5.*approximate=True"):
        model.invert([-2.0, 0.5])
    near = model.predict(model.invert([-2.0, 0.4, 1.7], approximate=True))
    np.testing.assert_array_equal(near, [-2.0, 0.0, 2.0])


# ---- bad input -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"alpha": [0.1], "beta": [0.2]}, r"alpha\[0\] = 0\.1 is below beta\[0\] = 0\.2"),
        ({"weights": [1.0, 2.0]}, "weights must have shape"),
        ({"width": -1.0}, "width must not be negative"),
        ({"width": 0.3}, "centred"),
        ({"offset": "a"}, "offset must be numeric"),
    ],
)
def test_bad_parameters_are_named(change: dict[str, Any], told: str) -> None:
    with pytest.raises(InputError, match=told):
        Preisach.from_parameters(**({"alpha": [0.5], "beta": [0.1], "weights": [1.0], "offset": 0.0} | change))


@pytest.mark.parametrize("hyper", [{"levels": 1}, {"signs": "any"}, {"smoothing": -1.0}])
def test_bad_hyperparameters_are_told_at_fit(hyper: dict[str, Any]) -> None:
    x = through([0.0, 1.0, -1.0], 20)
    with pytest.raises(InputError, match=next(iter(hyper))):
        Preisach(**hyper).fit(x, x)


def test_too_many_distinct_thresholds_are_refused() -> None:
    alpha = np.linspace(0.0, 1.0, 2001)
    with pytest.raises(InputError, match="distinct thresholds are too many"):
        Preisach.from_parameters(alpha=alpha, beta=alpha - 1.0, weights=alpha, offset=0.0)
