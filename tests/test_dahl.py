"""Dahl friction: against an adaptive integrator, its limits, and what a fit finds."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from motions import DECAYING, NESTED, Floats, nrmse, through
from scipy.integrate import solve_ivp

from hystbench import models
from hystbench.errors import InputError

Dahl = models.get("dahl")
TURNS = [0.0, 1.0, -1.0, 0.8, -0.6, 0.5, -0.3, 0.9, -0.2]


def reference(x: Floats, stiffness: float, friction: float, exponent: float) -> Floats:
    """dF/dx as Dahl wrote it, between samples by LSODA."""
    force, out = 0.0, [0.0]
    for a, b in pairwise(x.tolist()):
        sign = np.sign(b - a)

        def slope(t: float, f: Floats, sign: float = sign) -> Floats:
            left = 1.0 - f / friction * sign
            return stiffness * np.abs(left) ** exponent * np.sign(left)

        force = float(solve_ivp(slope, (a, b), [force], method="LSODA", rtol=1e-10, atol=1e-12).y[0, -1])
        out.append(force)
    return np.array(out)


@pytest.mark.parametrize("exponent", [1.0, 1.5, 3.0])
def test_friction_follows_dahls_equation(exponent: float) -> None:
    x = through(TURNS, 7)
    model = Dahl.from_parameters(stiffness=6.0, friction=1.5, exponent=exponent, spring=[0.1, 2.0, 0.0, 0.5])
    wanted = 0.1 + 2.0 * x + 0.5 * x**3 + reference(x, 6.0, 1.5, exponent)
    np.testing.assert_allclose(model.predict(x), wanted, atol=2e-6)


def test_below_exponent_one_the_limit_is_reached_within_a_finite_distance() -> None:
    # From 0, with u = 1 − F/friction: sqrt(u) = 1 − stiffness x / (2 friction), so the limit is reached at x = 0.5.
    x = np.linspace(0.0, 1.0, 101)
    wanted = 1.5 * (1.0 - np.maximum(1.0 - 2.0 * x, 0.0) ** 2)
    model = Dahl.from_parameters(stiffness=6.0, friction=1.5, exponent=0.5)
    np.testing.assert_allclose(model.predict(x), wanted, atol=1e-12)


def test_exponent_zero_is_coulomb_friction_with_an_elastic_part() -> None:
    x = through(TURNS, 11)
    stop, last, wanted = 0.0, 0.0, []
    for value in x:
        stop = min(max(stop + 5.0 * (value - last), -0.5), 0.5)
        last = value
        wanted.append(stop)
    model = Dahl.from_parameters(stiffness=5.0, friction=0.5, exponent=0.0)
    np.testing.assert_allclose(model.predict(x), wanted, atol=1e-12)


def test_exponents_near_one_join_the_exponential() -> None:
    x = through(TURNS, 11)
    near, at = (Dahl.from_parameters(stiffness=5.0, friction=0.5, exponent=n).predict(x) for n in (1.0 + 1e-9, 1.0))
    np.testing.assert_allclose(near, at, atol=1e-8)


@pytest.mark.parametrize("friction", [0.6, -0.6])
@pytest.mark.parametrize("exponent", [0.7, 1.0, 2.2])
def test_own_kind_is_recovered(friction: float, exponent: float) -> None:
    truth = Dahl.from_parameters(
        stiffness=12.0 * friction, friction=friction, exponent=exponent, spring=[0.2, 3.0, 0.0, 1.0]
    )
    train, test = through(DECAYING, 60), through(NESTED, 83)
    model = Dahl().fit(train, truth.predict(train))
    assert nrmse(model.predict(test), truth.predict(test)) < 1e-6
    for name in ("stiffness", "friction", "exponent"):
        assert model.parameters_[name] == pytest.approx(truth.parameters_[name], rel=1e-3)
    assert model.conditions_[0].holds == (friction > 0.0)


@pytest.mark.parametrize(
    ("changed", "told"),
    [({"friction": 0.0}, "same sign"), ({"stiffness": -1.0}, "same sign"), ({"exponent": -0.1}, "at least 0")],
)
def test_bad_parameters_are_named(changed: dict[str, Any], told: str) -> None:
    with pytest.raises(InputError, match=told):
        Dahl.from_parameters(**{"stiffness": 1.0, "friction": 1.0, "exponent": 1.0, **changed})
