"""Whether the gap is one factor on all that the simulator says, or one constant, or the errors of several of its parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..hypotheses.evidence import Evidence, Hypothesis, Term, is_refitted
from ..hypotheses.refinement import polish
from ..names import GAIN, OFFSET
from .own_errors import usual
from .priors import prior

__all__ = ["as_one_factor", "constant_of_all", "factor_of_all", "may_be_a_factor"]

Floats = NDArray[np.float64]
ONE_FACTOR = 0.005
"""Share of the gap's energy that one factor on the torque, or one constant, may leave to be more than a coincidence of several errors."""
AGAINST_ONE_FACTOR = 20.0
"""Logarithm of the odds against one factor beyond which it is a coincidence in any case."""
FOR_ONE_FACTOR = 10.0
"""The same for one factor beside a simulator that is off beyond which it is none."""
SEVERAL = 0.02
"""Share of the gap's energy that one factor leaves where it is several errors rather than one factor."""
LARGE, LITTLE_LEFT = 0.07, 0.009
"""A factor on the torque that parameters which are off by a few per cent seldom make together, and the share of the gap's energy
that it may leave to them where they do better without it. On 72 simulators of strangers that were off alone, ten of whose exponents
and preloads made a factor of 0.08 to 0.15, it left 0.0094 at least, and did worse beside the usual errors than these alone. Of eight
such gains beside errors it left more of two, which did better."""
TOO_LARGE, MOST_LEFT = 0.16, 0.1
"""The same of a factor that such parameters do not make, and the most that any factor may leave."""
LEFT_BY_ITSELF = 0.2
"""Share of the gap's energy that a factor which is too large may leave, as it is beside the usual errors, where these do better without
it: else they make most of the gap themselves. On strangers' joints a factor that was there left at most 0.12, and one that four
simulators' errors made 0.3 to 0.56."""
EXACTLY = ((0.0, 0.0),)
"""A simulator that is right to the last detail."""
SMALL = 3.0
"""Gap over noise below which such a share cannot be told."""
AGAINST_FACTOR_BESIDE = 15.0
"""Logarithm of the odds against one factor beside an effect, where a simulator that is off would do beside that effect, beyond
which it is a coincidence."""
CANCELS = 2.0
"""Energy of the factor over the gap's from which the effect would have to cancel most of it."""


def as_one_factor(
    evidence: Evidence, best: Hypothesis, found: Sequence[Hypothesis], energy: float, size: float
) -> Hypothesis:
    """A gain in place of a simulator that is off, alone or beside one effect, where one factor closes the gap; or the other way
    round; else ``best``."""
    gain, blank = next((h for h in found if h.names == {GAIN}), None), found[0]
    if gain is None or evidence.fitted or energy < SMALL**2 * evidence.sigma**2:
        # Noise would decide.
        return best

    def leaves(factor: Hypothesis) -> float:
        return _left(evidence, evidence.fit(factor.terms, EXACTLY)) / energy

    def is_large(factor: Hypothesis) -> bool:
        # Errors that make a factor by accident are themselves the better explanation.
        better = factor.score >= blank.score
        if not _is_too_large(evidence, energy):
            return better and may_be_a_factor(evidence, energy)
        by_itself = float(np.mean(np.square(evidence.gap - factor.part(GAIN)[evidence.rows]))) - evidence.sigma**2
        return better or by_itself < LEFT_BY_ITSELF * energy

    if not best.terms:
        factor = evidence.fit((_plain(evidence, gain),), evidence.exact)
        behind = best.score - factor.score - prior(evidence, factor, size)
        if behind < AGAINST_ONE_FACTOR and leaves(factor) < ONE_FACTOR:
            return factor
        # Beside one the simulator's errors may be the usual ones.
        beside = evidence.fit(factor.terms, [scale for scale in usual(evidence) if scale[1] > 0.0])
        if beside.score - best.score > FOR_ONE_FACTOR and leaves(beside) < SEVERAL:
            return beside
        return beside if is_large(beside) else best
    if len(best.terms) == 1 and GAIN not in best.names and is_refitted(best.scale):
        return _with_factor(evidence, best, found, gain, energy)
    if best.names == {GAIN} and is_refitted(best.scale) and leaves(best) > SEVERAL and not is_large(best):
        return blank
    return best


def _with_factor(
    evidence: Evidence, best: Hypothesis, found: Sequence[Hypothesis], gain: Hypothesis, energy: float
) -> Hypothesis:
    """A gain in place of what is off in the simulator beside one effect, where all its errors come to one factor; else ``best``."""
    factor = _plain(evidence, gain)
    alike = [h for h in found if h.names - {GAIN} == best.names]
    alike += [h.beside_exact for h in alike if h.beside_exact]
    laws = [best.terms, *(tuple(t for t in h.terms if t.effect.id != GAIN) for h in alike)]
    both = max((evidence.fit((*law, factor), evidence.exact) for law in laws), key=lambda h: h.score)
    strictly, noise = evidence.fit(both.terms, EXACTLY), evidence.sigma**2
    made, rubbed = (float(np.mean(np.square(part))) for part in _factored(evidence, strictly))
    # Where nothing is seen of what it makes of friction, a stiffness that is off would do.
    is_one = (
        _left(evidence, strictly) < ONE_FACTOR * made and SMALL**2 * noise < made < CANCELS * energy and rubbed > noise
    )
    if not is_one or both.score < best.score - AGAINST_FACTOR_BESIDE:
        return best
    return polish(evidence, replace(both, by_scale=evidence.fit(both.terms).by_scale, beside_exact=both))


def _left(evidence: Evidence, hypothesis: Hypothesis) -> float:
    """Mean square that a hypothesis leaves beyond the noise."""
    return float(np.mean(np.square(evidence.left_over(hypothesis)))) - evidence.sigma**2


def _factored(evidence: Evidence, hypothesis: Hypothesis) -> tuple[Floats, Floats]:
    """What its factor adds to the whole torque and to friction alone, shapes (n,)."""
    factor = hypothesis.parameters(GAIN)["gain_error"]
    return hypothesis.part(GAIN)[evidence.rows], factor * evidence.scene.friction[evidence.rows]


def _plain(evidence: Evidence, gain: Hypothesis) -> Term:
    """One factor on the torque, whatever the law of the gain."""
    plain = next(form for form in gain.terms[0].effect.forms(evidence.scene) if not form.shapes)
    return replace(gain.terms[0], form=plain, shape=())


def _is_too_large(evidence: Evidence, energy: float) -> bool:
    """Whether the gap is a factor on the torque that parameters which are off by a few per cent do not make together."""
    return _is_a_factor(evidence, energy, TOO_LARGE, MOST_LEFT) or _is_a_factor(evidence, energy, LARGE, LITTLE_LEFT)


def may_be_a_factor(evidence: Evidence, energy: float) -> bool:
    """Whether the gap is mostly a factor on the torque that such parameters seldom make."""
    return _is_a_factor(evidence, energy, LARGE, MOST_LEFT)


def _is_a_factor(evidence: Evidence, energy: float, least: float, most_left: float) -> bool:
    factor, left = _factor(evidence)
    return abs(factor) > least and left - evidence.sigma**2 < most_left * energy


def factor_of_all(evidence: Evidence, found: Sequence[Hypothesis], energy: float) -> float:
    """The relative error of the whole torque, where it makes the gap and no effect known here does that; 0 otherwise."""
    return _if_of_all(evidence, found, energy, GAIN, *_factor(evidence))


def constant_of_all(evidence: Evidence, found: Sequence[Hypothesis], energy: float) -> float:
    """The constant torque, N·m, that makes the gap, where no effect known here is one; 0 otherwise.

    A simulator with a preload would have that off, and nothing else.
    """
    gap = evidence.gap
    return _if_of_all(evidence, found, energy, OFFSET, float(np.mean(gap)), float(np.var(gap)))


def _if_of_all(
    evidence: Evidence, found: Sequence[Hypothesis], energy: float, effect: str, size: float, left: float
) -> float:
    """``size`` where what is ``left`` with it, a mean square, is noise and the ``effect`` that it would be is not known here; else 0."""
    if any(effect in h.names for h in found) or energy < SMALL**2 * evidence.sigma**2:
        return 0.0
    return size if left - evidence.sigma**2 < ONE_FACTOR * energy else 0.0


def _factor(evidence: Evidence) -> tuple[float, float]:
    """The relative error of the whole torque that closes most of the gap, and the mean square that it leaves."""
    torque = evidence.scene.torque[evidence.rows]
    factor = float(torque @ evidence.gap) / max(float(torque @ torque), 1e-300)
    return factor, float(np.mean(np.square(evidence.gap - factor * torque)))
