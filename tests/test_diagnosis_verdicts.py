"""Verdicts that depend on neither units nor knocks, nor on effects that may not be named."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from development import developed
from hardening_joint import rich_motion, signals_of, spring
from numpy.typing import NDArray

from hystbench.diagnosis import registry
from hystbench.diagnosis.diagnosis import _is_better, diagnose
from hystbench.diagnosis.emulator.emulation import SimulatorScene, emulate
from hystbench.diagnosis.hypotheses.adequacy import forgiven
from hystbench.diagnosis.hypotheses.evidence import Evidence
from hystbench.diagnosis.hypotheses.library import Library
from hystbench.diagnosis.hypotheses.search import search
from hystbench.diagnosis.recording.signals import Signals
from hystbench.diagnosis.verdict.choice import choose

Floats = NDArray[np.float64]


@pytest.mark.thorough
def test_an_offset_that_may_not_be_named_is_no_eccentricity_whose_harmonics_cancel() -> None:
    case, found = developed(11103)
    assert case.effects == case.excluded == ("deflection_offset",)
    assert "encoder_eccentricity" not in found.verdict


@pytest.mark.parametrize(("length", "torque", "duration"), [(57.3, 1e-3, 1.0), (1e-3, 1e4, 0.05), (1.0, 1.0, 20.0)])
def test_verdicts_do_not_depend_on_units(length: float, torque: float, duration: float) -> None:
    time, x = rich_motion(2500)
    played = x - np.clip(x, -0.01, 0.01)
    base = signals_of(time, x, spring(played), spring(x))
    scaled = Signals(duration * time, length * x, torque * base.y_real, torque * base.y_sim, base.runs, {})
    found = diagnose(scaled)
    assert found.verdict == ["backlash"]
    (report,) = [effect for effect in found.effects if effect.name == "backlash"]
    assert report.parameters["clearance"] / length == pytest.approx(0.02, rel=0.1)


def test_less_is_forgiven_beside_a_refitted_simulator_and_more_where_the_gap_is_large() -> None:
    assert forgiven(8.0, refitted=True) < forgiven(8.0, refitted=False) < 0.1 * 8.0
    assert forgiven(500.0, refitted=False) == pytest.approx(0.3 * 500.0)


@pytest.mark.parametrize(
    ("whole", "calm", "believed"),
    [
        (["backlash", "end_stop"], ["backlash"], True),
        (["backlash"], ["backlash"], False),
        # A simulator that is off is a cause as well; it makes what a gain makes.
        (["backlash", "end_stop"], ["backlash", "miscalibration"], False),
        (["backlash", "torque_gain"], ["backlash", "miscalibration"], True),
        (["backlash", "end_stop", "miscalibration"], ["backlash", "miscalibration"], True),
        (["unknown"], ["backlash", "miscalibration"], True),
        (["unknown"], ["unknown"], False),
    ],
)
def test_a_second_look_without_knocks_is_believed_where_it_blames_less(
    whole: list[str], calm: list[str], believed: bool
) -> None:
    time, x = rich_motion()
    recorded = signals_of(time, x, spring(x) + 0.3 * x, spring(x))
    looks = [SimpleNamespace(verdict=names, explained=0.99 * recorded.gap) for names in (calm, whole)]
    assert _is_better(recorded, *looks, seed=0) == believed
    # It has to close as much.
    looks[0].explained = 0.4 * recorded.gap
    assert not _is_better(recorded, *looks, seed=0) or whole == ["unknown"]


def test_what_an_effect_makes_of_a_beginning_that_is_left_out_does_not_speak_against_it() -> None:
    """A simulator that was in motion before is emulated badly there, and a shift of its input may make any torque."""
    time, x = rich_motion()
    signals = signals_of(time, x, spring(x) + 0.1, spring(x))
    looked_at = np.arange(x.size) >= 60
    evidence = Evidence(SimulatorScene(signals, emulate(signals, None)), looked_at)
    found = search(Library(evidence, [registry.get("torque_offset")()]))
    odd = [replace(h, columns=np.where(looked_at[:, None], h.columns, 1e3 * h.columns)) for h in found]
    choice = choose(evidence, odd)
    assert choice.verdict == ["torque_offset"]
    assert choice.features["signal"] == pytest.approx(choice.features["gap"], rel=0.05)
