"""What each model lacks on recorded data: one diagnosis a model and dataset, kept and computed like the other cells."""

from __future__ import annotations

import hashlib
import inspect
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, ClassVar

from .. import diagnosis, models
from ..datasets import Dataset
from ..errors import InputError
from ..files import write_text
from .cells import MEMORY_LIMIT, data_hash, fitted_on, load_unchanged, model_identity
from .results import plain
from .session import session_id
from .shapes import DIAGNOSES, fits

__all__ = ["SEED", "DiagnosisSpec", "best_models", "diagnosis_specs", "read_diagnoses", "write_diagnoses"]

SCHEMA = "hystbench/diagnoses/1"
SEED = 0
"""Of the bootstrap intervals."""


@dataclass(frozen=True)
class DiagnosisSpec:
    """A model that is fitted to a recorded dataset's training recordings and diagnosed on its test recordings."""

    model: str
    dataset: str
    data: str
    """Content hash of the dataset, its channels included."""
    time_limit: float
    memory_limit: float = MEMORY_LIMIT
    run: str = ""
    keep_arrays: ClassVar[bool] = False

    @property
    def key(self) -> str:
        """The content hash of everything the diagnosis depends on."""
        document = {
            "diagnosis": _diagnosis_code(),
            "seed": SEED,
            "dataset": self.dataset,
            "data": self.data,
            **model_identity(self.model),
        }
        return hashlib.sha256(json.dumps(document, sort_keys=True).encode()).hexdigest()[:24]

    @property
    def name(self) -> str:
        """For messages."""
        return f"the diagnosis of {self.model} on {self.dataset}"

    def blank(self) -> dict[str, Any]:
        """The cell before anything is known."""
        place = {"model": self.model, "dataset": self.dataset, "condition": "recorded", "seed": SEED}
        return {
            "key": self.key,
            **place,
            "session": session_id(),
            "run": self.run,
            "rows": [{**place, "task": "diagnosis", "status": "", "message": ""}],
            "diagnosis": None,
        }

    def fill(self, cell: dict[str, Any], arrays: dict[str, Any]) -> None:
        """Fit, diagnose and put the document into the cell."""
        from ..diagnosis.from_benchmark import diagnose_model

        dataset = load_unchanged(self.dataset, self.data, channels=True)
        row = cell["rows"][0]
        try:
            fitted, _ = fitted_on(self.model, dataset.train)
            found = diagnose_model(fitted, dataset, seed=SEED)
        except InputError as error:  # too short, for instance: no fault of the model's
            row.update(status="unsupported", message=str(error))
            return
        cell["diagnosis"] = found.document()
        row.update(status="ok")


@lru_cache(maxsize=1)
def _diagnosis_code() -> str:
    """Hash of the diagnosis' source and of all registered effects, whoever brought them."""
    folder = Path(inspect.getfile(diagnosis)).parent
    files = {path for path in folder.rglob("*.py") if "blind" not in path.parts}
    files |= {Path(inspect.getfile(diagnosis.registry.get(name))) for name in diagnosis.registry.ids()}
    digest = hashlib.sha256()
    for path in sorted(files):
        digest.update(path.read_bytes())
    return digest.hexdigest()


def diagnosis_specs(
    model_ids: Sequence[str], loaded: Mapping[str, Dataset], time_limit: float, memory_limit: float
) -> list[DiagnosisSpec]:
    """One diagnosis for each model and recorded dataset."""
    return [
        DiagnosisSpec(model, name, data_hash(dataset, channels=True), time_limit, memory_limit)
        for name, dataset in loaded.items()
        if dataset.kind == "recorded"
        for model in model_ids
    ]


def best_models(specs: Iterable[DiagnosisSpec], cells: Iterable[Mapping[str, Any]]) -> list[DiagnosisSpec]:
    """Of each dataset the diagnosis of the model with the smallest error on its recordings as they are."""
    errors = {
        (cell["model"], cell["dataset"]): row["nrmse"]
        for cell in cells
        for row in cell["rows"]
        if cell["condition"] == "recorded" and row["task"] == "forward" and row["status"] == "ok"
    }
    best: dict[str, DiagnosisSpec] = {}
    for spec in specs:
        error, first = errors.get((spec.model, spec.dataset)), best.get(spec.dataset)
        if error is not None and (first is None or error < errors[first.model, spec.dataset]):
            best[spec.dataset] = spec
    return list(best.values())


def write_diagnoses(path: Path, cells: Iterable[Mapping[str, Any]]) -> None:
    """Write the diagnoses of finished cells, each beside the cause that is known from how its data were made."""
    ordered = sorted(cells, key=lambda cell: (cell["dataset"], cell["model"]))
    document = {"schema": SCHEMA, "seed": SEED, "diagnoses": [_entry(cell) for cell in ordered]}
    write_text(path, json.dumps(plain(document), indent=1, ensure_ascii=False, allow_nan=False) + "\n")


def read_diagnoses(folder: Path) -> list[dict[str, Any]]:
    """The diagnoses of a run folder; none if there is no file of them that can be read."""
    try:
        document = json.loads((folder / "diagnoses.json").read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return []
    return list(document["diagnoses"]) if fits(document, DIAGNOSES) and document.get("schema") == SCHEMA else []


def _entry(cell: Mapping[str, Any]) -> dict[str, Any]:
    from ..diagnosis.known_causes import known_cause

    found = cell["diagnosis"]
    cause = known_cause(models.get(cell["model"]), cell["dataset"])
    known = cause and {
        "effects": sorted(cause.effects),
        "reason": cause.reason,
        "agrees": None if found is None else cause.agrees(found["verdict"]),
    }
    return {
        "model": cell["model"],
        "dataset": cell["dataset"],
        "status": cell["rows"][0]["status"],
        "message": cell["rows"][0]["message"],
        "known_cause": known,
        "diagnosis": found,
    }
