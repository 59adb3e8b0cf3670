"""Generalized Maxwell-slip: against the published law in small time steps, its limits, and what a fit finds."""

from __future__ import annotations

import numpy as np
import pytest
from motions import DECAYING, NESTED, Floats, nrmse, through
from test_lugre import clock

from hystbench import models
from hystbench.errors import InputError

GMS = models.get("generalized-maxwell-slip")
CONSTANTS = {
    "stiffness": [20.0, 6.0, 2.0], "strength": [0.5, 0.4, 0.3], "static_ratio": 1.6, "stribeck_speed": 0.4,
    "attraction": 30.0, "viscous": 0.2, "spring": [0.1, 2.0, 0.0, 0.5],
}  # fmt: skip


def reference(x: Floats, time: Floats, substeps: int) -> Floats:
    """Al-Bender's two rules for each element, by Euler's method."""
    c = CONSTANTS
    stiffness, strength = np.array(c["stiffness"]), np.array(c["strength"])
    force, slips = np.zeros(3), np.zeros(3, dtype=bool)
    last_v, out = 0.0, []
    for k in range(x.size):
        v = (x[k] - x[k - 1]) / (time[k] - time[k - 1]) if k else 0.0
        if v * last_v <= 0.0:
            slips[:] = False
        last_v = v
        s = np.sign(v) * (1.0 + (c["static_ratio"] - 1.0) * np.exp(-((v / c["stribeck_speed"]) ** 2)))
        dt = (time[k] - time[k - 1]) / substeps if k else 0.0
        for _ in range(substeps if v else 0):
            slips |= np.sign(v) * force >= strength * abs(s)
            rate = np.where(slips, np.sign(v) * c["attraction"] * (strength - force / s), stiffness * v)
            force = force + rate * dt
        out.append(force.sum() + c["viscous"] * v + 0.1 + 2.0 * x[k] + 0.5 * x[k] ** 3)
    return np.array(out)


def test_elements_follow_the_published_law() -> None:
    x = through([0.0, 1.0, -1.0, 0.8, -0.6, 0.5, -0.3, 0.9, 0.9, -0.2], 15)
    time = clock(x, 0)
    found = GMS.from_parameters(**CONSTANTS).predict(x, time=time)
    errors = [np.max(np.abs(found - reference(x, time, n))) for n in (100, 1000)]
    assert errors[1] < 1e-3 * np.ptp(found)
    # Euler's error falls with the step: what is left is the reference's own.
    assert errors[1] < 0.2 * errors[0]


def test_without_stribeck_effect_it_is_maxwell_slip_whatever_the_rate() -> None:
    x = through(NESTED, 30)
    stiffness, strength = np.array([20.0, 6.0]), np.array([0.5, 0.9])
    wanted, force, last = [], np.zeros(2), 0.0
    for value in x:
        force = np.clip(force + stiffness * (value - last), -strength, strength)
        last = value
        wanted.append(force.sum())
    model = GMS.from_parameters(
        stiffness=stiffness, strength=strength, static_ratio=1.0, stribeck_speed=1.0, attraction=5.0, viscous=0.0
    )
    for seed in (0, 1):
        np.testing.assert_allclose(model.predict(x, time=clock(x, seed)), wanted, atol=1e-12)


def test_stepper_and_inverse_take_the_same_times() -> None:
    x = through(NESTED, 20)
    time = clock(x, 3)
    model = GMS.from_parameters(**CONSTANTS)
    y = model.predict(x, time=time)
    stepper = model.stepper()
    steps = [stepper.step(v, dt) for v, dt in zip(x.tolist(), np.diff(time, prepend=0.0).tolist(), strict=True)]
    np.testing.assert_allclose(steps, y, atol=1e-12)
    np.testing.assert_allclose(model.predict(model.invert(y, time=time), time=time), y, atol=1e-8)


def test_own_kind_predicts_held_out_motion_at_other_rates() -> None:
    truth = GMS.from_parameters(**CONSTANTS)
    train, test = through(DECAYING, 60), through(NESTED, 83)
    times = clock(train, 5), clock(test, 6)
    model = GMS(elements=12).fit(train, truth.predict(train, time=times[0]), time=times[0])
    assert nrmse(model.predict(test, time=times[1]), truth.predict(test, time=times[1])) < 5e-3
    assert model.parameters_["static_ratio"] == pytest.approx(1.6, rel=0.1)
    assert np.all(model.parameters_["strength"] > 0.0)


@pytest.mark.parametrize(
    ("name", "value", "told"),
    [
        ("strength", [0.5, 0.0, 0.3], "strength must be positive"),
        ("stiffness", [1.0, 1.0], "stiffness must have shape"),
        ("attraction", 0.0, "attraction must be positive"),
    ],
)
def test_bad_parameters_are_named(name: str, value: object, told: str) -> None:
    with pytest.raises(InputError, match=told):
        GMS.from_parameters(**{**CONSTANTS, name: value})
