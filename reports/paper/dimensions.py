"""Checking the papers' equations by dimensions: each term of each equation, from the dimensions of its symbols."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import reduce
from operator import mul
from typing import NamedTuple

__all__ = ["EQUATIONS", "Dimension", "Equation", "inconsistent"]


class Dimension(NamedTuple):
    """Exponents of metre, kilogram and second; angles have none."""

    metre: int = 0
    kilogram: int = 0
    second: int = 0

    def __mul__(self, other: Dimension) -> Dimension:  # type: ignore[override]
        return Dimension(*(a + b for a, b in zip(self, other, strict=True)))

    def __truediv__(self, other: Dimension) -> Dimension:
        return Dimension(*(a - b for a, b in zip(self, other, strict=True)))

    def __pow__(self, power: int) -> Dimension:
        return reduce(mul, [self] * power, Dimension())

    def __str__(self) -> str:
        if self == NUMBER:
            return "1"
        for name, known in (("N·m", TORQUE), ("N", FORCE), ("N/m", STIFFNESS)):
            if self == known:
                return name
        return "·".join(f"{unit}{_SUPERSCRIPT.get(n, n)}" for unit, n in zip(("m", "kg", "s"), self, strict=True) if n)


_SUPERSCRIPT = {1: "", 2: "²", 3: "³", 4: "⁴", -1: "⁻¹", -2: "⁻²"}
NUMBER = Dimension()
LENGTH = Dimension(metre=1)
MASS = Dimension(kilogram=1)
FORCE = Dimension(1, 1, -2)
TORQUE = FORCE * LENGTH
STIFFNESS = FORCE / LENGTH
# x = h(θ) of Eq. 6: a length [12 (l1 + l2 − l3) + x0] times a lever arm l1 l3 sin θ / l2.
VIRTUAL = LENGTH * LENGTH * LENGTH / LENGTH
SLOPE = TORQUE / VIRTUAL


@dataclass(frozen=True)
class Equation:
    """An equation or statement and the dimension of each of its terms."""

    paper: int
    number: str
    terms: Mapping[str, Dimension]

    @property
    def consistent(self) -> bool:
        return len(set(self.terms.values())) == 1


EQUATIONS = (
    Equation(1, "1", {"T": TORQUE, "k [12 (l1+l2−l3) + x0] l1 l3 sin θ / l2": STIFFNESS * LENGTH * LENGTH**2 / LENGTH}),
    Equation(1, "2", {"F_i, named a force": FORCE, "Σ f_i, named forces": FORCE, "T_0, named a torque": TORQUE}),
    Equation(1, "3", {"f_i = k_i (x − ζ_i) with x = h(θ)": SLOPE * VIRTUAL, "η_i, named a force": FORCE}),
    Equation(1, "4, text before", {"δT": TORQUE, "K·δθ with K the stiffness of the elastomer": STIFFNESS * NUMBER}),
    Equation(1, "4", {"T": TORQUE, "K h(θ) with K the stiffness of the elastomer": STIFFNESS * VIRTUAL}),
    Equation(1, "5 and Figs. 20-23", {"x = h(θ)": VIRTUAL, "x as the deflection angle in rad": NUMBER}),
    Equation(1, "8, 9", {"f": TORQUE, "k_ij (x − x_i)": SLOPE * VIRTUAL, "T_i": TORQUE}),
    Equation(1, "10", {"f_t": TORQUE, "Σ f_i with f_i = k_i (x − ζ_i)": SLOPE * VIRTUAL, "T_0": TORQUE}),
    Equation(1, "11", {"f_d(x_1)": TORQUE, "k (x_1 − x_2)": SLOPE * VIRTUAL, "f_a(x_2)": TORQUE}),
    Equation(1, "12", {"k": SLOPE, "(T_D − T_C)/(x_D − x_C)": TORQUE / VIRTUAL}),
    Equation(1, "13, 14", {"x_1": VIRTUAL, "[f_a − k x_2 + p]/(k(x_1) − k)": TORQUE / SLOPE}),
    Equation(1, "16", {"k_i": SLOPE, "K_P1P2 − K_P2P3": SLOPE}),
    Equation(1, "17", {"η_1, a torque as Eq. 10 needs": TORQUE, "k_1 (x(P2) − x(P1))/(x(P_N+1) − x(P1)) e": SLOPE * VIRTUAL}),
    Equation(1, "A.1", {"l2²": LENGTH**2, "l1² + l3²": LENGTH**2, "2 l1 l3 cos θ": LENGTH * LENGTH}),
    Equation(1, "A.2", {"T_e": TORQUE, "F_e J_e": FORCE * LENGTH}),
    Equation(1, "A.3", {"J_e": LENGTH, "∂l2/∂θ": LENGTH / NUMBER, "l1 l3 sin θ / l2": LENGTH**2 / LENGTH}),
    Equation(1, "A.4", {"T_e": TORQUE, "k [2 (l1+l2−l3) + x0] l1 l3 sin θ / l2": STIFFNESS * LENGTH * LENGTH**2 / LENGTH}),
    Equation(1, "A.5", {"δT": TORQUE, "K_e δθ": TORQUE * NUMBER}),
    Equation(1, "A.6", {"K_e": TORQUE, "J_e² k": LENGTH**2 * STIFFNESS, "∂J_e/∂θ δl_e k": LENGTH * LENGTH * STIFFNESS,
                        "∂J_e/∂θ F_0": LENGTH * FORCE}),
    Equation(1, "A.7, c1", {"l1² l3² sin²θ / l2": LENGTH**4 / LENGTH, "2 c2 (l1+l2−l3)": LENGTH * LENGTH}),
    Equation(1, "A.7, c2", {"l1 l3 cos θ / l2": LENGTH**2 / LENGTH, "l1² l3² sin²θ / l2³": LENGTH**4 / LENGTH**3}),
    Equation(1, "A.8", {"K": TORQUE, "N k J_e²": STIFFNESS * LENGTH**2, "N k ∂J_e/∂θ δl_e": STIFFNESS * LENGTH * LENGTH,
                        "N ∂J_e/∂θ F_oe": LENGTH * FORCE}),
    Equation(1, "A.9", {"T": TORQUE, "N k J_e δl_e": STIFFNESS * LENGTH * LENGTH, "N J_e F_oe": LENGTH * FORCE}),
    Equation(1, "A.10", {"F_e": FORCE, "k δl_e": STIFFNESS * LENGTH, "F_0": FORCE}),
    Equation(1, "A.11", {"F_0": FORCE, "k x_0": STIFFNESS * LENGTH}),
    Equation(1, "A.12", {"T": TORQUE, "k [12 (l1+l2−l3) + x0] l1 l3 sin θ / l2": STIFFNESS * LENGTH * LENGTH**2 / LENGTH}),
    Equation(1, "section 2.1, belt", {"maximum stretch, a length": LENGTH, "0.7 kg": MASS}),
    Equation(1, "Table 4, MRE", {"|error| / |torque|": TORQUE / TORQUE, "N·m as printed": TORQUE}),
    Equation(2, "40", {"τ": TORQUE, "k θ": TORQUE * NUMBER}),
    Equation(2, "41", {"τ_err": TORQUE, "τ_k": TORQUE, "f_hys": TORQUE}),
    Equation(2, "44-46, 50", {"∮ τ dθ": TORQUE * NUMBER, "∫ (f − f) dθ": TORQUE * NUMBER}),
    Equation(2, "47, 48", {"τ": TORQUE, "s+ θ": TORQUE * NUMBER, "p": TORQUE}),
    Equation(2, "49", {"s+ (θ_H − θ_G)": TORQUE * NUMBER, "τ_H − τ_G": TORQUE}),
    Equation(2, "appendix 1, range", {"deformation range, an angle": NUMBER, "16 Nm": TORQUE}),
)  # fmt: skip


def inconsistent(paper: int, number: str) -> str:
    """The disagreeing dimensions of an equation in words; empty where it is consistent."""
    found = next(e for e in EQUATIONS if (e.paper, e.number) == (paper, number))
    return "" if found.consistent else "; ".join(f"{term}: {dimension}" for term, dimension in found.terms.items())
