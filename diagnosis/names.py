"""What a verdict may name besides effects, the effect that is hard to tell from it, and how several are named."""

from collections.abc import Sequence

__all__ = ["GAIN", "MISCALIBRATION", "UNKNOWN", "enumerated"]

MISCALIBRATION, UNKNOWN = "miscalibration", "unknown"
GAIN = "torque_gain"


def enumerated(names: Sequence[str]) -> str:
    """One or more names in a sentence: a, b and c."""
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
