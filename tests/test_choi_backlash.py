"""Choi's backlash polynomial: against a plain transcription of its rule, its conditions, its inverse, and what a fit finds."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from motions import DECAYING, NESTED, Floats, nrmse, through, turning_points
from numpy.polynomial import Polynomial

from hystbench import models
from hystbench.errors import InputError

Choi = models.get("choi-backlash")

PARAMETERS: dict[str, Any] = {
    "ascending_pos": [0.3, 2.0, 1.0, 0.5],
    "ascending_neg": [0.3, 2.2, -1.1, 0.4],
    "descending_pos": [-0.3, 2.0, 1.0, 0.4],
    "descending_neg": [-0.35, 2.1, -1.0, 0.5],
    "slope_pos": 9.0,
    "slope_neg": 7.0,
}


def transcription(x: Floats, p: dict[str, Any]) -> Floats:
    """The output moves along a line of the present side's slope until it meets the curve ahead, then follows it."""

    def curve(name: str, at: float) -> float:
        return float(Polynomial(p[f"{name}_{'pos' if at >= 0.0 else 'neg'}"])(at))

    y = 0.5 * (curve("ascending", x[0]) + curve("descending", x[0]))
    follows = None
    out = [y]
    for before, now in zip(x[:-1].tolist(), x[1:].tolist(), strict=True):
        if now != before:
            name = "ascending" if now > before else "descending"
            # The line bends where it passes zero.
            corner = 0.0 if before * now < 0.0 else now
            line = y
            for a, b in ((before, corner), (corner, now)):
                line += (b - a) * p["slope_pos" if a + b >= 0.0 else "slope_neg"]
            meets = line >= curve(name, now) if now > before else line <= curve(name, now)
            follows = name if follows == name or meets else None
            y = curve(name, now) if follows else line
        out.append(y)
    return np.array(out)


@given(turning_points(-1.0, 1.0))
def test_prediction_is_the_rule(turns: list[float]) -> None:
    x = through(turns, 9)
    found = Choi.from_parameters(**PARAMETERS).predict(x)
    np.testing.assert_allclose(found, transcription(x, PARAMETERS), atol=1e-12)


def test_degrees_may_differ_and_the_start_is_midway() -> None:
    p = {**PARAMETERS, "ascending_pos": [0.2, 2.0], "descending_neg": [-0.1, 1.0, 0.0, 0.3, 0.0, 0.1]}
    model = Choi.from_parameters(**p)
    for start in (-0.7, 0.0, 0.6):
        x = through([start, 0.9, -0.9, 0.3], 30)
        np.testing.assert_allclose(model.predict(x), transcription(x, p), atol=1e-12)
    assert model.predict([0.0])[0] == pytest.approx(0.5 * (0.2 - 0.3))


def test_outside_the_stroke_curves_go_on_straight() -> None:
    model = Choi.from_parameters(**PARAMETERS, stroke=[-1.0, 1.0])
    y = model.predict([0.0, 1.0, 1.5, 2.0])
    slope = Polynomial(PARAMETERS["ascending_pos"]).deriv()(1.0)
    np.testing.assert_allclose(np.diff(y[1:]), 0.5 * slope, rtol=1e-12)


@given(turning_points(-0.95, 0.95))
def test_the_inverse_is_exact(turns: list[float]) -> None:
    model = Choi.from_parameters(**{**PARAMETERS, "descending_neg": [-0.3, 2.1, -1.0, 0.5]})
    x = through([0.0, *turns], 9)
    y = model.predict(x)
    found = model.invert(y)
    np.testing.assert_allclose(found, x, atol=1e-8)
    np.testing.assert_allclose(model.predict(found), y, atol=1e-9)


def test_where_the_curve_jumps_there_is_no_inverse() -> None:
    # Rising motion jumps at zero from 0.1 to 0.5.
    p = {**PARAMETERS, "ascending_neg": [0.1, 2.0], "ascending_pos": [0.5, 2.0], "descending_pos": [-0.5, 2.0]}
    model = Choi.from_parameters(**p)
    y = np.array([-1.0, -0.5, 0.3])
    with pytest.raises(models.InverseError, match=r"y\[2\] = 0\.3.*jumps over it at x = 0.*approximate=True"):
        model.invert(y)
    near = model.predict(model.invert(y, approximate=True))
    np.testing.assert_allclose(near[:2], y[:2], atol=1e-9)
    # The nearest values are those on either side of the jump.
    assert 0.19 < abs(near[2] - 0.3) < 0.21


def test_the_papers_conditions_are_checked_and_told() -> None:
    assert all(c.holds for c in Choi.from_parameters(**PARAMETERS).conditions_)
    changes = {
        "Eq. 14": {"ascending_pos": [-0.4, 2.0, 1.0, 0.4]},
        "Eq. 15": {"ascending_pos": [0.9, -0.1, 2.0]},
        "Eq. 19": {"slope_pos": 3.0},
        "Eq. 20": {"slope_neg": 3.0},
    }
    for name, change in changes.items():
        broken = [c.name for c in Choi.from_parameters(**{**PARAMETERS, **change}).conditions_ if not c.holds]
        assert [text for text in broken if text.startswith(name)]


def test_curves_and_slopes_are_recovered() -> None:
    truth = Choi.from_parameters(**PARAMETERS)
    x = through([0.0, 1.0, -1.0, 1.0, -1.0, 0.8, -0.6, 0.5, -0.4, 0.6, 0.2, 0.5], 301)
    model = Choi(degree=3).fit(x, truth.predict(x))
    assert model.parameters_["slope_pos"] == pytest.approx(9.0, rel=2e-3)
    assert model.parameters_["slope_neg"] == pytest.approx(7.0, rel=2e-3)
    for branch, side, low, high in (
        ("ascending", "pos", 0.0, 0.95), ("ascending", "neg", -0.8, 0.0),
        ("descending", "pos", 0.0, 0.8), ("descending", "neg", -0.95, 0.0),
    ):  # fmt: skip
        grid = np.linspace(low, high, 50)
        found, wanted = (Polynomial(m.parameters_[f"{branch}_{side}"])(grid) for m in (model, truth))
        np.testing.assert_allclose(found, wanted, atol=2e-3)
    assert any("Eq. 40" in note for note in model.notes_)


def test_own_kind_predicts_held_out_minor_loops() -> None:
    truth = Choi.from_parameters(**PARAMETERS)
    train, test = through(DECAYING[:30], 101), through(NESTED, 83)
    model = Choi().fit(train, truth.predict(train))
    assert nrmse(model.predict(test), truth.predict(test)) < 1e-3


def test_noise_and_several_runs() -> None:
    truth = Choi.from_parameters(**PARAMETERS)
    rng = np.random.default_rng(0)
    runs = [through([0.0, 1.0, -1.0, 0.9, -0.8], 300), through([0.4, -1.0, 1.0, -0.7, 0.6], 300)]
    x, groups = np.concatenate(runs), np.repeat([0, 1], [run.size for run in runs])
    y = truth.predict(x, groups=groups)
    model = Choi().fit(x + 1e-3 * rng.normal(size=x.size), y + 0.02 * rng.normal(size=x.size), groups=groups)
    test = through(NESTED, 83)
    assert nrmse(model.predict(test), truth.predict(test)) < 0.01


def test_a_recording_without_one_branch_or_side_is_told() -> None:
    truth = Choi.from_parameters(**PARAMETERS)
    rising = np.linspace(-1.0, 1.0, 200)
    with pytest.raises(InputError, match="no sample lies on the descending curve"):
        Choi().fit(rising, truth.predict(rising))
    positive = through([0.1, 1.0, 0.1, 1.0, 0.1], 200)
    model = Choi().fit(positive, truth.predict(positive))
    assert any("x < 0" in note for note in model.notes_)
    assert nrmse(model.predict(positive)[200:], truth.predict(positive)[200:]) < 0.01


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"slope_pos": 0.0}, "slope_pos must be positive"),
        ({"stroke": [1.0, -1.0]}, "stroke must be"),
        ({"ascending_neg": []}, "ascending_neg must have shape"),
        ({"descending_pos": [[1.0]]}, "descending_pos must have shape"),
    ],
)
def test_bad_parameters_are_named(change: dict[str, Any], told: str) -> None:
    with pytest.raises(InputError, match=told):
        Choi.from_parameters(**{**PARAMETERS, **change})


def test_bad_hyperparameters_are_told_at_fit() -> None:
    x = through([0.0, 1.0, -1.0], 20)
    with pytest.raises(InputError, match="degree"):
        Choi(degree=0).fit(x, x)
