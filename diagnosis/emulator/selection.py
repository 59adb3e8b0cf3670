"""Which elements an emulator needs: those that tell blocks of a recording from the others much better."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import nnls

from ...models.least_squares import blocks, reduced
from .kinds import ELASTIC

__all__ = ["CLEARLY", "EXACT", "WORTHWHILE", "Selection", "places_of", "solve", "spread"]

Floats = NDArray[np.float64]
Places = NDArray[np.intp]
SPRING, FREE, BIAS = 1e-7, 1e-4, 1e-5
"""Strength of the ridge on elastic columns, on the other free ones, and on those of one sign."""
FOLDS, BLOCKS = 4, 20
"""Parts of a recording that are told from the others, and the blocks that it is cut into for them."""
ENOUGH = 6000
"""Samples that are enough to choose elements by."""
EXACT = 5e-4
"""Error, as a share of the target, below which no more elements are looked for."""
CLEARLY = 0.7
"""What a richer kind of emulator must leave at most of the error that a simpler one leaves."""
WORTHWHILE = 0.85
"""What must be left of the error at most for an element to be taken in."""


def spread(samples: int, enough: int = ENOUGH) -> slice:
    """Samples spread over a recording that are enough to choose elements by."""
    return slice(None, None, max(samples // enough, 1))


def triangle(columns: Floats, target: Floats) -> Floats:
    """R of the columns (n, k) and the target (n,), shape (at most k + 1, k + 1)."""
    return reduced(np.column_stack([columns[part], target[part]]) for part in blocks(target.size))


def solve(products: Floats, elastic: int, free: int, samples: int) -> Floats:
    """Least squares with so many free columns first, of them the elastic ones at the very first, then non-negative ones.

    ``products`` (k + 1, k + 1) are those of the columns and the target with each other, over so many samples. Returns
    shape (k,).
    """
    scale = np.sqrt(np.diag(products)[:-1] / samples)
    scale[scale == 0.0] = 1.0
    # A small ridge keeps nearly equal columns from cancelling each other with huge weights; it is larger on what is not
    # elastic, so that what may be elastic goes to the elastic curve and not to elements that hardly ever yield, nor to the
    # acceleration, which on one sine is as good a spring. It makes products safe, which take far less than rows.
    strength = np.full(scale.size, BIAS)
    strength[:free] = FREE
    strength[:elastic] = SPRING
    gram = products[:-1, :-1] / np.outer(scale, scale)
    gram[np.diag_indices(scale.size)] += strength * samples
    matrix = np.asarray(cholesky(gram, overwrite_a=True, check_finite=False))
    wanted = solve_triangular(matrix, products[:-1, -1] / scale, trans=1, check_finite=False)
    # The free unknowns come first in the triangle: below their rows only the bounded ones are left.
    positive = nnls(matrix[free:, free:], wanted[free:], maxiter=50 * scale.size)[0]
    rest = solve_triangular(matrix[:free, :free], wanted[:free] - matrix[:free, free:] @ positive, check_finite=False)
    return np.concatenate([rest, positive]) / scale


def places_of(elements: Mapping[str, Floats]) -> dict[str, Places]:
    """Where the columns of each kind stand when those of all kinds (n, any) stand side by side."""
    edges = np.cumsum([0, *(part.shape[1] for part in elements.values())]).tolist()
    return {name: np.arange(a, b) for name, (a, b) in zip(elements, itertools.pairwise(edges), strict=True)}


class Selection:
    """Elements to choose from, over a recording or over samples spread over it (see :func:`spread`).

    Parameters
    ----------
    elements : mapping of str to array, shape (n, any)
        Their outputs by kind, ``"elastic"`` among them.
    target : array, shape (n,)
        What they are to emulate.
    bounded : sequence of str
        Kinds whose weights must not be negative.
    """

    def __init__(self, elements: Mapping[str, Floats], target: Floats, bounded: Sequence[str]) -> None:
        fold = (np.arange(target.size) * BLOCKS // target.size) % FOLDS
        columns = np.hstack(list(elements.values()))
        self._samples = target.size
        self._parts = [triangle(columns[fold == k], target[fold == k]) for k in range(FOLDS)]
        others = ([part for j, part in enumerate(self._parts) if j != k] for k in range(FOLDS))
        self._others = [rows.T @ rows for rows in map(np.vstack, others)]
        """Products of the columns and the target, over all parts but one."""
        self._whole = reduced(self._parts)
        self._bounded = frozenset(bounded)
        self._exact = EXACT * float(np.std(target)) * np.sqrt(target.size / FOLDS)
        self.places = places_of(elements)

    def _ordered(self, chosen: Mapping[str, Places]) -> tuple[Places, int]:
        """The columns of what is chosen, elastic ones first, then free ones, and how many are free."""
        elastic = chosen[ELASTIC]
        free = [at for name, at in chosen.items() if name not in self._bounded and name != ELASTIC]
        bounded = [at for name, at in chosen.items() if name in self._bounded]
        return np.concatenate([elastic, *free, *bounded]), elastic.size + sum(at.size for at in free)

    def error(self, chosen: Mapping[str, Places]) -> float:
        """How far each part is off when the others identify it: the geometric mean, for one part may be an extrapolation."""
        order, free = self._ordered(chosen)
        at, left = np.ix_([*order, -1], [*order, -1]), np.zeros(len(self._whole[0]))
        left[-1] = -1.0
        total = 0.0
        for part, others in zip(self._parts, self._others, strict=True):
            left[order] = solve(others[at], chosen[ELASTIC].size, free, self._samples)
            total += float(np.log(np.sum(np.square(part @ left)) + 1e-300))
        return float(np.exp(0.5 * total / FOLDS))

    def best_of(self, candidates: Places, chosen: Mapping[str, Places]) -> Places:
        """The one of ``candidates`` that takes most of what the chosen elements leave, shape (1,)."""
        order, _ = self._ordered(chosen)
        rows = self._whole
        basis = np.linalg.qr(rows[:, order])[0]
        left = rows[:, [*candidates, -1]]
        left = left - basis @ (basis.T @ left)
        size, own = np.sum(np.square(left[:, :-1]), axis=0), np.sum(np.square(rows[:, candidates]), axis=0)
        taken = np.where(size > 1e-9 * own, (left[:, :-1].T @ left[:, -1]) ** 2 / np.maximum(size, 1e-300), 0.0)
        return candidates[[int(np.argmax(taken))]]

    def grow(self, base: Mapping[str, Places], kinds: Sequence[str], one_by_one: Sequence[str]) -> dict[str, Places]:
        """``base`` and those of ``kinds`` that make the error much smaller, the best first.

        Of the kinds that come ``one_by_one`` single elements are taken in.
        """
        chosen = dict(base)
        error = self.error(chosen)
        while error > self._exact:
            options = []
            for name in kinds:
                tried, all_of_it = chosen, self.places[name]
                # Two at once as well: one of a pair hardly helps without the other.
                for _ in range(2 if name in one_by_one else 1):
                    has = tried.get(name, all_of_it[:0])
                    rest = np.setdiff1d(all_of_it, has)
                    if rest.size:
                        more = self.best_of(rest, tried) if name in one_by_one else rest
                        tried = {**tried, name: np.concatenate([has, more])}
                        options.append((self.error(tried), tried))
            best, grown = min(options, key=lambda option: option[0], default=(np.inf, chosen))
            if best > WORTHWHILE * error:
                return chosen
            error, chosen = best, grown
        return chosen
