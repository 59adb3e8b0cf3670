"""Laws as other laboratories write them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.signal import lfilter, lsim
from slider_joint import (
    ACCELERATION,
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
    joint,
    lagged,
    signals,
    spring,
)

from hystbench.diagnosis.diagnosis import diagnose
from hystbench.diagnosis.recording.signals import Signals


def gear(driving: float, driven: float) -> Floats:
    lost = np.abs(joint(X)) * SIGN
    return joint(X) + lost * np.where(SIGN * joint(X) > 0.0, driving, driven)


def gap_off_centre(middle: float, half: float) -> Floats:
    return joint(X - np.clip(X - middle, -half, half) + np.clip(-middle, -half, half))


def at_rest_in(behind: Floats) -> Floats:
    """A joint whose spring knows where its clearance's flanks are, and whose friction has settled where it lies at first."""
    return spring(behind) + friction(behind - behind[0])


def strapped(half: float) -> Floats:
    """A joint behind a strap that is slack about zero and can only pull, so that no friction is felt behind it then."""
    behind = X - np.clip(X, -half, half)
    return np.where(behind > 0.0, np.maximum(joint(behind), 0.0), np.minimum(joint(behind), 0.0)) * (behind != 0.0)


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


def let_go(y: Floats, tau: float, level: float) -> Floats:
    """What of ``y`` a dashpot by Eyring takes over, by the sample: slowly at first, soon where it is over ``level``."""
    state, out = 0.0, np.zeros_like(y)
    for i, load in enumerate(y):
        state += 0.5 * STEP / tau * level * np.sinh(np.clip((load - state) / level, -6.0, 6.0))
        out[i] = state
    return out


def knee(over: Floats, width: float) -> Floats:
    """What is ``over`` a limit, with a knee of a ``width``, N·m."""
    return np.asarray(width * np.logaddexp(0.0, over / width))


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


def clinging(stiffness: float, level: Floats, give: float = 0.0, substeps: int = 20) -> Floats:
    """A spring behind a slider that slides at ``level`` and moves before, by ``give`` (rad/s) a newton metre, in small steps."""
    out, f = np.zeros(X.size), 0.0
    for k in range(1, X.size):
        for _ in range(substeps):
            moved = (X[k] - X[k - 1] - give * f * STEP) / substeps
            f = float(np.clip(f + stiffness * moved, -level[k], level[k]))
        out[k] = f
    return out


def rubbed_warm(tau: float) -> Floats:
    """Temperature by friction's losses against cooling, from 0 to about 1."""
    power = np.abs(friction(X) * SPEED)
    warm = lfilter([STEP / tau], [1.0, STEP / tau - 1.0], power)
    return np.asarray(warm / warm.max())


def deep(x: Floats, stop: float) -> Floats:
    """How deep a stop at either end is pressed, the lower one with a minus."""
    return np.sign(x) * np.maximum(np.abs(x) - stop, 0.0)


def since(start: float, tau: float) -> Floats:
    return 1.0 - np.exp(-np.maximum(TIME - start, 0.0) / tau)


def soft_limit(y: Floats, limit: float) -> Floats:
    return np.where(y < 0.0, y / (1.0 + np.abs(y / limit) ** 6.0) ** (1.0 / 6.0), y)


def voltage_limit(y: Floats, limit: float, idle: float) -> Floats:
    """What a motor drives with falls with the speed; it brakes with all it has."""
    left = np.where(y * SPEED > 0.0, limit * (1.0 - np.abs(SPEED) / idle), limit)
    return np.clip(y, -left, left)


LAWS: dict[str, tuple[str, Callable[[], Floats]]] = {
    "a strap that goes slack": ("backlash", lambda: strapped(0.01)),
    "warm grease": ("thermal_drift", lambda: spring(X) + friction(X) * (1.0 - 0.5 * (1.0 - np.exp(-TIME / 9.0)))),
    "room temperature": ("thermal_drift", lambda: joint(X) * (1.0 + 0.06 * np.sin(2.0 * np.pi * TIME / 30.0))),
    "a spring that wears": ("cyclic_softening", lambda: spring(X) * (1.0 - 0.15 * np.sqrt(TRAVEL / TRAVEL[-1])) + friction(X)),
    "a quadratic spring": ("stiffness_asymmetry", lambda: joint(X) + 0.35 * X**2),
    "a gap off the centre": ("backlash", lambda: gap_off_centre(0.2, 0.05)),
    "keys that are loose behind the bearings": ("backlash", lambda: spring(X - ahead(0.02)) + friction(X)),
    "a brake whose pads have play": ("backlash", lambda: spring(X) + friction(X - ahead(0.02))),
    "a mechanism that was zeroed at a flank": ("backlash", lambda: joint(X - ahead(0.02) + 0.02)),
    "a shock absorber's valve": (
        "viscous_friction", lambda: joint(X) + 0.4 * np.clip(SPEED, -0.4, 0.4)
    ),
    "a seal that is tighter towards one end": ("coulomb_friction", lambda: joint(X) + 0.15 * (1.0 + 0.5 * X) * SIGN),
    "a motor that its current heats": (
        "thermal_drift", lambda: joint(X) + 0.2 * lagged(joint(X) ** 2, 2.0) / np.max(lagged(joint(X) ** 2, 2.0))
    ),
    "a heater that is switched on": ("thermal_drift", lambda: joint(X) * (1.0 - 0.08 * since(9.0, 5.0))),
    "a heater that is switched off": (
        "thermal_drift", lambda: joint(X) + 0.25 * (since(0.0, 5.0) - since(16.0, 5.0))
    ),
    "a bumper that rubs": (
        "end_stop", lambda: joint(X) + 4.0 * deep(X, 0.5) + 2.4 * np.abs(deep(X, 0.5)) * SIGN
    ),
    "a bumper of rubber": ("end_stop", lambda: joint(X) + 4.0 * deep(X, 0.55) - 1.6 * lagged(deep(X, 0.55), 0.3)),
    "contacts that lift off": ("load_dependent_friction", lambda: joint(X) + 0.08 * np.maximum(1.2 + spring(X), 0.0) * SIGN),
    "a crack that begins late": (
        "cyclic_softening", lambda: joint(X) * (1.0 - 0.16 * np.maximum(TRAVEL / TRAVEL[-1] - 0.35, 0.0))
    ),
    "strands that break about a travel": (
        "cyclic_softening", lambda: joint(X) * (1.0 - 0.1 / (1.0 + np.exp(-(TRAVEL / TRAVEL[-1] - 0.5) / 0.08)))
    ),
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
    "a wedge": ("load_dependent_friction", lambda: joint(X) + 0.02 * joint(X) ** 2 * SIGN),
    "a seal that a load beyond its preload presses": (
        "load_dependent_friction", lambda: joint(X) + 0.15 * np.maximum(np.abs(spring(X)) - 1.2, 0.0) * SIGN
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
    "a spring that engages softly from somewhere on": (
        "stiffness_asymmetry", lambda: joint(X) + 0.02 * np.logaddexp(0.0, (X + 0.1) / 0.05)
    ),
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
    "an adhesive that creeps by Eyring": ("stress_relaxation", lambda: joint(X) - 0.06 * let_go(joint(X), 0.45, 0.5)),
    "unequal limits": ("torque_saturation", lambda: np.clip(joint(X), -1.9, 2.4)),
    "a coupling whose far side still stiffens a little": (
        "torque_saturation", lambda: spring(X) - 0.75 * (spring(X) - np.clip(spring(X), -3.0, 3.0)) + friction(X)
    ),
    "a motor that runs out of voltage": ("torque_saturation", lambda: voltage_limit(joint(X), 3.2, 1.6 * float(np.max(np.abs(SPEED))))),
    "a sensor's zero that takes a while to settle": ("torque_offset", lambda: joint(X) + 0.3 * (1.0 - 0.35 * np.exp(-TIME / (0.16 * TIME[-1])))),
    "day and night": ("thermal_drift", lambda: joint(X) + 0.15 * np.sin(2.0 * np.pi * TIME / 21.0 + 1.0)),
    "an encoder ring on the spring's shaft": (
        "encoder_eccentricity", lambda: spring(X + 0.03 * np.sin(9.0 * X + 0.2)) + friction(X)
    ),
    "bearings that carry a weight": (
        "load_dependent_friction", lambda: joint(X) + 0.08 * np.abs(spring(X) - 0.8) * SIGN
    ),
    "a seal that clings and slides the less the faster": (
        "stribeck_friction", lambda: joint(X) + clinging(8.0, 0.02 + 0.3 * np.exp(-(np.abs(SPEED / 0.25) ** 1.3)))
    ),
    "friction as a soft constraint behind a tendon": (
        "coulomb_friction", lambda: joint(X) + clinging(30.0, np.full(X.size, 0.25), 0.25)
    ),
    "a gap beside the zero, where friction lies at rest": (
        "backlash", lambda: at_rest_in(X - np.clip(X - 0.03, -0.02, 0.02))
    ),
    "play at a flank, where friction lies at rest": ("backlash", lambda: at_rest_in(X - ahead(0.01) + 0.01)),
    "the stiffer of two springs of a pair": (
        "stiffness_asymmetry", lambda: joint(X) + 0.12 * (np.exp(X / 0.35) - 1.0)
    ),
    "a sensor's compression": ("torque_gain", lambda: joint(X) * (1.12 - 0.01 * np.abs(joint(X)))),
}  # fmt: skip


@pytest.mark.thorough(but_one_in=5)
@pytest.mark.parametrize("law", LAWS)
def test_a_law_of_another_hand_is_named(law: str) -> None:
    expected, made = LAWS[law]
    assert diagnosed(made()).verdict == [expected]


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize(("waves", "hardening"), [(9.0, 0.6), (20.0, 0.0)])
def test_a_torque_that_waves_with_the_place_is_no_encoders_error(waves: float, hardening: float) -> None:
    simulated = 4.0 * X + hardening * X**3 + friction(X)
    detents = np.sin(waves * X + 0.2) - np.sin(0.2)
    detents *= 8.0 * NOISE / np.std(detents)
    assert diagnose(signals(simulated + detents, y_sim=simulated)).verdict == ["unknown"]


def test_short_waves_of_the_torque_are_told_from_an_encoders_where_there_is_hardly_any_friction() -> None:
    def hinge(x: Floats) -> Floats:
        return 4.0 * x + 0.3 * friction(x)

    wave = np.sin(13.0 * X + 0.2)
    detents = diagnose(signals(hinge(X) + 8.0 * NOISE * wave / np.std(wave), y_sim=hinge(X)))
    assert detents.verdict == ["unknown"]
    assert any("a torque that waves with the place" in note for note in detents.notes)
    eccentric = diagnose(signals(hinge(X + 2.0 * NOISE * wave / np.std(wave)), y_sim=hinge(X)))
    assert eccentric.verdict == ["encoder_eccentricity"]


def test_soft_limits_that_differ_a_little_leave_nothing() -> None:
    found = diagnosed(joint(X) - knee(joint(X) - 2.3, 0.15) + knee(-2.15 - joint(X), 0.15))
    assert found.verdict == ["torque_saturation"]
    assert found.choice.features["in_sample_left"] < 0.2


@pytest.mark.parametrize(("frequency", "verdict"), [(14.8, "unknown"), (20.0, "inertia")])
def test_a_mass_that_resonates_near_the_motions_band_is_no_inertia(frequency: float, verdict: str) -> None:
    # The fastest tone is at 10 rad/s.
    begun = 1.0 - np.exp(-TIME)
    x = (0.5 * np.sin(1.1 * TIME) + 0.3 * np.sin(0.37 * TIME) + 0.05 * np.sin(10.0 * TIME)) * begun
    mass = ([0.02 * frequency**2, 0.0, 0.0], [1.0, 0.1 * frequency, frequency**2])
    real = joint(x) + np.asarray(lsim(mass, x, TIME)[1]) + NOISE * np.random.default_rng(1).standard_normal(x.size)
    assert diagnose(Signals(TIME, x, real, joint(x), [slice(0, x.size)], {})).verdict == [verdict]


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize(
    "law",
    [
        "a spring that slackens on the way back",
        "a spring that stiffens across",
        "a spring that stiffens under load",
        "churning oil",
        "grease that thins steadily",
        "a spring that wears steadily",
        "heat that soaks in",
        "a seal that clings and slides the less the faster",
        "friction as a soft constraint behind a tendon",
        "a gap beside the zero, where friction lies at rest",
        "play at a flank, where friction lies at rest",
        "the stiffer of two springs of a pair",
    ],
)
def test_a_law_that_is_known_leaves_nothing(law: str) -> None:
    found = diagnosed(LAWS[law][1]())
    assert found.effects[0].adequacy == "adequate"
    assert found.choice.features["in_sample_left"] < 0.1
