"""The Duhem model: against an adaptive integrator of Coleman and Hodgdon's equation, and what a fit finds."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from motions import DECAYING, NESTED, Floats, nrmse, through
from numpy.polynomial import Polynomial
from scipy.integrate import solve_ivp

from hystbench import models
from hystbench.errors import InputError

Duhem = models.get("duhem")
TURNS = [0.3, 1.0, -1.0, 0.8, -0.6, 0.5, -0.3, 0.9, -0.2]


def reference(x: Floats, curve: Polynomial, loss: Polynomial, rate: float) -> Floats:
    """dy = rate |dx| (f − y) + g dx with g = f' + b."""
    g = curve.deriv() + loss
    y = float(curve(x[0]))
    out = [y]
    for a, b in pairwise(x.tolist()):
        sign = np.sign(b - a)

        def slope(u: float, y: Floats, sign: float = sign) -> Floats:
            return rate * sign * (curve(u) - y) + g(u)

        y = float(solve_ivp(slope, (a, b), [y], method="DOP853", rtol=1e-11, atol=1e-13).y[0, -1])
        out.append(y)
    return np.array(out)


def test_output_follows_coleman_and_hodgdons_equation() -> None:
    x = through(TURNS, 4)
    curve, loss = [0.1, 2.0, -0.3, 0.8], [0.9, 0.2, 1.5, -0.4]
    found = Duhem.from_parameters(curve=curve, loss=loss, rate=6.0).predict(x)
    np.testing.assert_allclose(found, reference(x, Polynomial(curve), Polynomial(loss), 6.0), atol=1e-9)


@pytest.mark.parametrize("step", [1e-9, 1e-6, 1e-3])
def test_tiny_steps_lose_no_digits(step: float) -> None:
    x = np.arange(2000) * step
    model = Duhem.from_parameters(curve=[0.0], loss=[1.0, 1.0, 1.0], rate=3.0)
    once = model.predict(x[[0, -1]])[-1]
    assert model.predict(x)[-1] == pytest.approx(once, rel=1e-9)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_own_kind_is_recovered_in_either_orientation(sign: float) -> None:
    truth = Duhem.from_parameters(curve=[0.1, 2.0, 0.2, 0.7], loss=[1.5 * sign, 0.3, 0.6 * sign], rate=9.0)
    train, test = through(DECAYING, 60), through(NESTED, 83)
    model = Duhem().fit(train, truth.predict(train))
    assert nrmse(model.predict(test), truth.predict(test)) < 1e-7
    assert model.parameters_["rate"] == pytest.approx(9.0, rel=1e-4)
    np.testing.assert_allclose(model.parameters_["loss"], truth.parameters_["loss"], atol=1e-3)
    assert [condition.holds for condition in model.conditions_] == [sign > 0.0, sign < 0.0]
    y = truth.predict(test)
    assert nrmse(truth.predict(model.invert(y)), y) < 1e-6


def test_a_rate_that_is_not_positive_is_refused() -> None:
    with pytest.raises(InputError, match="rate must be positive"):
        Duhem.from_parameters(curve=[0.0, 1.0], loss=[1.0], rate=0.0)
