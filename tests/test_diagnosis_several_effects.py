"""Verdicts on two effects at once."""

from __future__ import annotations

import numpy as np
import pytest
from development import developed
from hardening_joint import rich_motion, signals_of, spring
from joints import sliders
from motions import swelling
from numpy.typing import NDArray

from hystbench.diagnosis.blind.cases import DEVELOPMENT_PLANTS
from hystbench.diagnosis.blind.plant import Case
from hystbench.diagnosis.blind.plants import make
from hystbench.diagnosis.diagnosis import diagnose
from hystbench.diagnosis.effects.deflection_offset import DeflectionOffset
from hystbench.diagnosis.effects.torque_offset import TorqueOffset
from hystbench.diagnosis.hypotheses.evidence import Term
from hystbench.diagnosis.recording.noise import rms
from hystbench.diagnosis.recording.signals import Signals
from hystbench.diagnosis.verdict.priors import prior

Floats = NDArray[np.float64]


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize(
    ("phases", "presliding", "level", "stops", "stiffness", "offset"),
    [
        ((5.7, 0.4, 4.2, 3.0), 0.05, 2.0, (0.37, 0.37), 24.0, 0.25),
        ((2.6, 5.8, 1.7, 0.4), 0.05, 0.5, (0.53, 0.55), 6.0, 0.5),
    ],
)
def test_stops_in_mid_stroke_and_an_offset_are_found_together(
    phases: tuple[float, ...],
    presliding: float,
    level: float,
    stops: tuple[float, float],
    stiffness: float,
    offset: float,
) -> None:
    """Neither does well alone, so that a refitted simulator led the search astray."""
    time = np.arange(0.0, 20.0, 0.005)
    waves = zip((0.5, 0.35, 0.25, 0.15), (0.21, 0.47, 0.83, 1.3), phases, strict=True)
    x = sum(size * np.sin(2.0 * np.pi * rate * time + phase) for size, rate, phase in waves) * (
        1.0 - np.exp(-time / 0.5)
    )
    x = np.asarray(x - x[0])
    friction = np.zeros_like(x)
    for i in range(1, x.size):
        towards = np.sign(x[i] - x[i - 1])
        friction[i] = towards + (friction[i - 1] - towards) * np.exp(-abs(x[i] - x[i - 1]) / presliding)
    base = 6.0 * x + level * friction
    up, down = (share * np.max(np.abs(x)) for share in stops)
    gap = stiffness * (np.maximum(x - up, 0.0) ** 1.5 - np.maximum(-x - down, 0.0) ** 1.5) + offset
    noise = 0.1 * np.std(gap) * np.random.default_rng(2).standard_normal(x.size)
    found = diagnose(Signals(time, x, base + gap + noise, base, [slice(0, x.size)], {}))
    assert set(found.verdict) == {"end_stop", "torque_offset"}


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize("seed", [11034, 11111])
def test_two_effects_keep_their_laws_beside_an_exact_simulator(seed: int) -> None:
    """A refitted simulator led them to other laws, so that they were left out in favour of what imitates them."""
    case, found = developed(seed)
    assert len(case.effects) == 2
    assert set(found.verdict) == set(case.effects)


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize("seed", [5_000_419, 5_200_230])
def test_two_effects_do_not_pay_for_errors_of_the_simulator_that_bring_less_than_they_cost(seed: int) -> None:
    case, found = developed(seed, *DEVELOPMENT_PLANTS)
    assert len(case.effects) == 2
    assert set(found.verdict) == set(case.effects)


def test_an_offset_that_settles_for_ever_is_the_constant_that_does_as_well() -> None:
    """Beside another effect it left nothing, so that no other law was tried; at the end of its range it is a drift's image."""
    case, found = developed(5_700_055, *DEVELOPMENT_PLANTS)
    assert set(case.effects) == {"torque_offset", "cyclic_softening"}
    assert set(found.verdict) == set(case.effects)


@pytest.mark.thorough(but_one_in=3)
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_slow_error_of_an_encoder_and_an_offset_are_told_from_a_slower_error(seed: int) -> None:
    """Two harmonics that are as slow as can be make both, and leave nothing."""
    time, x = swelling()
    x = 2.5 / np.max(np.abs(x)) * x

    def gear(angle: Floats) -> Floats:
        return 3.0 * np.sin(0.9 * angle) + 0.6 * angle + sliders(angle - angle[0], ((4.0, 0.1), (1.5, 0.2)))

    read_wrong = x + 0.02 + 0.05 * np.sin(x + 0.7)
    found = diagnose(signals_of(time, x, gear(read_wrong), gear(x), seed, 0.03))
    assert set(found.verdict) == {"encoder_eccentricity", "deflection_offset"}


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize("phase", [2.0, 2.8])
def test_an_offset_beside_an_error_that_comes_once_a_turn_of_half_a_turn_is_told(phase: float) -> None:
    """With as many waves as suit it the error makes the offset as well, at the end of its range."""
    time, turned = swelling()
    turned = 1.75 / np.max(np.abs(turned)) * turned

    def joint(x: Floats) -> Floats:
        return 4.0 * x + 3.0 * np.tanh(2.0 * x) + sliders(x, ((6.0, 0.12), (2.0, 0.15), (0.8, 0.16)))

    read = turned + _once_a_turn(turned, phase)
    noise = 0.008 * float(np.std(joint(read)))
    found = diagnose(signals_of(time, read, joint(turned) + 4.5 * noise, joint(read), 1, noise))
    assert set(found.verdict) == {"encoder_eccentricity", "torque_offset"}


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize("stroke", [1.5, 1.7])
def test_an_error_that_comes_once_a_turn_is_told_on_half_a_turn(stroke: float) -> None:
    time, turned = swelling()
    turned = stroke / np.max(np.abs(turned)) * turned

    def joint(x: Floats, stiffer: float = 1.0) -> Floats:
        friction = sliders(x, ((6.0, 0.12), (2.0, 0.15), (0.8, 0.16)))
        return stiffer * (4.0 * x + 0.5 * x**3) + friction / stiffer

    read = turned + _once_a_turn(turned, 0.4)
    simulated = joint(read, 1.0 if stroke < 1.6 else 1.04)
    found = diagnose(signals_of(time, read, joint(turned), simulated, 1, 0.006 * float(np.std(simulated))))
    assert [name for name in found.verdict if name != "miscalibration"] == ["encoder_eccentricity"]
    assert "once a turn" in found.effects[0].law
    assert "periods" not in found.effects[0].parameters


def _once_a_turn(angle: Floats, phase: float) -> Floats:
    """Error of an eccentric ring at a true angle, rad, and a second harmonic, shape (n,); zero at home."""
    return np.asarray(0.1 * (np.sin(angle + phase) - np.sin(phase)) + 0.015 * (np.sin(2.0 * angle + 1.0) - np.sin(1.0)))


@pytest.mark.thorough
def test_a_law_that_was_chosen_beside_what_is_dropped_is_chosen_again() -> None:
    """An encoder error whose mean a torque offset hid needed an offset of the deflection besides."""
    case, found = developed(13055, "slip", "bouc-wen", "varied")
    assert set(case.effects) == {"encoder_eccentricity", "torque_offset"}
    assert set(found.verdict) == set(case.effects)


def test_effects_that_mostly_cancel_are_named_where_they_close_the_gap_by_themselves() -> None:
    case, found = developed(13188, "slip", "bouc-wen", "varied")
    assert set(case.effects) == {"viscous_friction", "sensor_delay"}
    assert found.choice.features["largest"] > 2.0 * found.choice.features["gap"]
    assert set(found.verdict) == set(case.effects)


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize(
    ("effects", "ratio", "motion", "seed"),
    [
        (("viscous_friction", "sensor_delay"), 4.0, "rich", 5_000_222),
        (("torque_offset", "deflection_offset"), 8.0, "sweeps", 5_000_849),
    ],
)
def test_effects_that_cancel_until_little_more_than_noise_is_left_are_named(
    effects: tuple[str, ...], ratio: float, motion: str, seed: int
) -> None:
    """What is left is so near the noise that they cannot be seen to close almost all of it."""
    found = diagnose(make(Case("slip", effects, ratio, 0.0, motion, seed)).signals)
    features = found.choice.features
    assert features["gap"] < 3.0
    assert features["largest"] > 2.0 * features["gap"]
    assert features["closed_alone"] < 0.95
    assert set(found.verdict) == set(effects)


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize(
    ("effects", "seed"),
    [
        (("stiffness_asymmetry", "cyclic_softening"), 5_000_369),
        (("cyclic_softening", "load_dependent_friction"), 5_000_825),
    ],
)
def test_two_effects_do_not_lose_to_two_others_for_a_simulator_that_they_do_not_need(
    effects: tuple[str, ...], seed: int
) -> None:
    """Beside a simulator that is off they fit a trace better than beside an exact one, and paid the price of that."""
    found = diagnose(make(Case("slip", effects, 4.0, 0.0, "sweeps", seed)).signals)
    assert set(found.verdict) == set(effects)


@pytest.mark.parametrize("factor", [0.92, 1.05])
def test_a_pedal_that_is_pressed_one_way_has_a_gain_and_no_stiffer_side(factor: float) -> None:
    """All of its torque is positive: a factor on that is one on the torque."""
    time, x = rich_motion()
    pressed = 0.6 + 0.5 * x
    y_sim = 3.0 * pressed + 2.0 * pressed**3 + sliders(pressed, ((5.0, 0.1), (2.0, 0.2)))
    rubs = 0.25 * np.tanh(np.gradient(pressed, time) / 0.02)
    found = diagnose(signals_of(time, pressed, factor * y_sim + rubs, y_sim, noise_level=0.03))
    assert set(found.verdict) == {"torque_gain", "coulomb_friction"}


def test_effects_far_larger_than_the_gap_that_cancel_are_the_less_likely() -> None:
    time, x = rich_motion()
    y_sim = spring(x)
    evidence = diagnose(signals_of(time, x, spring(x + 0.06) - 0.25, y_sim)).evidence
    shapes = {"constant": (), "positive": (0.06,)}
    terms = [
        Term(effect, form, shapes[form.name])
        for effect in (TorqueOffset(), DeflectionOffset())
        for form in effect.forms(evidence.scene)
        if form.name in shapes
    ]
    both = evidence.fit(terms)
    sizes = [rms(both.part(name)) for name in both.names]
    gap = rms(both.signal)
    assert len(sizes) == 2
    assert min(sizes) > 2.0 * gap
    assert prior(evidence, both, max(sizes)) - prior(evidence, both, gap) > 50.0
