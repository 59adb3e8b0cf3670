"""The search inverse on any model with a stepper."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from motions import NESTED, through, turning_points

from hystbench import models
from hystbench.datasets import get as get_dataset
from hystbench.models.inversion import invert_by_search
from hystbench.models.stepping import ReplayStepper, Stepper


class Saturating(Stepper):
    """tanh of the input with a play of half width 0.05 in front: smooth, with memory, bounded."""

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        self.play = 0.0

    def peek(self, x: float) -> float:
        return float(np.tanh(2.0 * min(max(self.play, x - 0.05), x + 0.05)) + 0.1 * x)

    def step(self, x: float) -> float:
        self.play = min(max(self.play, x - 0.05), x + 0.05)
        return float(np.tanh(2.0 * self.play) + 0.1 * x)


def outputs(stepper: Stepper, x: np.ndarray) -> np.ndarray:
    stepper.reset()
    return np.array([stepper.step(v) for v in x.tolist()])


@given(turning_points(-0.9, 0.9))
def test_own_outputs_are_reached(turns: list[float]) -> None:
    x = through([0.0, *turns], 7)
    y = outputs(Saturating(), x)
    found = invert_by_search(Saturating(), y, 0.0, 1.0, approximate=False)
    np.testing.assert_allclose(outputs(Saturating(), found), y, atol=1e-8)
    # The output rises strictly with the input, so there is one answer.
    np.testing.assert_allclose(found, x, atol=1e-6)


def test_falling_outputs_are_inverted_too() -> None:
    falling = ReplayStepper(lambda x: -3.0 * x)
    y = np.array([0.3, -0.6, 0.9])
    np.testing.assert_allclose(invert_by_search(falling, y, 0.0, 1.0, approximate=False), -y / 3.0, atol=1e-12)


def test_the_nearest_of_several_inputs_is_taken() -> None:
    fold = ReplayStepper(lambda x: x**2)
    assert invert_by_search(fold, np.array([0.25]), 0.4, 1.0, approximate=False)[0] == pytest.approx(0.5, abs=1e-9)
    assert invert_by_search(fold, np.array([0.25]), -0.4, 1.0, approximate=False)[0] == pytest.approx(-0.5, abs=1e-9)


def test_an_unreachable_output_says_where_how_far_and_what_to_do() -> None:
    told = r"^no input gives the output y\[1\] = 3: from x = .* the nearest output is off by 1\.\d+\. Pass approximate=True"
    with pytest.raises(models.InverseError, match=told) as caught:
        invert_by_search(Saturating(), np.array([0.1, 3.0]), 0.0, 1.0, approximate=False)
    assert "\n" not in str(caught.value)


def test_an_approximate_inverse_stays_within_the_training_range_and_recovers() -> None:
    y = np.array([0.1, 3.0, 0.2, -3.0, 0.0])
    found = invert_by_search(Saturating(), y, 0.0, 1.0, approximate=True)
    assert np.max(np.abs(found)) <= 1.0
    reached = outputs(Saturating(), found)
    np.testing.assert_allclose(reached[[0, 2, 4]], y[[0, 2, 4]], atol=1e-8)
    assert reached[1] > 0.9
    assert reached[3] < -0.9


def test_a_jump_is_not_taken_for_a_root() -> None:
    jump = ReplayStepper(lambda x: np.where(x >= 0.2, x + 1.0, x))
    with pytest.raises(models.InverseError):
        invert_by_search(jump, np.array([0.5]), 0.0, 0.1, approximate=False)
    assert invert_by_search(jump, np.array([1.5]), 0.0, 1.0, approximate=False)[0] == pytest.approx(0.5, abs=1e-9)


@pytest.mark.parametrize("name", ["maxwell-slip", "choi-backlash", "prandtl-ishlinskii"])
def test_closed_forms_and_search_agree(name: str) -> None:
    x = through([0.0, 1.0, -1.0, 0.9, -0.7, 0.6], 100)
    y = 3.0 * x + 0.4 * models.get("prandtl-ishlinskii").from_parameters(weights=[1, -1], thresholds=[0, 0.1]).predict(
        x
    )
    model = models.get(name)().fit(x, y)
    wanted = model.predict(through([0.0, *NESTED[1:8]], 20) * 0.9)
    exact = model.invert(wanted)
    searched = invert_by_search(model.stepper(), wanted, 0.0, 1.0, approximate=False)
    np.testing.assert_allclose(model.predict(searched), wanted, atol=1e-7 * np.ptp(wanted))
    np.testing.assert_allclose(model.predict(exact), wanted, atol=1e-7 * np.ptp(wanted))
    np.testing.assert_allclose(searched, exact, atol=1e-5)


@pytest.mark.parametrize("name", ["maxwell-slip", "prandtl-ishlinskii", "choi-backlash", "bouc-wen", "preisach"])
def test_the_streaming_inverse_gives_the_wanted_output_sample_by_sample(name: str) -> None:
    data = get_dataset("vsa-published")().load().train[0]
    model = models.get(name)().fit(data.x, data.y)
    wanted = model.predict(0.7 * np.sin(np.linspace(0.0, 12.0, 300)))
    inverse = model.inverse_stepper()
    x = np.array([inverse.step(value) for value in wanted])
    assert model.predict(x) == pytest.approx(wanted, abs=1e-6 * np.ptp(wanted))
    inverse.reset()
    assert inverse.step(wanted[0]) == x[0]


def test_a_streaming_inverse_that_fails_once_keeps_its_memory() -> None:
    relay = models.get("preisach").from_parameters(alpha=[0.5], beta=[-0.5], weights=[1.0], offset=0.0)
    inverse, same = relay.inverse_stepper(), relay.inverse_stepper()
    inverse.step(1.0)
    same.step(1.0)
    with pytest.raises(models.InverseError, match=r"y\[1\] = 0.3"):
        inverse.step(0.3)
    assert inverse.step(-1.0) == same.step(-1.0)
