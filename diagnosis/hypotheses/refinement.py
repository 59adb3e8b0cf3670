"""The shapes of effects' laws moved to their best values, coefficients profiled out.

The residual is a function of the shapes alone: for each of them the best coefficients are found by linear least squares
(variable projection: Golub & Pereyra, Inverse Problems 19, 2003), its slope in Kaufman's approximation (BIT 15, 1975,
49-57), for which a shape's derivative is projected off what the coefficients can make.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..nonlinear import least
from .boxed import RIDGE
from .evidence import Evidence, Hypothesis, Scale, Term, effect_columns, passes_of, spans

__all__ = ["polish", "refine", "refine_anyhow"]

Floats = NDArray[np.float64]
STEP, SHORTEST = 3e-3, 0.02
"""Step along a shape for its slope, over its size, which counts as this share of its range at least."""


def refine(evidence: Evidence, start: Hypothesis, evaluations: int = 10, scales: Sequence[Scale] = ()) -> Hypothesis:
    """Move the shapes of ``start`` to their best values; then choose again among ``scales``, by default all.

    They are moved by samples that are enough for that. ``start`` itself where that is no better.
    """
    return _moved(evidence, evidence.fewer, start, evaluations, scales)


def polish(evidence: Evidence, hypothesis: Hypothesis) -> Hypothesis:
    """The same beside the same simulator, with its shapes at their best on all samples: as precise as their intervals say."""
    if evidence.fewer is evidence:
        return hypothesis
    found = _moved(evidence, evidence, hypothesis, 10, (hypothesis.scale,))
    if found is hypothesis:
        return hypothesis
    return replace(found, by_scale=evidence.fit(found.terms).by_scale, beside_exact=hypothesis.beside_exact)


def _moved(
    evidence: Evidence, by: Evidence, start: Hypothesis, evaluations: int, scales: Sequence[Scale]
) -> Hypothesis:
    """``start`` with its shapes where they are best ``by`` some of the samples; itself where that is no better on all."""
    places = _Places(start.terms)
    if not places.slots:
        return start
    profile = _Profile(by, start, places, by is evidence)
    found, _ = least(
        profile.left, profile.slopes, places.first, places.ends, evaluations, ftol=1e-4, xtol=1e-3,
        x_scale=np.maximum(0.2 * places.range, 1e-12),
    )  # fmt: skip
    better = evidence.fit(places.terms_at(found), scales)
    return better if better.score > start.score else start


def refine_anyhow(evidence: Evidence, terms: Sequence[Term], evaluations: int = 10) -> Hypothesis:
    """Refine beside the likeliest simulator, and where that is a refitted one also beside an exact one.

    A refitted simulator makes up for wrong shapes, so that they would not move to where it is not needed.
    """
    start = evidence.fit(terms)
    best = refine(evidence, start, evaluations)
    if start.scale not in evidence.exact and any(term.shape for term in start.terms):
        beside = max(evidence.exact, key=lambda scale: start.by_scale[scale])
        found = refine(evidence, evidence.fit(terms, (beside,)), evaluations, (beside,))
        best = max(best, evidence.fit(found.terms), key=lambda hypothesis: hypothesis.score)
    return best


class _Places:
    """The shapes of some terms as one vector: those that are lengths, times or speeds by their logarithms."""

    def __init__(self, terms: Sequence[Term]) -> None:
        self._terms = terms
        self.slots = [(i, j) for i, term in enumerate(terms) for j in range(len(term.shape))]
        """Term and shape of each."""
        low = np.array([terms[i].form.limits[j][0] for i, j in self.slots])
        high = np.array([terms[i].form.limits[j][1] for i, j in self.slots])
        self._by_ratio = np.array([terms[i].form.by_ratio[j] for i, j in self.slots], dtype=bool)
        self._signs = np.where(high <= 0.0, -1.0, 1.0)
        low, high = self._encoded(low), self._encoded(high)
        self.ends = np.minimum(low, high), np.maximum(low, high)
        self.range = self.ends[1] - self.ends[0]
        first = self._encoded(np.array([terms[i].shape[j] for i, j in self.slots]))
        self.first = np.clip(first, self.ends[0] + 1e-9, self.ends[1] - 1e-9)

    def _encoded(self, values: Floats) -> Floats:
        return np.where(self._by_ratio, np.log(np.where(self._by_ratio, np.abs(values), 1.0)), values)

    def terms_at(self, values: Floats) -> tuple[Term, ...]:
        """The terms with other shapes."""
        decoded = np.where(self._by_ratio, np.exp(np.where(self._by_ratio, values, 0.0)) * self._signs, values)
        shapes = [list(term.shape) for term in self._terms]
        for (i, j), value in zip(self.slots, decoded, strict=True):
            shapes[i][j] = float(value)
        return tuple(replace(t, shape=tuple(s)) for t, s in zip(self._terms, shapes, strict=True))


class _Profile:
    """What is left as a function of the shapes, over the noise, and its slopes."""

    def __init__(self, evidence: Evidence, start: Hypothesis, places: _Places, by_these: bool) -> None:
        self._evidence, self._scale, self._places = evidence, start.scale, places
        self._sigma = evidence.sigma
        # Where it was fitted by these samples beside this simulator alone, it need not be again.
        known = by_these and not passes_of(evidence.scene, start.terms)
        self._at, self._fitted = places.first if known else np.empty(0), start

    def left(self, values: Floats) -> Floats:
        """Shape (n,), whitened."""
        fitted, evidence = self._fit(values), self._evidence
        inside = evidence.gap_inside - fitted.inside @ fitted.coefficients
        return evidence.whitened(evidence.gap - fitted.signal[evidence.rows], self._scale, inside) / self._sigma

    def slopes(self, values: Floats) -> Floats:
        """Shape (n, shapes)."""
        fitted, evidence = self._fit(values), self._evidence
        scene, rows = evidence.scene, evidence.rows
        guess = fitted.coefficients if passes_of(scene, fitted.terms) else None
        columns = fitted.columns if guess is None else effect_columns(scene, fitted.terms, guess)
        made = self._changes(values, fitted.coefficients, columns, guess)[rows]
        lower, upper = (np.concatenate([getattr(t.form, end) for t in fitted.terms]) for end in ("lower", "upper"))
        free = (fitted.coefficients > lower) & (fitted.coefficients < upper)
        basis = columns[rows][:, free]
        made_inside = evidence.inside(made)
        basis_inside = fitted.inside[:, free] if guess is None else evidence.inside(basis)
        taken = evidence.taken(basis_inside, self._scale)[0]
        gram = basis.T @ basis - taken @ taken.T
        across = basis.T @ made - taken @ evidence.taken(made_inside, self._scale)[0].T
        # What has no torque here, as a limit beyond all torque, has no ridge of its own size.
        size = np.diag(gram)
        ridge = RIDGE * np.diag(np.where(size > 0.0, size, 1.0))
        share = np.linalg.solve(gram + ridge, across)
        left, inside = basis @ share - made, basis_inside @ share - made_inside
        return evidence.whitened(left, self._scale, inside) / self._sigma

    def _changes(self, values: Floats, coefficients: Floats, columns: Floats, guess: Floats | None) -> Floats:
        """Slopes of what the effects add by each shape, their ``coefficients`` held, shape (n, shapes)."""
        scene, places = self._evidence.scene, self._places
        signal, made = columns @ coefficients, np.empty((len(columns), values.size))
        for k, (value, (i, _)) in enumerate(zip(values, places.slots, strict=True)):
            step = STEP * max(abs(value), SHORTEST * places.range[k])
            # Towards the farther limit.
            step = step if 2.0 * value < places.ends[0][k] + places.ends[1][k] else -step
            moved = values.copy()
            moved[k] += step
            terms = places.terms_at(moved)
            if guess is None:
                # The others' columns are the same.
                own = spans(terms)[i]
                change = (effect_columns(scene, terms[i : i + 1]) - columns[:, own]) @ coefficients[own]
            else:
                change = effect_columns(scene, terms, guess) @ coefficients - signal
            made[:, k] = change / step
        return made

    def _fit(self, values: Floats) -> Hypothesis:
        if not np.array_equal(values, self._at):
            self._fitted = self._evidence.fit(self._places.terms_at(values), (self._scale,))
            self._at = values.copy()
        return self._fitted
