"""The user's own recording in `hystbench run`: its split, what is assumed, and that runs notice when it changes."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from hystbench import datasets, models
from hystbench.bench.cells import run_cell
from hystbench.bench.cli import cli
from hystbench.bench.console import execute
from hystbench.bench.run import plan_run
from hystbench.datasets.column_roles import quantity
from hystbench.datasets.user_recording import MOST_SAMPLES, UserRecording, is_file, with_columns
from hystbench.errors import InputError


def loops(n: int = 2000, cycles: float = 6.0, noise: float = 0.0, seed: int = 3) -> pd.DataFrame:
    generator = np.random.default_rng(seed)
    time = np.linspace(0.0, cycles, n)
    x = np.sin(2.0 * np.pi * time)
    model = models.get("prandtl-ishlinskii").from_parameters(weights=[1.0, -0.4, -0.2], thresholds=[0.0, 0.1, 0.3])
    y = model.predict(x)
    frame = pd.DataFrame({"time_s": 5.0 + time, "deflection_rad": x, "torque_nm": y})
    frame["deflection_rad"] += noise * generator.standard_normal(n)
    frame["torque_nm"] += noise * generator.standard_normal(n)
    return frame


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    loops().to_csv(tmp_path / "loop.csv", index=False)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("noise", [0.0, 0.01])
def test_the_last_part_is_held_out_from_a_turn_on(folder: Path, noise: float) -> None:
    table = loops(noise=noise)
    table.to_csv("loop.csv", index=False)
    data = UserRecording("loop.csv").load()
    (train,), (test,) = data.train, data.test
    # Together they are the recording; the turn belongs to both.
    assert np.array_equal(np.concatenate([train.x, test.x[1:]]), table["deflection_rad"])
    assert np.array_equal(np.concatenate([train.y, test.y[1:]]), table["torque_nm"])
    assert 0.25 < test.x.size / len(table) < 0.45
    # It begins at an extreme and is scored from the next one on, noise or not.
    assert abs(test.x[0]) > 0.98
    assert abs(test.x[test.warm_up]) > 0.98
    assert test.x[0] * test.x[test.warm_up] < 0.0
    assert train.time[0] == test.time[0] == 0.0
    assert data.kind == "recorded"
    assert (data.x_name, data.x_unit, data.y_name, data.y_unit) == ("deflection", "rad", "torque", "N·m")
    assert data.y_sigma == pytest.approx(noise, rel=0.2, abs=2e-4)


def test_what_was_assumed_is_said(folder: Path) -> None:
    plain = " ".join(UserRecording("loop.csv").load().assumptions)
    assert "first turn" in plain
    assert "goes beyond" not in plain
    assert "Thinned" not in plain
    table = loops()
    table["deflection_rad"] *= np.linspace(0.5, 1.0, len(table))
    table.drop(columns="time_s").rename(columns={"torque_nm": "load"}).to_csv("odd.csv", index=False)
    told = " ".join(UserRecording("odd.csv?y=load").load().assumptions)
    assert "samples are numbered" in told
    assert "No unit" in told
    assert "goes beyond the fitted range by" in told
    loops(3 * MOST_SAMPLES + 1).to_parquet("long.parquet")
    data = UserRecording("long.parquet").load()
    assert "every 4th sample" in " ".join(data.assumptions)
    assert data.train[0].x.size + data.test[0].x.size <= MOST_SAMPLES + 2


def test_a_run_of_files_from_processes_of_its_own(folder: Path) -> None:
    loops(seed=5, noise=0.01).to_parquet("other.parquet")
    command = ["run", "--quick", "--models", "prandtl-ishlinskii", "--jobs", "2", "--out", "out"]
    command += ["--datasets", "loop.csv,other.parquet"]

    def cells() -> dict[str, int]:
        return {path.name: path.stat().st_mtime_ns for path in Path("out/cells").glob("*.json")}

    def errors() -> pd.DataFrame:
        return pd.read_parquet("out/results.parquet").query("task == 'forward'").set_index("dataset")

    assert execute(cli, command) == 0
    first = errors()
    assert list(first["status"]) == ["ok", "ok"]
    assert first.loc["loop.csv", "nrmse"] < 0.01
    document = json.loads(Path("out/run.json").read_text())
    assert document["datasets"]["loop.csv"]["assumptions"]
    assert document["data"]["loop.csv"]["sha256"] != document["data"]["other.parquet"]["sha256"]
    assert "other.parquet" in Path("out/report.html").read_text(encoding="utf-8")
    # The same files again: nothing to compute. A changed one: only its own cells.
    before = cells()
    assert execute(cli, command) == 0
    assert cells() == before
    table = loops()
    table["torque_nm"] *= 2.0
    table.to_csv("loop.csv", index=False)
    assert execute(cli, command) == 0
    assert len(cells()) == len(before) == 2
    assert sum(name in before for name in cells()) == 1
    assert errors().loc["loop.csv", "rmse"] == pytest.approx(2.0 * first.loc["loop.csv", "rmse"], rel=0.02)


def test_columns_by_option_and_by_name(folder: Path) -> None:
    names = {"time_s": "t", "deflection_rad": "angle [deg]", "torque_nm": "force"}
    loops().rename(columns=names).to_parquet("other.parquet")
    wanted = UserRecording("loop.csv").load().train[0]
    for name in (
        "other.parquet?x=angle [deg]&y=force&time=t",
        with_columns("other.parquet", x="angle [deg]", y="force", time="t"),
    ):
        data = UserRecording(name).load()
        assert np.array_equal(data.train[0].x, wanted.x)
        assert data.x_unit == "°"
        assert data.train[0].time == pytest.approx(wanted.time)
    assert with_columns("other.parquet?y=force", y="other", x=None) == "other.parquet?y=force"
    arguments = ["run", "--quick", "--models", "cubic", "--datasets", "other.parquet", "--y", "force", "--time", "t"]
    assert execute(cli, [*arguments, "--x", "angle [deg]", "--out", "out"]) == 0
    assert set(pd.read_parquet("out/results.parquet")["status"]) == {"ok", "unsupported"}


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["lop.csv"], ["lop.csv", "did you mean loop.csv"]),
        (["nowhere/loop.csv"], ["nowhere/loop.csv", "no such file"]),
        (["loop.csv", "--x", "angle"], ["loop.csv", "angle", "--x"]),
        (["loop.csv?z=angle"], ["loop.csv?x="]),
        (["vsa-published", "--x", "angle"], ["--x", "names no file"]),
        (["constant.csv"], ["constant.csv", "deflection_rad", "constant"]),
        (["flat.csv"], ["flat.csv", "torque_nm", "constant"]),
        (["ramp.csv"], ["ramp.csv", "turns 0 times", "hystbench fit"]),
        (["one.csv"], ["one.csv", "turns 2 times"]),
        (["broken.parquet"], ["broken.parquet", "Parquet"]),
        (["nothing"], ["nothing", "Known:"]),
    ],
)
def test_bad_files_are_one_line(
    arguments: list[str], words: list[str], folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    loops().assign(deflection_rad=1.0).to_csv("constant.csv", index=False)
    loops().assign(torque_nm=1.0).to_csv("flat.csv", index=False)
    loops(cycles=0.2).to_csv("ramp.csv", index=False)
    loops(cycles=1.0).to_csv("one.csv", index=False)
    Path("broken.parquet").write_text("no parquet")
    assert execute(cli, ["run", "--quick", "--models", "cubic", "--out", "out", "--datasets", *arguments]) == 2
    told = capsys.readouterr()
    assert (told.out, told.err.count("\n")) == ("", 1)
    for word in words:
        assert word in told.err
    assert not Path("out").exists()


def test_a_file_that_changes_while_the_run_goes_on_is_no_result(folder: Path) -> None:
    plan = plan_run(["cubic"], ["loop.csv"], True)
    changed = loops()
    changed["torque_nm"] += 1.0
    changed.to_csv("loop.csv", index=False)
    Path("cells").mkdir()
    rows = run_cell(plan.cells[0], Path("cells"))["rows"]
    assert {row["status"] for row in rows} == {"failed"}
    assert "has changed since" in rows[0]["message"]
    again = plan_run(["cubic"], ["loop.csv"], True)
    assert run_cell(again.cells[0], Path("cells"))["rows"][0]["status"] == "ok"


def test_what_is_a_file_and_what_an_id(folder: Path) -> None:
    assert all(is_file(name) for name in ("loop.csv", "data/loop", "LOOP.MAT", "loop.npz?x=a", "./loop"))
    assert not any(is_file(name) for name in ("vsa-published", "loop", "mr-damper"))
    assert datasets.source("vsa-published").load().id == "vsa-published"
    with pytest.raises(datasets.UnknownDatasetError):
        datasets.source("vsa-publshed")
    Path("odd?x=1.csv").write_bytes(Path("loop.csv").read_bytes())
    assert UserRecording("odd?x=1.csv").load().train
    with pytest.raises(InputError, match="question mark"):
        UserRecording("loop.csv?").load()


@pytest.mark.parametrize(
    ("column", "name", "unit"),
    [
        ("deflection_rad", "deflection", "rad"),
        ("torque_nm", "torque", "N·m"),
        ("Torque [Nm]", "Torque", "N·m"),
        ("torque (N·m)", "torque", "N·m"),
        ("motor_angle_deg", "motor angle", "°"),
        ("angle (°)", "angle", "°"),
        ("displacement_MM", "displacement", "mm"),
        ("force", "force", ""),
        ("x_offset", "x_offset", ""),
        ("_rad", "_rad", ""),
        ("[N]", "[N]", ""),
    ],
)
def test_units_by_column_name(column: str, name: str, unit: str) -> None:
    assert quantity(column) == (name, unit)


def test_fits_and_predictions_say_when_times_were_assumed(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    loops().drop(columns="time_s").to_csv("untimed.csv", index=False)
    for model, told in (("lugre", 1), ("prandtl-ishlinskii", 0)):
        for file, count in (("untimed.csv", told), ("loop.csv", 0)):
            assert execute(cli, ["fit", file, "--model", model, "--out", "m.json"]) == 0
            assert capsys.readouterr().err.count("samples are numbered") == count
            assert execute(cli, ["predict", "m.json", file, "--out", "p.csv"]) == 0
            assert capsys.readouterr().err.count("samples are numbered") == count
