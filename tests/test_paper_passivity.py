"""The second source paper's appendices: identification of the transition slopes, and work round its four loop types."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hystbench import models
from hystbench.errors import InputError
from hystbench.reports.paper.passivity import (
    choi_conditions_of_published_loop,
    example_choi,
    integrals,
    loop_types,
    objectives,
    work,
)


def elastoplastic(stiffness: float, limit: float):  # type: ignore[no-untyped-def]
    def predict(x: np.ndarray) -> np.ndarray:
        y, force = np.empty_like(x), 0.0
        last = 0.0
        for k, here in enumerate(x):
            force = min(limit, max(-limit, force + stiffness * (here - last)))
            y[k], last = force, here
        return y

    return predict


def test_work_of_an_elastoplastic_element_is_the_parallelogram() -> None:
    stiffness, limit, amplitude = 4.0, 0.5, 0.6
    exact = 4.0 * limit * (amplitude - limit / stiffness)
    assert work(elastoplastic(stiffness, limit), (-amplitude, amplitude)) == pytest.approx(exact, rel=1e-5)
    assert work(elastoplastic(stiffness, limit), (-0.1, 0.1)) == pytest.approx(0.0, abs=1e-12)
    # Counter-clockwise: work is taken out.
    assert work(lambda x: -elastoplastic(stiffness, limit)(x), (-amplitude, amplitude)) == pytest.approx(
        -exact, rel=1e-5
    )


@pytest.mark.parametrize("side", ["pos", "neg"])
def test_the_printed_integrals_are_the_work_of_the_driven_model(side: str) -> None:
    model = example_choi()
    found = loop_types(model, side)
    assert [t.equation for t in found] == ["44", "45", "46", "50"]
    for loop in found:
        driven = work(model.predict, (loop.low, loop.high), loop.approach)
        assert driven == pytest.approx(loop.printed, rel=1e-5, abs=1e-9)
    assert all(loop.printed > 0.0 for loop in found[:3])
    assert found[3].printed == 0.0


def test_the_corners_of_the_loops_are_ordered_and_on_the_models_path() -> None:
    model = example_choi()
    by_path = {t.path: t for t in loop_types(model)}
    for path, order in (("OBAO", "OAB"), ("CDFEC", "CDEF"), ("GIJHG", "GHIJ"), ("KLK", "KL")):
        places = [by_path[path].corners[name][0] for name in order]
        assert places == sorted(places)
        assert len(set(places)) == len(places)
    gijhg = by_path["GIJHG"].corners
    x = [0.0, 0.6, gijhg["G"][0], gijhg["I"][0], gijhg["J"][0], gijhg["H"][0]]
    dense = np.concatenate([np.linspace(p, q, 500) for p, q in pairwise(x)])
    y = np.asarray(model.predict(dense))[499::500]
    np.testing.assert_allclose(y[1:], [gijhg[name][1] for name in "GIJH"], atol=1e-6)


@settings(max_examples=15, deadline=None)
@given(st.floats(0.5, 3.0), st.floats(0.0, 1.0), st.floats(0.05, 0.2), st.floats(2.5, 6.0))
def test_every_spring_that_meets_the_conditions_is_passive(
    linear: float, cubic: float, share: float, steeper: float
) -> None:
    width = share * linear
    ascending, descending = [0.0, linear + width, 0.0, cubic], [0.0, linear, 0.0, cubic]
    slope = steeper * (linear + width + 3.0 * cubic)
    model = models.get("choi-backlash").from_parameters(
        ascending_pos=ascending, descending_pos=descending, ascending_neg=descending, descending_neg=ascending,
        slope_pos=slope, slope_neg=slope, stroke=[-1.0, 1.0],
    )  # fmt: skip
    assert all(condition.holds for condition in model.conditions_)
    types = loop_types(model)
    assert min(t.printed for t in types[:3]) > 0.0
    for t in types:
        assert work(model.predict, (t.low, t.high), t.approach) == pytest.approx(t.printed, rel=1e-4, abs=1e-9)


def test_a_spring_whose_lines_are_too_long_for_the_loops_is_refused_in_one_line() -> None:
    model = models.get("choi-backlash").from_parameters(
        ascending_pos=[0.0, 2.0], descending_pos=[0.0, 1.0], ascending_neg=[0.0, 1.0], descending_neg=[0.0, 2.0],
        slope_pos=2.05, slope_neg=2.05,
    )  # fmt: skip
    with pytest.raises(InputError, match=r"no loop of Fig\. 23"):
        loop_types(model)


def test_a_spring_with_exchanged_curves_is_reported_as_not_passive() -> None:
    play = models.get("prandtl-ishlinskii").from_parameters(weights=[1.0, 0.5], thresholds=[0.0, 0.05])
    rows = [row for row in integrals({"play": play}) if row.model == "play"]
    assert [row.path for row in rows] == ["OBAO", "CDFEC", "GIJHG", "KLK", "across zero"]
    # Plays of positive weight run counter-clockwise.
    assert not any(row.passive for row in rows if row.path in ("OBAO", "CDFEC", "across zero"))
    example = [row for row in integrals({}) if row.passive]
    assert len(example) == 5


def test_signed_sums_find_no_slope_and_squares_do() -> None:
    for objective in objectives():
        assert objective.squared_finds == objective.true
        assert objective.squared.min() < 1e-20
        assert objective.signed_finds in (objective.grid[0], objective.grid[-1])
        # The true slope has a signed sum of zero, which is not its least value.
        assert objective.signed[objective.grid == objective.true][0] == pytest.approx(0.0, abs=1e-9)
        assert objective.signed.min() < -1.0


def test_which_conditions_the_published_loop_meets() -> None:
    held = {c.name.split(":")[0]: c.holds for c in choi_conditions_of_published_loop()}
    assert held == {"Eq. 14": False, "Eq. 15": True, "Eq. 19": False, "Eq. 20": False, "Eq. 21": False}
