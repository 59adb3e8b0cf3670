"""The recorded datasets that the product knows: where each file is published, its size, SHA-256 and licence."""

from __future__ import annotations

import difflib
import json
import re
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import PurePosixPath
from typing import Any

from ..errors import InputError

__all__ = ["CatalogueEntry", "CatalogueFile", "catalogue", "entry", "parse"]

SCHEMA = "hystbench/catalogue/1"


@dataclass(frozen=True)
class CatalogueFile:
    """One published file, pinned to a commit.

    Attributes
    ----------
    repository : str
        ``owner/name`` on GitHub.
    commit : str
        40 hexadecimal digits.
    path : str
        Path in the repository.
    bytes : int
    sha256 : str
        64 hexadecimal digits.
    """

    repository: str
    commit: str
    path: str
    bytes: int
    sha256: str

    @property
    def place(self) -> PurePosixPath:
        """Where the file lies under the data folder: ``<owner>/<repo>/<commit>/<path>``."""
        return PurePosixPath(self.repository, self.commit, self.path)


@dataclass(frozen=True)
class CatalogueEntry:
    """A dataset: its files, licence (SPDX) and how to cite it."""

    id: str
    title: str
    licence: str
    citation: str
    files: tuple[CatalogueFile, ...]

    @property
    def share_alike(self) -> bool:
        """Whether what is derived from the data must carry the same licence: users must know before they fetch."""
        return "-SA-" in f"{self.licence}-"

    @property
    def bytes(self) -> int:
        """Size of all files together."""
        return sum(file.bytes for file in self.files)

    @property
    def published(self) -> dict[str, CatalogueFile]:
        """Files by their path in the repository, with the repository before it where two repositories share it."""
        count = Counter(file.path for file in self.files)
        return {file.path if count[file.path] == 1 else f"{file.repository}/{file.path}": file for file in self.files}

    @property
    def urls(self) -> list[str]:
        """Web pages of the repositories at the pinned commits."""
        return list(dict.fromkeys(f"https://github.com/{file.repository}/tree/{file.commit}" for file in self.files))


@cache
def catalogue() -> dict[str, CatalogueEntry]:
    """All entries by id, in their documented order."""
    return parse(json.loads(files(__package__).joinpath("catalogue.json").read_text(encoding="utf-8")))


def parse(document: Mapping[str, Any]) -> dict[str, CatalogueEntry]:
    """Entries of a catalogue document.

    Raises
    ------
    InputError
        If it is no catalogue, or a file's place could leave the data folder or its checksum is malformed.
    """
    if document.get("schema") != SCHEMA:
        raise InputError(f"not a catalogue: its schema is {document.get('schema')!r}, not {SCHEMA!r}")
    entries: dict[str, CatalogueEntry] = {}
    for number, item in enumerate(document.get("datasets", []), start=1):
        try:
            found = tuple(CatalogueFile(**file) for file in item["files"])
            new = CatalogueEntry(item["id"], item["title"], item["licence"], item["citation"], found)
        except (KeyError, TypeError) as error:
            raise InputError(
                f"catalogue entry {number}: a field is missing, unknown or of the wrong kind ({error})"
            ) from None
        if new.id in entries:
            raise InputError(f"catalogue entry {number}: the id {new.id!r} is taken by an earlier entry")
        for file in found:
            _check(new.id, file)
        if len({str(file.place).casefold() for file in found}) < len(found):
            raise InputError(f"catalogue entry {new.id}: two of its files have the same place")
        entries[new.id] = new
    return entries


def _check(name: str, file: CatalogueFile) -> None:
    if not all(isinstance(text, str) for text in (file.repository, file.commit, file.path, file.sha256)):
        raise InputError(f"catalogue entry {name}: repository, commit, path and sha256 of a file must be text")
    if type(file.bytes) is not int or file.bytes <= 0:
        raise InputError(f"catalogue entry {name}: {file.path}: bytes must be a positive whole number")
    parts = file.path.split("/")
    harmless = (
        re.fullmatch(r"[\w.-]+/[\w.-]+", file.repository)
        and re.fullmatch(r"[0-9a-f]{40}", file.commit)
        and re.fullmatch(r"[0-9a-f]{64}", file.sha256)
        and not {"", ".", ".."} & {*parts, *file.repository.split("/")}
        # A backslash is a folder and a colon a drive or a stream on Windows; control characters are never meant.
        and not re.search(r"[\x00-\x1f\\:]", file.path)
    )
    if not harmless:
        raise InputError(f"catalogue entry {name}: {file.repository}/{file.path} is not a place inside the data folder")


def entry(name: str) -> CatalogueEntry:
    """The entry called ``name``.

    Raises
    ------
    InputError
        If there is none; the message names the nearest one.
    """
    known = catalogue()
    if name in known:
        return known[name]
    nearest = difflib.get_close_matches(name, known, n=1, cutoff=0.0)
    raise InputError(f"no recorded dataset {name!r}; did you mean {nearest[0]!r}? Known: {', '.join(known)}.")
