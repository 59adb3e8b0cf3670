"""All that is recomputed from the papers, in one place."""

from __future__ import annotations

from dataclasses import dataclass

from ...models import Condition
from .appendix_a import EquationCheck, StiffnessCheck
from .audit import AuditRow
from .fits import Fits
from .passivity import LoopIntegral, Objective
from .sensitivity import Ranking
from .tables import Compared

__all__ = ["Results"]


@dataclass(frozen=True)
class Results:
    """Everything recomputed from the two papers."""

    fits: Fits
    tables: list[Compared]
    audit: list[AuditRow]
    equations: list[EquationCheck]
    stiffness: list[StiffnessCheck]
    conditions: dict[str, list[Condition]]
    objectives: list[Objective]
    integrals: list[LoopIntegral]
    sensitivity: list[Ranking]
