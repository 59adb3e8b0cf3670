"""Deflections that an encoder counts: the joint moves smoothly, the recording and a simulator that is fed with it do not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from joints import sliders
from numpy.typing import NDArray

from hystbench.diagnosis.corrected import CorrectedSimulator, calibrated, corrected_simulator
from hystbench.diagnosis.diagnosis import diagnose
from hystbench.diagnosis.emulator.emulation import emulate
from hystbench.diagnosis.emulator.jitter import along_what_it_follows, without_jitter
from hystbench.diagnosis.recording.noise import rms
from hystbench.diagnosis.recording.signals import Signals
from hystbench.errors import InputError

Floats = NDArray[np.float64]
NOISE = 0.08


def motion(interval: float, duration: float = 30.0) -> tuple[Floats, Floats]:
    """Time and deflection of three tones from rest, each of shape (n,)."""
    time = np.arange(round(duration / interval)) * interval
    tones = ((0.35, 0.23, 0.4), (0.2, 0.71, 2.0), (0.04, 1.9, 1.1))
    start = np.clip(0.5 * time, 0.0, 1.0)
    x = sum(size * np.sin(2.0 * np.pi * pace * time + phase) for size, pace, phase in tones)
    return time, np.asarray(x * start**2 * (3.0 - 2.0 * start))


def joint(x: Floats) -> Floats:
    return np.asarray(45.0 * x + 25.0 * x**3 + sliders(x, ((150.0, 1.2), (30.0, 0.9), (8.0, 0.6))))


def recorded(interval: float, count: float, added: str = "", fed: bool = True) -> Signals:
    """The joint with one effect, and its simulator, which is fed with the counts or knows the true deflection."""
    time, x = motion(interval)
    speed = np.gradient(x, time)
    torque = joint(x)
    gap = {"": 0.0 * x, "viscous_friction": speed, "inertia": np.gradient(speed, time)}[added]
    gap = 8.0 * NOISE * gap / max(rms(gap), 1e-300)
    counted = count * np.round(x / count)
    noise = NOISE * np.random.default_rng(4).standard_normal(x.size)
    simulated = joint(counted) if fed else torque
    return Signals(time, counted, torque + gap + noise, simulated, [slice(0, x.size)], {})


@pytest.mark.parametrize("interval", [0.005, 0.001])
@pytest.mark.parametrize("counts", [1024, 1500, 2000, 4096, 10000])
def test_the_speed_is_known_whatever_the_encoder_counts(interval: float, counts: int) -> None:
    """Median differences of counts are zero, or one or two whole numbers: they tell no noise level."""
    time, x = motion(interval)
    count = 2.0 * np.pi / counts
    signals = Signals(time, count * np.round(x / count), x, x, [slice(0, x.size)], {})
    speed = np.gradient(x, time)
    assert rms(signals.speed - speed) < 0.02 * rms(speed)
    assert rms(signals.smooth_x - x) < 0.5 * rms(signals.x - x)


@pytest.mark.thorough(but_one_in=3)
@pytest.mark.parametrize("fed", [True, False])
@pytest.mark.parametrize(
    ("interval", "added"),
    [(0.005, "viscous_friction"), (0.005, "inertia"), (0.005, ""), (0.001, "viscous_friction"), (0.001, "")],
)
def test_counts_are_no_gap_and_hide_none(interval: float, added: str, fed: bool) -> None:
    found = diagnose(recorded(interval, 2.0 * np.pi / 2048, added, fed))
    assert found.verdict == ([added] if added else [])
    assert any("noise of the recorded deflection" in note for note in found.notes) == fed
    assert any("emulated along the smoothed deflection" in note for note in found.notes) != fed


def test_what_counts_make_of_a_simulator_is_taken_out_and_the_rest_stays() -> None:
    signals = recorded(0.002, 0.003, "viscous_friction")
    quiet, emulator = without_jitter(signals, emulate(signals, None))
    _, x = motion(0.002)
    true = joint(x)
    assert rms(quiet.y_sim - true) < 0.5 * rms(signals.y_sim - true)
    assert quiet.noise_floor == pytest.approx(NOISE, rel=0.1)
    # The emulator is asked along the smoothed deflection now, and counts' speeds are still not in it.
    assert rms(emulator.predict(quiet.x) - quiet.y_sim) < 0.02 * rms(true)


def test_a_simulator_that_was_not_fed_with_the_counts_is_left_as_it_is() -> None:
    signals = recorded(0.002, 0.003, fed=False)
    emulator = emulate(signals, None)
    assert without_jitter(signals, emulator) == (signals, emulator)


@pytest.mark.parametrize("fed", [True, False])
@pytest.mark.parametrize("counted", [True, False])
def test_a_simulator_is_emulated_along_the_deflection_that_it_knows(fed: bool, counted: bool) -> None:
    signals = recorded(0.005, 0.003, fed=fed)
    if not counted:
        _, x = motion(0.005)
        seen = x + 1e-3 * np.random.default_rng(3).standard_normal(x.size)
        signals = replace(signals, x=seen, y_sim=joint(seen if fed else x))
    followed, emulator = along_what_it_follows(signals)
    if fed:
        assert followed is signals
    else:
        assert np.array_equal(followed.x, signals.smooth_x)
        assert np.array_equal(followed.y_sim, signals.y_sim)
        assert emulator.error < 0.5 * emulate(signals, None).error


@pytest.mark.parametrize(("noise", "taken_out"), [(1e-8, False), (1e-3, True)])
def test_the_rounding_of_numbers_is_no_noise_however_much_a_simulator_makes_of_it(
    noise: float, taken_out: bool
) -> None:
    """Smoothed, a hold creeps to and fro by next to nothing, which is a turn to rubber that forgets at every turn."""
    _, x = motion(0.005)
    rng = np.random.default_rng(7)
    seen = x + noise * rng.standard_normal(x.size)

    def sensitive(of: Floats) -> Floats:
        return 45.0 * x + (of - x) * NOISE / noise

    torque = sensitive(x) + NOISE * rng.standard_normal(x.size)
    signals = Signals(0.005 * np.arange(x.size), seen, torque, sensitive(seen), [slice(0, x.size)], {})
    emulator = replace(emulate(signals, None), predict=sensitive, parameters={"model": "another"})
    quiet, _ = without_jitter(signals, emulator)
    assert (quiet is not signals) == taken_out


@pytest.mark.thorough(but_one_in=3)
@pytest.mark.parametrize("seed", [1, 3, 5])
def test_what_noise_alone_might_look_like_is_not_taken_out(seed: int) -> None:
    """Rubber that was turned by the noise of the deflection forgets that but slowly: hardly anything of it is rough."""
    time, x = motion(0.005)
    rng = np.random.default_rng(seed)
    seen = x + 1e-3 * rng.standard_normal(x.size)
    turned = NOISE * np.exp(-np.maximum(time - 15.0, 0.0) / 2.0) * (time >= 15.0)

    def rubber(of: Floats) -> Floats:
        return 45.0 * x + turned * (of is seen)

    signals = Signals(time, seen, 45.0 * x + NOISE * rng.standard_normal(x.size), 45.0 * x, [slice(0, x.size)], {})
    emulator = replace(emulate(signals, None), predict=rubber, parameters={"model": "another"})
    assert without_jitter(signals, emulator)[0] is signals


def test_levels_that_are_gone_to_are_no_counts() -> None:
    """A staircase of thirty steps is the motion itself."""
    time = np.arange(3000) * 0.01
    x = 0.1 * np.round(1.5 * np.sin(2.0 * np.pi * 0.05 * time) / 0.1)
    signals = Signals(time, x, x, x, [slice(0, x.size)], {})
    assert rms(signals.smooth_x - x) < 0.01


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize("fed", [True, False])
def test_the_corrected_simulator_tells_the_speed_from_counts(fed: bool) -> None:
    """From samples up to each one only: differences of counts would be off by four times the noise."""
    signals = recorded(0.005, 0.003, "viscous_friction", fed)
    found = diagnose(signals)
    made = corrected_simulator(found, calibrated(found, None))
    assert rms(made.predict(signals.x) - signals.y_real) < 2.0 * NOISE
    stepper = made.stepper()
    assert [stepper.step(x) for x in signals.x[:50]] == pytest.approx(made.predict(signals.x[:50]))


def test_a_corrected_simulator_of_a_smooth_deflection_takes_differences_and_a_bad_window_is_told() -> None:
    _, x = motion(0.005)
    made = CorrectedSimulator(interval=0.005).fit(x, joint(x))
    assert made.parameters_["window"] == 2
    with pytest.raises(InputError, match="window must be 2 or an odd number"):
        CorrectedSimulator.from_parameters(**{**made.parameters_, "window": 8})
