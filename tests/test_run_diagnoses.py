"""`hystbench run --diagnose`: what each model lacks, as cells that are kept, shared out and reported like the others."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from hystbench import models
from hystbench.bench.cli import cli
from hystbench.bench.console import execute
from hystbench.bench.diagnoses import best_models
from hystbench.bench.run import part_of, plan_run
from hystbench.datasets.user_recording import UserRecording
from hystbench.diagnosis.from_benchmark import diagnose_model
from hystbench.diagnosis.known_causes import KNOWN_CAUSES
from hystbench.reports import render

FILE = "loop.csv"
MODELS = ("cubic", "prandtl-ishlinskii")
RUN = ["run", "--quick", "--models", ",".join(MODELS), "--datasets", FILE]


def damped_loop(n: int = 2400) -> pd.DataFrame:
    """A Prandtl-Ishlinskii loop at changing speed with viscous friction, which no model of the path alone follows."""
    generator = np.random.default_rng(2)
    time = 0.01 * np.arange(n)
    phase = 2.0 * np.pi * (0.3 * time + 0.012 * time**2)
    x = np.sin(phase)
    loop = models.get("prandtl-ishlinskii").from_parameters(weights=[1.0, -0.3, -0.2], thresholds=[0.0, 0.1, 0.3])
    y = loop.predict(x) + 0.05 * np.gradient(x, time) + 0.003 * generator.standard_normal(n)
    return pd.DataFrame({"time_s": time, "deflection_rad": x, "torque_nm": y})


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("diagnoses")
    damped_loop().to_csv(path / FILE, index=False)
    return path


@pytest.fixture(autouse=True)
def _in_folder(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)


@pytest.fixture(scope="module")
def whole(folder: Path) -> Path:
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        assert execute(cli, [*RUN, "--diagnose", "--jobs", "2", "--out", "out"]) == 0
    return folder / "out"


def diagnoses(out: Path) -> list[dict[str, Any]]:
    document = json.loads((out / "diagnoses.json").read_text())
    assert document["schema"] == "hystbench/diagnoses/1"
    return list(document["diagnoses"])


def test_every_model_is_diagnosed_as_the_library_does_it(whole: Path) -> None:
    found = {entry["model"]: entry for entry in diagnoses(whole)}
    assert tuple(found) == MODELS
    dataset = UserRecording(FILE).load()
    (train,) = dataset.train
    fitted = models.get("prandtl-ishlinskii")().fit(train.x, train.y)
    assert found["prandtl-ishlinskii"]["diagnosis"] == diagnose_model(fitted, dataset, seed=0).document()
    assert found["prandtl-ishlinskii"]["diagnosis"]["verdict"] != []
    assert "diagnosis" not in set(pd.read_parquet(whole / "results.parquet")["task"])


def test_one_process_gives_what_two_gave_and_a_second_run_keeps_it(whole: Path) -> None:
    assert execute(cli, [*RUN, "--diagnose", "--jobs", "1", "--out", "one"]) == 0
    text = (whole / "diagnoses.json").read_bytes()
    assert Path("one", "diagnoses.json").read_bytes() == text
    before = {path: path.stat().st_mtime_ns for path in whole.glob("diagnoses/*")}
    assert len(before) == 2
    for option in ("--diagnose", "--no-diagnose"):
        assert execute(cli, [*RUN, option, "--out", str(whole)]) == 0
        assert {path: path.stat().st_mtime_ns for path in whole.glob("diagnoses/*")} == before
        assert (whole / "diagnoses.json").read_bytes() == text


def test_parts_of_a_run_share_the_diagnoses() -> None:
    plan = plan_run(list(MODELS), [FILE], True, True)
    first, second = ({spec.key for spec in part_of(plan, k, 2).diagnoses} for k in (1, 2))
    assert first
    assert second
    assert first.isdisjoint(second)
    assert first | second == {spec.key for spec in plan.diagnoses}


def test_merged_runs_hold_the_diagnoses_of_all(whole: Path, tmp_path: Path) -> None:
    parts = [tmp_path / "a", tmp_path / "b"]
    for part, left_out in zip(parts, sorted(whole.glob("diagnoses/*.json")), strict=True):
        shutil.copytree(whole, part)
        (part / "diagnoses" / left_out.name).unlink()
    assert execute(cli, ["report", *map(str, parts), "--out", str(tmp_path / "merged")]) == 0
    assert diagnoses(tmp_path / "merged") == diagnoses(whole)
    assert 'id="diagnoses-table"' in (tmp_path / "merged" / "report.html").read_text()


def test_without_the_option_the_best_model_of_each_dataset_is_diagnosed_but_none_in_a_quick_run() -> None:
    assert plan_run(list(MODELS), [FILE], True, None).diagnosed == "none"
    plan = plan_run(list(MODELS), [FILE], False, None)
    assert plan.diagnosed == "best"
    assert plan.errands == len(plan.cells) + 1
    assert part_of(plan, 1, 2).diagnosed == "none"
    rows = {"cubic": 0.2, "prandtl-ishlinskii": 0.1}
    cells = [
        {"model": m, "dataset": FILE, "condition": c, "rows": [{"task": "forward", "status": "ok", "nrmse": e + k}]}
        for m, e in rows.items()
        for k, c in ((0.0, "recorded"), (-0.15 * (m == "cubic"), "kalman"))
    ]
    assert [spec.model for spec in best_models(plan.diagnoses, cells)] == ["prandtl-ishlinskii"]
    cells[2]["rows"][0]["status"] = "failed"
    assert [spec.model for spec in best_models(plan.diagnoses, cells)] == ["cubic"]
    assert plan_run(list(MODELS), ["vsa-published"], False, True).diagnoses == []


def test_what_cannot_be_diagnosed_is_told(folder: Path) -> None:
    damped_loop().iloc[::16].to_csv("short.csv", index=False)
    assert (
        execute(cli, ["run", "--quick", "--models", "cubic", "--datasets", "short.csv", "--diagnose", "--out", "s"])
        == 0
    )
    (entry,) = diagnoses(Path("s"))
    assert entry["status"] == "unsupported"
    assert "too few" in entry["message"]
    assert entry["message"].split(";")[0] in Path("s", "report.html").read_text()


def test_the_page_shows_verdict_confidence_and_the_known_cause(whole: Path, tmp_path: Path) -> None:
    for name in ("results.parquet", "run.json"):
        (tmp_path / name).write_bytes((whole / name).read_bytes())
    page = render(tmp_path).read_text()
    assert "Nothing was diagnosed in this run; <code>hystbench run --diagnose</code>" in page
    document = json.loads((whole / "diagnoses.json").read_text())
    first, second = document["diagnoses"]
    for entry, agrees in ((first, True), (second, False)):
        entry["known_cause"] = {
            "effects": ["viscous_friction"],
            "reason": "<b>it was driven fast</b>",
            "agrees": agrees,
        }
    first["diagnosis"].update(verdict=["viscous_friction", "backlash"], confidence=0.873, closed=0.642)
    (tmp_path / "diagnoses.json").write_text(json.dumps(document))
    page = render(tmp_path).read_text()
    for table in ("diagnoses-table", "diagnosis-1"):
        text = page[page.index(f'<table id="{table}"') :]
        text = text[: text.index("</table>")]
        for shown in ("viscous friction, backlash", "87%", "64%", ">yes<", ">no<"):
            assert shown in text, (table, shown)
    assert "&lt;b&gt;it was driven fast&lt;/b&gt;" in page
    (tmp_path / "diagnoses.json").write_text("[]")
    assert "Nothing was diagnosed" in render(tmp_path).read_text()


def test_known_causes_name_effects_that_exist() -> None:
    from hystbench import diagnosis

    for cause in KNOWN_CAUSES.values():
        assert cause.effects <= set(diagnosis.registry.ids())
        assert cause.models <= set(models.ids())
