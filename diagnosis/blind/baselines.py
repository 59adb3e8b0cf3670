"""Two simpler ways to name a cause, for comparison: plain correlation, and the best fit beside a fixed simulator."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..hypotheses.boxed import boxed_least_squares
from ..hypotheses.evidence import Term
from ..hypotheses.library import Library

__all__ = ["by_correlation", "by_fit"]

CONSTANT = 1e-10
"""Share of a signal's energy about its mean up to which it is a constant."""


def by_correlation(library: Library) -> str:
    """The effect one of whose signals correlates most with the gap."""
    gap, sums = library.spread.gap, library.sums
    gram, moment, energy = library.moments((0.0, 0.0))
    squares, moment = np.diagonal(gram)[: sums.size], moment[: sums.size]
    # A constant correlates with nothing once the mean is out, so it is compared about zero.
    about = squares - sums**2 / gap.size
    varies = about > CONSTANT * squares
    moments = moment - np.where(varies, gap.mean() * sums, 0.0)
    sizes = np.sqrt(np.where(varies, about * gap.size * gap.var(), squares * energy))
    correlations = np.abs(moments) / np.maximum(sizes, 1e-300)

    def largest(term: Term, columns: slice) -> float:
        return float(correlations[columns].max())

    return _best(library, largest)


def by_fit(library: Library) -> str:
    """The effect that leaves the smallest sum of squares beside the simulator as it is."""
    # One scale and no price for unknowns: the plain in-sample fit.
    gram, moment, _ = library.moments((0.0, 0.0))

    def reduction(term: Term, columns: slice) -> float:
        lower, upper = np.array(term.form.lower), np.array(term.form.upper)
        _, reduced = boxed_least_squares(gram[columns, columns][None], moment[columns][None], lower, upper)
        return float(reduced[0])

    return _best(library, reduction)


def _best(library: Library, worth: Callable[[Term, slice], float]) -> str:
    """The effect of the term that is worth most, by it and its columns."""
    candidates = zip(library.terms[: library.candidates], library.slices, strict=False)
    return max(candidates, key=lambda one: worth(*one))[0].effect.id
