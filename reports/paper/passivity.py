"""The second paper's appendices: identification (Eqs. 40-43), its conditions, and the passivity integrals (44-50).

The spring of that paper is not printed in what was at hand, so its equations run on an example: Choi's model fitted to
the curves of the first paper's Table 1, with transition slopes that meet Eqs. 19 and 20 (the published k+ and k− do
not). The integrals are evaluated twice: as printed, from the four functions, and by driving a model round the loop,
which any registered model can be.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray
from scipy.optimize import brentq

from ... import models
from ...datasets.published_loop import ASCENDING, DESCENDING, TRANSITION_NEG, TRANSITION_POS
from ...datasets.trajectories import reversals
from ...errors import InputError
from ...models import Condition
from .loop import curve, gap_between_curves, slopes
from .printed import SECOND_PAPER_DEGREE

__all__ = [
    "STROKE",
    "LoopIntegral",
    "LoopType",
    "Objective",
    "choi_conditions_of_published_loop",
    "example_choi",
    "integrals",
    "loop_types",
    "objectives",
    "work",
]

Floats = NDArray[np.float64]
STROKE = (-0.85, 0.85)
"""Where both curves of Table 1 are defined, made symmetric: beyond C they would cross."""

STEEPER = 1.5
"""Transition slopes of the example over the steepest derivative on their side; assumed."""


def choi_conditions_of_published_loop() -> list[Condition]:
    """Eqs. 14, 15, 19, 20 and 21 on the first paper's loop, each with the figure that decides it."""
    low, high = DESCENDING[-1, 0], ASCENDING[-1, 0]
    vertices = np.union1d(ASCENDING[:, 0], DESCENDING[:, 0])
    inside = vertices[(vertices >= low) & (vertices <= high)]
    gap = gap_between_curves(inside)
    rises = np.concatenate([slopes(ASCENDING), slopes(DESCENDING)])
    conditions = [
        Condition(
            "Eq. 14: the ascending curve lies above the descending one",
            bool(np.all(gap >= 0.0)),
            f"smallest gap {gap.min():.4f} N·m at x = {inside[np.argmin(gap)]:.4f}",
        ),
        Condition("Eq. 15: all functions rise", bool(rises.min() > 0.0), f"smallest slope {rises.min():.4f}"),
    ]
    for number, sign, transition, name in ((19, 1.0, TRANSITION_POS, "k+"), (20, -1.0, TRANSITION_NEG, "k−")):
        mean = float(np.diff(transition[[0, -1], 1])[0] / np.diff(transition[[0, -1], 0])[0])
        steepest = steepest_segment(sign)
        conditions.append(
            Condition(
                f"Eq. {number}: {name} exceeds every slope of the curves on its side",
                mean > steepest,
                f"{name} = {mean:.4f}, steepest segment {steepest:.4f}",
            )
        )
    # Eq. 21 asks the same of chords: the steepest chord of a polyline is one of its segments.
    conditions.append(
        Condition(
            "Eq. 21: a transition line leaves each curve on the inner side of the loop",
            conditions[2].holds and conditions[3].holds,
            "follows from Eqs. 19 and 20, which the printed k+ and k− miss",
        )
    )
    return conditions


def steepest_segment(sign: float) -> float:
    """Steepest segment of Table 1's curves on one side of zero."""
    found = 0.0
    for points in (ASCENDING, DESCENDING):
        side = np.maximum(sign * points[1:, 0], sign * points[:-1, 0]) > 0.0
        found = max(found, float(slopes(points)[side].max()))
    return found


def example_choi() -> Any:
    """Choi's model through the origin, fitted to the curves of Table 1 within :data:`STROKE` (degree 5)."""
    parameters: dict[str, Any] = {"stroke": STROKE}
    for branch, points in (("ascending", ASCENDING), ("descending", DESCENDING[::-1])):
        for side, end in (("neg", STROKE[0]), ("pos", STROKE[1])):
            x = np.linspace(end / 400.0, end, 400)
            powers = np.arange(1, SECOND_PAPER_DEGREE + 1)
            # No constant term: both curves pass through A = G, as the published loop does.
            coefficients = np.linalg.lstsq(x[:, None] ** powers, curve(points, x), rcond=None)[0]
            parameters[f"{branch}_{side}"] = np.concatenate([[0.0], coefficients])
    for side, end in (("neg", STROKE[0]), ("pos", STROKE[1])):
        grid = np.linspace(0.0, end, 201)
        steepest = max(
            float(Polynomial(parameters[f"{branch}_{side}"]).deriv()(grid).max())
            for branch in ("ascending", "descending")
        )
        parameters[f"slope_{side}"] = STEEPER * steepest
    return models.get("choi-backlash").from_parameters(**parameters)


# ---- identification ------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Objective:
    """Which slope an objective finds on data whose slope is known."""

    side: str
    true: float
    grid: Floats
    signed: Floats
    squared: Floats

    @property
    def signed_finds(self) -> float:
        """The slope at which the sum of signed errors, as printed in Eqs. 42 and 43, is least on the grid."""
        return float(self.grid[np.argmin(self.signed)])

    @property
    def squared_finds(self) -> float:
        return float(self.grid[np.argmin(self.squared)])


def objectives() -> list[Objective]:
    """Eqs. 42 and 43 as printed and with squares, on noise-free data of the example with many turns (as Fig. 22)."""
    model = example_choi()
    _, x = turning_trajectory()
    y = model.predict(x)
    found = []
    for side, inside in (("pos", x >= 0.0), ("neg", x < 0.0)):
        true = float(model.parameters_[f"slope_{side}"])
        grid = true * np.concatenate([np.linspace(1.0 / STEEPER, 1.0, 41)[1:], np.linspace(1.0, 4.0, 61)[1:]])
        signed, squared = [], []
        for slope in grid:
            trial = type(model).from_parameters(**{**model.parameters_, f"slope_{side}": float(slope)})
            error = (y - trial.predict(x))[inside]
            signed.append(float(error.sum()))
            squared.append(float(error @ error))
        found.append(Objective(side, true, grid, np.array(signed), np.array(squared)))
    return found


def turning_trajectory() -> tuple[Floats, Floats]:
    """A deformation with many turns at many places on both sides of zero (time in s, x)."""
    points = [0.0, 0.8, 0.6, 0.75, 0.4, 0.6, 0.2, 0.45, 0.1, 0.3, -0.8, -0.6, -0.7, -0.4, -0.55, -0.2, -0.4, 0.0]
    return reversals(points, speed=0.5, rate=200.0)


# ---- passivity -----------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class LoopType:
    """One of Fig. 23's loops: its path, equation, turning points, and how motion arrives at it."""

    path: str
    equation: str
    low: float
    high: float
    approach: tuple[float, ...]
    corners: dict[str, tuple[float, float]]
    printed: float
    """The sum of definite integrals as printed, N·m·rad."""


def loop_types(model: Any, side: str = "pos") -> list[LoopType]:
    """The four loops of Fig. 23 on one side of zero of a Choi model, their corners solved from its functions.

    The paper covers positive deformation; ``side="neg"`` does the same for negative deformation, where low and high
    swap their roles.

    Raises
    ------
    InputError
        If the transition lines are too long for the loops' turning points.
    """
    p = model.parameters_
    sign = 1.0 if side == "pos" else -1.0
    slope = p[f"slope_{side}"]
    # On the negative side −f(−θ) of the other branch plays each curve's part.
    upper, lower = ("ascending", "descending") if side == "pos" else ("descending", "ascending")
    mirror = np.where(np.arange(64) % 2 == 0, sign, 1.0)

    def polynomial(branch: str) -> Polynomial:
        c = np.asarray(p[f"{branch}_{side}"])
        return Polynomial(c * mirror[: c.size])

    ac, dc = polynomial(upper), polynomial(lower)

    def line(through: float, value: float) -> Polynomial:
        return Polynomial([value - slope * through, slope])

    def meets(a: Polynomial, b: Polynomial, start: float, stop: float) -> float:
        if (a(start) - b(start)) * (a(stop) - b(stop)) > 0.0:
            raise InputError(
                f"no loop of Fig. 23 fits between {start:.3g} and {stop:.3g}: a transition line does not meet the curve "
                "there; give steeper transition slopes"
            )
        return float(brentq(lambda t: float(a(t) - b(t)), start, stop, xtol=1e-15))

    def area(a: Polynomial, b: Polynomial, start: float, stop: float) -> float:
        primitive = (a - b).integ()
        return float(primitive(stop) - primitive(start))

    def down_from(top: float) -> tuple[Polynomial, float]:
        falling = line(top, float(ac(top)))
        return falling, meets(falling, dc, 0.0, top - 1e-9)

    def up_from(bottom: float) -> tuple[Polynomial, float]:
        rising = line(bottom, float(dc(bottom)))
        return rising, meets(rising, ac, bottom + 1e-9, bottom + 1.0)

    b_ = 0.7
    ba, a_ = down_from(b_)
    c_, f_ = 0.3, 0.7
    cd, d_ = up_from(c_)
    fe, e_ = down_from(f_)
    g_ = 0.5
    gi, i_ = up_from(g_)
    # Half a line beyond I: far enough to be on the ascending curve, near enough for both lines to overlap.
    j_ = i_ + 0.5 * (i_ - g_)
    jh, h_ = down_from(j_)
    k_, l_ = h_ + 0.25 * (j_ - h_), h_ + 0.75 * (j_ - h_)

    def at(**named: tuple[float, Polynomial]) -> dict[str, tuple[float, float]]:
        return {name: (sign * t, sign * float(f(t))) for name, (t, f) in named.items()}

    return [
        LoopType("OBAO", "44", 0.0, sign * b_, (), at(O=(0.0, ac), B=(b_, ac), A=(a_, dc)),
                 area(ac, dc, 0.0, a_) + area(ac, ba, a_, b_)),
        LoopType("CDFEC", "45", sign * c_, sign * f_, (), at(C=(c_, dc), D=(d_, ac), F=(f_, ac), E=(e_, dc)),
                 area(cd, dc, c_, d_) + area(ac, dc, d_, e_) + area(ac, fe, e_, f_)),
        LoopType("GIJHG", "46", sign * g_, sign * j_, (), at(G=(g_, dc), I=(i_, ac), J=(j_, ac), H=(h_, dc)),
                 area(gi, dc, g_, h_) + area(gi, jh, h_, i_) + area(ac, jh, i_, j_)),
        LoopType("KLK", "50", sign * k_, sign * l_, (sign * j_,), at(K=(k_, jh), L=(l_, jh)), area(jh, jh, k_, l_)),
    ]  # fmt: skip


def work(predict: Callable[[Floats], Floats], turns: Sequence[float], approach: Sequence[float] = ()) -> float:
    """Work ∮ y dx, N·m·rad, that a model dissipates over one cycle between two turning points, once it repeats.

    Parameters
    ----------
    predict : callable
        Output over an input from the virgin state.
    turns : (float, float)
        The cycle's two ends.
    approach : sequence of float
        Turning points passed before, from 0 on.
    """
    low, high = turns
    corners = [0.0, *approach, high, low, high, low, high]
    samples = 4000
    # Every leg has its own samples, so that all turning points are hit exactly.
    legs = [np.linspace(a, b, samples, endpoint=False) for a, b in pairwise(corners)]
    x = np.concatenate([*legs, [corners[-1]]])
    y = np.asarray(predict(x), dtype=np.float64)
    return float(np.trapezoid(y[-2 * samples - 1 :], x[-2 * samples - 1 :]))


@dataclass(frozen=True)
class LoopIntegral:
    """The work of one model on one of the loops."""

    model: str
    path: str
    equation: str
    low: float
    high: float
    printed: float
    """By the printed integrals; NaN for models that are not Choi's, and for loops that the paper does not cover."""
    driven: float
    passive: bool


def integrals(fitted: dict[str, Any]) -> list[LoopIntegral]:
    """Eqs. 44-50 for the example and by driving for every model in ``fitted`` (id → model with ``predict``)."""
    example = example_choi()
    types = loop_types(example)
    rows = []
    size = float(np.ptp(ASCENDING[:, 1]) * np.ptp(ASCENDING[:, 0]))
    for name, model in {"choi-backlash, example": example, **fitted}.items():
        loops = [(t.path, t.equation, t.low, t.high, t.approach, t.printed) for t in types]
        loops.append(("across zero", "not covered", -0.6, 0.6, (), float("nan")))
        for path, equation, low, high, approach, printed in loops:
            driven = work(model.predict, (low, high), approach)
            known = printed if model is example else float("nan")
            # Rounding and the trapezoids leave about 1e-8 of the loop's own box.
            rows.append(LoopIntegral(name, path, equation, low, high, known, driven, driven >= -1e-7 * size))
    return rows
