"""Columns that nobody named: guessed by name and unit, said in one line, refused where two are as likely."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hystbench.bench.cli import cli
from hystbench.bench.console import execute
from hystbench.datasets.column_roles import AssumptionWarning, guess_columns
from hystbench.datasets.recording_files import read_columns, read_recording
from hystbench.errors import InputError

ROLES = ["time", "x", "y"]


def guess(*names: str, known: dict[str, str] | None = None, wanted: list[str] | None = None) -> dict[str, str]:
    return guess_columns(Path("a.csv"), names, known or {}, wanted or ROLES)


@pytest.mark.parametrize(
    ("names", "time", "x", "y"),
    [
        ("t,angle_deg,torque_nm", "t", "angle_deg", "torque_nm"),
        ("torque,angle,time", "time", "angle", "torque"),
        ("Time [ms],Displacement (mm),Force (kN)", "Time [ms]", "Displacement (mm)", "Force (kN)"),
        ("timestamp,jointPosition,jointVelocity,jointTorque", "timestamp", "jointPosition", "jointTorque"),
        ("stamp_s,q_rad,dq_rad_s,tau_ref,tau,temperature", "stamp_s", "q_rad", "tau"),
        ("t,x,y", "t", "x", "y"),
        ("sec,encoder_mrad,cell_mnm", "sec", "encoder_mrad", "cell_mnm"),
        # A unit is weaker than a word.
        ("t,deflection,spare_mm,torque", "t", "deflection", "torque"),
        # What was wanted is taken where nothing was measured.
        ("t,torque_desired,angle", "t", "angle", "torque_desired"),
    ],
)
def test_names_and_units_tell_the_columns(names: str, time: str, x: str, y: str) -> None:
    assert guess(*names.split(",")) == {"time": time, "x": x, "y": y}


@pytest.mark.parametrize(
    ("names", "role", "candidates"),
    [
        ("time_s,position,angle,torque", "x", ["position", "angle"]),
        ("t,angle,torque_raw,torque_filtered", "y", ["torque_raw", "torque_filtered"]),
        ("angle,torque,t,time", "time", ["t", "time"]),
        ("t,a_mm,b_mm,force", "x", ["a_mm", "b_mm"]),
    ],
)
def test_what_is_equally_likely_is_asked_for(names: str, role: str, candidates: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        guess(*names.split(","))
    text = str(caught.value)
    assert f"--{role} COLUMN" in text
    assert ", ".join(map(repr, candidates)) in text


@pytest.mark.parametrize("names", ["a,b,c", "t,velocity,current", "t,speed_rad_s,temperature", "t,torque,temperature"])
def test_what_no_name_tells_is_not_made_up(names: str) -> None:
    assert "x" not in guess(*names.split(","))


def test_settled_columns_are_left_alone() -> None:
    assert guess("a", "angle", "torque", known={"x": "a"}, wanted=["y"]) == {"y": "torque"}
    assert guess("angle", "other", known={"x": "angle"}, wanted=["y"]) == {}
    # The output may be absent where only the input is wanted; it is not the input then.
    assert guess("t", "torque", wanted=["time", "x"]) == {"time": "t"}


@given(names=st.lists(st.text(max_size=12), unique=True, max_size=6))
def test_any_names_give_distinct_columns_or_one_line(names: list[str]) -> None:
    try:
        found = guess(*names)
    except InputError:
        return
    assert len(set(found.values())) == len(found)
    assert set(found.values()) <= set(names)


def table(**columns: str) -> pd.DataFrame:
    """A loop of a spring and a friction element, its columns called as ``columns`` says."""
    t = np.arange(800) / 100.0
    x = np.sin(t)
    y = 2.0 * x + 0.5 * np.sign(np.cos(t)) + 0.01 * np.cos(37.0 * t)
    return pd.DataFrame({columns["time"]: t, columns["x"]: x, columns["y"]: y})


def test_a_time_in_milliseconds_is_turned_into_seconds(tmp_path: Path) -> None:
    frame = table(time="time_ms", x="angle", y="torque")
    frame["time_ms"] *= 1000.0
    frame.to_csv(tmp_path / "a.csv", index=False)
    with pytest.warns(AssumptionWarning) as warned:
        columns = read_columns(tmp_path / "a.csv", {"x": None, "y": None})
    assert columns.time[-1] == pytest.approx(7.99)
    assert np.array_equal(columns.clock, frame["time_ms"])
    told = " ".join(str(one.message) for one in warned)
    assert "'angle'" in told
    assert "'time_ms' is in ms" in told


def test_default_names_need_no_word(tmp_path: Path, recwarn: pytest.WarningsRecorder) -> None:
    frame = table(time="time_s", x="deflection_rad", y="torque_nm").assign(angle=0.0, force=1.0, t=2.0)
    frame.to_csv(tmp_path / "a.csv", index=False)
    recording = read_recording(tmp_path / "a.csv")
    assert not recwarn.list
    assert not recording.conditions
    assert np.array_equal(recording.x, frame["deflection_rad"])


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    table(time="t", x="angle_deg", y="tau").to_csv("odd.csv", index=False)
    table(time="t", x="angle_deg", y="tau").assign(force=1.0).to_csv("two.csv", index=False)
    table(time="t", x="angle_deg", y="tau").drop(columns="angle_deg").to_csv("wanted.csv", index=False)
    assert execute(cli, ["fit", "odd.csv", "--model", "cubic", "--out", "model.json"]) == 0
    return tmp_path


COMMANDS = {
    "fit": ["fit", "{}", "--model", "cubic", "--out", "other.json"],
    "predict": ["predict", "model.json", "{}", "--out", "predicted.csv"],
    "diagnose": ["diagnose", "{}", "--sim", "model.json", "--json", "-"],
    "check": ["data", "check", "{}", "--json"],
    "run": ["run", "--quick", "--models", "cubic", "--datasets", "{}", "--jobs", "1"],
}


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_says_what_it_assumed(command: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    capsys.readouterr()
    assert execute(cli, [part.format("odd.csv") for part in COMMANDS[command]]) in (0, 1)
    told = capsys.readouterr()
    (line,) = [line for line in told.err.splitlines() if "assumed" in line]
    assert line.startswith("hystbench: note: odd.csv: assumed that time is 't' (no unit in its name, taken as s)")
    assert "x is 'angle_deg' (°)" in line
    if command == "check":
        assert json.loads(told.out)["columns"]["x"] == "angle_deg"


@pytest.mark.parametrize("command", [name for name in COMMANDS if name != "predict"])
def test_every_command_refuses_to_choose(command: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    capsys.readouterr()
    assert execute(cli, [part.format("two.csv") for part in COMMANDS[command]]) == 2
    told = capsys.readouterr()
    assert (
        told.err == "hystbench: error: two.csv: 'tau', 'force' may each be the output y; choose one with --y COLUMN\n"
    )


def test_predict_and_invert_write_the_columns_that_they_read(folder: Path) -> None:
    assert execute(cli, ["predict", "model.json", "odd.csv", "--out", "predicted.csv"]) == 0
    assert list(pd.read_csv("predicted.csv")) == ["t", "angle_deg", "torque_nm"]
    assert execute(cli, ["invert", "model.json", "wanted.csv", "--out", "found.csv", "--approximate"]) == 0
    assert list(pd.read_csv("found.csv")) == ["t", "deflection_rad", "tau"]
    assert np.array_equal(pd.read_csv("found.csv")["tau"], pd.read_csv("wanted.csv")["tau"])
