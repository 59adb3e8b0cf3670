"""Appendix A of the first source paper, derived symbolically, and the dimensions of every equation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from hystbench.models.maxwell_slip import virtual_deformation
from hystbench.reports.paper import appendix_a as a
from hystbench.reports.paper.dimensions import EQUATIONS, LENGTH, NUMBER, STIFFNESS, TORQUE, inconsistent

theta, l1, l3, k, x0, count = sp.symbols("theta l1 l3 k x0 N", positive=True)
L2 = sp.sqrt(l1**2 + l3**2 - 2 * l1 * l3 * sp.cos(theta))
STRETCH = 2 * (l1 + L2 - l3)
LEVER = sp.diff(L2, theta)
TORQUE_A4 = k * (STRETCH + x0) * LEVER


def zero(expression: sp.Expr) -> bool:
    """Whether an expression vanishes identically; checked at exact rational points to full precision."""
    points = [
        (sp.Rational(1, 3), sp.Rational(1, 50), sp.Rational(9, 200)),
        (sp.Rational(7, 5), sp.Rational(1, 7), sp.Rational(4, 7)),
    ]
    return all(
        abs(expression.subs({theta: t, l1: p, l3: q, k: 3, x0: sp.Rational(1, 9), count: 6}).evalf(40))
        < sp.Float(10) ** -30
        for t, p, q in points
    )


def test_a3_is_the_derivative_and_the_cross_product() -> None:
    assert zero(LEVER - l1 * l3 * sp.sin(theta) / L2)
    along = sp.Matrix([l3 * sp.cos(theta) - l1, l3 * sp.sin(theta), 0])
    cross = along.cross(sp.Matrix([l1, 0, 0])) / L2
    assert zero(LEVER**2 - cross.dot(cross))


def test_a7_has_the_right_c2_and_a_wrong_c1() -> None:
    c2 = l1 * l3 * sp.cos(theta) / L2 - l1**2 * l3**2 * sp.sin(theta) ** 2 / L2**3
    assert zero(c2 - sp.diff(LEVER, theta))
    printed = l1**2 * l3**2 * sp.sin(theta) ** 2 / L2 + 2 * c2 * (l1 + L2 - l3)
    mended_denominator = l1**2 * l3**2 * sp.sin(theta) ** 2 / L2**2 + 2 * c2 * (l1 + L2 - l3)
    derived = sp.diff(TORQUE_A4.subs(x0, 0), theta) / k
    assert not zero(printed - derived)
    # With l2² it is A.6's J², and still lacks a second J².
    assert zero(mended_denominator - (LEVER**2 + sp.diff(LEVER, theta) * STRETCH))
    assert zero(derived - mended_denominator - LEVER**2)


def test_the_stiffness_of_a4_has_twice_the_square() -> None:
    force = k * x0
    derived = k * (2 * LEVER**2 + sp.diff(LEVER, theta) * STRETCH) + sp.diff(LEVER, theta) * force
    assert zero(sp.diff(TORQUE_A4, theta) - derived)


def test_a4_is_half_of_what_virtual_work_gives() -> None:
    energy = k * STRETCH**2 / 2 + k * x0 * STRETCH
    assert zero(sp.diff(energy, theta) - 2 * TORQUE_A4)


def test_a12_lacks_five_preloads() -> None:
    a12 = k * (12 * (l1 + L2 - l3) + x0) * LEVER
    assert zero(6 * TORQUE_A4 - a12 - 5 * k * x0 * LEVER)


SYMBOLIC = {
    a.torque_a9: count * TORQUE_A4,
    a.torque_a12: k * (12 * (l1 + L2 - l3) + x0) * LEVER,
    a.torque_virtual_work: 2 * count * TORQUE_A4,
    a.stiffness_derived: sp.diff(count * TORQUE_A4, theta),
    a.stiffness_literal: count * (k * (LEVER**2 + LEVER / theta * STRETCH) + LEVER / theta * k * x0),
    a.stiffness_restored: count * (k * (LEVER**2 + sp.diff(LEVER, theta) * STRETCH) + sp.diff(LEVER, theta) * k * x0),
}


@pytest.mark.parametrize("function", SYMBOLIC, ids=lambda f: f.__name__)
def test_the_code_evaluates_the_symbolic_expression(function: object) -> None:
    numeric = sp.lambdify((theta, l1, l3, k, x0, count), SYMBOLIC[function])  # type: ignore[index]
    grid = np.linspace(0.1, 1.3, 7)
    for b in (a.ASSUMED, replace(a.ASSUMED, l1=0.01, l3=0.08, k=400.0, preload=12.0, count=2)):
        expected = numeric(grid, b.l1, b.l3, b.k, b.x0, b.count)
        np.testing.assert_allclose(function(grid, b), expected, rtol=1e-12)  # type: ignore[operator]


def test_eq_6_of_the_model_is_a12_over_the_belt_stiffness() -> None:
    grid = np.linspace(-1.2, 1.2, 25)
    b = a.ASSUMED
    np.testing.assert_allclose(
        b.k * virtual_deformation(grid, b.l1, b.l3, b.x0), a.torque_a12(grid, b), rtol=1e-12, atol=1e-15
    )


@settings(max_examples=40, deadline=None)
@given(
    st.floats(0.005, 0.05),
    st.floats(1.05, 5.0),
    st.floats(100.0, 5000.0),
    st.floats(0.0, 20.0),
    st.sampled_from([2, 4, 6]),
)
def test_only_the_derived_stiffness_is_the_slope_of_the_torque(
    l1_: float, ratio: float, k_: float, preload: float, n: int
) -> None:
    b = a.Branch(l1_, ratio * l1_, k_, preload, n)
    grid, step = np.linspace(-1.0, 1.0, 21), 1e-5
    slope = (a.torque_a9(grid + step, b) - a.torque_a9(grid - step, b)) / (2.0 * step)
    scale = np.max(np.abs(slope))
    np.testing.assert_allclose(a.stiffness_derived(grid, b), slope, atol=1e-5 * scale)
    # A preload makes a peak in the middle: against that all differences are small.
    assert np.max(np.abs(a.stiffness_restored(grid, b) - slope)) > 0.02 * np.median(np.abs(slope))


def test_stiffness_checks_cover_the_configurations_and_accuse_only_what_differs() -> None:
    checks = a.stiffness_checks()
    assert {(c.count, c.preload) for c in checks} == {(n, f) for n in (2, 4, 6) for f in (0.0, 5.0, 10.0)}
    assert {c.expression for c in checks if c.holds} == {"derivative of A.9 (2 J_e²)"}
    # Stiffness is proportional to the number of branches.
    one = {c.count: c.at_one_rad for c in checks if c.expression.startswith("derivative") and c.preload == 5.0}
    assert one[6] == pytest.approx(3.0 * one[2])


def test_the_equations_of_the_appendix_that_disagree() -> None:
    disagree = {check.equation for check in a.equation_checks() if not check.agrees}
    assert disagree == {"A.2", "A.6 with ∂J_e/∂θ", "A.7, c1", "A.8 with ∂J_e/∂θ", "A.12"}


def test_dimensions_of_the_equations() -> None:
    assert LENGTH * LENGTH / LENGTH == LENGTH
    assert LENGTH**3 / LENGTH**3 == NUMBER
    assert str(STIFFNESS * LENGTH**2) == "N·m"
    assert str(LENGTH**2) == "m²"
    assert TORQUE != NUMBER
    bad = {(e.paper, e.number) for e in EQUATIONS if not e.consistent}
    assert bad == {
        (1, "2"), (1, "3"), (1, "4, text before"), (1, "5 and Figs. 20-23"), (1, "A.7, c1"),
        (1, "section 2.1, belt"), (1, "Table 4, MRE"), (2, "appendix 1, range"),
    }  # fmt: skip
    assert inconsistent(1, "A.9") == ""
    assert "m³" in inconsistent(1, "A.7, c1")
    assert len(EQUATIONS) == len({(e.paper, e.number) for e in EQUATIONS})
