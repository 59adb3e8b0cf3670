"""The blind check: plants, sealed labels, what further recordings settle, scores and the page."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from markupsafe import escape
from numpy.typing import NDArray

from hystbench.diagnosis.blind import cases as bank_module
from hystbench.diagnosis.blind import check as check_module
from hystbench.diagnosis.blind.carry_over import found_closed, predicted_closed, signal_on
from hystbench.diagnosis.blind.cases import (
    DEVELOPMENT_PLANTS,
    TEST_PLANTS,
    available,
    bank,
    effects_of,
    group,
    quick_part,
)
from hystbench.diagnosis.blind.check import check, diagnose_blind, examine, seal, unseal
from hystbench.diagnosis.blind.cost import growth, measure
from hystbench.diagnosis.blind.motions import MOTIONS
from hystbench.diagnosis.blind.plants import EFFECTS, VARIED, Case, make, plant_of
from hystbench.diagnosis.blind.scoring import (
    expected_calibration_error,
    is_right,
    poor_is_right,
    score,
    settled,
    wilson,
)
from hystbench.diagnosis.blind.varied_plant import LAWS, Law, VariedJoint
from hystbench.diagnosis.blind.varied_plant import OUTSIDE as VARIED_OUTSIDE
from hystbench.diagnosis.diagnosis import diagnose
from hystbench.errors import InputError
from hystbench.reports.blind_page import _matrix

Floats = NDArray[np.float64]


@pytest.fixture
def mujoco_plant() -> Any:
    pytest.importorskip("mujoco")
    from hystbench.diagnosis.blind import mujoco_plant

    return mujoco_plant


# ---- the bank ------------------------------------------------------------------------------------------------------


def test_banks_of_tuning_and_of_reporting_share_no_plant() -> None:
    assert not set(DEVELOPMENT_PLANTS) & set(TEST_PLANTS)
    cases = bank(["asymmetric"], 1, 500)
    assert {name for case in cases for name in case.effects} >= set(EFFECTS)
    assert {case.ratio for case in cases} >= {2.0, 4.0, 8.0, 16.0}
    assert len({case.seed for case in cases}) == len(cases)


def test_a_quick_run_has_every_group_of_every_plant() -> None:
    cases = bank(["asymmetric", "slip"], 1, 500)
    quick = quick_part(cases)
    assert len(quick) < len(cases) / 8
    assert {(case.plant, group(case)) for case in quick} == {(case.plant, group(case)) for case in cases}


def test_without_mujoco_its_plant_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bank_module, "find_spec", lambda name: None)
    assert available() == ("asymmetric",)
    monkeypatch.setattr(bank_module, "find_spec", lambda name: object())
    assert available() == TEST_PLANTS


# ---- plants --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", sorted(EFFECTS))
def test_a_plant_effect_has_the_size_that_was_asked_for(name: str) -> None:
    made = make(Case("asymmetric", (name,), 4.0, 0.0, "rich", 77), seconds=15.0)
    size = float(np.sqrt(np.mean(np.square(made.contributions[name]))))
    assert size / made.noise == pytest.approx(4.0, rel=0.05)


@pytest.mark.parametrize("name", sorted({*EFFECTS} - {"cyclic_softening", "thermal_drift"}))
def test_a_plant_is_the_same_joint_along_another_motion(name: str) -> None:
    """Driven along a part of its first motion, it answers with that part of its first torque."""
    plant, time, x = plant_of(Case("asymmetric", (name,), 4.0, 0.0, "rich", 78), 12.0)
    half = time.size // 2
    _, whole = plant.joint.real(time, x, plant.sizes)
    _, part = plant.joint.real(time[:half], x[:half], plant.sizes)
    # The last samples' derivatives know no later ones.
    assert part[:-5] == pytest.approx(whole[: half - 5], abs=1e-3 * float(np.std(whole)))


def law_of(name: str, law: Law) -> tuple[VariedJoint, Floats, Floats]:
    """A joint of the varied plant that follows the law, and the motion for which it was designed."""

    def motion(reach: float) -> tuple[Floats, Floats]:
        return MOTIONS["stairs"](np.random.default_rng(3), reach, 20.0, 100.0)

    for seed in range(100):
        joint = VariedJoint(seed, 0.0, motion)
        if joint.law(name) is law:
            return joint, *motion(joint.reach)
    raise AssertionError(f"no joint draws {law.__name__}")


LAWS_AND_OUTSIDE = [(name, law) for name, laws in LAWS.items() for law in laws] + list(VARIED_OUTSIDE.items())


@pytest.mark.parametrize(("name", "law"), LAWS_AND_OUTSIDE, ids=lambda value: getattr(value, "__name__", value))
def test_every_drawn_law_changes_what_is_recorded_and_more_the_larger_it_is(name: str, law: Law) -> None:
    joint, time, x = law_of(name, law)
    gaps = []
    for size in (1.0, 3.0):
        measured, torque = joint.real(time, x, {name: size})
        assert np.all(np.isfinite(torque))
        assert np.all(np.isfinite(measured))
        again = joint.real(time, x, {name: size})
        np.testing.assert_array_equal(torque, again[1])
        none = joint.real(time, measured, {})[1]
        gaps.append(float(np.sqrt(np.mean(np.square(torque - none)))))
    assert 0.0 < gaps[0] < gaps[1]


def test_banks_of_tuning_know_every_effect() -> None:
    assert set(LAWS) == set(EFFECTS)
    assert {name for case in bank([VARIED], 1, 500) for name in case.effects} >= {*LAWS, *VARIED_OUTSIDE}


def base_torque(design: Any, time: Floats, x: Floats) -> Floats:
    """The MuJoCo plant's base by hand: crank springs from the geometry, slip elements one by one."""
    arm, anchor, rest = 0.05, 0.12, design.rest * np.hypot(0.05, 0.12)
    torque = np.zeros_like(x)
    for side in (-1.0, 1.0):
        length = np.sqrt(arm**2 + anchor**2 + 2.0 * side * arm * anchor * np.sin(x))
        torque += design.spring * (length - rest) * side * arm * anchor * np.cos(x) / length
    force, last = np.zeros_like(design.loss), 0.0
    for i, at in enumerate(x):
        force = np.clip(force + design.stiffness * (at - last), -design.loss, design.loss)
        last = at
        torque[i] += force.sum()
    return torque


def test_the_mujoco_base_is_what_its_elements_say(mujoco_plant: Any) -> None:
    plant, time, x = plant_of(Case("mujoco", (), 0.0, 0.0, "rich", 3), 10.0)
    joint = plant.joint
    _, torque = joint.real(time, x, {})
    by_hand = base_torque(joint._base, time, x)
    # Slip elements have masses and friction a solver's softness: a few per cent, mostly a lag of milliseconds.
    assert float(np.std((torque - by_hand)[20:])) < 0.03 * float(np.std(by_hand))
    assert float(np.std(joint.simulated(time, x) - torque)) < 3.0 * plant.noise


def expected_gaps() -> dict[str, Callable[[Any, Floats, Floats], Floats]]:
    def speed(time: Floats, x: Floats) -> Floats:
        return np.gradient(x, time)

    return {
        "viscous_friction": lambda d, time, x: d.damping * speed(time, x),
        "coulomb_friction": lambda d, time, x: d.friction[0] * np.clip(speed(time, x) / d.friction[1], -1.0, 1.0),
        "inertia": lambda d, time, x: d.inertia * np.gradient(speed(time, x), time),
        "end_stop": lambda d, time, x: d.stop[0] * d.stop[2] * np.maximum(d.stop[0] * x - d.stop[1], 0.0),
        "stiffness_asymmetry": lambda d, time, x: d.one_sided[0] * d.one_sided[1] * np.maximum(d.one_sided[0] * x, 0.0),
    }


@pytest.mark.parametrize("name", sorted(expected_gaps()))
def test_mujoco_elements_make_the_torque_that_they_are_meant_to(mujoco_plant: Any, name: str) -> None:
    plant, time, x = plant_of(Case("mujoco", (name,), 8.0, 0.0, "rich", 5), 8.0)
    joint = plant.joint
    (size,) = plant.sizes.values()
    order = [*mujoco_plant.EFFECTS, *mujoco_plant.OUTSIDE]
    rng = np.random.default_rng([joint._seed, 2, order.index(name)])
    design = mujoco_plant.EFFECTS[name](joint._base, size, joint._typical, rng)
    gap = plant.contribution(time, x, name)
    wanted = expected_gaps()[name](design, time, x)
    assert float(np.sqrt(np.mean(np.square(gap)))) == pytest.approx(8.0 * plant.noise, rel=0.05)
    assert float(np.std(gap - wanted)) < 0.25 * float(np.std(wanted))


def test_the_mujoco_sensor_delays_scales_shifts_and_saturates(mujoco_plant: Any) -> None:
    plant, time, _ = plant_of(Case("mujoco", (), 0.0, 0.0, "rich", 6), 5.0)
    torque = np.sin(3.0 * time)
    design = plant.joint._base
    late = mujoco_plant._sensed(replace(design, delay=0.0137), torque, 0.01)
    assert late[20:] == pytest.approx(np.sin(3.0 * (time[20:] - 0.0137)), abs=2e-3)
    other = mujoco_plant._sensed(replace(design, gain=1.2, bias=0.1, most=1.0), torque, 0.01)
    assert other == pytest.approx(np.clip(1.2 * torque + 0.1, -1.0, 1.0), abs=1e-9)


def test_a_loose_mujoco_shaft_trails_by_half_its_clearance_under_load(mujoco_plant: Any) -> None:
    plant, _, _ = plant_of(Case("mujoco", (), 0.0, 0.0, "rich", 8), 6.0)
    joint, size = plant.joint, 2.0
    half = 0.5 * size * 0.05 * joint.reach
    time = np.arange(600) * 0.01
    # One slow sweep, the torque positive all the way: what is left of it once the clearance is taken up.
    x = 0.8 * joint.reach * (0.5 - 0.5 * np.cos(np.pi * time / 6.0))
    _, torque = joint.real(time, x, {"backlash": size})
    behind = base_torque(joint._base, time, np.maximum(x - half, 0.0))
    loaded = x > 0.2 * joint.reach
    assert torque[loaded] == pytest.approx(behind[loaded], abs=0.02 * float(np.max(behind)))
    assert np.max(np.abs(joint.real(time, x, {})[1] - behind)[loaded]) > 0.03 * float(np.max(behind))


# ---- sealing and diagnosing ----------------------------------------------------------------------------------------


def test_a_seal_shows_tampering_and_the_recording_alone_is_diagnosed(tmp_path: Path) -> None:
    tasks, laboratories = seal([Case("asymmetric", ("torque_offset",), 8.0, 0.0, "rich", 5)], tmp_path, 1)
    assert set(tasks[0]) == {"id", "real", "sim", "exclude"}
    assert set(laboratories) == {tasks[0]["id"]}
    assert unseal(tmp_path)[tasks[0]["id"]]["truth"] == ["torque_offset"]
    assert diagnose_blind(tmp_path, tasks[0])[0]["verdict"] == ["torque_offset"]
    text = (tmp_path / "labels.json").read_text(encoding="utf-8")
    (tmp_path / "labels.json").write_text(text.replace("torque_offset", "torque_gain"), encoding="utf-8")
    with pytest.raises(InputError, match="seal"):
        unseal(tmp_path)
    assert json.loads((tmp_path / "tasks.json").read_text(encoding="utf-8")) == tasks


def test_an_ambiguous_sine_is_settled_by_the_recording_that_is_asked_for(tmp_path: Path) -> None:
    tasks, laboratories = seal([Case("slip", ("viscous_friction",), 4.0, 0.0, "one sine", 3)], tmp_path, 1)
    record = examine(tmp_path, tasks[0], laboratories[tasks[0]["id"]])
    label = unseal(tmp_path)[tasks[0]["id"]]
    assert record["ambiguous"], "one sine cannot tell viscous friction from delay"
    planned = pd.read_csv(tmp_path / "recordings" / "0000-next.csv")
    recorded = pd.read_parquet(tmp_path / "recordings" / "0000-next-real.parquet")
    assert recorded["deflection_rad"].to_numpy() == pytest.approx(planned["deflection_rad"].to_numpy(), abs=1e-2)
    assert record["again"]["verdict"] == ["viscous_friction"]
    assert all(settled(record, label))


def test_what_is_driven_again_is_the_recording_without_what_the_scorer_asks_for() -> None:
    for effects in (("encoder_eccentricity",), ("viscous_friction",)):
        plant, time, x = plant_of(Case("slip", effects, 8.0, 0.04, "rich", 5), 10.0)
        made, driven = (drive(time, x, np.random.default_rng(7)) for drive in (plant.record, plant.drive))
        for name in ("x", "y_real", "y_sim"):
            assert np.array_equal(getattr(made, name), getattr(driven, name))


def test_costs_are_those_of_real_diagnoses_the_shortest_first() -> None:
    costs = measure((900, 300))
    assert [cost["samples"] for cost in costs] == [300, 900]
    assert all(0.0 < cost["seconds"] < 60.0 for cost in costs)
    peaks = [cost["peak_mb"] for cost in costs]
    assert peaks == [None, None] or 50.0 < peaks[0] <= peaks[1]


@pytest.mark.parametrize("effect", ["viscous_friction", "backlash"])
def test_carried_over_to_another_motion_the_prediction_holds(effect: str) -> None:
    plant, time, x = plant_of(Case("slip", (effect,), 8.0, 0.0, "rich", 21), 30.0)
    made = plant.record(time, x, np.random.default_rng(1))
    found = diagnose(made.signals)
    assert found.verdict == [effect]
    slow = 0.3 * plant.joint.reach * np.sin(0.8 * time)
    there = plant.record(time, slow, np.random.default_rng(2))
    signal = signal_on(found, there.time, there.x, there.y_sim)
    predicted = predicted_closed(found, signal)
    assert signal == pytest.approx(there.contributions[effect], abs=0.2 * plant.noise + 0.1 * np.ptp(signal))
    # Slow and small strokes leave less of the gap: the figure of the first recording would be wrong here.
    assert predicted < found.closed_in_all
    assert predicted == pytest.approx(found_closed(there.signals, signal), abs=0.15)


def test_the_whole_check_on_three_recordings(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    chosen = [
        Case("slip", ("torque_offset",), 8.0, 0.0, "rich", 31),
        Case("slip", (), 0.0, 0.0, "sweeps", 32),
        Case("slip", ("hum",), 8.0, 0.0, "rich", 33),
    ]
    monkeypatch.setattr(check_module, "bank", lambda *arguments: chosen)
    monkeypatch.setattr(check_module, "available", lambda: ("slip",))
    monkeypatch.setattr(check_module, "SECONDS", 20.0)
    monkeypatch.setattr(
        check_module,
        "measure",
        lambda lengths: [{"samples": n, "seconds": 1e-3 * n, "peak_mb": 300.0} for n in lengths],
    )
    told = check(tmp_path, jobs=1)
    scores = json.loads((tmp_path / "scores.json").read_text(encoding="utf-8"))
    rows = {row["what"]: row for row in scores["table"]}
    assert rows["no effect: no gap"]["value"] == 1.0
    assert rows["outside the registry, or withheld: unknown"]["value"] == 1.0
    assert rows["growth of time: exponent of the samples"]["value"] == pytest.approx(1.0)
    assert any("left out: the mujoco plant" in line for line in told)
    page = (tmp_path / "blind.html").read_text(encoding="utf-8")
    for row in scores["table"]:
        assert escape(row["what"]) in page
        assert any(row["what"] in line and row["target"] in line for line in told)
    assert "The mujoco plant is left out" in page
    assert len(pd.read_csv(tmp_path / "cases.csv")) == 3
    verdicts = json.loads((tmp_path / "verdicts.json").read_text(encoding="utf-8"))
    assert not any("truth" in record or "effects" in record for record in verdicts)


# ---- scores --------------------------------------------------------------------------------------------------------


def test_right_means_nothing_more_and_nothing_less() -> None:
    label = {"truth": ["backlash"], "base_error": 0.0}
    assert is_right(["backlash"], label)
    assert not is_right(["backlash", "inertia"], label)
    assert not is_right([], label)
    assert not is_right(["backlash", "miscalibration"], label)
    assert is_right(["backlash", "miscalibration"], {**label, "base_error": 0.04})


def record(**changed: Any) -> dict[str, Any]:
    return {
        "id": "a", "verdict": ["backlash"], "confidence": 0.9, "ambiguous": [], "closed": 0.9, "where": "distance_since_reversal",
        "baseline_fit": "backlash", "baseline_correlation": "inertia", "seconds": 1.0, "next_settles": [], "again": None, "carried": None,
    } | changed  # fmt: skip


def label(**changed: Any) -> dict[str, Any]:
    return {
        "truth": ["backlash"], "effects": ["backlash"], "base_error": 0.0, "group": "one effect, gap/noise 8",
        "oracle_closed": 0.95, "plant": "asymmetric",
    } | changed  # fmt: skip


def test_a_pair_is_settled_only_by_naming_the_true_one_without_doubt() -> None:
    pair = ["backlash", "sensor_delay"]
    for again, wanted in (
        (None, [False]),
        ({"verdict": ["backlash"], "ambiguous": []}, [True]),
        ({"verdict": ["backlash"], "ambiguous": [pair]}, [False]),
        ({"verdict": ["sensor_delay"], "ambiguous": []}, [False]),
        ({"verdict": ["backlash", "sensor_delay"], "ambiguous": []}, [False]),
        ({"verdict": ["unknown"], "ambiguous": []}, [False]),
    ):
        assert settled(record(ambiguous=[pair], again=again), label()) == wanted
    # A pair of which neither is true says nothing about settling.
    assert settled(record(ambiguous=[["inertia", "sensor_delay"]]), label()) == []
    assert settled(record(ambiguous=[["inertia", "miscalibration"]]), label(base_error=0.04)) == [False]


def test_a_poor_recording_needs_the_truth_in_its_ambiguity_and_a_recording_that_settles_it() -> None:
    wrong = record(verdict=["sensor_delay"], ambiguous=[["backlash", "sensor_delay"]])
    good = {"verdict": ["backlash"], "ambiguous": []}
    assert poor_is_right(record(), label())
    assert poor_is_right(wrong | {"again": good}, label())
    assert not poor_is_right(wrong, label())
    assert not poor_is_right(wrong | {"ambiguous": [], "again": good}, label())
    assert not poor_is_right(wrong | {"again": {"verdict": ["sensor_delay"], "ambiguous": []}}, label())


def test_targets_are_reached_missed_or_not_measured() -> None:
    labels = {
        "a": label(),
        "b": label(),
        "c": label(truth=["unknown"], group="withheld from the registry"),
        "d": label(truth=["unknown"], group="withheld from the registry"),
    }
    records = [
        record(id="a", carried={"predicted": 0.8, "found": 0.75}),
        record(id="b", verdict=["inertia"], carried={"predicted": 0.8, "found": 0.2}),
        record(id="c", verdict=["inertia"], closed=0.3),
        record(id="d", verdict=["inertia"], closed=0.8),
    ]
    cost = {"by_length": [{"samples": 20_000, "seconds": 30.0, "peak_mb": 400.0}], "exponent": 1.0}
    table = {row["what"]: row for row in score(records, labels, cost)["table"]}
    alone = table["one effect, gap/noise 4 and more: right, alone"]
    assert (alone["value"], alone["of"], alone["told"]) == (0.5, 2, "missed")
    assert (alone["low"], alone["high"]) == wilson(1, 2)
    assert table["closed elsewhere within 0.10 of what was predicted"]["value"] == 0.5
    assert table["outside the registry, or withheld: unknown"]["value"] == 0.0
    assert table["the same, counting explanations that close half or more"]["value"] == 0.5
    assert table["closed, median distance from the oracle"]["value"] == pytest.approx(0.05)
    assert table["closed, median distance from the oracle"]["told"] == "missed"
    assert table["closed, median share of the oracle's"]["told"] == "missed"
    assert table["20000 samples, whole registry, s"]["told"] == "missed"
    assert table["20000 samples, whole registry, peak MB"]["told"] == "reached"
    assert table["two effects: both, nothing else"]["told"] == "not measured"
    assert len({row["what"] for row in table.values()}) == len(table)


def test_calibration_error_and_interval_against_known_values() -> None:
    by_hand = (8 * 0.2 + 2 * 0.8) / 10  # bins of one sample each
    assert expected_calibration_error([0.8] * 10, [True] * 8 + [False] * 2) == pytest.approx(by_hand, abs=1e-12)
    assert wilson(8, 10) == pytest.approx((0.4901, 0.9433), abs=1e-3)


def test_growth_is_the_exponent() -> None:
    assert growth([{"samples": n, "seconds": 3e-6 * n**1.5} for n in (1000, 2000, 8000)]) == pytest.approx(1.5)


def test_the_confusion_matrix_loses_no_verdict() -> None:
    confusion = {
        "backlash": {"backlash": 3, "inertia + backlash": 1, "no gap": 1},
        "inertia": {"inertia": 4, "viscous_friction": 1, "unknown": 2},
    }
    columns, lines = _matrix(confusion)
    assert columns == ["backlash", "inertia", "viscous_friction", "no gap", "unknown", "several"]
    assert [(truth, sum(counts)) for truth, counts, _ in lines] == [("backlash", 5), ("inertia", 7)]
    assert lines[0][1][columns.index("several")] == 1
    assert "inertia + backlash (1)" in lines[0][2]


def test_plants_know_their_effects() -> None:
    assert effects_of("asymmetric") == tuple(EFFECTS)
    pytest.importorskip("mujoco")
    left_out = set(EFFECTS) - set(effects_of("mujoco"))
    assert left_out == {"stribeck_friction", "load_dependent_friction", "thermal_drift", "cyclic_softening"}


def test_a_file_is_no_folder(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_text("")
    with pytest.raises(InputError, match="name a folder"):
        check(file)
