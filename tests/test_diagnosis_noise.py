"""Noise and structure told apart: what a filter correlates over a few samples is noise, a hum and what moves is not."""

from __future__ import annotations

import numpy as np
import pytest
from joints import sliders
from numpy.typing import NDArray
from scipy.signal import butter, lfilter, sosfilt

from hystbench.diagnosis.diagnosis import diagnose
from hystbench.diagnosis.recording.noise import FARTHEST, independent, noise_levels, structured_power
from hystbench.diagnosis.recording.signals import Signals

Floats = NDArray[np.float64]


def filtered(white: Floats, correlation: float) -> Floats:
    """Noise of the same size whose neighbours are correlated."""
    return np.asarray(lfilter([np.sqrt(1.0 - correlation**2)], [1.0, -correlation], white))


@pytest.mark.parametrize("correlation", [0.0, 0.4])
def test_noise_that_is_correlated_over_a_few_samples_is_noise(correlation: float) -> None:
    """As an anti-aliasing filter leaves it, on samples that are not dense: it is neither smaller nor structure."""
    rng = np.random.default_rng(11)
    time = np.arange(4000) * 0.02
    x = np.sin(2.0 * np.pi * 0.31 * time) * (0.55 + 0.35 * np.sin(2.0 * np.pi * 0.047 * time)) * (1.0 - np.exp(-time))
    white = 0.02 * rng.standard_normal(x.size)
    noise = filtered(white, correlation)
    spring, speed = 4.0 * x + 0.6 * x**3, np.gradient(x, time)
    signals = Signals(time, x, spring + 0.15 * speed + noise, spring, [slice(0, x.size)], {})
    assert signals.noise_floor == pytest.approx(0.02, rel=0.1)
    assert structured_power(noise, signals.runs, signals.stride) < (0.3 * 0.02) ** 2
    hum = spring + 0.05 * np.sin(2.0 * np.pi * 12.3 * time) + 0.1 * white
    assert Signals(time, x, hum, spring, [slice(0, x.size)], {}).noise_floor < 0.05


def test_an_effect_that_changes_fast_does_not_make_correlated_noise_structure() -> None:
    """The gap of an inertia is as rough as the noise, which shows as correlated only where the inertia is taken out."""
    rng = np.random.default_rng(5)
    time = np.arange(3000) * 0.01
    start = 1.0 - np.exp(-time)
    x = start * sum(
        0.5 / f * np.sin(2.0 * np.pi * f * time + rng.uniform(0.0, 6.28)) for f in np.linspace(0.3, 4.0, 40)
    )
    y = 4.0 * x + 0.6 * x**3 + sliders(x, ((6.0, 0.12), (2.0, 0.15), (0.8, 0.16)))
    acceleration = np.gradient(np.gradient(x, time), time)
    gap = 0.3 * acceleration / np.std(acceleration)
    signals = Signals(time, x, y + gap + filtered(0.04 * rng.standard_normal(x.size), 0.45), y, [slice(0, x.size)], {})
    assert signals.stride == 1
    assert diagnose(signals).verdict == ["inertia"]


@pytest.mark.parametrize("waves", [60.0, 80.0, 100.0])
def test_a_ripple_too_fine_for_the_samples_is_no_noise_behind_a_low_pass(waves: float) -> None:
    """It is correlated over a few samples as such noise is, but only while the joint moves; ``waves`` per radian."""
    rng = np.random.default_rng(5)
    time = np.arange(4000) * 0.02
    motion = zip((0.3, 0.25, 0.2, 0.15, 0.1), (0.11, 0.23, 0.41, 0.67, 0.93), strict=True)
    x = sum(size * np.sin(2.0 * np.pi * f * time + rng.uniform(0.0, 6.28)) for size, f in motion)
    y = 4.0 * x + sliders(x, ((6.0, 0.12), (2.0, 0.15)))
    noise = 0.01 * rng.standard_normal(x.size)
    signals = Signals(time, x, y + 0.05 * np.sin(waves * x) + noise, y, [slice(0, x.size)], {})
    assert independent(noise_levels(signals.gap, signals.runs)) > FARTHEST
    assert signals.noise_floor < 0.02
    assert signals.correlated == 1


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize("cut_off", [0.15, 0.25, 0.45])
@pytest.mark.parametrize("gap", [0.0, 6.0])
def test_noise_behind_a_low_pass_is_noise(cut_off: float, gap: float) -> None:
    """``cut_off`` is a share of half the sampling frequency, ``gap`` the size of viscous friction over the noise."""
    rng = np.random.default_rng(8)
    time = np.arange(4000) * 0.01
    x = (1.0 - np.exp(-time)) * sum(
        0.5 / f * np.sin(2.0 * np.pi * f * time + rng.uniform(0.0, 6.28)) for f in np.linspace(0.15, 1.2, 12)
    )
    y = 4.0 * x + 0.6 * x**3 + sliders(x, ((6.0, 0.12), (2.0, 0.15), (0.8, 0.16)))
    noise = sosfilt(butter(2, cut_off, output="sos"), rng.standard_normal(x.size))
    size = 0.01 * np.std(y)
    speed = np.gradient(x, time)
    real = y + gap * size * speed / np.std(speed) + size * noise / np.std(noise)
    signals = Signals(time, x, real, y, [slice(0, x.size)], {})
    assert signals.noise_floor == pytest.approx(size, rel=0.2)
    found = diagnose(signals)
    assert found.verdict == (["viscous_friction"] if gap else [])


@pytest.mark.parametrize("samples_a_period", [3.7, 6.0, 9.0, 13.0, 17.0])
def test_a_hum_is_no_noise_behind_a_low_pass(samples_a_period: float) -> None:
    """Its level does not stay, whatever its period."""
    hum = np.sin(2.0 * np.pi * np.arange(4000) / samples_a_period)
    noise = 0.02 * np.random.default_rng(3).standard_normal(hum.size)
    levels = noise_levels(hum + noise, [slice(0, hum.size)])
    assert independent(levels) <= FARTHEST
