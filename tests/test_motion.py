"""Direction of motion, turning points and noise level, with and without noise."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from motions import DECAYING, through, turning_points

from hystbench.models import motion


@given(turning_points(least=1), st.sampled_from([0.0, 0.051, 0.3]))
def test_directions_follow_the_rule_of_the_dead_band(turns: list[float], band: float) -> None:
    x = np.array(turns)
    direction, extreme_low, extreme_high, wanted = 0, x[0], x[0], []
    for value in turns:
        # The plain rule: remember the extremes since the last turn; a turn is seen once the input is back by more.
        if direction >= 0:
            extreme_high = max(extreme_high, value)
        if direction <= 0:
            extreme_low = min(extreme_low, value)
        if direction >= 0 and extreme_high - value > band:
            direction, extreme_low = -1, value
        elif direction <= 0 and value - extreme_low > band:
            direction, extreme_high = 1, value
        wanted.append(direction)
    assert motion.directions(x, band).tolist() == wanted


def test_a_pause_keeps_the_direction() -> None:
    assert motion.directions(np.array([1.0, 1.0, 2.0, 2.0, 1.5, 1.5, 1.5])).tolist() == [0, 0, 1, 1, -1, -1, -1]


def test_turning_points_are_where_the_extremes_lie() -> None:
    x = through([0.0, 1.0, -0.5, 0.5, 0.2], 20)
    assert motion.turning_points(x).tolist() == [0, 20, 40, 60, 80]
    assert motion.turning_points(x, 0.4).tolist() == [0, 20, 40, 80]
    assert motion.turning_points(np.array([2.0])).tolist() == [0]
    assert motion.turning_points(np.full(5, 2.0)).tolist() == [0, 4]
    assert motion.turning_points(np.arange(5.0)).tolist() == [0, 4]


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_noise_makes_no_turning_points(seed: int) -> None:
    clean = through(DECAYING[:12], 500)
    noisy = clean + 2e-3 * np.random.default_rng(seed).normal(size=clean.size)
    assert motion.turning_points(noisy).size > 1000
    found = motion.turning_points(noisy, motion.auto_dead_band(noisy))
    wanted = motion.turning_points(clean)
    assert found.size == wanted.size
    np.testing.assert_allclose(found, wanted, atol=10)


@pytest.mark.parametrize("level", [1e-4, 1e-2, 1.0])
def test_the_noise_level_is_measured_through_motion_and_jumps(level: float) -> None:
    rng = np.random.default_rng(1)
    x = 50.0 * level * np.sin(np.linspace(0.0, 30.0, 4000)) + level * rng.normal(size=4000)
    x[2000:] += 1000.0 * level
    assert motion.noise_level(x) == pytest.approx(level, rel=0.1)
    assert motion.noise_level(x[:8]) == 0.0
    assert motion.noise_level(through([0.0, 1.0, -1.0], 500)) < 1e-14


def test_the_dead_band_never_swallows_half_cycles() -> None:
    rng = np.random.default_rng(0)
    loud = through([0.0, 1.0, -1.0], 200) + 0.2 * rng.normal(size=401)
    assert motion.auto_dead_band(loud) == pytest.approx(0.05 * np.ptp(loud))


def test_settled_from_is_where_the_range_has_been_covered() -> None:
    x = through([0.3, 1.0, -1.0, 1.0, -1.0], 100)
    first = motion.settled_from(x)
    assert 195 <= first <= 200
    growing = through([0.0, 0.2, -0.3, 0.5, -0.7, 1.0, -1.0], 100)
    assert motion.settled_from(growing) == 0
