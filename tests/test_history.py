"""`hystbench history`: steps are found where they were planted, and noise is no step."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from hystbench.bench.cli import cli
from hystbench.bench.console import execute
from hystbench.bench.results import COLUMNS
from hystbench.reports.history import change_points


def series(steps: dict[int, float], noise: float, seed: int, n: int = 40) -> np.ndarray:
    level = np.ones(n)
    for at, ratio in steps.items():
        level[at:] *= ratio
    return level * np.exp(noise * np.random.default_rng(seed).normal(size=n))


@pytest.mark.parametrize("noise", [0.0, 0.02, 0.06])
def test_planted_steps_are_found_where_they_are(noise: float) -> None:
    for seed in range(20):
        found = change_points(series({12: 1.5, 27: 1 / 1.5}, noise, seed), 0.1)
        assert len(found) == 2
        assert np.abs(np.array(found) - [12, 27]).max() <= (1 if noise else 0)


def test_noise_is_seldom_a_step_and_a_small_step_none() -> None:
    assert sum(bool(change_points(series({}, 0.15, seed), 0.1)) for seed in range(300)) <= 9
    assert change_points(series({20: 1.05}, 0.0, 0), 0.1) == []
    assert change_points(series({20: 1.05}, 0.0, 0), 0.01) == [20]


@pytest.mark.parametrize("values", [[], [1.0], [np.nan, np.nan], [0.0, -1.0, np.inf], [3.0] * 9])
def test_nothing_to_find_in_degenerate_series(values: list[float]) -> None:
    assert change_points(values, 0.1) == []


def test_missing_values_are_skipped() -> None:
    values = series({20: 2.0}, 0.0, 0)
    values[[3, 19, 30]] = np.nan
    assert change_points(values, 0.1) == [20]


def make_run(folder: Path, k: int, error: float, session: str = "one", data: str = "same") -> None:
    rows = []
    for model, scale in (("steady", 1.0), ("<i>odd</i>", error)):
        for dataset in ("loop", "moved", *(["late"] if k > 5 else [])):
            row = dict.fromkeys(COLUMNS, 1.0) | {
                "model": model,
                "dataset": dataset,
                "condition": "clean",
                "task": "forward",
            }
            row |= {"seed": 0, "n": 9, "nrmse": 0.01 * scale, "fit_s": 0.1 * (2.0 if session == "two" else 1.0)}
            rows.append(row | {"status": "ok", "message": ""})
    folder.mkdir(parents=True)
    pd.DataFrame(rows)[list(COLUMNS)].to_parquet(folder / "results.parquet")
    document = {
        "started": f"2026-01-{k + 1:02d}T00:00:00", "commit": f"{k:040x}"[::-1], "sessions": [session],
        "data": {"loop": {"sha256": "same"}, "moved": {"sha256": data}}, "cells_done": 4,
    }  # fmt: skip
    (folder / "run.json").write_text(json.dumps(document))


def test_a_history_marks_the_change_of_one_model_only(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for k in range(10):
        make_run(tmp_path / f"run-{9 - k}", k, 1.0 if k < 6 else 1.2, "one" if k < 8 else "two", "x" if k else "y")
    folders = [str(path) for path in sorted(tmp_path.iterdir())]
    assert execute(cli, ["history", *folders, "--out", str(tmp_path / "out")]) == 0
    assert capsys.readouterr().out.strip().endswith("history.html")
    found = json.loads((tmp_path / "out" / "changes.json").read_text())["changes"]
    errors = [change for change in found if change["measure"] == "nrmse"]
    assert [(c["model"], c["run"]) for c in errors] == [("<i>odd</i>", 6)]
    assert errors[0]["ratio"] == pytest.approx(1.2)
    assert {c["run"] for c in found if c["measure"] == "fit_s"} == {8}
    page = (tmp_path / "out" / "history.html").read_text()
    assert "<i>odd</i>" not in page
    assert page.count("another session: perhaps the machine") == 2
    assert "Left out, because their samples differ between the runs: moved" in page
    table = pd.read_csv(tmp_path / "out" / "history.csv")
    assert (table["cells"] == 1).all()  # "late" is not in every run, "moved" is not the same
    assert list(table.query("model == 'steady'")["run"]) == list(range(10))


def test_one_run_is_no_history(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    make_run(tmp_path / "a", 0, 1.0)
    assert execute(cli, ["history", str(tmp_path / "a"), "--out", str(tmp_path / "out")]) == 2
    assert execute(cli, ["history", str(tmp_path / "a"), str(tmp_path / "b"), "--out", str(tmp_path / "out")]) == 2
    assert capsys.readouterr().err.count("\n") == 2
    assert not (tmp_path / "out").exists()
