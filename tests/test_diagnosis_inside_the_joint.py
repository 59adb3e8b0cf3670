"""Effects that act inside the joint, on its spring or its friction alone, and laws as other laboratories write them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from joints import sliders
from motions import swelling
from numpy.typing import NDArray
from scipy.signal import lfilter, lsim

from hystbench import models
from hystbench.diagnosis.delivery import deliver
from hystbench.diagnosis.diagnosis import diagnose
from hystbench.diagnosis.emulator.emulation import SimulatorScene, emulate
from hystbench.diagnosis.emulator.generalised import Generalised, spring_of
from hystbench.diagnosis.recording.hum import hum
from hystbench.diagnosis.recording.roughness import roughness
from hystbench.diagnosis.recording.signals import Signals
from hystbench.diagnosis.result import Diagnosis
from hystbench.diagnosis.wording import sentence
from hystbench.reports.diagnosis_page import write_diagnosis

Floats = NDArray[np.float64]
NOISE = 0.012
STEP = 0.01
ELEMENTS = ((6.0, 0.12), (2.0, 0.15), (0.8, 0.16))


def spring(x: Floats) -> Floats:
    return 4.0 * x + 0.6 * x**3


def friction(x: Floats) -> Floats:
    return sliders(x, ELEMENTS)


def joint(x: Floats) -> Floats:
    return spring(x) + friction(x)


TIME, X = swelling()
SPEED = np.gradient(X, TIME)
ACCELERATION = np.gradient(SPEED, TIME)
TRAVEL = np.cumsum(np.abs(np.diff(X, prepend=X[0])))
SIGN = np.tanh(SPEED / 0.02)


def signals(y_real: Floats, seed: int = 5, y_sim: Floats | None = None) -> Signals:
    noise = NOISE * np.random.default_rng(seed).standard_normal(X.size)
    return Signals(TIME, X, y_real + noise, joint(X) if y_sim is None else y_sim, [slice(0, X.size)], {})


def friction_that_is_off() -> Floats:
    """Each slider's stiffness and level by an error of its own."""
    return sliders(X, [(k * s, f * s) for (k, f), s in zip(ELEMENTS, (1.05, 0.96, 1.04), strict=True)])


def diagnosed(y_real: Floats, exclude: tuple[str, ...] = ()) -> Diagnosis:
    return diagnose(signals(y_real), exclude=exclude)


def gear(driving: float, driven: float) -> Floats:
    lost = np.abs(joint(X)) * SIGN
    return joint(X) + lost * np.where(SIGN * joint(X) > 0.0, driving, driven)


def gap_off_centre(middle: float, half: float) -> Floats:
    return joint(X - np.clip(X - middle, -half, half) + np.clip(-middle, -half, half))


def ahead(half: float) -> Floats:
    """How far the motion is ahead of what it drags through a clearance of ±``half``."""
    at, out = 0.0, np.zeros_like(X)
    for i, x in enumerate(X):
        at = min(max(at, x - half), x + half)
        out[i] = x - at
    return out


def swinging(inertia: float, frequency: float, damping: float) -> Floats:
    """Torque of a mass that swings on a compliance driven by the motion, from its equation of motion."""
    mass = ([inertia * frequency**2, 0.0, 0.0], [1.0, 2.0 * damping * frequency, frequency**2])
    return np.asarray(lsim(mass, X, TIME)[1])


def creeping(stiffness: float, tau: float, power: float, substeps: int = 20) -> Floats:
    """A spring behind a dashpot that yields with a power of its load, by small steps."""
    load, out = 0.0, np.zeros_like(X)
    for i in range(1, X.size):
        for _ in range(substeps):
            load += (X[i] - X[i - 1]) / substeps - load / tau * abs(load) ** (power - 1.0) * STEP / substeps
        out[i] = stiffness * load
    return out


def creeping_in_series(stiffness: float, tau: float, substeps: int = 4) -> Floats:
    """The same joint behind a spring and a dashpot side by side, which its torque stretches."""
    crept, place, force, out = 0.0, 0.0, np.zeros(3), np.zeros_like(X)
    elastic, limit = (np.array(part) for part in zip(*ELEMENTS, strict=True))
    for i in range(1, X.size):
        for k in range(substeps):
            before, place = place, X[i - 1] + (X[i] - X[i - 1]) * (k + 1) / substeps - crept
            force = np.clip(force + elastic * (place - before), -limit, limit)
            torque = 4.0 * place + 0.6 * place**3 + force.sum()
            crept += STEP / substeps * (torque / stiffness - crept) / tau
        out[i] = torque
    return out


def yielding(y: Floats, tau: float, level: float, substeps: int = 20) -> Floats:
    """What of ``y`` a dashpot by Eyring has let go, which yields the faster the more it is loaded over ``level``."""
    gone, out = 0.0, np.zeros_like(y)
    for i in range(1, y.size):
        for k in range(substeps):
            load = y[i - 1] + (y[i] - y[i - 1]) * k / substeps - gone
            gone += STEP / substeps / tau * level * np.sinh(load / level)
        out[i] = gone
    return out


def rubbed_warm(tau: float) -> Floats:
    """Temperature by friction's losses against cooling, from 0 to about 1."""
    power = np.abs(friction(X) * SPEED)
    warm = lfilter([STEP / tau], [1.0, STEP / tau - 1.0], power)
    return np.asarray(warm / warm.max())


def soft_limit(y: Floats, limit: float) -> Floats:
    return np.where(y < 0.0, y / (1.0 + np.abs(y / limit) ** 6.0) ** (1.0 / 6.0), y)


LAWS: dict[str, tuple[str, Callable[[], Floats]]] = {
    "warm grease": ("thermal_drift", lambda: spring(X) + friction(X) * (1.0 - 0.5 * (1.0 - np.exp(-TIME / 9.0)))),
    "room temperature": ("thermal_drift", lambda: joint(X) * (1.0 + 0.06 * np.sin(2.0 * np.pi * TIME / 30.0))),
    "a spring that wears": ("cyclic_softening", lambda: spring(X) * (1.0 - 0.15 * np.sqrt(TRAVEL / TRAVEL[-1])) + friction(X)),
    "a quadratic spring": ("stiffness_asymmetry", lambda: joint(X) + 0.35 * X**2),
    "a gap off the centre": ("backlash", lambda: gap_off_centre(0.2, 0.05)),
    "keys that are loose behind the bearings": ("backlash", lambda: spring(X - ahead(0.02)) + friction(X)),
    "a gap off the centre behind the seals": (
        "backlash", lambda: spring(X - np.clip(X - 0.6, -0.1, 0.1) - 0.1) + friction(X)
    ),
    "a gap of which one flank is zero": ("backlash", lambda: joint(X - np.clip(X - 0.2, -0.05, 0.05))),
    "a coupling that gives way before the bearings": (
        "torque_saturation", lambda: np.clip(spring(X), -3.3, 3.3) + friction(X)
    ),
    "a bore that narrows both ways": ("viscous_friction", lambda: joint(X) + 0.05 * (1.0 + 1.5 * X**2) * SPEED),
    "a rope that rubs under tension": (
        "load_dependent_friction", lambda: joint(X) + 0.08 * np.maximum(joint(X), 0.0) * SIGN
    ),
    "teeth that spread under load": ("load_dependent_friction", lambda: joint(X) + 0.03 * np.abs(joint(X)) ** 1.25 * SIGN),
    "damage by large strokes": (
        "cyclic_softening", lambda: joint(X) * (1.0 - 0.1 * np.cumsum(X**2 * np.abs(SPEED)) / np.sum(X**2 * np.abs(SPEED)))
    ),
    "a polymer that yields under load": ("stress_relaxation", lambda: joint(X) - 0.12 * yielding(spring(X), 2.0, 1.5)),
    "thinning grease": ("viscous_friction", lambda: joint(X) + 0.15 * np.arcsinh(SPEED / 0.6)),
    "saturating grease": ("viscous_friction", lambda: joint(X) + 0.2 * np.arctan(SPEED / 0.9)),
    "a gear's efficiency": ("load_dependent_friction", lambda: gear(0.1, 0.06)),
    "a capstan": ("load_dependent_friction", lambda: joint(X) + 0.08 * np.abs(spring(X)) * SIGN),
    "a bridge that shifted soon": ("torque_offset", lambda: joint(X) + 0.15 * (TIME > 1.7)),
    "a preloaded spring": ("deflection_offset", lambda: spring(X + 0.08) + friction(X)),
    "a preload that settles": (
        "deflection_offset", lambda: spring(X + 0.08 * (1.0 - 0.35 * np.exp(-TIME / 1.5))) + friction(X)
    ),
    "unequal directions": ("coulomb_friction", lambda: joint(X) + 0.25 * (SIGN + 0.12 * np.abs(SIGN))),
    "a filter behind a bus": (
        "sensor_delay",
        lambda: lfilter([0.4], [1.0, -0.6], np.interp(TIME - 0.02, TIME, joint(X))),
    ),
    "a linkage": ("inertia", lambda: joint(X) + 0.012 * (1.0 + 0.8 * X) * ACCELERATION + 0.5 * 0.012 * 0.8 * SPEED**2),
    "a mass that comes along on one side": ("inertia", lambda: joint(X) + 0.015 * (1.0 + 0.9 * X) * ACCELERATION),
    "a damper with a valve": ("viscous_friction", lambda: joint(X) + np.where(SPEED > 0.0, 0.12, 0.03) * SPEED),
    "a bore that narrows": ("viscous_friction", lambda: joint(X) + 0.08 * (1.0 + 0.8 * X) * SPEED),
    "a belt that creeps under load": ("stress_relaxation", lambda: joint(X) + creeping(0.5, 0.4, 2.6)),
    "a rubber mount": ("stress_relaxation", lambda: creeping_in_series(60.0, 0.8)),
    "churning oil": ("viscous_friction", lambda: joint(X) + 0.05 * SPEED + 0.02 * SPEED**3),
    "heat that soaks in": ("thermal_drift", lambda: joint(X) * (1.0 - 0.06 * np.sqrt(TIME / TIME[-1]))),
    "grease that thins steadily": ("thermal_drift", lambda: spring(X) + friction(X) * (1.0 - 0.4 * TIME / TIME[-1])),
    "damage that grows": ("cyclic_softening", lambda: joint(X) * (1.0 - 0.08 * (TRAVEL / TRAVEL[-1]) ** 2)),
    "a spring that wears steadily": ("cyclic_softening", lambda: spring(X) * (1.0 - 0.08 * TRAVEL / TRAVEL[-1]) + friction(X)),
    "a side that hardens steeply": ("stiffness_asymmetry", lambda: joint(X) + 0.6 * np.maximum(X, 0.0) ** 3),
    "a spring that slackens on the way back": (
        "stiffness_asymmetry", lambda: spring(X) * np.where(X > 0.0, 1.08, 0.98) + friction(X)
    ),
    "a spring that stiffens across": ("stiffness_asymmetry", lambda: spring(X) * (1.0 + 0.08 * X) + friction(X)),
    "a spring that stiffens under load": ("stiffness_asymmetry", lambda: spring(X) * np.where(joint(X) > 0.0, 1.08, 1.0) + friction(X)),
    "a mass on a compliant shaft": ("inertia", lambda: joint(X) + swinging(0.02, 9.0, 0.05)),
    "spring and grease that warm up": (
        "thermal_drift",
        lambda: spring(X) * (1.0 + 0.05 * (np.exp(-TIME / 9.0) - 1.0)) + friction(X) * (1.0 + 0.5 * (np.exp(-TIME / 9.0) - 1.0)),
    ),
    "a spring that friction heats": ("thermal_drift", lambda: spring(X) * (1.0 - 0.3 * rubbed_warm(15.0)) + friction(X)),
    "a sensor that friction heats": ("thermal_drift", lambda: joint(X) - 0.25 * rubbed_warm(4.0)),
    "a soft limit on one side": ("torque_saturation", lambda: soft_limit(joint(X), 2.6)),
    "unequal limits": ("torque_saturation", lambda: np.clip(joint(X), -1.9, 2.4)),
    "a sensor's compression": ("torque_gain", lambda: joint(X) * (1.12 - 0.01 * np.abs(joint(X)))),
}  # fmt: skip


@pytest.mark.parametrize("law", LAWS)
def test_a_law_of_another_hand_is_named(law: str) -> None:
    expected, made = LAWS[law]
    assert diagnosed(made()).verdict == [expected]


@pytest.mark.parametrize(("frequency", "verdict"), [(14.8, "unknown"), (20.0, "inertia")])
def test_a_mass_that_resonates_near_the_motions_band_is_no_inertia(frequency: float, verdict: str) -> None:
    # The fastest tone is at 10 rad/s.
    begun = 1.0 - np.exp(-TIME)
    x = (0.5 * np.sin(1.1 * TIME) + 0.3 * np.sin(0.37 * TIME) + 0.05 * np.sin(10.0 * TIME)) * begun
    mass = ([0.02 * frequency**2, 0.0, 0.0], [1.0, 0.1 * frequency, frequency**2])
    real = joint(x) + np.asarray(lsim(mass, x, TIME)[1]) + NOISE * np.random.default_rng(1).standard_normal(x.size)
    assert diagnose(Signals(TIME, x, real, joint(x), [slice(0, x.size)], {})).verdict == [verdict]


@pytest.mark.parametrize(
    "law",
    [
        "a spring that slackens on the way back",
        "a spring that stiffens across",
        "a spring that stiffens under load",
        "churning oil",
        "grease that thins steadily",
        "a spring that wears steadily",
    ],
)
def test_a_law_that_is_known_leaves_nothing(law: str) -> None:
    found = diagnosed(LAWS[law][1]())
    assert found.effects[0].adequacy == "adequate"
    assert found.choice.features["in_sample_left"] < 0.1


# ---- the simulator's parts ---------------------------------------------------------------------------------------------


def test_the_emulator_tells_the_spring_from_the_friction() -> None:
    scene = SimulatorScene(signals(joint(X)), emulate(signals(joint(X)), None))
    assert np.std(scene.spring - spring(X)) < 0.03 * np.std(spring(X))
    assert np.std(scene.friction - friction(X)) < 0.1 * np.std(friction(X))
    shifted = scene.spring_change(X + 0.05)
    assert np.std(shifted - (spring(X + 0.05) - spring(X))) < 0.1 * np.std(shifted)


@pytest.mark.parametrize("gain", [0.05, 0.5, -0.4])
def test_strength_is_the_change_with_the_level_at_which_friction_slides(gain: float) -> None:
    scene = SimulatorScene(signals(joint(X)), emulate(signals(joint(X)), None))
    change = sliders(X, [(stiffness, (1.0 + gain) * limit) for stiffness, limit in ELEMENTS]) - friction(X)
    assert np.std(scene.stronger(gain) - change) < 0.15 * np.std(change)
    assert np.std(gain * scene.strength_about(np.full(X.size, gain)) - change) < 0.15 * np.std(change)


@pytest.mark.parametrize("part", ["the friction's strength", "the stiffness"])
@pytest.mark.parametrize("drift", [-0.4, 0.8])
def test_what_changes_much_inside_the_joint_is_followed_all_the_way(part: str, drift: float) -> None:
    gain = drift * TIME / TIME[-1]
    real = np.empty_like(X)
    state = np.zeros(len(ELEMENTS))
    elastic, limit = (np.array(values) for values in zip(*ELEMENTS, strict=True))
    for k, step in enumerate(np.diff(X, prepend=0.0)):
        more = 1.0 + gain[k]
        # Each element by its stretch, which a stiffness that changes leaves as it is.
        if part == "the stiffness":
            state = np.clip(state + step, -limit / elastic / more, limit / elastic / more)
            real[k] = more * (spring(X[k : k + 1])[0] + elastic @ state)
        else:
            state = np.clip(state + step, -more * limit / elastic, more * limit / elastic)
            real[k] = spring(X[k : k + 1])[0] + elastic @ state
    found = diagnosed(real)
    assert found.verdict == ["thermal_drift"]
    assert found.closed_in_all > 0.99
    effect = next(effect for effect in found.effects if effect.name == "thermal_drift")
    assert effect.law == f"stiffness, linear, of {part}"
    assert effect.parameters["stiffness_drift"] * TIME[-1] == pytest.approx(drift, rel=0.05)


@pytest.mark.parametrize("preload", [0.0, 1.5])
def test_what_the_spring_has_at_rest_is_its_preload(preload: float) -> None:
    parameters = Generalised(signals(joint(X), y_sim=joint(X) + preload)).parameters()
    assert spring_of(parameters, np.zeros(3)) == pytest.approx(np.full(3, preload), abs=0.02)


def test_what_relaxes_about_the_stiffness_that_the_simulator_has_is_no_miscalibration() -> None:
    relaxed = lfilter([STEP], [1.0, STEP - 1.0], spring(X))
    found = diagnose(signals(joint(X) + 0.1 * (0.5 * spring(X) - relaxed)))
    assert found.verdict == ["stress_relaxation"]


def test_a_spring_that_relaxes_with_its_preload_needs_no_offset_besides() -> None:
    relaxed = np.zeros_like(X)
    for tau in np.geomspace(0.3, 30.0, 8):
        kept = np.exp(-STEP / tau)
        relaxed += lfilter([1.0 - kept], [1.0, -kept], spring(X) + 1.5, zi=[1.5 * kept])[0] / 8.0
    found = diagnose(signals(joint(X) + 1.5 - 0.1 * relaxed, y_sim=joint(X) + 1.5))
    assert found.verdict == ["stress_relaxation"]


def test_what_relaxes_from_where_the_recording_began_needs_no_offset_besides() -> None:
    begun = slice(int(np.argmax(X)), X.size)
    time, x = TIME[begun], X[begun]
    sim = spring(x) + friction(X)[begun]
    kept = np.exp(-STEP / 1.2)
    relaxed = lfilter([1.0 - kept], [1.0, -kept], sim - sim[0])
    noise = NOISE * np.random.default_rng(5).standard_normal(x.size)
    found = diagnose(Signals(time, x, sim - 0.1 * relaxed + noise, sim, [slice(0, x.size)], {}))
    assert found.verdict == ["stress_relaxation"]
    assert found.effects[0].law.endswith("of its rise")


@pytest.mark.parametrize("pace", [0.01, 0.05])
def test_friction_that_knows_the_speed_alone_has_a_strength_and_its_damper_has_none(pace: float) -> None:
    def rigid(friction: Floats | float) -> Floats:
        return spring(X) + 0.05 * SPEED + friction * np.tanh(SPEED / pace)

    seen = signals(rigid(0.3), y_sim=rigid(0.3))
    scene = SimulatorScene(seen, emulate(seen, None))
    dry = 0.3 * np.tanh(SPEED / pace)
    assert np.std(scene.strength - dry) < 0.1 * np.std(dry)
    warm = 1.0 - np.exp(-TIME / 9.0)
    found = diagnose(signals(rigid(0.3 * (1.0 - 0.5 * warm)), y_sim=rigid(0.3)))
    assert found.verdict == ["thermal_drift"]
    assert found.choice.hypothesis.terms[0].form.name == "stiffness, exponential, of the friction's strength"


# ---- one factor, or several errors -------------------------------------------------------------------------------------


def test_one_factor_is_a_gain_and_several_errors_are_a_miscalibration() -> None:
    assert diagnosed(1.05 * joint(X)).verdict == ["torque_gain"]
    several = 1.05 * 4.0 * X + 0.96 * 0.6 * X**3 + friction_that_is_off()
    assert diagnosed(several).verdict == ["miscalibration"]
    assert diagnosed(several, exclude=("torque_gain",)).verdict == ["miscalibration"]


@pytest.mark.parametrize("seed", [2, 8])
def test_a_factor_that_errors_make_is_no_gain_where_they_do_better_without_it(seed: int) -> None:
    def leaf(stiffness: float, length: float, roll: float, damping: float, elastic: float, limit: float) -> Floats:
        # A leaf spring whose free length shortens as it rolls off: 4 % of the length make 12 % of the torque.
        free = length - 0.2 * roll * (np.sqrt(X**2 + 0.01) - 0.1)
        rubbing = sliders(X, [(6.0 * elastic, 0.12 * limit), (2.0 * elastic, 0.15 * limit)])
        return 3.0 * stiffness * X / free**3 + 0.05 * damping * SPEED + rubbing

    drawn = np.random.default_rng(seed)
    off = [1.0 + drawn.choice([-1, 1]) * drawn.uniform(0.03, 0.05) for _ in range(6)]
    found = diagnose(signals(leaf(*off), y_sim=leaf(*[1.0] * 6)))
    assert found.verdict == ["miscalibration"]


def test_one_factor_beside_an_effect_is_a_gain_and_several_errors_are_a_miscalibration() -> None:
    hard = -25.0 * np.maximum(-X - 0.85 * np.max(-X), 0.0)
    assert sorted(diagnosed(1.05 * joint(X) + hard).verdict) == ["end_stop", "torque_gain"]
    several = 1.05 * 4.0 * X + 0.96 * 0.6 * X**3 + friction_that_is_off()
    soft = 12.0 * np.maximum(X - 0.9 * np.max(X), 0.0)
    assert diagnosed(several + soft).verdict == ["end_stop", "miscalibration"]


def test_one_factor_without_a_gain_in_the_registry_is_an_effect_that_is_not_known() -> None:
    found = diagnosed(1.05 * joint(X), exclude=("torque_gain",))
    assert found.verdict == ["unknown"]
    assert found.choice.factor == pytest.approx(0.05, abs=0.002)
    assert any("one factor on the whole torque, 1.05" in note for note in found.notes)


def test_one_of_two_effects_that_do_the_same_beside_errors_is_ambiguous_and_not_unknown() -> None:
    # The spring is linear: a shift of its deflection is one of its torque, and neither is likely alone.
    offset = 0.2 * (1.0 - 0.15 * np.exp(-TIME / 0.4))
    found = diagnose(signals(0.96 * 4.0 * X + 1.03 * friction_that_is_off() + offset, 7, 4.0 * X + friction(X)))
    assert found.verdict[0] in {"torque_offset", "deflection_offset"}
    assert found.verdict[1:] == ["miscalibration"]
    assert found.ambiguous == [["deflection_offset", "torque_offset"]]


# ---- a hum -------------------------------------------------------------------------------------------------------------


def test_a_hum_that_passes_for_noise_is_told_with_its_frequency(tmp_path: Path) -> None:
    found = diagnosed(joint(X) + 0.05 * np.sin(2.0 * np.pi * 31.0 * TIME))
    assert found.verdict == ["unknown"]
    assert found.choice.hum == pytest.approx(31.0, abs=0.3)
    assert "hum" in sentence(found)
    assert any("shield or filter" in note for note in found.notes)
    write_diagnosis(found, tmp_path, None, ["real.csv"], ["sim.csv"])
    page = (tmp_path / "diagnosis.html").read_text(encoding="utf-8")
    assert "Nothing beyond the noise and the hum to locate" in page


@pytest.mark.parametrize("frequency", [49.97, 50.02, 49.4, 0.37 * 100.0])
def test_a_hum_is_told_where_the_sampling_makes_it_the_fastest_there_is(frequency: float) -> None:
    """Mains at 50 Hz, sampled at 100 Hz, changes its sign at every sample."""
    assert 1.0 / float(np.mean(np.diff(TIME))) == pytest.approx(100.0)
    recorded = signals(joint(X) + 0.05 * np.sin(2.0 * np.pi * frequency * TIME))
    assert hum(recorded) == pytest.approx(min(frequency, 100.0 - frequency), abs=0.3)


@pytest.mark.parametrize("seed", range(8))
def test_noise_does_not_hum(seed: int) -> None:
    white = signals(joint(X), seed)
    assert hum(white) == 0.0
    smooth = np.convolve(white.y_real - white.y_sim, np.ones(4) / 4.0, mode="same")
    assert hum(Signals(TIME, X, joint(X) + smooth, joint(X), [slice(0, X.size)], {})) == 0.0


# ---- roughness ---------------------------------------------------------------------------------------------------------


def passed_fast(amplitude: float, seed: int = 3) -> Signals:
    """Slow strokes, and fast ones that pass a fine ripple within a sample or two."""
    time = np.arange(6000) * STEP
    x = 0.4 * np.sin(0.3 * time) + 0.5 * np.sin(5.0 * time) * (time > 10.0)
    noise = NOISE * np.random.default_rng(seed).standard_normal(x.size)
    return Signals(time, x, joint(x) + amplitude * np.sin(200.0 * x) + noise, joint(x), [slice(0, x.size)], {})


def test_a_ripple_too_fine_for_the_samples_is_no_noise() -> None:
    found = diagnose(passed_fast(0.05))
    assert found.verdict == ["unknown"]
    assert found.choice.roughness > 2.0
    assert "while the joint moves" in sentence(found)
    assert any("record slow strokes" in note for note in found.notes)


@pytest.mark.parametrize("seed", range(8))
def test_noise_is_no_rougher_while_the_joint_moves(seed: int) -> None:
    assert roughness(passed_fast(0.0, seed)) == 0.0


def test_rounded_numbers_are_not_rough() -> None:
    time = np.arange(6000) * STEP
    held = 0.5 * np.clip(1.5 * np.sin(0.8 * time), -1.0, 1.0)
    seen = Signals(time, held, np.round(joint(held), 4), joint(held), [slice(0, time.size)], {})
    assert roughness(seen) == 0.0


def test_a_rough_deflection_is_not_taken_for_a_rough_torque() -> None:
    smooth = passed_fast(0.0)
    counted = np.round(smooth.x / 0.01) * 0.01
    seen = Signals(smooth.time, counted, smooth.y_real, joint(counted), smooth.runs, {})
    assert np.std(seen.gap) > 1.5 * np.std(smooth.gap)
    assert roughness(seen) == 0.0


# ---- spikes ------------------------------------------------------------------------------------------------------------


def spiked(share: float) -> Floats:
    rng = np.random.default_rng(8)
    struck = rng.choice(X.size, max(int(share * X.size), 1), replace=False)
    y = joint(X)
    y[struck] += rng.choice([-1.0, 1.0], struck.size) * rng.uniform(0.5, 3.0, struck.size)
    return y


def test_spikes_are_told_and_are_no_noise() -> None:
    found = diagnosed(spiked(0.01))
    assert found.verdict == ["unknown"]
    assert found.choice.spikes == pytest.approx(0.01, rel=0.1)
    assert "spikes in 1 % of the samples" in sentence(found)


def test_one_outlier_is_noted_and_is_no_gap() -> None:
    found = diagnosed(spiked(0.0))
    assert found.verdict == []
    assert any("stand out" in note for note in found.notes)


@pytest.mark.parametrize("seed", range(4))
def test_noise_with_heavy_tails_has_no_spikes(seed: int) -> None:
    noise = NOISE * np.random.default_rng(seed).standard_t(4, X.size)
    found = diagnose(Signals(TIME, X, joint(X) + noise, joint(X), [slice(0, X.size)], {}))
    assert found.verdict == []
    assert not any("stand out" in note for note in found.notes)


# ---- a model file that was fitted --------------------------------------------------------------------------------------


def damped(rate: float, damping: float) -> pd.DataFrame:
    time = np.arange(900) * 0.01 / rate
    x = 0.8 * np.sin(2.0 * np.pi * rate * 0.5 * time) * (1.0 - 0.5 * np.cos(2.0 * np.pi * rate * 0.11 * time))
    noise = 0.004 * np.random.default_rng(7).standard_normal(x.size)
    y = joint(x) + damping * np.gradient(x, time) + noise
    return pd.DataFrame({"time_s": time, "deflection_rad": x, "torque_nm": y})


def test_a_model_file_tells_whether_it_was_fitted(tmp_path: Path) -> None:
    fitted = models.get("prandtl-ishlinskii")().fit(X, joint(X))
    fitted.save(tmp_path / "fitted.json")
    assert models.load(tmp_path / "fitted.json").fitted_samples_ == X.size
    models.get("prandtl-ishlinskii").from_parameters(**fitted.parameters_).save(tmp_path / "given.json")
    assert models.load(tmp_path / "given.json").fitted_samples_ == 0


def test_what_a_fitted_model_file_lacks_is_found_though_it_took_a_part_of_it(tmp_path: Path) -> None:
    real = []
    for rate in (0.4, 4.0):
        real.append(tmp_path / f"real{rate}.csv")
        damped(rate, 0.3).to_csv(real[-1], index=False)
    both = pd.concat([pd.read_csv(file) for file in real])
    groups = np.repeat([0, 1], 900)
    model = models.get("prandtl-ishlinskii")().fit(both["deflection_rad"], both["torque_nm"], groups)
    model.save(tmp_path / "fitted.json")
    given = models.get("prandtl-ishlinskii").from_parameters(**model.parameters_)
    given.save(tmp_path / "given.json")

    def told(file: str) -> str:
        columns = {"x": None, "y": None, "time": None}
        return "\n".join(deliver(real, [tmp_path / file], None, None, (), 0, columns))

    off = "the simulator's own parameters"
    assert "comes from viscous friction" in told("fitted.json")
    assert off not in told("fitted.json")
    assert off in told("given.json")
