"""Effects that act inside the joint, on its spring or its friction alone, and one factor or several errors of its parameters."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from joints import sliders
from scipy.signal import lfilter
from slider_joint import (
    ELEMENTS,
    NOISE,
    SIGN,
    SPEED,
    STEP,
    TIME,
    TRAVEL,
    Floats,
    X,
    diagnosed,
    friction,
    friction_that_is_off,
    joint,
    lagged,
    signals,
    spring,
)

from hystbench import models
from hystbench.diagnosis.delivery import deliver
from hystbench.diagnosis.diagnosis import diagnose
from hystbench.diagnosis.emulator.emulation import SimulatorScene, emulate
from hystbench.diagnosis.emulator.generalised import Generalised, motion_of, spring_of
from hystbench.diagnosis.emulator.kinds import KINDS
from hystbench.diagnosis.emulator.motion import Extent
from hystbench.diagnosis.operators.memory import plays
from hystbench.diagnosis.recording.signals import Signals

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
    assert np.std(scene.stronger_at(np.full(X.size, gain)) - change) < 0.15 * np.std(change)


def slid(more: Floats) -> Floats:
    """Sliders that slide at ``more`` (n,) times their level and are as stiff as ever."""
    elastic, limit = (np.array(values) for values in zip(*ELEMENTS, strict=True))
    state, out = np.zeros(len(ELEMENTS)), np.empty_like(X)
    for k, step in enumerate(np.diff(X, prepend=0.0)):
        state = np.clip(state + step, -more[k] * limit / elastic, more[k] * limit / elastic)
        out[k] = elastic @ state
    return out


@pytest.mark.thorough(but_one_in=3)
@pytest.mark.parametrize("part", ["the friction's strength", "the stiffness"])
@pytest.mark.parametrize("drift", [-0.4, 0.8])
def test_what_changes_much_inside_the_joint_is_followed_all_the_way(part: str, drift: float) -> None:
    more = 1.0 + drift * TIME / TIME[-1]
    # Each element by its stretch, which a stiffness that changes leaves as it is.
    real = more * (spring(X) + slid(1.0 / more)) if part == "the stiffness" else spring(X) + slid(more)
    found = diagnosed(real)
    assert found.verdict == ["thermal_drift"]
    assert found.closed_in_all > 0.99
    effect = next(effect for effect in found.effects if effect.name == "thermal_drift")
    assert effect.law == f"stiffness, linear, of {part}"
    assert effect.parameters["stiffness_drift"] * TIME[-1] == pytest.approx(drift, rel=0.05)


@pytest.mark.parametrize("name", [name for name, kind in KINDS.items() if kind.yielding])
def test_an_element_at_one_level_throughout_has_that_strength_at_the_same_stiffness(name: str) -> None:
    kind, motion = KINDS[name], motion_of(signals(joint(X)))
    sizes = kind.sizes(Extent(float(np.max(np.abs(X))), float(np.std(SPEED)), STEP, float(TIME[-1])))[::7]
    assert kind.yielding is not None
    for level in (1.0, 1.4, 0.6):
        stronger = sizes * np.where(np.arange(kind.width) == 0, level, 1.0)
        wanted = kind.columns(motion, stronger)
        held = kind.yielding(motion, sizes, np.full(X.size, level))
        np.testing.assert_allclose(held, wanted, atol=1e-4 * float(np.max(np.abs(wanted))))


def slow(pace: float, curve: Callable[[Floats], Floats]) -> Floats:
    return curve(np.abs(SPEED) / pace)


EXCESS: dict[str, Callable[[Floats], Floats]] = {
    "Gauss": lambda ratio: np.exp(-(ratio**2)),
    "exponential": lambda ratio: np.exp(-ratio),
    "hyperbola": lambda ratio: 1.0 / (1.0 + ratio),
}


@pytest.mark.parametrize("curve", EXCESS)
def test_strength_that_changes_within_a_swing_is_followed_sample_by_sample(curve: str) -> None:
    scene = SimulatorScene(signals(joint(X)), emulate(signals(joint(X)), None))
    gain = 0.8 * slow(0.4, EXCESS[curve])
    change = slid(1.0 + gain) - friction(X)
    assert np.std(scene.stronger_at(gain) - change) < 0.1 * np.std(change)


@pytest.mark.parametrize(("curve", "pace"), [("Gauss", 0.1), ("exponential", 0.5), ("hyperbola", 0.5)])
def test_elements_that_slide_later_the_slower_they_move_have_stribeck_friction(curve: str, pace: float) -> None:
    found = diagnosed(spring(X) + slid(1.0 + 0.7 * slow(pace, EXCESS[curve])))
    assert found.verdict == ["stribeck_friction"]
    assert found.effects[0].law.endswith("inside the joint")
    assert found.closed_in_all > 0.99


def _built_up(more: Floats, share_of_the_way: Callable[[float], float]) -> Floats:
    """Stretch of an element of unit stiffness that saturates at 0.12 rad times ``more`` (n,); how much of a way bends it goes with its
    stretch over that in the direction of the motion."""
    z, out, parts = 0.0, np.zeros(X.size), 20
    for k, step in enumerate(np.diff(X)):
        for _ in range(parts):
            z += step / parts * share_of_the_way(np.sign(step) * z / (0.12 * more[k + 1]))
        out[k + 1] = z
    return out


SMOOTH: dict[str, Callable[[float], float]] = {
    "Bouc-Wen": lambda into: 1.0 - (0.6 * np.sign(into) + 0.4) * abs(into) ** 1.5,
    "Dahl": lambda into: float(np.sign(1.0 - into) * abs(1.0 - into) ** 0.7),
}


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize("element", SMOOTH)
def test_elements_that_yield_smoothly_and_later_the_slower_they_move_have_stribeck_friction(element: str) -> None:
    usual, later = (
        6.0 * _built_up(1.0 + rise * slow(0.3, EXCESS["exponential"]), SMOOTH[element]) for rise in (0.0, 0.4)
    )
    found = diagnose(signals(spring(X) + later, y_sim=spring(X) + usual))
    assert found.verdict == ["stribeck_friction"]
    assert found.effects[0].law.endswith("inside the joint")
    assert found.closed_in_all > 0.98


def test_elements_that_slide_later_the_more_they_are_loaded_have_friction_by_load() -> None:
    load = np.abs(spring(X))
    found = diagnosed(spring(X) + slid(1.0 + 0.25 * load / load.max()))
    assert found.verdict == ["load_dependent_friction"]
    assert found.effects[0].law == "inside the joint"
    assert found.closed_in_all > 0.99


WORN, WARM = TRAVEL / TRAVEL[-1], 1.0 - np.exp(-TIME / 9.0)


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize(
    ("change", "cause", "of_spring", "of_friction"),
    [(WORN, "cyclic_softening", -0.1, -0.5), (1.0 - np.exp(-2.0 * WORN), "cyclic_softening", -0.1, -0.5),
     (WARM, "thermal_drift", -0.1, -0.5), (WARM, "thermal_drift", -0.15, 0.4)],
    ids=["wear", "wear that ends", "a joint that warms up", "a spring that warms up and pads that grip"],
)  # fmt: skip
def test_spring_and_strength_that_change_with_one_clock_but_not_alike_have_one_cause(
    change: Floats, cause: str, of_spring: float, of_friction: float
) -> None:
    found = diagnosed(spring(X) * (1.0 + of_spring * change) + slid(1.0 + of_friction * change))
    assert found.verdict == [cause]
    assert found.closed_in_all > 0.995
    assert found.effects[0].law.endswith("of spring and friction's strength")
    kind = "softening" if cause == "cyclic_softening" else "drift"
    told = found.effects[0].parameters
    assert told[f"friction_{kind}"] / told[f"spring_{kind}"] == pytest.approx(of_friction / of_spring, rel=0.05)


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


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize("rest", [-1.2, 0.9])
def test_what_relaxes_from_where_the_joint_had_rested_before_needs_no_offset_besides(rest: float) -> None:
    sim, kept = joint(X), np.exp(-STEP / 1.5)
    relaxed = lfilter([1.0 - kept], [1.0, -kept], sim - rest)
    found = diagnose(signals(sim - 0.12 * relaxed))
    assert found.verdict == ["stress_relaxation"]
    assert found.effects[0].law == "from the torque down, since a rest"
    assert found.effects[0].parameters["rest"] == pytest.approx(rest, rel=0.1)
    assert found.closed_in_all > 0.99


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


def hard_spring(x: Floats) -> Floats:
    return 2.0 * x + 3.0 * x**3


SPRING, PLAYS = hard_spring(X), plays(X, np.array([0.05, 0.15, 0.3])) @ np.array([1.0, 0.8, 0.7])
INSIDE = {
    "plays that wear": ("cyclic_softening", SPRING + PLAYS * (0.6 + 0.4 * np.exp(-2.0 * TRAVEL / TRAVEL[-1]))),
    "plays that warm up": ("thermal_drift", SPRING + PLAYS * (0.6 + 0.4 * np.exp(-TIME / 9.0))),
    "a spring that is stiff at first": ("stress_relaxation", 1.2 * SPRING + PLAYS - 0.2 * lagged(SPRING, 0.8)),
    "a spring that gives way": ("stress_relaxation", SPRING + PLAYS - 0.15 * lagged(SPRING, 2.0)),
    "a spring that differs by side": ("stiffness_asymmetry", SPRING * np.where(X > 0.0, 1.12, 1.0) + PLAYS),
    "contacts that the spring presses": ("load_dependent_friction", SPRING + PLAYS + 0.1 * np.abs(SPRING) * SIGN),
}
"""What changes inside a joint of plays, whose slope an emulator by sliders counts to the spring."""


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize("law", INSIDE)
def test_what_acts_on_a_part_that_the_emulator_does_not_tell_leaves_nothing(law: str) -> None:
    effect, real = INSIDE[law]
    found = diagnose(signals(real, y_sim=SPRING + PLAYS))
    assert found.verdict == [effect]
    assert found.choice.features["in_sample_left"] < 0.02


@pytest.mark.thorough(but_one_in=3)
@pytest.mark.parametrize("law", ["plays that wear", "a spring that is stiff at first", "a spring that differs by side"])
def test_a_gain_beside_what_acts_on_such_a_part_is_told(law: str) -> None:
    effect, real = INSIDE[law]
    assert set(diagnose(signals(1.06 * real, y_sim=SPRING + PLAYS)).verdict) == {effect, "torque_gain"}


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize("gain", [1.0, 1.05])
def test_a_softly_engaging_spring_that_makes_no_torque_at_zero_needs_no_errors_of_the_simulator(gain: float) -> None:
    engaging = 0.05 * (np.logaddexp(0.0, X / 0.05) - np.log(2.0))
    found = diagnosed(gain * (joint(X) + 0.6 * engaging))
    assert set(found.verdict) == {"stiffness_asymmetry"} | ({"torque_gain"} if gain > 1.0 else set())
    assert found.choice.features["in_sample_left"] < 0.1


# ---- one factor, or several errors -------------------------------------------------------------------------------------


def test_one_factor_is_a_gain_and_several_errors_are_a_miscalibration() -> None:
    assert diagnosed(1.05 * joint(X)).verdict == ["torque_gain"]
    several = 1.05 * 4.0 * X + 0.96 * 0.6 * X**3 + friction_that_is_off()
    assert diagnosed(several).verdict == ["miscalibration"]
    assert diagnosed(several, exclude=("torque_gain",)).verdict == ["miscalibration"]


@pytest.mark.thorough(but_one_in=2)
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


@pytest.mark.thorough
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
