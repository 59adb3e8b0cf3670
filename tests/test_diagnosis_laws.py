"""Effects as hardware has them, not as the registry's first formula has them: homed encoders, damped stops, loose loads."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from joints import clearance, dahl, sliders, through_a_clearance
from motions import swelling
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.signal import lfilter

from hystbench.diagnosis import registry
from hystbench.diagnosis.diagnosis import diagnose
from hystbench.diagnosis.emulator.emulation import SimulatorScene, emulate
from hystbench.diagnosis.operators.levels import yielding
from hystbench.diagnosis.operators.masses import free_flight
from hystbench.diagnosis.operators.memory import bristle
from hystbench.diagnosis.recording.quantisation import torque_step
from hystbench.diagnosis.recording.signals import Signals
from hystbench.diagnosis.result import Diagnosis
from hystbench.diagnosis.wording import sentence

Floats = NDArray[np.float64]
NOISE = 0.012
REACH = 0.9


def joint(x: Floats) -> Floats:
    """A hardening spring and three springs with sliders."""
    return 4.0 * x + 0.6 * x**3 + sliders(x, ((6.0, 0.12), (2.0, 0.15), (0.8, 0.16)))


def behind_a_spring(x: Floats, upper: float, lower: float) -> Floats:
    """Torque of a spring to a load with dry friction that another spring holds back, between two stops."""
    place, out = 0.0, np.empty_like(x)
    for i, value in enumerate(x):
        for way in (1.0, -1.0):
            # Where the load is when it only just moves.
            stiffness, pulled = 11.0, 8.0 * value - 0.9 * way
            for end in (upper, -lower):
                if np.sign(end) * (pulled / 11.0 - end) > 0.0:
                    stiffness, pulled = 11.0 + 30.0, pulled + 30.0 * end
            place = way * max(way * place, way * pulled / stiffness)
        out[i] = 8.0 * (value - place)
    return out


def diagnosed(
    measured: Floats, y_real: Floats, exclude: tuple[str, ...] = (), simulator: Callable[[Floats], Floats] = joint
) -> Diagnosis:
    rng = np.random.default_rng(5)
    time, _ = swelling(measured.size)
    seen = measured + 1e-4 * REACH * rng.standard_normal(measured.size)
    noise = NOISE * rng.standard_normal(measured.size)
    return diagnose(Signals(time, seen, y_real + noise, simulator(seen), [slice(0, seen.size)], {}), exclude=exclude)


# ---- laws --------------------------------------------------------------------------------------------------------------


def test_an_encoder_that_was_zeroed_at_home_has_no_offset_besides() -> None:
    _, x = swelling()
    found = diagnosed(x + 0.02 * (np.sin(6.0 * x + 0.9) - np.sin(0.9)), joint(x))
    assert found.verdict == ["encoder_eccentricity"]


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize("periods", [40.0, 60.0])
def test_an_encoder_of_many_pole_pairs_is_told(periods: float) -> None:
    """Whose error has more waves within the stroke than can all be tried."""
    _, x = swelling()
    found = diagnosed(x + 0.006 * (np.sin(periods * x + 0.9) - np.sin(0.9)), joint(x))
    assert found.verdict == ["encoder_eccentricity"]
    assert found.effects[0].parameters["periods"] == pytest.approx(periods, rel=0.01)


def test_an_encoder_error_with_an_offset_is_both() -> None:
    _, x = swelling()
    found = diagnosed(x + 0.02 * (np.sin(6.0 * x + 0.9) - np.sin(0.9)) + 0.03, joint(x))
    assert set(found.verdict) == {"encoder_eccentricity", "deflection_offset"}


@pytest.mark.parametrize(
    ("effect", "parameter", "size"),
    [("viscous_friction", "damping", 0.08), ("coulomb_friction", "friction", 0.12), ("inertia", "inertia", 0.008)],
)
def test_what_the_simulator_has_too_much_of_is_named_with_a_minus(effect: str, parameter: str, size: float) -> None:
    time, x = swelling()
    speed = np.gradient(x, time)
    law = {
        "viscous_friction": speed,
        "coulomb_friction": np.tanh(speed / 0.05),
        "inertia": np.gradient(speed, time),
    }[effect]
    noise = NOISE * np.random.default_rng(5).standard_normal(x.size)
    y_sim = joint(x) + size * law
    found = diagnose(Signals(time, x, joint(x) + noise, y_sim, [slice(0, x.size)], {}))
    assert found.verdict == [effect]
    (report,) = (e for e in found.effects if e.name == effect)
    assert report.parameters[parameter] == pytest.approx(-size, rel=0.05)
    low, high = found.parameter_intervals[effect][parameter]
    assert low <= -size <= high
    title = effect.replace("_", " ").replace("coulomb", "Coulomb")
    assert f"too much {title} in the simulator; correcting that" in sentence(found)


def test_dry_friction_whose_sign_turns_slowly_needs_no_excess_at_rest() -> None:
    time, x = swelling()
    speed = np.gradient(x, time)
    regularised = 2.0 / np.pi * np.arctan(speed / (0.08 * np.std(speed)))
    assert diagnosed(x, joint(x) + 0.15 * regularised).verdict == ["coulomb_friction"]


@pytest.mark.parametrize("thinning", [0.1, 0.2])
def test_a_grease_that_thins_early_still_grows_with_the_logarithm_of_the_speed(thinning: float) -> None:
    time, x = swelling()
    speed = np.gradient(x, time)
    found = diagnosed(x, joint(x) + 0.05 * np.arcsinh(speed / (thinning * np.std(speed))))
    assert found.verdict == ["viscous_friction"]


@pytest.mark.parametrize("transition", [0.02, 0.08])
def test_friction_that_does_not_fall_with_speed_is_not_stribecks_where_dry_friction_is_excluded(
    transition: float,
) -> None:
    time, x = swelling()
    speed = np.gradient(x, time)
    regularised = 2.0 / np.pi * np.arctan(speed / (transition * np.std(speed)))
    found = diagnosed(x, joint(x) + 0.15 * regularised, exclude=("coulomb_friction",))
    assert "stribeck_friction" not in found.verdict


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_spring_that_hardens_on_one_side_is_an_asymmetry_of_an_exact_simulator(side: float) -> None:
    _, x = swelling()
    y = joint(x)
    assert diagnosed(x, y + 0.5 * x * np.maximum(side * x, 0.0)).verdict == ["stiffness_asymmetry"]


def test_sides_whose_torque_is_off_in_opposite_ways_are_one_asymmetry() -> None:
    _, x = swelling()
    y = joint(x)
    assert diagnosed(x, y + 0.06 * np.abs(y)).verdict == ["stiffness_asymmetry"]


ELEMENTS = ((6.0, 0.12), (2.0, 0.15), (0.8, 0.16))


@pytest.mark.thorough(but_one_in=2)
# The last is held by friction nearly wherever it is.
@pytest.mark.parametrize(("tones", "spring"), [(1, 4.0), (3, 4.0), (3, 0.3)])
@pytest.mark.parametrize(
    ("width", "soft", "dry", "damping", "mass"),
    [
        (0.05, None, 0.0, 0.0, 0.0),
        (0.15, None, 0.0, 0.0, 0.0),
        (0.3, None, 0.0, 0.0, 0.0),
        (0.15, None, 0.0, 0.1, 0.0),
        (0.15, None, 0.3, 0.0, 0.0),
        (0.3, None, 0.0, 0.05, 0.03),
        (0.05, 0.2, 0.0, 0.0, 0.0),
        (0.15, 0.6, 0.0, 0.05, 0.03),
    ],
)
def test_a_clearance_in_series_is_crossed_where_the_torque_is_nil(
    width: float, soft: float | None, tones: int, spring: float, dry: float, damping: float, mass: float
) -> None:
    time, x = swelling()
    if tones == 1:
        x = 0.8 * np.sin(2 * np.pi * 0.4 * time)
    speed = np.gradient(x, time)
    # The drive's own, on which the clearance has no hold.
    drag = dry * np.tanh(speed / 0.003) + damping * speed + mass * np.gradient(speed, time)
    sim = drag + spring * x + sliders(x, ELEMENTS)
    wanted = drag + through_a_clearance(x, width, spring, ELEMENTS, soft) - sim
    signals = Signals(time, x, sim + wanted, sim, [slice(0, x.size)], {})
    scene = SimulatorScene(signals, emulate(signals, None))
    laws = {form.name: form for form in registry.get("backlash")().forms(scene)}
    hard, yielding = laws["gap at zero torque"], laws["gap at zero torque, soft flanks"]
    made = hard.columns(scene, (width,)) if soft is None else yielding.columns(scene, (width, soft))
    assert np.std(made[:, 0] - wanted) < 0.08 * np.std(wanted)


def test_a_clearance_may_be_crossed_where_all_the_torque_turns_a_masss_and_a_dampers_too() -> None:
    time, x = swelling()

    def drive(x: Floats) -> Floats:
        speed = np.gradient(x, time)
        return joint(x) + 0.4 * speed + 0.03 * np.gradient(speed, time)

    noise = NOISE * np.random.default_rng(6).standard_normal(x.size)
    loose = drive(x - 0.01 * np.tanh(drive(x) / 0.4)) + noise
    found = diagnose(Signals(time, x, loose, drive(x), [slice(0, x.size)], {}))
    assert found.verdict == ["backlash"]
    assert found.closed_in_all > 0.98


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_spring_on_one_side_may_grow_stiffer_beside_a_simulator_that_is_off(side: float) -> None:
    _, x = swelling()
    beyond = np.maximum(side * x, 0.0)
    off = 4.12 * x + 0.58 * x**3 + sliders(x, ((5.8, 0.124), (2.07, 0.145), (0.77, 0.166)))
    found = diagnosed(x, off + side * (0.25 * beyond + 0.4 * beyond**2))
    assert set(found.verdict) - {"miscalibration"} == {"stiffness_asymmetry"}
    named = next(effect for effect in found.effects if effect.name == "stiffness_asymmetry")
    assert abs(named.parameters["extra_stiffness_slope"] - 0.4) < 0.15


def test_a_clearance_may_hold_the_spring_alone_while_friction_is_felt_before_it() -> None:
    _, x = swelling()
    behind = x - np.clip(x, -0.02, 0.02)
    found = diagnosed(x, joint(x) + 4.0 * (behind - x) + 0.6 * (behind**3 - x**3))
    assert found.verdict == ["backlash"]
    assert found.closed_in_all > 0.98


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize(("gain", "off"), [(0.3, 0.0), (1.2, 0.0), (0.45, 0.04), (0.8, 0.04)])
def test_much_more_of_the_joints_own_friction_is_dry_friction(gain: float, off: float) -> None:
    _, x = swelling()
    errors = np.array([1.0, -1.0, 1.0])
    made = [
        (k * (1.0 + off * e), (1.0 + gain) * f * (1.0 - off * e)) for (k, f), e in zip(ELEMENTS, errors, strict=True)
    ]
    found = diagnosed(x, 4.0 * (1.0 + off) * x + 0.6 * (1.0 - off) * x**3 + sliders(x, made))
    assert set(found.verdict) - {"miscalibration"} == {"coulomb_friction"}
    assert found.closed_in_all > 0.9
    effect = next(effect for effect in found.effects if effect.name == "coulomb_friction")
    assert abs(effect.parameters["strength_gain"] - gain) < 0.02 + 4.0 * off


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize("middle", [0.4, 0.75])
def test_a_gap_within_the_stroke_of_a_joint_that_is_moved_to_one_side_is_a_clearance(middle: float) -> None:
    time, x = swelling()
    x = (0.6 + 0.5 * x) * (1.0 - np.exp(-time))
    found = diagnosed(x, joint(x - np.clip(x - middle, -0.02, 0.02)))
    assert found.verdict == ["backlash"]
    assert found.effects[0].parameters["middle"] == pytest.approx(middle, abs=0.005)


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize("middle", [0.0, 0.3])
def test_a_gap_with_rounded_flanks_is_a_clearance(middle: float) -> None:
    _, x = swelling()
    half, rounding = 0.15, 0.15
    taken = 0.5 * (np.hypot(x - middle + half, rounding) - np.hypot(x - middle - half, rounding))
    found = diagnosed(x, joint(x - taken))
    assert found.verdict == ["backlash"]
    assert found.effects[0].parameters["clearance"] == pytest.approx(2.0 * half, rel=0.03)


@pytest.mark.parametrize("spread", [0.5, 0.9])
def test_flanks_that_yield_are_a_clearance(spread: float) -> None:
    _, x = swelling()
    halves = 0.04 * (1.0 + spread * np.linspace(-1.0, 1.0, 41))
    # Each of many flanks is met in its turn: plays by their definition.
    place = np.zeros_like(halves)
    moved = np.empty_like(x)
    for i, value in enumerate(x):
        place = np.clip(place, value - halves, value + halves)
        moved[i] = place.mean()
    found = diagnosed(x, joint(moved))
    assert found.verdict == ["backlash"]
    assert found.closed_in_all > 0.98


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_stop_that_loses_energy_is_a_stop(side: float) -> None:
    time, x = swelling()
    depth = np.maximum(side * x - 0.55, 0.0)
    force = 6.0 * depth + np.where(depth > 0.0, 0.25 * side * np.gradient(x, time), 0.0)
    found = diagnosed(x, joint(x) + side * np.maximum(force, 0.0))
    assert found.verdict == ["end_stop"]


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_stop_that_a_few_large_swings_press_far_in_is_a_stop(side: float) -> None:
    time, x = swelling()
    x = x * (0.2 + 0.8 * np.exp(-np.square((time - 26.0) / 3.0)))
    depth = np.maximum(side * x - 0.18, 0.0)
    found = diagnosed(x, joint(x) + side * 5.0 * depth * np.maximum(1.0 + 0.25 * side * np.gradient(x, time), 0.0))
    assert found.verdict == ["end_stop"]


@pytest.mark.thorough(but_one_in=3)
@pytest.mark.parametrize("ends", [(0.3, 9.0), (9.0, 0.3), (0.45, 0.4)], ids=["above", "below", "both"])
def test_a_stop_that_a_load_behind_a_spring_meets_is_a_stop(ends: tuple[float, float]) -> None:
    """Its friction has it meet the stop at another deflection than it leaves it."""
    _, x = swelling()
    found = diagnosed(x, behind_a_spring(x, *ends), simulator=lambda x: behind_a_spring(x, 9.0, 9.0))
    assert found.verdict == ["end_stop"]
    for name, end in zip(("upper", "lower"), ends, strict=True):
        if end < 9.0:
            assert found.effects[0].parameters[name] == pytest.approx(end, abs=0.02)


def test_a_stop_that_is_met_at_the_very_end_is_a_stop() -> None:
    _, x = swelling()
    # It often is at the end of what it can do.
    x = np.tanh(3.0 * x)
    end = 0.994 * x.max()
    found = diagnosed(x, joint(x) + 150.0 * np.maximum(x - end, 0.0))
    assert found.verdict == ["end_stop"]
    assert found.effects[0].parameters["upper"] == pytest.approx(end, rel=0.002)


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize(("threshold", "offset"), [(1.5, 0.0), (1.5, 0.1)])
def test_contacts_that_only_a_large_load_presses_together_rub_by_the_load(threshold: float, offset: float) -> None:
    _, x = swelling()
    y = joint(x)
    rubbed = 0.12 * np.maximum(np.abs(y) - threshold, 0.0) * dahl(x, 1.0, 0.01, 1.0)
    found = diagnosed(x, y + rubbed + offset)
    assert set(found.verdict) == {"load_dependent_friction"} | ({"torque_offset"} if offset else set())
    effect = next(effect for effect in found.effects if effect.name == "load_dependent_friction")
    assert effect.parameters["threshold"] == pytest.approx(threshold, rel=0.05)


@pytest.mark.parametrize("law", ["upper, lossy", "lower, lossy"])
def test_a_stop_that_rubs_pushes_and_gives_back_no_more_than_it_took(law: str) -> None:
    time, x = swelling()
    side = 1.0 if law.startswith("upper") else -1.0
    signals = Signals(time, x, joint(x), joint(x), [slice(0, x.size)], {})
    scene = SimulatorScene(signals, emulate(signals, None))
    (form,) = (form for form in registry.get("end_stop")().forms(scene) if form.name == law)
    columns = form.columns(scene, (0.1, 1.5))
    for weights in ((1.0, 0.0), (0.0, 1.0), (1.0, 3.0)):
        torque = columns @ weights
        assert np.all(side * torque >= 0.0)
        assert np.sum(torque[1:] * np.diff(x)) >= -1e-3 * np.max(np.abs(torque))


def test_a_clutch_that_slips_in_series_is_a_saturation_with_memory() -> None:
    """Its slip is where the joint carries no more than the clutch holds, solved for at each sample."""
    _, x = swelling()
    held, slipped, real = 3.4, 0.0, np.empty(x.size)

    def carried(at: float) -> float:
        return 4.0 * at + 0.6 * at**3

    for i, now in enumerate(x):
        if abs(carried(now - slipped)) > held:
            most = brentq(lambda at: carried(at) - held, 0.0, 2.0)
            slipped = now - np.copysign(most, now - slipped)
        real[i] = carried(now - slipped)
    time, _ = swelling(x.size)
    noise = NOISE * np.random.default_rng(5).standard_normal(x.size)
    found = diagnose(Signals(time, x, real + noise, carried(x), [slice(0, x.size)], {}))
    assert found.verdict == ["torque_saturation"]
    (report,) = (e for e in found.effects if e.name == "torque_saturation")
    assert report.parameters["limit"] == pytest.approx(held, rel=0.03)
    assert report.closed > 0.9


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize("sharp", [True, False])
def test_contacts_that_the_load_presses_together_give_way_at_a_level_and_not_at_a_deflection(sharp: bool) -> None:
    _, x = swelling()
    load, force, friction = np.abs(joint(x)), 0.0, np.zeros(x.size)
    for i in range(1, x.size):
        for _ in range(20):
            step, most = (x[i] - x[i - 1]) / 20, 0.08 * load[i] + 1e-9
            force = (
                np.clip(force + 5.0 * step, -most, most)
                if sharp
                else force + 5.0 * step - 5.0 * abs(step) * force / most
            )
            force = float(np.clip(force, -most, most))
        friction[i] = force
    found = diagnosed(x, joint(x) + friction)
    assert found.verdict == ["load_dependent_friction"]
    assert found.closed_in_all > 0.98


def springpot(time: Floats, x: Floats, order: float) -> Floats:
    """Maxwell branches two to an octave whose stiffness falls with their time constant, by its power ``-order``."""
    step, out = time[1] - time[0], np.zeros_like(x)
    for tau in np.geomspace(1e-3, 1e4, 48):
        kept = np.exp(-step / tau)
        out += tau**-order * lfilter([tau / step * (1.0 - kept)], [1.0, -kept], np.diff(x, prepend=x[0]))
    return out / np.std(out)


def heated(time: Floats, power: Floats, tau: float) -> Floats:
    """Temperature, over its largest, of what is heated by ``power`` from cold and cools in ``tau`` s."""
    step = time[1] - time[0]
    warmth = lfilter([step / tau], [1.0, step / tau - 1.0], power)
    return np.asarray(warmth / warmth.max())


def pressed(x: Floats, most: Floats) -> Floats:
    """A spring over ``x`` whose slider gives way at ``most``."""
    force = np.zeros_like(x)
    for i in range(1, x.size):
        force[i] = np.clip(force[i - 1] + 5.0 * (x[i] - x[i - 1]), -most[i], most[i])
    return force


def with_law(name: str) -> tuple[str, Floats]:
    """The effect whose law ``name`` is, and what it makes of the joint."""
    time, x = swelling()
    speed = np.gradient(x, time)
    acceleration, spring = np.gradient(speed, time), 4.0 * x + 0.6 * x**3
    worse = np.where(spring * speed > 0.0, 1.0, 0.4)
    if name == "power law, unequal":
        return "viscous_friction", joint(x) + np.where(speed > 0.0, 0.25, 0.08) * np.sign(speed) * np.abs(speed) ** 0.7
    if name == "fractional":
        return "stress_relaxation", joint(x) + 0.35 * springpot(time, x, 0.3)
    if name == "stiffness, viscous heating":
        return "thermal_drift", joint(x) * (1.0 - 0.15 * heated(time, speed**2, 8.0))
    if name == "by elastic torque, driving and driven, presliding":
        way = bristle(x, 0.01)
        return "load_dependent_friction", joint(x) + 0.12 * np.abs(spring) * np.where(
            spring * way > 0.0, 1.0, 0.4
        ) * way
    if name == "by elastic torque, driving and driven, pressed slider":
        return "load_dependent_friction", joint(x) + pressed(x, 0.1 * np.abs(spring) * worse + 1e-9)
    if name == "elastic torque, lower side, ramped":
        return "stiffness_asymmetry", joint(x) - 0.2 * spring * np.interp(-x, [0.0, 0.4], [0.0, 1.0])
    # Lagrange's equation of an inertia that changes as a cosine about the middle, or elsewhere on its turn.
    rate, begun = (1.5, 0.0) if name == "of a symmetric mechanism" else (1.1, 0.8)
    inertia, slope = 1.0 + 0.5 * np.cos(rate * x + begun), -0.5 * rate * np.sin(rate * x + begun)
    return "inertia", joint(x) + 0.03 * (inertia * acceleration + 0.5 * slope * speed**2)


@pytest.mark.parametrize(
    "law",
    [
        "power law, unequal",
        "fractional",
        "stiffness, viscous heating",
        "by elastic torque, driving and driven, presliding",
        "by elastic torque, driving and driven, pressed slider",
        "elastic torque, lower side, ramped",
        "of a symmetric mechanism",
        "of a crank",
    ],
)
def test_an_effect_is_told_with_the_law_that_it_follows(law: str) -> None:
    _, x = swelling()
    effect, torque = with_law(law)
    found = diagnosed(x, torque)
    assert found.verdict == [effect]
    (report,) = (e for e in found.effects if e.name == effect)
    assert report.law == law
    assert report.closed > 0.99


def test_a_filter_on_the_deflection_is_a_delay_and_its_time_is_told() -> None:
    time, x = swelling()
    fine = np.linspace(time[0], time[-1], 50 * (x.size - 1) + 1)
    share = 1.0 - np.exp(-(fine[1] - fine[0]) / 0.03)
    seen = lfilter([share], [1.0, share - 1.0], np.interp(fine, time, x))[::50]
    found = diagnosed(seen, joint(x))
    assert found.verdict == ["sensor_delay"]
    (report,) = (e for e in found.effects if e.name == "sensor_delay")
    assert report.parameters["deflection_lag"] == pytest.approx(0.03, rel=0.05)


def test_friction_with_a_bristle_of_its_own_dynamics_is_stribeck() -> None:
    time, x = swelling()
    speed, friction, z = np.gradient(x, time), np.zeros_like(x), 0.0
    for i in range(1, x.size):
        for _ in range(20):
            level = 0.1 + 0.15 * np.exp(-((speed[i] / 0.15) ** 2))
            z += 0.01 / 20 * speed[i] * (1.0 - np.sign(speed[i]) * z * 40.0 / level)
        friction[i] = 40.0 * z
    found = diagnosed(x, joint(x) + friction)
    assert found.verdict == ["stribeck_friction"]


def test_a_mass_behind_a_shaft_is_inertia() -> None:
    time, x = swelling()
    acceleration = np.gradient(np.gradient(x, time), time)
    late = np.interp(time - 0.012, time, acceleration)
    found = diagnosed(x, joint(x) + 0.03 * late)
    assert found.verdict == ["inertia"]
    (report,) = [e for e in found.effects if e.name == "inertia"]
    assert report.parameters["inertia"] == pytest.approx(0.03, rel=0.1)


def loose(x: Floats, half: float, inertia: float = 4e-4, flank: float = 120.0, substeps: int = 50) -> Floats:
    """The same joint as a loose load between flanks, by symplectic Euler steps."""
    h, q, rate = 0.01 / substeps, float(x[0]), 0.0
    forces, limits, stiffness = np.zeros(3), np.array([0.12, 0.15, 0.16]), np.array([6.0, 2.0, 0.8])
    out, before = np.zeros_like(x), float(x[0])
    for i, target in enumerate(x):
        pace, mean = (target - before) / 0.01, 0.0
        for step in range(substeps):
            drive = before + (target - before) * (step + 1) / substeps
            depth = drive - q - np.clip(drive - q, -half, half)
            contact = flank * depth + 0.15 * (pace - rate) if depth != 0.0 else 0.0
            contact = contact if contact * depth > 0.0 else 0.0
            rate += h / inertia * (contact - 4.0 * q - 0.6 * q**3 - forces.sum())
            q += h * rate
            forces = np.clip(forces + stiffness * h * rate, -limits, limits)
            mean += contact / substeps
        out[i], before = mean, target
    return out


def test_a_loose_load_that_hits_its_flanks_is_backlash() -> None:
    _, x = swelling(2500)
    found = diagnosed(x, joint(x) + loose(x, 0.02) - loose(x, 0.0))
    assert found.verdict == ["backlash"]
    (report,) = [e for e in found.effects if e.name == "backlash"]
    assert report.parameters["clearance"] == pytest.approx(0.04, rel=0.15)


def test_a_gain_is_told_from_a_simulator_of_coarser_structure() -> None:
    _, x = swelling()
    coarse = joint(x) + 0.4 * (1.0 - np.exp(-np.abs(x))) * 0.01
    found = diagnosed(x, 1.04 * coarse)
    assert found.verdict == ["torque_gain"]


def test_a_hum_is_no_noise_even_where_it_is_as_fast_as_the_sampling_allows() -> None:
    time, x = swelling()
    found = diagnosed(x, joint(x) + 0.05 * np.sin(2.0 * np.pi * 8.3 * time))
    assert found.verdict == ["unknown"]


def test_what_excluded_effects_leave_is_never_called_no_gap() -> None:
    _, x = swelling()
    found = diagnosed(x + 0.04, joint(x), exclude=("deflection_offset", "torque_offset"))
    assert found.verdict != []


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize(
    ("effect", "reason"),
    [
        ("viscous_friction", "stress relaxation would explain it at the end of its range"),
        (
            "stiffness_asymmetry",
            "encoder eccentricity would explain it, but on this joint stiffness asymmetry, which is not considered here, would",
        ),
    ],
)
def test_an_effect_at_the_end_of_its_range_is_not_named_for_one_that_is_excluded(effect: str, reason: str) -> None:
    time, x = swelling()
    law = {"viscous_friction": 0.05 * np.gradient(x, time), "stiffness_asymmetry": 0.2 * np.maximum(x, 0.0)}[effect]
    found = diagnosed(x, joint(x) + law, exclude=(effect,))
    assert found.verdict == ["unknown"]
    assert found.confidence >= 0.85
    assert any(note.startswith(reason) for note in found.notes)
    assert diagnosed(x, joint(x) + law).verdict == [effect]


@pytest.mark.parametrize(
    ("hardening", "effect", "exclude", "verdict"),
    [
        (0.0, "torque_offset", ("torque_offset",), ["unknown"]),
        (0.0, "torque_offset", (), ["torque_offset"]),
        (1.5, "deflection_offset", ("torque_offset",), ["deflection_offset"]),
    ],
)
def test_on_a_linear_spring_an_offset_of_the_deflection_is_not_named_for_one_of_the_torque_that_is_excluded(
    hardening: float, effect: str, exclude: tuple[str, ...], verdict: list[str]
) -> None:
    def sprung(x: Floats) -> Floats:
        return 4.0 * x + hardening * x**3 + sliders(x, ((6.0, 0.12), (2.0, 0.15), (0.8, 0.16)))

    time, x = swelling()
    y_real = sprung(x) + 0.12 if effect == "torque_offset" else sprung(x + 0.04)
    y_real = y_real + NOISE * np.random.default_rng(1).standard_normal(x.size)
    found = diagnose(Signals(time, x, y_real, sprung(x), [slice(0, x.size)], {}), exclude=exclude)
    assert found.verdict == verdict
    told = [note for note in found.notes if note.startswith("deflection offset would explain it, but on this joint")]
    assert len(told) == (verdict == ["unknown"])


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize("phase", [0.6, -0.6])
def test_a_wave_much_longer_than_the_stroke_is_an_offset_of_the_deflection(phase: float) -> None:
    def hard(x: Floats) -> Floats:
        return joint(x) + 0.9 * x**3

    time, x = swelling()
    y_real = hard(x + 0.05 * np.cos(0.5 * x + phase)) + 0.036 * np.random.default_rng(1).standard_normal(x.size)
    signals = Signals(time, x, y_real, hard(x), [slice(0, x.size)], {})
    assert diagnose(signals).verdict == ["deflection_offset"]


# ---- a sensor that counts in steps -------------------------------------------------------------------------------------


@pytest.mark.parametrize("step", [0.15, 0.3])
def test_a_coarse_torque_sensor_is_no_noise_and_its_step_is_told(step: float) -> None:
    _, x = swelling()
    found = diagnosed(x, step * np.round(joint(x) / step))
    assert found.verdict == ["unknown"]
    assert f"steps of {found.choice.torque_step:.3g} N·m" in sentence(found)
    assert any("steps of" in note for note in found.notes)
    assert found.choice.torque_step == pytest.approx(step, rel=0.01)


@pytest.mark.parametrize("levels", [20.0, 28.0])
def test_steps_on_which_a_slow_torque_stays_long_are_told_beside_the_noise_of_what_follows(levels: float) -> None:
    # From sample to sample most of their error does not change, so little of it passes for noise.
    time, x = swelling(14000, 0.0025)
    step = levels * NOISE
    y = step * np.round(joint(x) / step) + NOISE * np.random.default_rng(0).standard_normal(x.size)
    assert torque_step(Signals(time, x, y, joint(x), [slice(0, x.size)], {})) == pytest.approx(step, rel=0.01)


@pytest.mark.parametrize("make", [lambda x: joint(x), lambda x: np.round(joint(x), 3)])
def test_a_fine_sensor_has_no_steps(make: Callable[[Floats], Floats]) -> None:
    time, x = swelling()
    y = make(x) + NOISE * np.random.default_rng(0).standard_normal(x.size)
    assert torque_step(Signals(time, x, y, joint(x), [slice(0, x.size)], {})) == 0.0


# ---- operators ---------------------------------------------------------------------------------------------------------


def test_a_torque_sensor_whose_zero_and_span_drift_is_one_effect() -> None:
    time, x = swelling()
    warm = 1.0 - np.exp(-time / 12.0)
    found = diagnosed(x, joint(x) * (1.0 - 0.04 * warm) + 0.08 * warm)
    assert found.verdict == ["thermal_drift"]
    values = found.choice.hypothesis.parameters("thermal_drift")
    assert values["zero_drift"] == pytest.approx(0.08, rel=0.2)
    assert values["stiffness_drift"] == pytest.approx(-0.04, rel=0.2)


def test_a_free_load_stays_in_its_clearance_and_a_stiff_one_stays_where_it_was_left() -> None:
    time, x = swelling()
    torque, speed = joint(x), np.gradient(x, time)
    for frequency in (30.0, 300.0, 1e6):
        gap, free, hit = free_flight(time, x, speed, torque, 0.03, frequency)
        assert np.all(np.abs(gap) <= 0.03)
        assert np.all(np.abs(gap[free == 0.0]) == 0.03)
        assert np.all(hit[free == 1.0] == 0.0)
    # A load that swings infinitely fast does not get anywhere: the quasi-static clearance.
    held = clearance(x, torque, 0.03)
    assert np.mean(np.abs(gap - held) > 1e-3) < 0.02


def test_a_bristle_that_yields_at_one_level_is_dahls() -> None:
    _, x = swelling()
    np.testing.assert_allclose(yielding(x, np.ones_like(x), 0.02), bristle(x, 0.02), atol=1e-12)
    assert np.max(np.abs(yielding(x, np.full_like(x, 2.0), 0.02))) <= 2.0
