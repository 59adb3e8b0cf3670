"""What of the built-in emulator gives way at a level that changes on the way, and is followed sample by sample."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..operators.levels import slid_together, yielding
from .generalised import as_seen, stops_along
from .kinds import KINDS
from .motion import Motion

__all__ = ["GivingWay", "without_given_way"]

Floats = NDArray[np.float64]


class GivingWay:
    """Elements that give way at a level which may change on the way, along one motion.

    These are stops, bristles, and further elements of the kinds that say how (:attr:`Kind.yielding`).
    """

    def __init__(self, parameters: Mapping[str, Any], motion: Motion) -> None:
        self._motion = as_seen(parameters, motion)
        thresholds, weights = np.asarray(parameters["thresholds"]), stops_along(parameters, motion.x)
        seen = np.any(weights, axis=0)
        # A search asks for many levels along the one motion.
        self._thresholds, self._weights = thresholds[seen], self._motion.along(weights[:, seen])
        bristles = np.asarray(parameters["weights"])[thresholds.size :]
        self._bristles = [each for each in zip(np.asarray(parameters["lengths"]), bristles, strict=True) if each[1]]
        self._further = [
            (own, np.asarray(elements["sizes"]), np.asarray(elements["weights"]))
            for name, elements in parameters.get("further", {}).items()
            if (own := KINDS[name].yielding)
        ]
        self._usual = self._held(np.ones(motion.x.size))

    def change(self, gain: Floats) -> Floats:
        """Change of what they hold for a relative ``gain`` (n,) of their strength at the same stiffness, N·m, shape (n,).

        What they held before they had it they still hold.
        """
        return self._held(1.0 + gain) - self._usual

    def _held(self, level: Floats) -> Floats:
        motion = self._motion
        runs = zip(motion.ways, motion.along(level), self._weights, strict=True)
        held = np.concatenate([slid_together(way, at, weights, self._thresholds)[1:] for way, at, weights in runs])
        for length, weight in self._bristles:
            held += weight * length * motion.from_rest(yielding, level, length=length)
        for own, sizes, weights in self._further:
            held += own(motion, sizes, level) @ weights
        return held


def without_given_way(parameters: Mapping[str, Any]) -> dict[str, Any]:
    """The same emulator without the elements of :class:`GivingWay`."""
    further = {name: elements for name, elements in parameters.get("further", {}).items() if not KINDS[name].yielding}
    nothing = {name: np.zeros_like(np.asarray(parameters[name], dtype=np.float64)) for name in ("weights", "placed")}
    return dict(parameters) | nothing | {"further": further}
