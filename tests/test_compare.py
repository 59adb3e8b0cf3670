"""`hystbench compare`: a model that got worse is noticed, rounding and noise are not."""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from hystbench.bench.cells import run_cell
from hystbench.bench.cli import cli
from hystbench.bench.compare import compare
from hystbench.bench.console import execute
from hystbench.bench.results import COLUMNS, table_of
from hystbench.bench.run import plan_run
from hystbench.models.cubic import Cubic


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


def seeds(*nrmse: float) -> pd.DataFrame:
    """One cell with these errors, one a seed."""
    frame = table().query("model == 'a' and dataset == 'one'").iloc[[0] * len(nrmse)].copy()
    return frame.assign(seed=range(len(nrmse)), nrmse=nrmse)


@pytest.mark.parametrize(
    ("after", "kind"),
    [
        ((1.07, 1.08, 1.06), "regression"),  # every seed alike
        ((1.00, 1.24, 1.01), "unsure"),  # one seed alone: chance
        ((1.00, 2.50, 0.40), "regression"),  # one seed broke down
        ((0.90, 0.91, 0.89), "improvement"),
        ((1.04, 1.03, 1.04), None),
    ],
)
def test_growth_is_judged_by_pairs_over_the_seeds(after: tuple[float, ...], kind: str | None) -> None:
    # The spread between the seeds is far wider than the growth: unpaired, none of it would show.
    base = np.array([0.01, 0.05, 0.3])
    found = compare(seeds(*base), seeds(*(base * after)), 0.05).differences
    assert [d.kind for d in found] == ([kind] if kind else [])


def test_seeds_that_are_gone_are_named(compared) -> None:
    code, out, _ = compared(table(), table().query("seed == 0"))
    assert code == 1
    assert out.count("seed 1, 2 in BASE only") == 4


def test_what_fails_in_both_is_named_and_passes(compared) -> None:
    broken = table(**{"a/one": {"status": "timeout", "nrmse": float("nan"), "message": "took | long"}})
    code, out, _ = compared(broken, broken)
    assert code == 0
    assert "failing       a / one / kalman / forward" in out
    assert compared(broken, table())[0] == 0


def test_json_and_markdown_tell_what_text_tells(compared) -> None:
    worse = table(**{"b/two": {"nrmse": 0.05}, "a/one": {"status": "failed", "message": "<b>|no`"}})
    code, out, _ = compared(table(), worse, "--format", "json")
    assert code == 1
    document = json.loads(out)
    assert document["schema"] == "hystbench/compare/1"
    assert document["counts"] == {"failed": 1, "regression": 1}
    assert document["worse"] == 2
    assert document["differences"][0]["new"] is None
    code, out, _ = compared(table(), worse, "--format", "markdown")
    assert code == 1
    rows = [line for line in out.splitlines() if line.startswith("| **")]
    assert len(rows) == 2
    assert r"\<b\>\|no\`" in rows[0]
    assert all(line.replace(r"\|", "").count("|") == 5 for line in rows)


def timed(model_a: float, model_b: float = 1.0, model_c: float = 1.0) -> pd.DataFrame:
    frame = pd.concat([table(), table().query("model == 'a'").assign(model="c")])
    slow = frame["model"].map({"a": model_a, "b": model_b, "c": model_c})
    return frame.assign(fit_s=0.5 * slow, predict_ns_per_sample=10.0 * slow, step_ns=900.0)


def in_session(folder: Path, session: str) -> None:
    (folder / "run.json").write_text(json.dumps({"sessions": [session], "data": {"one": {"sha256": session}}}))


def test_time_needs_a_ratio_and_an_absolute_floor_within_one_session(tmp_path: Path, compared) -> None:
    compared(timed(1.0), timed(2.0))
    in_session(tmp_path / "base", "monday")
    in_session(tmp_path / "new", "monday")
    code, out, _ = compared(timed(1.0), timed(2.0))
    assert code == 1
    # 10 ns more a sample are twice the time and below the floor.
    assert [line.split()[:4] for line in out.splitlines() if line.startswith("slower")] == [
        ["slower", "a", "/", "fit_s"]
    ]
    assert compared(timed(1.0), timed(2.0), "--time-tolerance", "150%")[0] == 0
    assert compared(timed(1.0), timed(2.0, 2.0, 2.0))[0] == 0  # the whole machine was slower
    in_session(tmp_path / "new", "tuesday")
    code, out, _ = compared(timed(1.0), timed(2.0))
    assert code == 0
    assert "not measured in one session" in out


def test_errors_on_other_data_are_not_compared(tmp_path: Path, compared) -> None:
    compared(table(), table())
    in_session(tmp_path / "base", "old")
    in_session(tmp_path / "new", "new")
    code, out, _ = compared(table(), table(**{"a/one": {"nrmse": 0.9}}))
    assert code == 0
    assert out.count("changed data") == 2
    assert "2 cells compared" in out


def real_run(folder: Path, conditions: tuple[str, ...] = ("clean", "noisy", "smoothed")) -> pd.DataFrame:
    """Two models on the published loop, with the noise of three seeds."""
    folder.mkdir()
    plan = plan_run(["cubic", "prandtl-ishlinskii"], ["vsa-published"], False)
    wanted = [replace(spec, timing_time=0.005) for spec in plan.cells if spec.condition in conditions]
    return table_of(run_cell(spec, folder) for spec in wanted)


def test_a_planted_loss_of_three_percent_in_one_model_is_caught(tmp_path: Path, monkeypatch) -> None:
    base = real_run(tmp_path / "base")
    identify, shift = Cubic._identify, 0.0

    def identify_worse(self: Cubic, runs: object) -> dict:
        return {name: np.add(value, [shift, 0.0, 0.0, 0.0]) for name, value in identify(self, runs).items()}

    monkeypatch.setattr(Cubic, "_identify", identify_worse)
    lost, tries = 0.0, 0
    while abs(lost - 0.03) > 0.003:
        # An offset adds to the mean square, so that the loss grows with its square.
        shift = 0.01 if not tries else shift * float(np.sqrt(0.03 / lost))
        tries += 1
        assert tries < 12
        new = real_run(tmp_path / f"new-{tries}")
        ok = base["status"].eq("ok") & base["model"].eq("cubic")
        lost = float(np.expm1(np.log(new.loc[ok, "nrmse"] / base.loc[ok, "nrmse"]).mean()))
        lost = max(lost, 1e-4)
    comparison = compare(base, new, 0.05)
    assert comparison.worse
    assert {d.cell.split(" / ")[0] for d in comparison.differences} == {"cubic"}


@pytest.mark.no_cover
def test_a_hundred_runs_without_a_change_never_alarm(tmp_path: Path) -> None:
    runs = [real_run(tmp_path / str(k), ("noisy",)) for k in range(11)]
    # Times scatter by a tenth here, however busy the machine is.
    rng = np.random.default_rng(0)
    for run in runs:
        for name in ("fit_s", "predict_ns_per_sample", "step_ns"):
            run[name] = runs[0][name] * rng.lognormal(0.0, 0.1, len(run))
    pairs = list(itertools.permutations(runs, 2))
    assert len(pairs) > 100
    for base, new in pairs:
        comparison = compare(base, new, 0.0, time_tolerance=0.5)
        assert comparison.compared == 6
        assert comparison.timed == 18
        assert comparison.worse == 0, comparison.differences


def test_no_results_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "results.parquet").write_text("not parquet")
    for path in (tmp_path / "nowhere", tmp_path):
        assert execute(cli, ["compare", str(path), str(path)]) == 2
        assert capsys.readouterr().err.count("\n") == 1
