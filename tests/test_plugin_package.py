"""A package from elsewhere, built and found by its entry points, in a run of its own process."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import pandas as pd
import psutil
import pytest

from sample_site import ROOT, hystbench, install_wheel

BAD = ("raises", "nan", "hangs", "exits", "leaks", "interrupts")
MODELS = ",".join(f"sample-{name}" for name in ("stop", "duck", "messy", "forks", *BAD))


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return install_wheel(ROOT / "tests" / "sample_plugin", tmp_path_factory.mktemp("plugin"))


@pytest.fixture(scope="module")
def done(site: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, subprocess.CompletedProcess[str]]:
    folder = tmp_path_factory.mktemp("plugin-run")
    arguments = ("run", "--quick", "--datasets", "sample-loop", "--models", MODELS, "--out", "out")
    return folder / "out", hystbench(
        *arguments, cwd=folder, site=site, HYSTBENCH_TIME_LIMIT="10", HYSTBENCH_MEMORY_LIMIT="0.5"
    )


@pytest.fixture(scope="module")
def forward(done: tuple[Path, subprocess.CompletedProcess[str]]) -> pd.DataFrame:
    table = pd.read_parquet(done[0] / "results.parquet")
    return table[table["task"] == "forward"].set_index(["model", "condition"])


def test_plugins_are_listed_and_broken_ones_are_named_and_skipped(site: Path, tmp_path: Path) -> None:
    listed = hystbench("list", "models", "--json", cwd=tmp_path, site=site)
    assert listed.returncode == 0
    ids = [entry["id"] for entry in json.loads(listed.stdout)]
    assert "sample-stop" in ids
    assert "cubic" in ids
    assert not {"sample-broken", "sample-incomplete"} & set(ids)
    for name, reason in (
        ("sample-broken", "No module named"),
        ("sample-incomplete", "it lacks predict"),
        ("cubic", "the id is taken by hystbench"),
    ):
        assert any(name in line and reason in line for line in listed.stderr.splitlines())


def test_a_broken_plugin_asked_for_by_name_is_an_input_error(site: Path, tmp_path: Path) -> None:
    done = hystbench("run", "--models", "sample-broken", "--out", "out", cwd=tmp_path, site=site)
    assert done.returncode == 2
    assert "sample-broken" in done.stderr.splitlines()[-1]
    assert "Traceback" not in done.stderr


def test_a_model_from_another_package_runs_in_the_benchmark(
    done: tuple[Path, subprocess.CompletedProcess[str]], forward: pd.DataFrame
) -> None:
    out, process = done
    assert process.returncode == 0, process.stderr
    assert forward.loc[("sample-stop", "clean"), "nrmse"] < 2e-3
    table = pd.read_parquet(out / "results.parquet").set_index(["model", "condition", "task"])
    assert table.loc[("sample-stop", "clean", "compensation"), "nrmse"] < 2e-3
    assert table.loc[("sample-duck", "clean", "inverse"), "status"] == "unsupported"
    assert forward.loc[("sample-duck", "clean"), "status"] == "ok"


@pytest.mark.parametrize(
    ("model", "status", "reason"),
    [
        ("sample-raises", "failed", "RuntimeError: no <b>idea</b> what to do"),
        ("sample-nan", "failed", "the prediction is nan at sample 0"),
        ("sample-hangs", "timeout", "took longer than 10 s"),
        ("sample-exits", "failed", "its process died"),
        ("sample-leaks", "failed", "MemoryError"),
        ("sample-interrupts", "failed", "KeyboardInterrupt"),
    ],
)
def test_a_bad_model_costs_its_own_cells_only(model: str, status: str, reason: str, forward: pd.DataFrame) -> None:
    for condition in ("clean", "kalman"):
        assert forward.loc[(model, condition), "status"] == status
        assert reason in forward.loc[(model, condition), "message"]
    good = forward.drop(index=[f"sample-{name}" for name in BAD], level="model")
    assert (good["status"] == "ok").all()


def test_what_a_model_does_to_its_process_does_not_reach_others(
    done: tuple[Path, subprocess.CompletedProcess[str]], forward: pd.DataFrame
) -> None:
    # It spoils its inputs, prints, and changes NumPy's state and the working directory.
    assert forward.loc[("sample-messy", "clean"), "nrmse"] == forward.loc[("sample-duck", "clean"), "nrmse"]
    assert done[1].stdout == "out/report.html\n"
    assert "written by a model" in done[1].stderr


def test_processes_that_a_model_forks_end_with_its_cell(
    done: tuple[Path, subprocess.CompletedProcess[str]], forward: pd.DataFrame
) -> None:
    assert forward.loc[("sample-forks", "clean"), "nrmse"] == forward.loc[("sample-duck", "clean"), "nrmse"]
    # They would carry the site of this run in their environment.
    left = [p for p in psutil.process_iter(["environ"]) if str(done[0].parent) in str(p.info["environ"])]
    assert left == []


def test_names_and_messages_from_plugins_are_escaped_in_the_report(
    done: tuple[Path, subprocess.CompletedProcess[str]],
) -> None:
    page = (done[0] / "report.html").read_text()
    assert "<script>alert(1)</script>" not in page
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in page
    assert "<b>idea</b>" not in page
    assert "spring &amp; &lt;stop&gt;" in page


def test_a_dataset_plugin_that_raises_is_named_and_left_out(site: Path, tmp_path: Path) -> None:
    arguments = ("run", "--quick", "--models", "sample-duck", "--datasets", "sample-loop,sample-dataset-raises")
    done = hystbench(*arguments, "--out", "out", cwd=tmp_path, site=site)
    assert done.returncode == 0, done.stderr
    assert "sample-dataset-raises left out: OSError: the disk is on fire" in done.stderr
    assert set(pd.read_parquet(tmp_path / "out" / "results.parquet")["dataset"]) == {"sample-loop"}
