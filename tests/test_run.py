"""`hystbench run`: the result table, resuming, and what happens to a run that is killed."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pandas as pd
import pytest

from hystbench.bench.cli import cli
from hystbench.bench.console import execute

COLUMNS = [
    "model", "dataset", "condition", "task", "seed", "n", "mae", "mre", "rmse", "max_abs", "nrmse",
    "fit_s", "predict_ns_per_sample", "step_ns", "status", "message",
]  # fmt: skip
TIMES = ["fit_s", "predict_ns_per_sample", "step_ns"]
SMALL = ["run", "--quick", "--models", "cubic,prandtl-ishlinskii", "--datasets", "vsa-minor-loops"]


@pytest.fixture(scope="module")
def small_run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("run") / "out"
    assert execute(cli, [*SMALL, "--out", str(out), "--jobs", "2"]) == 0
    return out


def results(out: Path) -> pd.DataFrame:
    return pd.read_parquet(out / "results.parquet")


def cell_times(out: Path) -> dict[str, int]:
    return {path.name: path.stat().st_mtime_ns for path in (out / "cells").glob("*.json")}


def test_every_cell_is_a_row_with_the_promised_columns(small_run: Path) -> None:
    table = results(small_run)
    assert list(table.columns) == COLUMNS
    keys = ["model", "dataset", "condition", "task", "seed"]
    assert not table.duplicated(keys).any()
    assert len(table) == 2 * 2 * 3  # models, conditions, tasks
    assert set(table["status"]) == {"ok"}
    assert (table["n"] > 1000).all()
    assert table[["mae", "rmse", "max_abs", "nrmse", *TIMES]].gt(0).all(axis=None)
    assert (table["mae"] <= table["rmse"]).all()
    assert (table["rmse"] <= table["max_abs"]).all()


def test_run_json_tells_where_the_results_came_from(small_run: Path) -> None:
    document = json.loads((small_run / "run.json").read_text())
    assert document["finished"] is True
    assert document["cells_done"] == document["cells_total"] == 4
    assert document["seeds"] == [0]
    assert {"python", "numpy", "hystbench"} <= set(document["versions"])
    assert len(document["data"]["vsa-minor-loops"]["sha256"]) == 64
    assert document["machine"]["cores"] == os.cpu_count()


def test_one_process_gives_what_two_gave(small_run: Path, tmp_path: Path) -> None:
    assert execute(cli, [*SMALL, "--out", str(tmp_path), "--jobs", "1"]) == 0
    pd.testing.assert_frame_equal(results(tmp_path).drop(columns=TIMES), results(small_run).drop(columns=TIMES))


def test_a_second_run_keeps_finished_cells_and_repairs_damaged_ones(small_run: Path) -> None:
    before, table = cell_times(small_run), results(small_run)
    names = sorted(before)
    (small_run / "cells" / names[0]).unlink()
    (small_run / "cells" / names[1]).write_text('{"rows": ')
    (small_run / "cells" / names[2]).with_suffix(".npz").unlink()
    assert execute(cli, [*SMALL, "--out", str(small_run)]) == 0
    after = cell_times(small_run)
    assert [name for name in names if after[name] == before[name]] == names[3:]
    pd.testing.assert_frame_equal(results(small_run).drop(columns=TIMES), table.drop(columns=TIMES))


def test_fresh_computes_every_cell_again(small_run: Path) -> None:
    before = cell_times(small_run)
    assert execute(cli, [*SMALL, "--out", str(small_run), "--fresh"]) == 0
    after = cell_times(small_run)
    assert all(after[name] > before[name] for name in before)


def test_a_run_killed_in_the_middle_says_so_and_is_finished_by_the_same_command(
    small_run: Path, tmp_path: Path
) -> None:
    command = [sys.executable, "-m", "hystbench", *SMALL, "--out", str(tmp_path / "out"), "--jobs", "1"]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=tmp_path)
    deadline = time.monotonic() + 120
    while not list((tmp_path / "out").glob("cells/*.json")):
        assert time.monotonic() < deadline
        assert process.poll() is None
        time.sleep(0.01)
    process.send_signal(signal.SIGKILL)
    process.wait()
    assert execute(cli, ["report", str(tmp_path / "out")]) == 0
    assert "This run is incomplete" in (tmp_path / "out" / "report.html").read_text()
    kept = cell_times(tmp_path / "out")
    assert execute(cli, [*SMALL, "--out", str(tmp_path / "out")]) == 0
    assert kept.items() <= cell_times(tmp_path / "out").items()
    assert "This run is incomplete" not in (tmp_path / "out" / "report.html").read_text()
    pd.testing.assert_frame_equal(results(tmp_path / "out").drop(columns=TIMES), results(small_run).drop(columns=TIMES))


def test_another_selection_in_the_same_folder_keeps_the_first_ones_cells(small_run: Path) -> None:
    before = cell_times(small_run)
    assert (
        execute(cli, ["run", "--quick", "--models", "cubic", "--datasets", "vsa-minor-loops", "--out", str(small_run)])
        == 0
    )
    assert set(results(small_run)["model"]) == {"cubic"}
    assert execute(cli, [*SMALL, "--out", str(small_run)]) == 0
    assert cell_times(small_run) == before


def test_a_cell_is_computed_again_when_its_hyperparameters_change(monkeypatch: pytest.MonkeyPatch) -> None:
    from hystbench.bench.run import plan_run
    from hystbench.models.cubic import Cubic

    first = {spec.name: spec.key for spec in plan_run(["cubic", "bouc-wen"], ["vsa-published"], True).cells}
    monkeypatch.setattr(Cubic, "version", "changed")
    second = {spec.name: spec.key for spec in plan_run(["cubic", "bouc-wen"], ["vsa-published"], True).cells}
    for name in first:
        assert (first[name] == second[name]) is name.startswith("bouc-wen")


def test_recorded_data_that_are_absent_are_named_once_and_left_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from hystbench.bench.cells import load_dataset
    from hystbench.bench.run import plan_run

    monkeypatch.setenv("HYSTBENCH_DATA", str(tmp_path / "nothing"))
    load_dataset.cache_clear()
    plan = plan_run(["cubic"], None, True)
    assert {"mr-damper", "pneumatic-seal", "friction-backlash-damper"} <= set(plan.absent)
    assert {"vsa-published", "vsa-minor-loops", "vsa-physical"} == set(plan.datasets)
    assert execute(cli, ["run", "--datasets", "mr-damper", "--out", str(tmp_path / "out")]) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert "hystbench data fetch mr-damper" in told
    assert not (tmp_path / "out").exists()
    load_dataset.cache_clear()


@pytest.mark.parametrize("limit", ["0", "-3", "soon", "nan"])
def test_a_senseless_time_limit_is_refused(limit: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HYSTBENCH_TIME_LIMIT", limit)
    assert execute(cli, [*SMALL, "--out", str(tmp_path / "out")]) == 2
    assert not (tmp_path / "out").exists()


def test_a_change_of_one_models_file_leaves_the_other_models_cells_valid(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    from hystbench.bench import cells

    def hashes() -> dict[str, str]:
        cells._code_hash.cache_clear()
        return {name: cells._code_hash(f"hystbench.models.{name}") for name in ("cubic", "bouc_wen", "maxwell_slip")}

    before = hashes()
    assert len(set(before.values())) == 3
    real = Path.read_bytes
    for changed, affected in (("cubic.py", {"cubic"}), ("motion.py", set(before)), ("base.py", set(before))):

        def read(path: Path, changed: str = changed) -> bytes:
            return real(path) + (b"#" if path.name == changed else b"")

        monkeypatch.setattr(Path, "read_bytes", read)
        assert {name for name, value in hashes().items() if value != before[name]} == affected
        monkeypatch.undo()
    cells._code_hash.cache_clear()
