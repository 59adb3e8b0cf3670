"""The audit: every place where the two papers contradict themselves, each other or dimensions, recomputed by code.

A row states what is printed; a function computes what stands there instead and whether it really differs, so that a row
cannot outlive the contradiction that it claims. The papers were at hand as text extracted from PDF and HTML: where a
symbol may have been lost in extraction, the row's note says so.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.polynomial import Polynomial

from ...bench.metrics import METRICS
from ...datasets.published_loop import (
    ASCENDING,
    DESCENDING,
    PRINTED_ELEMENTS,
    PRINTED_Q4_TORQUE,
    PRINTED_SLOPES,
    TABLE_4,
    TABLE_5,
    TRANSITION_NEG,
    TRANSITION_POS,
    VERTICES,
)
from . import appendix_a, passivity, printed
from .dimensions import SLOPE, STIFFNESS, TORQUE, inconsistent
from .loop import (
    READINGS,
    crossing,
    curve,
    derived_limits,
    element_sum,
    gap_between_curves,
    printed_limits,
    slope,
    slopes,
    stiffnesses,
)
from .rounding import half_step, interval
from .tables import table_1

__all__ = ["SEVERITIES", "AuditRow", "audit"]

SEVERITIES = ("misprint", "arithmetic", "inconsistent", "dimension", "definition")
"""misprint: a wrong sign, symbol or reference whose right form is evident. arithmetic: figures that do not follow from
the figures they are said to come from. inconsistent: statements or equations that exclude each other. dimension: terms
or units that cannot be added or named so. definition: a symbol or quantity without a definition, or one that cannot
have the stated property."""


@dataclass(frozen=True)
class AuditRow:
    """One finding.

    Attributes
    ----------
    values : dict of str to float
        The figures that decide it, computed by code.
    contradicts : bool
        Whether the recomputed figures really differ from the printed ones.
    reading : str
        What hystbench takes instead.
    note : str
        How certain it is, extraction errors included.
    """

    id: str
    paper: int
    place: str
    printed: str
    recomputed: str
    how: str
    severity: str
    reading: str
    note: str
    contradicts: bool
    values: dict[str, float] = field(default_factory=dict)


Found = tuple[str, bool, dict[str, float]]
_CHECKS: list[tuple[dict[str, Any], Callable[[], Found]]] = []


def _row(**told: Any) -> Callable[[Callable[[], Found]], Callable[[], Found]]:
    def register(check: Callable[[], Found]) -> Callable[[], Found]:
        _CHECKS.append((told, check))
        return check

    return register


def audit() -> list[AuditRow]:
    """All rows, in the order of the papers."""
    rows = []
    for told, check in _CHECKS:
        recomputed, contradicts, values = check()
        plain = {name: float(value) for name, value in values.items()}
        rows.append(
            AuditRow(recomputed=recomputed, contradicts=bool(contradicts), values=plain, **{"note": "", **told})
        )
    return rows


def as_records() -> list[dict[str, Any]]:
    """The rows as plain data."""
    return [asdict(row) for row in audit()]


# ---- first paper: text and equations -------------------------------------------------------------------------------


@_row(
    id="intro-model-list", paper=1, place="section 1, list of common models", severity="misprint",
    printed=", ".join(printed.INTRODUCED_MODELS), how="names in the list that occur twice",
    reading="each model once",
)  # fmt: skip
def _() -> Found:
    names = printed.INTRODUCED_MODELS
    twice = sorted({n for n in names if names.count(n) > 1})
    return f"{', '.join(twice)} is listed twice", bool(twice), {"listed": len(names), "distinct": len(set(names))}


@_row(
    id="intro-start-operator", paper=1, place="section 1, PI model", severity="definition",
    printed="two operators: the stop operator and the start operator",
    how="a play operator of threshold r and a stop operator of the same r add up to the input: max |play + stop − x| on a test motion",
    reading="play and stop operators; the model prandtl-ishlinskii uses plays",
)  # fmt: skip
def _() -> Found:
    x = np.sin(np.linspace(0.0, 12.0, 400)) * np.linspace(1.0, 0.2, 400)
    r = 0.2
    play, stop = np.zeros_like(x), np.zeros_like(x)
    for k in range(1, x.size):
        play[k] = max(x[k] - r, min(x[k] + r, play[k - 1]))
        stop[k] = min(r, max(-r, stop[k - 1] + x[k] - x[k - 1]))
    last = float(np.max(np.abs(play + stop - x)))
    return (
        f"the counterpart of stop is play: play + stop = x to {last:.0e}",
        last < 1e-12,
        {"play_plus_stop_minus_x": last},
    )


@_row(
    id="intro-choi-degree", paper=1, place="section 1, on Choi's model", severity="inconsistent",
    printed="able to express only up to a third-degree polynomial", how="degree that the second paper's appendix 1 uses",
    reading="any degree; choi-backlash defaults to 5",
)  # fmt: skip
def _() -> Found:
    claimed, used = printed.CLAIMS["choi_degree"], printed.SECOND_PAPER_DEGREE
    return f"degree {used}", used > claimed, {"claimed": claimed, "used": used}


@_row(
    id="eq1-x0", paper=1, place="Eqs. 1, 6 and A.12", severity="inconsistent",
    printed="k [12 (l1 + l2 − l3) + x0] J: x0 counted once",
    how="coefficient of k x0 J in N (k δl_e + F_0) J (A.9) with F_0 = k x0 (A.11) and N = 6; relative torque difference at 1 rad",
    reading="N k [2 (l1 + l2 − l3) + x0] J; virtual_deformation() keeps Eq. 6 as printed",
    note="Agrees with A.9 only if x0 is read as six times the preload elongation. The 12 also ties Eq. 1, introduced for "
    "the single branch of Fig. 5(b) and for any N, to N = 6.",
)  # fmt: skip
def _() -> Found:
    b, at = appendix_a.ASSUMED, np.array([1.0])
    coefficient = (
        appendix_a.torque_a9(at, b)[0] / (b.k * appendix_a.lever(at, b)[0]) - b.count * appendix_a.elongation(at, b)[0]
    ) / b.x0
    short = 1.0 - appendix_a.torque_a12(at, b)[0] / appendix_a.torque_a9(at, b)[0]
    return (
        f"x0 counts {coefficient:.0f} times; A.12 gives {short:.1%} less torque at 1 rad (assumed lengths)",
        abs(coefficient - 1.0) > 1e-6,
        {"coefficient_of_x0": coefficient, "torque_missing_at_1_rad": short},
    )


@_row(
    id="eq1-f0", paper=1, place="text after Eq. 1", severity="definition",
    printed="explains k and F_0", how="symbols explained that Eq. 1 does not contain",
    reading="F_0 = k x0 (A.11)",
)  # fmt: skip
def _() -> Found:
    absent = [s for s in printed.EXPLAINED_AFTER_EQUATION_1 if s not in printed.EQUATION_1_SYMBOLS]
    return f"{', '.join(absent)} is not in Eq. 1, which has x0", bool(absent), {"absent": len(absent)}


@_row(
    id="belt-stretch-unit", paper=1, place="section 2.1, belt", severity="dimension",
    printed="maximum stretch of 0.7 kg", how="dimensions", reading="a pull of 0.7 kgf = 6.9 N",
)  # fmt: skip
def _() -> Found:
    pull = printed.CLAIMS["belt_stretch_kg"] * printed.STANDARD_GRAVITY
    return f"{inconsistent(1, 'section 2.1, belt')}; as a weight {pull:.2f} N", True, {"pull_n": pull}


@_row(
    id="belt-pull-lever", paper=1, place="section 2.1, belt, against Table 1", severity="inconsistent",
    printed="0.7 kg and a torque of 5.66 N·m with N = 6",
    how="lever arm J >= T_J / (N F) by A.9; J never exceeds the crank length l1, because J = l1 sin(angle between l1 and l2)",
    reading="no belt limit is used",
    note="Holds if 0.7 kg is the largest pull of one belt; half of it if both strands pull with 0.7 kgf each.",
)  # fmt: skip
def _() -> Found:
    pull = printed.CLAIMS["belt_stretch_kg"] * printed.STANDARD_GRAVITY
    arm = abs(VERTICES["J"][1]) / (printed.CLAIMS["branches"] * pull)
    preload = printed.CLAIMS["preload_n"] / pull
    return (
        f"a crank of at least {arm:.3f} m ({arm / 2:.3f} m with two strands), for an elbow joint; the preload alone is {preload:.0%} of that pull",
        arm / 2 > 0.05,
        {"least_crank_m": arm, "preload_share": preload},
    )


@_row(
    id="eq2-force-torque", paper=1, place="Eq. 2", severity="dimension",
    printed="hysteresis force F_i = Σ f_i + T_0, forces f_i plus an initial torque", how="dimensions of the named quantities",
    reading="f_i, η_i and F are torques",
    note="The index i of F_i is also the one summed over, so F cannot carry it.",
)  # fmt: skip
def _() -> Found:
    said = inconsistent(1, "2")
    return said, bool(said), {}


@_row(
    id="eq2-interval", paper=1, place="Eqs. 2 and 10, domains", severity="misprint",
    printed="x ∈ [x_1, x_2] ∪ [x_3, x_4]",
    how="lengths x_2 − x_1 and x_4 − x_3 on the printed loop (x_1 = x_D, x_2 = x_C, x_3 = x_I, x_4 = x_J), as Eq. 7 orders them",
    reading="[x_2, x_1] and [x_4, x_3]",
)  # fmt: skip
def _() -> Found:
    positive, negative = VERTICES["C"][0] - VERTICES["D"][0], VERTICES["J"][0] - VERTICES["I"][0]
    return (
        f"both intervals are empty: lengths {positive:.4f} and {negative:.4f}",
        positive < 0.0 and negative < 0.0,
        {"length_12": positive, "length_34": negative},
    )


@_row(
    id="fig8-index", paper=1, place="caption of Fig. 8", severity="misprint",
    printed="S_j = Σ_{i=j}^m k_j", how="S_1 from the stiffnesses of Eq. 16 against the crease slope P1P2: Σ k_j and Σ k_i",
    reading="S_j = Σ_{i=j}^m k_i",
    note="The text says the sum of all k_i, which leaves out that slipping elements no longer count. The index may be an "
    "extraction error.",
)  # fmt: skip
def _() -> Found:
    k = stiffnesses(TRANSITION_POS)
    literal, right, crease = k.size * k[0], k.sum(), slopes(TRANSITION_POS)[0]
    return (
        f"Σ k_j = {literal:.4f}, Σ k_i = {right:.4f}, slope of P1P2 {crease:.4f}",
        abs(literal - crease) > 0.01 and abs(right - crease) < 1e-9,
        {"sum_k_j": literal, "sum_k_i": right, "crease": crease},
    )


@_row(
    id="fig9-slip-force", paper=1, place="section 2.2, description of Fig. 9, e to f", severity="misprint",
    printed="sliding starts when the force reaches −f_i",
    how="Eq. 3 run along a-b-c-e-f: the force at which the element slips back",
    reading="−η_i",
    note="f_i is the force itself; the limit is η_i.",
)  # fmt: skip
def _() -> Found:
    k, eta = 2.0, 0.5
    x = np.concatenate([np.linspace(0.0, 1.0, 101), np.linspace(1.0, -1.0, 201)[1:]])
    force, position = np.zeros_like(x), 0.0
    for n, here in enumerate(x):
        force[n] = float(np.clip(k * (here - position), -eta, eta))
        position = here - force[n] / k
    return f"it slips back at {force.min():.2f} = −η_i for η_i = {eta}", force.min() == -eta, {"slip": force.min()}


@_row(
    id="eq4-stiffness", paper=1, place="text before Eq. 4, and Eq. 4", severity="dimension",
    printed="δT = K δθ and T = K h(θ) with one K, the stiffness of the elastomer",
    how="dimensions of K in both, and of the other quantities called K or k: crease slope (Eq. 16), k_1 and k_2 of A.6",
    reading="K of Eq. 4 is k of Eq. 1, N/m; δT = K_e δθ has K_e in N·m/rad",
)  # fmt: skip
def _() -> Found:
    said = inconsistent(1, "4, text before")
    needed = {"T = K h(θ)": STIFFNESS, "δT = K δθ": TORQUE, "K of Eq. 16": SLOPE}
    told = ", ".join(f"{name}: {d}" for name, d in needed.items())
    return told, bool(said) and len(set(needed.values())) > 1, {"dimensions": len(set(needed.values()))}


@_row(
    id="eq4-proportional", paper=1, place="Eq. 4 and section 3 against Table 1", severity="inconsistent",
    printed="T = K h(θ): torque proportional to x",
    how="largest over smallest slope of Table 1; T/x at both ends of the stroke",
    reading="T over x is the polyline of Eqs. 8 and 9; Eq. 4 is not used",
    note="x = h(θ) of Eq. 6 is odd in θ, so Eq. 4 also demands equal torques at x = ±1.",
)  # fmt: skip
def _() -> Found:
    found = np.array([slope(*name) for name in PRINTED_SLOPES])
    ratio = found.max() / found.min()
    ends = [VERTICES[n][1] / VERTICES[n][0] for n in "DJ"]
    return (
        f"slopes differ {ratio:.2f}-fold; T/x is {ends[0]:.2f} at D and {ends[1]:.2f} at J",
        ratio > 1.01,
        {"slope_ratio": ratio, "secant_d": ends[0], "secant_j": ends[1]},
    )


@_row(
    id="eq5-unit-of-x", paper=1, place="Eqs. 5, 6 against Tables 1, 2, 5", severity="dimension",
    printed="x = h(θ), tabulated from −1.0000 to 1.0000 and scored in rad", how="dimensions of Eq. 6",
    reading="x is the measured input, in rad",
    note="Either x was normalised by its largest value or h was not applied; the text says neither.",
)  # fmt: skip
def _() -> Found:
    said = inconsistent(1, "5 and Figs. 20-23")
    return said, bool(said), {"x_max": ASCENDING[:, 0].max(), "x_end": VERTICES["D"][0]}


@_row(
    id="loop-figure", paper=1, place="section 3, trajectory A-B-…-L-A", severity="misprint",
    printed="shown in Fig. 9", how="the figure whose subject has the vertices", reading="Fig. 11",
)  # fmt: skip
def _() -> Found:
    return _cited("trajectory A-B-...-L-A")


def _cited(what: str) -> Found:
    cited, word = printed.CITED[what]
    right = [n for n, subject in printed.FIGURE_SUBJECTS.items() if word in subject]
    return (
        f"Fig. {', '.join(right)}; Fig. {cited} shows: {printed.FIGURE_SUBJECTS[cited]}",
        cited not in right,
        {"cited": float(cited), "right": float(right[0])},
    )


@_row(
    id="eq7-descending", paper=1, place="Eq. 7, second line", severity="misprint",
    printed="f_d for ẋ <= 0, x > x_1", how="share of the descending curve D…I with x > x_1 = x_D and with x > x_3 = x_I",
    reading="f_d for ẋ <= 0, x > x_3; f_a for ẋ >= 0, x_4 < x < x_2",
)  # fmt: skip
def _() -> Found:
    x = np.linspace(VERTICES["I"][0], VERTICES["D"][0], 1001)[1:]
    literal, right = float(np.mean(x > VERTICES["D"][0])), float(np.mean(x > VERTICES["I"][0]))
    return (
        f"x > x_1 holds on {literal:.0%} of the curve, x > x_3 on {right:.0%}",
        literal == 0.0,
        {"share_x1": literal, "share_x3": right},
    )


@_row(
    id="eq7-transition", paper=1, place="Eq. 7, third line", severity="inconsistent",
    printed="f_t for x_2 < x < x_1, whatever the direction; no line for x_4 < x < x_3",
    how="torque at x = x(P3) on the transition (Table 2) and on the falling curve DE (Eq. 9), which covers the same x",
    reading="f_t+ only while x rises, f_t− only while x falls",
)  # fmt: skip
def _() -> Found:
    at = TRANSITION_POS[2, 0]
    rising, falling = TRANSITION_POS[2, 1], float(curve(DESCENDING[::-1], np.array([at]))[0])
    return (
        f"at x = {at:.2f}: {rising:.3f} N·m rising, {falling:.3f} N·m falling by Eq. 9",
        abs(rising - falling) > 0.05,
        {"rising": rising, "falling": falling},
    )


@_row(
    id="elements-symbol", paper=1, place="Eqs. 2, 10, 16, 17", severity="definition",
    printed="m elements in Eq. 2, n in Eq. 10, N in Eqs. 16 and 17, where N = 6 is the number of branches",
    how="elements in Table 3 against N", reading="4 elements a transition; N is the number of branches",
)  # fmt: skip
def _() -> Found:
    count, branches = len(PRINTED_ELEMENTS["k"]), printed.CLAIMS["branches"]
    return f"{count} elements, N = {branches}", count != branches, {"elements": count, "branches": branches}


@_row(
    id="symbols",
    paper=1,
    place="symbols throughout",
    severity="definition",
    printed="; ".join(f"{k} is {' and '.join(v)}" for k, v in printed.SYMBOL_CLASHES.items()),
    how="symbols with two meanings, and quantities with two symbols",
    reading="as each table and equation says",
    note="Upper and lower case may have been changed in extraction.",
)
def _() -> Found:
    clashes = {s: len(set(meanings)) for s, meanings in printed.SYMBOL_CLASHES.items()}
    return (
        f"{len(clashes)} symbols with {sum(clashes.values())} meanings",
        all(n > 1 for n in clashes.values()),
        dict(clashes),
    )


def _turning(sign: float) -> dict[str, float]:
    """Eqs. 13 and 14 on the printed loop: x_1 and x_2 at D and C, x_3 and x_4 at I and J, with ``sign`` before p."""

    def intercept(first: str, second: str) -> float:
        return VERTICES[first][1] - VERTICES[first][0] * slope(first, second)

    def solved(torque: float, k: float, at: float, p: float, own: float) -> float:
        return (torque - k * at + sign * p) / (own - k)

    k_pos, k_neg = slope("C", "D"), slope("I", "J")
    (xc, tc), (xd, td), (xi, ti), (xj, tj) = (VERTICES[n] for n in "CDIJ")
    return {
        "x_1": solved(tc, k_pos, xc, intercept("E", "D"), slope("D", "E")),
        "x_2": solved(td, k_pos, xd, intercept("B", "C"), slope("B", "C")),
        "x_3": solved(tj, k_neg, xj, intercept("I", "H"), slope("H", "I")),
        "x_4": solved(ti, k_neg, xi, intercept("J", "K"), slope("J", "K")),
    }


@_row(
    id="eq13-sign", paper=1, place="Eqs. 13 and 14, sign of p", severity="misprint",
    printed="x_1 = [f_a(x_2) − k x_2 + p(x_1)] / [k(x_1) − k]",
    how="Eq. 11 solved for x_1: f_d(x_1) = k(x_1) x_1 + p(x_1) puts −p(x_1) into the numerator; both evaluated on Table 1",
    reading="minus p",
    note="Eq. 14 has the same sign error; evaluated here with the curves mended as in eq14-curves.",
)  # fmt: skip
def _() -> Found:
    literal, right = _turning(1.0), _turning(-1.0)
    told = ", ".join(f"{name} = {literal[name]:.2f} with +p, {right[name]:.4f} with −p" for name in right)
    truth = dict(zip(("x_1", "x_2", "x_3", "x_4"), (VERTICES[n][0] for n in "DCIJ"), strict=True))
    holds = all(abs(right[n] - truth[n]) < 1e-9 and abs(literal[n] - truth[n]) > 0.1 for n in truth)
    return told, holds, {**{f"{n}_plus": v for n, v in literal.items()}, **{f"{n}_minus": v for n, v in right.items()}}


@_row(
    id="eq14-curves", paper=1, place="Eq. 14, p and k", severity="misprint",
    printed="x_3 from p(x_2), k(x_2) (ascending curve) and x_4 from p(x_1), k(x_1) (descending curve)",
    how="x_3 and x_4 on Table 1 with the printed curves (minus sign) and with each point's own curve",
    reading="x_3 is on the descending curve (HI), x_4 on the ascending curve (JK)",
    note="With the printed curves each line is an identity: it returns the point that it starts from.",
)  # fmt: skip
def _() -> Found:
    k = slope("I", "J")
    (xi, ti), (xj, tj) = VERTICES["I"], VERTICES["J"]

    def solved(torque: float, at: float, first: str, second: str) -> float:
        own = slope(first, second)
        return (torque - k * at - (VERTICES[first][1] - VERTICES[first][0] * own)) / (own - k)

    x3_printed, x4_printed = solved(tj, xj, "J", "K"), solved(ti, xi, "I", "H")
    right = _turning(-1.0)
    return (
        f"x_3 = {x3_printed:.4f} as printed, {right['x_3']:.4f} with HI; x_4 = {x4_printed:.4f} as printed, {right['x_4']:.4f} with JK",
        abs(x3_printed - xi) > 1e-3 and abs(x4_printed - xj) > 1e-3 and abs(right["x_3"] - xi) < 1e-9,
        {"x_3_printed": x3_printed, "x_4_printed": x4_printed, "x_3": right["x_3"], "x_4": right["x_4"]},
    )


@_row(
    id="eq15-symbols", paper=1, place="Eq. 15", severity="definition",
    printed="conditions on x − x_p and x − x_f", how="symbols of Eq. 15 that the text does not explain",
    reading="turning points are found with a dead band, see hystbench.models.motion",
)  # fmt: skip
def _() -> Found:
    unknown = [s for s in printed.EQUATION_15_SYMBOLS if s not in printed.GLOSSARY]
    return f"{' and '.join(unknown)} are not defined", bool(unknown), {"undefined": len(unknown)}


@_row(
    id="transition-slows", paper=1, place="section 3, before Fig. 12", severity="inconsistent",
    printed="at C the ascending curve gradually slows down and starts to transition",
    how="slope before C (Table 1, BC) and after it (Table 2, P1P2)", reading="Tables 1 and 2",
)  # fmt: skip
def _() -> Found:
    before, after = slope("B", "C"), slopes(TRANSITION_POS)[0]
    return (
        f"the slope rises from {before:.2f} to {after:.2f} N·m per unit of x at C",
        after > before,
        {"before": before, "after": after},
    )


@_row(
    id="eq17-distance", paper=1, place="Eq. 17", severity="inconsistent",
    printed="η_i = k_i (x(P_{i+1}) − x(P_i)) e/e_0 for i < N, but η_N = k_N e_0",
    how="Σ η_i, which must be the torque gained over the transition, T_D − T_C and T_I − T_J",
    reading="η_i = k_i (x(P_{i+1}) − x(P_1)) e/e_0 for all i",
    note="The last line is the same formula with P_1, the lines before it are not. e_0 is not defined; it is taken as "
    "|x(P_{N+1}) − x(P_1)|.",
)  # fmt: skip
def _() -> Found:
    told: list[str] = []
    values: dict[str, float] = {}
    for name, transition in (("+", TRANSITION_POS), ("−", TRANSITION_NEG)):
        gained = abs(transition[-1, 1] - transition[0, 1])
        literal, right = printed_limits(transition).sum(), derived_limits(transition).sum()
        told.append(f"transition {name}: {literal:.3f} as printed, {right:.3f} from P_1, gained {gained:.3f} N·m")
        values |= {f"printed{name}": literal, f"derived{name}": right, f"gained{name}": gained}
    holds = all(abs(values[f"printed{s}"] - values[f"gained{s}"]) > 0.1 for s in "+−")
    return "; ".join(told), holds and abs(values["derived+"] - values["gained+"]) < 1e-9, values


# ---- first paper: tables -------------------------------------------------------------------------------------------


@_row(
    id="t1-last-digits", paper=1, place="Table 1, k_DE, k_EF, k_FG", severity="arithmetic",
    printed=", ".join(f"{PRINTED_SLOPES[n]:.4f}" for n in ("DE", "EF", "FG")),
    how="chords of the printed vertices; all slopes recomputed, these differ in the printed digits",
    reading="slopes from the vertices",
    note="Each lies within what the rounding of the printed vertices allows, so unrounded data were used. x_F is printed "
    "with three digits, all other x with four.",
)  # fmt: skip
def _() -> Found:
    off = [row for row in table_1() if row.verdict == "within rounding"]
    bad = [row for row in table_1() if row.verdict == "contradicts"]
    told = ", ".join(f"{row.cell} {row.recomputed:.4f}" for row in off)
    return told, len(off) > 0 and not bad, {row.cell: row.recomputed for row in off}


@_row(
    id="t2-points", paper=1, place="section 4.1 against Table 2", severity="definition",
    printed="deformation for a point number of 4", how="points of each transition in Table 2",
    reading="5 points bound 4 elements",
)  # fmt: skip
def _() -> Found:
    points = TRANSITION_POS.shape[0]
    return f"{points} points, {points - 1} elements", points != printed.CLAIMS["elements"], {"points": points}


@_row(
    id="t2-q4-sign", paper=1, place="Table 2, Q4", severity="misprint", printed=f"{PRINTED_Q4_TORQUE}",
    how="τ(Q5) + k'_4 (x(Q4) − x(Q5)) and τ(Q3) − (k'_3 + k'_4)(x(Q3) − x(Q4)) with Table 3's k'",
    reading="−5.62", note="The sign may have been lost in extraction.",
)  # fmt: skip
def _() -> Found:
    k3, k4 = PRINTED_ELEMENTS["k'"][2:]
    q = TRANSITION_NEG
    from_q5 = q[4, 1] + k4 * (q[3, 0] - q[4, 0])
    from_q3 = q[2, 1] - (k3 + k4) * (q[2, 0] - q[3, 0])
    return (
        f"{from_q5:.3f} from Q5, {from_q3:.3f} from Q3",
        abs(from_q5 - PRINTED_Q4_TORQUE) > 1.0 and abs(from_q5 + PRINTED_Q4_TORQUE) < 0.01,
        {"from_q5": from_q5, "from_q3": from_q3},
    )


@_row(
    id="t3-k-not-differences", paper=1, place="Table 3, k_1 to k_3", severity="arithmetic",
    printed=", ".join(f"{v:g}" for v in PRINTED_ELEMENTS["k"][:3]),
    how="Eq. 16 on Table 2: differences of successive crease slopes",
    reading="Eq. 16; Table 3's k is not used",
    note="The printed figures are the crease slopes themselves. The second transition's k' do follow Eq. 16.",
)  # fmt: skip
def _() -> Found:
    k, crease = stiffnesses(TRANSITION_POS), slopes(TRANSITION_POS)
    given = np.array(PRINTED_ELEMENTS["k"])
    return (
        f"{', '.join(f'{v:.4f}' for v in k[:3])}; crease slopes {', '.join(f'{v:.4f}' for v in crease[:3])}",
        bool(np.all(np.abs(given[:3] - k[:3]) > 1.0) and np.all(np.abs(given - crease) < 1e-3)),
        {f"k_{i + 1}": v for i, v in enumerate(k)} | {f"crease_{i + 1}": v for i, v in enumerate(crease)},
    )


@_row(
    id="t3-eta-3-4", paper=1, place="Table 3, η_3 and η_4", severity="arithmetic",
    printed=", ".join(f"{v:g}" for v in PRINTED_ELEMENTS["eta"][2:]),
    how="Eq. 17 on Table 2, as printed and as derived, with k of Eq. 16", reading="as derived",
    note="Neither form, nor either with the printed k, gives the printed figures; where they come from was not found.",
)  # fmt: skip
def _() -> Found:
    literal, right = printed_limits(TRANSITION_POS), derived_limits(TRANSITION_POS)
    lengths = np.abs(np.diff(TRANSITION_POS[:, 0]))
    distance = np.abs(TRANSITION_POS[1:, 0] - TRANSITION_POS[0, 0])
    given, k = np.array(PRINTED_ELEMENTS["eta"]), np.array(PRINTED_ELEMENTS["k"])
    tried = np.array([literal, right, k * lengths, k * distance])[:, 2:]
    return (
        f"η_3 = {literal[2]:.3f} as printed, {right[2]:.3f} as derived; η_4 = {literal[3]:.3f} either way",
        bool(np.all(np.abs(tried - given[2:]) > 0.003)),
        {"eta_3_printed": literal[2], "eta_3_derived": right[2], "eta_4": right[3]},
    )


@_row(
    id="t3-eta-prime", paper=1, place="Table 3, η'_2 and η'_3", severity="inconsistent",
    printed=", ".join(f"{v:g}" for v in PRINTED_ELEMENTS["eta'"][1:3]),
    how="Eq. 17 on Table 2, as printed and as derived", reading="as derived",
    note="These follow the derived form; η_2 = 0.09 of the other transition follows the printed one: the table mixes both.",
)  # fmt: skip
def _() -> Found:
    literal, right = printed_limits(TRANSITION_NEG), derived_limits(TRANSITION_NEG)
    given = np.array(PRINTED_ELEMENTS["eta'"])
    return (
        f"{literal[1]:.3f}, {literal[2]:.3f} as printed; {right[1]:.3f}, {right[2]:.3f} as derived",
        bool(np.all(np.abs(given[1:3] - literal[1:3]) > 0.1) and np.all(np.abs(given - right) < 0.006)),
        {"eta_2_printed": literal[1], "eta_3_printed": literal[2], "eta_2": right[1], "eta_3": right[2]},
    )


@_row(
    id="t3-end-torque", paper=1, place="Table 3 against T_D", severity="arithmetic",
    printed="5.02 N·m at D", how="Eqs. 2 and 3 with Table 3's k and η from C to D", reading="Table 2",
    note="The second transition's k' and η' do reach T_J.",
)  # fmt: skip
def _() -> Found:
    values = {}
    for label, marks, transition in (("D", ("k", "eta"), TRANSITION_POS), ("J", ("k'", "eta'"), TRANSITION_NEG)):
        distance = np.array([abs(transition[-1, 0] - transition[0, 0])])
        gained = float(element_sum(distance, *(np.array(PRINTED_ELEMENTS[m]) for m in marks))[0])
        values[label] = transition[0, 1] + np.sign(transition[0, 1]) * gained
    return (
        f"{values['D']:.3f} N·m at D ({values['J']:.3f} at J, printed {VERTICES['J'][1]})",
        abs(values["D"] - VERTICES["D"][1]) > 0.1 and abs(values["J"] - VERTICES["J"][1]) < 0.01,
        values,
    )


@_row(
    id="t3-never-slips", paper=1, place="Table 3, element 4", severity="inconsistent",
    printed="k_4 = 1.8, η_4 = 0.638", how="distance η_4/k_4 at which it slips, against the transition's length",
    reading="η_4 = k_4 e_0, so that the last element slips at D (Eq. 17)",
)  # fmt: skip
def _() -> Found:
    distance = PRINTED_ELEMENTS["eta"][3] / PRINTED_ELEMENTS["k"][3]
    length = TRANSITION_POS[-1, 0] - TRANSITION_POS[0, 0]
    return (
        f"slips after {distance:.3f}, the transition is {length:.3f} long",
        distance > length,
        {"slips_after": distance, "length": length},
    )


@_row(
    id="choi-14", paper=1, place="Table 1 against the second paper's Eq. 14", severity="inconsistent",
    printed="f_a above f_d (the condition of the model that it builds on)",
    how="f_a − f_d on Table 1; where it is negative and the work of that lobe",
    reading="the loop as printed; the model approaches the crossed curve from beyond",
    note="Eq. 14 is known from the second paper's appendix only. At A = G the curves touch as well, so the loop has no "
    "width there.",
)  # fmt: skip
def _() -> Found:
    ends, deepest = crossing()
    x = np.linspace(ends[0], ends[1], 2001)
    lobe = float(np.trapezoid(gap_between_curves(x), x))
    at_origin = float(gap_between_curves(np.array([0.0]))[0])
    return (
        f"negative from x = {ends[0]:.4f} to {ends[1]:.4f}, {deepest[1]:.4f} N·m at H; work {lobe * 1e3:.3f} mJ; {at_origin:g} at A = G",
        deepest[1] < 0.0,
        {"from": ends[0], "to": ends[1], "deepest": deepest[1], "work": lobe, "at_origin": at_origin},
    )


def _mean_slope(number: int, name: str) -> Found:
    condition = next(c for c in passivity.choi_conditions_of_published_loop() if c.name.startswith(f"Eq. {number}:"))
    sign = 1.0 if number == 19 else -1.0
    steepest = passivity.steepest_segment(sign)
    mean = slope(*name)
    return condition.detail, not condition.holds and mean < steepest, {"transition": mean, "steepest": steepest}


@_row(
    id="choi-19", paper=1, place="K+ of Table 1 against the second paper's Eq. 19", severity="inconsistent",
    printed="K+ = 8.4667, k_DE = 9.1929", how="K+ against the steepest segment at x > 0",
    reading="where the curve ahead is steeper than the chord, the gap closes at a twentieth of the chord's slope",
    note="Falling from a turn beyond E, a chord of slope K+ moves away from DE instead of meeting it.",
)  # fmt: skip
def _() -> Found:
    return _mean_slope(19, "CD")


@_row(
    id="choi-20", paper=1, place="K− of Table 1 against the second paper's Eq. 20", severity="inconsistent",
    printed="K− = 8.8533, k_JK = 9.5385", how="K− against the steepest segment at x < 0", reading="as for choi-19",
)  # fmt: skip
def _() -> Found:
    return _mean_slope(20, "IJ")


# ---- first paper: claims and scores --------------------------------------------------------------------------------


@_row(
    id="motor-gear", paper=1, place="section 4.1, motor", severity="inconsistent",
    printed="MG6012E-i8v2 with a reduction ratio of 1:6", how="digit in the type name after 'i', and the maker's MG6012 ratio",
    reading="not used", note="External source: a vendor's table of the MG motors lists 8:1 for the MG6012 and 6:1 for the MG8016.",
)  # fmt: skip
def _() -> Found:
    named = int(str(printed.CLAIMS["motor"]).split("-i")[1].split("v")[0])
    told = int(str(printed.CLAIMS["gear"]).split(":")[1])
    return (
        f"1:{named} by its name, 1:{printed.MOTOR_GEAR} by the vendor",
        told != named == printed.MOTOR_GEAR,
        {"printed": told, "named": named},
    )


@_row(
    id="error-bound", paper=1, place="abstract, section 4.1, Fig. 16", severity="inconsistent",
    printed="torque error within 0.2 N·m, less than 0.3 N·m, at most 0.2 N·m", how="the three bounds stated for one model and test",
    reading="0.2 N·m", note="Compatible as inequalities; no text says which test the weaker one belongs to.",
)  # fmt: skip
def _() -> Found:
    bounds = [float(printed.CLAIMS[f"torque_error_{w}"]) for w in ("abstract", "section_4", "figure_16")]
    return (
        f"{min(bounds)} to {max(bounds)} N·m",
        min(bounds) < max(bounds),
        {"least": min(bounds), "greatest": max(bounds)},
    )


@_row(
    id="fig16-two-models", paper=1, place="section 4.1 on Fig. 16", severity="definition",
    printed="torque errors for the two models", how="models that have an error: measured and simulated torque give one error curve",
    reading="one curve, simulated minus measured",
)  # fmt: skip
def _() -> Found:
    compared = ("measured", "simulated")
    return (
        f"{len(compared) - 1} error curve",
        printed.CLAIMS["figures_16_models"] != len(compared) - 1,
        {"curves": len(compared) - 1},
    )


@_row(
    id="mean-torque", paper=1, place="section 4.1, average torque", severity="definition",
    printed="average torque 1.7 N·m simulated, 1.8 N·m measured", how="mean and mean modulus of the published loop over one cycle at constant speed",
    reading="the mean modulus",
    note="The text does not say that a modulus or a half cycle is meant.",
)  # fmt: skip
def _() -> Found:
    x = np.linspace(-1.0, 1.0, 20001)
    torque = np.concatenate([curve(READINGS[0].upper, x), curve(READINGS[0].lower, x)])
    mean, modulus = float(torque.mean()), float(np.abs(torque).mean())
    return (
        f"mean {mean:.2f} N·m, mean modulus {modulus:.2f} N·m",
        abs(mean - 1.8) > 1.0,
        {"mean": mean, "mean_modulus": modulus},
    )


@_row(
    id="mean-torque-mae", paper=1, place="section 4.1, 6 %, against Table 4", severity="inconsistent",
    printed="averages that differ by about 6 %, MAE 0.063 N·m", how="the difference of two means (or mean moduli) never exceeds the mean absolute error",
    reading="neither is used",
    note="5.5 to 6.5 % of 1.75 to 1.85 N·m is meant by 'about 6 %'. Fig. 17 and Table 4 may rest on different recordings; the text does not say so.",
)  # fmt: skip
def _() -> Found:
    c = printed.CLAIMS
    measured, simulated = float(c["mean_torque_measured"]), float(c["mean_torque_simulated"])
    share = (measured - simulated) / measured
    least = (float(c["mean_torque_error"]) - 0.005) * (measured - half_step(1))
    mae = TABLE_4["maxwell-slip"]["mae"]
    return (
        f"{share:.1%} from the printed averages; a difference of at least {least:.3f} N·m > MAE {mae} N·m",
        least > mae + half_step(3),
        {"share": share, "least_difference": least, "mae": mae},
    )


@_row(
    id="t4-caption", paper=1, place="caption of Table 4", severity="misprint", printed="comparison of two models",
    how="rows of the table", reading="three models",
)  # fmt: skip
def _() -> Found:
    return f"{len(TABLE_4)} models", len(TABLE_4) != printed.CLAIMS["models_in_captions"], {"models": len(TABLE_4)}


@_row(
    id="t4-mre-unit", paper=1, place="Table 4, MRE", severity="dimension", printed="MRE (N·m)",
    how="dimension of an average relative error; the largest deviations named for Fig. 19 as another reading",
    reading="mean of |error|/|torque| where |torque| is at least 5 % of its maximum, without unit",
    note="It is not the largest deviation either, which does have that unit: cubic 0.5 N·m against 0.271.",
)  # fmt: skip
def _() -> Found:
    said = inconsistent(1, "Table 4, MRE")
    return (
        said,
        bool(said) and any(v["mre"] > v["mae"] for v in TABLE_4.values()),
        {"cubic_mre": TABLE_4["cubic"]["mre"]},
    )


@_row(
    id="t4-mrse", paper=1, place="section 4.2", severity="misprint", printed="MRSE", how="the metric with the same letters",
    reading="RMSE",
)  # fmt: skip
def _() -> Found:
    printed_name = printed.CLAIMS["misspelt_metric"]
    same = [m.title for m in METRICS if sorted(m.title) == sorted(str(printed_name))]
    return ", ".join(same), same == ["RMSE"], {"letters_shared": len(same[0])}


@_row(
    id="t5-caption", paper=1, place="caption of Table 5", severity="misprint", printed="comparison error of torque of two models",
    how="rows of the table and their unit", reading="deflection errors of three inverse models, rad",
)  # fmt: skip
def _() -> Found:
    return (
        f"{len(TABLE_5)} models, in rad",
        len(TABLE_5) != printed.CLAIMS["models_in_captions"],
        {"models": len(TABLE_5)},
    )


@_row(
    id="t5-mre-unit", paper=1, place="Table 5, MRE", severity="dimension", printed="MRE (rad)", how="an error in rad divided by a deflection in rad",
    reading="as in Table 4, without unit",
)  # fmt: skip
def _() -> Found:
    ratio = {m: v["mre"] / v["mae"] for m, v in TABLE_5.items()}
    told = ", ".join(f"{m} {r:.1f}" for m, r in ratio.items())
    return (
        f"a ratio has no unit; MRE over MAE is {told}, 1 if both were mean errors in rad",
        min(ratio.values()) > 1.5,
        ratio,
    )


@_row(
    id="t5-rmse-reduction", paper=1, place="section 5, reductions", severity="arithmetic", printed="RMSE reduced by 7 %",
    how="1 − 0.051/0.056 from Table 5, proposed against cubic; MRE and MAE likewise",
    reading="8.9 %",
    note="The rounding of Table 5 allows 7.2 to 10.6 %, so 7 % is the very edge. 16 % and 21 % do follow. Against the "
    "Bouc-Wen model, which the sentence names too, the reductions are far larger.",
)  # fmt: skip
def _() -> Found:
    def reduction(metric: str, other: str = "cubic") -> float:
        return 1.0 - TABLE_5["maxwell-slip"][metric] / TABLE_5[other][metric]

    found = {m: reduction(m) for m in ("rmse", "mre", "mae")}
    half = half_step(printed.TABLE_DECIMALS[5])
    low, high = interval(
        lambda a, b: 1.0 - a / b, [TABLE_5["maxwell-slip"]["rmse"], TABLE_5["cubic"]["rmse"]], [half, half]
    )
    claimed = printed.CLAIMS["reduction"]
    differs = abs(found["rmse"] - claimed["rmse"]) > 0.005
    follows = all(abs(found[m] - claimed[m]) < 0.005 for m in ("mre", "mae"))
    return (
        f"RMSE {found['rmse']:.1%} ({low:.1%} to {high:.1%}), MRE {found['mre']:.1%}, MAE {found['mae']:.1%}; against "
        f"Bouc-Wen {reduction('rmse', 'bouc-wen'):.0%}, {reduction('mre', 'bouc-wen'):.0%}, {reduction('mae', 'bouc-wen'):.0%}",
        differs and follows,
        {**found, "rmse_low": low, "rmse_high": high},
    )


@_row(
    id="abstract-deflection", paper=1, place="abstract, last sentence", severity="inconsistent", printed="the deformation deflection is less than 0.15 rad",
    how="range of the tabulated deflection; section 5 states 0.15 rad as the largest error", reading="the deflection error is less than 0.15 rad",
)  # fmt: skip
def _() -> Found:
    span = max(abs(x) for x, _ in VERTICES.values())
    return f"deflections reach {span:g}", span > printed.CLAIMS["deflection_error"], {"largest": span}


# ---- first paper: appendix -----------------------------------------------------------------------------------------


@_row(
    id="appendix-figure", paper=1, place="appendix, first sentence", severity="misprint", printed="individual branches in Fig. 3(b)",
    how="the figure whose subject is a single branch", reading="Fig. 5(b)",
)  # fmt: skip
def _() -> Found:
    return _cited("individual compliant branches")


@_row(
    id="appendix-equations", paper=1, place="appendix, references to Eqs. (6) to (9)", severity="misprint",
    printed="Eq. (6), Eq. (7), Eq. (8), Eq. (9)", how="what the main text's equations of these numbers are", reading="A.6 to A.9",
)  # fmt: skip
def _() -> Found:
    clash = [n for n, what in printed.APPENDIX_CITED.items() if printed.MAIN_EQUATIONS.get(n) != what]
    told = ", ".join(f"({n}) is the {printed.MAIN_EQUATIONS[n]}, not the {printed.APPENDIX_CITED[n]}" for n in clash)
    return told, len(clash) == 4, {"wrong": len(clash)}


@_row(
    id="a2-virtual-work", paper=1, place="A.2 with δl_e = 2 (l1 + l2 − l3) and A.10", severity="inconsistent",
    printed="T_e = F_e J_e with F_e = k δl_e + F_0",
    how="derivative of the belt's energy k δl_e²/2 + F_0 δl_e, by finite differences, over F_e J_e at 0.5 rad",
    reading="A.4 as printed; k and F_0 then belong to both strands together",
    note="The principle of virtual work, which the appendix invokes, gives F_e ∂δl_e/∂θ = 2 F_e J_e for a tension F_e.",
)  # fmt: skip
def _() -> Found:
    b, at, step = appendix_a.ASSUMED, 0.5, 1e-6

    def energy(theta: float) -> float:
        stretch = float(appendix_a.elongation(np.array(theta), b))
        return b.count * (0.5 * b.k * stretch**2 + b.preload * stretch)

    torque = (energy(at + step) - energy(at - step)) / (2.0 * step)
    ratio = torque / float(appendix_a.torque_a9(np.array(at), b))
    return f"{ratio:.4f} times F_e J_e", abs(ratio - 1.0) > 0.5, {"ratio": ratio}


@_row(
    id="a3-modulus", paper=1, place="A.3", severity="misprint", printed="J_e = |…| = ∂l2/∂θ = l1 l3 sin θ / l2, called a displacement",
    how="∂l2/∂θ at −0.5 rad by finite differences", reading="signed; a lever arm",
    note="A modulus is never negative; the two other terms are for θ < 0.",
)  # fmt: skip
def _() -> Found:
    b, at, step = appendix_a.ASSUMED, -0.5, 1e-6
    rate = float(appendix_a.belt(np.array(at + step), b) - appendix_a.belt(np.array(at - step), b)) / (2.0 * step)
    same = abs(rate - float(appendix_a.lever(np.array(at), b))) < 1e-9
    return f"{rate * 1e3:.2f} mm at −0.5 rad (assumed lengths)", rate < 0.0 and same, {"rate_m": rate}


@_row(
    id="a6-derivative", paper=1, place="A.6 and A.8", severity="misprint", printed="J_e/θ",
    how="J_e/θ and ∂J_e/∂θ at 1 rad against c2 of A.7", reading="∂J_e/∂θ",
    note="Probably a partial derivative whose ∂ was lost in extraction: A.7's c2 is ∂J_e/∂θ exactly.",
)  # fmt: skip
def _() -> Found:
    b, at = appendix_a.ASSUMED, np.array([1.0])
    step = 1e-6
    rate = float((appendix_a.lever(at + step, b) - appendix_a.lever(at - step, b))[0]) / (2.0 * step)
    literal, c2 = float(appendix_a.lever(at, b)[0]), float(appendix_a.c2_printed(at, b)[0])
    return (
        f"J_e/θ {literal * 1e3:.2f} mm, ∂J_e/∂θ {rate * 1e3:.2f} mm, c2 {c2 * 1e3:.2f} mm (assumed lengths)",
        abs(rate - c2) < 1e-8 and abs(literal - c2) > 1e-4,
        {"literal": literal, "derivative": rate, "c2": c2},
    )


@_row(
    id="a6-factor", paper=1, place="A.6 and A.8, first term", severity="inconsistent", printed="J_e² k",
    how="derivative of A.4's torque: ∂δl_e/∂θ = 2 J_e gives 2 J_e² k; both against finite differences for N = 2, 4, 6 and 0, 5, 10 N",
    reading="2 J_e² k",
)  # fmt: skip
def _() -> Found:
    checks = appendix_a.stiffness_checks()
    worst = {
        name: max(c.worst for c in checks if c.expression == name)
        for name in ("A.8 with ∂J_e/∂θ", "derivative of A.9 (2 J_e²)")
    }
    literal, right = worst.values()
    return (
        f"off by {literal:.0%} of the largest stiffness with J_e², by {right:.0e} with 2 J_e² (assumed lengths)",
        literal > 0.01 and right < 1e-6,
        {"with_j2": literal, "with_2_j2": right},
    )


@_row(
    id="a7-c1-denominator", paper=1, place="A.7, c1", severity="dimension", printed="l1² l3² sin²θ / l2 + 2 c2 (l1 + l2 − l3)",
    how="dimensions; J_e² by A.3", reading="l1² l3² sin²θ / l2², twice (see a6-factor)",
    note="The exponent of l2 may have been lost in extraction.",
)  # fmt: skip
def _() -> Found:
    b, at = appendix_a.ASSUMED, np.array([1.0])
    said = inconsistent(1, "A.7, c1")
    share = float((appendix_a.c1_printed(at, b) / appendix_a.c1_derived(at, b))[0])
    return f"{said}; in SI numbers c1 is {share:.2f} of the derived one at 1 rad", bool(said), {"share": share}


@_row(
    id="a8-foe", paper=1, place="A.8 and A.9", severity="definition", printed="F_oe", how="A.9 at N = 1 against A.4 with F_0 = k x0: the force that makes them equal",
    reading="F_0", note="Never defined; A.10 and A.11 call it F_0.",
)  # fmt: skip
def _() -> Found:
    from dataclasses import replace

    b, at = replace(appendix_a.ASSUMED, count=1), np.array([0.7])
    arm = appendix_a.lever(at, b)
    a4 = b.k * (appendix_a.elongation(at, b) + b.x0) * arm
    force = float(((a4 - b.k * appendix_a.elongation(at, b) * arm) / arm)[0])
    return f"F_oe = {force:.3f} N = F_0", abs(force - b.preload) < 1e-9, {"force": force}


# ---- second paper --------------------------------------------------------------------------------------------------


@_row(
    id="choi-range-unit", paper=2, place="appendix 1, identification range", severity="dimension", printed="deformation range about 16 Nm, permissible torque range about 14 Nm",
    how="dimensions; ratio of both", reading="a torque range",
)  # fmt: skip
def _() -> Found:
    said = inconsistent(2, "appendix 1, range")
    ratio = printed.SPRING_RANGE["identified"] / printed.SPRING_RANGE["permissible"]
    return f"{said}; {ratio - 1.0:.0%} beyond the permissible range", bool(said), {"ratio": ratio}


@_row(
    id="choi-signed-objective", paper=2, place="Eqs. 42 and 43", severity="inconsistent", printed="argmin over s of Σ τ_err (signed)",
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


@_row(
    id="choi-bound-name", paper=2, place="Eq. 43 and the text after it", severity="misprint", printed="s_{-,max} in Eq. 43, s_{,min} in the text",
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


@_row(
    id="choi-path-name", paper=2, place="Eq. 44", severity="misprint", printed="∮ over OABO for the path OBAO",
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


@_row(
    id="choi-element-sign", paper=2, place="Eqs. 44-46, 49, 50", severity="misprint", printed="θ ∋ [θ_min, θ_max]",
    how="which of the two is a set: the interval has a least and a greatest element, θ is a number", reading="θ ∈ [θ_min, θ_max]",
)  # fmt: skip
def _() -> Found:
    low, high = passivity.STROKE
    theta = passivity.loop_types(passivity.example_choi())[0].high
    return f"{low} <= {theta} <= {high}: the interval contains θ", low <= theta <= high, {"theta": theta}


@_row(
    id="choi-proof-scope", paper=2, place="appendix 2, opening", severity="inconsistent", printed="all contour integrals are non-negative; cases in positive deformation are covered",
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
