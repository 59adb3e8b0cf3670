"""Which elements an emulator needs: those that tell blocks of a recording from the others much better."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import nnls

from .kind import ELASTIC

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
DIGITS = 1e-13
"""Share of the target's energy that products do not tell from nothing."""
WORTHWHILE = 0.85
"""What must be left of the error at most for an element to be taken in."""


def spread(known: NDArray[np.bool_], enough: int = ENOUGH) -> Places:
    """Samples spread over those ``known`` (n,) of a recording that are enough to choose elements by."""
    at = np.flatnonzero(known)
    return at[:: max(at.size // enough, 1)]


def solve(products: Floats, elastic: int, free: int, samples: int) -> Floats:
    """Least squares with so many free columns first, of them the elastic ones at the very first, then non-negative ones.

    ``products`` (k + 1, k + 1) are those of the columns and the target with each other, over so many samples. Returns
    shape (k,).
    """
    gram, wanted, scale = _ridged(products, elastic, free, samples)
    matrix = np.asarray(cholesky(gram, overwrite_a=True, check_finite=False))
    wanted = solve_triangular(matrix, wanted, trans=1, check_finite=False)
    # The free unknowns come first in the triangle: below their rows only the bounded ones are left.
    positive = wanted[free:]
    # Of no unknowns at all nnls frees its memory twice (scipy 1.17).
    if positive.size:
        positive = nnls(matrix[free:, free:], positive, maxiter=50 * scale.size)[0]
    rest = solve_triangular(matrix[:free, :free], wanted[:free] - matrix[:free, free:] @ positive, check_finite=False)
    return np.concatenate([rest, positive]) / scale


def _ridged(products: Floats, elastic: int, free: int, samples: int) -> tuple[Floats, Floats, Floats]:
    """Products of the columns (k, k) and their products with the target (k,), of columns made alike by a ``scale`` (k,)."""
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
    return gram, products[:-1, -1] / scale, scale


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
        columns = np.column_stack([*elements.values(), target])
        self._samples = target.size
        self._parts = [rows.T @ rows for rows in (columns[fold == k] for k in range(FOLDS))]
        """Products of the columns and the target over each part."""
        self._others = [sum(self._parts[:k] + self._parts[k + 1 :]) for k in range(FOLDS)]
        self._whole = sum(self._parts)
        self._bounded = frozenset(bounded)
        self.size = max(float(np.std(target)), 1e-300) * np.sqrt(target.size / FOLDS)
        """Of the target, as errors are told."""
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
        at = np.ix_([*order, -1], [*order, -1])
        total = 0.0
        for part, others in zip(self._parts, self._others, strict=True):
            left = np.append(solve(others[at], chosen[ELASTIC].size, free, self._samples), -1.0)
            # Of what is less the products have no digits.
            total += float(np.log(max(left @ part[at] @ left, DIGITS * part[-1, -1]) + 1e-300))
        return float(np.exp(0.5 * total / FOLDS))

    def best_of(self, candidates: Places, chosen: Mapping[str, Places]) -> Places:
        """The one of ``candidates`` that takes most of what the chosen elements leave, shape (1,)."""
        order, free = self._ordered(chosen)
        at = [*order, *candidates, -1]
        gram, moments, _ = _ridged(self._whole[np.ix_(at, at)], chosen[ELASTIC].size, free, self._samples)
        factor = cholesky(gram[: order.size, : order.size], lower=True, check_finite=False)
        across = np.column_stack([gram[: order.size, order.size :], moments[: order.size]])
        taken = solve_triangular(factor, across, lower=True, check_finite=False)
        size = np.diag(gram)[order.size :] - np.sum(np.square(taken[:, :-1]), axis=0)
        gain = np.square(moments[order.size :] - taken[:, -1] @ taken[:, :-1]) / size
        return candidates[[int(np.argmax(gain))]]

    def grow(self, base: Mapping[str, Places], kinds: Sequence[str], one_by_one: Sequence[str]) -> dict[str, Places]:
        """``base`` and those of ``kinds`` that make the error much smaller, the best first.

        Of the kinds that come ``one_by_one`` single elements are taken in.
        """
        chosen = dict(base)
        error = self.error(chosen)
        while error > EXACT * self.size:
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
