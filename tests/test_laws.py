"""The laws of hysteresis as property tests over random motions: what holds for which model."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from motions import Floats, through, turning_points

from hystbench import models
from hystbench.datasets import published_loop as paper


def _cells(clockwise: bool) -> Any:
    width = 0.2
    centres = width * (np.arange(10) - 4.5)
    alpha, beta = (v.ravel() for v in np.meshgrid(centres, centres, indexing="ij"))
    alpha, beta = alpha[alpha >= beta], beta[alpha >= beta]
    weights = np.random.default_rng(0).uniform(0.1, 1.0, alpha.size)
    if clockwise:
        weights = np.where(alpha > beta, -weights, 30.0)
    return models.get("preisach").from_parameters(alpha=alpha, beta=beta, weights=weights, offset=0.2, width=width)


def _relays() -> Any:
    cells = _cells(False).parameters_
    return models.get("preisach").from_parameters(
        alpha=cells["alpha"], beta=cells["beta"] - 0.033, weights=cells["weights"], offset=0.0
    )


CLOCKWISE = {
    "maxwell-slip": models.get("maxwell-slip").from_parameters(
        # A loop of its own, with gaps everywhere: the printed branches cross near H, so tiny loops there run the other way.
        ascending=[[-1.0, -3.0], [-0.4, -0.5], [0.3, 1.2], [0.7, 2.5]],
        descending=[[1.0, 3.0], [0.4, 0.5], [-0.3, -1.2], [-0.7, -2.5]],
        transition_pos=[[0.7, 2.5], [0.85, 2.8], [1.0, 3.0]],
        transition_neg=[[-0.7, -2.5], [-0.85, -2.8], [-1.0, -3.0]],
    ),
    "prandtl-ishlinskii": models.get("prandtl-ishlinskii").from_parameters(
        weights=[3.0, -0.5, -0.4, -0.3, -0.2], thresholds=[0.0, 0.1, 0.25, 0.4, 0.7]
    ),
    "preisach": _cells(True),
    "bouc-wen": models.get("bouc-wen").from_parameters(stiffness=2.0, alpha=0.3, A=1.0, beta=3.0, gamma=1.0, n=1.0),
    "bouc-wen n=2": models.get("bouc-wen").from_parameters(stiffness=2.0, alpha=0.3, A=1.0, beta=3.0, gamma=-2.0, n=2.0),
    "choi-backlash": models.get("choi-backlash").from_parameters(
        ascending_pos=[0.3, 2.0, 1.0, 0.5], ascending_neg=[0.3, 2.0, -1.0, 0.5],
        descending_pos=[-0.3, 2.0, 1.0, 0.5], descending_neg=[-0.3, 2.0, -1.0, 0.5], slope_pos=9.0, slope_neg=7.0,
    ),
    "cubic": models.get("cubic").from_parameters(ascending=[0.1, 4.0, 0.2, 1.5], descending=[-0.1, 4.0, -0.2, 1.5]),
}  # fmt: skip
"""One model of each kind whose loops dissipate."""

PRINTED = models.get("maxwell-slip").from_parameters(
    ascending=paper.ASCENDING,
    descending=paper.DESCENDING,
    transition_pos=paper.TRANSITION_POS,
    transition_neg=paper.TRANSITION_NEG,
)

COUNTER = {
    "prandtl-ishlinskii": models.get("prandtl-ishlinskii").from_parameters(
        weights=[1.0, 0.5, 0.4, 0.3, 0.2], thresholds=[0.0, 0.1, 0.25, 0.4, 0.7]
    ),
    "preisach": _cells(False),
    "preisach relays": _relays(),
}

ALL = {**CLOCKWISE, **{f"{name} counter-clockwise": model for name, model in COUNTER.items()}, "printed": PRINTED}
WIPING = {name: ALL[name] for name in ALL if not name.startswith(("bouc-wen", "cubic", "choi"))}
RETURNING = {name: model for name, model in WIPING.items() if name != "printed"}
"""Where the printed branches are as steep as its transitions, a minor loop that reached the other branch comes back to
its first turn before the transition has closed the gap."""

PLAYS_AND_RELAYS = {name: model for name, model in ALL.items() if name.startswith(("prandtl", "preisach"))}


@pytest.mark.parametrize("model", ALL.values(), ids=list(ALL))
@given(turns=turning_points(), seed=st.integers(0, 1000))
def test_rate_independence(model: Any, turns: list[float], seed: int) -> None:
    """Only the path counts: another sampling of it and pauses give the same output at the samples in common."""
    x = through(turns, 6)
    rng = np.random.default_rng(seed)
    pieces, common = [x[:1]], [0]
    for a, b in pairwise(x):
        inner = a + (b - a) * np.sort(rng.uniform(0.0, 1.0, rng.integers(0, 4)))
        pieces.append(np.concatenate([inner, np.repeat(b, rng.integers(1, 3))]))
        common.append(common[-1] + pieces[-1].size)
    wanted = model.predict(x)
    found = model.predict(np.concatenate(pieces))[common]
    np.testing.assert_allclose(found, wanted, atol=1e-7 * max(float(np.ptp(wanted)), 1.0))


@pytest.mark.parametrize("model", ALL.values(), ids=list(ALL))
@given(turns=turning_points(-1.3, 1.3), cut=st.integers(1, 60))
def test_splitting_a_motion_changes_nothing(model: Any, turns: list[float], cut: int) -> None:
    """A stepper carries the memory across any cut, and equals predict."""
    x = through(turns, 6)
    stepper = model.stepper()
    found = []
    for block in (x[:cut], x[cut:]):
        found += [stepper.step(v) for v in block.tolist()]
    np.testing.assert_allclose(found, model.predict(x), rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("model", WIPING.values(), ids=list(WIPING))
@given(inner=turning_points(-0.55, 0.55), later=turning_points(-1.0, 1.0))
def test_wiping_out(model: Any, inner: list[float], later: list[float]) -> None:
    """A larger extreme erases what smaller ones left in the memory."""
    after = [0.9, -0.95, *later]
    plain = through([0.0, 1.0, -1.0, *after], 8)
    detour = through([0.0, 1.0, -1.0, *inner, *after], 8)
    tail = 8 * (len(after) - 1)
    np.testing.assert_allclose(model.predict(detour)[-tail:], model.predict(plain)[-tail:], atol=1e-9)


@pytest.mark.parametrize("model", RETURNING.values(), ids=list(RETURNING))
@given(outer=st.integers(2, 9), depth=st.integers(1, 8), inner=turning_points(0.0, 1.0, most=6))
def test_return_point_memory(model: Any, outer: int, depth: int, inner: list[float]) -> None:
    """Back at the input where it turned, with any motion between the two turns, the output is what it was there."""
    top = outer / 10.0
    bottom = top - 0.1 * depth
    x = through([0.0, 1.0, -1.0, top, bottom, *(bottom + (top - bottom) * v for v in inner), top], 8)
    y = model.predict(x)
    assert y[-1] == pytest.approx(y[3 * 8], abs=1e-9)


@pytest.mark.parametrize("model", PLAYS_AND_RELAYS.values(), ids=list(PLAYS_AND_RELAYS))
@given(first=turning_points(), second=turning_points(), low=st.integers(-9, 7), size=st.integers(1, 8))
def test_congruency(model: Any, first: list[float], second: list[float], low: int, size: int) -> None:
    """Minor loops between the same two inputs have the same shape whatever came before."""
    bottom, top = low / 10.0, min((low + size) / 10.0, 0.95)
    shapes = []
    for before in (first, second):
        x = through([0.0, *before, top, bottom, top, bottom], 12)
        loop = model.predict(x)[-25:]
        shapes.append(loop - loop[0])
    np.testing.assert_allclose(shapes[0], shapes[1], atol=1e-9)


@pytest.mark.parametrize("model", CLOCKWISE.values(), ids=list(CLOCKWISE))
@given(turns=turning_points(-1.0, 1.0, most=8))
def test_closed_loops_dissipate(model: Any, turns: list[float]) -> None:
    """The work ∮ y dx of a periodic motion is not negative."""
    work, scale = _steady_work(model, turns)
    assert work >= -1e-6 * scale


@pytest.mark.parametrize("model", COUNTER.values(), ids=list(COUNTER))
@given(turns=turning_points(-1.0, 1.0, most=8))
def test_counter_clockwise_loops_take_work(model: Any, turns: list[float]) -> None:
    work, scale = _steady_work(model, turns)
    assert work <= 1e-6 * scale


def _steady_work(model: Any, turns: list[float]) -> tuple[float, float]:
    """∮ y dx over one cycle and its scale, once a periodic motion has gone round so often that its output repeats."""
    settling = turns * 200
    x = np.concatenate([settling, through([*turns, turns[0]], 400)])
    y = model.predict(x)
    x, y = x[len(settling) :], y[len(settling) :]
    return _work(x, y), max(float(np.ptp(y) * np.ptp(x)), 1e-3)


def _work(x: Floats, y: Floats) -> float:
    return float(np.sum(0.5 * (y[1:] + y[:-1]) * np.diff(x)))


@pytest.mark.parametrize(("low", "high"), [(0.2, 0.8), (-0.8, -0.2), (-0.5, 0.6), (-0.9, 0.9)])
@pytest.mark.parametrize("model", CLOCKWISE.values(), ids=list(CLOCKWISE))
def test_the_second_papers_four_loop_types_dissipate(model: Any, low: float, high: float) -> None:
    """Appendix 2: loops on the positive side, on the negative side, and across zero, small and large."""
    x = through([0.0, high, low, high, low, high], 2000)
    y = model.predict(x)
    assert _work(x[-4001:], y[-4001:]) > 0.0
