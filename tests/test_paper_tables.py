"""Tables 1 to 3 of the first source paper: recomputed figures against exact arithmetic, and what rounding allows."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hystbench.datasets.published_loop import PRINTED_SLOPES, TRANSITION_NEG, TRANSITION_POS, VERTICES
from hystbench.reports.paper.loop import (
    READINGS,
    crossing,
    derived_limits,
    element_sum,
    gap_between_curves,
    printed_limits,
    stiffnesses,
)
from hystbench.reports.paper.rounding import half_step, interval, verdict
from hystbench.reports.paper.tables import table_1, table_2, table_3


def test_table_1_slopes_are_those_of_exact_arithmetic() -> None:
    rows = table_1()
    assert len(rows) == 12
    for row, (name, printed) in zip(rows, PRINTED_SLOPES.items(), strict=True):
        (x1, y1), (x2, y2) = ([Fraction(str(v)) for v in VERTICES[vertex]] for vertex in name)
        assert row.recomputed == pytest.approx(float((y2 - y1) / (x2 - x1)), rel=1e-12)
        assert row.printed == printed
    assert {row.cell for row in rows if row.verdict == "within rounding"} == {"k_DE", "k_EF", "k_FG"}
    assert all(row.verdict == "exact" for row in rows if row.cell not in ("k_DE", "k_EF", "k_FG"))


@settings(max_examples=200, deadline=None)
@given(
    st.floats(-0.9, 0.4).filter(lambda v: abs(v) > 1e-3), st.floats(0.05, 0.5), st.floats(-5, 5), st.floats(0.1, 5)
)  # fmt: skip
def test_no_honest_table_is_called_a_contradiction(x: float, dx: float, y: float, dy: float) -> None:
    """A slope computed before rounding and printed with rounded points must never be accused."""

    def chord(x1: float, y1: float, x2: float, y2: float) -> float:
        return (y2 - y1) / (x2 - x1)

    true = round(chord(x, y, x + dx, y + dy), 4)
    points = [round(x, 4), round(y, 2), round(x + dx, 4), round(y + dy, 2)]
    halves = [half_step(4), half_step(2), half_step(4), half_step(2)]
    assert verdict(true, 4, chord(*points), interval(chord, points, halves)) != "contradicts"


def test_a_slope_from_other_points_is_a_contradiction() -> None:
    assert verdict(1.7561, 4, 1.8, (1.78, 1.82)) == "contradicts"
    assert verdict(1.81, 2, 1.8, (1.78, 1.82)) == "within rounding"
    assert verdict(1.80, 2, 1.8, (1.8, 1.8)) == "exact"


def test_table_3_follows_eq_16_in_one_column_only() -> None:
    rows = {(row.cell, row.how): row for row in table_3()}
    assert [rows[f"k_{i}", "Eq. 16"].verdict for i in (1, 2, 3, 4)] == ["contradicts"] * 3 + ["exact"]
    assert [rows[f"k′_{i}", "Eq. 16"].verdict for i in (1, 2, 3, 4)] == ["exact"] * 4
    assert rows["k_1", "Eq. 16"].recomputed == pytest.approx(float(Decimal("0.85") / Decimal("0.06") - Decimal("10.5")))
    assert [rows[f"η_{i}", "Eq. 17 as printed"].verdict for i in (1, 2, 3, 4)] == ["exact"] * 2 + ["contradicts"] * 2
    assert [rows[f"η′_{i}", "Eq. 17 as derived"].verdict for i in (1, 2, 3, 4)] == ["exact"] * 4
    assert [rows[f"η′_{i}", "Eq. 17 as printed"].verdict for i in (2, 3)] == ["contradicts"] * 2


def test_table_2_follows_from_the_second_column_of_table_3_and_not_from_the_first() -> None:
    rows = {(row.cell, row.how): row for row in table_2()}
    elements = "elements of Table 3 by Eqs. 2, 3"
    assert [rows[f"τ(Q{i})", elements].verdict for i in (2, 3, 5)] == ["exact"] * 3
    assert [rows[f"τ(P{i})", elements].verdict for i in (2, 3, 4, 5)] == ["contradicts"] * 4
    q4 = rows["τ(Q4)", elements]
    assert q4.verdict == "contradicts"
    assert q4.ratio == pytest.approx(-1.0, abs=1e-4)


@pytest.mark.parametrize("transition", [TRANSITION_POS, TRANSITION_NEG])
def test_the_derived_elements_pass_every_point_of_table_2(transition: np.ndarray) -> None:
    distance = np.abs(transition[:, 0] - transition[0, 0])
    rise = element_sum(distance, stiffnesses(transition), derived_limits(transition))
    np.testing.assert_allclose(rise, np.abs(transition[:, 1] - transition[0, 1]), atol=1e-12)
    # As printed they fall short of the end by almost half of the rise.
    short = element_sum(distance[-1:], stiffnesses(transition), printed_limits(transition))[0]
    assert short < 0.65 * rise[-1]


@settings(max_examples=50, deadline=None)
@given(st.lists(st.tuples(st.floats(0.01, 1.0), st.floats(0.01, 5.0)), min_size=2, max_size=6))
def test_eqs_16_and_17_as_derived_hold_for_any_flattening_polyline(segments: list[tuple[float, float]]) -> None:
    lengths = np.array([length for length, _ in segments])
    falling = np.sort([slope for _, slope in segments])[::-1]
    points = np.column_stack([np.cumsum(np.r_[0.0, lengths]), np.cumsum(np.r_[1.0, lengths * falling])])
    rise = element_sum(points[:, 0], stiffnesses(points), derived_limits(points))
    np.testing.assert_allclose(rise, points[:, 1] - 1.0, atol=1e-9)


def test_the_printed_curves_cross_near_h() -> None:
    ends, (deepest, depth) = crossing()
    np.testing.assert_allclose(gap_between_curves(ends), 0.0, atol=1e-12)
    assert (deepest, depth) == (VERTICES["H"][0], pytest.approx(-0.0351, abs=1e-4))
    assert gap_between_curves(ends + np.array([-0.01, 0.01])).min() > 0.0


def test_the_mended_reading_is_a_closed_loop_and_the_printed_ones_are_not() -> None:
    by_id = {reading.id: reading for reading in READINGS}
    ends = {name: r.upper[-1, 1] - r.lower[-1, 1] for name, r in by_id.items()}
    assert ends["mended"] == ends["chords"] == ends["q4-printed"] == 0.0
    assert ends["table-3-printed"] == pytest.approx(4.446 - 5.02)
    assert ends["eq-17-printed"] < -0.5
    assert np.all(np.diff(by_id["mended"].lower[:, 1]) > 0.0)
    assert not np.all(np.diff(by_id["q4-printed"].lower[:, 1]) > 0.0)
    x = np.concatenate([np.linspace(-1.0, 1.0, 50), np.linspace(1.0, -1.0, 50)[1:]])
    torque = by_id["mended"].torque(x)
    assert torque[0] == -5.66
    assert torque.max() == 5.02
    assert np.trapezoid(torque, x) > 0.0
