"""Models that were fitted to the joint: where their parameters went for what they lack, and recordings without a clock."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from joints import sliders, through_a_clearance
from numpy.typing import NDArray

from hystbench import models
from hystbench.datasets import Dataset, Recording, concatenate
from hystbench.diagnosis.diagnosis import known_effects
from hystbench.diagnosis.emulator.emulation import emulate
from hystbench.diagnosis.from_benchmark import diagnose_model, gap_signals
from hystbench.diagnosis.hypotheses.refitting import refitted_beside
from hystbench.diagnosis.recording.signals import Signals

Floats = NDArray[np.float64]
NOISE = 0.01
ELEMENTS = ((4.0, 0.2), (1.0, 0.3))


def joint(x: Floats) -> Floats:
    """A spring and two sliders."""
    return 3.0 * x + sliders(x, ELEMENTS)


def recording(rate: float, amplitude: float, damping: float) -> Recording:
    time = np.linspace(0.0, 3.0 / rate, 900)
    x = amplitude * np.sin(2 * np.pi * rate * time)
    noise = NOISE * np.random.default_rng(round(10 * rate)).standard_normal(x.size)
    y = joint(x) + damping * np.gradient(x, time) + noise
    return Recording(f"{rate} Hz", time, x, y, warm_up=100)


def dataset(timed: bool = True) -> Dataset:
    train = [recording(rate, 0.8, 0.08) for rate in (0.4, 0.5)]
    test = [recording(rate, amplitude, 0.08) for rate, amplitude in ((0.1, 0.8), (0.5, 0.5), (1.0, 0.8))]
    return Dataset(
        "made", "made", train, test, "other rates", "angle", "rad", "torque", "N·m", "here", "CC0-1.0", 1e-6, NOISE,
        timed=timed,
    )  # fmt: skip


def one_recording(damping: float) -> Signals:
    made = [recording(rate, 0.8, damping) for rate in (0.1, 1.0)]
    time = np.concatenate([r.time for r in made])
    x, y = (np.concatenate(parts) for parts in zip(*((r.x, r.y) for r in made), strict=True))
    runs = [slice(0, 900), slice(900, 1800)]
    model = models.get("prandtl-ishlinskii")().fit(x, y, np.repeat([0, 1], 900))
    return Signals(time, x, y, model.predict(x, np.repeat([0, 1], 900)), runs, {})


def share_outside(columns: Floats, wanted: Floats) -> float:
    left = wanted - columns @ np.linalg.lstsq(columns, wanted, rcond=None)[0]
    return float(np.sum(np.square(left)) / np.sum(np.square(wanted)))


def test_the_directions_hold_what_a_model_took_of_the_effect_that_it_lacks() -> None:
    signals, groups = one_recording(0.3), np.repeat([0, 1], 900)
    model = models.get("prandtl-ishlinskii")().fit(signals.x, signals.y_real, groups)
    before = repr(model.parameters_)
    emulator = refitted_beside(signals, model, emulate(signals, model), known_effects())
    # Without damping the same joint would have been identified like this.
    unbiased = models.get("prandtl-ishlinskii")().fit(
        signals.x, np.concatenate([joint(signals.x[run]) for run in signals.runs]), groups
    )
    bias = unbiased.predict(signals.x, groups) - signals.y_sim
    assert np.std(bias) > 3.0 * NOISE
    assert share_outside(emulator.bulk, bias) < 0.05
    assert emulator.structure.shape == (signals.x.size, 0)
    assert repr(model.parameters_) == before


def test_few_directions_cannot_make_up_for_the_effect_itself() -> None:
    signals, groups = one_recording(0.3), np.repeat([0, 1], 900)
    model = models.get("prandtl-ishlinskii")().fit(signals.x, signals.y_real, groups)
    emulator = refitted_beside(signals, model, emulate(signals, model), known_effects())
    damping = np.concatenate([np.gradient(signals.x[run], signals.time[run]) for run in signals.runs])
    assert emulator.bulk.shape[1] <= len(known_effects()) + 1
    assert share_outside(emulator.bulk, damping) > 0.3


class _Given:
    """A simulator that can only be asked, not fitted."""

    def predict(self, x: Floats, groups: NDArray[np.intp] | None = None) -> Floats:
        return joint(x)


def test_a_model_that_cannot_be_fitted_keeps_its_tangents() -> None:
    signals = one_recording(0.3)
    model = models.get("prandtl-ishlinskii")().fit(signals.x, signals.y_real, np.repeat([0, 1], 900))
    emulator = emulate(signals, model)
    assert refitted_beside(signals, _Given(), emulator, known_effects()) is emulator


def test_a_model_that_was_fitted_to_the_same_recordings_keeps_its_tangents_and_lacks_nothing() -> None:
    made = [recording(rate, 0.8, 0.0) for rate in (0.1, 1.0)]
    data = replace(dataset(), train=made, test=[replace(r, warm_up=0) for r in made])
    model = models.get("prandtl-ishlinskii")().fit(*concatenate(data.train))
    signals = gap_signals(model, data)
    emulator = emulate(signals, model)
    assert refitted_beside(signals, model, emulator, known_effects()) is emulator
    assert diagnose_model(model, data).verdict == []


@pytest.mark.parametrize("timed", [True, False])
def test_without_a_clock_nothing_is_said_of_rates(timed: bool) -> None:
    data = dataset(timed)
    model = models.get("prandtl-ishlinskii")().fit(*concatenate(data.train))
    found = diagnose_model(model, data)
    of_time = {"viscous_friction", "stribeck_friction", "inertia", "stress_relaxation", "thermal_drift"}
    if timed:
        assert found.verdict == ["viscous_friction"]
        assert of_time.isdisjoint(found.excluded)
    else:
        assert of_time <= set(found.excluded)
        assert of_time.isdisjoint(found.verdict)


@pytest.mark.parametrize("kind", [pytest.param("dahl", marks=pytest.mark.thorough), "prandtl-ishlinskii"])
def test_a_model_and_a_clearance_are_fitted_together(kind: str) -> None:
    made = []
    for rate, amplitude in ((0.4, 0.8), (0.5, 0.5), (0.45, 0.65)):
        time = np.linspace(0.0, 3.0 / rate, 900)
        x = amplitude * np.sin(2 * np.pi * rate * time)
        noise = NOISE * np.random.default_rng(round(100 * rate)).standard_normal(x.size)
        made.append(Recording(f"{rate} Hz", time, x, through_a_clearance(x, 0.3, 3.0, ELEMENTS) + noise, warm_up=100))
    data = replace(dataset(), train=made[:2], test=made[1:])
    model = models.get(kind)().fit(*concatenate(data.train))
    signals = gap_signals(model, data)
    beside = refitted_beside(signals, model, emulate(signals, model), known_effects())
    # The model was fitted soft to make up for the clearance; beside it, it answers like the joint itself.
    wanted = np.concatenate([joint(signals.x[run]) for run in signals.runs])
    before, after = (np.std(given - wanted) for given in (signals.y_sim, beside.predict(signals.x)))
    assert before > 0.1 * np.std(wanted)
    assert after < 0.2 * before
    found = diagnose_model(model, data)
    assert found.verdict == ["backlash"]
    assert found.choice.hypothesis.parameters("backlash")["clearance"] == pytest.approx(0.3, abs=0.02)
    assert found.closed_in_all > 0.8
