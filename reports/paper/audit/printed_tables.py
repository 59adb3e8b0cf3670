"""Contradictions in the first paper's tables."""

from __future__ import annotations

import numpy as np

from ....datasets.published_loop import (
    PRINTED_ELEMENTS,
    PRINTED_Q4_TORQUE,
    PRINTED_SLOPES,
    TRANSITION_NEG,
    TRANSITION_POS,
    VERTICES,
)
from .. import passivity, printed
from ..loop import (
    crossing,
    derived_limits,
    element_sum,
    gap_between_curves,
    printed_limits,
    slope,
    slopes,
    stiffnesses,
)
from ..tables import table_1
from .rows import Checks, Found

__all__ = ["CHECKS"]

CHECKS = Checks(paper=1)


@CHECKS.row(
    id="t1-last-digits", place="Table 1, k_DE, k_EF, k_FG", severity="arithmetic",
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


@CHECKS.row(
    id="t2-points", place="section 4.1 against Table 2", severity="definition",
    printed="deformation for a point number of 4", how="points of each transition in Table 2",
    reading="5 points bound 4 elements",
)  # fmt: skip
def _() -> Found:
    points = TRANSITION_POS.shape[0]
    return f"{points} points, {points - 1} elements", points != printed.CLAIMS["elements"], {"points": points}


@CHECKS.row(
    id="t2-q4-sign", place="Table 2, Q4", severity="misprint", printed=f"{PRINTED_Q4_TORQUE}",
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


@CHECKS.row(
    id="t3-k-not-differences", place="Table 3, k_1 to k_3", severity="arithmetic",
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


@CHECKS.row(
    id="t3-eta-3-4", place="Table 3, η_3 and η_4", severity="arithmetic",
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


@CHECKS.row(
    id="t3-eta-prime", place="Table 3, η'_2 and η'_3", severity="inconsistent",
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


@CHECKS.row(
    id="t3-end-torque", place="Table 3 against T_D", severity="arithmetic",
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


@CHECKS.row(
    id="t3-never-slips", place="Table 3, element 4", severity="inconsistent",
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


@CHECKS.row(
    id="choi-14", place="Table 1 against the second paper's Eq. 14", severity="inconsistent",
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


@CHECKS.row(
    id="choi-19", place="K+ of Table 1 against the second paper's Eq. 19", severity="inconsistent",
    printed="K+ = 8.4667, k_DE = 9.1929", how="K+ against the steepest segment at x > 0",
    reading="where the curve ahead is steeper than the chord, the gap closes at a twentieth of the chord's slope",
    note="Falling from a turn beyond E, a chord of slope K+ moves away from DE instead of meeting it.",
)  # fmt: skip
def _() -> Found:
    return _mean_slope(19, "CD")


@CHECKS.row(
    id="choi-20", place="K− of Table 1 against the second paper's Eq. 20", severity="inconsistent",
    printed="K− = 8.8533, k_JK = 9.5385", how="K− against the steepest segment at x < 0", reading="as for choi-19",
)  # fmt: skip
def _() -> Found:
    return _mean_slope(20, "IJ")
