"""Baber and Noori's model: against an adaptive integrator and plain Bouc-Wen, its effects, and what a fit finds."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from motions import DECAYING, NESTED, Floats, nrmse, through
from scipy.integrate import solve_ivp

from hystbench import models
from hystbench.errors import InputError

BBN = models.get("bouc-wen-baber-noori")
SHAPE = {"spring": [0.0, 0.3], "hysteretic": 1.2, "A": 1.0, "beta": 2.0, "gamma": 0.5, "n": 1.5}
EFFECTS = {
    "phi": 0.3, "zeta_s": 0.7, "q": 0.2, "p": 3.0, "psi": 0.15, "delta_psi": 0.05, "lambda_": 0.3, "delta_nu": 0.4,
    "delta_eta": 0.3,
}  # fmt: skip
TURNS = [0.0, 1.0, -1.0, 0.8, -0.6, 0.5, -0.3, 0.9, -0.2]


def reference(x: Floats, c: dict[str, Any]) -> Floats:
    """The published equations in x itself, in short pieces by RK45 with tight tolerances."""
    state, out = [0.0, 0.0], [0.0]
    for a, b in pairwise(x.tolist()):
        sign = np.sign(b - a)

        def slope(u: float, s: Floats, sign: float = sign) -> list[float]:
            z, energy = s[0], max(s[1], 0.0)
            nu, eta = 1.0 + c["delta_nu"] * energy, 1.0 + c["delta_eta"] * energy
            bracket = c["beta"] * np.sign(sign * z) + c["gamma"] + c["phi"] * (sign + np.sign(z))
            zeta_1 = c["zeta_s"] * (1.0 - np.exp(-c["p"] * energy))
            zeta_2 = (c["psi"] + c["delta_psi"] * energy) * (c["lambda_"] + zeta_1)
            ultimate = (c["A"] / (nu * (c["beta"] + c["gamma"]))) ** (1.0 / c["n"])
            h = 1.0 - zeta_1 * np.exp(-(((z * sign - c["q"] * ultimate) / zeta_2) ** 2))
            return [h * (c["A"] - nu * abs(z) ** c["n"] * bracket) / eta, z]

        state = solve_ivp(slope, (a, b), state, rtol=1e-9, atol=1e-11, max_step=0.01).y[:, -1].tolist()
        out.append(state[0])
    return np.polynomial.Polynomial(c["spring"])(x) + c["hysteretic"] * np.array(out)


def test_output_follows_the_published_equations() -> None:
    x = through(TURNS, 10)
    parameters = {**SHAPE, **EFFECTS}
    found = BBN.from_parameters(**parameters).predict(x)
    assert np.max(np.abs(found - reference(x, parameters))) < 2e-6 * np.ptp(found)


@pytest.mark.parametrize("n", [1.0, 1.6, 3.0])
def test_without_effects_it_is_bouc_wen(n: float) -> None:
    x = through(TURNS, 6)
    plain = models.get("bouc-wen").from_parameters(stiffness=1.5, alpha=0.2, A=1.0, beta=2.0, gamma=0.5, n=n)
    same = BBN.from_parameters(**{**SHAPE, "n": n})
    np.testing.assert_allclose(same.predict(x), plain.predict(x), atol=2e-6)


def test_each_effect_does_what_it_is_named_for() -> None:
    cycles = through([0.0, *[1.0, -1.0] * 6], 100)
    tops = np.arange(100, cycles.size, 200)
    base = BBN.from_parameters(**SHAPE).predict(cycles)
    assert np.ptp(base[tops[2:]]) < 1e-6

    weaker = BBN.from_parameters(**SHAPE, delta_nu=0.5).predict(cycles)
    assert np.all(np.diff(weaker[tops]) < 0.0)

    softer = BBN.from_parameters(**SHAPE, delta_eta=0.5).predict(cycles)
    initial_slopes = [(softer[k] - softer[k + 5]) / (cycles[k] - cycles[k + 5]) for k in tops[:-1]]
    assert np.all(np.diff(initial_slopes) < 0.0)

    lopsided = BBN.from_parameters(**SHAPE, phi=0.5).predict(cycles)
    assert lopsided[tops[-1]] + lopsided[tops[-1] - 100] < -0.05

    pinched = BBN.from_parameters(**SHAPE, zeta_s=0.9, p=50.0, psi=0.3, lambda_=0.3).predict(cycles)
    last = slice(tops[-2], tops[-2] + 201)
    area = [abs(np.trapezoid(y[last], cycles[last])) for y in (base, pinched)]
    assert area[1] < 0.8 * area[0]


def test_own_kind_predicts_held_out_motion() -> None:
    truth = BBN.from_parameters(**{**SHAPE, "phi": 0.2, "delta_nu": 0.05, "delta_eta": 0.1})
    train, test = through(DECAYING[:30], 40), through(NESTED, 50)
    model = BBN(starts=32).fit(train, truth.predict(train))
    assert nrmse(model.predict(test), truth.predict(test)) < 2e-3
    plain = models.get("bouc-wen")(starts=32).fit(train, truth.predict(train))
    assert nrmse(model.predict(train), truth.predict(train)) < 0.2 * nrmse(plain.predict(train), truth.predict(train))


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"n": 0.5}, "n must be at least 1"),
        ({"zeta_s": 1.0}, r"zeta_s must lie in \[0, 1\)"),
        ({"delta_nu": -1.0}, "delta_nu must not be negative"),
        ({"psi": 0.0}, "psi must be positive"),
    ],
)
def test_bad_parameters_are_named(changed: dict[str, float], told: str) -> None:
    with pytest.raises(InputError, match=told):
        BBN.from_parameters(**{**SHAPE, **changed})
