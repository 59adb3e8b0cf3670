"""Further elements of the emulator: for simulators that stops, bristles, a polynomial and rates do not emulate."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..recording.noise import rms
from .kind import ELASTIC, MEMORY, RATE, Kind
from .kinds import KINDS
from .motion import Motion

__all__ = [
    "Further",
    "drag_among",
    "kinks_moved",
    "strengthened_among",
    "tangents",
    "torque_of",
    "uncancelled",
]

Floats = NDArray[np.float64]
Further = Mapping[str, Mapping[str, Any]]
"""By kind: ``sizes`` (k, m) and ``weights`` (k,) of its elements."""
DRY = 0.3
"""Speed, over its standard deviation, at which friction by speed saturates at the latest."""
MOVED = 0.04
"""Relative error of where a kink is or a slider yields."""


def torque_of(further: Further, motion: Motion, part: str | None = None, dragging: bool = True) -> Floats:
    """Torque of further elements, N·m, shape (n,): of those that are ``part`` of the simulator, or without those that drag."""
    return _total(further, motion, lambda kind: part in (None, kind.part) and (dragging or not kind.drags))


def drag_among(further: Further, motion: Motion) -> Floats:
    """Torque of those that follow the speed alone, N·m, shape (n,)."""
    return _total(further, motion, lambda kind: kind.drags)


def _total(further: Further, motion: Motion, counts: Callable[[Kind], bool]) -> Floats:
    total = np.zeros(motion.x.size)
    for kind, sizes, weights in _made(further):
        if counts(kind):
            total += kind.torque(motion, sizes, weights)
    return total


def strengthened_among(further: Further, gain: float, fast: float) -> Further:
    """Further elements whose friction has a relative ``gain`` of its strength at the same stiffness.

    ``fast`` is the standard deviation of the speed, rad/s.
    """
    made = {}
    for name, elements in further.items():
        kind, sizes, weights = KINDS[name], np.array(elements["sizes"]), np.array(elements["weights"])
        if kind.part == MEMORY:
            sizes = _scaled(sizes, (0,), 1.0 + gain)
        elif kind.part == RATE and kind.by_speed:
            # Friction that knows the speed alone has no stiffness; what grows up to the usual speeds is a damper.
            weights = weights * np.where(sizes[:, 0] < DRY * fast, 1.0 + gain, 1.0)
        made[name] = {"sizes": sizes, "weights": weights}
    return made


def tangents(further: Further, motion: Motion) -> tuple[Floats, Floats]:
    """Changes for a relative error of one of some parameter, shapes (n, any): of the fine structure and of the bulk."""
    nothing = np.empty((motion.x.size, 0))
    fine, bulk = [nothing], [nothing]
    for kind, sizes, weights in _made(further):
        torque = _of_table(kind, motion, sizes, weights) if kind.table else kind.columns(motion, sizes) * weights
        if kind.limits:
            # Each of these stands for one of the simulator's own, and its sizes for that one's parameters. A slider yields
            # at a quotient of two of them, which may be off by twice as much.
            bulk.append(torque)
            for at in np.setdiff1d(np.arange(kind.width), kind.exact).tolist():
                if at in kind.shared:
                    bulk.append((_stretched(kind, motion, sizes, (at,)) @ weights)[:, None])
                elif at in kind.corners:
                    bulk += _either_way(kind, motion, sizes, weights, at, MOVED, 2.0 * MOVED)
                else:
                    bulk.append(_stretched(kind, motion, sizes, (at,)) * weights)
        elif kind.one_sign:
            fine += [torque, _stretched(kind, motion, sizes) * weights]
        elif kind.table:
            bulk.append(torque)
        elif kind.part == ELASTIC:
            bulk += [torque, *_either_way(kind, motion, sizes, weights, 0, MOVED)]
        else:
            # Elements that differ in one size only are one parameter.
            _, group = np.unique(sizes[:, 1:] if sizes.shape[1] > 1 else sizes, axis=0, return_inverse=True)
            bulk.append(uncancelled(torque @ np.eye(group.max() + 1)[group.ravel()]))
            bulk.append((_stretched(kind, motion, sizes) @ weights)[:, None])
    return np.hstack(fine), np.hstack(bulk)


def kinks_moved(motion: Motion, sizes: Floats, weights: Floats) -> Floats:
    """Change of the torque of each kink when its place moves on by one radian, N·m, shape (n, k)."""
    beyond = np.where(sizes[:, 0] > 0.0, motion.x[:, None] > sizes[:, 0], motion.x[:, None] < sizes[:, 0])
    return np.asarray(beyond * -weights)


def uncancelled(columns: Floats) -> Floats:
    """Columns (n, k) of which none is larger than their sum: what cancels is no parameter of the simulator."""
    whole = rms(columns.sum(axis=1))
    sizes = np.sqrt(np.mean(np.square(columns), axis=0))
    return columns * np.minimum(1.0, whole / np.maximum(sizes, 1e-300))


def _made(further: Further) -> Iterator[tuple[Kind, Floats, Floats]]:
    for name, elements in further.items():
        yield KINDS[name], np.asarray(elements["sizes"], dtype=np.float64), np.asarray(elements["weights"])


def _of_table(kind: Kind, motion: Motion, sizes: Floats, weights: Floats) -> Floats:
    """Changes where a table as a whole is off: in its values, in its places, and of friction in the law that its values are made by.

    Shape (n, any).
    """
    torque = kind.torque(motion, sizes, weights)
    spread_out = _stretched(kind, motion, sizes, kind.table) @ weights
    place = motion.x / max(float(np.max(np.abs(motion.x))), 1e-300)
    # Where a spring's law is off is told by the curve that is there in any case.
    powers = range(1 if kind.part == ELASTIC else 3)
    return np.column_stack([spread_out, *(torque * place**power for power in powers)])


def _stretched(kind: Kind, motion: Motion, sizes: Floats, at: Sequence[int] = (0,)) -> Floats:
    """Change of each element for a relative change by one of its sizes ``at``, shape (n, k)."""
    up, down = (kind.columns(motion, _scaled(sizes, at, scale)) for scale in (1.05, 0.95))
    return np.asarray((up - down) / 0.1)


def _either_way(kind: Kind, motion: Motion, sizes: Floats, weights: Floats, at: int, *errors: float) -> list[Floats]:
    """The same for errors up and down: where a corner moves it leaves a ramp, each way its own."""
    here = kind.columns(motion, sizes)
    ways = [way * error for error in errors for way in (1.0, -1.0)]
    return [(kind.columns(motion, _scaled(sizes, (at,), 1.0 + way)) - here) * weights / way for way in ways]


def _scaled(sizes: Floats, at: Sequence[int], scale: float) -> Floats:
    return np.asarray(sizes * np.where(np.isin(np.arange(sizes.shape[1]), at), scale, 1.0))
