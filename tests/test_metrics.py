"""Error metrics against figures worked out by hand, and their laws."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from hystbench.bench.metrics import METRICS, score

# Multiples of 1/1024: squares of the smallest doubles underflow.
finite = st.integers(-(10**9), 10**9).map(lambda k: k / 1024.0)
series = arrays(float, 20, elements=finite)


def test_figures_worked_out_by_hand() -> None:
    truth = [0.0, 2.0, -4.0, 10.0]
    estimate = [1.0, 2.0, -5.0, 8.0]
    found = score(truth, estimate)
    assert found["n"] == 4
    assert found["mae"] == pytest.approx(1.0)
    assert found["rmse"] == pytest.approx(np.sqrt(6.0 / 4.0))
    assert found["max_abs"] == 2.0
    assert found["nrmse"] == pytest.approx(np.sqrt(1.5) / 14.0)
    # The first sample is below 5 % of the largest and does not count: (0/2 + 1/4 + 2/10) / 3.
    assert found["mre"] == pytest.approx((0.0 + 0.25 + 0.2) / 3.0)


def test_the_warm_up_does_not_count() -> None:
    truth = np.array([1.0, 2.0, 3.0])
    estimate = np.array([101.0, 2.0, 4.0])
    assert score(truth, estimate, [False, True, True]) == score(truth[1:], estimate[1:])


@given(series, series)
def test_metrics_are_ordered_and_zero_only_without_error(truth: np.ndarray, estimate: np.ndarray) -> None:
    found = score(truth, estimate)
    tolerance = 1 + 1e-12
    assert 0.0 <= found["mae"] <= found["rmse"] * tolerance <= found["max_abs"] * tolerance**2
    assert (found["max_abs"] == 0.0) is bool(np.all(truth == estimate))


@given(series, series, st.sampled_from([0.25, 2.0, 1024.0]))
def test_relative_metrics_do_not_depend_on_the_unit(truth: np.ndarray, estimate: np.ndarray, factor: float) -> None:
    one, other = score(truth, estimate), score(factor * truth, factor * estimate)
    for name in ("mre", "nrmse"):
        assert other[name] == pytest.approx(one[name], rel=1e-9, nan_ok=True)
    assert other["rmse"] == pytest.approx(factor * one["rmse"], rel=1e-9, abs=1e-150)


@pytest.mark.parametrize(
    ("truth", "estimate", "keep"),
    [
        ([1.0, 2.0], [1.0], None),
        ([], [], None),
        ([1.0, 2.0], [1.0, np.nan], None),
        ([1.0, 2.0], [1.0, 2.0], [False, False]),
        ([1.0, 2.0], [1.0, 2.0], [True]),
        ([[1.0]], [[1.0]], None),
    ],
)
def test_what_cannot_be_scored_is_refused(truth: list, estimate: list, keep: list | None) -> None:
    with pytest.raises(ValueError, match=r"alike|no sample|finite|shape"):
        score(truth, estimate, keep)


def test_an_unscored_sample_may_be_anything() -> None:
    assert score([1.0, 2.0, 4.0], [np.nan, 2.0, 4.0], [False, True, True])["max_abs"] == 0.0


def test_constant_truth_has_no_normalised_error() -> None:
    assert np.isnan(score([2.0, 2.0], [2.0, 3.0])["nrmse"])


def test_every_metric_is_described_with_its_unit() -> None:
    for metric in METRICS:
        assert "unit" in metric.description
