"""What recorded datasets are known to contain, from how their experiments were made."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

__all__ = ["KNOWN_CAUSES", "KnownCause", "known_cause"]


@dataclass(frozen=True)
class KnownCause:
    """What every model that cannot make it lacks on a dataset.

    Attributes
    ----------
    effects : frozenset of str
        Ids of effects any of which states the cause.
    models : frozenset of str
        Ids of the models that are known to lack it. Of the others it is not known what they lack.
    reason : str
        Why this is known, in one or two sentences for people.
    """

    effects: frozenset[str]
    models: frozenset[str]
    reason: str

    def agrees(self, verdict: list[str]) -> bool:
        """Whether a verdict names the cause; further effects may stand beside it."""
        return not self.effects.isdisjoint(verdict)


# With memory but without rate; a model without memory lacks friction of any kind first.
_RATE_INDEPENDENT = frozenset({
    "bouc-wen", "choi-backlash", "maxwell-slip", "modified-prandtl-ishlinskii", "prandtl-ishlinskii", "preisach",
})  # fmt: skip
_MEMORYLESS = frozenset({"cubic", "elastic", "linear"})

KNOWN_CAUSES: Mapping[str, KnownCause] = MappingProxyType({
    "mr-damper": KnownCause(
        frozenset({"viscous_friction"}),
        _RATE_INDEPENDENT,
        "The same damper was driven at 0.1 to 5 Hz at one current; its fluid flows through a gap, so the force grows with "
        "speed, which no model of the displacement alone follows.",
    ),
    "pneumatic-seal": KnownCause(
        frozenset({"load_dependent_friction"}),
        _RATE_INDEPENDENT | _MEMORYLESS | {"dahl", "lugre", "generalized-maxwell-slip", "duhem"},
        "Only the chamber pressure, the normal load on the seal, was varied between the recordings: 5.1, 8.9, 11.7 and "
        "15.0 N of friction at 1, 3, 5 and 7 bar. The models see the displacement alone.",
    ),
    "friction-backlash-damper": KnownCause(
        frozenset({"backlash"}),
        frozenset({"dahl", "lugre", "bouc-wen"}),
        "The device has a clearance that its makers describe and model apart from friction; friction models have none.",
    ),
    "cycloidal": KnownCause(
        frozenset({"backlash"}),
        frozenset({"dahl", "lugre", "bouc-wen"}),
        "The drive's play was measured apart, 0.7 to 2.3 degrees by state of wear and preload, and the torque goes "
        "through zero within it.",
    ),
})  # fmt: skip


def known_cause(model: Any, dataset: str) -> KnownCause | None:
    """What ``model`` (fitted or a class) is known to lack on a dataset; None where that is not known."""
    cause = KNOWN_CAUSES.get(dataset)
    return cause if cause is not None and getattr(model, "id", None) in cause.models else None
