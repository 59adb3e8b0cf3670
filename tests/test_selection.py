"""Hyperparameters by blocked cross-validation, and learning curves."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from hystbench import models
from hystbench.bench.cli import cli
from hystbench.bench.console import execute
from hystbench.errors import InputError
from hystbench.models.selection import choose_hyperparameters, cross_validate, learning_curve


def motion(n: int = 1500) -> np.ndarray:
    t = np.linspace(0.0, 1.0, n)
    return np.sin(40.0 * t) * (0.3 + 0.7 * t)


def loop(noise: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    x = motion()
    plant = models.get("prandtl-ishlinskii").from_parameters(weights=[2.0, -0.6, -0.5], thresholds=[0.0, 0.1, 0.3])
    return x, plant.predict(x) + noise * np.random.default_rng(0).standard_normal(x.size)


def test_held_out_error_of_the_right_model_is_the_noise() -> None:
    x, y = loop(noise=0.02)
    found = cross_validate(models.get("prandtl-ishlinskii")(operators=20), x, y)
    assert found.nrmse * np.ptp(y) == pytest.approx(0.02, rel=0.15)
    assert 0.0 < found.spread < 0.1 * found.nrmse


def test_a_model_that_memorises_is_found_out() -> None:
    class Memory(models.HysteresisModel):
        """Knows the outputs that it saw, by their inputs, and nothing else."""

        id = title = summary = source = "memory"

        def _identify(self, runs):
            return {"seen": {round(float(x), 9): float(y) for run in runs for x, y in zip(run.x, run.y, strict=True)}}

        @classmethod
        def _check_parameters(cls, seen):
            return {"seen": seen}

        def _predict_run(self, x):
            return np.array([self.parameters_["seen"].get(round(float(v), 9), 0.0) for v in x])

    x, y = loop()
    assert np.max(np.abs(Memory().fit(x, y).predict(x) - y)) == 0.0
    assert cross_validate(Memory(), x, y).nrmse > 0.2


def test_the_best_setting_comes_first_and_the_model_is_left_alone() -> None:
    x, y = loop()
    candidates = choose_hyperparameters(models.get("prandtl-ishlinskii"), x, y, grid={"operators": (2, 40)})
    assert [c.hyperparameters["operators"] for c in candidates] == [40, 2]
    assert candidates[0].nrmse < 0.1 * candidates[1].nrmse
    model = models.get("prandtl-ishlinskii")(operators=5)
    cross_validate(model, x, y)
    assert not hasattr(model, "parameters_")


def test_a_setting_that_cannot_be_fitted_comes_last() -> None:
    x, y = loop()
    candidates = choose_hyperparameters(models.get("cubic"), x, y, grid={"branches": (7, 2)})
    assert candidates[0].hyperparameters["branches"] == 2
    assert np.isnan(candidates[-1].nrmse)
    with pytest.raises(InputError, match="branches"):
        choose_hyperparameters(models.get("cubic"), x, y, grid={"branches": (7,)})


def test_several_runs_are_held_out_as_runs() -> None:
    x, y = loop()
    both = cross_validate(
        models.get("prandtl-ishlinskii")(), np.tile(x, 2), np.tile(y, 2), groups=np.repeat([0, 1], x.size)
    )
    assert both.nrmse < 5e-3


def test_more_data_never_hurt_much() -> None:
    x, y = loop(noise=0.05)
    curve = learning_curve(models.get("prandtl-ishlinskii")(), x, y)
    assert [point.samples for point in curve] == sorted({point.samples for point in curve})
    assert len(curve) >= 4
    assert curve[-1].nrmse < 0.5 * curve[0].nrmse
    assert curve[-1].nrmse * np.ptp(y) < 0.07


def test_an_input_that_never_turns_cannot_be_divided() -> None:
    with pytest.raises(InputError, match="never turns"):
        cross_validate(models.get("cubic")(), np.linspace(0.0, 1.0, 100), np.linspace(0.0, 1.0, 100))


@pytest.mark.parametrize(
    "name", ["maxwell-slip", "cubic", "bouc-wen", "preisach", "prandtl-ishlinskii", "choi-backlash"]
)
def test_every_grid_names_real_hyperparameters(name: str) -> None:
    cls = models.get(name)
    assert cls.search_grid
    for key, values in cls.search_grid.items():
        assert key in cls().get_params()
        assert cls().get_params()[key] in values


def test_fit_tunes_on_request(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    x, y = loop(noise=0.01)
    pd.DataFrame({"deflection_rad": x, "torque_nm": y}).to_csv(tmp_path / "loop.csv", index=False)
    out = tmp_path / "model.json"
    assert execute(cli, ["fit", str(tmp_path / "loop.csv"), "--model", "cubic", "--tune", "--out", str(out)]) == 0
    told = capsys.readouterr().err
    assert told.count("held-out NRMSE") == 2
    assert models.load(out).get_params()["branches"] == 2
