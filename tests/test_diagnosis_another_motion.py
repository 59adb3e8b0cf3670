"""A simulator as it was identified along one motion, along another."""

from __future__ import annotations

import numpy as np
import pytest
from hardening_joint import one_sine, rich_motion, signals_of, spring
from joints import sliders
from numpy.typing import NDArray

from hystbench import models
from hystbench.diagnosis.diagnosis import diagnose
from hystbench.diagnosis.emulator.emulation import emulate
from hystbench.diagnosis.emulator.generalised import Generalised
from hystbench.diagnosis.excitation import margins
from hystbench.diagnosis.recording.signals import Signals

Floats = NDArray[np.float64]
TANGENTS = "structure", "bulk", "parts"


def simulated(time: Floats, x: Floats) -> Floats:
    """A hardening spring, sliders and a damper."""
    return spring(x) + sliders(x, ((4.0, 0.1), (1.0, 0.15))) + 0.02 * np.gradient(x, time)


def of(time: Floats, x: Floats) -> Signals:
    return signals_of(time, x, simulated(time, x), simulated(time, x))


@pytest.mark.parametrize("is_at_hand", [False, True])
def test_it_answers_and_may_be_off_along_another_motion_as_along_its_own(is_at_hand: bool) -> None:
    signals = of(*rich_motion())
    model = models.get("prandtl-ishlinskii")().fit(signals.x, signals.y_sim) if is_at_hand else None
    known = emulate(signals, model)
    again = known.along(signals)
    assert np.array_equal(again.predict(0.9 * signals.x), known.predict(0.9 * signals.x))
    for name in TANGENTS:
        assert np.array_equal(getattr(again, name), getattr(known, name))
    other = of(*one_sine())
    there = known.along(other)
    assert there.predict(other.x) == pytest.approx(known.anew(other.x), abs=1e-9 * float(np.ptp(other.y_sim)))
    for name in TANGENTS:
        assert getattr(there, name).shape == (other.x.size, getattr(known, name).shape[1])


def test_a_planned_motion_is_weighed_without_identifying_the_simulator_again(monkeypatch: pytest.MonkeyPatch) -> None:
    time, x = one_sine()
    mass = 0.01 * np.gradient(np.gradient(x, time), time)
    found = diagnose(signals_of(time, x, spring(x) + mass, spring(x)))
    assert found.ambiguous == [["inertia", "miscalibration"]]

    def identified(*_: object) -> None:
        raise AssertionError("it was identified again")

    monkeypatch.setattr(Generalised, "__init__", identified)
    (settled,) = margins(found, *rich_motion())
    assert settled > 0.0
