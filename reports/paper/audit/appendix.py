"""Contradictions in the first paper's appendix."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .. import appendix_a, printed
from ..dimensions import inconsistent
from .equations import cited
from .rows import Checks, Found

__all__ = ["CHECKS"]

CHECKS = Checks(paper=1)


@CHECKS.row(
    id="appendix-figure", place="appendix, first sentence", severity="misprint", printed="individual branches in Fig. 3(b)",
    how="the figure whose subject is a single branch", reading="Fig. 5(b)",
)  # fmt: skip
def _() -> Found:
    return cited("individual compliant branches")


@CHECKS.row(
    id="appendix-equations", place="appendix, references to Eqs. (6) to (9)", severity="misprint",
    printed="Eq. (6), Eq. (7), Eq. (8), Eq. (9)", how="what the main text's equations of these numbers are", reading="A.6 to A.9",
)  # fmt: skip
def _() -> Found:
    clash = [n for n, what in printed.APPENDIX_CITED.items() if printed.MAIN_EQUATIONS.get(n) != what]
    told = ", ".join(f"({n}) is the {printed.MAIN_EQUATIONS[n]}, not the {printed.APPENDIX_CITED[n]}" for n in clash)
    return told, len(clash) == 4, {"wrong": len(clash)}


@CHECKS.row(
    id="a2-virtual-work", place="A.2 with δl_e = 2 (l1 + l2 − l3) and A.10", severity="inconsistent",
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


@CHECKS.row(
    id="a3-modulus", place="A.3", severity="misprint", printed="J_e = |…| = ∂l2/∂θ = l1 l3 sin θ / l2, called a displacement",
    how="∂l2/∂θ at −0.5 rad by finite differences", reading="signed; a lever arm",
    note="A modulus is never negative; the two other terms are for θ < 0.",
)  # fmt: skip
def _() -> Found:
    b, at, step = appendix_a.ASSUMED, -0.5, 1e-6
    rate = float(appendix_a.belt(np.array(at + step), b) - appendix_a.belt(np.array(at - step), b)) / (2.0 * step)
    same = abs(rate - float(appendix_a.lever(np.array(at), b))) < 1e-9
    return f"{rate * 1e3:.2f} mm at −0.5 rad (assumed lengths)", rate < 0.0 and same, {"rate_m": rate}


@CHECKS.row(
    id="a6-derivative", place="A.6 and A.8", severity="misprint", printed="J_e/θ",
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


@CHECKS.row(
    id="a6-factor", place="A.6 and A.8, first term", severity="inconsistent", printed="J_e² k",
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


@CHECKS.row(
    id="a7-c1-denominator", place="A.7, c1", severity="dimension", printed="l1² l3² sin²θ / l2 + 2 c2 (l1 + l2 − l3)",
    how="dimensions; J_e² by A.3", reading="l1² l3² sin²θ / l2², twice (see a6-factor)",
    note="The exponent of l2 may have been lost in extraction.",
)  # fmt: skip
def _() -> Found:
    b, at = appendix_a.ASSUMED, np.array([1.0])
    said = inconsistent(1, "A.7, c1")
    share = float((appendix_a.c1_printed(at, b) / appendix_a.c1_derived(at, b))[0])
    return f"{said}; in SI numbers c1 is {share:.2f} of the derived one at 1 rad", bool(said), {"share": share}


@CHECKS.row(
    id="a8-foe", place="A.8 and A.9", severity="definition", printed="F_oe", how="A.9 at N = 1 against A.4 with F_0 = k x0: the force that makes them equal",
    reading="F_0", note="Never defined; A.10 and A.11 call it F_0.",
)  # fmt: skip
def _() -> Found:
    b, at = replace(appendix_a.ASSUMED, count=1), np.array([0.7])
    arm = appendix_a.lever(at, b)
    a4 = b.k * (appendix_a.elongation(at, b) + b.x0) * arm
    force = float(((a4 - b.k * appendix_a.elongation(at, b) * arm) / arm)[0])
    return f"F_oe = {force:.3f} N = F_0", abs(force - b.preload) < 1e-9, {"force": force}
