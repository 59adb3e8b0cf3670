"""What a recording cannot tell apart, and the motion that would."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
from development import developed
from hardening_joint import one_sine, rich_motion, signals_of, spring
from numpy.typing import NDArray

from hystbench.datasets.recording_files import DEFAULT_TIME, DEFAULT_X
from hystbench.diagnosis.blind.cases import DEVELOPMENT_PLANTS
from hystbench.diagnosis.diagnosis import diagnose
from hystbench.diagnosis.excitation import design_next, margins
from hystbench.diagnosis.wording import sentence

Floats = NDArray[np.float64]


def test_one_sine_cannot_tell_inertia_from_a_softer_spring_and_says_so() -> None:
    time, x = one_sine()
    acceleration = np.gradient(np.gradient(x, time), time)
    found = diagnose(signals_of(time, x, spring(x) + 0.02 * acceleration, spring(x)))
    stated = {name for pair in found.ambiguous for name in pair} | set(found.verdict)
    assert "inertia" in stated
    assert found.verdict != ["inertia"] or found.ambiguous


def test_what_is_as_good_beside_an_exact_simulator_is_ambiguous() -> None:
    """On a spring that is nearly linear the two offsets are the same, each with an exact simulator."""
    case, found = developed(13050, "slip", "bouc-wen")
    assert case.effects == ("torque_offset",)
    assert found.ambiguous == [["deflection_offset", "torque_offset"]]


def test_which_of_two_effects_stands_beside_another_is_ambiguous_and_not_unknown() -> None:
    # The spring is nearly linear: a small change of the emulator turns round which of the two offsets is named.
    offsets = {"deflection_offset", "torque_offset"}
    case, found = developed(18237, *DEVELOPMENT_PLANTS)
    assert set(case.effects) == {"stribeck_friction", "torque_offset"}
    assert set(found.verdict) - offsets == {"stribeck_friction"}
    assert len(offsets & set(found.verdict)) == 1
    assert [set(pair) for pair in found.ambiguous] == [offsets]
    assert 0.2 < found.confidence < 0.6
    (named,), (other,) = offsets & set(found.verdict), offsets - set(found.verdict)
    # By its title: a person's name is written with a capital.
    told = {"stribeck_friction": "Stribeck friction", named: f"{named} (or {other})".replace("_", " ")}
    assert f"comes from {' and '.join(told[name] for name in found.verdict)}; adding" in sentence(found)


def test_a_motion_is_designed_although_an_effect_follows_a_measured_channel(tmp_path: Path) -> None:
    # Drift by temperature and wear by use: the joint warms while it is used.
    time, x = rich_motion()
    warming = 8.0 * (1.0 - np.exp(-time / 12.0))
    y_sim = spring(x)
    made = replace(
        signals_of(time, x, y_sim * (1.0 - 0.003 * warming), y_sim), channels={"temperature_degc": 20.0 + warming}
    )
    found = diagnose(made)
    assert found.verdict == ["thermal_drift"]
    assert found.ambiguous == [["cyclic_softening", "thermal_drift"]]
    planned = design_next(found, tmp_path / "next.csv")
    assert planned is not None
    assert planned["settles"] == found.ambiguous


def test_the_next_recording_tells_apart_what_the_same_motion_again_would_not(tmp_path: Path) -> None:
    time, x = one_sine()
    mass = 0.01 * np.gradient(np.gradient(x, time), time)
    found = diagnose(signals_of(time, x, spring(x) + mass, spring(x)))
    pair = ["inertia", "miscalibration"]
    assert found.ambiguous == [pair]
    (same_again,) = margins(found, time, x)
    assert same_again <= 0.0
    designed = design_next(found, tmp_path / "next.csv")
    assert designed is not None
    assert designed["settles"] == [pair]
    planned = pd.read_csv(tmp_path / "next.csv")
    (settled,) = margins(found, planned[DEFAULT_TIME].to_numpy(), planned[DEFAULT_X].to_numpy())
    assert settled > 0.0
    assert np.max(np.abs(planned[DEFAULT_X])) <= np.max(np.abs(x)) * 1.001


def test_a_motion_is_promised_only_where_it_settles_the_pair(tmp_path: Path) -> None:
    """Offsets of the torque and of a nearly linear spring's deflection differ by the spring's curvature."""
    time, x = rich_motion()
    pair = ["deflection_offset", "torque_offset"]

    def with_an_offset(x: Floats, hardening: float) -> tuple[Floats, Floats]:
        y_sim = spring(x, hardening, hardening)
        return y_sim + 0.06, y_sim

    straight = diagnose(signals_of(time, x, *with_an_offset(x, 0.03)))
    assert straight.ambiguous == [pair]
    assert design_next(straight, tmp_path / "none.csv") is None

    found = diagnose(signals_of(time, x, *with_an_offset(x, 0.08)))
    assert found.ambiguous == [pair]
    designed = design_next(found, tmp_path / "next.csv")
    assert designed is not None
    assert designed["settles"] == [pair]
    planned = pd.read_csv(tmp_path / "next.csv")
    more = planned[DEFAULT_X].to_numpy()
    y_real, y_sim = np.hstack([with_an_offset(x, 0.08), with_an_offset(more, 0.08)])
    later = time[-1] + 1.0 + planned[DEFAULT_TIME].to_numpy()
    both = signals_of(np.concatenate([time, later]), np.concatenate([x, more]), y_real, y_sim)
    settled = diagnose(replace(both, runs=[slice(0, x.size), slice(x.size, both.x.size)]))
    assert settled.verdict == ["torque_offset"]
    assert settled.ambiguous == []
