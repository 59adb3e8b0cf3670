"""From fitted hypotheses to a verdict with a calibrated confidence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .adequacy import ALMOST_ALL, emulated, forgiven_here, left_to_noise
from .calibration import CONFIDENCE, confidence
from .evidence import FINE, Evidence, Hypothesis, count_unknowns, is_refitted
from .heldout import HeldOut, held_out, structured_power
from .hum import hum
from .operators import rms
from .parsimony import fewest, hardly_worse, simplest, special_cases
from .quantisation import torque_step
from .signals import Signals
from .spikes import OUTLIERS, spikes

__all__ = ["MISCALIBRATION", "SAME_BY_EYE", "TEMPERATURE", "UNKNOWN", "Choice", "choose", "effective_share"]

Floats = NDArray[np.float64]
MISCALIBRATION, UNKNOWN = "miscalibration", "unknown"
TEMPERATURE = 0.25
"""Share of the evidence that is trusted when alternatives are weighed: laws are never exact."""
SAME_BY_EYE = 0.003
"""Evidence a sample that a slightly different law could reverse: such alternatives are stated as ambiguous."""
SAME_WHERE_POOR = 0.04
"""The same where all half cycles are alike."""
IDLE = 5.0
"""Evidence that an effect must bring to stand in for another; beside others, or beside a simulator that is off, it must
be worth its company."""
NEEDED = 0.3
"""Evidence a sample by which an effect must be needed beside a simulator that is off by a tenth."""
DOUBT = 0.2
"""A cause less probable than this is not named; of those between this and a half most are right, and an honest figure is stated."""
ALIKE = 0.25
"""Coefficient of variation of amplitudes and of mid-stroke speeds up to which half cycles are alike."""
EFFECT_COST = 3.0
"""Logarithm of the prior odds against each further effect."""
EFFECT_COST_REFITTED = 12.0
COMPANY_COST = 0.02
"""The same a sample, for effects beside others or beside a simulator that is off: a small misfit of one can always be
patched by one more, however sure the improvement."""
BESIDE_OFF = 0.012
"""Evidence a sample that one effect must bring beside a simulator that may be off by a tenth to be more than its misfit."""
CONSTANTS = 3.0
"""Free constants of a usual law; one with more must bring more."""
COINCIDENCE = 200.0
"""Logarithm of the odds against effects of 2.5 times the gap; it grows as the square beyond 1.25."""
GAIN = "torque_gain"
STANDS_IN = (GAIN,)
STAND_IN, STAND_IN_COMPANY = 7.0, 9.0
"""Logarithm of the odds against these where the loop's fine structure is off too: then the simulator is to blame."""
BALANCED = 2.0
"""Size of an effect over the gap's beyond which others, or the refitted simulator, would have to cancel it: that is no
explanation unless the effects close almost all of the gap by themselves."""
ONE_FACTOR = 0.005
"""Share of the gap's energy that one factor on the torque may leave to be more than a coincidence of several errors."""
AGAINST_ONE_FACTOR = 20.0
"""Logarithm of the odds against one factor beyond which it is a coincidence in any case."""
SEVERAL = 0.02
"""Share of the gap's energy that one factor leaves where it is several errors rather than one factor."""
NO_BETTER = 4.0
"""Logarithm of the odds, for each constant of its law, up to which an effect beside an exact simulator is no better than a
simulator that is off: every simulator is, by a little, and its errors are what such an effect would imitate."""
SMALL = 3.0
"""Gap over noise below which such a share cannot be told."""
CLEARLY_WORSE = 0.004
"""Evidence a sample by which smaller errors must do worse than errors of a tenth for these to be needed."""
CALIBRATED = 0.8
"""Share of a clear gap that a calibration alone must close."""
NEGLIGIBLE = 0.7
"""An effect smaller than this share of the noise is no gap beyond the noise."""
SUBSTANTIAL = 0.3
"""Size of an effect over the gap's that is more than a patch on a simulator that is off."""
BARELY = 1.2
"""Gap over noise up to which it is not asked how much of it is closed: noise decides that."""
SAME_JOINT = 0.006
"""Neither is a gap of this share of the torque that is hardly above the noise and needs no effect."""
RECALIBRATION_WORTH = 0.06
"""Share of the gap's energy that the refit must close to be called a miscalibration."""
RECALIBRATION_SHARE = 0.15
"""Share of the gap's energy that the refit must close beside effects to be called a miscalibration in any case."""
RECALIBRATION_CLEAR = 5.0
"""The same over the noise's energy: less is what an inexact law leaves."""
WIDENING = -0.5
"""Effects that alone would close less than this only bend the refitted simulator."""
RECALIBRATION_SHARE_POOR = 0.3
"""The same where all half cycles are alike: there the refit makes up for any law that is not quite exact."""


@dataclass(frozen=True)
class Choice:
    """The verdict and what it rests on."""

    verdict: list[str]
    confidence: float
    hypothesis: Hypothesis
    held: HeldOut
    miscalibrated: bool
    left: float
    """Structured power left over by the best explanation, over the gap's."""
    features: dict[str, float]
    posterior: dict[frozenset[str], float]
    rivals: dict[frozenset[str], float]
    """Odds of other sets of effects against the verdict's."""
    candidates: list[Hypothesis]
    recalibration_rivals: list[str]
    """Effects of the verdict for which an unnamed miscalibration could stand in, or the other way round."""
    torque_step: float = 0.0
    """Step in which the recorded torque comes, N·m, where it makes up the gap; 0 otherwise."""
    hum: float = 0.0
    """Frequency of a hum that makes up the gap, Hz; 0 otherwise."""
    spikes: float = 0.0
    """Share of the samples that stand out and make up the gap; 0 otherwise."""


def _prior(evidence: Evidence, hypothesis: Hypothesis, gap: float) -> float:
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
    size = rms(hypothesis.signal) / gap
    return -cost - COINCIDENCE * max(size / 1.25 - 1.0, 0.0) ** 2


def choose(evidence: Evidence, found: Sequence[Hypothesis]) -> Choice:
    """Weigh the hypotheses (the empty one first) and state the verdict."""
    floor = evidence.sigma
    energy = max(float(np.mean(np.square(evidence.gap))) - floor**2, 1e-6 * floor**2)
    size = max(rms(evidence.gap), floor)
    likely = {id(h): h.score + _prior(evidence, h, size) for h in found}
    found = [h for h in found if np.isfinite(likely[id(h)])]
    ranked = sorted(found, key=lambda h: -likely[id(h)])
    simple = simplest(evidence, ranked, energy)
    best = fewest(evidence, ranked, simple, energy)
    blank = found[0]

    def is_needed(hypothesis: Hypothesis) -> bool:
        pliable = max(count_unknowns(hypothesis.terms) / CONSTANTS, 1.0)
        least = IDLE if _is_too_far_off(evidence, blank) else BESIDE_OFF * pliable * evidence.effective
        return hypothesis.score - blank.score >= least

    if not simple.terms and not evidence.fitted:
        single = (h for h in ranked if len(h.terms) == 1 and rms(h.signal) > SUBSTANTIAL * size)
        best = next((h for h in single if is_needed(h) and _is_nearer(h, blank)), best)
    best = _rather_off(evidence, best, found, size)
    refit = _judge_refit(evidence, best, energy)
    if best.terms or refit.miscalibrated:
        other = _as_one_factor(evidence, best, found, energy, size)
        if other is not best:
            best, refit = other, _judge_refit(evidence, other, energy)
    if best.terms and refit.miscalibrated and not evidence.fitted and not is_needed(best):
        # The simulator is off in any case: an effect beside must be needed, not only welcome.
        best, refit = blank, _judge_refit(evidence, blank, energy)
    own = best.score + _prior(evidence, best, size)
    if best.terms and not is_refitted(best.scale):
        # What could stand in for it is judged as it is: beside an exact simulator where that is hardly worse.
        ranked = [hardly_worse(evidence, h) for h in ranked]
        likely |= {id(h): h.score + _prior(evidence, h, size) for h in ranked if id(h) not in likely}
        ranked.sort(key=lambda h: -likely[id(h)])
    scores = np.array([likely[id(h)] for h in ranked])
    choice = _stated(evidence, found, ranked, scores, best, own, refit, energy)
    if choice.verdict == [UNKNOWN] and evidence.is_beside_refit(best):
        # Doubtful beside a simulator that is off in any case; which alone may leave no more than an inexact law.
        refit = _judge_refit(evidence, blank, energy)
        alone = _stated(evidence, found, ranked, scores, blank, blank.score, refit, energy)
        if alone.verdict == [MISCALIBRATION]:
            return alone
    return choice


def _stated(
    evidence: Evidence,
    found: Sequence[Hypothesis],
    ranked: Sequence[Hypothesis],
    scores: Floats,
    best: Hypothesis,
    own: float,
    refit: _Refit,
    energy: float,
) -> Choice:
    """The verdict that follows from the hypothesis ``best``, whose score is ``own``, among those ``ranked`` by ``scores``."""
    signals, floor, blank = evidence.scene.signals, evidence.sigma, found[0]
    held, misfit_refit, miscalibrated = refit.held, refit.left, refit.miscalibrated
    expected = evidence.fitted and bool(best.terms)

    rows = evidence.rows
    after = (signals.gap - held.signal - held.recalibration) * rows
    left = max(structured_power(after, signals.runs, signals.stride), 0.0)
    gap_power = max(structured_power(signals.gap * rows, signals.runs, signals.stride), 1e-6 * floor**2)
    tempered = TEMPERATURE * effective_share(misfit_refit, signals.runs)
    posterior, odds = _weigh(evidence, ranked, scores, own, best, blank, tempered)
    others = [s for h, s in zip(ranked, scores, strict=True) if not _is_nested(h, best)]
    features = {
        "gap": float(np.sqrt(energy) / floor),
        "left_to_noise": float(np.sqrt(left) / floor),
        "left_share": left / gap_power,
        "margin": float(own - max(others)) if others else 1e3,
        "over_null": float(own - blank.score),
        "effects": float(len(best.terms)),
        "signal": rms(best.signal) / floor,
        "largest": max((rms(best.part(name)) for name in best.names), default=0.0) / floor,
        "recalibrated": refit.gain,
        "refitted": float(is_refitted(best.scale) and not expected),
        "closed": 1.0
        - (float(np.mean(np.square((after if miscalibrated else signals.gap - held.signal)[rows]))) - floor**2)
        / energy,
        "closed_alone": 1.0 - (float(np.mean(np.square((signals.gap - held.signal)[rows]))) - floor**2) / energy,
        "in_sample_left": left_to_noise(evidence, misfit_refit),
    }
    bent = (
        evidence.is_beside_refit(best)
        and not _is_clearly_there(evidence, features)
        and features["closed_alone"] < ALMOST_ALL
    )
    features["forgiven"] = float(
        np.hypot(forgiven_here(evidence, features["gap"], bent), emulated(evidence, best, energy))
    )
    verdict = sorted(best.names, key=lambda name: -float(np.mean(np.square(best.part(name)))))
    if miscalibrated and not expected:
        verdict.append(MISCALIBRATION)
    if _nothing(evidence, best, miscalibrated, features):
        verdict = []
    elif _inadequate(evidence, features) or (
        miscalibrated and not expected and _overstretched(evidence, best, features)
    ):
        verdict = [UNKNOWN]
    stated = confidence(CONFIDENCE, verdict, features)
    if verdict and verdict != [UNKNOWN] and stated < DOUBT and not evidence.fitted:
        verdict, stated = [UNKNOWN], 1.0 - stated
    step = torque_step(signals) if verdict == [] else 0.0
    frequency = hum(signals) if verdict == [] else 0.0
    standing_out = spikes(signals) if verdict == [] else 0.0
    if step > 0.0 or frequency > 0.0 or standing_out > OUTLIERS:
        # They pass for noise, but a finer or better shielded sensor would close them.
        verdict = [UNKNOWN]
    return Choice(
        verdict, stated, best, held, miscalibrated, left / gap_power, features,
        posterior, odds, list(ranked), _recalibration_rivals(evidence, verdict, best, own, found, tempered), step, frequency,
        standing_out,
    )  # fmt: skip


def _rather_off(evidence: Evidence, best: Hypothesis, found: Sequence[Hypothesis], size: float) -> Hypothesis:
    """``best``, or the same with a simulator that is off in place of one of its effects where that is no worse."""
    if evidence.fitted or is_refitted(best.scale):
        return best
    own = best.score + _prior(evidence, best, size)
    made = []
    for term in best.terms:
        name = term.effect.id
        rest = next((h for h in found if h.names == best.names - {name}), None)
        if rest is None or (name in STANDS_IN and (rest.terms or best.scale[0] < FINE)):
            # Beside others these are charged for it already; one factor on all that an exact simulator says is no error.
            continue
        scale = max((s for s in rest.by_scale if is_refitted(s)), key=rest.by_scale.__getitem__)
        off = replace(evidence.fit(rest.terms, (scale,)), by_scale=rest.by_scale)
        worse = own - off.score - _prior(evidence, off, size)
        if worse < NO_BETTER * count_unknowns([term]):
            made.append((worse, off))
    return min(made, key=lambda pair: pair[0])[1] if made else best


def _is_nearer(hypothesis: Hypothesis, blank: Hypothesis) -> bool:
    """Whether the simulator is nearer to right beside an effect; else the effect only patches what its errors leave."""
    return hypothesis.scale != blank.scale and all(a <= b for a, b in zip(hypothesis.scale, blank.scale, strict=True))


def _as_one_factor(
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
        behind = best.score - factor.score - _prior(evidence, factor, size)
        return factor if behind < AGAINST_ONE_FACTOR and leaves(factor) < ONE_FACTOR else best
    if best.names == {GAIN} and is_refitted(best.scale) and leaves(best) > SEVERAL:
        return blank
    return best


def _is_nested(one: Hypothesis, other: Hypothesis) -> bool:
    """Whether one explanation is a special case of the other."""
    a, b = special_cases(one), special_cases(other)
    return a <= b or b <= a


def _weigh(
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
    near = (SAME_WHERE_POOR if _is_poor(evidence.scene.signals) else SAME_BY_EYE) * evidence.effective
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
        elif own - score < near or hypothesis.score > best.score:
            # The latter does better but for what company costs it.
            against = max(against, 0.1)
        odds[hypothesis.names] = max(odds.get(hypothesis.names, 0.0), against)
    return posterior, odds


@dataclass(frozen=True)
class _Refit:
    """What refitting the simulator does beside a hypothesis."""

    held: HeldOut
    left: Floats
    """What the hypothesis and the refitted simulator leave."""
    gain: float
    """Share of the gap's energy that errors of the bulk close beyond those of the fine structure."""
    miscalibrated: bool


def _judge_refit(evidence: Evidence, best: Hypothesis, energy: float) -> _Refit:
    """Whether the simulator's bulk parameters are off: does their refit close more than fine structure alone does?"""
    signals, floor = evidence.scene.signals, evidence.sigma
    fixed = evidence.fit(best.terms, evidence.exact)
    recalibration = evidence.recalibration(best)
    left = evidence.left_over(best)
    gain = float(np.mean(np.square(evidence.left_over(fixed))) - np.mean(np.square(left))) / energy
    held = held_out(evidence, best)
    if best.terms:
        # What the refit closes of the gap, on unseen samples, and beyond what fine structure would close.
        rows = evidence.rows
        alone = float(np.mean(np.square((signals.gap - held.signal)[rows])))
        together = float(np.mean(np.square((signals.gap - held.signal - held.recalibration)[rows])))
        share = RECALIBRATION_SHARE_POOR if _is_poor(signals) else RECALIBRATION_SHARE
        needed = alone - together > max(share * energy, RECALIBRATION_CLEAR * floor**2)
        off = bool(needed or (is_refitted(best.scale) and gain > RECALIBRATION_WORTH))
    else:
        # With no effect at all, what the refit takes is the gap.
        off = is_refitted(best.scale) or energy > floor**2
    return _Refit(held, left, gain, off and rms(recalibration) > NEGLIGIBLE * floor)


def _is_poor(signals: Signals) -> bool:
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


def _recalibration_rivals(
    evidence: Evidence,
    verdict: Sequence[str],
    best: Hypothesis,
    own: float,
    found: Sequence[Hypothesis],
    tempered: float,
) -> list[str]:
    """Effects that a miscalibrated simulator would imitate, or be imitated by, on this recording."""
    blank = next(h for h in found if not h.terms)
    # That one factor fits all parameters is a coincidence that evidence weighs rightly, whatever the laws are.
    least = np.log(0.05) / (1.0 if best.names & set(STANDS_IN) else tempered)
    if len(best.names) == 1 and verdict == sorted(best.names):
        refitted = max((s for scale, s in blank.by_scale.items() if is_refitted(scale)), default=-np.inf)
        if _is_poor(evidence.scene.signals):
            least = min(least, -SAME_WHERE_POOR * evidence.effective)
        return sorted(best.names) if refitted - own > least else []
    if verdict == [MISCALIBRATION]:
        exact = [scale for scale in blank.by_scale if not is_refitted(scale)]
        fixed = []
        for hypothesis in found:
            # Where the fine structure is off too, it is the effect that must stand in for the errors, not that structure.
            own_worth = [h for s, h in hypothesis.by_scale.items() if s in exact and h > blank.by_scale[s] + IDLE]
            if len(hypothesis.terms) == 1 and own_worth:
                fixed.append((hypothesis, max(own_worth)))
        return sorted(
            name
            for h, s in fixed
            for name in h.names
            if s - EFFECT_COST - best.score > (np.log(0.05) if name in STANDS_IN else least)
        )
    return []


def _nothing(evidence: Evidence, best: Hypothesis, miscalibrated: bool, features: dict[str, float]) -> bool:
    floor = evidence.sigma
    if not best.terms and features["gap"] < 3.0:
        # No two models of a joint agree better than this.
        agree = float(np.std(evidence.gap)) < SAME_JOINT * float(np.std(evidence.scene.signals.y_real))
        miscalibrated = miscalibrated and not agree
    if miscalibrated or features["in_sample_left"] > NEGLIGIBLE:
        return False
    if features["gap"] < BARELY and features["closed"] < 0.0:
        # A gap as small as the noise, and an explanation that helps on no unseen sample.
        return True
    return not best.terms or rms(best.signal) < NEGLIGIBLE * floor


def _inadequate(evidence: Evidence, features: dict[str, float]) -> bool:
    """Whether the best explanation leaves structure that neither noise nor an inexact law accounts for."""
    gap, refitted = features["gap"], features["refitted"] and features["effects"] > 0
    # Effects that widen the gap until the simulator is bent to meet them explain nothing.
    least = 0.0 if features["signal"] > 1.5 * gap else WIDENING
    widened = features["closed_alone"] < least and not _is_clearly_there(evidence, features)
    if refitted and gap > 3.0 and widened:
        return True
    cancels = features["largest"] > BALANCED * gap and features["closed_alone"] < ALMOST_ALL
    if cancels and not evidence.fitted:
        return True
    # A simulator that is only off closes nearly all once it is calibrated, also where the calibration did not look.
    enough = CALIBRATED if not features["effects"] and gap > 3.0 else 0.5
    return features["in_sample_left"] > features["forgiven"] or (features["closed"] < enough and gap > BARELY)


def _is_clearly_there(evidence: Evidence, features: dict[str, float]) -> bool:
    """Whether one effect is named without which the most pliable simulator leaves much.

    Then the simulator's errors may hide a part of it, but they do not imitate it.
    """
    return features["effects"] == 1.0 and features["over_null"] >= NEEDED * evidence.effective


def _overstretched(evidence: Evidence, best: Hypothesis, features: dict[str, float]) -> bool:
    """Whether a miscalibration would have to be so large that it could imitate anything.

    It is believed where the gap is as large as such errors make, and beside an effect without which much is left.
    """
    if best.terms:
        return _needs_largest_errors(evidence, best) and features["over_null"] < NEEDED * evidence.effective
    return _is_too_far_off(evidence, best)


def _needs_largest_errors(evidence: Evidence, hypothesis: Hypothesis) -> bool:
    """Whether smaller errors than a tenth of the simulator's parameters do clearly worse beside a hypothesis."""
    largest = max(evidence.scales)
    smaller = max(score for scale, score in hypothesis.by_scale.items() if scale[1] < largest[1])
    return hypothesis.scale == largest and hypothesis.by_scale[largest] - smaller > CLEARLY_WORSE * evidence.effective


def _is_too_far_off(evidence: Evidence, blank: Hypothesis) -> bool:
    """Whether errors of a tenth would be needed to make a gap that is smaller than such errors make."""
    made = 0.5 * max(evidence.scales)[1] * float(np.std(evidence.scene.signals.y_sim))
    return _needs_largest_errors(evidence, blank) and float(np.std(evidence.gap)) < made
