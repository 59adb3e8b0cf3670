"""LuGre friction: against an adaptive integrator, its dependence on time, and what a fit finds."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from motions import DECAYING, NESTED, Floats, nrmse, through
from scipy.integrate import solve_ivp

from hystbench import models
from hystbench.errors import InputError

LuGre = models.get("lugre")
CONSTANTS = {
    "stiffness": 20.0, "damping": 0.3, "viscous": 0.2, "coulomb": 1.0, "static": 1.6, "stribeck_speed": 0.4,
    "spring": [0.1, 2.0, 0.0, 0.5],
}  # fmt: skip


def clock(x: Floats, seed: int) -> Floats:
    """Uneven sample times with slow and fast stretches."""
    pace = np.repeat(np.random.default_rng(seed).uniform(0.005, 0.1, x.size // 50 + 1), 50)[: x.size]
    return np.cumsum(pace * np.random.default_rng(seed + 1).uniform(0.7, 1.3, x.size))


def reference(x: Floats, time: Floats) -> Floats:
    c = CONSTANTS
    z, out = 0.0, []
    for k, value in enumerate(x.tolist()):
        v = (value - x[k - 1]) / (time[k] - time[k - 1]) if k else 0.0
        level = c["coulomb"] + (c["static"] - c["coulomb"]) * np.exp(-((v / c["stribeck_speed"]) ** 2))

        def rate(t: float, z: Any, v: float = v, level: float = level) -> Any:
            return v - c["stiffness"] * abs(v) * z / level

        if k:
            z = float(solve_ivp(rate, (time[k - 1], time[k]), [z], method="LSODA", rtol=1e-10, atol=1e-13).y[0, -1])
        force = c["stiffness"] * z + c["damping"] * rate(0.0, z) + c["viscous"] * v
        out.append(force + 0.1 + 2.0 * value + 0.5 * value**3)
    return np.array(out)


def test_output_follows_the_bristles_equation() -> None:
    x = through([0.0, 1.0, -1.0, 0.8, -0.6, 0.5, -0.3, 0.9, 0.9, -0.2], 12)
    time = clock(x, 0)
    found = LuGre.from_parameters(**CONSTANTS).predict(x, time=time)
    np.testing.assert_allclose(found, reference(x, time), atol=1e-7)


def test_time_matters_and_without_it_samples_are_one_second_apart() -> None:
    x = through(NESTED, 20)
    model = LuGre.from_parameters(**CONSTANTS)
    np.testing.assert_array_equal(model.predict(x), model.predict(x, time=5.0 + np.arange(x.size)))
    assert nrmse(model.predict(x, time=0.01 * np.arange(x.size)), model.predict(x)) > 0.01
    assert any("1 s apart" in note for note in LuGre(starts=4).fit(x, model.predict(x)).notes_)
    assert not any("1 s apart" in note for note in LuGre(starts=4).fit(x, x, time=clock(x, 1)).notes_)


def test_stepper_and_inverse_take_the_same_times() -> None:
    x = through(NESTED, 20)
    time = clock(x, 3)
    model = LuGre.from_parameters(**CONSTANTS)
    y = model.predict(x, time=time)
    stepper = model.stepper()
    steps = [stepper.step(v, dt) for v, dt in zip(x.tolist(), np.diff(time, prepend=0.0).tolist(), strict=True)]
    np.testing.assert_allclose(steps, y, atol=1e-12)
    np.testing.assert_allclose(model.predict(model.invert(y, time=time), time=time), y, atol=1e-8)
    groups = np.repeat([0, 1], [100, x.size - 100])
    restarted = np.concatenate([time[:100], time[100:] - time[100]])
    np.testing.assert_array_equal(
        model.predict(x, groups=groups, time=restarted)[100:], model.predict(x[100:], time=restarted[100:])
    )


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda t: t[:-1], "one value a sample"),
        (lambda t: np.where(np.arange(t.size) == 7, t[6], t), r"time\[7\] = .* follows"),
        (lambda t: np.where(np.arange(t.size) == 7, np.nan, t), r"time\[7\] is nan"),
    ],
)
def test_bad_times_are_named(change: Any, told: str) -> None:
    x = through(NESTED, 20)
    time = change(clock(x, 3))
    model = LuGre.from_parameters(**CONSTANTS)
    for call in (model.predict, model.invert, lambda v, time: LuGre().fit(v, v, time=time)):
        with pytest.raises(InputError, match=told):
            call(x, time=time)


def test_own_kind_is_recovered() -> None:
    truth = LuGre.from_parameters(**CONSTANTS)
    train, test = through(DECAYING, 60), through(NESTED, 83)
    times = clock(train, 5), clock(test, 6)
    model = LuGre().fit(train, truth.predict(train, time=times[0]), time=times[0])
    wanted = truth.predict(test, time=times[1])
    assert nrmse(model.predict(test, time=times[1]), wanted) < 1e-5
    for name in ("stiffness", "damping", "viscous", "coulomb", "static", "stribeck_speed"):
        assert model.parameters_[name] == pytest.approx(CONSTANTS[name], rel=0.01)


def test_passivity_condition_is_the_published_bound() -> None:
    passive = {**CONSTANTS, "viscous": 0.181}
    assert LuGre.from_parameters(**passive).conditions_[1].holds
    assert not LuGre.from_parameters(**{**passive, "viscous": 0.179}).conditions_[1].holds


@pytest.mark.parametrize("name", ["stiffness", "coulomb", "static", "stribeck_speed"])
def test_constants_that_must_be_positive(name: str) -> None:
    with pytest.raises(InputError, match=f"{name} must be positive"):
        LuGre.from_parameters(**{**CONSTANTS, name: 0.0})
