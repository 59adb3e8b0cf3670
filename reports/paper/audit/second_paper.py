"""Contradictions in the second paper."""

from __future__ import annotations

from itertools import pairwise

from numpy.polynomial import Polynomial

from .. import passivity, printed
from ..dimensions import inconsistent
from .rows import Checks, Found

__all__ = ["CHECKS"]

CHECKS = Checks(paper=2)


@CHECKS.row(
    id="choi-range-unit", place="appendix 1, identification range", severity="dimension", printed="deformation range about 16 Nm, permissible torque range about 14 Nm",
    how="dimensions; ratio of both", reading="a torque range",
)  # fmt: skip
def _() -> Found:
    said = inconsistent(2, "appendix 1, range")
    ratio = printed.SPRING_RANGE["identified"] / printed.SPRING_RANGE["permissible"]
    return f"{said}; {ratio - 1.0:.0%} beyond the permissible range", bool(said), {"ratio": ratio}


@CHECKS.row(
    id="choi-signed-objective", place="Eqs. 42 and 43", severity="inconsistent", printed="argmin over s of Σ τ_err (signed)",
    how="noise-free data of a spring of known s, objective over s from the bound to 4 s: where the signed sum and the sum of squares are least",
    reading="sum of squares",
    note="Errors of opposite sign cancel and negative ones are rewarded: the minimum is at an end of the range. A modulus or square may have been lost in extraction.",
)  # fmt: skip
def _() -> Found:
    found = passivity.objectives()
    told = "; ".join(
        f"s {o.side} = {o.true:.2f}: signed {o.signed_finds:.2f} (range {o.grid[0]:.2f} to {o.grid[-1]:.2f}), squares {o.squared_finds:.2f}"
        for o in found
    )
    at_end = all(o.signed_finds in (o.grid[0], o.grid[-1]) for o in found)
    right = all(abs(o.squared_finds - o.true) < 1e-9 for o in found)
    values = {
        f"{o.side}_{n}": v
        for o in found
        for n, v in (("true", o.true), ("signed", o.signed_finds), ("squares", o.squared_finds))
    }
    return told, at_end and right, values


@CHECKS.row(
    id="choi-bound-name", place="Eq. 43 and the text after it", severity="misprint", printed="s_{-,max} in Eq. 43, s_{,min} in the text",
    how="names of one bound", reading="s_{-,min}: the greatest derivative at θ < 0 is the least admissible s−",
    note="The missing minus may be an extraction error.",
)  # fmt: skip
def _() -> Found:
    _, equation, text = printed.SLOPE_BOUNDS
    return (
        f"{equation} and {text} name the same bound; by Eq. 42's pattern it is s_{{-,min}}",
        equation != text,
        {"names": len({equation, text})},
    )


@CHECKS.row(
    id="choi-path-name", place="Eq. 44", severity="misprint", printed="∮ over OABO for the path OBAO",
    how="work along O-B-A-O and along O-A-B-O on the example spring", reading="OBAO",
    note="The printed integrals are those of OBAO; OABO is the same loop the other way round.",
)  # fmt: skip
def _() -> Found:
    model = passivity.example_choi()
    corners = passivity.loop_types(model)[0].corners
    curves = {frozenset("OB"): "ascending_pos", frozenset("OA"): "descending_pos"}

    def along(path: str) -> float:
        total = 0.0
        for start, stop in pairwise(path):
            (x1, y1), (x2, y2) = corners[start], corners[stop]
            name = curves.get(frozenset((start, stop)))
            if name is None:
                total += 0.5 * (y1 + y2) * (x2 - x1)
            else:
                primitive = Polynomial(model.parameters_[name]).integ()
                total += float(primitive(x2) - primitive(x1))
        return total

    named, under = printed.LOOP_PATHS["44"]
    found = {path: along(path) for path in (named, under)}
    others = [n for n, (a, b) in printed.LOOP_PATHS.items() if a != b]
    told = ", ".join(f"{path}: {value:.4f} J" for path, value in found.items())
    return told, others == ["44"] and found[named] > 0.0 > found[under], {p.lower(): v for p, v in found.items()}


@CHECKS.row(
    id="choi-element-sign", place="Eqs. 44-46, 49, 50", severity="misprint", printed="θ ∋ [θ_min, θ_max]",
    how="which of the two is a set: the interval has a least and a greatest element, θ is a number", reading="θ ∈ [θ_min, θ_max]",
)  # fmt: skip
def _() -> Found:
    low, high = passivity.STROKE
    theta = passivity.loop_types(passivity.example_choi())[0].high
    return f"{low} <= {theta} <= {high}: the interval contains θ", low <= theta <= high, {"theta": theta}


@CHECKS.row(
    id="choi-proof-scope", place="appendix 2, opening", severity="inconsistent", printed="all contour integrals are non-negative; cases in positive deformation are covered",
    how="loops of the example spring that the four cases leave out: one across zero, and the four types at negative deformation",
    reading="every fitted model is driven round all of them",
    note="By symmetry the negative cases follow; loops across zero, where both slopes act, are in none of the four cases. None found negative here.",
)  # fmt: skip
def _() -> Found:
    model = passivity.example_choi()
    across = passivity.work(model.predict, (-0.6, 0.6))
    covered = [t for t in passivity.loop_types(model) if min(t.low, t.high) < 0.0 < max(t.low, t.high)]
    negative = min(t.printed for t in passivity.loop_types(model, "neg"))
    return (
        f"{len(covered)} of 4 cases crosses zero; there the work is {across:.4f} J; at negative deformation at least {negative:.4f} J",
        not covered,
        {"across_zero": across, "least_negative_side": negative},
    )
