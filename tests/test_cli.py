"""The command line: what works, and what bad input gets: one line, exit code 2, nothing left half-written."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import click
import numpy as np
import pandas as pd
import pytest

from hystbench import models
from hystbench.bench.cli import cli
from hystbench.bench.console import execute


def loop(n: int = 400) -> pd.DataFrame:
    time = 0.01 * np.arange(n)
    x = np.sin(2.0 * np.pi * time)
    model = models.get("prandtl-ishlinskii").from_parameters(weights=[1.0, 0.5, 0.3], thresholds=[0.0, 0.1, 0.3])
    return pd.DataFrame({"time_s": time, "deflection_rad": x, "torque_nm": model.predict(x)})


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    loop().to_csv(tmp_path / "loop.csv", index=False)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def commands() -> list[tuple[str, ...]]:
    found: list[tuple[str, ...]] = []

    def walk(command: click.Command, path: tuple[str, ...]) -> None:
        if path:
            found.append(path)
        if isinstance(command, click.Group):
            for name, inner in command.commands.items():
                walk(inner, (*path, name))

    walk(cli, ())
    return found


@pytest.mark.parametrize("command", commands(), ids=" ".join)
def test_every_command_has_help_with_an_example(command: tuple[str, ...], capsys: pytest.CaptureFixture[str]) -> None:
    assert execute(cli, [*command, "--help"]) == 0
    told = capsys.readouterr().out
    assert "Example" in told
    assert f"hystbench {' '.join(command)}" in told
    assert "--debug" in told or isinstance(cli.commands[command[0]], click.Group)


def test_the_contracts_commands_are_there() -> None:
    wanted = {"run", "report", "compare", "list", "fit", "predict", "invert", "paper", "diagnose", "blind", "data"}
    assert wanted <= set(cli.commands)
    assert {"list", "fetch", "verify"} <= set(cli.commands["data"].commands)


def test_fit_predict_invert_round_trip(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert execute(cli, ["fit", "loop.csv", "--model", "prandtl-ishlinskii", "--out", "model.json"]) == 0
    assert "RMSE" in capsys.readouterr().out
    assert execute(cli, ["predict", "model.json", "loop.csv", "--out", "predicted.csv"]) == 0
    predicted = pd.read_csv("predicted.csv")
    assert list(predicted.columns) == ["time_s", "deflection_rad", "torque_nm"]
    # Its thresholds are none of the fit's grid, so the match is close, not exact.
    assert np.std(predicted["torque_nm"] - loop()["torque_nm"]) < 0.005 * np.ptp(loop()["torque_nm"])
    assert execute(cli, ["invert", "model.json", "predicted.csv", "--out", "inverted.parquet"]) == 0
    inverted = pd.read_parquet("inverted.parquet")
    back = models.load("model.json").predict(inverted["deflection_rad"].to_numpy())
    assert back == pytest.approx(predicted["torque_nm"].to_numpy(), abs=1e-9)


def test_other_column_names(folder: Path) -> None:
    loop().rename(columns={"time_s": "t", "deflection_rad": "angle", "torque_nm": "tau"}).to_parquet("other.parquet")
    names = ["--x", "angle", "--time", "t"]
    assert execute(cli, ["fit", "other.parquet", "--model", "cubic", "--out", "m.json", "--y", "tau", *names]) == 0
    assert execute(cli, ["predict", "m.json", "other.parquet", "--out", "p.csv", "--y", "tau", *names]) == 0
    assert list(pd.read_csv("p.csv").columns) == ["t", "angle", "tau"]


@pytest.mark.parametrize("what", ["models", "datasets", "effects"])
def test_lists_for_people_and_for_machines(what: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert execute(cli, ["list", what]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert execute(cli, ["list", what, "--json"]) == 0
    entries = json.loads(capsys.readouterr().out)
    assert [line.split()[0] for line in lines] == [entry["id"] for entry in entries]
    assert all(entry["summary"] for entry in entries)
    if what == "models":
        six = {"maxwell-slip", "cubic", "bouc-wen", "preisach", "prandtl-ishlinskii", "choi-backlash"}
        assert six <= {entry["id"] for entry in entries}


def changed(row: int, column: str, value: object) -> pd.DataFrame:
    frame = loop().astype(object)
    frame.loc[row, column] = value
    return frame


BAD_FILES = {
    "text in a number": (changed(7, "torque_nm", "abc"), ["line 9", "torque_nm", "abc", "write a number there"]),
    "a line of units": (changed(0, "torque_nm", "Nm"), ["line 2", "torque_nm", "'Nm'", "units, remove it"]),
    "a missing value": (changed(7, "deflection_rad", None), ["line 9", "deflection_rad"]),
    "infinity": (changed(7, "deflection_rad", "inf"), ["line 9", "deflection_rad"]),
    "time backwards": (changed(7, "time_s", 0.01), ["line 9", "time_s", "backwards"]),
    "constant input": (loop().assign(deflection_rad=0.5), ["constant"]),
    "three samples": (loop().iloc[:3], ["few"]),
    "wrong column": (loop().rename(columns={"torque_nm": "torqe"}), ["torque_nm", "torqe", "--y"]),
    "no rows": (loop().iloc[:0], ["bad.csv"]),
}


@pytest.mark.parametrize("name", BAD_FILES)
def test_a_bad_recording_is_one_line(name: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    frame, words = BAD_FILES[name]
    frame.to_csv("bad.csv", index=False)
    assert execute(cli, ["fit", "bad.csv", "--model", "bouc-wen", "--out", "model.json"]) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err.count("\n") == 1
    assert told.err.startswith("hystbench: error: bad.csv")
    for word in words:
        assert word in told.err
    assert sorted(p.name for p in folder.iterdir()) == ["bad.csv", "loop.csv"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["fit", "nowhere.csv", "--model", "cubic", "--out", "m.json"], ["nowhere.csv", "no such file"]),
        (["fit", "loop.csv", "--model", "bouc-when", "--out", "m.json"], ["bouc-when", "bouc-wen", "Known:"]),
        (["fit", "loop.csv", "--out", "m.json"], ["--model", "fit --help"]),
        (["fit", "loop.csv", "--model", "cubic", "--out", "loop.csv/m.json"], ["loop.csv"]),
        (["predict", "loop.csv", "loop.csv", "--out", "p.csv"], ["loop.csv", "not a model file"]),
        (["predict", "nowhere.json", "loop.csv", "--out", "p.csv"], ["nowhere.json", "no such file"]),
        (["run", "--models", "cubist", "--out", "o"], ["cubist", "cubic"]),
        (["run", "--datasets", "vsa", "--out", "o"], ["'vsa'", "vsa-"]),
        (["run", "--models", "", "--out", "o"], ["--models"]),
        (["run", "--out", "loop.csv"], ["loop.csv", "folder"]),
        (["run", "--jobs", "0"], ["--jobs"]),
        (["report", "nowhere"], ["nowhere", "hystbench run"]),
        (["list", "nothing"], ["nothing"]),
        (["frobnicate"], ["frobnicate", "--help"]),
        (["data", "fetch", "mr-dumper"], ["mr-damper"]),
        (["data", "export", "nothing", "--out", "o"], ["nothing"]),
    ],
)
def test_bad_usage_is_one_line(
    arguments: list[str], words: list[str], folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert execute(cli, arguments) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err.count("\n") == 1
    for word in words:
        assert word in told.err
    assert [p.name for p in folder.iterdir()] == ["loop.csv"]


@pytest.mark.parametrize(
    "text",
    ["", "{", "[]", '{"schema": "hystbench/model/1"}', '{"schema": "hystbench/model/1", "model": "cubic", "parameters": {}}',
     '{"schema": "hystbench/model/1", "model": "nothing", "parameters": {}}',
     '{"schema": "hystbench/model/1", "model": "cubic", "parameters": {"ascending": [1], "descending": "x"}}'],
)  # fmt: skip
def test_a_bad_model_file_is_one_line(text: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("m.json").write_text(text)
    assert execute(cli, ["predict", "m.json", "loop.csv", "--out", "p.csv"]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert not Path("p.csv").exists()


def test_an_output_that_has_no_inverse_says_where_and_offers_the_nearest(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    relay = models.get("preisach").from_parameters(alpha=[0.2], beta=[-0.2], weights=[1.0], offset=0.0)
    relay.save("relay.json")
    loop().assign(torque_nm=0.5).to_csv("wanted.csv", index=False)
    assert execute(cli, ["invert", "relay.json", "wanted.csv", "--out", "x.csv"]) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert "--approximate" in told
    assert not Path("x.csv").exists()
    assert execute(cli, ["invert", "relay.json", "wanted.csv", "--out", "x.csv", "--approximate"]) == 0


def test_an_unwritable_output_loses_nothing(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("taken").mkdir()
    (Path("taken") / "file").write_text("kept")
    assert execute(cli, ["fit", "loop.csv", "--model", "cubic", "--out", "taken"]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert (Path("taken") / "file").read_text() == "kept"
    assert len(list(folder.iterdir())) == 2


def test_debug_shows_the_traceback_and_nothing_else_does(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["fit", "nowhere.csv", "--model", "cubic", "--out", "m.json"]
    execute(cli, arguments)
    assert "Traceback" not in capsys.readouterr().err
    execute(cli, [*arguments, "--debug"])
    assert "Traceback" in capsys.readouterr().err


def test_results_go_to_stdout_and_messages_to_stderr_without_progress_when_piped(folder: Path) -> None:
    command = [
        sys.executable,
        "-m",
        "hystbench",
        "run",
        "--quick",
        "--models",
        "cubic",
        "--datasets",
        "vsa-published",
        "--out",
        "out",
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0
    assert done.stdout == "out/report.html\n"
    assert not re.search(r"[\x1b\r━]", done.stderr)


def test_starting_the_command_imports_no_heavy_library() -> None:
    code = "import sys; import hystbench.bench.cli; print([m for m in ('numba', 'pandas', 'matplotlib', 'filterpy') if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"
