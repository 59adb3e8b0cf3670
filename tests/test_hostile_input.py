"""Hostile input to the parts of a run: a clear error or a right answer, never a wrong number in silence."""

from __future__ import annotations

import json
import math
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pandas as pd
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from hystbench.bench.compare import compare, parse_tolerance
from hystbench.bench.comparison_output import FORMATS, write
from hystbench.bench.conditions import apply
from hystbench.bench.metrics import score
from hystbench.bench.results import COLUMNS, read_cells, read_document, read_results
from hystbench.datasets import Dataset, Recording
from hystbench.errors import InputError
from hystbench.reports.export import latex, slug
from hystbench.reports.history import change_points
from hystbench.reports.tables import Cell, Table, number

ANY = st.floats(allow_nan=True, allow_infinity=True, allow_subnormal=True)
SERIES = arrays(np.float64, st.integers(0, 30), elements=ANY)
JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | ANY | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=8,
)


def in_one_line(error: Exception, justly: bool = True) -> None:
    """That bad input was refused, for a reason that fits a line."""
    assert justly
    assert str(error).strip()
    assert "\n" not in str(error)


def read_only_every_second(values: np.ndarray) -> np.ndarray:
    """The same values, neither contiguous nor writable."""
    spread = np.empty(2 * values.size)
    spread[::2] = values
    view = spread[::2]
    view.flags.writeable = False
    return view


@given(SERIES, SERIES)
def test_score_refuses_or_equals_the_definitions(truth: np.ndarray, estimate: np.ndarray) -> None:
    estimate = np.resize(estimate, truth.shape) if estimate.size else np.zeros(truth.shape)
    with np.errstate(over="ignore", invalid="ignore"):
        try:
            figures = score(read_only_every_second(truth), read_only_every_second(estimate))
        except ValueError as error:
            refused = truth.size == 0 or not (np.isfinite(truth).all() and np.isfinite(estimate).all())
            in_one_line(error, refused)
            return
        error = estimate - truth
        assert figures["n"] == truth.size
        assert figures["max_abs"] == np.abs(error).max()
        assert figures["mae"] <= figures["max_abs"] * (1 + 1e-12)
        if figures["rmse"] < 1e150:
            assert figures["nrmse"] != figures["nrmse"] or figures["nrmse"] * np.ptp(truth) == pytest.approx(
                figures["rmse"]
            )


@given(
    st.sampled_from([np.array([1, "a", None], dtype=object), np.ones((2, 2)), np.array(1.0), np.array([1 + 1j, 2, 3])])
)
def test_score_refuses_what_is_no_series(values: np.ndarray) -> None:
    with pytest.raises((ValueError, TypeError)):
        score(values, np.zeros(3))


@given(SERIES, SERIES, SERIES, st.integers(-3, 40))
def test_recordings_refuse_what_no_sensor_gives(time: np.ndarray, x: np.ndarray, y: np.ndarray, warm_up: int) -> None:
    try:
        recording = Recording("r", time, x, y, warm_up)
    except ValueError as error:
        in_one_line(error)
        return
    assert recording.time.shape == recording.x.shape == recording.y.shape
    assert np.isfinite(recording.x).all()
    assert np.isfinite(recording.y).all()
    assert (np.diff(recording.time) > 0).all()
    assert 0 <= recording.warm_up < recording.x.size


@pytest.mark.parametrize(
    ("time", "x", "told"),
    [
        ([0.0, 0.0, 1.0], [0.0, 1.0, 2.0], "time must increase"),
        ([0.0, 2.0, 1.0], [0.0, 1.0, 2.0], "time must increase"),
        ([0.0, 1.0, math.nan], [0.0, 1.0, 2.0], "finite"),
        ([0.0, 1.0, 2.0], [0.0, math.inf, 2.0], "finite"),
    ],
)
def test_a_recording_whose_time_stands_still_or_has_gaps_is_refused(
    time: list[float], x: list[float], told: str
) -> None:
    with pytest.raises(ValueError, match=rf"recording 'rig': .*{told}"):
        Recording("rig", np.array(time), np.array(x), np.zeros(3))


@given(st.text(max_size=12))
def test_a_tolerance_is_a_fraction_or_refused(text: str) -> None:
    try:
        value = parse_tolerance(text)
    except InputError as error:
        in_one_line(error)
        return
    assert 0.0 <= value < 10.0


ROWS = st.lists(
    st.fixed_dictionaries(
        {
            "model": st.sampled_from(["a", "<b>", "|c|\n"]), "dataset": st.just("d"), "condition": st.just("clean"),
            "task": st.sampled_from(["forward", "inverse"]), "seed": st.integers(0, 2), "n": st.just(9),
            "nrmse": ANY.filter(lambda v: not v < 0), "fit_s": ANY, "status": st.sampled_from(["ok", "ok", "failed", "unsupported"]),
            "message": st.text(max_size=8),
        }
    ),
    min_size=1, max_size=12, unique_by=lambda r: (r["model"], r["task"], r["seed"]),
)  # fmt: skip


def table_of(rows: list[dict[str, Any]]) -> pd.DataFrame:
    return pd.DataFrame([dict.fromkeys(COLUMNS, 1.0) | row for row in rows])[list(COLUMNS)]


@given(ROWS, ROWS)
def test_any_two_tables_compare_and_a_table_with_itself_never_alarms(old: list[dict], new: list[dict]) -> None:
    same = compare(table_of(old), table_of(old), 0.0, time_tolerance=0.5)
    assert same.worse == 0
    found = compare(table_of(old), table_of(new), 0.05, time_tolerance=0.5)
    for form in FORMATS:
        told = write(found, form, "")
        assert len(told.splitlines()) >= 1
    assert json.loads(write(found, "json", ""))["worse"] == found.worse


@given(JSON)
def test_cells_and_run_json_of_any_content_are_read_or_skipped(content: Any) -> None:
    with TemporaryDirectory() as name:
        folder = Path(name)
        for target in ("run.json", "abc.json"):
            (folder / target).write_text(json.dumps(content))
        (folder / "broken.json").write_bytes(b"\xff\xfe{")
        assert isinstance(read_document(folder), dict)
        assert all(cell["key"] == key for key, cell in read_cells(folder).items())


@given(st.binary(max_size=60))
def test_a_damaged_result_table_is_one_line(content: bytes) -> None:
    with TemporaryDirectory() as name:
        (Path(name) / "results.parquet").write_bytes(content)
        with pytest.raises(InputError) as caught:
            read_results(name)
        assert "\n" not in str(caught.value)


@given(SERIES, st.floats(0.001, 2.0))
def test_change_points_lie_within_and_in_order(values: np.ndarray, least: float) -> None:
    found = change_points(values, least)
    assert found == sorted(set(found))
    assert all(0 < at < values.size for at in found)


@given(ANY.filter(lambda value: not 1e300 < abs(value) < math.inf))
def test_numbers_for_people_keep_three_digits(value: float) -> None:
    text = number(value)
    if not math.isfinite(value):
        assert text == "–"
    else:
        assert float(text) == pytest.approx(value, rel=5.1e-3)


@given(st.text(max_size=20))
def test_any_name_is_safe_in_files_and_in_latex(name: str) -> None:
    assert "/" not in slug(name)
    assert not slug(name).startswith(".")
    text = latex(Table(name, [name], [[Cell(name)]]))
    assert text.splitlines()[-1] == r"\end{tabular}"
    assert len([line for line in text.splitlines() if not line.startswith("%")]) == 7


@settings(max_examples=8)
@given(
    arrays(np.float64, 40, elements=st.floats(-1e6, 1e6)),
    st.sampled_from(["noisy", "kalman", "smoothed"]),
    st.integers(0, 3),
)
def test_conditions_leave_finite_series_of_the_same_shape_or_refuse(x: np.ndarray, condition: str, seed: int) -> None:
    assume(np.ptp(x) > 0)
    time = np.arange(40) / 100.0
    recording = Recording("r", time, x, 2.0 * x, 0)
    dataset = Dataset(
        id="d", title="d", train=[recording], test=[recording], split="", x_name="x", x_unit="rad", y_name="y", y_unit="N·m",
        source="", licence="", x_sigma=1e-3, y_sigma=1e-3, plant=lambda t, u: 2.0 * u,
    )  # fmt: skip
    try:
        found = apply(dataset, condition, seed)
    except ValueError as error:
        in_one_line(error)
        return
    for part in (*found.train, *found.test):
        assert part.x.shape == part.y.shape == (40,)
        assert np.isfinite(part.x).all()
        assert np.isfinite(part.y).all()
    again = apply(dataset, condition, seed)
    np.testing.assert_array_equal(again.test[0].x, found.test[0].x)
