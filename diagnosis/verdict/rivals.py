"""What could stand in for a verdict on this recording, and with what odds."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np
from numpy.typing import NDArray

from ..hypotheses.evidence import Evidence, Hypothesis, is_refitted
from ..names import GAIN, MISCALIBRATION
from ..recording.signals import Signals
from .one_factor import may_be_a_factor
from .parsimony import special_cases
from .priors import BESIDE_OFF, COMPANY_COST, EFFECT_COST, IDLE, STANDS_IN

__all__ = [
    "SAME_BY_EYE",
    "TEMPERATURE",
    "effective_share",
    "is_nested",
    "is_poor",
    "is_weighed_rightly",
    "recalibration_rivals",
    "weigh",
]

Floats = NDArray[np.float64]
TEMPERATURE = 0.25
"""Share of the evidence that is trusted when alternatives are weighed: laws are never exact."""
SAME_BY_EYE = 0.003
"""Evidence a sample that a slightly different law could reverse: such alternatives are stated as ambiguous."""
SAME_WHERE_POOR = 0.04
"""The same where all half cycles are alike."""
ALIKE = 0.25
"""Coefficient of variation of amplitudes and of mid-stroke speeds up to which half cycles are alike."""


def is_nested(one: Hypothesis, other: Hypothesis) -> bool:
    """Whether one explanation is a special case of the other."""
    a, b = special_cases(one), special_cases(other)
    return a <= b or b <= a


def weigh(
    evidence: Evidence,
    ranked: Sequence[Hypothesis],
    scores: Floats,
    own: float,
    best: Hypothesis,
    blank: Hypothesis,
    tempered: float,
) -> tuple[dict[frozenset[str], float], dict[frozenset[str], float]]:
    """Probability of each set of effects, and its odds against the verdict ``best``, whose score is ``own``."""
    weights = np.exp(np.clip(tempered * (scores - scores.max()), -700.0, 0.0))
    near = (SAME_WHERE_POOR if is_poor(evidence.scene.signals) else SAME_BY_EYE) * evidence.effective
    posterior: dict[frozenset[str], float] = {}
    odds: dict[frozenset[str], float] = {}
    known = {hypothesis.names: hypothesis.score for hypothesis in ranked}
    for hypothesis, weight, score in zip(ranked, weights / weights.sum(), scores, strict=True):
        posterior[hypothesis.names] = posterior.get(hypothesis.names, 0.0) + float(weight)
        against = float(np.exp(np.clip(tempered * (score - own), -700.0, 50.0)))
        rest = hypothesis.names & best.names
        alone = BESIDE_OFF * evidence.effective if is_refitted(hypothesis.scale) else IDLE
        idle = COMPANY_COST * evidence.effective if rest else alone
        if hypothesis.terms and hypothesis.score < known.get(rest, blank.score) + idle:
            # What stands in for the verdict here is the refitted simulator, not this effect.
            against = 0.0
        elif special_cases(hypothesis) == best.names != hypothesis.names:
            # The more general effect is no other cause.
            against = 0.0
        elif own - score < near or hypothesis.score - best.score > near:
            # The latter does better but for what company costs it.
            against = max(against, 0.1)
        odds[hypothesis.names] = max(odds.get(hypothesis.names, 0.0), against)
    return posterior, odds


def recalibration_rivals(
    evidence: Evidence,
    verdict: Sequence[str],
    best: Hypothesis,
    own: float,
    found: Sequence[Hypothesis],
    tempered: float,
    energy: float,
) -> list[str]:
    """Effects that a miscalibrated simulator would imitate, or be imitated by, on this recording."""
    blank = next(h for h in found if not h.terms)

    def least(names: Collection[str]) -> float:
        return float(np.log(0.05)) / (1.0 if is_weighed_rightly(names) else tempered)

    if len(best.names) == 1 and verdict == sorted(best.names):
        refitted = max((s for scale, s in blank.by_scale.items() if is_refitted(scale)), default=-np.inf)
        poor = -SAME_WHERE_POOR * evidence.effective if is_poor(evidence.scene.signals) else 0.0
        return sorted(best.names) if refitted - own > min(least(best.names), poor) else []

    def beside_exact(hypothesis: Hypothesis) -> float:
        # Where the fine structure is off too, it is the effect that must stand in for the errors, not that structure.
        scores = (
            s for scale, s in hypothesis.by_scale.items() if not is_refitted(scale) and s > blank.by_scale[scale] + IDLE
        )
        return max(scores, default=-np.inf)

    if verdict == [MISCALIBRATION]:
        factor = {GAIN} if not evidence.fitted and may_be_a_factor(evidence, energy) else set()
        return sorted(
            name
            for h in found
            for name in h.names
            if len(h.names) == 1 and (h.names == factor or beside_exact(h) - EFFECT_COST - best.score > least(h.names))
        )
    return []


def is_weighed_rightly(names: Collection[str]) -> bool:
    """Whether evidence between these effects and a simulator that is off may be trusted whole.

    That one factor fits all parameters is a coincidence that evidence weighs rightly, whatever the laws are.
    """
    return not set(STANDS_IN).isdisjoint(names)


def is_poor(signals: Signals) -> bool:
    """Whether all half cycles are alike, as in a single sine: one amplitude at one rate."""
    whole = signals.amplitude > 0.05 * signals.reach
    if not np.any(whole):
        return True
    amplitude = signals.amplitude[whole]
    pace = np.abs(signals.speed[whole]) / amplitude
    middle = signals.since_reversal[whole] > 0.7 * amplitude
    middle &= signals.since_reversal[whole] < 1.3 * amplitude
    spread = [float(np.std(v)) / max(float(np.mean(v)), 1e-300) for v in (amplitude, pace[middle]) if v.size]
    return max(spread) < ALIKE


def effective_share(residual: Floats, runs: Sequence[slice], longest: int = 200) -> float:
    """Effective over actual number of samples, 1 / (1 + 2 Σ ρ_k), the sum ended where ρ_k is no longer positive."""
    products = np.zeros(longest)
    for run in runs:
        series = residual[run]
        for lag in range(min(longest, series.size // 4)):
            products[lag] += float(series[: series.size - lag] @ series[lag:])
    if products[0] <= 0.0:
        return 1.0
    correlation = products[1:] / products[0]
    ends = np.flatnonzero(correlation <= 0.0)
    return 1.0 / (1.0 + 2.0 * float(correlation[: ends[0] if ends.size else longest - 1].sum()))
