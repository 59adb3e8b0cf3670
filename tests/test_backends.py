"""Where cells are computed makes no difference to them: processes here, a dask cluster, parts of an array job."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pandas as pd
import psutil
import pytest

from hystbench.bench.cli import cli
from hystbench.bench.console import execute

TIMES = ["fit_s", "predict_ns_per_sample", "step_ns"]
SMALL = [
    "run",
    "--quick",
    "--models",
    "cubic,prandtl-ishlinskii,preisach",
    "--datasets",
    "vsa-minor-loops,vsa-published",
]


def results(out: Path) -> pd.DataFrame:
    return pd.read_parquet(out / "results.parquet").drop(columns=TIMES)


def wait_for(what: Callable[[], object], process: subprocess.Popen[str] | None = None) -> None:
    deadline = time.monotonic() + 120
    while not what():
        assert time.monotonic() < deadline
        assert process is None or process.poll() is None, process.communicate()
        time.sleep(0.02)


@pytest.fixture(scope="module")
def on_one_process(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("one") / "out"
    assert execute(cli, [*SMALL, "--out", str(out), "--jobs", "1"]) == 0
    return out


@pytest.fixture(scope="module")
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, subprocess.Popen[str]]]:
    """A real scheduler, a worker with a nanny and one without, which may be killed; each a process of its own."""
    pytest.importorskip("distributed")
    folder = tmp_path_factory.mktemp("dask")
    processes: list[subprocess.Popen[str]] = []

    def start(*arguments: str) -> subprocess.Popen[str]:
        command = [sys.executable, "-m", *arguments]
        with (folder / f"log-{len(processes)}").open("w") as log:
            processes.append(
                subprocess.Popen(command, cwd=folder, stdout=log, stderr=log, text=True, start_new_session=True)
            )
        return processes[-1]

    where = folder / "scheduler.json"
    scheduler = start("distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard",
                      "--scheduler-file", str(where))  # fmt: skip
    try:
        wait_for(where.exists, scheduler)
        wait_for(lambda: where.read_text().strip().endswith("}"), scheduler)
        address = json.loads(where.read_text())["address"]
        worker = (
            "distributed.cli.dask_worker",
            address,
            "--nthreads",
            "1",
            "--no-dashboard",
            "--local-directory",
            str(folder),
        )
        start(*worker, "--nanny")
        mortal = start(*worker, "--no-nanny")
        from distributed import Client

        with Client(address, timeout="30s", set_as_default=False) as client:
            client.wait_for_workers(2, timeout=60)
        yield address, mortal
    finally:
        for process in reversed(processes):
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()


def test_a_dask_cluster_that_loses_a_worker_gives_what_one_process_gives(
    cluster: tuple[str, subprocess.Popen[str]], on_one_process: Path, tmp_path: Path
) -> None:
    address, mortal = cluster
    out = tmp_path / "out"
    arguments = [*SMALL, "--out", str(out), "--backend", "dask", "--scheduler", address]
    process = subprocess.Popen(
        [sys.executable, "-m", "hystbench", *arguments],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    wait_for(lambda: list(out.glob("cells/*.json")), process)
    assert len(list(out.glob("cells/*.json"))) < 12
    mortal.kill()
    told, err = process.communicate(timeout=240)
    assert process.returncode == 0, err
    assert told == f"{out}/report.html\n"
    pd.testing.assert_frame_equal(results(out), results(on_one_process))
    assert {p.name for p in out.glob("cells/*.npz")} == {p.name for p in on_one_process.glob("cells/*.npz")}
    assert not list(out.glob("cells/.*"))


def test_two_processes_give_what_one_gives(on_one_process: Path, tmp_path: Path) -> None:
    assert execute(cli, [*SMALL, "--out", str(tmp_path), "--jobs", "2"]) == 0
    pd.testing.assert_frame_equal(results(tmp_path), results(on_one_process))


def test_cells_that_a_dying_process_had_finished_are_kept_one_by_one(
    on_one_process: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("hystbench.bench.local_backend._batches", lambda specs, jobs: [specs])
    out, kept = tmp_path / "out", {}

    def kill_the_worker() -> None:
        wait_for(lambda: list(out.glob("cells/[!.]*.json")))
        kept.update({path.name: path.stat().st_mtime_ns for path in out.glob("cells/[!.]*.json")})
        for child in psutil.Process().children(recursive=True):
            if "popen_loky" in " ".join(child.cmdline()):
                child.kill()

    killer = threading.Thread(target=kill_the_worker)
    killer.start()
    assert execute(cli, [*SMALL, "--out", str(out), "--jobs", "1"]) == 0
    killer.join()
    assert 0 < len(kept) < 12
    assert kept.items() <= {path.name: path.stat().st_mtime_ns for path in out.glob("cells/*.json")}.items()
    pd.testing.assert_frame_equal(results(out), results(on_one_process))


def test_parts_merge_into_the_whole_in_any_order(
    on_one_process: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    parts = [str(tmp_path / f"part-{k}") for k in (1, 2, 3)]
    for k, part in enumerate(parts, 1):
        # What the whole has computed is kept: only the splitting is at stake here.
        shutil.copytree(on_one_process / "cells", Path(part) / "cells")
        assert execute(cli, [*SMALL, "--out", part, "--array", f"{k}/3"]) == 0
    sizes = [len(results(Path(part))) // 3 for part in parts]
    assert sizes == [4, 4, 4]
    out = tmp_path / "whole"
    assert execute(cli, ["report", parts[2], parts[0], parts[1], "--out", str(out)]) == 0
    pd.testing.assert_frame_equal(results(out), results(on_one_process))
    assert "This run is incomplete" not in (out / "report.html").read_text()
    assert "This run is incomplete" in (Path(parts[0]) / "report.html").read_text()
    assert execute(cli, ["report", parts[2], parts[0], "--out", str(out)]) == 0
    page = (out / "report.html").read_text()
    assert "This run is incomplete" in page
    assert "parts 2/3 are absent" in page
    assert execute(cli, ["compare", str(on_one_process), str(out)]) == 1
    capsys.readouterr()
    for wrong in (
        ["report", *parts],
        ["report", *parts, "--out", parts[0]],
        ["report", *parts, "--out", str(on_one_process)],
    ):
        assert execute(cli, wrong) == 2
        assert capsys.readouterr().err.count("\n") == 1


def test_more_parts_than_cells_leave_some_with_nothing_to_do(tmp_path: Path) -> None:
    arguments = ["run", "--quick", "--models", "cubic", "--datasets", "vsa-published"]
    parts = [str(tmp_path / str(k)) for k in (1, 2, 3)]
    for k, part in enumerate(parts, 1):
        assert execute(cli, [*arguments, "--out", part, "--array", f"{k}/3"]) == 0
    assert sorted(len(results(Path(part))) for part in parts) == [0, 3, 3]
    assert execute(cli, ["report", *parts, "--out", str(tmp_path / "whole")]) == 0
    assert "This run is incomplete" not in (tmp_path / "whole" / "report.html").read_text()


def test_cells_of_different_code_are_not_merged(
    on_one_process: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    other = tmp_path / "other"
    shutil.copytree(on_one_process, other)
    path = next((other / "cells").glob("*.json"))
    cell = json.loads(path.read_text())
    path.unlink()
    (other / "cells" / "0123.json").write_text(json.dumps(cell | {"key": "0123"}))
    assert execute(cli, ["report", str(on_one_process), str(other), "--out", str(tmp_path / "out")]) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert "hystbench compare" in told


@pytest.mark.parametrize("array", ["0/3", "4/3", "1", "a/b", "1/0", "-1/3"])
def test_a_senseless_part_is_refused(array: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert execute(cli, [*SMALL, "--out", str(tmp_path / "out"), "--array", array]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_a_scheduler_that_is_not_there_is_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr("hystbench.bench.dask_backend.CONNECT_TIMEOUT", "1s")
    arguments = [*SMALL, "--out", str(tmp_path / "out"), "--backend", "dask"]
    for more in ([], ["--scheduler", "tcp://127.0.0.1:9"], ["--scheduler", "nonsense://"]):
        assert execute(cli, [*arguments, *more]) == 2
        told = capsys.readouterr().err
        assert told.count("\n") == 1, told
        assert "--scheduler" in told


def test_dask_that_is_not_installed_is_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    arguments = [*SMALL, "--out", str(tmp_path / "out"), "--backend", "dask", "--scheduler", "tcp://127.0.0.1:9"]
    assert execute(cli, arguments) == 2
    assert "pip install 'hystbench[dask]'" in capsys.readouterr().err
