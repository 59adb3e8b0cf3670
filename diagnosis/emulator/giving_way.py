"""What of the built-in emulator gives way at a level that changes on the way, and is followed sample by sample."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..operators.levels import slid_together, yielding
from .generalised import as_seen, stops_along
from .kinds import KINDS
from .motion import Motion

__all__ = ["given_way", "without_given_way"]

Floats = NDArray[np.float64]


def given_way(parameters: Mapping[str, Any], motion: Motion, gain: Floats) -> Floats:
    """What these elements hold where they have a relative ``gain`` (n,) of their strength at the same stiffness, N·m, shape (n,).

    These are stops, bristles, and further elements of the kinds that say how (:attr:`Kind.yielding`). The gain may change on the
    way: what they held before they had it they still hold.
    """
    motion, level = as_seen(parameters, motion), 1.0 + gain
    thresholds, lengths = np.asarray(parameters["thresholds"]), np.asarray(parameters["lengths"])
    weights = stops_along(parameters, motion.x)
    seen = np.any(weights, axis=0)
    held = motion.from_rest(functools.partial(slid_together, lengths=thresholds[seen]), level, weights[:, seen])
    for length, weight in zip(lengths, np.asarray(parameters["weights"])[thresholds.size :], strict=True):
        if weight:
            held += weight * length * motion.from_rest(yielding, level, length=length)
    for name, elements in parameters.get("further", {}).items():
        own = KINDS[name].yielding
        if own:
            held += own(motion, np.asarray(elements["sizes"]), level) @ elements["weights"]
    return held


def without_given_way(parameters: Mapping[str, Any]) -> dict[str, Any]:
    """The same emulator without what :func:`given_way` is."""
    further = {name: elements for name, elements in parameters.get("further", {}).items() if not KINDS[name].yielding}
    nothing = {name: np.zeros_like(np.asarray(parameters[name], dtype=np.float64)) for name in ("weights", "placed")}
    return dict(parameters) | nothing | {"further": further}
