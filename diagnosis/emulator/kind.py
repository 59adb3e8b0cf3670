"""What a kind of element is: its columns, the sizes to choose from, and how these are found."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from .motion import Extent, Motion

__all__ = [
    "ELASTIC",
    "MEMORY",
    "RATE",
    "Kind",
    "at_level",
    "by_row",
    "timed_by",
    "timeless",
    "timeless_at_level",
    "with_each",
]

Floats = NDArray[np.float64]
ELASTIC, MEMORY, RATE = "elastic", "memory", "rate"


@dataclass(frozen=True)
class Kind:
    """One kind of element.

    Attributes
    ----------
    part : str
        ``ELASTIC``, ``MEMORY`` or ``RATE``: what of the simulator it belongs to.
    one_sign : bool
        Whether all weights have the sign of the simulator's other elements with memory.
    sizes : callable
        ``sizes(extent) -> (k, m)`` of the elements to choose from; of those with memory the first is a length, rad.
    columns : callable
        ``columns(motion, sizes) -> (n, k)``, the torque of each for a weight of one.
    between : mapping of int to (float, float)
        Between which values, themselves left out, a size must lie, by its place; none is negative but those ``signed``.
    timed : bool
        Whether it is left out where a recording has no clock. Speed is there in any case: it tells the direction.
    together : callable, optional
        ``together(motion, sizes, weights) -> (n,)``, the torque of all, where that takes less than to make each.
    yielding : callable, optional
        ``yielding(motion, sizes, level) -> (n, k)``, the columns where each gives way at ``level`` (n,) times its own, which may change on
        the way, at the same stiffness. Others are taken to be where they would be had that been their level all along.
    limits : callable, optional
        ``limits(extent) -> (2, m)``, positive but those ``signed``, between which sizes are moved to their best places from those to choose
        from, which are not fine enough to be taken as they are.
    later : sequence of int
        Which sizes stay where they are until all elements are there: with all at once the way there is easily lost.
    corners : sequence of int
        Which sizes tell where the torque has corners.
    exact : sequence of int
        Which sizes no simulator has wrong, such as how many teeth there are.
    signed : sequence of int
        Which sizes may be negative: places.
    shared : sequence of int
        Which sizes are the same for all elements.
    by_speed : bool
        Whether it knows the speed, sharply enough to tell how that was made of the deflection.
    all_along : bool
        Whether it changes on the way as well, and not only by where the motion turns.
    last : bool
        Whether it resembles so many others, by few sizes, that it is asked last: they would not be clearly better.
    like : str
        A kind of which it is a variant, which is not tried where that one does not help at all.
    table : sequence of int
        Where its elements are the nodes of one table: which sizes are their places and the interval between them, which stay.
    evident : bool
        Whether, where there is one, those to choose from help much before they are moved, with the sign that they must have.
    many : bool
        Whether all are begun at once, those to choose from that help most together: each of many helps little.
    alone : bool
        Whether its elements may be all the friction there is: they are also looked for where no stops stand in for them.
    pairs : bool
        Whether they are also begun two at a time.
    starts : int
        At how many of those to choose from each is begun: what swings is easily begun beside its place.
    """

    part: str
    one_sign: bool
    sizes: Callable[[Extent], Floats]
    columns: Callable[[Motion, Floats], Floats]
    between: Mapping[int, tuple[float, float]] = field(default_factory=dict)
    timed: bool = False
    together: Callable[[Motion, Floats, Floats], Floats] | None = None
    yielding: Callable[[Motion, Floats, Floats], Floats] | None = None
    limits: Callable[[Extent], Floats] | None = None
    later: Sequence[int] = ()
    corners: Sequence[int] = (0,)
    exact: Sequence[int] = ()
    signed: Sequence[int] = ()
    shared: Sequence[int] = ()
    by_speed: bool = False
    all_along: bool = False
    last: bool = False
    like: str = ""
    evident: bool = False
    table: Sequence[int] = ()
    many: bool = False
    alone: bool = False
    pairs: bool = False
    starts: int = 2

    def torque(self, motion: Motion, sizes: Floats, weights: Floats) -> Floats:
        """Torque of all elements of these sizes and weights, N·m, shape (n,)."""
        return self.together(motion, sizes, weights) if self.together else self.columns(motion, sizes) @ weights

    @property
    def drags(self) -> bool:
        """Whether it follows the speed alone, as dampers and friction by speed do."""
        return self.part == RATE and (self.timed or self.by_speed)

    @cached_property
    def width(self) -> int:
        """How many sizes an element has."""
        return int(self.sizes(Extent(1.0, 1.0, 0.01, 1.0)).shape[1])


def by_row(column: Callable[..., Floats]) -> Callable[[Motion, Floats], Floats]:
    """Columns made one by one, each from its sizes."""

    def columns(motion: Motion, sizes: Floats) -> Floats:
        made = [column(motion, *row) for row in sizes]
        # Mostly one is asked for at a time.
        return made[0][:, None] if len(made) == 1 else np.column_stack(made)

    return columns


def timeless(answer: Callable[..., Floats]) -> Callable[[Motion, Floats], Floats]:
    """Columns of what an operator of given sizes answers to the deflection alone."""
    return by_row(lambda motion, *sizes: motion.from_rest(lambda x: answer(x, *sizes)))


def timed_by(answer: Callable[..., Floats]) -> Callable[[Motion, Floats], Floats]:
    """The same of one that knows the time as well."""
    return by_row(lambda motion, *sizes: motion.from_rest(lambda x, time: answer(time, x, *sizes), motion.time))


def at_level(column: Callable[..., Floats]) -> Callable[[Motion, Floats, Floats], Floats]:
    """Columns of elements that give way at a level, made one by one, each from its sizes and ``level`` (n,)."""
    return lambda motion, sizes, level: np.column_stack([column(motion, *row, level=level) for row in sizes])


def timeless_at_level(answer: Callable[..., Floats]) -> Callable[[Motion, Floats, Floats], Floats]:
    """The same of what an operator of given sizes answers to the deflection and its level alone."""
    return at_level(
        lambda motion, *sizes, level: motion.from_rest(lambda x, level: answer(x, *sizes, level=level), level)
    )


def with_each(lengths: Floats, *others: tuple[float, ...]) -> Floats:
    """Each length with each of the other sizes, shape (k, m)."""
    return np.array([(length, *other) for length in lengths for other in others])
