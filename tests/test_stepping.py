"""Steppers: blocks of any size, bounded memory, times of their own, one line for a bad block."""

from __future__ import annotations

import numpy as np
import pytest

from hystbench import models
from hystbench.errors import InputError


def stop_loading(samples: int) -> np.ndarray:
    return np.sin(np.linspace(0.0, 0.3 * samples, samples)) * (1.0 + 0.2 * np.sin(0.01 * np.arange(samples)))


@pytest.mark.parametrize(
    "parameters",
    [
        ("prandtl-ishlinskii", {"weights": [1.0, 0.5, 0.2], "thresholds": [0.0, 0.3, 0.6]}),
        ("preisach", {"alpha": [0.5, 0.2], "beta": [-0.5, -0.1], "weights": [1.0, 0.3], "offset": 0.0}),
    ],
)
def test_memory_does_not_grow_with_what_has_passed(parameters: tuple[str, dict[str, object]]) -> None:
    name, values = parameters
    model = models.get(name).from_parameters(**values)
    x = stop_loading(60_000)
    stepper = model.stepper()
    found = np.concatenate([stepper.steps(part) for part in np.split(x, 60)])
    np.testing.assert_allclose(found, model.predict(x), atol=1e-12)
    # Ten times the reversals that a block can add is far less than the 5,700 reversals that have passed.
    assert stepper._state.size < 20_000
    single = model.stepper()
    np.testing.assert_allclose([single.step(v) for v in x.tolist()], found, atol=1e-12)
    assert single._state.size < 2_000


def test_reversals_that_never_close_are_all_kept() -> None:
    model = models.get("prandtl-ishlinskii").from_parameters(weights=[0.2, 1.0], thresholds=[0.0, 1e-4])
    x = np.linspace(1.0, 0.0, 5_000) * (-1.0) ** np.arange(5_000)
    stepper = model.stepper()
    found = np.concatenate([stepper.steps(part) for part in np.split(x, [1, 50, 700, 701, 4_000])])
    np.testing.assert_allclose(found, model.predict(x), atol=1e-12)
    single = model.stepper()
    np.testing.assert_allclose([single.step(v) for v in x.tolist()], found, atol=1e-12)


def test_a_rate_dependent_model_takes_the_times_of_a_block() -> None:
    model = models.get("lugre").from_parameters(
        stiffness=5.0, damping=0.1, viscous=0.3, coulomb=0.5, static=0.7, stribeck_speed=0.1, spring=[0.0, 1.0]
    )
    time = np.cumsum(np.random.default_rng(0).uniform(0.005, 0.02, 400))
    x = np.sin(5.0 * time)
    dt = np.diff(time, prepend=time[0] - 0.01)
    stepper = model.stepper()
    found = np.concatenate([stepper.steps(a, b) for a, b in zip(np.split(x, 4), np.split(dt, 4), strict=True)])
    np.testing.assert_allclose(found, model.predict(x, time=time), atol=1e-12)
    stepper.reset()
    evenly = np.concatenate([stepper.steps(part, 0.01) for part in np.split(x, 4)])
    np.testing.assert_allclose(evenly, model.predict(x, time=0.01 * np.arange(400)), atol=1e-9)


@pytest.mark.parametrize("block", [[[1.0, 2.0]], 1.0, [0.0, np.nan], ["a"], [1j], np.array([1j])])
def test_a_bad_block_is_told_in_one_line_and_moves_nothing(block: object) -> None:
    stepper = models.get("prandtl-ishlinskii").from_parameters(weights=[1.0, 0.5], thresholds=[0.0, 0.3]).stepper()
    stepper.step(0.4)
    before = stepper.peek(-0.2)
    with pytest.raises(InputError, match=r"^a block of inputs must [^\n]*$"):
        stepper.steps(block)  # type: ignore[arg-type]
    assert stepper.peek(-0.2) == before
    assert stepper.steps([]).shape == (0,)
