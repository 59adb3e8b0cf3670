"""Errors of the simulator's own parameters as an explanation: how large they would have to be, and what is rather said.

Errors imitate effects and effects imitate errors. The rules here say when an effect gives way to errors, and errors to effects.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..hypotheses.adequacy import is_adequate, left_by
from ..hypotheses.evidence import FINE, Evidence, Hypothesis, Scale, count_unknowns, is_refitted
from ..hypotheses.search import NOTHING
from ..recording.noise import rms
from .parsimony import beside_exact, in_place_of
from .priors import BESIDE_OFF, IDLE, STANDS_IN, prior
from .strain import is_beyond_belief, is_strained, largest_error

__all__ = ["OwnErrors", "needs_largest", "rather_errors", "rather_off", "rather_two", "usual"]

NO_BETTER = 4.0
"""Logarithm of the odds, for each constant of its law, up to which an effect beside an exact simulator is no better than a
simulator that is off: every simulator is, by a little, and its errors are what such an effect would imitate."""
TWO, ONE = 0.014, 0.1
"""Evidence a sample that two effects beside an exact simulator must bring beyond a simulator that is off, and beyond one effect
beside an exact one."""
FEW, SHARE, SIMPLY = 3, (0.3, 1.25), 20.0
"""Free constants of two simple effects and sizes of each over the gap's, and logarithm of the odds that they must bring beyond a
simulator that is off. Of 285 strangers' simulators that were off alone none looked so, the nearest with 17; of 300 pairs four that had
passed for errors did, with 24 to 85."""
SECOND = 0.003
"""Evidence a sample that a second effect beside an exact simulator must bring beyond the errors of one that is off: 0.0031 at least
where it was there, of 200 pairs of strangers, and 0.0026 at most where it was not, but for 3 of 300 simulators that were off."""
EQUAL = 0.5
"""Logarithm of the odds up to which two sizes of the errors are as good: fine structure may matter for neither."""
CLEARLY_WORSE = 0.004
"""Evidence a sample by which smaller errors must do worse than errors of a tenth for these to be needed."""
FAR, AS_GOOD = 3.0, 0.004
"""Error of one of the simulator's parameters, over a tenth, that is not believed where an effect beside the usual errors does as well,
and evidence a sample by which that may do worse. Of 48 strangers' simulators that were off by 3 to 5 % alone five needed so much, of
which four are not known as such with or without this."""
BESIDE_ENOUGH = 0.09
"""Evidence a sample by which an effect must be needed beside a simulator that alone leaves no more than an inexact law may."""
CONSTANTS = 3.0
"""Free constants of a usual law; one with more must bring more."""


def rather_errors(evidence: Evidence, found: Sequence[Hypothesis], best: Hypothesis) -> Hypothesis:
    """One of two effects beside a simulator that is off, where it does nearly as well as both beside an exact one."""
    if evidence.fitted or len(best.terms) != 2 or is_refitted(best.scale):
        return best
    off = [
        (score, scale, h)
        for h in found
        if len(h.terms) == 1 and h.names < best.names
        for scale, score in h.by_scale.items()
        if is_refitted(scale)
    ]
    score, scale, one = max(off, key=lambda each: each[0], default=(-np.inf, best.scale, best))
    return best if score < best.score - SECOND * evidence.effective else _at(evidence, one, (scale,))


def rather_off(evidence: Evidence, best: Hypothesis, blank: Hypothesis, size: float) -> Hypothesis:
    """``best``, or a simulator that is off in place of its one effect beside an exact one where that is no worse."""
    if evidence.fitted or len(best.terms) != 1 or is_refitted(best.scale):
        return best
    if not best.names.isdisjoint(STANDS_IN) and best.scale[0] < FINE:
        # One factor on all that an exact simulator says is no error.
        return best
    scale = max((s for s in blank.by_scale if is_refitted(s)), key=blank.by_scale.__getitem__)
    worse = best.score + prior(evidence, best, size) - blank.by_scale[scale]
    return _at(evidence, blank, (scale,)) if worse < NO_BETTER * count_unknowns(best.terms) else best


def rather_two(evidence: Evidence, found: Sequence[Hypothesis], best: Hypothesis, energy: float) -> Hypothesis:
    """Two effects beside an exact simulator in place of one that is off, where neither that nor one of them does nearly as well.

    Or, also in place of one of them beside it, where both are simple and each makes much of the gap: errors of all parameters
    hardly ever look like just that.
    """
    if evidence.fitted or len(best.terms) > 1 or not is_refitted(best.scale):
        return best
    pairs = [(h.beside_exact, h) for h in found if len(h.terms) == 2 and h.beside_exact]
    pairs.sort(key=lambda each: -each[0].score)
    if pairs and not best.terms:
        beside, pair = pairs[0]
        one = max(beside_exact(evidence, h).score for h in found if len(h.terms) == 1)
        enough = max(best.score + TWO * evidence.effective, one + ONE * evidence.effective)
        if beside.score > enough and is_adequate(evidence, beside, energy):
            return in_place_of(pair, beside)
    for beside, pair in pairs:
        if beside.score > best.score + SIMPLY and best.names < pair.names and _are_simple(evidence, beside):
            return in_place_of(pair, beside)
    return best


def _are_simple(evidence: Evidence, pair: Hypothesis) -> bool:
    """Whether two effects of few constants leave nothing, and neither is a small part of the gap nor cancels the other."""
    size = rms(evidence.gap)
    parts = [evidence.rms_of(pair.part(name)) / size for name in pair.names]
    much = min(parts) > SHARE[0] and max(parts) < SHARE[1]
    return much and count_unknowns(pair.terms) <= FEW and left_by(evidence, pair) < NOTHING


def needs_largest(evidence: Evidence, hypothesis: Hypothesis) -> bool:
    """Whether smaller errors than a tenth of the simulator's parameters do clearly worse beside a hypothesis."""
    return hypothesis.score - _beside_usual(evidence, hypothesis) > CLEARLY_WORSE * evidence.effective


@dataclass(frozen=True)
class OwnErrors:
    """What a simulator that is off explains without any effect, and which effects are needed beside it."""

    evidence: Evidence
    blank: Hypothesis
    """The hypothesis without an effect."""
    energy: float
    """Mean square of the gap beyond the noise."""

    @cached_property
    def are_strained(self) -> bool:
        """Whether those that make the gap by themselves are so large that an effect is likelier."""
        return not self.evidence.fitted and is_strained(self.evidence)

    @cached_property
    def are_beyond_belief(self) -> bool:
        """Whether they are no explanation."""
        return self.are_strained and is_beyond_belief(self.evidence)

    def is_needed(self, hypothesis: Hypothesis) -> bool:
        """Whether an effect does so much better than the errors alone that it must be there beside them."""
        if self.spares(hypothesis):
            # Errors beyond belief are no measure for what spares the simulator them.
            return True
        is_free = self._are_too_large or (self.are_strained and self.are_smaller_beside(hypothesis))
        pliable = max(count_unknowns(hypothesis.terms) / CONSTANTS, 1.0)
        enough = self._are_enough and not self._makes_right(hypothesis)
        least = (
            IDLE if is_free else max(BESIDE_OFF * pliable, BESIDE_ENOUGH if enough else 0.0) * self.evidence.effective
        )
        return hypothesis.score - self.blank.score >= least

    def spares(self, hypothesis: Hypothesis) -> bool:
        """Whether one effect beside the usual errors does as well as errors of a third and more."""
        least = self.blank.score - AS_GOOD * self.evidence.effective
        return self._are_far and len(hypothesis.terms) == 1 and _beside_usual(self.evidence, hypothesis) > least

    def are_smaller_beside(self, hypothesis: Hypothesis) -> bool:
        """Whether the simulator is nearer to right beside an effect; else the effect only patches what its errors leave."""
        blank = self.blank.scale
        return any(
            scale != blank and all(a <= b for a, b in zip(scale, blank, strict=True))
            for scale, score in hypothesis.by_scale.items()
            if score > hypothesis.score - EQUAL
        )

    def spared(self, ranked: Sequence[Hypothesis]) -> Hypothesis | None:
        """The effect that does best beside the usual errors, beside these, where it spares the simulator larger ones."""
        sparing = [h for h in ranked if self.spares(h)]
        if not sparing:
            return None
        return _at(self.evidence, max(sparing, key=lambda h: _beside_usual(self.evidence, h)), usual(self.evidence))

    def believed(self, hypothesis: Hypothesis) -> float:
        """What the evidence for a hypothesis loses where the simulator may be off by no more than usual; zero or less."""
        return min(_beside_usual(self.evidence, hypothesis) - hypothesis.score, 0.0)

    @cached_property
    def _are_far(self) -> bool:
        """Whether one parameter would have to be off by a third and more."""
        return (
            not self.evidence.fitted and needs_largest(self.evidence, self.blank) and largest_error(self.evidence) > FAR
        )

    @cached_property
    def _are_enough(self) -> bool:
        return is_adequate(self.evidence, self.blank, self.energy)

    @cached_property
    def _are_too_large(self) -> bool:
        """Whether errors of a tenth would be needed to make a gap that is smaller than such errors make."""
        made = 0.5 * max(self.evidence.scales)[1] * float(np.std(self.evidence.scene.signals.y_sim))
        return needs_largest(self.evidence, self.blank) and float(np.std(self.evidence.gap)) < made

    def _makes_right(self, hypothesis: Hypothesis) -> bool:
        """Whether beside an effect, which leaves nothing, they need not be as large as a tenth; patches don't do that."""
        nearer = needs_largest(self.evidence, self.blank) and not needs_largest(self.evidence, hypothesis)
        return nearer and left_by(self.evidence, hypothesis) < NOTHING


def usual(evidence: Evidence) -> list[Scale]:
    """The simulators that are off by less than a tenth, or not at all."""
    largest = max(evidence.scales)[1]
    return [scale for scale in evidence.scales if scale[1] < largest]


def _beside_usual(evidence: Evidence, hypothesis: Hypothesis) -> float:
    """The most evidence for a hypothesis beside one of these."""
    return max((hypothesis.by_scale.get(scale, -np.inf) for scale in usual(evidence)), default=-np.inf)


def _at(evidence: Evidence, hypothesis: Hypothesis, scales: Sequence[Scale]) -> Hypothesis:
    """The same effects beside simulators of some scales only, with the evidence that there is for them beside any."""
    fitted = evidence.fit(hypothesis.terms, scales)
    return replace(fitted, by_scale=hypothesis.by_scale, beside_exact=hypothesis.beside_exact)
