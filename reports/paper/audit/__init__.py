"""The audit: every place where the two papers contradict themselves, each other or dimensions, recomputed by code.

A row states what is printed; a function computes what stands there instead and whether it really differs, so that a row
cannot outlive the contradiction that it claims. The papers were at hand as text extracted from PDF and HTML: where a
symbol may have been lost in extraction, the row's note says so.
"""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from . import appendix, claims, equations, printed_tables, second_paper
from .rows import SEVERITIES, AuditRow

__all__ = ["SEVERITIES", "AuditRow", "as_records", "audit"]

PARTS = (equations, printed_tables, claims, appendix, second_paper)
"""In the order of the papers."""


def audit() -> list[AuditRow]:
    """All rows, in the order of the papers."""
    return [row for part in PARTS for row in part.CHECKS.rows()]


def as_records() -> list[dict[str, Any]]:
    """The rows as plain data."""
    return [asdict(row) for row in audit()]
