"""BibTeX of what was used."""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import cache
from importlib.resources import files
from typing import Any

__all__ = ["bibtex"]


@cache
def _known() -> dict[str, str]:
    """Entries of references.bib by key."""
    text = files(__package__).joinpath("references.bib").read_text(encoding="utf-8")
    entries = re.split(r"\n\n(?=@)", text.strip())
    return {re.match(r"@\w+\{([^,]+),", entry)[1]: entry for entry in entries}  # type: ignore[index]


def bibtex(plugins: Iterable[type[Any]]) -> str:
    """The entries that the classes name in ``references``: keys of references.bib, or whole entries; each once."""
    found: dict[str, None] = {}
    for plugin in plugins:
        for reference in getattr(plugin, "references", ()):
            found[reference if reference.lstrip().startswith("@") else _known()[reference]] = None
    return "\n\n".join(found) + "\n" if found else ""
