"""Whether the gap is one factor on all that the simulator says, or the errors of several of its parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..hypotheses.evidence import Evidence, Hypothesis, is_refitted
from ..names import GAIN
from .own_errors import usual
from .priors import prior

__all__ = ["as_one_factor", "factor_of_all", "is_too_large"]

ONE_FACTOR = 0.005
"""Share of the gap's energy that one factor on the torque may leave to be more than a coincidence of several errors."""
AGAINST_ONE_FACTOR = 20.0
"""Logarithm of the odds against one factor beyond which it is a coincidence in any case."""
FOR_ONE_FACTOR = 10.0
"""The same for one factor beside a simulator that is off beyond which it is none."""
SEVERAL = 0.02
"""Share of the gap's energy that one factor leaves where it is several errors rather than one factor."""
TOO_LARGE, MOST_LEFT = 0.07, 0.1
"""A factor on the torque beyond what parameters that are off by a few per cent make together, and the share of the gap's
energy that it may leave to them."""
SMALL = 3.0
"""Gap over noise below which such a share cannot be told."""


def as_one_factor(
    evidence: Evidence, best: Hypothesis, found: Sequence[Hypothesis], energy: float, size: float
) -> Hypothesis:
    """A gain in place of a simulator that is off where one factor closes the gap, or the other way round; else ``best``."""
    gain, blank = next((h for h in found if h.names == {GAIN}), None), found[0]
    if gain is None or evidence.fitted or energy < SMALL**2 * evidence.sigma**2:
        # Noise would decide.
        return best

    def leaves(factor: Hypothesis) -> float:
        alone = evidence.fit(factor.terms, ((0.0, 0.0),))
        return (float(np.mean(np.square(evidence.left_over(alone)))) - evidence.sigma**2) / energy

    if not best.terms:
        plain = next(form for form in gain.terms[0].effect.forms(evidence.scene) if not form.shapes)
        factor = evidence.fit((replace(gain.terms[0], form=plain, shape=()),), evidence.exact)
        behind = best.score - factor.score - prior(evidence, factor, size)
        if behind < AGAINST_ONE_FACTOR and leaves(factor) < ONE_FACTOR:
            return factor
        # Beside one the simulator's errors may be the usual ones.
        beside = evidence.fit(factor.terms, [scale for scale in usual(evidence) if scale[1] > 0.0])
        if beside.score - best.score > FOR_ONE_FACTOR and leaves(beside) < SEVERAL:
            return beside
        return beside if is_too_large(evidence, energy) else best
    if (
        best.names == {GAIN}
        and is_refitted(best.scale)
        and leaves(best) > SEVERAL
        and not is_too_large(evidence, energy)
    ):
        return blank
    return best


def is_too_large(evidence: Evidence, energy: float) -> bool:
    """Whether the gap is a factor on the torque that parameters which are off by a few per cent do not make together."""
    factor, left = _factor(evidence)
    return abs(factor) > TOO_LARGE and left - evidence.sigma**2 < MOST_LEFT * energy


def factor_of_all(evidence: Evidence, found: Sequence[Hypothesis], energy: float) -> float:
    """The relative error of the whole torque, where it makes the gap and no effect known here does that; 0 otherwise."""
    if any(GAIN in h.names for h in found) or energy < SMALL**2 * evidence.sigma**2:
        return 0.0
    factor, left = _factor(evidence)
    return factor if left - evidence.sigma**2 < ONE_FACTOR * energy else 0.0


def _factor(evidence: Evidence) -> tuple[float, float]:
    """The relative error of the whole torque that closes most of the gap, and the mean square that it leaves."""
    torque = evidence.scene.torque[evidence.rows]
    factor = float(torque @ evidence.gap) / max(float(torque @ torque), 1e-300)
    return factor, float(np.mean(np.square(evidence.gap - factor * torque)))
