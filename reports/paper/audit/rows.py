"""One finding of the audit, and a table of checks each of which computes one."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

__all__ = ["SEVERITIES", "AuditRow", "Checks", "Found"]

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
"""What stands there instead, whether it really differs, and the figures that decide it."""


class Checks:
    """Checks in the order of the text that they are about, which is of one ``paper``."""

    def __init__(self, paper: int) -> None:
        self._paper = paper
        self._checks: list[tuple[dict[str, Any], Callable[[], Found]]] = []

    def row(self, **told: Any) -> Callable[[Callable[[], Found]], Callable[[], Found]]:
        """Take in the decorated function, which computes the row of which the rest is ``told``."""

        def register(check: Callable[[], Found]) -> Callable[[], Found]:
            self._checks.append((told, check))
            return check

        return register

    def rows(self) -> Iterator[AuditRow]:
        """What each check finds."""
        for own, check in self._checks:
            recomputed, contradicts, values = check()
            plain = {name: float(value) for name, value in values.items()}
            told = {"paper": self._paper, "note": "", **own}
            yield AuditRow(recomputed=recomputed, contradicts=bool(contradicts), values=plain, **told)
