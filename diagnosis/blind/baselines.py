"""Two simpler ways to name a cause, for comparison: plain correlation, and the best fit beside a fixed simulator."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..evidence import Term, boxed_least_squares
from ..search import Library

__all__ = ["by_correlation", "by_fit"]


def by_correlation(library: Library) -> str:
    """The effect one of whose signals correlates most with the gap."""
    gap, columns = library.evidence.gap, library.columns
    # A constant correlates with nothing once the mean is out, so it is compared about zero.
    varies = np.ptp(columns, axis=0) > 0.0
    about = columns - np.where(varies, columns.mean(axis=0), 0.0)
    moments = np.where(varies, (gap - gap.mean()) @ about, gap @ about)
    sizes = np.linalg.norm(about, axis=0) * np.where(varies, np.linalg.norm(gap - gap.mean()), np.linalg.norm(gap))
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
    return max(zip(library.terms, library.slices, strict=True), key=lambda one: worth(*one))[0].effect.id
