"""Which elements an emulator takes in besides those that it has in any case."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from .kind import ELASTIC, Kind
from .kinds import FRICTION_TABLE, KINKS, SPRING_TABLE
from .placing import Choices, Placing
from .selection import CLEARLY, EXACT, WORTHWHILE, Selection, spread

__all__ = ["PLACED", "RATES", "STOPS", "TABLED", "Growth"]

Floats = NDArray[np.float64]
Places = NDArray[np.intp]
STOPS, PLACED, RATES = "stops", "placed", "rates"
"""What there is in any case besides an elastic curve; some of the stops only where they are needed."""
SIMPLE = 3
"""Sizes of an element up to which it is taken in as readily as those that are not moved."""
ROUNDS = 2
"""Kinds of elements with sizes to move that are taken in one after the other, at most."""
TABLED = 0.003
"""Error, as a share of the output, from which tables are tried, and what else follows much that is a law."""
FOLLOWED = 0.001
"""Error, as a share of the output, from which what was placed is moved together."""
WELL_EMULATED = 0.002
"""Error, as a share of the output, from which further kinds are looked for that may need to be there together."""


class Growth:
    """Elements that are needed, of some kinds, beside those that are there in any case.

    Parameters
    ----------
    there : mapping of str to array, shape (n, any)
        ``ELASTIC``, ``STOPS``, ``PLACED`` and ``RATES``.
    few : array of int
        The stops that are there in any case.
    sign : float
        That of the weights of all that has memory.
    kinds : mapping of str to Kind
        Kinds to choose from.
    choices : Choices
        Those of these kinds that are moved, along the input as these elements see it.
    target : array, shape (n,)
        What is to be emulated.
    known : array of bool, shape (n,)
        Where it is.
    """

    def __init__(
        self,
        there: Mapping[str, Floats],
        few: Places,
        sign: float,
        kinds: Mapping[str, Kind],
        choices: Choices,
        target: Floats,
        known: NDArray[np.bool_],
    ) -> None:
        self._few, self._sign, self._kinds = few, sign, kinds
        self._motion, self._target = choices.motion, target
        self._placing = Placing(choices, target, known, sign)
        self._beside = [there[ELASTIC], there[STOPS][:, few], there[RATES]]
        self._some = spread(known)
        self._there = {name: columns[self._some] for name, columns in there.items()}
        self._there[STOPS] = sign * self._there[STOPS]
        self._sizes = {name: kind.sizes(choices.extent) for name, kind in kinds.items() if kind.limits is None}
        self._grid = tuple(name for name in self._sizes if not kinds[name].table)
        self._made = self._sampled(self._grid)

    def needed(self, placing: Collection[str]) -> tuple[bool, dict[str, Floats]]:
        """Whether all of the stops are needed, and the sizes (k, m) of further elements by their kind.

        Of the kinds that are moved to their places those in ``placing`` are tried.
        """
        movable = {
            name: kind for name, kind in self._kinds.items() if kind.limits and name in placing and not kind.table
        }
        # Where the spring has corners, or waves, what is left without them says little of the rest.
        springs = {name: kind for name, kind in movable.items() if kind.part == ELASTIC}
        more = self._placing.placed(springs, np.hstack(self._beside))
        self._take_up(more)
        chosen, _ = self._chosen([KINKS], list(more))
        chosen = {KINKS: np.empty(0, dtype=np.intp)} | {name: at for name, at in chosen.items() if name in self._sizes}
        beside = [*self._beside, *(self._columns(name, at) for name, at in chosen.items() if at.size)]
        needed = [name for name in chosen if name in movable]
        refused: set[str] = set()
        before, (chosen, error) = chosen, self._chosen([STOPS, *self._grid], needed, needed)
        if error < FOLLOWED:
            # What is followed without any needs none that takes long.
            movable = {name: kind for name, kind in movable.items() if kind.width <= SIMPLE and not kind.timed}
        for this in range(ROUNDS):
            rest = {name: kind for name, kind in movable.items() if name not in needed and name not in refused}
            enough = WELL_EMULATED if this else EXACT
            more = self._placing.placed(rest, np.hstack(beside), enough)
            if more:
                self._take_up(more)
                chosen, error = self._chosen([STOPS, *self._grid], [*needed, *more], needed)
            elif this:
                break
            # What some kinds leave may be another's, which hardly helped beside all that.
            new = [
                name
                for name, at in chosen.items()
                if name in self._sizes and not np.isin(at, before.get(name, [])).all()
            ]
            before = chosen
            beside += [self._columns(name, chosen[name]) for name in new]
            needed = [name for name in chosen if name in movable]
            # What is not taken in hides what is nearly as good, and would do so again.
            refused = set() if new else set(more).difference(needed)
            if not new and not refused:
                break
        if error > FOLLOWED:
            chosen, error = self._settled(chosen, error, needed, movable)
            needed = [name for name in chosen if name in movable]
        if error > TABLED and FRICTION_TABLE in placing:
            chosen = self._looked_up(chosen, error, needed)
        finer = chosen[STOPS].size > self._few.size
        return finer, {name: self._sizes[name][at] for name, at in chosen.items() if name in self._sizes}

    def _settled(
        self, chosen: dict[str, Places], error: float, needed: Sequence[str], movable: Mapping[str, Kind]
    ) -> tuple[dict[str, Places], float]:
        """The same with all that is placed moved together: each was placed beside what others then only stood in for."""
        best = chosen, error
        for these, beside in self._alternatives(chosen, error, needed, movable):
            before = self._sizes, self._made
            self._take_up(self._placing.settled(self._kinds, these, np.hstack(beside)))
            growing = [STOPS, *(name for name in self._grid if name != KINKS or set(these) == set(needed))]
            settled, left = self._chosen(growing, list(these), list(these))
            if left < WORTHWHILE * best[1]:
                best = settled, left
            else:
                self._sizes, self._made = before
            if best[1] < FOLLOWED:
                break
        return best

    def _alternatives(
        self, chosen: dict[str, Places], error: float, needed: Sequence[str], movable: Mapping[str, Kind]
    ) -> Iterator[tuple[dict[str, Floats], list[Floats]]]:
        """Elements by their kind, and the columns beside them, from which what was placed may be moved together."""
        springs = {name: kind for name, kind in movable.items() if kind.part == ELASTIC}
        placed = {name: self._sizes[name][chosen[name]] for name in needed}
        # Many of one kind were moved together already.
        rubbing = {name: sizes for name, sizes in placed.items() if name not in springs and not movable[name].many}
        # Stops stand in for sliders that are not there yet; where all are, they only blur where these are.
        bare = self._beside[::2]
        if rubbing:
            columns = {n: self._columns(n, chosen[n]) for n in self._grid if n in chosen and chosen[n].size}
            unkinked = [own for name, own in columns.items() if name != KINKS]
            moved = self._along(rubbing)
            for simple in (self._beside, bare):
                yield placed, [*simple, *columns.values()]
                others = [*simple, *unkinked]
                more = self._best_of(springs, [*others, *moved])
                if more:
                    yield rubbing | more, others
        # And beside stops that follow nearly all of it a slider that follows all is not found.
        for name, kind in movable.items() if error > WELL_EMULATED else ():
            if kind.alone:
                first = self._placing.placed({name: kind}, np.hstack(bare))
                if first:
                    yield first | self._best_of(springs, [*bare, *self._along(first)]), bare

    def _best_of(self, kinds: Mapping[str, Kind], beside: Sequence[Floats]) -> dict[str, Floats]:
        """Sizes of that one of these kinds that emulates best beside these columns, if any helps."""
        found = self._placing.placed(kinds, np.hstack(beside))
        return dict(list(found.items())[-1:])

    def _along(self, placed: Mapping[str, Floats]) -> list[Floats]:
        """Columns of elements by their kind, shapes (n, any)."""
        return [self._kinds[name].columns(self._motion, sizes) for name, sizes in placed.items()]

    def _looked_up(self, chosen: dict[str, Places], error: float, needed: Sequence[str]) -> dict[str, Places]:
        """The same with a spring from a table, and friction from one, in place of kinks, where that is clearly better."""
        spring = np.arange(len(self._sizes[SPRING_TABLE]))
        others = (name for name in chosen if name in self._sizes and name != KINKS and chosen[name].size)
        beside = [
            *self._beside,
            *(self._columns(name, chosen[name]) for name in others),
            self._columns(SPRING_TABLE, spring),
        ]
        more = self._placing.placed({FRICTION_TABLE: self._kinds[FRICTION_TABLE]}, np.hstack(beside))
        self._take_up(more | {SPRING_TABLE: self._sizes[SPRING_TABLE]})
        growing = [STOPS, *(name for name in self._grid if name != KINKS)]
        for tables in [[SPRING_TABLE], *([[SPRING_TABLE, *more]] if more else [])]:
            with_tables, left = self._chosen(growing, [*needed, *tables], [*needed, *tables])
            if left < CLEARLY * error:
                chosen, error = with_tables, left
        return chosen

    def _take_up(self, more: Mapping[str, Floats]) -> None:
        """Further elements to choose from, by their kind."""
        self._sizes = {**self._sizes, **more}
        self._made = {**self._made, **self._sampled(more)}

    def _columns(self, name: str, which: Places) -> Floats:
        return self._kinds[name].columns(self._motion, self._sizes[name][which])

    def _sampled(self, names: Collection[str]) -> dict[str, Floats]:
        """All elements of these kinds on the samples by which is chosen; what has memory turned to a positive weight."""
        return {
            name: (self._sign if self._kinds[name].one_sign else 1.0)
            * self._kinds[name].columns(self._motion, self._sizes[name])[self._some]
            for name in names
        }

    def _chosen(
        self, growing: Sequence[str], moved: Collection[str] = (), needed: Collection[str] = ()
    ) -> tuple[dict[str, Places], float]:
        """Elements that are needed of the kinds ``growing`` and of those ``moved``, of which some are ``needed`` in any case.

        And the error that they leave, as a share of the output.
        """
        kept = [name for name in self._sizes if name in moved or name in growing]
        of_one_sign = [STOPS, *(name for name in kept if self._kinds[name].one_sign)]
        offered = self._there | {name: self._made[name] for name in kept}
        selection = Selection(offered, self._target[self._some], of_one_sign)
        places = selection.places
        base = {STOPS: places[STOPS][self._few]} | {name: places[name] for name in (ELASTIC, PLACED, RATES, *needed)}
        chosen = selection.grow(base, growing, [KINKS])
        left = selection.error(chosen)
        for name in (name for name in moved if name not in needed):
            with_moved = selection.grow(base | {name: places[name]}, growing, [KINKS])
            # Sliders with mass also round corners that have nothing to do with mass.
            enough = CLEARLY if self._kinds[name].width > SIMPLE else WORTHWHILE
            left_with = selection.error(with_moved)
            if left_with < enough * left:
                chosen, left = with_moved, left_with
        return {name: at - places[name][0] for name, at in chosen.items()}, left / selection.size
