"""What simulators of joints are made of, each by an implementation of its own, and whether the emulator answers for them."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from joints import sliders
from numpy.typing import NDArray

from hystbench.diagnosis import generalised
from hystbench.diagnosis.corrected import CorrectedSimulator
from hystbench.diagnosis.diagnosis import diagnose
from hystbench.diagnosis.emulation import emulate
from hystbench.diagnosis.generalised import Generalised, spring_of
from hystbench.diagnosis.operators import hyperbolic
from hystbench.diagnosis.signals import Signals
from hystbench.errors import InputError

Floats = NDArray[np.float64]
Pads = tuple[float, float] | None
Joint = Callable[..., Floats]
INTERVAL = 0.01


def motion(seconds: float, *phases: float) -> tuple[Floats, Floats]:
    time = np.arange(0.0, seconds, INTERVAL)
    x = sum(
        size * np.sin(2.0 * np.pi * rate * time + phase)
        for size, rate, phase in zip((0.6, 0.3, 0.15), (0.17, 0.43, 1.1), phases, strict=True)
    )
    return time, np.asarray(x - x[0] * np.exp(-time / 0.3)) * (1.0 - np.exp(-time / 0.5))


# Each with its parameters off by ``e``, some up and some down.


def kinked(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    spring = 5.0 * x + 7.0 * (1.0 + e) * np.sign(x) * np.maximum(np.abs(x) - 0.52 * (1.0 + e), 0.0)
    return spring + sliders(x, ((6.0, 0.12 * (1.0 - e)), (2.0 * (1.0 + e), 0.15)))


def two_sliders(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Yielding at two sharp deflections, of which a coarse set of elements has neither."""
    return (1.0 + e) * x + sliders(x, ((12.5, 0.75 * (1.0 + e)), (5.8 * (1.0 - e), 0.75)))


def rubber(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    friction, force, left, left_at, way = np.zeros(x.size), 0.0, 0.0, 0.0, 0.0
    most, length = 1.5 * (1.0 + e), 0.08 * (1.0 - e)
    for i in range(1, x.size):
        step = x[i] - x[i - 1]
        if step * way <= 0.0:
            left, left_at, way = force, x[i - 1], step
        # Berg's two branches as printed.
        mu, gone = left / most, x[i] - left_at
        up = left + gone / (length * (1.0 - mu) + gone) * (most - left)
        down = left + gone / (length * (1.0 + mu) - gone) * (most + left)
        friction[i] = force = up if step > 0.0 else down
    return 4.0 * (1.0 - e) * x + friction


def smooth_yielding(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    z, out = 0.0, np.zeros(x.size)
    for i in range(1, x.size):
        step = (x[i] - x[i - 1]) / 40
        for _ in range(40):
            z += step * (1.0 - (z / (0.09 * (1.0 - e))) ** 2 * (0.6 * np.sign(z * step) + 0.4))
        out[i] = z
    return 3.0 * (1.0 + e) * x + 12.0 * (1.0 + e) * out


def stribeck(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """LuGre, explicit in small steps."""
    z, out = 0.0, np.zeros(x.size)
    for i in range(1, x.size):
        speed = (x[i] - x[i - 1]) / INTERVAL
        level = (1.0 + e) * (0.8 + 0.6 * np.exp(-((speed / 0.25) ** 2)))
        for _ in range(40):
            z += INTERVAL / 40 * (speed - 60.0 * abs(speed) / level * z)
        out[i] = 60.0 * z
    return 3.0 * (1.0 - e) * x + out


def damped_bristles(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """LuGre whose bristles are damped, in small steps."""
    finely = np.arange(0.0, x.size - 1 + 1e-9, 1 / 40)
    speed = np.interp(finely, np.arange(x.size), np.gradient(x, time))
    z, out = 0.0, np.zeros(finely.size)
    for i, v in enumerate(speed):
        rate = v - 60.0 * abs(v) / (1.0 + 0.5 * np.exp(-((v / 0.2) ** 2))) / (1.0 + e) * z
        out[i] = 60.0 * z + 0.9 * (1.0 - e) * rate
        z += INTERVAL / 40 * rate
    return 3.0 * (1.0 - e) * x + out[::40]


def bristles_by_the_sample(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """LuGre of a speed made from the samples on both sides, a step each."""
    z, out = 0.0, np.zeros(x.size)
    for i, v in enumerate(np.gradient(x, time)):
        settled = (1.0 + 0.5 * np.exp(-((v / 0.2) ** 2))) * (1.0 + e) / 60.0
        z = settled * np.sign(v) + (z - settled * np.sign(v)) * np.exp(-abs(v) / settled * INTERVAL)
        out[i] = 60.0 * z
    return 3.0 * (1.0 - e) * x + out


def viscoelastic(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    branches = np.zeros(x.size)
    for constant in (0.3, 2.0, 9.0):
        force = 0.0
        for i in range(1, x.size):
            force = force * np.exp(-INTERVAL / (constant * (1.0 + e))) + 1.5 * (1.0 + e) * (x[i] - x[i - 1])
            branches[i] += force
    return 3.0 * (1.0 - e) * x + branches


def saturating(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """A generalised Prandtl-Ishlinskii stage: each play is bent by an envelope that saturates sooner on one side."""
    out = np.zeros(x.size)
    for half in (0.05, 0.1, 0.2, 0.3):
        at = 0.0
        for i, now in enumerate(x):
            at = min(max(at, now - half), now + half)
            out[i] += (1.0 + e) * np.tanh(1.6 * (1.0 - e) * at + 0.4)
    return (1.0 + e) * x + out


FINER = 40


def dragged(
    time: Floats, x: Floats, stiffness: float, limit: float, mass: float, damping: float, pads: Pads = None
) -> Floats:
    """Torque of a spring to a mass with dry and viscous friction, explicit in small steps, which may rest between two pads."""
    h = INTERVAL / FINER
    fine = np.interp(np.arange((x.size - 1) * FINER + 1) * h, time, x)
    at, speed, stretch = 0.0, 0.0, np.zeros(fine.size)
    for i, now in enumerate(fine):
        stretch[i] = now - at
        deep = max(at - pads[1], 0.0) + min(at - pads[0], 0.0) if pads else 0.0
        pad = 300.0 * deep + 1.5 * speed if deep else 0.0
        pull = stiffness * stretch[i] - (pad if pad * deep > 0.0 else 0.0)
        if speed == 0.0 and abs(pull) <= limit:
            continue
        way = np.sign(speed) if speed else np.sign(pull)
        speed += h * (pull - way * limit - damping * speed) / mass
        speed = speed if speed * way > 0.0 else 0.0
        at += h * speed
    return np.asarray(stiffness * stretch[::FINER])


def heavy(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Two masses on springs beside a third spring."""
    out = 4.0 * (1.0 + e) * x + dragged(time, x, 9.0, 0.9, 0.001, 0.15)
    return out + dragged(time, x, 5.0 * (1.0 + e), 1.3 * (1.0 - e), 0.0015, 0.12)


def between_pads(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """A mass on a spring that strikes pads of rubber."""
    return 4.0 * (1.0 + e) * x + dragged(time, x, 9.0, 0.9 * (1.0 + e), 0.003, 0.1, (-0.25, 0.3 * (1.0 - e)))


def pinching(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Bouc-Wen with the pinching of Baber and Noori, as printed, explicit in small steps."""
    z, out = 0.0, np.zeros(x.size)
    beta, gamma, n = 2.0 * (1.0 + e), 0.8 * (1.0 - e), 1.4
    most = (1.0 / (beta + gamma)) ** (1.0 / n)
    for i in range(1, x.size):
        step = (x[i] - x[i - 1]) / 40
        for _ in range(40):
            h = 1.0 - 0.6 * (1.0 - e) * np.exp(-(((z * np.sign(step) - 0.15 * most) / (0.2 * (1.0 + e))) ** 2))
            z += h * (step - beta * abs(step) * abs(z) ** (n - 1.0) * z - gamma * step * abs(z) ** n)
        out[i] = z
    return 0.8 * (1.0 + e) * x + 3.0 * out


def metal(time: Floats, x: Floats, e: float = 0.0, growth: float = 0.0) -> Floats:
    """Plasticity with two back stresses that recall themselves, by small steps back to the yield limit, which may grow."""
    torque, fast, slow, flown, out = 0.0, 0.0, 0.0, 0.0, np.zeros(x.size)
    for i in range(1, x.size):
        for _ in range(40):
            torque += 10.0 * (x[i] - x[i - 1]) / 40
            limit = 0.5 * (1.0 + e) * (1.0 + growth * (1.0 - np.exp(-flown / 0.8)))
            over = abs(torque - fast - slow) - limit
            if over > 0.0:
                way = np.sign(torque - fast - slow)
                rates = 12.0 * (1.0 + e) * way - 15.0 * fast, 3.0 * (1.0 - e) * way - 2.0 * slow
                flow = over / (10.0 + way * sum(rates))
                torque, fast, slow = torque - 10.0 * way * flow, fast + rates[0] * flow, slow + rates[1] * flow
                flown += flow
        out[i] = torque
    return (1.0 + e) * x + out


def used_metal(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Metal whose yield limit grows by a fifth as it flows."""
    return metal(time, x, e, 0.2 * (1.0 - e))


def damper(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Spencer's damper of magnetorheological fluid with both of its springs, explicit in small steps."""
    steps, behind, hysteretic, piston, out = 40, 5.0 * (1.0 - e), 0.0, 0.0, np.zeros(x.size)
    h = INTERVAL / steps
    for i in range(1, x.size):
        speed = (x[i] - x[i - 1]) / INTERVAL
        for k in range(steps):
            spring = 1.5 * (x[i - 1] + (k + 0.5) * h * speed - piston)
            inner = (12.0 * (1.0 + e) * hysteretic + 0.2 * speed + spring) / (0.2 + behind)
            slip, share = speed - inner, hysteretic / 0.08
            piston += h * inner
            hysteretic += h * (slip - 0.5 * slip * share**2 - 0.5 * abs(slip) * share * abs(share))
        out[i] = behind * inner
    return 3.0 * (1.0 - e) * x + out


def spreadsheet(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Dry and viscous friction of a speed made from one sample to the next."""
    speed = np.diff(x, prepend=x[0]) / INTERVAL
    return 4.0 * (1.0 + e) * x + 0.3 * (1.0 - e) * speed + (1.0 + e) * np.tanh(speed / (0.003 * (1.0 + e)))


def rigid_body(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """The torque that an engine for rigid bodies wants for a motion: friction of a speed that is yet to come, and inertia."""
    speed = np.gradient(x, time)
    acceleration = np.gradient(speed, time)
    friction = 0.8 * (1.0 - e) * np.clip((speed + 0.003 * acceleration) / 0.02, -1.0, 1.0)
    return 4.0 * (1.0 + e) * x + friction + 0.1 * speed + 0.02 * (1.0 + e) * acceleration


def two_sided(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Kwok's damper of magnetorheological fluid, whose friction turns earlier on the way back from either side."""
    speed = np.gradient(x, time)
    friction = np.tanh(speed / (0.3 * (1.0 + e)) + 0.7 * (1.0 - e) * np.tanh(x / 0.2))
    return 2.0 * (1.0 + e) * x + 0.4 * speed + (1.0 - e) * friction


def late_and_two_sided(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """The same whose fluid takes its time."""
    wanted = np.tanh(np.gradient(x, time) / 0.3 + 0.7 * np.tanh(x / 0.2))
    told, friction = np.zeros(x.size), 0.0
    for i, now in enumerate(wanted):
        friction += (now - friction) * (1.0 - np.exp(-INTERVAL / (0.05 * (1.0 + e))))
        told[i] = friction
    return 2.0 * (1.0 + e) * x + 0.4 * np.gradient(x, time) + (1.0 - e) * told


def maxwell_slip(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Generalised Maxwell slip: elements stick, or are drawn to a share of the Stribeck curve, in small steps."""
    out, fine = np.zeros(x.size), 20
    for stiffness, share in ((30.0, 0.4), (12.0, 0.6)):
        force, slips, before = 0.0, False, 0.0
        for i in range(1, x.size):
            speed = (x[i] - x[i - 1]) / INTERVAL
            curve = (1.0 + e) * (0.9 + 0.5 * np.exp(-((speed / 0.4) ** 2)))
            slips, before = slips and speed * before > 0.0, speed
            for _ in range(fine):
                if slips:
                    force += 12.0 * (share * np.sign(speed) - force / curve) * INTERVAL / fine
                else:
                    force += stiffness * speed * INTERVAL / fine
                    slips = abs(force) >= share * curve and force * speed > 0.0
            out[i] += force
    return 3.0 * (1.0 - e) * x + out


def rolling(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Hysteresis of rolling balls, all of which is stronger at rest."""
    slow = 1.0 + 0.3 * (1.0 + e) * np.exp(-np.abs(np.gradient(x, time)) / 0.5)
    return 4.0 * (1.0 + e) * x + slow * sliders(x, ((6.0, 0.12), (2.0 * (1.0 - e), 0.3)))


def leaves(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Fancher's leaf spring as printed: its friction grows with the deflection and builds up faster one way."""
    friction, force = np.zeros(x.size), 0.0
    for i in range(1, x.size):
        step = x[i] - x[i - 1]
        envelope = np.sign(step) * (1.0 + e) * (0.8 + 0.5 * abs(x[i]))
        force = envelope + (force - envelope) * np.exp(-abs(step) / (0.05 * (1.0 - e) if step > 0.0 else 0.12))
        friction[i] = force
    return 4.0 * x + (1.0 + e) * x**3 + friction


def lagging(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Sliders whose torque is told late, each by its own time."""
    out = 3.0 * (1.0 + e) * x
    for stiffness, limit, constant in ((6.0, 0.12, 0.15), (3.0 * (1.0 - e), 0.3, 0.4 * (1.0 + e))):
        late, told = sliders(x, ((stiffness, limit),)), 0.0
        for i in range(1, x.size):
            told += (late[i] - told) * (1.0 - np.exp(-INTERVAL / constant))
            out[i] += told
    return out


def hardly_yielding(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Mostly a spring: whatever emulates the loop badly is still less than a hundredth of the torque."""
    return 4.0 * (1.0 + e) * x + 0.3 * smooth_yielding(time, x, -e)


JOINTS: dict[str, tuple[Joint, float]] = {
    "kinked": (kinked, 0.005),
    "two sliders": (two_sliders, 0.002),
    "rubber": (rubber, 0.005),
    "smooth yielding": (smooth_yielding, 0.001),
    "Stribeck": (stribeck, 0.01),
    "damped bristles": (damped_bristles, 0.003),
    "bristles by the sample": (bristles_by_the_sample, 0.003),
    "viscoelastic": (viscoelastic, 0.02),
    "saturating": (saturating, 0.02),
    "heavy": (heavy, 0.002),
    "between pads": (between_pads, 0.005),
    "pinching": (pinching, 0.001),
    "metal": (metal, 0.001),
    "used metal": (used_metal, 0.002),
    "damper": (damper, 0.002),
    "spreadsheet": (spreadsheet, 0.005),
    "rigid body": (rigid_body, 0.002),
    "two-sided": (two_sided, 0.005),
    "late and two-sided": (late_and_two_sided, 0.005),
    "Maxwell slip": (maxwell_slip, 0.01),
    "rolling": (rolling, 0.005),
    "leaves": (leaves, 0.001),
    "hardly yielding": (hardly_yielding, 0.0003),
    "lagging": (lagging, 0.01),
}
"""With the error, as a share of the output, that the emulator may make over a motion that it never saw."""


def recorded(joint: Joint, real: Joint | None = None) -> Signals:
    time, x = motion(60.0, 0.0, 1.0, 2.0)
    y = joint(time, x)
    noise = 0.002 * np.std(y) * np.random.default_rng(5).standard_normal(x.size)
    return Signals(time, x, (real or joint)(time, x) + noise, y, [slice(0, x.size)], {})


@pytest.mark.parametrize("name", JOINTS)
def test_answers_another_motion_as_the_simulator_would(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    joint, allowed = JOINTS[name]
    signals = recorded(joint)
    time, x = motion(40.0, 2.0, 0.5, 1.0)
    x *= 0.85
    wanted = joint(time, x)

    def error() -> float:
        return float(np.std(Generalised(signals).anew(x) - wanted) / np.std(wanted))

    found = error()
    monkeypatch.setattr(generalised, "EMULATED", np.inf)
    assert found < min(allowed, 0.7 * error())


@pytest.mark.parametrize("name", JOINTS)
def test_simulator_of_any_kind_that_is_off_by_a_few_per_cent_is_a_miscalibration(name: str) -> None:
    joint, _ = JOINTS[name]
    found = diagnose(recorded(joint, lambda time, x: joint(time, x, 0.04)))
    assert found.verdict == ["miscalibration"]


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
    assert np.std(found.anew(0.8 * x)[first] - wanted[first]) < 0.002 * np.std(wanted)
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
    assert np.std(found.anew(0.85 * x) - wanted) < 0.0015 * np.std(wanted)


def dahl(time: Floats, x: Floats) -> Floats:
    """Dahl friction of any exponent beside a spring that softens, explicit in small steps from rest at zero."""
    friction, before, out = 0.0, 0.0, np.zeros(x.size)
    for i, now in enumerate(x):
        step = (now - before) / 40
        for _ in range(40):
            friction += 30.0 * step * max(1.0 - friction * np.sign(step), 0.0) ** 1.6
        before, out[i] = now, friction
    return 3.0 * x - 0.8 * x**3 + out


def test_simulator_of_a_registered_kind_is_emulated_as_such_and_a_shifted_run_shows_in_its_friction() -> None:
    signals = recorded(dahl, lambda time, x: dahl(time, x + 0.05))
    emulator = emulate(signals, None)
    assert emulator.name == "dahl"
    assert emulator.error < 0.002
    # From home to where it really is friction builds up before the first sample.
    change = emulator.predict(signals.x + 0.05) - emulator.predict(signals.x)
    wanted = dahl(signals.time, signals.x + 0.05) - signals.y_sim
    assert wanted[0] > 5.0 * np.std(wanted[-1000:])
    assert np.max(np.abs(change - wanted)) < 0.05 * np.max(np.abs(wanted))
    assert diagnose(signals).verdict == ["deflection_offset"]


def test_sharp_sliders_are_found_where_they_yield_and_know_nothing_of_time() -> None:
    found = Generalised(recorded(two_sliders)).further
    # A mass with a very stiff spring would do as well, and would let a refit imitate damping.
    assert list(found) == ["a few sharp sliders"]
    assert sorted(found["a few sharp sliders"]["sizes"][:, 0]) == pytest.approx([0.75 / 12.5, 0.75 / 5.8], rel=0.01)


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


def test_kinks_belong_to_the_spring_and_have_no_torque_at_rest() -> None:
    emulator = emulate(recorded(kinked), None)
    assert "kinks" in emulator.name
    x = np.array([-0.8, -0.3, 0.0, 0.3, 0.8])
    # Sliders that hardly ever slide may pass for springs and the other way round, but a kink is one of the spring.
    bent = np.diff(spring_of(emulator.split, x))
    assert spring_of(emulator.split, x)[2] == pytest.approx(0.0, abs=1e-12)
    assert bent[[0, 3]] / 0.5 == pytest.approx(bent[[1, 2]] / 0.3 + 7.0 * 0.28 / 0.5, rel=0.1)


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


def test_hyperbolic_friction_is_half_way_after_its_length_and_does_not_know_time() -> None:
    x = np.concatenate([np.linspace(0.0, 0.1, 11), np.linspace(0.1, -0.5, 61)[1:]])
    f = hyperbolic(x, 0.1)
    assert f[10] == pytest.approx(0.5)
    # From there back the length is 0.1 (1 + f): half of the way from 0.5 to −1.
    assert f[25] == pytest.approx(-0.25)
    finer = hyperbolic(np.interp(np.arange(0.0, x.size - 1, 0.25), np.arange(x.size), x), 0.1)
    assert finer[::4] == pytest.approx(f[:-1])


def test_model_file_keeps_further_elements_and_tells_what_is_wrong_with_them() -> None:
    signals = recorded(kinked)
    parameters = json.loads(json.dumps(Generalised(signals).parameters(), default=np.ndarray.tolist))

    def made(**changed: object) -> CorrectedSimulator:
        base = {"model": "generalised", "parameters": {**parameters, **changed}}
        return CorrectedSimulator.from_parameters(interval=INTERVAL, base=base, effects=[])

    bent = made().predict(signals.x)
    assert np.std(bent - signals.y_sim) < 0.01 * np.std(signals.y_sim)
    assert np.std(made(further={}).predict(signals.x) - signals.y_sim) > 0.05 * np.std(signals.y_sim)
    for wrong in (
        3.0, {"rope": {"sizes": [[1.0]], "weights": [1.0]}}, {"kinks": {"sizes": [[0.1]]}},
        {"rubber": {"sizes": [[0.0]], "weights": [1.0]}}, {"a few sliders with mass": {"sizes": [[0.1, 30.0, 1.0, 0.0, 0.0, 0.0, 0.1]], "weights": [1.0]}}, {"leaky sliders": {"sizes": [[0.1, 0.0]], "weights": [1.0]}}, {"a few pinched sliders": {"sizes": [[0.1, 1.0, 0.5, 1.0, 0.2, 0.2]], "weights": [1.0]}}, {"a few hardening sliders": {"sizes": [[0.1, 1.0, 0.0, 1.0, 0.5, 0.1, 1.0]], "weights": [1.0]}}, {"a few sliders behind dashpots": {"sizes": [[0.1, 1.0, 0.5, 0.0, 0.1, 0.1]], "weights": [1.0]}}, {"kinks": {"sizes": [[0.1]], "weights": [1.0, 2.0]}}, {"kinks": {"sizes": [[0.1, 2.0]], "weights": [1.0]}},
    ):  # fmt: skip
        with pytest.raises(InputError) as told:
            made(further=wrong)
        assert "\n" not in str(told.value)
