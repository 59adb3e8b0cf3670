"""The ranking over datasets: certain where the data are, tied where they are not; and what follows for the reader."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from hystbench.bench.results import COLUMNS
from hystbench.errors import InputError
from hystbench.reports import export, figure
from hystbench.reports.advice import accuracy_and_cost, advice
from hystbench.reports.export import latex
from hystbench.reports.ranking import rank_models
from hystbench.reports.run_directory import RunDirectory
from hystbench.reports.tables import Cell, Table


def made_run(errors: dict[str, np.ndarray], times: dict[str, float] | None = None, path: Path = Path()) -> RunDirectory:
    """``errors`` of each model by dataset and seed."""
    rows = []
    for model, table in errors.items():
        for (dataset, seed), value in np.ndenumerate(table):
            row = dict.fromkeys(COLUMNS, 1.0) | {"model": model, "dataset": f"set-{dataset}", "condition": "noisy"}
            row |= {"task": "forward", "seed": seed, "n": 9, "nrmse": value, "status": "ok", "message": ""}
            row["predict_ns_per_sample"] = row["step_ns"] = (times or {}).get(model, 10.0)
            rows.append(row if np.isfinite(value) else row | {"status": "failed", "message": "broke"})
    return RunDirectory(path, pd.DataFrame(rows)[list(COLUMNS)], {}, {})


def noise(shape: tuple[int, int], seed: int) -> np.ndarray:
    return np.exp(0.3 * np.random.default_rng(seed).normal(size=shape))


def test_a_model_that_is_always_better_is_placed_first_alone_and_equals_tie() -> None:
    shape = (12, 3)
    run = made_run({"a": 0.1 * noise(shape, 1), "b": noise(shape, 2), "c": noise(shape, 3), "d": 50 * noise(shape, 4)})
    ranking = rank_models(run, "forward")
    assert ranking is not None
    assert dict(zip(ranking.models, ranking.place, strict=True)) == {"a": "1", "b": "2=", "c": "2=", "d": "4"}
    assert ranking.mean[0] == ranking.low[0] == ranking.high[0] == 1.0
    assert ranking.mean.sum() == pytest.approx(1 + 2 + 3 + 4)
    assert ranking.low[1] < ranking.mean[1] < ranking.high[1]
    assert ranking.p < 1e-6
    # Demšar 2006, Table 5: q = 2.569 for four models at 5 %.
    assert ranking.critical_difference == pytest.approx(2.569 * np.sqrt(4 * 5 / (6 * 12)), rel=1e-3)
    again = rank_models(run, "forward")
    assert again is not None
    np.testing.assert_array_equal(again.low, ranking.low)


def test_models_alike_but_for_chance_are_told_apart_no_more_often_than_that() -> None:
    alone = 0
    for seed in range(40):
        ranking = rank_models(made_run({m: noise((10, 2), 100 * seed + k) for k, m in enumerate("ab")}), "forward")
        assert ranking is not None
        alone += ranking.place[0] == "1"
    assert alone <= 8


def test_seeds_add_to_the_uncertainty() -> None:
    steady = {"a": np.ones((8, 3)), "b": np.full((8, 3), 2.0)}
    shaky = {"a": np.ones((8, 3)), "b": np.tile([0.9, 3.0, 0.9], (8, 1))}
    widths = []
    for errors in (steady, shaky):
        ranking = rank_models(made_run(errors), "forward")
        assert ranking is not None
        widths.append(float((ranking.high - ranking.low).max()))
    assert widths[0] == 0.0
    assert widths[1] > 0.3


def test_a_failed_model_ranks_last_and_one_dataset_gives_no_interval() -> None:
    ranking = rank_models(
        made_run({"a": np.array([[np.nan]]), "b": np.array([[0.3]]), "c": np.array([[0.2]])}), "forward"
    )
    assert ranking is not None
    assert list(ranking.models) == ["c", "b", "a"]
    assert list(ranking.place) == ["1", "2", "3"]
    assert np.isnan(ranking.low).all()
    assert np.isnan(ranking.p)
    assert rank_models(made_run({"a": np.ones((3, 1)), "b": np.full((3, 1), np.nan)}), "forward") is None


def test_the_front_holds_what_nothing_beats_in_both() -> None:
    errors = {m: np.full((4, 1), e) for m, e in {"a": 0.1, "b": 0.2, "c": 0.3, "d": 0.2}.items()}
    table = accuracy_and_cost(made_run(errors, {"a": 100.0, "b": 10.0, "c": 50.0, "d": 10.0}))
    assert dict(zip(table["model"], table["front"], strict=True)) == {"a": True, "b": True, "c": False, "d": True}


def test_advice_names_the_best_its_figure_and_what_is_close() -> None:
    run = made_run({m: np.full((5, 1), e) for m, e in {"a": 0.1, "b": 0.11, "c": 0.4}.items()}, {"a": 90.0, "b": 20.0})
    ranking = rank_models(run, "forward")
    assert ranking is not None
    told = dict(advice(run, {"forward": ranking}))
    assert told["Predicting the output"] == "a: ahead of the others over 5 datasets"
    assert told["Fastest sample by sample, in a control loop"] == "c (10.0 ns)"


def test_latex_is_escaped_and_marks_the_best() -> None:
    table = Table(
        "50 % of {it}", ["Model", "a_b"], [[Cell("x & <y>\\"), Cell("1.5", 1.5, True)]], (("", 1), ("N·m", 1))
    )
    text = latex(table)
    assert r"x \& \textless{}y\textgreater{}\textbackslash{} & \textbf{1.5} \\" in text
    assert r"\toprule" in text
    assert r"a\_b" in text
    assert text.count("{") == text.count("}")


def test_figures_and_tables_are_exported_and_can_be_remade(tmp_path: Path) -> None:
    run = made_run({"a": np.ones((3, 2)), "<b>&": noise((3, 2), 1)}, {"a": 20.0})
    run.table.to_parquet(tmp_path / "results.parquet")
    written = export(tmp_path)
    names = {str(path.relative_to(tmp_path)) for path in written}
    for form in ("svg", "pdf", "png"):
        assert f"figures/accuracy-and-cost.{form}" in names
        assert f"figures/loops-set-2.{form}" in names
    assert {"tables/headline-forward.csv", "tables/time.tex", "tables/ranking-forward.tex"} <= names
    heads = {".svg": b"<?xml", ".pdf": b"%PDF", ".png": b"\x89PNG"}
    assert all(path.read_bytes().startswith(heads[path.suffix]) for path in written if path.suffix in heads)
    assert set(pd.read_csv(tmp_path / "tables" / "ranking-forward.csv")["Model"]) == {"<b>&", "a"}
    figure(tmp_path, "accuracy and cost").save(tmp_path / "again.svg")
    assert (tmp_path / "again.svg").read_bytes() == (tmp_path / "figures" / "accuracy-and-cost.svg").read_bytes()
    with pytest.raises(InputError, match="no figure 'nothing'"):
        figure(tmp_path, "nothing")
