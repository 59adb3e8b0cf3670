"""Verdicts where the simulator's own parameters are off, alone or beside an effect."""

from __future__ import annotations

import numpy as np
import pytest
from development import developed
from hardening_joint import relaxing_branch, rich_motion, signals_of, spring
from joints import dahl, sliders
from motions import swelling
from numpy.typing import NDArray
from simulators import motion, rigid_body
from slider_joint import ELEMENTS, TIME, X

from hystbench.diagnosis.blind.cases import DEVELOPMENT_PLANTS
from hystbench.diagnosis.diagnosis import diagnose
from hystbench.diagnosis.verdict.strain import is_strained

Floats = NDArray[np.float64]
GAINS = [{"torque_gain"}, {"torque_gain", "miscalibration"}]


@pytest.mark.parametrize("seed", [11147, 12156])
def test_several_small_errors_of_a_simulator_are_no_gain(seed: int) -> None:
    case, found = developed(seed)
    assert case.effects == ()
    assert found.verdict == ["miscalibration"]


@pytest.mark.thorough(but_one_in=4)
@pytest.mark.parametrize(
    ("factor", "verdicts"),
    [(0.8, GAINS), (0.88, GAINS), (1.0, [{"miscalibration"}]), (1.12, GAINS), (1.25, GAINS)],
)
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_factor_beyond_what_parameters_off_by_a_few_per_cent_make_is_a_gain(
    factor: float, verdicts: list[set[str]], seed: int
) -> None:
    time, x = swelling()
    rng = np.random.default_rng(seed)
    errors = 1.0 + rng.choice([-1.0, 1.0], 4) * rng.uniform(0.03, 0.05, 4)

    def joint(off: Floats) -> Floats:
        soft, stiff = sliders(x, ((0.8, 0.16),)), sliders(x, ((6.0, 0.12), (2.0, 0.15)))
        return off[0] * 4.0 * x + off[1] * 0.6 * x**3 + off[2] * stiff + off[3] * soft

    found = diagnose(signals_of(time, x, factor * joint(errors), joint(np.ones(4)), seed))
    assert set(found.verdict) in verdicts
    if factor == 1.0:
        assert found.ambiguous == []


@pytest.mark.thorough
def test_elements_that_stand_in_for_others_may_be_off_by_more_than_those() -> None:
    # Neighbouring sliders of the emulator make up for each other, so that some are off by far more than the simulator's own.
    time, x = motion(45.0, 0.0, 1.0, 2.0)

    def joint(e: float) -> Floats:
        """A spring that is soft about zero, as in gears with lost motion, beside nine sliders."""
        yields = np.geomspace(0.03, 0.7, 9)
        elements = [(14.0 * (1.0 - e) * np.exp(-k / 3.0), length * (1.0 + 2.0 * e)) for k, length in enumerate(yields)]
        return 20.0 * (1.0 - e) * (x - 0.04 * np.tanh(x / 0.05)) + sliders(x, elements)

    real, simulated = joint(-0.045), joint(0.0)
    noise_level = float(np.std(real - simulated)) / 8.0
    found = diagnose(signals_of(time, x, real, simulated, 3, noise_level))
    assert is_strained(found.evidence)
    assert found.verdict == ["miscalibration"]


def test_exponents_that_are_off_make_no_gain() -> None:
    time, x = swelling()

    def joint(stiffness: float, exponent: float, friction: float) -> Floats:
        return stiffness * np.sinh(exponent * x) + sliders(x, ((6.0 * friction, 0.12), (2.0 * friction, 0.15)))

    found = diagnose(signals_of(time, x, joint(1.04, 2.1, 0.96), joint(1.0, 2.0, 1.0)))
    factor = float(np.polyfit(found.signals.y_sim, found.signals.gap, 1)[0])
    assert factor > 0.08
    assert found.verdict == ["miscalibration"]
    # A factor of a torque sensor and errors of 3 to 5 % could make it as well.
    assert ["miscalibration", "torque_gain"] in found.ambiguous


def test_an_asymmetric_spring_that_is_off_brings_no_offset() -> None:
    time, x = rich_motion()
    found = diagnose(signals_of(time, x, spring(x), spring(x, 1.27, 0.66, 4.14, 0.29)))
    assert found.verdict == ["miscalibration"]


def test_an_effect_beside_a_simulator_that_is_off_is_named_with_it() -> None:
    time, x = rich_motion()
    y_real = spring(x) + 0.06 * np.gradient(x, time)
    found = diagnose(signals_of(time, x, y_real, spring(x, 1.27, 0.66, 4.14, 0.29)))
    assert set(found.verdict) - {"miscalibration"} == {"viscous_friction"}


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize("cubic", [-0.04, 0.04])
def test_an_effect_of_which_a_simulator_that_is_off_hides_a_part_is_named_with_it(cubic: float) -> None:
    def joint(linear: float, cubic: float, sliding: float) -> Floats:
        return 4.0 * linear * X + 0.6 * cubic * X**3 + sliding * sliders(X, ELEMENTS)

    real, simulated = joint(1.0, 1.0, 1.0), joint(1.04, 1.0 + cubic, 0.96)
    hiding = real - simulated
    branch = relaxing_branch(TIME, X, 3.0)
    relaxation = branch * np.std(hiding) / np.std(branch) / 1.6
    found = diagnose(signals_of(TIME, X, real + relaxation, simulated, 5, float(np.std(relaxation)) / 8.0))
    assert np.std(hiding + relaxation) < 0.8 * np.std(relaxation)
    assert set(found.verdict) == {"stress_relaxation", "miscalibration"}


@pytest.mark.thorough(but_one_in=4)
@pytest.mark.parametrize("off", [0.0, 0.04, -0.04])
@pytest.mark.parametrize(("effect", "more"), [("inertia", 1.0), ("coulomb_friction", 0.4), ("coulomb_friction", 0.8)])
def test_much_more_of_what_a_simulator_has_itself_is_an_effect_and_no_miscalibration(
    effect: str, more: float, off: float
) -> None:
    """An engine for rigid bodies that knows the mass and the friction, of which the joint has ``more``, relatively."""
    time, x = swelling(4000)
    speed = np.gradient(x, time)
    acceleration = np.gradient(speed, time)
    friction = np.clip((speed + 0.003 * acceleration) / 0.02, -1.0, 1.0)
    added = more * {"inertia": 0.02 * acceleration, "coulomb_friction": 0.8 * friction}[effect]
    noise = np.std(added) / 8.0 * np.random.default_rng(3).standard_normal(x.size)
    found = diagnose(signals_of(time, x, rigid_body(time, x) + added + noise, rigid_body(time, x, off)))
    assert set(found.verdict) - {"miscalibration"} == {effect}


def test_friction_is_not_named_for_what_a_simulator_that_is_off_explains_by_itself() -> None:
    def joint(x: Floats, friction: float, presliding: float, exponent: float, stiffness: float, cubic: float) -> Floats:
        return dahl(x, friction, presliding, exponent) + stiffness * x + cubic * x**3

    time, x = swelling(3000)
    y_real = joint(x, 2.61, 0.04, 1.6, 3.0, 1.96)
    y_sim = joint(1.037 * x, 2.61 * 0.959, 0.04 * 0.963, 1.6 * 1.05, 3.0 * 0.957, 1.96 * 1.031)
    found = diagnose(signals_of(time, x, y_real, y_sim, noise_level=0.007))
    assert found.closed_in_all > 0.98
    assert found.verdict == ["miscalibration"]


@pytest.mark.parametrize(("seed", "effect"), [(19270, "inertia"), (19368, "viscous_friction")])
def test_a_wave_longer_than_the_stroke_is_not_asked_for_where_a_simulator_that_is_off_does_as_well(
    seed: int, effect: str
) -> None:
    case, found = developed(seed, *DEVELOPMENT_PLANTS)
    assert case.effects == (effect,)
    assert set(found.verdict) - {"miscalibration"} == {effect}


@pytest.mark.thorough
def test_several_effects_beside_a_simulator_that_is_off_are_not_named_on_a_doubtful_ground() -> None:
    case, found = developed(19110, *DEVELOPMENT_PLANTS)
    assert case.effects == case.excluded == ("stiffness_asymmetry",)
    assert found.verdict == ["unknown"]


def test_a_gain_beside_relaxation_is_no_simulator_that_is_off() -> None:
    time, x = rich_motion()
    y_sim = spring(x)

    fast, slow = (relaxing_branch(time, y_sim, constant) for constant in (0.18, 0.72))
    y_real = 0.704 * y_sim + 0.048 * fast + 0.032 * slow
    found = diagnose(signals_of(time, x, y_real, y_sim))
    assert set(found.verdict) == {"torque_gain", "stress_relaxation"}


def test_an_effect_is_named_though_the_simulators_errors_hide_a_part_of_it() -> None:
    time, x = rich_motion(4000)
    y_real = spring(x) + 0.5 * relaxing_branch(time, x, 0.5)
    # A stiffer spring makes up for a part of the branch: without the branch's own error the gap would be larger.
    y_sim = spring(x, 1.25, 0.68, 4.3, 0.31)
    assert np.std(y_real - y_sim) < np.std(spring(x) - y_sim)
    found = diagnose(signals_of(time, x, y_real, y_sim))
    assert found.verdict == ["stress_relaxation", "miscalibration"]
    assert found.closed_in_all > 0.9


def test_an_offset_beside_a_weight_that_is_off_needs_no_larger_errors_of_fine_structure() -> None:
    """Which have no say there, so that it was chance how large they were said to be."""
    time, x = rich_motion()

    def arm(weight: float, stiffness: float, friction: float, level: float) -> Floats:
        return weight * np.sin(x + 0.4) + stiffness * x + sliders(x, ((friction, level),)) + 0.1 * np.gradient(x, time)

    y_sim, y_real = arm(4.5, 3.0, 5.0, 0.12), arm(4.64, 2.86, 4.77, 0.1153) + 0.378
    found = diagnose(signals_of(time, x, y_real, y_sim, seed=7, noise_level=0.378 / 4.0))
    assert "torque_offset" in found.verdict
