"""Noise and filters: reproducible, causal where they say so, and equal to the textbook's recursion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hystbench.bench.conditions import CONDITIONS, apply, conditions_for, tune
from hystbench.datasets import Dataset, Recording, get

SIGMA_X, SIGMA_Y = 2e-3, 3e-2


def dataset(n: int = 800, step: float = 0.01) -> Dataset:
    time = step * np.arange(n)
    x = np.sin(2.0 * np.pi * 0.5 * time)
    recording = Recording("sine", time, x, 4.0 * x**3, 10)
    return Dataset(
        id="a-sine", title="", train=[recording], test=[replace(recording, name="again")], split="", x_name="x",
        x_unit="rad", y_name="y", y_unit="N·m", source="", licence="", x_sigma=SIGMA_X, y_sigma=SIGMA_Y,
        plant=lambda time, x: 4.0 * x**3,
    )  # fmt: skip


def test_noise_has_the_stated_deviation_and_its_own_seed_everywhere() -> None:
    original = dataset(4000)
    first, again, other = (apply(original, "noisy", seed) for seed in (1, 1, 2))
    assert np.array_equal(first.train[0].x, again.train[0].x)
    noises = []
    for data in (first, other):
        for part, clean in ((data.train[0], original.train[0]), (data.test[0], original.test[0])):
            noises += [(part.x - clean.x) / SIGMA_X, (part.y - clean.y) / SIGMA_Y]
    correlations = np.corrcoef(noises)
    assert np.abs(correlations - np.eye(len(noises))).max() < 0.08
    assert np.std(noises, axis=1) == pytest.approx(1.0, abs=0.05)
    assert first.truth == original.test
    assert first.filter["x_noise_rms"] == pytest.approx(SIGMA_X, rel=0.05)


def test_clean_is_the_recording_itself() -> None:
    data = apply(dataset(), "clean", 0)
    assert data.train[0].y is dataset().train[0].y or np.array_equal(data.train[0].y, dataset().train[0].y)
    assert data.filter["false_reversals"] == 0.0


def test_filters_take_noise_and_false_reversals_away() -> None:
    found = {name: apply(dataset(), name, 0).filter for name in ("noisy", "kalman", "smoothed")}
    for channel in ("x_noise_rms", "y_noise_rms"):
        assert found["smoothed"][channel] < found["kalman"][channel] < 0.8 * found["noisy"][channel]
    assert (
        found["smoothed"]["false_reversals"] <= found["kalman"]["false_reversals"] < found["noisy"]["false_reversals"]
    )


def test_the_filter_equals_the_textbooks_recursion() -> None:
    original = dataset(300)
    noisy, filtered = apply(original, "noisy", 3), apply(original, "kalman", 3)
    ratio = tune(noisy.train, (SIGMA_X, SIGMA_Y))
    step = 0.01
    transition = np.array([[1, step, step**2 / 2], [0, 1, step], [0, 0, 1]])
    noise = ratio * SIGMA_X**2 * np.array(
        [[step**5 / 20, step**4 / 8, step**3 / 6], [step**4 / 8, step**3 / 3, step**2 / 2], [step**3 / 6, step**2 / 2, step]]
    )  # fmt: skip
    series = noisy.test[0].x
    state = np.array([series[0], 0.0, 0.0])
    covariance = SIGMA_X**2 * np.diag([1.0, (1e4 / step) ** 2, (1e4 / step**2) ** 2])
    expected = []
    for value in series:
        state, covariance = transition @ state, transition @ covariance @ transition.T + noise
        gain = covariance[:, 0] / (covariance[0, 0] + SIGMA_X**2)
        state = state + gain * (value - state[0])
        covariance = covariance - np.outer(gain, covariance[0])
        expected.append(state[0])
    assert filtered.test[0].x == pytest.approx(np.array(expected), abs=1e-6)


def test_the_tuned_filter_is_near_the_best_of_its_kind() -> None:
    from hystbench.bench.conditions import _filter

    original = dataset(3000)
    noisy = apply(original, "noisy", 0)
    ratio = tune(noisy.train, (SIGMA_X, SIGMA_Y))

    def error(factor: float) -> float:
        r = noisy.train[0]
        return float(np.std((_filter(r.time, r.y, SIGMA_Y, factor * ratio, False) - original.train[0].y)[100:]))

    assert error(1.0) < 1.15 * min(error(10.0**k) for k in (-2.0, -1.0, -0.5, 0.5, 1.0, 2.0))


def test_the_kalman_filter_is_causal_and_the_smoother_is_not() -> None:
    from hystbench.bench.conditions import _filter

    time = np.arange(200) / 100.0
    series = np.sin(time)
    changed = np.where(time > 1.0, series + 1.0, series)
    for smooth in (False, True):
        one, other = (_filter(time, s, 0.01, 1e4, smooth) for s in (series, changed))
        assert np.array_equal(one[time <= 1.0], other[time <= 1.0]) is (not smooth)


def test_uneven_sampling_is_filtered_with_its_own_steps() -> None:
    from hystbench.bench.conditions import _filter

    generator = np.random.default_rng(0)
    even = np.arange(600) / 100.0
    uneven = np.sort(even + generator.uniform(-0.004, 0.004, even.size))
    noise = 0.02 * generator.standard_normal(even.size)
    results = [
        np.std((_filter(t, np.sin(3 * t) + noise, 0.02, 1e5, False) - np.sin(3 * t))[50:]) for t in (even, uneven)
    ]
    assert results[1] < 1.1 * results[0]
    assert results[1] < 0.015


def test_conditions_follow_the_kind_of_data() -> None:
    recorded = replace(dataset(), plant=None)
    assert conditions_for(recorded) == ("recorded", "kalman", "smoothed")
    assert set(conditions_for(dataset())) | {"recorded"} == set(CONDITIONS)
    data = apply(recorded, "recorded", 0)
    assert np.array_equal(data.test[0].x, recorded.test[0].x)
    assert np.isnan(data.filter["x_noise_rms"])
    with pytest.raises(ValueError, match="does not apply to recorded data"):
        apply(recorded, "noisy", 0)


def test_noisy_reversals_of_the_published_loop_are_false_ones() -> None:
    published = get("vsa-published")().load()
    noisy = apply(published, "noisy", 0).filter
    # Six turns are real; the angle sensor's noise makes many more.
    assert noisy["true_reversals"] == 6.0
    assert noisy["false_reversals"] > 50.0
