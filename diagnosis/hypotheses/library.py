"""The library of laws: what sets of effects are made of, and which further one does best beside a set."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..effects.base import Effect
from .boxed import boxed_least_squares
from .evidence import Evidence, Scale, Term, count_unknowns

__all__ = ["Library", "Scored"]

Floats = NDArray[np.float64]
Scored = tuple[float, tuple[int, ...]]
"""A set of terms by their numbers, with its score."""


class Library:
    """The columns of every effect, law and starting shape, and their products, computed once."""

    def __init__(self, evidence: Evidence, effects: Sequence[Effect]) -> None:
        self.evidence = evidence
        self.spread = evidence.sparse
        """By samples spread over the recording: enough to compare laws and the shapes from which they start."""
        self.terms: list[Term] = []
        self._laws: list[list[int]] = []
        """Numbers of the terms of each law."""
        self._alike: dict[tuple[object, ...], list[int]] = {}
        """Numbers of terms with the same bounds and number of unknowns, whose fits are one batch."""
        self.slices: list[slice] = []
        made: list[Floats] = []
        start = 0
        for effect in effects:
            forms = evidence.forms_of(effect)
            for form in forms:
                numbers = []
                for shape in form.grid:
                    columns = form.columns(evidence.scene, shape)[self.spread.rows]
                    if not np.all(np.isfinite(columns)) or not np.any(columns):
                        continue
                    numbers.append(len(self.terms))
                    self.terms.append(Term(effect, form, shape, len(forms)))
                    self.slices.append(slice(start, start + columns.shape[1]))
                    made.append(columns)
                    start += columns.shape[1]
                if numbers:
                    self._laws.append(numbers)
                    key = (tuple(form.lower), tuple(form.upper), len(form.shapes), form.overdone)
                    self._alike.setdefault(key, []).extend(numbers)
        self.candidates = len(self.terms)
        """How many terms there were before sets grew: what one effect, law and starting shape makes by itself."""
        matrix = np.hstack(made)
        self.sums: Floats = matrix.sum(axis=0)
        """Of each column of these, shape (k,)."""
        self._blocks = [matrix]
        self._gram = matrix.T @ matrix
        self._moment = matrix.T @ self.spread.gap
        self._inside = self.spread.inside(matrix)
        self._taken: dict[Scale, tuple[Floats, Floats, float]] = {}

    def add(self, terms: Sequence[Term]) -> tuple[int, ...]:
        """Take in terms with refined shapes and return their numbers, so that sets can grow from them.

        They are no candidates for extension themselves.
        """
        made: list[Floats] = []
        numbers, start = [], self._moment.size
        for term in terms:
            columns = term.form.columns(self.evidence.scene, term.shape)[self.spread.rows]
            numbers.append(len(self.terms))
            self.terms.append(term)
            self.slices.append(slice(start, start + columns.shape[1]))
            made.append(columns)
            start += columns.shape[1]
        new = np.hstack(made)
        across = np.vstack([block.T @ new for block in self._blocks])
        self._blocks.append(new)
        self._gram = np.block([[self._gram, across], [across.T, new.T @ new]])
        self._moment = np.concatenate([self._moment, new.T @ self.spread.gap])
        self._inside = np.hstack([self._inside, self.spread.inside(new)])
        self._taken.clear()
        return tuple(numbers)

    def close(self) -> None:
        """Let go of the columns, which take most memory; their products stay, and no term can be taken in any more."""
        self._blocks.clear()
        self._taken.clear()

    def moments(self, scale: Scale) -> tuple[Floats, Floats, float]:
        """Whitened Gram matrix, moments and energy at a scale of parameter errors."""
        gram, moment, energy = self.spread.reduced(self._gram, self._moment, self._inside, [scale])
        return gram[0], moment[0], float(energy[0])

    def _taken_at(self, scale: Scale) -> tuple[Floats, Floats, float]:
        """What a refit takes of each column, shape (k, m), and what stays of the moments (k,) and of the energy."""
        if scale not in self._taken:
            of_columns, of_moments, energy = self.spread.taken(self._inside, scale)
            self._taken[scale] = of_columns, self._moment - of_moments, energy
        return self._taken[scale]

    def extend(self, base: Sequence[int], scales: Sequence[Scale], only: str | None = None) -> list[Scored]:
        """The best set made of ``base`` (term numbers) and one more term, for each law of each further effect.

        With ``only``, of that effect. Returns (score, term numbers), in no order.
        """
        base_columns = [c for number in base for c in range(self.slices[number].start, self.slices[number].stop)]
        base_terms = [self.terms[number] for number in base]
        # A special case beside the general effect would only be that effect again.
        taken = {term.effect.id for term in base_terms}.union(*(term.effect.contains for term in base_terms))
        own = {term.effect.id for term in base_terms}
        scores = np.full(len(self.terms), -np.inf)
        for numbers in self._alike.values():
            chosen = [
                k
                for k in numbers
                if self.terms[k].effect.id not in taken
                and not own.intersection(self.terms[k].effect.contains)
                and only in (None, self.terms[k].effect.id)
            ]
            if not chosen:
                continue
            first = self.terms[chosen[0]]
            index = np.array([base_columns + list(range(self.slices[k].start, self.slices[k].stop)) for k in chosen])
            lower = np.array([*(v for t in base_terms for v in t.form.lower), *first.form.lower])
            upper = np.array([*(v for t in base_terms for v in t.form.upper), *first.form.upper])
            unknowns = count_unknowns([*base_terms, first])
            best = np.full(len(chosen), -np.inf)
            gram = self._gram[index[:, :, None], index[:, None, :]]
            for scale in scales:
                of_columns, moment, energy = self._taken_at(scale)
                # Of the whole matrix little is asked for.
                taken_here = of_columns[index]
                left = gram - taken_here @ taken_here.transpose(0, 2, 1)
                _, reduction = boxed_least_squares(left, moment[index], lower, upper)
                rss = np.maximum(energy - reduction, 1e-12 * self.spread.gap_energy)
                best = np.maximum(best, self.spread.score(rss[:, None], [scale], unknowns)[:, 0])
            scores[chosen] = best
        found = []
        for numbers in self._laws:
            k = max(numbers, key=lambda number: scores[number])
            if np.isfinite(scores[k]):
                found.append((float(scores[k]), (*base, k)))
        return found
