"""Frictionless data packages: of a dataset, as CSV files and a ``datapackage.json``, and of the catalogue of recorded data.

Source: https://datapackage.org/standard/data-package/ (version 2).
"""

from __future__ import annotations

import hashlib
import json
import os
import re
from pathlib import Path
from typing import Any
from urllib.parse import quote

from ..errors import InputError
from ..files import write_text
from .base import Dataset, Recording
from .catalogue import CatalogueEntry, CatalogueFile, catalogue
from .recording_files import DEFAULT_TIME, DEFAULT_X, DEFAULT_Y, write_recording

__all__ = ["catalogue_package", "write_datapackage"]

PROFILE = "https://datapackage.org/profiles/2.0/datapackage.json"
PUBLISHED = "https://raw.githubusercontent.com"
MEDIA_TYPES = {
    "csv": "text/csv", "json": "application/json", "npy": "application/octet-stream", "svg": "image/svg+xml", "txt": "text/plain",
}  # fmt: skip


def write_datapackage(dataset: Dataset, folder: str | os.PathLike[str]) -> Path:
    """Write every recording of ``dataset`` as CSV to ``folder`` and return the path of ``datapackage.json``.

    The same dataset gives the same bytes.

    Raises
    ------
    InputError
        If ``folder`` is a file.
    """
    target = Path(folder)
    if target.exists() and not target.is_dir():
        raise InputError(f"{target} is a file; name a folder")
    resources = []
    for part, recordings in (("train", dataset.train), ("test", dataset.test)):
        for number, recording in enumerate(recordings, start=1):
            resources.append(_write(dataset, recording, target, f"{part}-{number:02d}", part))
    recorded = catalogue().get(dataset.id)
    source = {"title": dataset.source}
    package = {
        "$schema": PROFILE,
        "name": dataset.id,
        "title": dataset.title,
        "description": dataset.split,
        "sources": [source | {"path": url} for url in recorded.urls] if recorded else [source],
        "licenses": [_licence(dataset.licence)],
        "assumptions": list(dataset.assumptions),
        "references": dict(dataset.references),
        "resources": resources,
    }
    path = target / "datapackage.json"
    write_text(path, json.dumps(package, indent=1, ensure_ascii=False) + "\n")
    return path


def catalogue_package() -> dict[str, Any]:
    """The catalogue of recorded data as a data package: every published file with its address, size, checksum and licence."""
    entries = catalogue().values()
    return {
        "$schema": PROFILE,
        "name": "hystbench-recorded-data",
        "title": "Recorded hysteresis data that hystbench knows",
        "description": "Published by their authors, pinned to a commit; `hystbench data fetch` downloads and checks them.",
        "sources": [{"title": entry.citation, "path": url} for entry in entries for url in entry.urls],
        "resources": [_published(entry, file) for entry in entries for file in entry.files],
    }


def _published(entry: CatalogueEntry, file: CatalogueFile) -> dict[str, Any]:
    suffix = Path(file.path).suffix[1:].lower()
    slug = re.sub(r"[^a-z0-9]+", "-", f"{file.repository.split('/')[1]} {file.path}".lower()).strip("-")
    return {
        "name": f"{entry.id}.{slug}",
        "path": f"{PUBLISHED}/{quote(str(file.place))}",
        "title": file.path,
        "format": suffix,
        "mediatype": MEDIA_TYPES.get(suffix, "application/octet-stream"),
        "bytes": file.bytes,
        "hash": f"sha256:{file.sha256}",
        "licenses": [_licence(entry.licence)],
        "sources": [{"title": entry.citation}],
        "dataset": entry.id,
    }


def _write(dataset: Dataset, recording: Recording, folder: Path, stem: str, part: str) -> dict[str, Any]:
    # Deflection and torque get the names that every command expects.
    x_column = DEFAULT_X if dataset.x_unit == "rad" else _column(dataset.x_name, dataset.x_unit)
    y_column = DEFAULT_Y if dataset.y_unit == "N·m" else _column(dataset.y_name, dataset.y_unit)
    columns = {DEFAULT_TIME: recording.time, x_column: recording.x, y_column: recording.y}
    fields: list[dict[str, Any]] = [
        {"name": DEFAULT_TIME, "type": "number", "unit": "s"},
        {"name": x_column, "type": "number", "unit": dataset.x_unit, "title": dataset.x_name},
        {"name": y_column, "type": "number", "unit": dataset.y_unit, "title": dataset.y_name},
    ]
    for name, values in recording.channels.items():
        if name in columns:
            raise InputError(
                f"{dataset.id}, recording {recording.name!r}: a channel is called {name} like a main column; rename it"
            )
        columns[name] = values
        fields.append({"name": name, "type": "number"})
    path = folder / f"{stem}.csv"
    write_recording(path, columns)
    content = path.read_bytes()
    return {
        "name": stem,
        "path": path.name,
        "title": recording.name,
        "format": "csv",
        "mediatype": "text/csv",
        "encoding": "utf-8",
        "bytes": len(content),
        "hash": f"sha256:{hashlib.sha256(content).hexdigest()}",
        "part": part,
        "warm_up_rows": recording.warm_up,
        "conditions": dict(recording.conditions),
        "schema": {"fields": fields},
    }


def _licence(text: str) -> dict[str, str]:
    """A licence descriptor, which must have a name; that of a licence told in words is the SPDX id in them, if any."""
    spdx = re.search(r"\b(CC0|CC-BY|CC-BY-SA|Apache|MIT|BSD|GPL|ODbL)(-[0-9][\w.-]*\w)?(?![\w-])", text)
    name = spdx.group() if spdx else re.sub(r"[^\w.-]+", "-", text, flags=re.ASCII).strip("-") or "unknown"
    return {"name": name, "title": text}


def _column(name: str, unit: str) -> str:
    """A column name such as ``torque_nm`` of a quantity and its unit."""
    spelled = unit.replace("·", "").replace("°", "deg").replace("/", "_per_").replace("%", "percent")
    return re.sub(r"[^0-9a-z]+", "_", f"{name}_{spelled}".lower()).strip("_")
