"""`hystbench compare`: a model that got worse is noticed, rounding and noise are not."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pandas as pd
import pytest

from hystbench.bench.cli import cli
from hystbench.bench.console import execute
from hystbench.bench.results import COLUMNS


def table(**changes: dict) -> pd.DataFrame:
    """Two models on two datasets with three seeds; ``changes`` by "model/dataset"."""
    rows = []
    for m, model in enumerate(("a", "b")):
        for d, dataset in enumerate(("one", "two")):
            for seed in range(3):
                row = dict.fromkeys(COLUMNS, 1.0)
                row |= {
                    "model": model,
                    "dataset": dataset,
                    "condition": "kalman",
                    "task": "forward",
                    "seed": seed,
                    "n": 10,
                }
                row |= {"nrmse": 0.01 * (1 + m + d) * (1 + 0.001 * seed), "status": "ok", "message": ""}
                rows.append(row | changes.get(f"{model}/{dataset}", {}))
    return pd.DataFrame(rows)[list(COLUMNS)]


@pytest.fixture
def compared(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Callable[..., tuple[int, str, str]]:
    def run(base: pd.DataFrame, new: pd.DataFrame, *options: str) -> tuple[int, str, str]:
        for name, frame in (("base", base), ("new", new)):
            (tmp_path / name).mkdir(exist_ok=True)
            frame.to_parquet(tmp_path / name / "results.parquet")
        code = execute(cli, ["compare", str(tmp_path / "base"), str(tmp_path / "new"), *options])
        told = capsys.readouterr()
        return code, told.out, told.err

    return run


def test_nothing_changed(compared) -> None:
    code, out, _ = compared(table(), table())
    assert code == 0
    assert "4 cells compared" in out
    assert "0 worse" in out


def test_a_model_that_got_worse_by_three_percent_is_caught_at_two(compared) -> None:
    worse = table(**{"b/two": {"nrmse": 0.03 * 1.001 * 1.03}})
    code, out, _ = compared(table(), worse, "--tolerance", "2%")
    assert code == 1
    lines = [line for line in out.splitlines() if line.startswith("regression")]
    assert len(lines) == 1
    assert "b / two / kalman / forward" in lines[0]
    assert "+3.0%" in lines[0]
    assert compared(table(), worse, "--tolerance", "5%")[0] == 0


def test_an_improvement_is_told_and_passes(compared) -> None:
    code, out, _ = compared(table(), table(**{"a/one": {"nrmse": 0.005}}))
    assert code == 0
    assert "improvement" in out


def test_rounding_of_an_exact_fit_is_no_regression(compared) -> None:
    assert compared(table(**{"a/one": {"nrmse": 1e-16}}), table(**{"a/one": {"nrmse": 9e-16}}))[0] == 0


@pytest.mark.parametrize(
    ("new", "word"),
    [
        (table(**{"a/one": {"status": "failed", "nrmse": float("nan"), "message": "it broke"}}), "failed"),
        (table().query("dataset != 'two'"), "missing"),
    ],
)
def test_a_lost_cell_is_a_regression(compared, new: pd.DataFrame, word: str) -> None:
    code, out, _ = compared(table(), new)
    assert code == 1
    assert any(line.startswith(word) for line in out.splitlines())


def test_a_new_cell_is_named_and_passes(compared) -> None:
    code, out, _ = compared(table().query("model == 'a'"), table())
    assert code == 0
    assert sum(line.startswith("new") for line in out.splitlines()) == 2


def test_comparing_nothing_is_an_error(compared) -> None:
    failed = {key: {"status": "failed", "nrmse": float("nan")} for key in ("a/one", "a/two", "b/one", "b/two")}
    code, _, err = compared(table(**failed), table(**failed))
    assert code == 2
    assert "nothing was compared" in err


@pytest.mark.parametrize("tolerance", ["five", "-1%", "2000%", ""])
def test_a_senseless_tolerance_is_refused(compared, tolerance: str) -> None:
    code, _, err = compared(table(), table(), "--tolerance", tolerance)
    assert code == 2
    assert err.count("\n") == 1


def test_no_results_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "results.parquet").write_text("not parquet")
    for path in (tmp_path / "nowhere", tmp_path):
        assert execute(cli, ["compare", str(path), str(path)]) == 2
        assert capsys.readouterr().err.count("\n") == 1
