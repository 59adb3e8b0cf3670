"""The search for sets of one, two and three effects."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .effects.base import Effect
from .evidence import SCALES, Evidence, Hypothesis, Scale, Term, boxed_least_squares, count_unknowns

__all__ = ["Library", "search"]

Floats = NDArray[np.float64]


class Library:
    """The columns of every effect, law and starting shape, and their products, computed once."""

    def __init__(self, evidence: Evidence, effects: Sequence[Effect]) -> None:
        self.evidence = evidence
        self.terms: list[Term] = []
        self.groups: list[tuple[str, list[int]]] = []
        """Terms of one law, which have the same number of columns and bounds: (effect id, term numbers)."""
        self.slices: list[slice] = []
        made: list[Floats] = []
        start = 0
        for effect in effects:
            for form in effect.forms(evidence.scene):
                numbers = []
                for shape in form.grid:
                    columns = form.columns(evidence.scene, shape)[evidence.rows]
                    if not np.all(np.isfinite(columns)) or not np.any(columns):
                        continue
                    numbers.append(len(self.terms))
                    self.terms.append(Term(effect, form, shape))
                    self.slices.append(slice(start, start + columns.shape[1]))
                    made.append(columns)
                    start += columns.shape[1]
                if numbers:
                    self.groups.append((effect.id, numbers))
        matrix = np.hstack(made)
        self._gram = matrix.T @ matrix
        self._moment = matrix.T @ evidence.gap
        self._inside = evidence.inside(matrix)
        self._by_scale: dict[Scale, tuple[Floats, Floats, float]] = {}

    def moments(self, scale: Scale) -> tuple[Floats, Floats, float]:
        """Whitened Gram matrix, moments and energy at a scale of parameter errors."""
        if scale not in self._by_scale:
            e = self.evidence
            self._by_scale[scale] = e.reduced(self._gram, self._moment, e.gap_energy, self._inside, scale)
        return self._by_scale[scale]

    def extend(self, base: Sequence[int], skip: frozenset[str] = frozenset()) -> dict[str, list[tuple[float, tuple[int, ...]]]]:
        """The best sets made of ``base`` (term numbers) and one more term, by the id of the effect added.

        Each list holds (score, term numbers), one for each law of the effect, best first.
        """
        found: dict[str, list[tuple[float, tuple[int, ...]]]] = {}
        base_columns = [c for number in base for c in range(self.slices[number].start, self.slices[number].stop)]
        base_terms = [self.terms[number] for number in base]
        for name, numbers in self.groups:
            if name in skip or any(term.effect.id == name for term in base_terms):
                continue
            width = self.slices[numbers[0]].stop - self.slices[numbers[0]].start
            index = np.array([base_columns + list(range(self.slices[k].start, self.slices[k].stop)) for k in numbers])
            form = self.terms[numbers[0]].form
            lower = np.array([*(v for t in base_terms for v in t.form.lower), *form.lower])
            upper = np.array([*(v for t in base_terms for v in t.form.upper), *form.upper])
            assert index.shape[1] == lower.size == len(base_columns) + width
            unknowns = count_unknowns([*base_terms, self.terms[numbers[0]]])
            best = np.full(len(numbers), -np.inf)
            for scale in SCALES:
                gram, moment, energy = self.moments(scale)
                _, reduction = boxed_least_squares(gram[index[:, :, None], index[:, None, :]], moment[index], lower, upper)
                rss = np.maximum(energy - reduction, 1e-12 * self.evidence.gap_energy)
                best = np.maximum(best, self.evidence.score(rss, scale, unknowns))
            k = int(np.argmax(best))
            found.setdefault(name, []).append((float(best[k]), (*base, numbers[k])))
        for candidates in found.values():
            candidates.sort(key=lambda item: -item[0])
        return found


def search(library: Library, wide: int = 7, most: int = 3) -> list[Hypothesis]:
    """Fitted hypotheses, the empty one first, then by number of effects and evidence.

    Every effect is fitted alone; the best ``wide`` of them are extended by every other effect, the best pairs again,
    up to ``most`` effects. The candidates of each size are refined with their shapes free.
    """
    evidence = library.evidence
    found = [evidence.fit(())]
    beam: list[tuple[int, ...]] = [()]
    for size in range(1, most + 1):
        sets: dict[frozenset[str], tuple[float, tuple[int, ...]]] = {}
        for base in beam:
            for candidates in library.extend(base).values():
                for score, numbers in candidates[: 2 if size == 1 else 1]:
                    names = frozenset(library.terms[k].effect.id for k in numbers)
                    if size == 1:
                        names = names | {library.terms[numbers[0]].form.name}
                    if names not in sets or score > sets[names][0]:
                        sets[names] = (score, numbers)
        ranked = sorted(sets.values(), key=lambda item: -item[0])
        count = wide if size > 1 else 2 * wide
        refined: dict[frozenset[str], tuple[Hypothesis, tuple[int, ...]]] = {}
        for _, numbers in ranked[:count]:
            fitted = evidence.refine(evidence.fit([library.terms[k] for k in numbers]))
            known = refined.get(fitted.names)
            if known is None or fitted.score > known[0].score:
                refined[fitted.names] = (fitted, numbers)
        if size == 1:
            # Every effect is reported on, also those that are far from the best.
            for _, numbers in ranked[count:]:
                fitted = evidence.fit([library.terms[k] for k in numbers])
                if fitted.names not in refined or fitted.score > refined[fitted.names][0].score:
                    refined[fitted.names] = (fitted, numbers)
        ordered = sorted(refined.values(), key=lambda item: -item[0].score)
        found += [fitted for fitted, _ in ordered]
        beam = [numbers for _, numbers in ordered[:wide]]
    return found
