"""The result table: one row per model x dataset x condition x task x seed, and the finished cells it is made of."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import InputError
from ..files import replacing, write_text
from .shapes import CELL, RUN, fits

if TYPE_CHECKING:
    import pandas as pd

__all__ = [
    "COLUMNS",
    "METRIC_COLUMNS",
    "TASKS",
    "TIME_COLUMNS",
    "drop_unfinished",
    "read_cells",
    "read_document",
    "read_results",
    "table_of",
    "write_cell",
    "write_results",
]

TASKS = ("forward", "inverse", "compensation")
KEYS = ("dataset", "model", "condition", "task", "seed")
METRIC_COLUMNS = ("mae", "mre", "rmse", "max_abs", "nrmse")
TIME_COLUMNS = ("fit_s", "predict_ns_per_sample", "step_ns")
COLUMNS = ("model", "dataset", "condition", "task", "seed", "n", *METRIC_COLUMNS, *TIME_COLUMNS, "status", "message")


def plain(value: Any) -> Any:
    """``value`` as JSON can hold it: arrays as lists, what is not finite as null."""
    if isinstance(value, Mapping):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [plain(v) for v in value]
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def write_cell(folder: Path, cell: Mapping[str, Any], arrays: Mapping[str, np.ndarray] | bytes) -> None:
    """Write one finished cell, its arrays (or the bytes of their file) first: a cell whose JSON exists is whole."""
    path = folder / f"{cell['key']}.npz"
    if arrays:
        with replacing(path) as temporary:
            if isinstance(arrays, bytes):
                temporary.write_bytes(arrays)
            else:
                np.savez_compressed(temporary, allow_pickle=False, **arrays)
    else:
        # The cell may take the place of one that succeeded.
        path.unlink(missing_ok=True)
    write_text(folder / f"{cell['key']}.json", json.dumps(plain(cell), allow_nan=False) + "\n")


def read_cells(folder: Path) -> dict[str, dict[str, Any]]:
    """All finished cells by their key."""
    cells = {}
    for path in sorted(folder.glob("*.json")):
        try:
            cell = json.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError, RecursionError):
            continue
        # What was not written by us, or was damaged since, is simply computed again.
        if fits(cell, CELL) and cell.get("key") == path.stem:
            cells[path.stem] = cell
    return cells


def drop_unfinished(folder: Path) -> None:
    """Remove the marks and half-written files of processes that were killed; none may be at work there any more."""
    for left in folder.glob(".*"):
        left.unlink(missing_ok=True)


def table_of(cells: Iterable[Mapping[str, Any]]) -> pd.DataFrame:
    """The rows of all cells, sorted, so that equal results make equal tables."""
    # Processes that compute cells make no table, and importing pandas would cost them a second.
    import pandas as pd

    rows = [row for cell in cells for row in cell["rows"]]
    table = pd.DataFrame(rows, columns=list(COLUMNS))
    table = table.astype({"seed": "int64", "n": "int64", **dict.fromkeys((*METRIC_COLUMNS, *TIME_COLUMNS), "float64")})
    return table.sort_values(list(KEYS), ignore_index=True)


def write_results(path: Path, cells: Iterable[Mapping[str, Any]]) -> None:
    """Write the rows of all cells to a Parquet file."""
    with replacing(path) as temporary:
        table_of(cells).to_parquet(temporary, index=False)


def read_results(where: str | Path) -> pd.DataFrame:
    """Read the result table of a run folder (or the Parquet file itself).

    Raises
    ------
    InputError
        If there is none, or it lacks a column.
    """
    import pandas as pd

    path = Path(where)
    if path.is_dir():
        path = path / "results.parquet"
    if not path.exists():
        raise InputError(f"{path}: no results there; `hystbench run --out {path.parent}` makes them")
    try:
        table = pd.read_parquet(path)
    except Exception as error:
        raise InputError(f"{path}: not a result table ({type(error).__name__}); run `hystbench run` again") from None
    missing = [column for column in COLUMNS if column not in table.columns]
    if missing:
        raise InputError(f"{path}: not a result table of this version, it lacks {', '.join(missing)}")
    return table


def read_document(where: str | Path) -> dict[str, Any]:
    """The ``run.json`` of a run folder; empty if there is none that can be read, or it is not as a run writes it."""
    path = Path(where)
    try:
        document = json.loads(((path if path.is_dir() else path.parent) / "run.json").read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return {}
    return document if fits(document, RUN) else {}
