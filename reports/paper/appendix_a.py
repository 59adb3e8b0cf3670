"""Appendix A of the first paper: torque and stiffness of the compliant branch as printed and as derived.

The paper prints no lengths and no belt stiffness, so figures here use :data:`ASSUMED`; what is compared are ratios of
two expressions at the same constants. "As derived" differentiates what the same appendix defines: the stiffness is the
derivative of the torque (A.5), the elongation is 2 (l1 + l2 − l3).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...datasets.vsa_physical import CONSTANTS
from .printed import CLAIMS

__all__ = [
    "ASSUMED",
    "CONFIGURATIONS",
    "PRELOADS",
    "Branch",
    "EquationCheck",
    "StiffnessCheck",
    "belt",
    "c1_derived",
    "c1_printed",
    "c2_printed",
    "elongation",
    "equation_checks",
    "lever",
    "lever_rate",
    "stiffness_checks",
    "stiffness_derived",
    "stiffness_literal",
    "stiffness_printed_c",
    "stiffness_restored",
    "torque_a9",
    "torque_a12",
    "torque_virtual_work",
]

Floats = NDArray[np.float64]
CONFIGURATIONS = (2, 4, 6)
"""The configurations of Fig. 6."""

PRELOADS = (0.0, 5.0, 10.0)
"""N; the paper names 5 N."""


@dataclass(frozen=True)
class Branch:
    """Constants of one compliant branch and the number of branches; lengths in m, stiffness in N/m, preload in N."""

    l1: float
    l3: float
    k: float
    preload: float
    count: int

    @property
    def x0(self) -> float:
        """Preload elongation, m (A.11)."""
        return self.preload / self.k


ASSUMED = Branch(
    l1=CONSTANTS["crank_m"],
    l3=CONSTANTS["link_m"],
    k=CONSTANTS["belt_stiffness_n_m"],
    preload=CLAIMS["preload_n"],
    count=CLAIMS["branches"],
)
"""Lengths and stiffness that the dataset vsa-physical assumes; preload and number of branches are the paper's."""


def belt(theta: Floats, b: Branch) -> Floats:
    """Length l2, m (A.1)."""
    return np.sqrt(b.l1**2 + b.l3**2 - 2.0 * b.l1 * b.l3 * np.cos(theta))


def elongation(theta: Floats, b: Branch) -> Floats:
    """Elongation δl_e = 2 (l1 + l2 − l3), m; zero at θ = 0 where l1 < l3."""
    return 2.0 * (b.l1 + belt(theta, b) - b.l3)


def lever(theta: Floats, b: Branch) -> Floats:
    """J_e = ∂l2/∂θ, m (A.3), with the sign of θ: the printed modulus has it lost."""
    return b.l1 * b.l3 * np.sin(theta) / belt(theta, b)


def lever_rate(theta: Floats, b: Branch) -> Floats:
    """∂J_e/∂θ, m; equal to the printed c2 (A.7)."""
    l2 = belt(theta, b)
    return b.l1 * b.l3 * np.cos(theta) / l2 - (b.l1 * b.l3 * np.sin(theta)) ** 2 / l2**3


def torque_a9(theta: Floats, b: Branch) -> Floats:
    """T = N (k J_e δl_e + J_e F_0), N·m (A.9)."""
    return b.count * (b.k * elongation(theta, b) + b.preload) * lever(theta, b)


def torque_a12(theta: Floats, b: Branch) -> Floats:
    """T as printed in A.12 and Eq. 1: the preload elongation x0 counted once for all six branches."""
    return b.k * (12.0 * (b.l1 + belt(theta, b) - b.l3) + b.x0) * lever(theta, b)


def torque_virtual_work(theta: Floats, b: Branch) -> Floats:
    """N (k δl_e + F_0) ∂δl_e/∂θ: the derivative of the belts' energy, N·m."""
    return b.count * (b.k * elongation(theta, b) + b.preload) * 2.0 * lever(theta, b)


def stiffness_literal(theta: Floats, b: Branch) -> Floats:
    """A.8 to the letter of the extracted text, with J_e/θ, N·m/rad."""
    rate = lever(theta, b) / theta
    return b.count * (b.k * (lever(theta, b) ** 2 + rate * elongation(theta, b)) + rate * b.preload)


def stiffness_restored(theta: Floats, b: Branch) -> Floats:
    """A.8 with ∂J_e/∂θ where J_e/θ stands, as A.7's c2 says, N·m/rad."""
    rate = lever_rate(theta, b)
    return b.count * (b.k * (lever(theta, b) ** 2 + rate * elongation(theta, b)) + rate * b.preload)


def c2_printed(theta: Floats, b: Branch) -> Floats:
    """c2 of A.7, m."""
    return lever_rate(theta, b)


def c1_printed(theta: Floats, b: Branch) -> Floats:
    """c1 of A.7 as printed, with l2 in the first denominator: numbers in m³ and m² added."""
    l2 = belt(theta, b)
    return (b.l1 * b.l3 * np.sin(theta)) ** 2 / l2 + 2.0 * c2_printed(theta, b) * (b.l1 + l2 - b.l3)


def c1_derived(theta: Floats, b: Branch) -> Floats:
    """The factor of k in the derivative of A.4, m²: 2 J_e² + δl_e ∂J_e/∂θ."""
    return 2.0 * lever(theta, b) ** 2 + elongation(theta, b) * lever_rate(theta, b)


def stiffness_printed_c(theta: Floats, b: Branch) -> Floats:
    """N (c1 k + c2 F_0) with c1, c2 as printed (A.6, A.7), in SI numbers."""
    return b.count * (c1_printed(theta, b) * b.k + c2_printed(theta, b) * b.preload)


def stiffness_derived(theta: Floats, b: Branch) -> Floats:
    """The derivative of A.9, N·m/rad."""
    return b.count * (c1_derived(theta, b) * b.k + c2_printed(theta, b) * b.preload)


@dataclass(frozen=True)
class StiffnessCheck:
    """A stiffness expression against the central difference of the torque A.9 over ±1 rad."""

    expression: str
    count: int
    preload: float
    at_one_rad: float
    difference_at_one_rad: float
    worst: float
    """Largest relative deviation over the grid."""

    @property
    def holds(self) -> bool:
        return self.worst < 1e-6


EXPRESSIONS = (
    ("A.8 to the letter (J_e/θ)", stiffness_literal),
    ("A.8 with ∂J_e/∂θ", stiffness_restored),
    ("A.6, A.7 with c1, c2 as printed", stiffness_printed_c),
    ("derivative of A.9 (2 J_e²)", stiffness_derived),
)


def stiffness_checks() -> list[StiffnessCheck]:
    """Every stiffness expression for N = 2, 4, 6 and each preload against finite differences of the torque."""
    # The grid misses θ = 0, where J_e/θ is undefined.
    theta = np.linspace(-1.0, 1.0, 200)
    step = 1e-5
    rows = []
    for title, expression in EXPRESSIONS:
        for count in CONFIGURATIONS:
            for preload in PRELOADS:
                b = replace(ASSUMED, count=count, preload=preload)
                measured = (torque_a9(theta + step, b) - torque_a9(theta - step, b)) / (2.0 * step)
                given = expression(theta, b)
                scale = np.max(np.abs(measured))
                worst = float(np.max(np.abs(given - measured)) / scale)
                rows.append(StiffnessCheck(title, count, preload, float(given[-1]), float(measured[-1]), worst))
    return rows


@dataclass(frozen=True)
class EquationCheck:
    """One equation of the appendix at 1 rad: its printed right-hand side and what it should equal."""

    equation: str
    unit: str
    against: str
    printed: float
    derived: float

    @property
    def agrees(self) -> bool:
        return abs(self.printed - self.derived) <= 1e-6 * max(abs(self.printed), abs(self.derived))


def equation_checks() -> list[EquationCheck]:
    """A.1 to A.12 at 1 rad with :data:`ASSUMED`, each against geometry, energy or finite differences."""
    b = ASSUMED
    one = replace(b, count=1)
    theta, step = np.array(1.0), 1e-6

    def rate(function: Callable[[Floats, Branch], Floats], branch: Branch = one) -> float:
        return float(function(theta + step, branch) - function(theta - step, branch)) / (2.0 * step)

    def energy(stretch: float) -> float:
        return 0.5 * b.k * stretch**2 + b.preload * stretch

    crank = b.l1 * np.array([1.0, 0.0])
    link = b.l3 * np.array([np.cos(theta), np.sin(theta)])
    along = link - crank
    stretch = float(elongation(theta, b))
    force = b.k * stretch + b.preload
    arm = abs(float(crank[0] * along[1] - crank[1] * along[0])) / float(np.hypot(*along))
    a4 = b.k * (stretch + b.x0) * float(lever(theta, b))
    rows = [
        ("A.1", "m", "length of link minus crank as vectors", float(belt(theta, b)), float(np.hypot(*along))),
        ("A.2", "N·m", "virtual work of the belt force, ∂δl_e/∂θ F_e", force * arm, float(torque_virtual_work(theta, one))),
        ("A.3, |l̂2 × l1|", "m", "∂l2/∂θ by differences", arm, rate(belt)),
        ("A.3, l1 l3 sin θ / l2", "m", "∂l2/∂θ by differences", float(lever(theta, b)), rate(belt)),
        ("A.4", "N·m", "F_e J_e with A.10 and A.11", a4, force * arm),
        ("A.6 with ∂J_e/∂θ", "N·m/rad", "derivative of A.4 by differences (A.5)", float(stiffness_restored(theta, one)), rate(torque_a9)),
        ("A.7, c1", "m²", "derivative of A.4 by k, by differences", float(c1_printed(theta, b)), rate(lambda t, q: elongation(t, q) * lever(t, q))),
        ("A.7, c2", "m", "∂J_e/∂θ by differences", float(c2_printed(theta, b)), rate(lever)),
        ("A.8 with ∂J_e/∂θ", "N·m/rad", "derivative of A.9 by differences", float(stiffness_restored(theta, b)), rate(torque_a9, b)),
        ("A.9", "N·m", "N times A.4", float(torque_a9(theta, b)), b.count * a4),
        ("A.10", "N", "derivative of the belt's energy by its elongation", force, (energy(stretch + step) - energy(stretch - step)) / (2.0 * step)),
        ("A.11", "N", "A.10 at δl_e = 0", b.k * b.x0, b.preload),
        ("A.12", "N·m", "A.9 with N = 6", float(torque_a12(theta, b)), float(torque_a9(theta, b))),
    ]  # fmt: skip
    return [EquationCheck(*row) for row in rows]
