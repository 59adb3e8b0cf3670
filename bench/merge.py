"""Several runs as one: the parts of an array job, or models that were run apart."""

from __future__ import annotations

import json
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..files import replacing, write_text
from ..reports.run_directory import RunDirectory, read_run
from .diagnoses import write_diagnoses
from .results import plain, read_cells, read_document, write_results

__all__ = ["merge"]

IDENTITY = ("model", "dataset", "condition", "seed")
EXTENTS = ("none", "best", "all")
"""How much was diagnosed, from least to most."""


def merge(folders: Sequence[Path], out: Path) -> Path:
    """Write one run folder ``out`` that holds the cells of all ``folders`` and return it.

    A cell that several runs hold counts once, a finished one before a failed one.

    Raises
    ------
    InputError
        If a folder holds no results, two hold a cell computed from different code, data or settings, or ``out`` holds
        something else already.
    """
    if any(out.resolve() == folder.resolve() for folder in folders):
        raise InputError(f"--out {out} is one of the runs to merge; name another folder")
    if out.exists() and not (out.is_dir() and (not any(out.iterdir()) or read_document(out).get("merged"))):
        raise InputError(f"--out {out} holds something that is no merged run; name another folder")
    runs = [read_run(folder) for folder in folders if not _is_empty_part(folder)]
    if not runs:
        raise InputError(f"{', '.join(map(str, folders))}: no cell in any of them, so there is nothing to report")
    chosen: dict[tuple[Any, ...], tuple[RunDirectory, dict[str, Any]]] = {}
    for run in runs:
        if not run.cells:
            raise InputError(f"{run.path}: its folder cells is missing, without which runs cannot be merged")
        for cell in run.cells.values():
            identity = tuple(cell[name] for name in IDENTITY)
            if identity not in chosen:
                chosen[identity] = run, cell
                continue
            other, first = chosen[identity]
            if first["key"] != cell["key"]:
                raise InputError(
                    f"{other.path} and {run.path} both hold {cell['model']} on {cell['dataset']} ({cell['condition']}, seed "
                    f"{cell['seed']}), from different code, data or settings; `hystbench compare` compares them"
                )
            if _failed(first) and not _failed(cell):
                chosen[identity] = run, cell
    for name in ("cells", "diagnoses"):
        shutil.rmtree(out / name, ignore_errors=True)
        (out / name).mkdir(parents=True)
    for run, cell in chosen.values():
        _copy(run.path / "cells", cell["key"], out / "cells")
    write_results(out / "results.parquet", [cell for _, cell in chosen.values()])
    write_diagnoses(out / "diagnoses.json", _diagnoses(folders, out / "diagnoses"))
    document = _document(runs, folders, [cell for _, cell in chosen.values()])
    write_text(out / "run.json", json.dumps(plain(document), indent=1, allow_nan=False) + "\n")
    return out


def _copy(source: Path, key: str, target: Path) -> None:
    for suffix in (".json", ".npz"):
        file = source / f"{key}{suffix}"
        if file.exists():
            with replacing(target / file.name) as temporary:
                shutil.copyfile(file, temporary)


def _diagnoses(folders: Sequence[Path], target: Path) -> list[dict[str, Any]]:
    """Copy the diagnoses that the folders hold, of each model and dataset one that succeeded if any did."""
    chosen: dict[tuple[Any, ...], tuple[Path, dict[str, Any]]] = {}
    for folder in folders:
        for cell in read_cells(folder / "diagnoses").values():
            identity = tuple(cell[name] for name in IDENTITY)
            if identity not in chosen or (_failed(chosen[identity][1]) and not _failed(cell)):
                chosen[identity] = folder / "diagnoses", cell
    for source, cell in chosen.values():
        _copy(source, cell["key"], target)
    return [cell for _, cell in chosen.values()]


def _is_empty_part(folder: Path) -> bool:
    """A part of an array job that had more parts than cells."""
    return read_document(folder).get("cells_total") == 0


def _failed(cell: dict[str, Any]) -> bool:
    return any(row["status"] in ("failed", "timeout") for row in cell["rows"])


def _document(runs: Sequence[RunDirectory], folders: Sequence[Path], cells: Sequence[dict[str, Any]]) -> dict[str, Any]:
    documents = [run.document for run in runs]
    expected = {key for document in documents for key in document.get("cells", [])}
    held = {cell["key"] for cell in cells}
    united: dict[str, Any] = {}
    for name in ("models", "datasets", "data", "compile_s"):
        united[name] = {key: value for document in documents for key, value in document.get(name, {}).items()}
    skipped = {(entry["what"], entry["why"]): entry for document in documents for entry in document.get("skipped", [])}
    parts = {tuple(document["part"]) for document in map(read_document, folders) if document.get("part")}
    of = max((n for _, n in parts), default=0)
    absent = sorted(set(range(1, of + 1)) - {i for i, n in parts if n == of})
    return {
        **documents[0],
        **united,
        "merged": [str(run.path) for run in runs],
        "command": ["hystbench", "report", *(str(folder) for folder in folders)],
        "seeds": sorted({seed for document in documents for seed in document.get("seeds", [])}),
        "sessions": sorted({session for document in documents for session in document.get("sessions", ["unknown"])}),
        "elapsed_s": sum(document.get("elapsed_s") or 0.0 for document in documents),
        "skipped": list(skipped.values()),
        "part": None,
        "diagnosed": max((str(document.get("diagnosed", "none")) for document in documents), key=EXTENTS.index),
        "parts_absent": [f"{i}/{of}" for i in absent],
        "cells": sorted(expected | held),
        "cells_total": len(expected | held),
        "cells_done": len(held),
        # Unfinished parts leave cells out; absent ones, cells that nobody here knows of.
        "finished": not absent and expected <= held,
    }
