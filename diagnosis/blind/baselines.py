"""Two simpler ways to name a cause, for comparison: plain correlation, and the best fit beside a fixed simulator."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..evidence import Evidence, boxed_least_squares
from ..search import Library

__all__ = ["by_correlation", "by_fit"]


def by_correlation(evidence: Evidence, exclude: Sequence[str]) -> str:
    """The effect one of whose signals correlates most with the gap."""
    from ..diagnosis import known_effects

    gap = evidence.gap - evidence.gap.mean()
    best, name = -1.0, ""
    for effect in known_effects(exclude):
        for form in effect.forms(evidence.scene):
            for shape in form.grid:
                columns = form.columns(evidence.scene, shape)[evidence.rows]
                for column in columns.T:
                    # A constant correlates with nothing once the mean is out, so it is compared about zero.
                    about = column - column.mean() if np.ptp(column) > 0.0 else column
                    against = gap if np.ptp(column) > 0.0 else evidence.gap
                    size = float(np.linalg.norm(about) * np.linalg.norm(against))
                    found = abs(float(about @ against)) / size if size > 0.0 else 0.0
                    if found > best:
                        best, name = found, effect.id
    return name


def by_fit(evidence: Evidence, exclude: Sequence[str]) -> str:
    """The effect that leaves the smallest sum of squares beside the simulator as it is."""
    from ..diagnosis import known_effects

    library = Library(evidence, known_effects(exclude))
    # One scale and no price for unknowns: the plain in-sample fit.
    gram, moment, energy = library.moments((0.0, 0.0))
    best, name = np.inf, ""
    for term, columns in zip(library.terms, library.slices, strict=True):
        lower, upper = np.array(term.form.lower), np.array(term.form.upper)
        _, reduction = boxed_least_squares(gram[columns, columns][None], moment[columns][None], lower, upper)
        if energy - float(reduction[0]) < best:
            best, name = energy - float(reduction[0]), term.effect.id
    return name
