"""Rubber that softens as far as it was stretched (Mullins), and what only looks like wear."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hardening_joint import rich_motion, signals_of, spring
from numpy.typing import NDArray

from hystbench.diagnosis.diagnosis import diagnose

Floats = NDArray[np.float64]
TIME = np.arange(4000) * 0.01
MOTIONS = {
    "steps up": np.interp(np.floor(TIME / 8.0), np.arange(5), [0.2, 0.4, 0.6, 0.8, 0.9]),
    "up and down": np.interp(np.floor(TIME / 4.0), np.arange(11), [0.2, 0.4, 0.2, 0.6, 0.4, 0.6, 0.8, 0.3, 0.9, 0.5, 0.5]),
}  # fmt: skip
WORN: dict[str, Callable[[Floats, Floats], Floats]] = {
    "in proportion to the largest deflection": lambda x, farthest: farthest,
    "as its square": lambda x, farthest: farthest**2,
    "below the largest deflection": lambda x, farthest: farthest - np.abs(x),
    "below the largest energy": lambda x, farthest: 1.0 - np.exp((x**2 - farthest**2) / 0.36),
}


@pytest.mark.thorough(but_one_in=3)
@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("worn", WORN)
def test_rubber_softens_as_far_as_it_was_stretched(worn: str, motion: str) -> None:
    x = np.sin(np.pi * TIME) * MOTIONS[motion] * (1.0 - np.exp(-TIME / 0.3))
    lost = WORN[worn](x, np.maximum.accumulate(np.abs(x)))
    found = diagnose(signals_of(TIME, x, spring(x) * (1.0 - 0.2 * lost / np.max(lost)), spring(x)))
    assert found.verdict == ["cyclic_softening"]
    assert found.ambiguous == []


def test_what_is_stretched_as_far_as_ever_from_the_start_is_a_gain_and_no_softening() -> None:
    x = 0.8 * np.cos(np.pi * TIME)
    found = diagnose(signals_of(TIME, x, 0.86 * spring(x), spring(x)))
    assert "cyclic_softening" not in found.verdict


@pytest.mark.thorough(but_one_in=2)
@pytest.mark.parametrize("stiffness", [4.77, 5.25])
def test_a_spring_without_losses_that_is_off_is_no_effect_that_is_over_at_once_or_never_begins(
    stiffness: float,
) -> None:
    """What an emulator's ripples lose is lost in the first instants; a spectrum's third branch alone outlasts the recording."""
    time, x = rich_motion()
    mass = 0.05 * np.gradient(np.gradient(x, time), time)

    def joint(stiffness: float) -> Floats:
        return stiffness * x / (1.0 + np.abs(x) / 0.9) + mass

    found = diagnose(signals_of(time, x, joint(stiffness), joint(5.0), noise_level=0.002))
    assert found.verdict == ["miscalibration"]
