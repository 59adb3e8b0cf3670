"""What an effect that is not known here does is not blamed on one that would do nearly the same."""

from __future__ import annotations

import numpy as np
import pytest
from development import developed
from joints import sliders
from motions import swelling
from numpy.typing import NDArray

from hystbench.diagnosis.blind.cases import DEVELOPMENT_PLANTS
from hystbench.diagnosis.diagnosis import diagnose
from hystbench.diagnosis.effects.encoder_eccentricity import EncoderEccentricity
from hystbench.diagnosis.effects.stribeck_friction import StribeckFriction
from hystbench.diagnosis.emulator import generalised
from hystbench.diagnosis.emulator.emulation import SimulatorScene
from hystbench.diagnosis.operators.levels import yielding
from hystbench.diagnosis.recording.signals import Signals
from hystbench.diagnosis.result import Diagnosis
from hystbench.diagnosis.verdict.strain import is_strained
from hystbench.diagnosis.wording import summary

Floats = NDArray[np.float64]
NOISE = 0.012
TIME, X = swelling()
TRAVEL = np.cumsum(np.abs(np.diff(X, prepend=X[0])))
SLOWLY = {
    "cyclic_softening": TRAVEL / TRAVEL[-1],
    "thermal_drift": TIME / TIME[-1],
}
"""What each goes on with, from 0 to 1."""
CLOCK = {"cyclic_softening": "travel", "thermal_drift": "time"}


def spring(x: Floats) -> Floats:
    return 4.0 * x + 0.6 * x**3


def joint(x: Floats) -> Floats:
    return spring(x) + sliders(x, ((6.0, 0.12), (2.0, 0.15), (0.8, 0.16)))


def diagnosed(y_real: Floats, exclude: tuple[str, ...] = ()) -> Diagnosis:
    noise = NOISE * np.random.default_rng(3).standard_normal(X.size)
    return diagnose(Signals(TIME, X, y_real + noise, joint(X), [slice(0, X.size)], {}), exclude=exclude)


def weakened(effect: str) -> Floats:
    """A joint that loses more and more of its torque, with the clock of one effect."""
    return joint(X) * (1.0 - 0.12 * (1.0 - np.exp(-2.0 * SLOWLY[effect])))


@pytest.mark.parametrize(
    ("effect", "other"), [("cyclic_softening", "thermal_drift"), ("thermal_drift", "cyclic_softening")]
)
def test_wear_is_no_drift_and_drift_no_wear_where_only_one_of_them_is_known(effect: str, other: str) -> None:
    withheld = diagnosed(weakened(effect), (effect,))
    assert withheld.verdict == ["unknown"]
    why = f"goes with {CLOCK[effect]} rather than with {CLOCK[other]}"
    assert any(why in note for note in withheld.notes)
    assert any(why in line for line in summary(withheld, designed=False))
    # The one that is there is named also where the other is known not to be.
    assert diagnosed(weakened(effect), (other,)).verdict == [effect]
    assert diagnosed(weakened(effect)).verdict == [effect]


def test_an_offset_of_the_torque_is_not_blamed_on_two_errors_of_the_deflection_that_make_it_up_together() -> None:
    withheld = diagnosed(joint(X) + 0.15, ("torque_offset",))
    assert withheld.verdict == ["unknown"]
    assert len(withheld.choice.hypothesis.names) > 1
    assert diagnosed(joint(X) + 0.15).verdict == ["torque_offset"]


def test_an_offset_of_the_torque_is_no_error_of_a_preload_that_the_simulator_has() -> None:
    y_sim = joint(X) + 0.9
    noise = NOISE * np.random.default_rng(3).standard_normal(X.size)
    preloaded = Signals(TIME, X, y_sim + 0.1 + noise, y_sim, [slice(0, X.size)], {})
    withheld = diagnose(preloaded, exclude=("torque_offset",))
    assert withheld.verdict == ["unknown"]
    assert any(note.startswith("one constant on the whole torque, 0.100") for note in withheld.notes)
    assert diagnose(preloaded).verdict == ["torque_offset"]


def test_a_shift_of_the_spring_is_not_blamed_on_a_constant_torque_and_an_asymmetry_that_make_it_up_together() -> None:
    shifted = joint(X) + spring(X - 0.03) - spring(X)
    withheld = diagnosed(shifted, ("deflection_offset",))
    assert withheld.verdict == ["unknown"]
    assert withheld.choice.hypothesis.names == {"torque_offset", "stiffness_asymmetry"}
    assert any(note.startswith("stiffness asymmetry would explain it, but on this joint") for note in withheld.notes)
    assert diagnosed(shifted).verdict == ["deflection_offset"]


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize("stiffer", [1.5 * np.maximum(X, 0.0), 0.8 * np.abs(X)], ids=["stiffer above", "softer below"])
def test_a_stiffness_that_differs_by_side_is_not_blamed_on_an_encoder(stiffer: Floats) -> None:
    withheld = diagnosed(joint(X) + stiffer, ("stiffness_asymmetry",))
    assert withheld.verdict == ["unknown"]
    why = "encoder eccentricity would explain it, but on this joint stiffness asymmetry, which is not considered here"
    assert any(note.startswith(why) for note in withheld.notes)
    assert diagnosed(joint(X) + stiffer).verdict == ["stiffness_asymmetry"]


@pytest.mark.parametrize(
    ("error", "one_sided"),
    [(X, True), (np.maximum(X, 0.0), True), (1.0 - np.cos(2.0 * np.pi * X), False)],
    ids=["the more the farther", "the more the farther above", "two waves"],
)
def test_nor_is_one_that_differs_the_more_the_farther(error: Floats, one_sided: bool) -> None:
    scene = SimulatorScene(Signals(TIME, X, joint(X), joint(X), [slice(0, X.size)], {}))
    others = EncoderEccentricity().imitates(0.05 * error * spring(X), scene)
    assert others == (("stiffness_asymmetry",) if one_sided else ())


def test_a_shift_of_the_spring_is_not_blamed_on_an_offset_of_the_torque_and_its_limit() -> None:
    others = ("deflection_offset", "encoder_eccentricity", "stiffness_asymmetry", "end_stop")
    withheld = diagnosed(joint(X) - spring(X) + spring(X + 0.06), others)
    assert withheld.choice.hypothesis.names == {"torque_offset", "torque_saturation"}
    assert withheld.verdict == ["unknown"]


def test_an_offset_of_the_torque_is_not_blamed_on_one_of_the_deflection_that_the_simulators_errors_make_even(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # By itself the offset of the deflection adds more where the spring is stiffer; so told by an emulator that is off by 0.4 %.
    monkeypatch.setattr(generalised, "BEFORE", np.inf)
    case, withheld = developed(61236, *DEVELOPMENT_PLANTS)
    assert case.excluded == ("torque_offset",)
    assert withheld.choice.hypothesis.names == {"deflection_offset"}
    assert withheld.verdict == ["unknown"]


def test_an_offset_that_by_chance_seems_to_settle_slowly_is_an_offset() -> None:
    settling = 1.0 - 0.04 * np.exp(-TIME / (0.3 * TIME[-1]))
    noise = 0.03 * np.random.default_rng(3).standard_normal(X.size)
    found = diagnose(Signals(TIME, X, joint(X) + 0.3 * settling + noise, joint(X), [slice(0, X.size)], {}))
    assert found.verdict == ["torque_offset"]


def test_friction_of_constant_size_is_not_blamed_on_a_damper_that_saturates() -> None:
    speed = np.gradient(X, TIME)
    rubbing = joint(X) + 0.1 * np.tanh(speed / (0.5 * np.std(speed)))
    withheld = diagnosed(rubbing, ("coulomb_friction",))
    assert withheld.verdict == ["unknown"]
    assert any(note.startswith("viscous friction would explain it, but on this joint") for note in withheld.notes)


@pytest.mark.parametrize(("excess", "constant"), [(0.1, True), (1.5, False)])
def test_friction_that_hardly_falls_is_constant_friction_also_where_it_builds_up_over_a_distance(
    excess: float, constant: bool
) -> None:
    signals = Signals(TIME, X, joint(X), joint(X), [slice(0, X.size)], {})
    level = 1.0 + excess * np.exp(-np.square(signals.speed / (0.4 * np.std(signals.speed))))
    added = yielding(X, level, 0.02)
    assert StribeckFriction().imitates(added, SimulatorScene(signals)) == (("coulomb_friction",) if constant else ())


@pytest.mark.parametrize(("rising", "constant"), [(1.5, True), (0.0, False)])
def test_friction_that_falls_is_constant_with_what_rises_as_much_beside_it(rising: float, constant: bool) -> None:
    scene = SimulatorScene(Signals(TIME, X, joint(X), joint(X), [slice(0, X.size)], {}))
    speed = scene.signals.speed / np.std(scene.signals.speed)
    falling = (1.0 + 1.5 * np.exp(-np.abs(speed))) * np.tanh(speed / 0.02)
    added = falling + rising * (1.0 - np.exp(-np.abs(speed))) * np.sign(speed)
    assert StribeckFriction().imitates(added, scene) == (("coulomb_friction",) if constant else ())


def test_a_simulator_is_not_called_off_where_its_parameters_would_have_to_be_off_by_far_too_much() -> None:
    # The simulator has a little of the damping that the joint has much more of.
    speed = np.gradient(X, TIME)
    noise = NOISE * np.random.default_rng(3).standard_normal(X.size)

    def off_by(much: float) -> Diagnosis:
        simulated = joint(X) + 0.05 * speed
        real = simulated + 0.05 * much * speed + noise
        exclude = ("viscous_friction", "sensor_delay", "stress_relaxation")
        return diagnose(Signals(TIME, X, real, simulated, [slice(0, X.size)], {}), exclude=exclude)

    assert off_by(0.6).verdict == ["miscalibration"]
    far = off_by(3.0)
    assert far.verdict == ["unknown"]
    assert any("far more than a tenth" in note for note in far.notes)


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize(("a", "b", "c"), [(0.97, 1.04, 0.96), (1.03, 0.96, 1.03)])
def test_what_spares_a_simulator_errors_beyond_belief_is_named(a: float, b: float, c: float) -> None:
    # A parameter of its own would do as well, but would have to be off by more than its size.
    elements = ((6.0 * c, 0.12 * b), (2.0 * a, 0.15 * c), (0.8 * b, 0.16 * a))
    real = a * 4.0 * X + b * 0.6 * X**3 + sliders(X, elements) + 0.24 * X**2
    noise = NOISE * np.random.default_rng(3).standard_normal(X.size)
    found = diagnose(Signals(TIME, X, real + noise, joint(X) + 0.1 * X**2, [slice(0, X.size)], {}))
    assert is_strained(found.evidence)
    assert found.verdict == ["stiffness_asymmetry", "miscalibration"]
