"""The audit of the source papers: every row is pinned, and a row goes when its contradiction goes."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from hystbench.reports.paper import printed
from hystbench.reports.paper.audit import SEVERITIES, AuditRow, as_records, audit, printed_tables

PINNED: dict[str, tuple[str, dict[str, float]]] = {
    "intro-model-list": ("misprint", {"listed": 5.0, "distinct": 4.0}),
    "intro-start-operator": ("definition", {"play_plus_stop_minus_x": 0.0}),
    "intro-choi-degree": ("inconsistent", {"claimed": 3.0, "used": 5.0}),
    "eq1-x0": ("inconsistent", {"coefficient_of_x0": 6.0, "torque_missing_at_1_rad": 0.1281}),
    "eq1-f0": ("definition", {"absent": 1.0}),
    "belt-stretch-unit": ("dimension", {"pull_n": 6.865}),
    "belt-pull-lever": ("inconsistent", {"least_crank_m": 0.1374, "preload_share": 0.7284}),
    "eq2-force-torque": ("dimension", {}),
    "eq2-interval": ("misprint", {"length_12": -0.15, "length_34": -0.1186}),
    "fig8-index": ("misprint", {"sum_k_j": 14.67, "sum_k_i": 14.17, "crease": 14.17}),
    "fig9-slip-force": ("misprint", {"slip": -0.5}),
    "eq4-stiffness": ("dimension", {"dimensions": 2.0}),
    "eq4-proportional": ("inconsistent", {"slope_ratio": 8.762, "secant_d": 5.02, "secant_j": 5.66}),
    "eq5-unit-of-x": ("dimension", {"x_max": 0.85, "x_end": 1.0}),
    "loop-figure": ("misprint", {"cited": 9.0, "right": 11.0}),
    "eq7-descending": ("misprint", {"share_x1": 0.0, "share_x3": 1.0}),
    "eq7-transition": ("inconsistent", {"rising": 4.81, "falling": 4.376}),
    "elements-symbol": ("definition", {"elements": 4.0, "branches": 6.0}),
    "symbols": ("definition", {"k_1, k_2": 2.0, "T": 2.0, "k+, k−": 2.0}),
    "eq13-sign": (
        "misprint",
        {
            "x_1_plus": -10.48,
            "x_2_plus": 3.512,
            "x_3_plus": -10.52,
            "x_4_plus": 10.32,
            "x_1_minus": 1.0,
            "x_2_minus": 0.85,
            "x_3_minus": -0.8814,
            "x_4_minus": -1.0,
        },
    ),
    "eq14-curves": ("misprint", {"x_3_printed": -1.0, "x_4_printed": -0.8814, "x_3": -0.8814, "x_4": -1.0}),
    "eq15-symbols": ("definition", {"undefined": 2.0}),
    "transition-slows": ("inconsistent", {"before": 6.886, "after": 14.17}),
    "eq17-distance": (
        "inconsistent",
        {"printed+": 0.664, "derived+": 1.27, "gained+": 1.27, "printed−": 0.654, "derived−": 1.05, "gained−": 1.05},
    ),
    "t1-last-digits": ("arithmetic", {"k_DE": 9.194, "k_EF": 5.578, "k_FG": 1.089}),
    "t2-points": ("definition", {"points": 5.0}),
    "t2-q4-sign": ("misprint", {"from_q5": -5.62, "from_q3": -5.62}),
    "t3-k-not-differences": (
        "arithmetic",
        {
            "k_1": 3.667,
            "k_2": 4.5,
            "k_3": 4.2,
            "k_4": 1.8,
            "crease_1": 14.17,
            "crease_2": 10.5,
            "crease_3": 6.0,
            "crease_4": 1.8,
        },
    ),
    "t3-eta-3-4": ("arithmetic", {"eta_3_printed": 0.084, "eta_3_derived": 0.42, "eta_4": 0.27}),
    "t3-eta-prime": (
        "inconsistent",
        {"eta_2_printed": 0.1152, "eta_3_printed": 0.11, "eta_2": 0.3463, "eta_3": 0.2748},
    ),
    "t3-end-torque": ("arithmetic", {"D": 4.446, "J": -5.66}),
    "t3-never-slips": ("inconsistent", {"slips_after": 0.3544, "length": 0.15}),
    "choi-14": (
        "inconsistent",
        {"from": -0.4676, "to": -0.4382, "deepest": -0.03507, "work": -0.0005161, "at_origin": 0.0},
    ),
    "choi-19": ("inconsistent", {"transition": 8.467, "steepest": 9.194}),
    "choi-20": ("inconsistent", {"transition": 8.853, "steepest": 9.538}),
    "motor-gear": ("inconsistent", {"printed": 6.0, "named": 8.0}),
    "error-bound": ("inconsistent", {"least": 0.2, "greatest": 0.3}),
    "fig16-two-models": ("definition", {"curves": 1.0}),
    "mean-torque": ("definition", {"mean": -0.1533, "mean_modulus": 1.849}),
    "mean-torque-mae": ("inconsistent", {"share": 0.05556, "least_difference": 0.09625, "mae": 0.063}),
    "t4-caption": ("misprint", {"models": 3.0}),
    "t4-mre-unit": ("dimension", {"cubic_mre": 0.271}),
    "t4-mrse": ("misprint", {"letters_shared": 4.0}),
    "t5-caption": ("misprint", {"models": 3.0}),
    "t5-mre-unit": ("dimension", {"maxwell-slip": 4.816, "cubic": 4.562, "bouc-wen": 2.866}),
    "t5-rmse-reduction": (
        "arithmetic",
        {"rmse": 0.08929, "mre": 0.1644, "mae": 0.2083, "rmse_low": 0.07207, "rmse_high": 0.1062},
    ),
    "abstract-deflection": ("inconsistent", {"largest": 1.0}),
    "appendix-figure": ("misprint", {"cited": 3.0, "right": 5.0}),
    "appendix-equations": ("misprint", {"wrong": 4.0}),
    "a2-virtual-work": ("inconsistent", {"ratio": 2.0}),
    "a3-modulus": ("misprint", {"rate_m": -0.01484}),
    "a6-derivative": ("misprint", {"literal": 0.01987, "derivative": 0.002398, "c2": 0.002398}),
    "a6-factor": ("inconsistent", {"with_j2": 0.4531, "with_2_j2": 0.0}),
    "a7-c1-denominator": ("dimension", {"share": 0.0914}),
    "a8-foe": ("definition", {"force": 5.0}),
    "choi-range-unit": ("dimension", {"ratio": 1.143}),
    "choi-signed-objective": (
        "inconsistent",
        {
            "pos_true": 15.44,
            "pos_signed": 10.42,
            "pos_squares": 15.44,
            "neg_true": 15.5,
            "neg_signed": 61.99,
            "neg_squares": 15.5,
        },
    ),
    "choi-bound-name": ("misprint", {"names": 2.0}),
    "choi-path-name": ("misprint", {"obao": 0.153, "oabo": -0.153}),
    "choi-element-sign": ("misprint", {"theta": 0.7}),
    "choi-proof-scope": ("inconsistent", {"across_zero": 0.1711, "least_negative_side": 0.0}),
}
"""Severity and deciding figures of every row; figures of the order of rounding errors are pinned to zero."""


@pytest.fixture(scope="module")
def rows() -> dict[str, AuditRow]:
    found = audit()
    assert len({row.id for row in found}) == len(found)
    return {row.id: row for row in found}


def test_no_row_is_missing_or_new(rows: dict[str, AuditRow]) -> None:
    assert list(rows) == list(PINNED)


@pytest.mark.parametrize("name", PINNED)
def test_a_row_is_what_it_was(rows: dict[str, AuditRow], name: str) -> None:
    row = rows[name]
    severity, values = PINNED[name]
    assert row.contradicts
    assert row.severity == severity
    assert severity in SEVERITIES
    assert row.values == pytest.approx(values, rel=1e-3, abs=1e-8)
    assert row.paper in (1, 2)
    for text in (row.place, row.printed, row.recomputed, row.how, row.reading):
        assert text.strip()


def test_rows_are_plain_data(rows: dict[str, AuditRow]) -> None:
    assert [record["id"] for record in json.loads(json.dumps(as_records()))] == list(rows)


def found_with(monkeypatch: pytest.MonkeyPatch, row: str, **changes: Any) -> bool:
    for name, value in changes.items():
        monkeypatch.setattr(printed_tables, name, value)
    return next(r for r in audit() if r.id == row).contradicts


MENDED_ELEMENTS = {
    "k": (3.6667, 4.5, 4.2, 1.8), "eta": (0.22, 0.36, 0.42, 0.27),
    "k'": (8.52, 6.82, 3.24, 1.18), "eta'": (0.29, 0.35, 0.27, 0.14),
}  # fmt: skip


@pytest.mark.parametrize("row", ["t3-k-not-differences", "t3-eta-3-4", "t3-end-torque", "t3-never-slips"])
def test_a_mended_table_3_is_not_accused(monkeypatch: pytest.MonkeyPatch, row: str) -> None:
    assert not found_with(monkeypatch, row, PRINTED_ELEMENTS=MENDED_ELEMENTS)


def test_a_mended_q4_is_not_accused(monkeypatch: pytest.MonkeyPatch) -> None:
    assert not found_with(monkeypatch, "t2-q4-sign", PRINTED_Q4_TORQUE=-5.62)


def test_mended_claims_are_not_accused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(printed.CLAIMS, "reduction", {"rmse": 0.09, "mre": 0.16, "mae": 0.21})
    monkeypatch.setitem(printed.CLAIMS, "models_in_captions", 3)
    monkeypatch.setitem(printed.CLAIMS, "choi_degree", 5)
    monkeypatch.setitem(printed.CLAIMS, "torque_error_section_4", 0.2)
    monkeypatch.setitem(printed.CLAIMS, "mean_torque_error", 0.03)
    monkeypatch.setitem(printed.CLAIMS, "gear", "1:8")
    monkeypatch.setitem(printed.CITED, "individual compliant branches", ("5", "single branch"))
    standing = {row.id for row in audit() if row.contradicts}
    mended = {
        "t5-rmse-reduction", "t4-caption", "t5-caption", "intro-choi-degree", "error-bound", "mean-torque-mae",
        "motor-gear", "appendix-figure",
    }  # fmt: skip
    assert standing == set(PINNED) - mended


def test_steeper_transitions_would_meet_the_second_papers_conditions(monkeypatch: pytest.MonkeyPatch) -> None:
    from hystbench.reports.paper import passivity

    steep = np.array([(0.85, 3.75), (0.95, 5.02)])
    monkeypatch.setattr(passivity, "TRANSITION_POS", steep)
    held = {c.name.split(":")[0]: c.holds for c in passivity.choi_conditions_of_published_loop()}
    assert held["Eq. 19"]
    assert not held["Eq. 20"]
