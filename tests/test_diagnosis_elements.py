"""Whether the emulator answers for what simulators of joints are made of."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from joints import sliders
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from simulators import (
    INTERVAL,
    JOINTS,
    Joint,
    damped_bristles,
    damper,
    kinked,
    lagging,
    metal,
    motion,
    rubber,
    strain_wave_gear,
    two_sliders,
)

from hystbench.diagnosis.corrected import CorrectedSimulator
from hystbench.diagnosis.diagnosis import diagnose
from hystbench.diagnosis.emulator import generalised
from hystbench.diagnosis.emulator.emulation import SimulatorScene, emulate
from hystbench.diagnosis.emulator.generalised import (
    Generalised,
    motion_beside,
    motion_of,
    predict_anew,
    predict_generalised,
    spring_of,
)
from hystbench.diagnosis.emulator.kinds import FRICTION_TABLE, KINDS, SPRING_TABLE
from hystbench.diagnosis.emulator.motion import Extent, Motion
from hystbench.diagnosis.emulator.placing import Choices, Placing
from hystbench.diagnosis.operators.memory import hyperbolic, plays
from hystbench.diagnosis.recording.noise import rms
from hystbench.diagnosis.recording.signals import Signals, differentiate
from hystbench.errors import InputError

Floats = NDArray[np.float64]


SECONDS = dict.fromkeys(JOINTS, 30.0) | dict.fromkeys(("looked up", "phase-changing", "antagonists"), 45.0)
"""Of a recording that tells each of the joints."""


def recorded(joint: Joint, real: Joint | None = None, seconds: float = 30.0) -> Signals:
    time, x = motion(seconds, 0.0, 1.0, 2.0)
    y = joint(time, x)
    noise = 0.002 * np.std(y) * np.random.default_rng(5).standard_normal(x.size)
    return Signals(time, x, (real or joint)(time, x) + noise, y, [slice(0, x.size)], {})


def begun_late(joint: Joint, before: float) -> Signals:
    """A simulator that had been in motion for ``before`` seconds, without a gap."""
    time, x = motion(60.0, 0.0, 1.0, 2.0)
    y, later = joint(time, x), time >= before
    return Signals(time[later] - before, x[later], y[later], y[later], [slice(0, int(later.sum()))], {})


@pytest.mark.thorough(but_one_in=3)
@pytest.mark.parametrize("name", JOINTS)
def test_answers_another_motion_as_the_simulator_would(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    joint, allowed = JOINTS[name]
    time, x = motion(40.0, 2.0, 0.5, 1.0)
    x *= 0.85
    wanted = joint(time, x)
    along = Motion(time, x, [slice(0, x.size)], lambda: differentiate(time, x)[1:])

    def error(found: Mapping[str, Any]) -> float:
        return float(np.std(predict_generalised(found, along) - wanted) / np.std(wanted))

    signals = recorded(joint, seconds=SECONDS[name])
    emulator = emulate(signals, None).split
    monkeypatch.setattr(generalised, "EMULATED", np.inf)
    plain = Generalised(signals).parameters()
    assert error(emulator) < min(allowed, 0.7 * error(plain))


@pytest.mark.thorough(but_one_in=7)
@pytest.mark.parametrize("name", JOINTS)
def test_simulator_of_any_kind_that_is_off_by_a_few_per_cent_is_a_miscalibration(name: str) -> None:
    joint, _ = JOINTS[name]
    found = diagnose(recorded(joint, lambda time, x: joint(time, x, 0.04), SECONDS[name]))
    assert found.verdict == ["miscalibration"]


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize("name", ["kinked", "pressed by a cam"])
def test_one_effect_that_explains_most_is_named_though_others_patch_what_its_law_misses(name: str) -> None:
    """A soft gap beside a simulator that is off, which several effects together explain better, in doubt of each."""
    joint, _ = JOINTS[name]
    found = diagnose(recorded(joint, lambda time, x: joint(time, x - 0.02 * np.tanh(x / 0.02), 0.05)))
    assert set(found.verdict) - {"miscalibration"} == {"backlash"}


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize("name", ["two sliders", "Maxwell slip"])
def test_a_factor_that_the_usual_errors_do_not_make_is_a_gain_beside_them(name: str) -> None:
    joint, _ = JOINTS[name]
    found = diagnose(recorded(joint, lambda time, x: 0.8 * joint(time, x, 0.03)))
    assert set(found.verdict) - {"miscalibration"} == {"torque_gain"}


def test_corners_that_yield_a_little_elsewhere_are_no_spikes_in_the_torque() -> None:
    # The simulator agrees to half a per cent: what stands out of the noise are its corners, not lost samples.
    found = diagnose(recorded(metal, lambda time, x: metal(time, x, 0.015)))
    assert found.choice.features["gap"] < 3.0
    assert found.verdict == []
    assert not any("stand out" in note for note in found.notes)


@pytest.mark.parametrize("begun", [False, True])
def test_memory_begins_at_zero_or_where_the_run_does(begun: bool) -> None:
    def joint(x: Floats) -> Floats:
        """Sliders at rest at zero, from where they come to the first sample, or there."""
        way = x - x[0] if begun else np.concatenate([np.linspace(0.0, x[0], 50), x])
        return 3.0 * x + sliders(way, ((6.0, 1.2), (4.0, 1.6)))[-x.size :]

    time, x = motion(60.0, 0.0, 1.0, 2.0)
    x = x + 0.35
    found = Generalised(Signals(time, x, joint(x), joint(x), [slice(0, x.size)], {}))
    wanted = joint(0.8 * x)
    first = slice(0, 100)
    # Until the motion turns, nothing else tells where the sliders began.
    assert np.std(
        predict_anew(found.parameters(), found.signals.interval, 0.8 * x)[first] - wanted[first]
    ) < 0.002 * np.std(wanted)
    base = {"model": "generalised", "parameters": json.loads(json.dumps(found.parameters(), default=np.ndarray.tolist))}
    kept = CorrectedSimulator.from_parameters(interval=INTERVAL, base=base, effects=[])
    for predicted in (found.predict(x), kept.predict(x)):
        assert np.max(np.abs(predicted - joint(x))) < 0.005 * np.std(joint(x))
    base["parameters"]["begun"] = "where it does"
    with pytest.raises(InputError, match="begun must be true or false"):
        CorrectedSimulator.from_parameters(interval=INTERVAL, base=base, effects=[])


def test_joint_of_an_engine_behind_a_servo_is_followed_to_a_thousandth() -> None:
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_string(
        """<mujoco><option timestep="0.001" integrator="implicitfast" gravity="0 0 0"/><worldbody>
        <body><inertial pos="0 0 0" mass="0.0001" diaginertia="1e-6 1e-6 1e-6"/>
        <joint name="q" type="hinge" stiffness="0.8" frictionloss="0.25" damping="0.01" armature="0.0013"/></body>
        </worldbody><actuator><position name="a" joint="q" kp="2.7" kv="0.03"/></actuator>
        <sensor><actuatorfrc actuator="a"/></sensor></mujoco>"""
    )

    def servo(time: Floats, x: Floats) -> Floats:
        data, torque = mujoco.MjData(model), []
        for target in np.interp(np.arange(0.0, time[-1] + 0.0005, 0.001), time, x):
            data.ctrl[0] = target
            mujoco.mj_step(model, data)
            torque.append(data.sensordata[0])
        return np.asarray(torque)[::10]

    found = Generalised(recorded(servo))
    assert found.error < 0.001
    time, x = motion(40.0, 2.0, 0.5, 1.0)
    wanted = servo(time, 0.85 * x)
    assert np.std(predict_anew(found.parameters(), found.signals.interval, 0.85 * x) - wanted) < 0.0015 * np.std(wanted)


def test_rotors_of_an_engine_that_swing_on_tendons_keep_their_swing() -> None:
    mujoco = pytest.importorskip("mujoco")
    rotor = (
        '<body pos="0 {0} 0"><joint name="r{0}" type="hinge" axis="0 0 1" frictionloss="{1}" damping="0.08" armature="0.06"/>'
        '<geom size="0.01" mass="1e-4"/></body>'
    )
    tendon = '<fixed stiffness="40"><joint joint="a" coef="1"/><joint joint="r{0}" coef="-1"/></fixed>'
    model = mujoco.MjModel.from_xml_string(
        f"""<mujoco><option timestep="0.002" integrator="implicitfast" gravity="0 0 0"/><worldbody><body><joint name="a"
        type="hinge" axis="0 0 1" stiffness="9"/><geom size="0.03" mass="1"/></body>{rotor.format(1, 1.5)}{rotor.format(2, 5.0)}
        </worldbody><tendon>{tendon.format(1)}{tendon.format(2)}</tendon></mujoco>"""
    )

    def engine(time: Floats, x: Floats) -> Floats:
        data, course, torque = mujoco.MjData(model), CubicSpline(time, x), []
        for now in np.arange(0.0, time[-1] + 0.001, 0.002):
            data.qpos[0], data.qvel[0] = course(now), course(now, 1)
            mujoco.mj_step(model, data)
            torque.append(-data.qfrc_passive[0])
        return np.asarray(torque)[::5]

    found = Generalised(recorded(engine))
    assert found.error < 3e-4
    time, x = motion(40.0, 2.0, 0.5, 1.0)
    wanted = engine(time, 0.85 * x)
    assert np.std(predict_anew(found.parameters(), found.signals.interval, 0.85 * x) - wanted) < 0.001 * np.std(wanted)


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize("before", [3.0, 13.0])
def test_what_a_simulator_remembers_of_a_motion_before_the_recording_is_not_looked_at(before: float) -> None:
    def joint(time: Floats, x: Floats) -> Floats:
        return 3.0 * x + sliders(x, ((6.0, 1.2), (4.0, 1.6)))

    signals = begun_late(joint, before)
    found = Generalised(signals)
    left = found.predict(signals.x) - signals.y_sim
    assert rms(left[~found.known]) > 0.01 * np.std(signals.y_sim)
    assert np.mean(found.known) > 0.7
    assert found.error < 0.001
    assert rms(left[found.known]) == pytest.approx(found.error * np.std(signals.y_sim[found.known]))
    assert emulate(signals, None).unknown == pytest.approx(np.mean(~found.known))
    # It is the same joint.
    time, x = motion(60.0, 0.0, 1.0, 2.0)
    y = joint(time, x)
    along = Motion(time, x, [slice(0, x.size)], lambda: differentiate(time, x)[1:])
    wanted = predict_generalised({**found.parameters(), "begun": False}, along)
    assert rms(wanted - y) < 0.002 * np.std(y)


@pytest.mark.thorough
def test_a_gap_where_the_simulator_still_remembers_what_was_before_is_not_judged() -> None:
    signals = begun_late(JOINTS["leaves"][0], 7.5)
    time, y = signals.time, signals.y_sim
    noise = 0.005 * np.std(y) * np.random.default_rng(3).standard_normal(y.size)
    found = diagnose(replace(signals, y_real=y + 0.2 * np.std(y) * np.exp(-time / 0.3) + noise))
    assert found.verdict == []
    first = float(time[found.signals.judged][0])
    assert 1.5 < first < 5.0
    assert any(
        f"the first {100.0 * first / time[-1]:.2g} % of the samples are not judged" in note for note in found.notes
    )


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize(("name", "before", "allowed"), [("leaves", 13.0, 0.0002), ("metal", 7.5, 0.007)])
def test_a_beginning_is_left_out_though_it_did_not_show_at_first_or_not_as_far(
    name: str, before: float, allowed: float
) -> None:
    found = Generalised(begun_late(JOINTS[name][0], before))
    assert np.mean(found.known) > 0.9
    assert found.error < allowed


def test_damper_moved_slowly_to_one_side_is_followed_though_it_seems_to_turn_the_other_way_round() -> None:
    time, along = motion(60.0, 0.0, 1.0, 2.0)
    x = np.interp(time / 5.0, time, along)
    x = 0.4 * (x - np.max(np.abs(x)) * (1.0 - np.exp(-time)))
    y = damper(time, x)
    found = Generalised(Signals(time, x, y, y, [slice(0, x.size)], {}))
    assert found.sign > 0.0
    assert found.error < 0.0005


def dahl(time: Floats, x: Floats) -> Floats:
    """Dahl friction of any exponent beside a spring that softens, explicit in small steps from rest at zero."""
    friction, before, out = 0.0, 0.0, np.zeros(x.size)
    for i, now in enumerate(x):
        step = (now - before) / 40
        for _ in range(40):
            friction += 30.0 * step * max(1.0 - friction * np.sign(step), 0.0) ** 1.6
        before, out[i] = now, friction
    return 3.0 * x - 0.8 * x**3 + out


def duhem(time: Floats, x: Floats) -> Floats:
    """Friction that relaxes towards a curve over the way, and builds up the faster the farther off the middle."""
    torque, before, out = 0.0, 0.0, np.zeros(x.size)
    for i, now in enumerate(x):
        step = (now - before) / 40
        for k in range(40):
            at = before + (k + 0.5) * step
            torque += 6.0 * abs(step) * (4.0 * at - 1.5 * at**3 - torque) + step * (5.0 + 0.9 * at**2)
        before, out[i] = now, torque
    return out


@pytest.mark.parametrize(("joint", "name"), [(duhem, "duhem"), (dahl, "a few Dahl sliders")])
def test_a_simulator_is_emulated_as_what_it_is_and_a_shifted_run_shows_in_its_friction(joint: Joint, name: str) -> None:
    signals = recorded(joint, lambda time, x: joint(time, x + 0.05))
    emulator = emulate(signals, None)
    assert emulator.name.removeprefix("generalised Prandtl-Ishlinskii with ") == name
    assert emulator.error < 0.002
    # From home to where it really is friction builds up before the first sample.
    change = emulator.predict(signals.x + 0.05) - emulator.predict(signals.x)
    wanted = joint(signals.time, signals.x + 0.05) - signals.y_sim
    assert wanted[0] > 5.0 * np.std(wanted[-1000:])
    assert np.max(np.abs(change - wanted)) < 0.05 * np.max(np.abs(wanted))
    assert diagnose(signals).verdict == ["deflection_offset"]


def test_sharp_sliders_are_found_where_they_yield_and_know_nothing_of_time() -> None:
    found = Generalised(recorded(two_sliders)).further
    # A mass with a very stiff spring would do as well, and would let a refit imitate damping.
    assert list(found) == ["a few sharp sliders"]
    assert sorted(found["a few sharp sliders"]["sizes"][:, 0]) == pytest.approx([0.75 / 12.5, 0.75 / 5.8], rel=0.01)


def test_what_is_placed_one_after_the_other_is_moved_together_to_where_it_is() -> None:
    """Two corners of a spring are not seen beside stops that stand in for friction, nor friction beside a spring without them."""
    found = Generalised(recorded(strain_wave_gear)).further
    assert found["a few Dahl sliders"]["sizes"] == pytest.approx(np.array([[0.07, 1.5]]), rel=0.01)
    for place in (0.25, 0.6):
        assert np.min(np.abs(found["a few corners"]["sizes"][:, 0] / place - 1.0)) < 0.005


@pytest.mark.parametrize("rate", [0.25, 0.5])
def test_loop_that_turns_the_other_way_is_no_damping_though_one_sine_cannot_tell(rate: float) -> None:
    time = np.arange(0.0, 30.0, INTERVAL)
    x = 0.8 * np.sin(2.0 * np.pi * rate * time)

    def lagging(x: Floats) -> Floats:
        return 6.0 * x - sliders(x, ((1.2, 0.1), (0.8, 0.25), (0.6, 0.4)))

    y = lagging(x)
    found = emulate(
        Signals(time, x, y + 0.01 * np.random.default_rng(0).standard_normal(x.size), y, [slice(0, x.size)], {}), None
    )
    moved = x - np.clip(x, -0.05, 0.05)
    wanted = lagging(moved) - y
    # Within the gap there is no speed; damping would vanish there at once.
    assert np.std(found.predict(moved) - found.predict(x) - wanted) < 0.1 * np.std(wanted)


@pytest.mark.parametrize("name", [name for name, kind in KINDS.items() if kind.together])
def test_elements_that_are_summed_as_they_come_are_their_columns_with_weights(name: str) -> None:
    rng = np.random.default_rng(2)
    time = np.cumsum(rng.choice([0.005, 0.01, 0.02], 900))
    x = np.cumsum(rng.standard_normal(900)) * 0.03
    seen = Motion(time, x, [slice(0, 500), slice(500, 900)], lambda: (np.gradient(x, time), np.zeros(900)))
    sizes = KINDS[name].sizes(Extent(float(np.max(np.abs(x))), 1.0, 0.01, float(time[-1])))
    weights = rng.standard_normal(len(sizes)) * (rng.random(len(sizes)) < 0.5)
    wanted = KINDS[name].columns(seen, sizes) @ weights
    assert KINDS[name].torque(seen, sizes, weights) == pytest.approx(wanted, abs=1e-9 * np.ptp(wanted))


def test_what_is_held_is_all_but_damping_mass_and_friction_by_speed() -> None:
    time, x = motion(30.0, 0.4, 2.0, 1.0)
    speed = np.gradient(x, time)

    def joint(x: Floats) -> Floats:
        return np.asarray(4.0 * x + sliders(x, ((3.0, 0.1), (2.0, 0.3))))

    y = joint(x) + 0.3 * speed + 0.8 * np.tanh(speed / 0.2)
    recording = Signals(time, x, y, y, [slice(0, x.size)], {})
    emulator = emulate(recording, None)
    moved = x - np.clip(x, -0.05, 0.05)
    wanted = joint(moved)
    # A model at hand answers for all of its torque at once: what drags is taken off.
    for known in (emulator, replace(emulator, parameters={"model": "another"})):
        scene = SimulatorScene(recording, known)
        assert np.std(scene.held_at(moved) - wanted) < 0.03 * np.std(wanted)
        assert np.std(scene.torque_at(moved) - wanted) > 0.1 * np.std(wanted)
    untimed = SimulatorScene(replace(recording, timed=False), emulator)
    assert untimed.held_at(moved) == pytest.approx(untimed.torque_at(moved))


def test_kinks_belong_to_the_spring_and_are_no_preload() -> None:
    emulator = emulate(recorded(kinked), None)
    assert "a few corners" in emulator.name
    x = np.array([-0.8, -0.3, 0.0, 0.3, 0.8])
    # Sliders that hardly ever slide may pass for springs and the other way round, but a kink is one of the spring.
    bent = np.diff(spring_of(emulator.split, x))
    assert spring_of(emulator.split, x)[2] == pytest.approx(0.0, abs=0.002 * np.std(kinked(x, x)))
    assert bent[[0, 3]] / 0.5 == pytest.approx(bent[[1, 2]] / 0.3 + 7.0 * 0.28 / 0.5, rel=0.1)


@pytest.mark.thorough(but_one_in=3)
@pytest.mark.parametrize(
    ("joint", "kind"),
    [
        (damper, "a few sliders behind dashpots"),
        (lagging, "lagging stops"),
        (damped_bristles, "a few Stribeck sliders"),
    ],
)
def test_without_a_clock_nothing_is_said_of_how_long_things_take(joint: Joint, kind: str) -> None:
    signals = recorded(joint)
    assert kind in Generalised(signals).further
    assert kind not in Generalised(replace(signals, timed=False)).further


def test_table_goes_on_as_it_ends() -> None:
    joint, _ = JOINTS["looked up"]
    signals = recorded(joint, seconds=SECONDS["looked up"])
    found = Generalised(signals)
    assert {SPRING_TABLE, FRICTION_TABLE} <= set(found.further)
    along = motion_of(signals)
    end, beyond = (replace(along, x=np.full_like(along.x, share * found.reach), course=along.x) for share in (1.0, 1.3))
    for name in (SPRING_TABLE, FRICTION_TABLE):
        sizes, weights = np.array(found.further[name]["sizes"]), np.array(found.further[name]["weights"])
        at_end = KINDS[name].torque(end, sizes, weights)
        assert KINDS[name].torque(beyond, sizes, weights) == pytest.approx(at_end)
        assert np.any(at_end != 0.0)


def test_rubber_of_a_simulator_that_goes_along_a_spline_begins_anew_where_that_overshoots_a_stop() -> None:
    time, random = np.arange(0.0, 60.0, INTERVAL), np.random.default_rng(4)
    # From place to place in half a second each, with a rest there, all of a sudden.
    places = np.repeat(random.uniform(-0.8, 0.8, 31), 2)
    x = np.interp(time, np.sort(np.concatenate([np.arange(31.0) * 2.0, np.arange(31.0) * 2.0 + 1.5])), places)
    x -= x[0]
    finely = np.arange(0.0, 59.99 + 1e-9, INTERVAL / 5)
    y = rubber(finely, CubicSpline(time, x)(finely))[::5]
    found = Generalised(Signals(time, x, y, y, [slice(0, x.size)], {}))
    assert found.error < 0.002
    assert "rubber along a spline" in found.further


@pytest.mark.parametrize("half", [0.01, 0.03, 0.1])
def test_rubber_along_a_spline_stays_where_a_clearance_holds_it(half: float) -> None:
    def moved(time: Floats) -> Floats:
        return 0.6 * np.sin(1.3 * time) + 0.3 * np.sin(2.9 * time)

    time, finely = np.arange(0.0, 60.0, INTERVAL), np.arange(0.0, 60.0 - 0.9 * INTERVAL, INTERVAL / 5)
    x, felt = moved(time), moved(finely)
    loose, held = plays(x, np.array([half]))[:, 0], plays(felt, np.array([half]))[:, 0]
    signals = Signals(time, x, x, x, [slice(0, x.size)], {})
    made = KINDS["rubber along a spline"].columns(motion_beside(signals, loose), np.array([[0.06]]))[:, 0]
    stiff, wanted = (0.06 * hyperbolic(path, 0.06)[::5] for path in (felt, held))
    assert rms(made - wanted) < 0.01 * rms(wanted - stiff)


def test_elements_that_share_sizes_are_not_placed_with_the_wrong_sign() -> None:
    signals = recorded(two_sliders)
    along, kind = motion_of(signals), KINDS["a few slip elements"]
    choices = Choices(Extent(signals.reach, float(np.std(signals.speed)), INTERVAL, 45.0), along)
    sizes = np.array([[0.05, 0.6, 0.4, 0.05, 1.0], [0.2, 0.6, 0.4, 0.05, 1.0], [0.5, 0.6, 0.4, 0.05, 1.0]])
    target = kind.columns(along, sizes) @ [3.0, 2.0, 1.0]
    beside, known = np.ones((target.size, 1)), np.ones(target.size, dtype=np.bool_)
    # Something else as well, or a few elements would do.
    other = 0.005 * np.std(target) * np.sin(40.0 * signals.x)
    for sign in (1.0, -1.0):
        found = Placing(choices, target + other, known, sign).placed({"a few slip elements": kind}, beside)
        assert len(found) == (sign > 0.0)
    (found,) = Placing(choices, target, known, 1.0).placed({"a few slip elements": kind}, beside).values()
    assert found[:, 1:] == pytest.approx(np.tile(sizes[0, 1:], (len(found), 1)), rel=0.03)
    for place in sizes[:, 0]:
        assert np.min(np.abs(found[:, 0] / place - 1.0)) < 0.03


def test_model_file_keeps_further_elements_and_tells_what_is_wrong_with_them() -> None:
    signals = recorded(kinked)
    parameters = json.loads(json.dumps(Generalised(signals).parameters(), default=np.ndarray.tolist))

    def made(**changed: object) -> CorrectedSimulator:
        base = {"model": "generalised", "parameters": {**parameters, **changed}}
        return CorrectedSimulator.from_parameters(interval=INTERVAL, base=base, effects=[])

    bent = made().predict(signals.x)
    assert np.std(bent - signals.y_sim) < 0.01 * np.std(signals.y_sim)
    assert np.std(made(further={}).predict(signals.x) - signals.y_sim) > 0.05 * np.std(signals.y_sim)
    # Places have a sign.
    behind = {"damping beyond a place": {"sizes": [[-0.2, 0.05, 0.0]], "weights": [1.0]}}
    added = made(further=behind).predict(signals.x) - made(further={}).predict(signals.x)
    assert rms(added[signals.x > 0.0]) > 3.0 * rms(added[signals.x < -0.3])
    for wrong in (
        3.0, {"rope": {"sizes": [[1.0]], "weights": [1.0]}}, {"kinks": {"sizes": [[0.1]]}},
        {"rubber": {"sizes": [[0.0]], "weights": [1.0]}}, {"a few sliders with mass": {"sizes": [[0.1, 30.0, 1.0, 0.0, 0.0, 0.0, 0.1]], "weights": [1.0]}}, {"leaky sliders": {"sizes": [[0.1, 0.0]], "weights": [1.0]}}, {"damping beyond a place": {"sizes": [[0.1, 0.0, 1.0]], "weights": [1.0]}}, {"damping beyond a place": {"sizes": [[0.1, 0.1, -1.0]], "weights": [1.0]}}, {"a few pinched sliders": {"sizes": [[0.1, 1.0, 0.5, 1.0, 0.2, 0.2]], "weights": [1.0]}}, {"a few hardening sliders": {"sizes": [[0.1, 1.0, 0.0, 1.0, 0.5, 0.1, 1.0]], "weights": [1.0]}}, {"a few sliders behind dashpots": {"sizes": [[0.1, 1.0, 0.5, 0.0, 0.1, 0.1]], "weights": [1.0]}}, {"kinks": {"sizes": [[0.1]], "weights": [1.0, 2.0]}}, {"kinks": {"sizes": [[0.1, 2.0]], "weights": [1.0]}},
    ):  # fmt: skip
        with pytest.raises(InputError) as told:
            made(further=wrong)
        assert "\n" not in str(told.value)
