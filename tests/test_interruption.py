"""A run that is interrupted, or whose disk is full, says so in one line and is finished by the same command."""

from __future__ import annotations

import os
import resource
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pandas as pd
import pytest

from hystbench.bench.cli import cli
from hystbench.bench.console import execute

TIMES = ["fit_s", "predict_ns_per_sample", "step_ns"]
SMALL = ["run", "--quick", "--models", "cubic,prandtl-ishlinskii,preisach", "--datasets", "vsa-minor-loops"]


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("whole") / "out"
    assert execute(cli, [*SMALL, "--out", str(out), "--jobs", "2"]) == 0
    return out


@pytest.fixture(scope="module")
def whole(finished: Path) -> pd.DataFrame:
    return results(finished)


def results(out: Path) -> pd.DataFrame:
    return pd.read_parquet(out / "results.parquet").drop(columns=TIMES)


def stamps(out: Path) -> dict[str, int]:
    return {path.name: path.stat().st_mtime_ns for path in out.glob("cells/[!.]*.json")}


def start(out: Path, **more: object) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "hystbench", *SMALL, "--out", str(out), "--jobs", "2"]
    return subprocess.Popen(
        command,
        cwd=out.parent,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        # A shell's background job ignores SIGINT, and so would its children.
        **{"preexec_fn": lambda: signal.signal(signal.SIGINT, signal.SIG_DFL), **more},
    )  # type: ignore[call-overload]


def has_processes(group: int) -> bool:
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True


def is_finished_by_the_same_command(out: Path, whole: pd.DataFrame) -> None:
    kept = stamps(out)
    assert execute(cli, ["report", str(out)]) == (0 if kept else 2)
    if kept:
        assert "This run is incomplete" in (out / "report.html").read_text()
    assert execute(cli, [*SMALL, "--out", str(out), "--jobs", "2"]) == 0
    assert "This run is incomplete" not in (out / "report.html").read_text()
    assert kept.items() <= stamps(out).items()
    pd.testing.assert_frame_equal(results(out), whole)
    assert not list(out.glob("cells/.*"))


def test_ctrl_c_ends_every_process_and_leaves_what_is_finished(whole: pd.DataFrame, tmp_path: Path) -> None:
    out = tmp_path / "out"
    process = start(out)
    deadline = time.monotonic() + 120
    while not list(out.glob("cells/*.json")):
        assert time.monotonic() < deadline
        assert process.poll() is None
        time.sleep(0.01)
    # A terminal sends it to all processes of the group.
    os.killpg(process.pid, signal.SIGINT)
    told, err = process.communicate(timeout=60)
    assert process.returncode == 130, err
    assert told == ""
    assert err.split("\n") == ["", "hystbench: interrupted", ""]  # after the terminal's ^C
    deadline = time.monotonic() + 30
    while has_processes(process.pid) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not has_processes(process.pid)
    assert not list(out.glob("cells/.*"))
    is_finished_by_the_same_command(out, whole)


def test_a_full_disk_is_told_in_one_line_and_blamed_on_no_model(whole: pd.DataFrame, tmp_path: Path) -> None:
    out = tmp_path / "out"
    # No file may outgrow this: the arrays of a cell do, its figures do not.

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (30_000, 30_000))

    # What measures coverage writes a file of its own, which the same limit would break.
    unmeasured = {name: value for name, value in os.environ.items() if not name.startswith("COV")}
    process = start(out, preexec_fn=limit, env=unmeasured)
    told, err = process.communicate(timeout=240)
    assert process.returncode == 2, err
    assert told == ""
    assert err.count("\n") == 1
    assert "File too large" in err
    assert "free space" in err
    assert not list(out.glob("cells/*.npz"))
    assert not list(out.glob("cells/.*"))
    is_finished_by_the_same_command(out, whole)


def test_a_killed_fresh_run_has_lost_nothing_and_either_command_goes_on(
    finished: Path, whole: pd.DataFrame, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    shutil.copytree(finished, out)
    old = stamps(out)
    command = [sys.executable, "-m", "hystbench", *SMALL, "--out", str(out), "--jobs", "1", "--fresh"]
    process = subprocess.Popen(
        command, cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
    )
    deadline = time.monotonic() + 120
    while stamps(out) == old:
        assert time.monotonic() < deadline
        assert process.poll() is None
        time.sleep(0.002)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()

    killed = stamps(out)
    assert killed.keys() == old.keys()
    renewed = {name for name in old if killed[name] != old[name]}
    assert 0 < len(renewed) < len(old)
    pd.testing.assert_frame_equal(results(out), whole)
    assert execute(cli, ["report", str(out)]) == 0
    page = (out / "report.html").read_text()
    assert (
        f"{len(renewed)} of {len(old)} cells are finished, {len(old) - len(renewed)} stand as an earlier run left them"
        in page
    )

    shutil.copytree(out, tmp_path / "other")
    assert execute(cli, [*SMALL, "--out", str(tmp_path / "other"), "--resume"]) == 0
    pd.testing.assert_frame_equal(results(tmp_path / "other"), whole)

    assert execute(cli, [*SMALL, "--out", str(out), "--fresh"]) == 0
    after = stamps(out)
    assert {name for name in old if after[name] == killed[name]} == renewed
    assert "This run is incomplete" not in (out / "report.html").read_text()
    pd.testing.assert_frame_equal(results(out), whole)
