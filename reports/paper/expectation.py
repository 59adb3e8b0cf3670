"""What a run is expected to give, rounded to meaningful digits, and the differences from it."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

from ...errors import InputError
from .results import Results

__all__ = ["compare_with_expectation", "expectation", "read_expectation"]

SCHEMA = "hystbench/paper-expectation/1"
DIGITS = 5
EXACT = 1e-4
"""Relative tolerance of what follows from printed figures alone: the last of the kept digits."""

FITTED = 0.05
"""Relative tolerance of what rests on fits: optimisers stop at slightly different points on other machines."""

TOSS_UP = 1.05
"""Orders are compared only where neighbouring scores differ at least by this factor."""


def _round(value: float) -> float | None:
    return float(f"{value:.{DIGITS}g}") if math.isfinite(value) else None


def expectation(results: Results) -> dict[str, Any]:
    """The results as plain rounded data, to be committed."""
    return {
        "schema": SCHEMA,
        "tables": {
            f"Table {row.table} | {row.cell} | {row.how}": {
                "recomputed": _round(row.recomputed),
                "verdict": row.verdict,
            }
            for row in results.tables
            if row.table <= 3
        },
        "fitted": {
            f"Table {row.table} | {row.cell}": {"recomputed": _round(row.recomputed)}
            for row in results.tables
            if row.table > 3 and math.isfinite(row.printed)
        },
        "audit": {
            row.id: {
                "severity": row.severity,
                "contradicts": row.contradicts,
                **{name: _round(value) for name, value in row.values.items()},
            }
            for row in results.audit
        },
        "appendix": {
            row.equation: {"agrees": row.agrees, "printed": _round(row.printed), "derived": _round(row.derived)}
            for row in results.equations
        },
        "stiffness": {
            f"{row.expression} | N = {row.count} | {row.preload:g} N": {
                "holds": row.holds,
                "at_one_rad": _round(row.at_one_rad),
            }
            for row in results.stiffness
        },
        "passivity": {
            f"{row.model} | {row.path}": {"passive": row.passive, "printed": _round(row.printed)}
            for row in results.integrals
            if math.isfinite(row.printed)
        },
        "orders": {
            f"{row.study} | {row.variant} | {row.metric}": {"order": row.order, "closest": _round(row.closest)}
            for row in results.sensitivity
        },
    }


def read_expectation(path: Path) -> dict[str, Any]:
    """Read a committed expectation.

    Raises
    ------
    InputError
        If the file is missing or is no expectation.
    """
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputError(f"{path}: no such file; `hystbench paper` writes one as expectation.json") from None
    except (UnicodeDecodeError, json.JSONDecodeError) as error:
        raise InputError(f"{path}: not an expectation ({error}); `hystbench paper` writes one") from None
    if not isinstance(document, dict) or document.get("schema") != SCHEMA:
        raise InputError(f"{path}: not an expectation (no schema {SCHEMA!r}); `hystbench paper` writes one")
    return document


def compare_with_expectation(found: dict[str, Any], expected: dict[str, Any]) -> list[str]:
    """Differences between two expectations, one line each; empty when the run gives what was committed.

    What was committed must be there and agree, and nothing may be new.
    """
    differences = []
    for section in ("tables", "fitted", "audit", "appendix", "stiffness", "passivity", "orders"):
        wanted, given = expected.get(section, {}), found.get(section, {})
        tolerance = FITTED if section == "fitted" else EXACT
        for key, entry in wanted.items():
            if key not in given:
                differences.append(f"{section}: {key}: missing")
                continue
            if section == "orders":
                decided = min(entry["closest"] or 0.0, given[key]["closest"] or 0.0) >= TOSS_UP
                entry, own = ({"order": e["order"]} for e in (entry, given[key]))
                if not decided:
                    continue
            else:
                own = given[key]
            for name in {**entry, **own}:
                expected_value, value = entry.get(name), own.get(name)
                if not _alike(expected_value, value, tolerance):
                    differences.append(f"{section}: {key}: {name}: expected {expected_value}, found {value}")
        differences += [f"{section}: {key}: not expected" for key in given if key not in wanted]
    return differences


def _alike(a: Any, b: Any, tolerance: float) -> bool:
    numbers = [isinstance(v, float | int) and not isinstance(v, bool) for v in (a, b)]
    if all(numbers):
        # Differences of finite differences and of rounding are zero for every purpose here.
        return math.isclose(a, b, rel_tol=tolerance, abs_tol=1e-6)
    return bool(a == b)
