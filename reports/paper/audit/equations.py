"""Contradictions in the first paper's text and equations."""

from __future__ import annotations

import numpy as np

from ....datasets.published_loop import (
    ASCENDING,
    DESCENDING,
    PRINTED_ELEMENTS,
    PRINTED_SLOPES,
    TRANSITION_NEG,
    TRANSITION_POS,
    VERTICES,
)
from .. import appendix_a, printed
from ..dimensions import SLOPE, STIFFNESS, TORQUE, inconsistent
from ..loop import (
    curve,
    derived_limits,
    printed_limits,
    slope,
    slopes,
    stiffnesses,
)
from .rows import Checks, Found

__all__ = ["CHECKS", "cited"]

CHECKS = Checks(paper=1)


@CHECKS.row(
    id="intro-model-list", place="section 1, list of common models", severity="misprint",
    printed=", ".join(printed.INTRODUCED_MODELS), how="names in the list that occur twice",
    reading="each model once",
)  # fmt: skip
def _() -> Found:
    names = printed.INTRODUCED_MODELS
    twice = sorted({n for n in names if names.count(n) > 1})
    return f"{', '.join(twice)} is listed twice", bool(twice), {"listed": len(names), "distinct": len(set(names))}


@CHECKS.row(
    id="intro-start-operator", place="section 1, PI model", severity="definition",
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


@CHECKS.row(
    id="intro-choi-degree", place="section 1, on Choi's model", severity="inconsistent",
    printed="able to express only up to a third-degree polynomial", how="degree that the second paper's appendix 1 uses",
    reading="any degree; choi-backlash defaults to 5",
)  # fmt: skip
def _() -> Found:
    claimed, used = printed.CLAIMS["choi_degree"], printed.SECOND_PAPER_DEGREE
    return f"degree {used}", used > claimed, {"claimed": claimed, "used": used}


@CHECKS.row(
    id="eq1-x0", place="Eqs. 1, 6 and A.12", severity="inconsistent",
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


@CHECKS.row(
    id="eq1-f0", place="text after Eq. 1", severity="definition",
    printed="explains k and F_0", how="symbols explained that Eq. 1 does not contain",
    reading="F_0 = k x0 (A.11)",
)  # fmt: skip
def _() -> Found:
    absent = [s for s in printed.EXPLAINED_AFTER_EQUATION_1 if s not in printed.EQUATION_1_SYMBOLS]
    return f"{', '.join(absent)} is not in Eq. 1, which has x0", bool(absent), {"absent": len(absent)}


@CHECKS.row(
    id="belt-stretch-unit", place="section 2.1, belt", severity="dimension",
    printed="maximum stretch of 0.7 kg", how="dimensions", reading="a pull of 0.7 kgf = 6.9 N",
)  # fmt: skip
def _() -> Found:
    pull = printed.CLAIMS["belt_stretch_kg"] * printed.STANDARD_GRAVITY
    return f"{inconsistent(1, 'section 2.1, belt')}; as a weight {pull:.2f} N", True, {"pull_n": pull}


@CHECKS.row(
    id="belt-pull-lever", place="section 2.1, belt, against Table 1", severity="inconsistent",
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


@CHECKS.row(
    id="eq2-force-torque", place="Eq. 2", severity="dimension",
    printed="hysteresis force F_i = Σ f_i + T_0, forces f_i plus an initial torque", how="dimensions of the named quantities",
    reading="f_i, η_i and F are torques",
    note="The index i of F_i is also the one summed over, so F cannot carry it.",
)  # fmt: skip
def _() -> Found:
    said = inconsistent(1, "2")
    return said, bool(said), {}


@CHECKS.row(
    id="eq2-interval", place="Eqs. 2 and 10, domains", severity="misprint",
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


@CHECKS.row(
    id="fig8-index", place="caption of Fig. 8", severity="misprint",
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


@CHECKS.row(
    id="fig9-slip-force", place="section 2.2, description of Fig. 9, e to f", severity="misprint",
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


@CHECKS.row(
    id="eq4-stiffness", place="text before Eq. 4, and Eq. 4", severity="dimension",
    printed="δT = K δθ and T = K h(θ) with one K, the stiffness of the elastomer",
    how="dimensions of K in both, and of the other quantities called K or k: crease slope (Eq. 16), k_1 and k_2 of A.6",
    reading="K of Eq. 4 is k of Eq. 1, N/m; δT = K_e δθ has K_e in N·m/rad",
)  # fmt: skip
def _() -> Found:
    said = inconsistent(1, "4, text before")
    needed = {"T = K h(θ)": STIFFNESS, "δT = K δθ": TORQUE, "K of Eq. 16": SLOPE}
    told = ", ".join(f"{name}: {d}" for name, d in needed.items())
    return told, bool(said) and len(set(needed.values())) > 1, {"dimensions": len(set(needed.values()))}


@CHECKS.row(
    id="eq4-proportional", place="Eq. 4 and section 3 against Table 1", severity="inconsistent",
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


@CHECKS.row(
    id="eq5-unit-of-x", place="Eqs. 5, 6 against Tables 1, 2, 5", severity="dimension",
    printed="x = h(θ), tabulated from −1.0000 to 1.0000 and scored in rad", how="dimensions of Eq. 6",
    reading="x is the measured input, in rad",
    note="Either x was normalised by its largest value or h was not applied; the text says neither.",
)  # fmt: skip
def _() -> Found:
    said = inconsistent(1, "5 and Figs. 20-23")
    return said, bool(said), {"x_max": ASCENDING[:, 0].max(), "x_end": VERTICES["D"][0]}


@CHECKS.row(
    id="loop-figure", place="section 3, trajectory A-B-…-L-A", severity="misprint",
    printed="shown in Fig. 9", how="the figure whose subject has the vertices", reading="Fig. 11",
)  # fmt: skip
def _() -> Found:
    return cited("trajectory A-B-...-L-A")


def cited(what: str) -> Found:
    """A figure that the text names beside what it says of it, against the figure that shows that."""
    cited, word = printed.CITED[what]
    right = [n for n, subject in printed.FIGURE_SUBJECTS.items() if word in subject]
    return (
        f"Fig. {', '.join(right)}; Fig. {cited} shows: {printed.FIGURE_SUBJECTS[cited]}",
        cited not in right,
        {"cited": float(cited), "right": float(right[0])},
    )


@CHECKS.row(
    id="eq7-descending", place="Eq. 7, second line", severity="misprint",
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


@CHECKS.row(
    id="eq7-transition", place="Eq. 7, third line", severity="inconsistent",
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


@CHECKS.row(
    id="elements-symbol", place="Eqs. 2, 10, 16, 17", severity="definition",
    printed="m elements in Eq. 2, n in Eq. 10, N in Eqs. 16 and 17, where N = 6 is the number of branches",
    how="elements in Table 3 against N", reading="4 elements a transition; N is the number of branches",
)  # fmt: skip
def _() -> Found:
    count, branches = len(PRINTED_ELEMENTS["k"]), printed.CLAIMS["branches"]
    return f"{count} elements, N = {branches}", count != branches, {"elements": count, "branches": branches}


@CHECKS.row(
    id="symbols",
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


@CHECKS.row(
    id="eq13-sign", place="Eqs. 13 and 14, sign of p", severity="misprint",
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


@CHECKS.row(
    id="eq14-curves", place="Eq. 14, p and k", severity="misprint",
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


@CHECKS.row(
    id="eq15-symbols", place="Eq. 15", severity="definition",
    printed="conditions on x − x_p and x − x_f", how="symbols of Eq. 15 that the text does not explain",
    reading="turning points are found with a dead band, see hystbench.models.motion",
)  # fmt: skip
def _() -> Found:
    unknown = [s for s in printed.EQUATION_15_SYMBOLS if s not in printed.GLOSSARY]
    return f"{' and '.join(unknown)} are not defined", bool(unknown), {"undefined": len(unknown)}


@CHECKS.row(
    id="transition-slows", place="section 3, before Fig. 12", severity="inconsistent",
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


@CHECKS.row(
    id="eq17-distance", place="Eq. 17", severity="inconsistent",
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
