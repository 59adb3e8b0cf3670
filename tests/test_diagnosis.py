"""The diagnosis of a sim-to-real gap, on a plant written here: what it names, what it must not name, its files."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from threadpoolctl import threadpool_info, threadpool_limits

from hystbench import models
from hystbench.bench.cli import cli
from hystbench.bench.console import execute
from hystbench.datasets.recording_files import read_recording, write_recording
from hystbench.diagnosis import registry
from hystbench.diagnosis.diagnosis import NEAREST, diagnose
from hystbench.diagnosis.emulator.emulation import emulate
from hystbench.diagnosis.emulator.generalised import Generalised
from hystbench.diagnosis.recording.signals import COORDINATES, Signals
from hystbench.diagnosis.result import Diagnosis
from hystbench.diagnosis.wording import summary

Floats = NDArray[np.float64]
NOISE = 0.01
CONTRACT_EFFECTS = [
    "viscous_friction",
    "coulomb_friction",
    "stribeck_friction",
    "load_dependent_friction",
    "stress_relaxation",
    "thermal_drift",
    "cyclic_softening",
    "torque_offset",
    "torque_gain",
    "sensor_delay",
    "backlash",
    "end_stop",
    "inertia",
    "encoder_eccentricity",
    "deflection_offset",
    "stiffness_asymmetry",
    "torque_saturation",
]


def joint(x: Floats, stiffness: float = 4.0, friction: float = 0.3) -> Floats:
    """A spring and an elastic-plastic element, sample by sample."""
    force, last, out = 0.0, 0.0, np.empty_like(x)
    for i, value in enumerate(x):
        force = min(max(force + 12.0 * friction * (value - last), -friction), friction)
        last = value
        out[i] = force
    return stiffness * x + 0.8 * x**3 + out


def motion() -> tuple[Floats, Floats]:
    time = np.arange(3000) * 0.01
    x = np.sin(2 * np.pi * 0.31 * time) * (0.5 + 0.3 * np.sin(2 * np.pi * 0.043 * time)) + 0.25 * np.sin(
        2 * np.pi * 1.13 * time
    )
    return time, x * (1.0 - np.exp(-time / 0.5))


def signals(
    add: Callable[[Floats, Floats, Floats], Floats], sim: Callable[[Floats], Floats] = joint, seed: int = 1
) -> Signals:
    time, x = motion()
    clean = joint(x)
    y_real = clean + add(time, x, clean) + NOISE * np.random.default_rng(seed).standard_normal(x.size)
    return Signals(time, x, y_real, sim(x), [slice(0, x.size)], {})


def nothing(time: Floats, x: Floats, y: Floats) -> Floats:
    return np.zeros_like(x)


def viscous(time: Floats, x: Floats, y: Floats) -> Floats:
    return 0.04 * np.gradient(x, time)


@pytest.fixture(scope="module")
def viscous_diagnosis() -> Diagnosis:
    return diagnose(signals(viscous))


# ---- the registry --------------------------------------------------------------------------------------------------


def test_every_effect_of_the_contract_is_registered() -> None:
    assert set(CONTRACT_EFFECTS) <= set(registry.ids())


@pytest.mark.parametrize("name", CONTRACT_EFFECTS)
def test_effect_documents_every_parameter_that_its_forms_fit(name: str) -> None:
    from hystbench.diagnosis.emulator.emulation import SimulatorScene, emulate

    effect = registry.get(name)()
    assert effect.id == name
    assert effect.coordinate in COORDINATES
    assert set(effect.confused_with) <= {*registry.ids(), "miscalibration"}
    recording = signals(nothing)
    scene = SimulatorScene(recording, emulate(recording, None))
    documented = {parameter.name for parameter in effect.parameters}
    forms = effect.forms(scene)
    assert len({form.name for form in forms}) == len(forms)
    for form in forms:
        assert {c for c in (*form.coefficients, *form.shapes) if not c.startswith("_")} <= documented
        assert len(form.limits) == len(form.shapes)
        for shape in form.grid:
            columns = form.columns(scene, shape)
            assert columns.shape == (recording.x.size, len(form.coefficients))
            assert np.all(np.isfinite(columns))
            assert all(low <= value <= high for value, (low, high) in zip(shape, form.limits, strict=True))


# ---- verdicts ------------------------------------------------------------------------------------------------------


def test_names_viscous_friction_where_and_how_far(viscous_diagnosis: Diagnosis) -> None:
    found = viscous_diagnosis
    assert found.verdict == ["viscous_friction"]
    assert found.places[0].coordinate == "speed"
    (report,) = [e for e in found.effects if e.name == "viscous_friction"]
    assert report.parameters["damping"] == pytest.approx(0.04, rel=0.03)
    assert report.closed > 0.97
    assert report.closed_interval[0] <= report.closed <= report.closed_interval[1]
    assert report.adequacy == "adequate"
    assert found.noise_floor == pytest.approx(NOISE, rel=0.1)


def test_no_gap_beyond_the_noise_is_said() -> None:
    found = diagnose(signals(nothing))
    assert found.verdict == []


def test_a_diagnosis_takes_one_thread_and_gives_back_what_there_were(monkeypatch: pytest.MonkeyPatch) -> None:
    def threads() -> set[int]:
        return {library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"}

    seen = set()

    def emulated(*arguments: Any) -> Any:
        seen.update(threads())
        return emulate(*arguments)

    monkeypatch.setattr("hystbench.diagnosis.emulator.jitter.emulate", emulated)
    with threadpool_limits(limits=2, user_api="blas"):
        diagnose(signals(viscous))
        assert threads() == {2}
    assert seen == {1}


def test_a_simulator_is_emulated_once_until_it_says_something_else(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []

    def emulated(seen: Signals, **more: Any) -> Generalised:
        asked.append(seen)
        return Generalised(seen, **more)

    monkeypatch.setattr("hystbench.diagnosis.emulator.emulation.Generalised", emulated)
    usual = signals(viscous)
    # Of a size that no other test asks about.
    for number, of in enumerate((1.03 * usual.y_sim, 1.04 * usual.y_sim), start=1):
        for real in (usual.y_real, usual.y_real + 0.1):
            found = emulate(replace(usual, y_real=real, y_sim=of), None)
            assert np.std(found.predict(usual.x) - of) < 0.01 * np.std(of)
        assert len(asked) == number


def test_a_simulator_that_copies_the_recording_leaves_no_gap() -> None:
    recording = signals(nothing)
    found = diagnose(Signals(recording.time, recording.x, recording.y_real, recording.y_real, recording.runs, {}))
    assert found.verdict == []
    assert json.loads(found.to_json())["gap"]["rmse"] == 0.0


def test_a_simulator_that_is_off_is_no_missing_effect() -> None:
    found = diagnose(signals(nothing, lambda x: joint(x, stiffness=4.16, friction=0.285)))
    assert found.verdict == ["miscalibration"]
    assert found.closed_by_recalibration > 0.9


def test_what_no_effect_explains_is_unknown() -> None:
    found = diagnose(signals(lambda t, x, y: 0.06 * np.sin(2 * np.pi * 4.7 * t)))
    assert found.verdict == ["unknown"]


def test_of_what_is_unknown_it_is_told_what_comes_nearest_and_why_that_is_not_it() -> None:
    def loose(t: Floats, x: Floats, y: Floats) -> Floats:
        # Friction that drops by half while the joint is held from outside, as no listed effect does, every nine seconds.
        return np.where(t % 9.0 > 6.0, -0.5, 0.0) * (y - 4.0 * x - 0.8 * x**3)

    found = diagnose(signals(loose))
    assert found.verdict == ["unknown"]
    (reason,) = found.reasons
    nearest = [term.effect.title for term in found.choice.hypothesis.terms]
    assert nearest
    assert all(title in reason for title in nearest)
    assert reason in summary(found, designed=False)
    # None of them is said to be probable, nor are steps shown that would be undone by others.
    assert all(report.probability <= 1.0 - found.confidence for report in found.effects)
    assert [name for name, _ in found.waterfall] == ["the simulator as it is", NEAREST]
    assert found.waterfall[1][1] < found.waterfall[0][1] == found.rmse


def test_two_effects_are_both_named() -> None:
    found = diagnose(signals(lambda t, x, y: 0.05 + 0.04 * np.gradient(x, t)))
    assert set(found.verdict) == {"viscous_friction", "torque_offset"}


def test_an_excluded_effect_is_not_named() -> None:
    found = diagnose(signals(viscous), exclude=["viscous_friction"])
    assert "viscous_friction" not in {e.name for e in found.effects}
    assert found.verdict == ["unknown"] or found.confidence < 0.9


def test_as_few_as_two_effects_may_be_left_to_consider() -> None:
    rest = set(registry.ids()) - {"viscous_friction", "torque_offset"}
    found = diagnose(signals(lambda t, x, y: 0.05 + 0.04 * np.gradient(x, t)), exclude=rest)
    assert set(found.verdict) == {"viscous_friction", "torque_offset"}
    # One of them does not explain the gap, and there is none that could stand beside it.
    assert diagnose(signals(viscous), exclude={*rest, "viscous_friction"}).verdict == ["unknown"]


def test_backlash_is_found_through_the_emulator() -> None:
    half, at = 0.008, 0.0
    _, x = motion()
    follower = np.empty_like(x)
    for i, value in enumerate(x):
        at = min(max(at, value - half), value + half)
        follower[i] = at
    found = diagnose(signals(lambda t, x, y: joint(follower) - y))
    assert found.verdict == ["backlash"]
    (report,) = [e for e in found.effects if e.name == "backlash"]
    assert report.parameters["clearance"] == pytest.approx(2 * half, rel=0.1)


def test_the_same_input_gives_the_same_bytes(viscous_diagnosis: Diagnosis) -> None:
    assert diagnose(signals(viscous)).to_json() == viscous_diagnosis.to_json()


def test_units_scale_with_the_torque(viscous_diagnosis: Diagnosis) -> None:
    base = signals(viscous)
    scaled = Signals(base.time, base.x, 100.0 * base.y_real, 100.0 * base.y_sim, base.runs, {})
    found = diagnose(scaled)
    assert found.verdict == viscous_diagnosis.verdict
    assert found.rmse == pytest.approx(100.0 * viscous_diagnosis.rmse, rel=1e-6)


# ---- files and the command line ------------------------------------------------------------------------------------


def write_pair(folder: Path, recording: Signals) -> tuple[Path, Path]:
    real, sim = folder / "real.csv", folder / "sim.csv"
    for file, y in ((real, recording.y_real), (sim, recording.y_sim)):
        write_recording(file, {"time_s": recording.time, "deflection_rad": recording.x, "torque_nm": y})
    return real, sim


def test_command_writes_contract_json_page_and_corrected_simulator(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    real, sim = write_pair(tmp_path, signals(viscous))
    out = tmp_path / "out"
    assert (
        execute(cli, ["diagnose", str(real), "--sim", str(sim), "--json", str(tmp_path / "d.json"), "--out", str(out)])
        == 0
    )
    assert "viscous friction" in capsys.readouterr().out
    document = json.loads((tmp_path / "d.json").read_text(encoding="utf-8"))
    assert document["schema"] == "hystbench/diagnosis/1"
    assert set(document) >= {"gap", "where", "verdict", "confidence", "effects", "ambiguous", "next_recording"}
    assert set(document["gap"]) >= {"unit", "rmse", "noise_floor", "closed_by_recalibration"}
    assert 0.0 <= document["confidence"] <= 1.0
    for effect in document["effects"]:
        assert set(effect) >= {
            "name",
            "probability",
            "rmse_after",
            "closed",
            "closed_interval",
            "adequacy",
            "parameters",
        }
        assert 0.0 <= effect["probability"] <= 1.0
    probabilities = [effect["probability"] for effect in document["effects"]]
    assert probabilities == sorted(probabilities, reverse=True)
    page = (out / "diagnosis.html").read_text(encoding="utf-8")
    assert page.count("<svg") >= 3
    assert "http" not in page.replace("http://www.w3.org", "")
    # The corrected simulator is a model file that predicts the recording better than the simulator did.
    assert execute(cli, ["predict", str(out / "corrected.json"), str(real), "--out", str(tmp_path / "p.csv")]) == 0
    recorded, predicted, simulated = (read_recording(f).y for f in (real, tmp_path / "p.csv", sim))
    assert np.std(recorded - predicted) < 0.6 * np.std(recorded - simulated)
    assert "damping" in (out / "formula.txt").read_text(encoding="utf-8")


def test_what_no_motion_tells_apart_is_said_to_be_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """On a linear spring a constant torque and a constant deflection are the same."""
    time, x = motion()
    sim = 4.0 * x
    noise = NOISE * np.random.default_rng(3).standard_normal(x.size)
    recording = Signals(time, x, sim + 0.06 + noise, sim, [slice(0, x.size)], {})
    real, simulator = write_pair(tmp_path, recording)
    asked = ["diagnose", str(real), "--sim", str(simulator)]
    assert execute(cli, asked) == 0
    told = capsys.readouterr().out
    assert "cannot tell apart: deflection_offset and torque_offset" in told
    assert "name --out" in told
    assert execute(cli, [*asked, "--out", str(tmp_path / "out")]) == 0
    assert "no motion within the recorded deflection" in capsys.readouterr().out
    assert "No motion within the recorded" in (tmp_path / "out" / "diagnosis.html").read_text(encoding="utf-8")
    assert not (tmp_path / "out" / "next.csv").exists()


def test_a_model_file_is_a_simulator(tmp_path: Path) -> None:
    time, x = motion()
    model = models.get("prandtl-ishlinskii")().fit(x, joint(x))
    model.save(tmp_path / "model.json")
    noise = NOISE * np.random.default_rng(8).standard_normal(x.size)
    y_real = model.predict(x) + viscous(time, x, x) + noise
    real, _ = write_pair(tmp_path, Signals(time, x, y_real, y_real, [slice(0, x.size)], {}))
    assert (
        execute(cli, ["diagnose", str(real), "--sim", str(tmp_path / "model.json"), "--json", str(tmp_path / "d.json")])
        == 0
    )
    document = json.loads((tmp_path / "d.json").read_text(encoding="utf-8"))
    assert document["simulator"]["emulated_by"] == "the simulator itself"
    assert document["verdict"] == ["viscous_friction"]


@pytest.mark.parametrize(
    "names",
    [
        ("time_s", "torque_nm"),
        ("torque_nm",),
        ("time_s", "channel", "tau_sim [Nm]"),
        ("time_s", "motor angle", "link angle", "torque_nm"),
    ],
)
def test_a_simulator_s_table_needs_its_output_only(
    names: tuple[str, ...], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    recording = signals(viscous)
    real = tmp_path / "real.csv"
    write_recording(real, {"t": recording.time, "q": recording.x, "measured [Nm]": recording.y_real})
    series = {"time_s": recording.time} | dict.fromkeys(("channel", "motor angle", "link angle"), recording.time**2)
    write_recording(tmp_path / "sim.csv", {name: series.get(name, recording.y_sim) for name in names})
    asked = [
        "diagnose",
        str(real),
        "--sim",
        str(tmp_path / "sim.csv"),
        "--x",
        "q",
        "--y",
        "measured [Nm]",
        "--json",
        "-",
    ]
    assert execute(cli, asked) == 0
    assert json.loads(capsys.readouterr().out)["verdict"] == ["viscous_friction"]


def bad_inputs(folder: Path) -> dict[str, tuple[list[str], str]]:
    recording = signals(viscous)
    real, sim = write_pair(folder, recording)
    columns = {"time_s": recording.time, "deflection_rad": recording.x, "torque_nm": recording.y_sim}
    write_recording(folder / "short.csv", {k: v[:-7] for k, v in columns.items()})
    write_recording(folder / "late.csv", {**columns, "time_s": recording.time + 5.0})
    write_recording(folder / "degrees.csv", {**columns, "deflection_rad": np.degrees(recording.x)})
    write_recording(folder / "still.csv", {**columns, "torque_nm": np.ones_like(recording.x)})
    write_recording(
        folder / "named.csv", {"time_s": recording.time, "channel": recording.x, "torque_nm": recording.y_sim}
    )
    write_recording(folder / "output.csv", {"time_s": recording.time, "simulated": recording.y_sim})
    write_recording(folder / "milli.csv", {**columns, "torque_nm": 1000.0 * recording.y_sim})
    write_recording(folder / "huge.csv", {**columns, "torque_nm": 1e20 * recording.y_sim})
    write_recording(folder / "mirrored.csv", {**columns, "torque_nm": -recording.y_sim})
    write_recording(folder / "turned.csv", {**columns, "deflection_rad": -recording.x})
    write_recording(folder / "other.csv", {**columns, "deflection_rad": np.sin(7.3 * recording.time)})
    return {
        "rows differ": ([str(real), "--sim", str(folder / "short.csv")], "2993 rows"),
        "time not shared": ([str(real), "--sim", str(folder / "late.csv")], "row 1 is at 5 s"),
        "degrees": ([str(real), "--sim", str(folder / "degrees.csv")], "deg"),
        "constant": ([str(real), "--sim", str(folder / "still.csv")], "constant"),
        "wrong column": ([str(folder / "named.csv"), "--sim", str(sim)], "deflection_rad"),
        "no output": ([str(real), "--sim", str(folder / "output.csv")], "torque_nm"),
        "millinewtons": ([str(real), "--sim", str(folder / "milli.csv")], "mN·m"),
        "torque of the other sign": ([str(real), "--sim", str(folder / "mirrored.csv")], "signs were opposite"),
        "deflection of the other sign": ([str(real), "--sim", str(folder / "turned.csv")], "with the other sign"),
        "another motion": ([str(real), "--sim", str(folder / "other.csv")], "along the recorded motion"),
        "beyond reason": ([str(real), "--sim", str(folder / "huge.csv")], "no effect accounts for that"),
        "unknown effect": ([str(real), "--sim", str(sim), "--exclude", "viscos_friction"], "viscous_friction"),
        "missing file": ([str(folder / "none.csv"), "--sim", str(sim)], "no such file"),
        "two simulators": ([str(real), "--sim", str(sim), "--sim", str(sim)], "2 --sim files"),
    }


@pytest.mark.parametrize(
    "case",
    [
        "rows differ",
        "time not shared",
        "degrees",
        "constant",
        "wrong column",
        "no output",
        "millinewtons",
        "torque of the other sign",
        "deflection of the other sign",
        "another motion",
        "beyond reason",
        "unknown effect",
        "missing file",
        "two simulators",
    ],
)
def test_bad_input_is_one_line_and_exit_2(case: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments, told = bad_inputs(tmp_path)[case]
    assert execute(cli, ["diagnose", *arguments]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert len(captured.err.strip().splitlines()) == 1
    assert told in captured.err
