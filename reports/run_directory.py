"""What a run left behind: its table, its cells and where they came from."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from ..bench.diagnoses import read_diagnoses
from ..bench.results import read_cells, read_document, read_results, table_of
from ..errors import InputError

__all__ = ["RunDirectory", "read_run"]

CONDITION_ORDER = ("clean", "noisy", "kalman", "smoothed", "recorded")
# A run.json that is missing or older leaves these blank.
NO_RUN: dict[str, Any] = {
    "started": "", "skipped": [], "command": [], "seeds": [], "elapsed_s": None, "machine": {}, "versions": {},
    "cells_done": 0, "cells_total": 0,
}  # fmt: skip
NO_DATASET: dict[str, Any] = {
    "title": "", "kind": "", "split": "", "source": "", "licence": "", "x_name": "input", "x_unit": "", "y_name": "output",
    "y_unit": "", "x_sigma": None, "y_sigma": None, "assumptions": [], "n_train": 0, "n_test": 0,
    "test_recordings": [], "references": {},
}  # fmt: skip
NO_MODEL: dict[str, Any] = {"summary": "", "source": "", "hyperparameters": {}}
IDENTITY = ("model", "dataset", "condition", "seed")
MODEL_ORDER = ("maxwell-slip", "cubic", "bouc-wen", "preisach", "prandtl-ishlinskii", "choi-backlash")


@dataclass(frozen=True)
class RunDirectory:
    """A run folder, read."""

    path: Path
    table: pd.DataFrame
    cells: dict[str, dict[str, Any]]
    document: dict[str, Any]
    diagnoses: list[dict[str, Any]] = field(default_factory=list)
    """What models lack, as diagnoses.json tells it."""

    @cached_property
    def models(self) -> list[str]:
        """Model ids in the report's order: the six of the source papers first, then the others by name."""
        found = set(self.table["model"]) | set(self.document.get("models", {}))
        return [m for m in MODEL_ORDER if m in found] + sorted(found - set(MODEL_ORDER))

    @cached_property
    def datasets(self) -> list[str]:
        """Dataset ids: synthetic ones first."""
        found = set(self.table["dataset"]) | set(self.document.get("datasets", {}))
        return sorted(found, key=lambda d: (self.dataset(d).get("kind") == "recorded", not d.startswith("vsa"), d))

    def dataset(self, name: str) -> dict[str, Any]:
        """What run.json says of a dataset."""
        return NO_DATASET | self.document.get("datasets", {}).get(name, {})

    def model(self, name: str) -> dict[str, Any]:
        """What run.json says of a model."""
        return NO_MODEL | {"title": name} | self.document.get("models", {}).get(name, {})

    def model_title(self, name: str) -> str:
        """The model's title for people."""
        return str(self.model(name)["title"])

    def conditions(self, dataset: str) -> list[str]:
        """Conditions that were run on a dataset, from clean to filtered."""
        found = set(self.table.loc[self.table["dataset"] == dataset, "condition"])
        return [c for c in CONDITION_ORDER if c in found] + sorted(found - set(CONDITION_ORDER))

    def reference_condition(self, dataset: str) -> str:
        """The condition that the headline compares under: what an engineer would have, filtered where that was run."""
        found = self.conditions(dataset)
        for condition in ("recorded", "kalman", "noisy", "smoothed", "clean"):
            if condition in found:
                return condition
        return ""

    def rows(self, dataset: str, condition: str, task: str, model: str) -> pd.DataFrame:
        """Rows of one model over the seeds."""
        t = self.table
        chosen = (t["dataset"] == dataset) & (t["condition"] == condition) & (t["task"] == task) & (t["model"] == model)
        return t[chosen]

    def iter_cells(self, **wanted: Any) -> Iterator[dict[str, Any]]:
        """Cells whose entries equal ``wanted``."""
        for cell in self.cells.values():
            if all(cell.get(key) == value for key, value in wanted.items()):
                yield cell

    def arrays(self, model: str, dataset: str, condition: str) -> dict[str, np.ndarray]:
        """Predictions of a model's first seed; empty if none were kept."""
        for cell in sorted(self.iter_cells(model=model, dataset=dataset, condition=condition), key=lambda c: c["seed"]):
            path = self.path / "cells" / f"{cell['key']}.npz"
            if path.exists():
                with np.load(path, allow_pickle=False) as stored:
                    return {name: stored[name] for name in stored.files}
        return {}


def read_run(path: Path) -> RunDirectory:
    """Read a run folder.

    Raises
    ------
    InputError
        If it holds no results.
    """
    document = NO_RUN | read_document(path)
    cells = read_cells(path / "cells") if (path / "cells").is_dir() else {}
    if document.get("finished") is False:
        # A run that was killed could not write its table any more; its finished cells are there.
        cells = {key: cells[key] for key in document.get("cells", []) if key in cells}
        table = table_of(cells.values())
        superseded = set(document.get("superseded", []))
        earlier = [key for key in cells if key in superseded and cells[key].get("run") != document.get("run")]
        document["cells_done"] = len(cells) - len(earlier)
        document["cells_earlier"] = len(earlier)
    else:
        table = read_results(path)
        known = set(zip(*(table[column] for column in IDENTITY), strict=True))
        cells = {key: cell for key, cell in cells.items() if tuple(cell[column] for column in IDENTITY) in known}
    if table.empty:
        raise InputError(f"{path}: the run finished no cell, so there is nothing to report; run `hystbench run` again")
    return RunDirectory(path, table, cells, document, read_diagnoses(path))
