"""One of the simulator's own parts that is off by itself is no effect; a second one of its kind is."""

from __future__ import annotations

import numpy as np
import pytest
from hardening_joint import rich_motion, signals_of
from joints import dahl, sliders
from numpy.typing import NDArray

from hystbench.diagnosis.diagnosis import diagnose

Floats = NDArray[np.float64]
TIME, X = rich_motion()
SPEED = np.gradient(X, TIME)
PARTS: dict[str, Floats] = {
    "inertia": 0.02 * np.gradient(SPEED, TIME),
    "viscous_friction": 0.15 * SPEED,
    "coulomb_friction": 0.6 * np.tanh(SPEED / 0.05),
    "presliding": dahl(X, 0.6, 0.03, 1.0),
    "sliders": sliders(X, ((5.0, 0.12), (2.0, 0.2))),
}


def joint(*parts: str) -> Floats:
    return 3.0 * X + 0.8 * X**3 + sum((PARTS[part] for part in parts), np.zeros(X.size))


@pytest.mark.thorough(but_one_in=3)
@pytest.mark.parametrize("error", [-0.04, 0.05])
@pytest.mark.parametrize("part", PARTS)
def test_one_part_that_is_off_by_a_few_per_cent_is_no_effect(part: str, error: float) -> None:
    # Two frictions with memory would be one part.
    others = ["inertia"] if part in ("presliding", "sliders") else ["inertia", "sliders"]
    y_sim = joint(*(other for other in others if other != part), part)
    found = diagnose(
        signals_of(TIME, X, y_sim + error * PARTS[part], y_sim, noise_level=0.2 * np.std(error * PARTS[part]))
    )
    assert found.verdict == ["miscalibration"]
    assert found.closed_in_all > 0.9


@pytest.mark.thorough(but_one_in=3)
@pytest.mark.parametrize("part", ["inertia", "viscous_friction", "sliders"])
def test_one_part_that_is_off_by_less_than_the_noise_is_no_gap(part: str) -> None:
    y_sim = joint("sliders", part) if part != "sliders" else joint("inertia", part)
    error = 0.05 * PARTS[part]
    found = diagnose(signals_of(TIME, X, y_sim + error, y_sim, noise_level=3.0 * np.std(error)))
    assert found.verdict == []


@pytest.mark.thorough(but_one_in=3)
@pytest.mark.parametrize("part", ["inertia", "viscous_friction", "coulomb_friction"])
def test_much_more_of_a_part_or_a_part_that_is_not_there_is_an_effect(part: str) -> None:
    for y_sim in (joint("sliders", part), joint("sliders")):
        found = diagnose(signals_of(TIME, X, y_sim + 0.4 * PARTS[part], y_sim, noise_level=0.02))
        assert found.verdict == [part]


@pytest.mark.parametrize(("stronger", "verdict"), [(1.05, "miscalibration"), (1.12, "coulomb_friction")])
def test_friction_that_slides_at_a_tenth_more_is_an_effect_and_at_less_it_is_off(stronger: float, verdict: str) -> None:
    levels = ((5.0, 0.12), (2.0, 0.2))
    y_sim = 3.0 * X + 0.8 * X**3 + sliders(X, levels)
    more = sliders(X, [(stiffness, stronger * level) for stiffness, level in levels]) - sliders(X, levels)
    found = diagnose(signals_of(TIME, X, y_sim + more, y_sim, noise_level=0.2 * np.std(more)))
    assert found.verdict == [verdict]


def test_a_part_that_is_off_beside_an_effect_is_no_second_effect() -> None:
    y_sim = joint("sliders", "viscous_friction")
    y_real = y_sim + 0.05 * PARTS["viscous_friction"] + 0.1
    found = diagnose(signals_of(TIME, X, y_real, y_sim, noise_level=0.002))
    assert found.verdict == ["torque_offset", "miscalibration"]


def test_a_factor_is_told_from_a_stiffness_by_what_it_makes_of_friction() -> None:
    spring = joint()
    found = diagnose(signals_of(TIME, X, 1.04 * spring, spring))
    assert found.verdict == ["miscalibration"]
    assert ["miscalibration", "torque_gain"] in found.ambiguous
    rubbing = joint("sliders", "viscous_friction")
    assert diagnose(signals_of(TIME, X, 1.04 * rubbing, rubbing)).verdict == ["torque_gain"]
