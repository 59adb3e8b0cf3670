"""Bouc-Wen: against an adaptive integrator, its conditions, its inverse, and what a fit finds."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from motions import DECAYING, NESTED, Floats, nrmse, through
from scipy.integrate import solve_ivp

from hystbench import models
from hystbench.errors import InputError

BoucWen = models.get("bouc-wen")

TURNS = [0.0, 1.0, -1.0, 0.8, -0.6, 0.5, -0.3, 0.9, -0.2]


def reference(x: Floats, A: float, beta: float, gamma: float, n: float) -> Floats:
    """The state by DOP853 between samples, cut at its zeros, where the right-hand side is not smooth."""
    z, out = 0.0, [0.0]
    for before, now in zip(x[:-1].tolist(), x[1:].tolist(), strict=True):
        sign, at, left = np.sign(now - before), 0.0, abs(now - before)
        while left - at > 1e-15:

            def rate(t: float, s: Floats, sign: float = sign) -> Floats:
                return sign * (A - np.abs(s) ** n * (beta * np.sign(sign * s) + gamma))

            def zero(t: float, s: Floats) -> float:
                return float(s[0])

            zero.terminal = True  # type: ignore[attr-defined]
            zero.direction = sign  # type: ignore[attr-defined]
            done = solve_ivp(rate, (at, left), [z], method="DOP853", rtol=1e-11, atol=1e-13, events=zero if z else None)
            at, z = float(done.t[-1]), float(done.y[0, -1])
            if done.status == 1:
                z = 0.0
        out.append(z)
    return np.array(out)


@pytest.mark.parametrize("n", [1.0, 1.5, 2.0, 4.7])
@pytest.mark.parametrize(("beta", "gamma"), [(3.0, 1.0), (3.0, -1.0), (2.0, 2.0), (1.0, 3.0), (5.0, -2.0)])
def test_integration_error_is_below_1e_6_of_the_range_however_coarse_the_sampling(
    beta: float, gamma: float, n: float
) -> None:
    model = BoucWen.from_parameters(stiffness=2.0, alpha=0.0, A=1.2, beta=beta, gamma=gamma, n=n)
    coarse = through(TURNS, 2)
    wanted = 2.0 * reference(coarse, 1.2, beta, gamma, n)
    assert np.max(np.abs(model.predict(coarse) - wanted)) < 1e-6 * np.ptp(wanted)
    dense = model.predict(through(TURNS, 200))[::100]
    assert np.max(np.abs(dense - wanted)) < 1e-6 * np.ptp(wanted)


@pytest.mark.parametrize("n", [1.0, 2.0])
@pytest.mark.parametrize(("beta", "gamma"), [(1.0, 1.0), (1.0, -1.0), (-1.0, 0.5), (0.0, 0.0), (0.0, 0.7)])
def test_closed_forms_where_a_coefficient_vanishes_or_is_negative(beta: float, gamma: float, n: float) -> None:
    x = 0.35 * through(TURNS, 3)
    model = BoucWen.from_parameters(stiffness=1.0, alpha=0.0, A=1.0, beta=beta, gamma=gamma, n=n)
    wanted = reference(x, 1.0, beta, gamma, n)
    np.testing.assert_allclose(model.predict(x), wanted, atol=1e-9 * np.ptp(wanted))


@pytest.mark.parametrize("n", [1.0, 1.5, 2.0])
def test_negative_a(n: float) -> None:
    x = 0.5 * through(TURNS, 3)
    model = BoucWen.from_parameters(stiffness=1.0, alpha=0.0, A=-1.0, beta=0.6, gamma=0.2, n=n)
    wanted = reference(x, -1.0, 0.6, 0.2, n)
    np.testing.assert_allclose(model.predict(x), wanted, atol=1e-6 * np.ptp(wanted))


def test_the_output_mixes_elastic_and_hysteretic_parts() -> None:
    x = 0.4 + through(TURNS, 10)
    state = BoucWen.from_parameters(stiffness=1.0, alpha=0.0, A=1.0, beta=3.0, gamma=1.0, n=1.0).predict(x)
    assert state[0] == 0.0
    found = BoucWen.from_parameters(stiffness=2.0, alpha=0.3, A=1.0, beta=3.0, gamma=1.0, n=1.0, offset=0.2).predict(x)
    np.testing.assert_allclose(found, 0.6 * x + 1.4 * state + 0.2, atol=1e-12)


def test_conditions_of_boundedness_and_dissipation() -> None:
    good = BoucWen.from_parameters(stiffness=2.0, alpha=0.3, A=1.0, beta=3.0, gamma=1.0, n=1.5)
    assert [c.holds for c in good.conditions_] == [True, True]
    unbounded = BoucWen.from_parameters(stiffness=2.0, alpha=0.3, A=1.0, beta=-3.0, gamma=1.0, n=1.5)
    assert [c.holds for c in unbounded.conditions_] == [False, False]


@pytest.mark.parametrize("n", [1.5, 2.0, 3.0])
@pytest.mark.parametrize(("beta", "gamma"), [(-3.0, 1.0), (-1.0, 0.5)])
def test_a_state_that_runs_away_is_told_and_not_returned(beta: float, gamma: float, n: float) -> None:
    unbounded = BoucWen.from_parameters(stiffness=2.0, alpha=0.3, A=1.0, beta=beta, gamma=gamma, n=n)
    with pytest.raises(InputError, match=r"grows without bound at sample \d+ "):
        unbounded.predict(through([0.0, 1.5, -30.0], 2000))


@pytest.mark.parametrize(
    "truth",
    [
        {"stiffness": 2.0, "alpha": 0.3, "A": 1.0, "beta": 3.0, "gamma": -1.0, "n": 1.4},
        {"stiffness": 5.0, "alpha": 0.6, "A": 1.0, "beta": 4.0, "gamma": 2.0, "n": 1.0},
        {"stiffness": 1.0, "alpha": 0.2, "A": 1.0, "beta": 8.0, "gamma": 1.0, "n": 2.5},
    ],
)
def test_parameters_are_recovered(truth: dict[str, float]) -> None:
    x = through(DECAYING[:24], 60)
    model = BoucWen().fit(x, BoucWen.from_parameters(**truth).predict(x) + 0.25)
    assert model.parameters_["offset"] == pytest.approx(0.25, abs=1e-4)
    for name, value in truth.items():
        assert model.parameters_[name] == pytest.approx(value, rel=1e-3, abs=1e-3), name


def test_the_scale_of_the_state_is_normalised_to_a_equal_1() -> None:
    truth = {"stiffness": 2.0, "alpha": 0.25, "A": 2.0, "beta": 3.0, "gamma": 1.0, "n": 1.5}
    x = through(DECAYING[:24], 60)
    found = BoucWen().fit(x, BoucWen.from_parameters(**truth).predict(x)).parameters_
    # z = A z': the same output with A = 1, coefficients times A^(n − 1) and the hysteretic stiffness times A.
    assert found["A"] == 1.0
    assert found["beta"] == pytest.approx(3.0 * 2.0**0.5, rel=1e-3)
    assert found["gamma"] == pytest.approx(1.0 * 2.0**0.5, rel=5e-3)
    assert found["alpha"] * found["stiffness"] == pytest.approx(0.5, rel=1e-3)
    assert (1.0 - found["alpha"]) * found["stiffness"] == pytest.approx(1.5 * 2.0, rel=1e-3)


def test_own_kind_other_units_noise_and_a_fixed_exponent() -> None:
    truth = BoucWen.from_parameters(stiffness=0.5, alpha=0.3, A=1.0, beta=0.03, gamma=0.01, n=1.0)
    rng = np.random.default_rng(0)
    train, test = 40.0 * through(DECAYING[:20], 60), 40.0 * through(NESTED, 83)
    y = truth.predict(train)
    clean = BoucWen(n=1.0).fit(train, y)
    assert clean.parameters_["n"] == 1.0
    assert nrmse(clean.predict(test), truth.predict(test)) < 1e-6
    noisy = BoucWen(starts=64).fit(train, y + 0.01 * np.ptp(y) * rng.normal(size=y.size))
    assert nrmse(noisy.predict(test), truth.predict(test)) < 5e-3


def test_an_elastic_recording_says_what_it_cannot_tell() -> None:
    x = through(DECAYING[:10], 60)
    model = BoucWen(starts=64).fit(x, 3.0 * x + 1.0)
    assert nrmse(model.predict(x), 3.0 * x + 1.0) < 1e-6
    flat = BoucWen(starts=64).fit(x, np.full_like(x, 2.0))
    np.testing.assert_allclose(flat.predict(x), 2.0, atol=1e-6)


@pytest.mark.parametrize("n", [1.0, 1.7, 2.0])
def test_the_inverse_is_exact(n: float) -> None:
    model = BoucWen.from_parameters(stiffness=2.0, alpha=0.3, A=1.0, beta=3.0, gamma=1.0, n=n)
    y = model.predict(through([0.0, 0.9, -0.8, 0.7, -0.1, 0.5], 60))
    np.testing.assert_allclose(model.predict(model.invert(y)), y, atol=1e-6 * np.ptp(y))


def test_the_inverse_reaches_inputs_in_any_unit() -> None:
    model = BoucWen.from_parameters(stiffness=0.1, alpha=0.3, A=1.0, beta=0.04, gamma=0.01, n=1.0)
    y = model.predict(60.0 * through([0.0, 0.9, -0.8, 0.7], 30))
    np.testing.assert_allclose(model.predict(model.invert(y)), y, atol=1e-6 * np.ptp(y))


def test_beyond_saturation_there_is_no_inverse() -> None:
    model = BoucWen.from_parameters(stiffness=1.0, alpha=0.0, A=1.0, beta=3.0, gamma=1.0, n=1.0)
    # The state is 0 at the first sample, and saturates at 1/4.
    y = [0.0, 0.1, 0.5]
    with pytest.raises(models.InverseError, match=r"y\[2\] = 0\.5.*approximate=True"):
        model.invert(y)
    near = model.predict(model.invert(y, approximate=True))
    np.testing.assert_allclose(near[:2], y[:2], atol=1e-7)
    assert 0.2 < near[2] <= 0.25


@pytest.mark.parametrize(
    ("change", "told"),
    [({"n": 0.5}, "n must be at least 1"), ({"beta": [1.0]}, "beta must have shape"), ({"A": np.nan}, "A has")],
)
def test_bad_parameters_are_named(change: dict[str, Any], told: str) -> None:
    good = {"stiffness": 2.0, "alpha": 0.3, "A": 1.0, "beta": 3.0, "gamma": 1.0, "n": 1.5}
    with pytest.raises(InputError, match=told):
        BoucWen.from_parameters(**{**good, **change})


@pytest.mark.parametrize("hyper", [{"n": 0.5}, {"starts": 0}])
def test_bad_hyperparameters_are_told_at_fit(hyper: dict[str, Any]) -> None:
    x = through([0.0, 1.0, -1.0], 20)
    with pytest.raises(InputError, match=next(iter(hyper))):
        BoucWen(**hyper).fit(x, x)
