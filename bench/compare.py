"""Did a model get worse? Two result tables, compared cell by cell."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd

from ..errors import InputError

__all__ = ["Difference", "compare", "parse_tolerance"]

KEYS = ["model", "dataset", "condition", "task"]
FLOOR = 1e-9
"""NRMSE below which a difference is rounding: two exact fits may differ by any ratio."""


@dataclass(frozen=True)
class Difference:
    """One cell that differs between base and new: ``kind`` is regression, improvement, failed, missing or new."""

    kind: str
    cell: str
    base: float
    new: float
    message: str


def parse_tolerance(text: str) -> float:
    """``"5%"`` or ``"0.05"`` as 0.05."""
    try:
        value = float(text.rstrip("%")) / (100.0 if text.endswith("%") else 1.0)
    except ValueError:
        value = -1.0
    if not 0.0 <= value < 10.0:
        raise InputError(f"--tolerance must be a percentage such as 5% or a fraction such as 0.05; it is {text!r}")
    return value


def compare(base: pd.DataFrame, new: pd.DataFrame, tolerance: float) -> tuple[int, list[Difference]]:
    """Compare the median NRMSE over seeds of every cell.

    Returns
    -------
    compared : int
        Number of cells that both tables hold with a result.
    differences : list of Difference
        Worst first.
    """
    old, now = _by_cell(base), _by_cell(new)
    compared = 0
    found = []
    for key in sorted(old.keys() | now.keys()):
        cell = " / ".join(key)
        if key not in now:
            if old[key][0] == "ok":
                found.append(Difference("missing", cell, old[key][1], np.nan, "in BASE only"))
            continue
        if key not in old:
            found.append(Difference("new", cell, np.nan, now[key][1], "in NEW only"))
            continue
        (old_status, before, _), (status, after, message) = old[key], now[key]
        if old_status == "ok" and status != "ok":
            found.append(Difference("failed", cell, before, np.nan, f"{status}: {message}"))
        elif old_status == status == "ok":
            compared += 1
            if after > before * (1.0 + tolerance) and after - before > FLOOR:
                found.append(Difference("regression", cell, before, after, f"{after / max(before, FLOOR) - 1:+.1%}"))
            elif after < before * (1.0 - tolerance) and before - after > FLOOR:
                found.append(Difference("improvement", cell, before, after, f"{after / before - 1:+.1%}"))
    order = {"failed": 0, "missing": 1, "regression": 2, "improvement": 3, "new": 4}
    found.sort(key=lambda d: (order[d.kind], -(d.new / max(d.base, FLOOR)) if d.kind == "regression" else 0.0))
    return compared, found


def _by_cell(table: pd.DataFrame) -> dict[tuple[str, ...], tuple[str, float, str]]:
    cells = {}
    for key, rows in table.groupby(KEYS, sort=True):
        bad = rows[rows["status"] != "ok"]
        status = "ok" if bad.empty else str(bad["status"].iloc[0])
        message = "" if bad.empty else str(bad["message"].iloc[0])
        cells[tuple(map(str, key))] = (status, float(rows["nrmse"].median()), message)
    return cells
