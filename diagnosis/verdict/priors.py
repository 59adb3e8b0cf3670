"""What an explanation costs before its evidence is looked at."""

from __future__ import annotations

import numpy as np

from ..hypotheses.evidence import FINE, Evidence, Hypothesis
from ..names import GAIN

__all__ = ["BESIDE_OFF", "COMPANY_COST", "EFFECT_COST", "IDLE", "STANDS_IN", "prior"]

IDLE = 5.0
"""Evidence that an effect must bring to stand in for another; beside others, or beside a simulator that is off, it must
be worth its company."""
EFFECT_COST = 3.0
"""Logarithm of the prior odds against each further effect."""
EFFECT_COST_REFITTED = 12.0
COMPANY_COST = 0.02
"""The same a sample, for effects beside others or beside a simulator that is off: a small misfit of one can always be
patched by one more, however sure the improvement."""
BESIDE_OFF = 0.012
"""Evidence a sample that one effect must bring beside a simulator that may be off by a tenth to be more than its misfit."""
COINCIDENCE = 200.0
"""Logarithm of the odds against effects, together or one of them, of 2.5 times the gap; it grows as the square beyond 1.25.

Of 360 right pairs on strangers' joints no effect made more than 1.4 times the gap, of 50 wrong ones a sixth did."""
STANDS_IN = (GAIN,)
STAND_IN, STAND_IN_COMPANY = 7.0, 9.0
"""Logarithm of the odds against these where the loop's fine structure is off too: then the simulator is to blame."""


def prior(evidence: Evidence, hypothesis: Hypothesis, gap: float) -> float:
    """Logarithm of the prior odds; minus infinity for an effect that is only a special case of itself."""
    if not hypothesis.terms:
        return 0.0
    if any(
        term.effect.is_degenerate(hypothesis.parameters(term.effect.id), evidence.scene) for term in hypothesis.terms
    ):
        return -np.inf
    # Beside a simulator that is off in many ways, an effect may always stand in for one more of them.
    refitted = evidence.is_beside_refit(hypothesis)
    cost = (EFFECT_COST_REFITTED if refitted else EFFECT_COST) * len(hypothesis.terms)
    cost += COMPANY_COST * evidence.effective * (len(hypothesis.terms) - (0 if refitted else 1))
    cost += sum(float(np.log(term.laws)) for term in hypothesis.terms)
    if evidence.fitted:
        return -cost
    if any(term.effect.id in STANDS_IN for term in hypothesis.terms):
        alone = len(hypothesis.terms) == 1
        cost += STAND_IN * (hypothesis.scale[0] >= (FINE if alone else 0.5 * FINE)) + STAND_IN_COMPANY * (not alone)
    # Effects and errors of the simulator that are each larger than the gap and cancel would be a coincidence.
    made = [hypothesis.signal, *(hypothesis.part(name) for name in hypothesis.names if len(hypothesis.names) > 1)]
    size = max(map(evidence.rms_of, made)) / gap
    return -cost - COINCIDENCE * max(size / 1.25 - 1.0, 0.0) ** 2
