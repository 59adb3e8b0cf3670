"""Recordings of one joint that are diagnosed together: a short one and a long one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hardening_joint import rich_motion, signals_of, spring
from numpy.typing import NDArray

from hystbench.diagnosis.diagnosis import diagnose
from hystbench.diagnosis.recording.signals import Signals

Floats = NDArray[np.float64]
SHORT, LONG = 1500, 12000
"""Samples: a quarter of a minute, and two minutes."""


def short_and_long(real: Callable[[Floats, Floats, Floats], Floats]) -> Signals:
    """Both recordings of a joint whose torque is ``real`` of time, deflection and the simulator's torque, each from a rest."""
    motions = [rich_motion(size) for size in (SHORT, LONG)]
    simulated = [spring(x) for _, x in motions]
    recorded = [real(time, x, y) for (time, x), y in zip(motions, simulated, strict=True)]
    time = np.concatenate([motions[0][0], motions[0][0][-1] + 1.0 + motions[1][0]])
    together = signals_of(
        time, np.concatenate([x for _, x in motions]), np.concatenate(recorded), np.concatenate(simulated)
    )
    return replace(together, runs=[slice(0, SHORT), slice(SHORT, SHORT + LONG)])


def warmed_up(time: Floats, x: Floats, y_sim: Floats) -> Floats:
    return y_sim + 0.15 * (1.0 - np.exp(-time / 2.5))


def run_in(time: Floats, x: Floats, y_sim: Floats) -> Floats:
    travel = np.cumsum(np.abs(np.diff(x, prepend=x[0])))
    return y_sim * (1.0 - 0.1 * (1.0 - np.exp(-travel / 2.5)))


@pytest.mark.parametrize(("effect", "real"), [("thermal_drift", warmed_up), ("cyclic_softening", run_in)])
def test_what_is_soon_over_in_a_long_recording_is_seen_in_a_short_one(
    effect: str, real: Callable[[Floats, Floats, Floats], Floats]
) -> None:
    found = diagnose(short_and_long(real))
    assert found.verdict == [effect]
    constant = next(value for name, value in found.effects[0].parameters.items() if name.endswith("_constant"))
    assert constant == pytest.approx(2.5, rel=0.25)
