"""Standard errors of parameters: right in size, infinite where the recording tells nothing."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from hystbench import models
from hystbench.bench.cli import cli
from hystbench.bench.console import execute
from hystbench.models.uncertainty import effective_samples, parameter_uncertainty


def motion(n: int = 2000) -> np.ndarray:
    return np.sin(np.linspace(0.0, 25.0, n)) * np.linspace(0.3, 1.0, n)


def test_errors_of_a_bouc_wen_fit_have_the_size_that_repeated_recordings_show() -> None:
    true = {"stiffness": 5.0, "alpha": 0.4, "A": 1.0, "beta": 3.0, "gamma": 1.0, "n": 1.5}
    x = motion(600)
    clean = models.get("bouc-wen").from_parameters(**true).predict(x)
    generator = np.random.default_rng(0)
    scores = []
    for _ in range(12):
        y = clean + 0.03 * generator.standard_normal(x.size)
        model = models.get("bouc-wen")(starts=16).fit(x, y)
        errors = parameter_uncertainty(model, x, y).standard_errors
        scores.append([(model.parameters_[k] - v) / errors[k] for k, v in true.items() if k != "A"])
    spread = np.sqrt(np.mean(np.square(scores), axis=0))
    assert np.all(spread > 0.4)
    assert np.all(spread < 1.9)


def test_linear_parameters_agree_with_the_textbook() -> None:
    generator = np.random.default_rng(1)
    x = motion()
    y = 2.0 * x + 0.1 * generator.standard_normal(x.size)
    model = models.get("prandtl-ishlinskii").from_parameters(weights=[2.0], thresholds=[0.0], offset=0.0)
    found = parameter_uncertainty(model, x, y)
    design = np.column_stack([x, np.ones(x.size)])
    expected = 0.1 * np.sqrt(np.diag(np.linalg.inv(design.T @ design)))
    assert found.standard_errors["weights[0]"] == pytest.approx(expected[0], rel=0.1)
    assert found.standard_errors["offset"] == pytest.approx(expected[1], rel=0.1)
    assert found.undetermined == []


def test_a_threshold_beyond_the_stroke_is_named() -> None:
    x = 0.5 * motion()
    model = models.get("prandtl-ishlinskii").from_parameters(weights=[1.0, 0.5, 0.7], thresholds=[0.0, 0.2, 3.0])
    y = model.predict(x) + 0.01 * np.random.default_rng(2).standard_normal(x.size)
    found = parameter_uncertainty(model, x, y)
    assert found.undetermined == ["weights[2]"]
    assert np.isinf(found.standard_errors["weights[2]"])
    assert np.isfinite(found.standard_errors["weights[1]"])


def test_maxwell_slip_vertices_that_were_never_reached_are_named() -> None:
    from hystbench.datasets.published_loop import ASCENDING, DESCENDING, TRANSITION_NEG, TRANSITION_POS

    model = models.get("maxwell-slip").from_parameters(
        ascending=ASCENDING, descending=DESCENDING, transition_pos=TRANSITION_POS, transition_neg=TRANSITION_NEG
    )
    x = 0.5 + 0.5 * motion()
    y = model.predict(x) + 0.01 * np.random.default_rng(3).standard_normal(x.size)
    found = parameter_uncertainty(model, x, y)
    assert "vertex (-0.675, -2.56) y" in found.undetermined
    assert found.standard_errors["vertex (0.41, 0.72) y"] < 0.02


def test_correlated_residuals_are_worth_fewer_samples() -> None:
    generator = np.random.default_rng(4)
    white = generator.standard_normal(4000)
    assert effective_samples(white) > 3000
    slow = np.convolve(white, np.ones(20) / 20.0, mode="same")
    assert 100 < effective_samples(slow) < 400
    assert effective_samples(np.zeros(10)) == 10


def test_fit_tells_what_the_recording_determines(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    x = motion(800)
    y = models.get("bouc-wen").from_parameters(stiffness=5.0, alpha=0.4, A=1.0, beta=3.0, gamma=1.0, n=1.0).predict(x)
    noise = 0.02 * np.random.default_rng(5).standard_normal(x.size)
    pd.DataFrame({"deflection_rad": x, "torque_nm": y + noise}).to_csv("loop.csv", index=False)
    assert execute(cli, ["fit", "loop.csv", "--model", "bouc-wen", "--out", "m.json"]) == 0
    assert re.search(r"  stiffness = (4\.9|5\.0)\d* ± 0\.0", capsys.readouterr().out)
    assert execute(cli, ["fit", "loop.csv", "--model", "preisach", "--out", "p.json"]) == 0
    assert "does not determine" in capsys.readouterr().out
