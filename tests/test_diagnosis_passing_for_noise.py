"""What passes for noise and is none: hums, what is rough while the joint moves, spikes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from slider_joint import (
    NOISE,
    STEP,
    TIME,
    Floats,
    X,
    diagnosed,
    joint,
    signals,
)

from hystbench.diagnosis.diagnosis import diagnose
from hystbench.diagnosis.recording.hum import hum
from hystbench.diagnosis.recording.roughness import roughness
from hystbench.diagnosis.recording.signals import Signals
from hystbench.diagnosis.wording import sentence
from hystbench.reports.diagnosis_page import write_diagnosis

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


@pytest.mark.parametrize("seed", range(3))
def test_chatter_while_the_joint_creeps_is_no_noise_behind_a_low_pass(seed: int) -> None:
    """Stick and slip at a quarter of the samples' rate, in a band of low speeds."""
    rng = np.random.default_rng(seed)
    speed = np.abs(np.gradient(X, TIME))
    band = np.exp(-(((speed / np.quantile(speed, 0.15) - 1.0) / 0.7) ** 2))
    turns = np.cumsum(rng.uniform(0.15, 0.32, X.size))
    chatter = 2.0 * (turns % 1.0) - 1.0
    found = diagnosed(joint(X) + 8.0 * NOISE * band * chatter)
    assert found.verdict == ["unknown"]


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


def test_samples_that_drop_out_are_a_gap_however_few() -> None:
    y, lost = joint(X), np.random.default_rng(5).choice(X.size, 7, replace=False)
    y[lost] = 0.0
    found = diagnosed(y)
    assert found.verdict == ["unknown"]
    assert "spikes in" in sentence(found)


def test_one_outlier_is_noted_and_is_no_gap() -> None:
    found = diagnosed(spiked(0.0))
    assert found.verdict == []
    assert any("stand out" in note for note in found.notes)


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize("seed", range(4))
def test_noise_with_heavy_tails_has_no_spikes(seed: int) -> None:
    noise = NOISE * np.random.default_rng(seed).standard_t(4, X.size)
    found = diagnose(Signals(TIME, X, joint(X) + noise, joint(X), [slice(0, X.size)], {}))
    assert found.verdict == []
    assert not any("stand out" in note for note in found.notes)
