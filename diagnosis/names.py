"""What a verdict may name besides effects, the effects that are hard to tell from it, and how several are named."""

from __future__ import annotations

from collections.abc import Sequence

from . import registry

__all__ = ["GAIN", "MISCALIBRATION", "OFFSET", "UNKNOWN", "enumerated", "spoken"]

MISCALIBRATION, UNKNOWN = "miscalibration", "unknown"
GAIN, OFFSET = "torque_gain", "torque_offset"


def enumerated(names: Sequence[str]) -> str:
    """One or more names in a sentence: a, b and c."""
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"


def spoken(name: str) -> str:
    """An effect's title, or the id of something else (a coordinate, ``miscalibration``) without underscores."""
    return str(registry.get(name).title) if name in registry.ids() else name.replace("_", " ")
