"""From fitted hypotheses to a verdict with a calibrated confidence."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..hypotheses.adequacy import ALMOST_ALL, emulated, forgiven_here, left_to_noise
from ..hypotheses.evidence import Evidence, Hypothesis, is_refitted
from ..hypotheses.heldout import HeldOut, held_out
from ..hypotheses.refinement import polish
from ..hypotheses.search import NOTHING
from ..names import GAIN, MISCALIBRATION, UNKNOWN
from ..recording.hum import hum
from ..recording.noise import rms, structured_power
from ..recording.quantisation import torque_step
from ..recording.roughness import roughness
from ..recording.spikes import OUTLIERS, spikes
from .calibration import CONFIDENCE, confidence, stated
from .clocks import OtherClock, follows_another_clock
from .imitation import Image, imaged_by, imitations, within_range, without_image
from .one_factor import as_one_factor, constant_of_all, factor_of_all, may_be_a_factor
from .outsiders import Instead, instead
from .own_errors import OwnErrors, needs_largest, rather_errors, rather_off, rather_two
from .own_parts import rather_own_parts
from .parsimony import fewest, hardly_worse, simplest
from .priors import STANDS_IN, prior
from .rivals import SAME_BY_EYE, TEMPERATURE, effective_share, is_nested, is_poor, recalibration_rivals, weigh

__all__ = ["ENOUGH", "Choice", "choose"]

Floats = NDArray[np.float64]
NEEDED = 0.2
"""Evidence a sample by which an effect must be needed beside a simulator that is off by a tenth."""
DOUBT = 0.2
"""A cause less probable than this is not named; of those between this and a half most are right, and an honest figure is stated."""
DOUBT_INSTEAD = 0.6
"""The same of one effect in place of several that are not named."""
DOUBT_IN_COMPANY = 0.5
"""The same of several effects beside a simulator that is off as well: together they can imitate anything."""
BALANCED = 2.0
"""Size of an effect over the gap's beyond which others and the refitted simulator would have to cancel it: that is no
explanation unless the effects close almost all of the gap by themselves, or without the one much is left. Beside an exact
simulator it may be: of 158 pairs on development joints that do so, it was right for each of the 5 of which nearly all was closed
but not all, and no effect that was withheld was explained so."""
CALIBRATED = 0.8
"""Share of a clear gap that a calibration alone must close."""
ENOUGH = 0.5
"""The same of any gap and any explanation, to be named."""
NEGLIGIBLE = 0.7
"""An effect smaller than this share of the noise is no gap beyond the noise."""
LITTLE = 0.1
"""Size of an explanation over that of the gap below which it explains nothing."""
SUBSTANTIAL = 0.3
"""Size of an effect over the gap's that is more than a patch on a simulator that is off."""
SWAPPED = 2
"""Effects in one of two sets only, where one effect is in the place of another."""
IMAGED = 0.85
"""Confidence that what explains the gap only as an image of another effect is not its cause: 13 of 13 on development joints."""
FACTOR = 0.75
"""The same that a factor which the usual errors do not make is a gain: 15 of 19 on strangers' joints."""
BARELY = 1.2
"""Gap over noise up to which it is not asked how much of it is closed: noise decides that."""
LOOKS = 2
"""Sets of effects that are left out in turn where their laws run to the end of their range only on all samples."""
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
    tempered: float
    """Share of the evidence that is trusted between alternatives: less where what is left is correlated."""
    torque_step: float = 0.0
    """Step in which the recorded torque comes, N·m, where it makes up the gap; 0 otherwise."""
    hum: float = 0.0
    """Frequency of a hum that makes up the gap, Hz; 0 otherwise."""
    spikes: float = 0.0
    """Share of the samples that stand out and make up the gap; 0 otherwise."""
    roughness: float = 0.0
    """How many times stronger what passes for noise is while the joint moves, where that makes up the gap; 0 otherwise."""
    images: Sequence[Image] = ()
    clock: OtherClock | None = None
    """The effect that explains the gap, but goes on with another clock than it should."""
    outsider: Instead | None = None
    """What is no effect here, but explains the gap in place of one that is its image."""
    strained: bool = False
    """Whether the simulator's own parameters would make the gap, but would have to be off by far too much."""
    factor: float = 0.0
    """Relative error of all that the simulator says which alone makes the gap, where no effect known here does that; 0 otherwise."""
    constant: float = 0.0
    """The same of a constant torque, N·m."""

    @property
    def explained(self) -> Floats:
        """What the hypothesis and the simulator's errors, where it is off, make of the gap on samples that no fit saw, shape (n,)."""
        return self.held.signal + self.held.recalibration if self.miscalibrated else self.held.signal


def choose(evidence: Evidence, found: Sequence[Hypothesis]) -> Choice:
    """Weigh the hypotheses (the empty one first) and state the verdict."""
    choice = _looked_over(evidence, found)
    return replace(choice, confidence=stated(choice.confidence))


def _looked_over(evidence: Evidence, found: Sequence[Hypothesis]) -> Choice:
    """What is chosen, or what is instead of it if it is blamed on a law at the end of its range."""
    choice = _chosen(evidence, found)
    own = choice.hypothesis
    if not _is_an_image(choice):
        return choice
    # What a law at the end of its range is the image of may be known, and explain the gap itself; or another law does.
    better = {h.names: h for h in within_range(evidence, own, found)}
    inside = [*(without_image(h) for h in found if not h.images and h.names not in better), *better.values()]
    again = _chosen(evidence, inside)
    for _ in range(LOOKS):
        if not _is_an_image(again):
            break
        inside = [h for h in inside if h.names != again.hypothesis.names]
        again = _chosen(evidence, inside)
    other = again.hypothesis
    known = other.names < own.names or other.names in imaged_by(own)
    if again.verdict != [UNKNOWN] and (known or _is_as_good(evidence, other, own)):
        return again
    return choice


def _is_an_image(choice: Choice) -> bool:
    return any(image.term.is_an_image for image in choice.images)


def _is_as_good(evidence: Evidence, one: Hypothesis, other: Hypothesis) -> bool:
    """Whether some of the same effects, by other laws or beside a simulator that is off, do as well."""
    near = SAME_BY_EYE * evidence.effective
    return bool(one.names) and one.names <= other.names and one.by_scale[one.scale] > other.by_scale[other.scale] - near


def _as_itself(evidence: Evidence, hypothesis: Hypothesis, size: float) -> Hypothesis:
    """The same without other laws of its effects beside an exact simulator that are only special cases of themselves there."""
    close = hypothesis.beside_exact
    return replace(hypothesis, beside_exact=None) if close and prior(evidence, close, size) == -np.inf else hypothesis


def _odds(evidence: Evidence, hypothesis: Hypothesis, size: float) -> float:
    """Logarithm of a hypothesis' odds, or of those of the same effects beside an exact simulator where these are better.

    What a simulator that is off costs several effects may be more than it brings. But what errors of all its parameters nearly
    make is no cheaper without them.
    """
    own, close = hypothesis.score + prior(evidence, hypothesis, size), hypothesis.beside_exact
    if len(hypothesis.terms) < 2 or close is None or close.images or not hypothesis.names.isdisjoint(STANDS_IN):
        return own
    return max(own, close.score + prior(evidence, close, size))


def _chosen(evidence: Evidence, found: Sequence[Hypothesis]) -> Choice:
    floor = evidence.sigma
    energy = max(float(np.mean(np.square(evidence.gap))) - floor**2, 1e-6 * floor**2)
    size = max(rms(evidence.gap), floor)
    found = [_as_itself(evidence, h, size) for h in found if np.isfinite(prior(evidence, h, size))]
    likely = {id(h): _odds(evidence, h, size) for h in found}
    ranked = sorted(found, key=lambda h: -likely[id(h)])
    simple = simplest(evidence, ranked, energy)
    best = rather_errors(evidence, found, fewest(evidence, ranked, simple, energy))
    blank = found[0]

    errors = OwnErrors(evidence, blank, energy)
    if not simple.terms and not evidence.fitted:
        single = (h for h in ranked if len(h.terms) == 1 and evidence.rms_of(h.signal) > SUBSTANTIAL * size)
        best = next((h for h in single if errors.is_needed(h) and errors.are_smaller_beside(h)), best)
    spared = None if best.terms else errors.spared(ranked)
    if spared:
        best = spared
        # Nor is anything else believed beside errors beyond the usual ones.
        likely = {id(h): likely[id(h)] + errors.believed(h) for h in found}
        ranked = sorted(found, key=lambda h: -likely[id(h)])
    two = rather_two(evidence, found, best, energy)
    # A gain beside what undoes it on one of the simulator's parts is an error of the rest.
    if two is not best and (GAIN not in two.names or rather_own_parts(evidence, two) is two):
        best = two
    best = best if errors.spares(best) else rather_off(evidence, best, blank, size)
    best = polish(evidence, best)
    refit = _judge_refit(evidence, best, energy)
    if best.terms or refit.miscalibrated:
        other = as_one_factor(evidence, best, found, energy, size)
        if other is not best:
            best, refit = other, _judge_refit(evidence, other, energy)
    # What is no gap beyond the noise is no error either.
    rather = rather_own_parts(evidence, best) if evidence.rms_of(best.signal) > NEGLIGIBLE * floor else best
    is_own = rather is not best
    if is_own:
        # However little of the gap that is.
        best, refit = rather, replace(_judge_refit(evidence, rather, energy), miscalibrated=True)
    if (
        best.terms
        and best.names != {GAIN}
        and refit.miscalibrated
        and not evidence.fitted
        and not errors.is_needed(best)
    ):
        # The simulator is off in any case: an effect beside must be needed, not only welcome. Of one factor that is known.
        best, refit = blank, _judge_refit(evidence, blank, energy)
    if prior(evidence, best, size) == -np.inf:
        # Beside another simulator its law is only a special case.
        best = next(h for h in found if h.names == best.names)
        refit = _judge_refit(evidence, best, energy)
    own = best.score + prior(evidence, best, size)
    if best.terms and not is_refitted(best.scale):
        # What could stand in for it is judged as it is: beside an exact simulator where that is hardly worse.
        ranked = [hardly_worse(evidence, h) for h in ranked]
        likely |= {id(h): h.score + prior(evidence, h, size) for h in ranked if id(h) not in likely}
        ranked.sort(key=lambda h: -likely[id(h)])
    scores = np.array([likely[id(h)] for h in ranked])
    field = _Field(evidence, found, ranked, scores, energy, errors, is_own)
    choice = _stated(field, best, own, refit)
    doubtful = choice.verdict == [UNKNOWN] and evidence.is_beside_refit(best)
    return _rather_one(field, best, choice, size) if doubtful else choice


@dataclass(frozen=True)
class _Field:
    """What a verdict is chosen from."""

    evidence: Evidence
    found: Sequence[Hypothesis]
    """The empty hypothesis first."""
    ranked: Sequence[Hypothesis]
    scores: Floats
    """Of those ranked, shape (m,), with their prior odds."""
    energy: float
    """Mean square of the gap beyond the noise."""
    errors: OwnErrors
    is_own: bool
    """Whether one of its parts that is off does as well as an effect."""

    def scored(self) -> list[tuple[Hypothesis, float]]:
        """Those ranked, each with its score."""
        return list(zip(self.ranked, self.scores.tolist(), strict=True))


def _rather_one(field: _Field, best: Hypothesis, choice: Choice, size: float) -> Choice:
    """What is said in place of ``choice``, which is in doubt of ``best`` beside a simulator that is off in any case.

    Where without a certain effect much is left, that one, whose law may need a patch; else the simulator alone, where that
    leaves no more than an inexact law may.
    """
    evidence, blank = field.evidence, field.found[0]
    single = max((h for h in field.found if len(h.terms) == 1), key=lambda h: h.score)
    clear = single.score - blank.score > NEEDED * evidence.effective
    if clear and single.names == best.names:
        return choice
    one = polish(evidence, single if clear else blank)
    own = one.score + prior(evidence, one, size)
    other = _stated(field, one, own, _judge_refit(evidence, one, field.energy))
    if clear:
        return other if other.verdict != [UNKNOWN] and other.confidence > DOUBT_INSTEAD else choice
    return other if other.verdict == [MISCALIBRATION] else choice


def _stated(field: _Field, best: Hypothesis, own: float, refit: _Refit) -> Choice:
    """The verdict that follows from the hypothesis ``best``, whose score is ``own``."""
    evidence, found, energy = field.evidence, field.found, field.energy
    signals, floor, blank = evidence.scene.signals, evidence.sigma, found[0]
    held, misfit_refit, miscalibrated = refit.held, refit.left, refit.miscalibrated
    expected = evidence.fitted and bool(best.terms)

    rows = evidence.rows
    after = (signals.gap - held.signal - held.recalibration) * rows
    left = max(structured_power(after, signals.runs, signals.stride), 0.0)
    gap_power = max(structured_power(signals.gap * rows, signals.runs, signals.stride), 1e-6 * floor**2)
    tempered = TEMPERATURE * effective_share(misfit_refit, signals.runs)
    posterior, odds = weigh(evidence, field.ranked, field.scores, own, best, blank, tempered)
    ranked = field.scored()
    others = [score for h, score in ranked if not is_nested(h, best)]
    # What is not worth naming beside the verdict's effects speaks for them no less.
    supported = max([own, *(score for h, score in ranked if best.names and best.names < h.names)])
    features = {
        "gap": float(np.sqrt(energy) / floor),
        "left_to_noise": float(np.sqrt(left) / floor),
        "left_share": left / gap_power,
        "margin": supported - max(others) if others else 1e3,
        "over_null": float(own - blank.score),
        "effects": float(len(best.terms)),
        "signal": evidence.rms_of(best.signal) / floor,
        "largest": max((evidence.rms_of(best.part(name)) for name in best.names), default=0.0) / floor,
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
    verdict = sorted(best.names, key=lambda name: -evidence.rms_of(best.part(name)))
    images: list[Image] = []
    factor, constant, clock, other, strained, blamed = 0.0, 0.0, None, None, False, False
    if miscalibrated and not expected:
        verdict.append(MISCALIBRATION)
    if _nothing(evidence, best, miscalibrated, features, field.is_own):
        verdict = []
    elif _inadequate(evidence, features, field.errors.spares(best)) or (
        miscalibrated and not expected and _overstretched(evidence, best, features)
    ):
        verdict = [UNKNOWN]
    elif not evidence.fitted:
        images = [Image(term, term.effect.image_of) for term in best.images]
        images = images or imitations(evidence.scene, found, best, refit.recalibration)
        if verdict == [MISCALIBRATION]:
            factor, constant = factor_of_all(evidence, found, energy), constant_of_all(evidence, found, energy)
            strained = field.errors.are_beyond_belief
        clock = follows_another_clock(evidence, best, found)
        other = instead(evidence, best)
        blamed = bool(images or factor or constant or clock or other or strained)
        verdict = [UNKNOWN] if blamed else verdict
    sure = confidence(CONFIDENCE, verdict, features)
    if blamed:
        # Little is left over, which says otherwise that the verdict ought to be another.
        sure = max(sure, IMAGED)
    if best.names == {GAIN} and GAIN in verdict and may_be_a_factor(evidence, energy):
        sure = max(sure, FACTOR)
    if verdict and verdict != [UNKNOWN] and not evidence.fitted:
        crowded = len(verdict) > 2 and MISCALIBRATION in verdict
        if sure < (DOUBT_IN_COMPANY if crowded else DOUBT):
            either = 0.0 if crowded else _either_of_two(field, best, verdict, features, supported)
            # Of two the one named is the likelier.
            verdict, sure = ([UNKNOWN], 1.0 - sure) if either < DOUBT else (verdict, max(sure, 0.5 * either))
    step = frequency = standing_out = rough = 0.0
    if not verdict:
        step, frequency, rough = torque_step(signals), hum(signals), roughness(signals)
        # What a simulator that is off by a little would close is no spike, nor is what its refit makes of one.
        smaller = np.minimum(np.abs(signals.gap), np.abs(misfit_refit))[rows]
        standing_out = spikes(smaller / signals.noise_floor)
    if step > 0.0 or frequency > 0.0 or rough > 0.0 or round(standing_out * evidence.size) > OUTLIERS:
        # They pass for noise, but a finer or better shielded sensor, or a denser recording, would tell or close them.
        verdict = [UNKNOWN]
    rivals = recalibration_rivals(evidence, verdict, best, own, found, tempered, energy)
    return Choice(
        verdict, sure, best, held, miscalibrated, left / gap_power, features,
        posterior, odds, list(field.ranked), rivals, tempered,
        step, frequency, standing_out, rough, images, clock, other, strained, factor, constant,
    )  # fmt: skip


def _either_of_two(
    field: _Field, best: Hypothesis, verdict: Sequence[str], features: Mapping[str, float], supported: float
) -> float:
    """Confidence in effects of which one may have to be swapped for another: told as ambiguous, it is no doubt of all."""
    swapped = {h.names: score for h, score in field.scored() if len(h.names ^ best.names) == SWAPPED}
    # Of a single effect any other would be a swap.
    told = swapped.keys() if len(best.names) > 1 else {max(swapped, key=swapped.__getitem__, default=frozenset())}
    apart = [score for h, score in field.scored() if not is_nested(h, best) and h.names not in told]
    return confidence(CONFIDENCE, verdict, {**features, "margin": supported - max(apart, default=-np.inf)})


@dataclass(frozen=True)
class _Refit:
    """What refitting the simulator does beside a hypothesis."""

    held: HeldOut
    left: Floats
    """What the hypothesis and the refitted simulator leave."""
    recalibration: Floats
    """What refitting the simulator adds, shape (n,)."""
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
        share = RECALIBRATION_SHARE_POOR if is_poor(signals) else RECALIBRATION_SHARE
        needed = alone - together > max(share * energy, RECALIBRATION_CLEAR * floor**2)
        # Errors of a tenth that would make so little are the law's misfit; those of a fitted model are expected.
        likely = is_refitted(best.scale) and (evidence.fitted or not needs_largest(evidence, best))
        off = bool(needed or (likely and gain > RECALIBRATION_WORTH))
    else:
        # With no effect at all, what the refit takes is the gap.
        off = is_refitted(best.scale) or energy > floor**2
    return _Refit(held, left, recalibration, gain, off and evidence.rms_of(recalibration) > NEGLIGIBLE * floor)


def _nothing(
    evidence: Evidence, best: Hypothesis, miscalibrated: bool, features: dict[str, float], is_own: bool
) -> bool:
    floor = evidence.sigma
    if not best.terms and features["gap"] < 3.0 and not is_own:
        # No two models of a joint agree better than this.
        agree = float(np.std(evidence.gap)) < SAME_JOINT * float(np.std(evidence.scene.signals.y_real))
        miscalibrated = miscalibrated and not agree
    if miscalibrated or features["in_sample_left"] > NEGLIGIBLE:
        return False
    if features["gap"] < BARELY and features["closed"] < 0.0:
        # A gap as small as the noise, and an explanation that helps on no unseen sample.
        return True
    # What is left is noise in any case, and of a large gap little is anything else.
    return not best.terms or evidence.rms_of(best.signal) < max(NEGLIGIBLE, LITTLE * features["gap"]) * floor


def _inadequate(evidence: Evidence, features: dict[str, float], spares: bool) -> bool:
    """Whether the best explanation leaves structure that neither noise nor an inexact law accounts for.

    What ``spares`` the simulator errors that nobody would believe may have others against it.
    """
    gap, refitted = features["gap"], features["refitted"] and features["effects"] > 0
    # Effects that widen the gap until the simulator is bent to meet them explain nothing.
    least = 0.0 if features["signal"] > 1.5 * gap else WIDENING
    widened = features["closed_alone"] < least and not _is_clearly_there(evidence, features)
    if refitted and gap > 3.0 and widened and not spares and not _is_partly_hidden(features):
        return True
    # Effects may cancel each other, but a simulator that cancels them can imitate anything.
    cancels = refitted and features["largest"] > BALANCED * gap and features["closed_alone"] < ALMOST_ALL
    if cancels and not _is_clearly_there(evidence, features):
        return True
    # A simulator that is only off closes nearly all once it is calibrated, also where the calibration did not look.
    enough = CALIBRATED if not features["effects"] and gap > 3.0 else ENOUGH
    return features["in_sample_left"] > features["forgiven"] or (features["closed"] < enough and gap > BARELY)


def _is_clearly_there(evidence: Evidence, features: dict[str, float]) -> bool:
    """Whether one effect is named without which the most pliable simulator leaves much.

    Then the simulator's errors may hide a part of it, but they do not imitate it.
    """
    return features["effects"] == 1.0 and features["over_null"] >= NEEDED * evidence.effective


def _is_partly_hidden(features: dict[str, float]) -> bool:
    """Whether one effect of about the gap's size leaves nothing beside errors of the simulator: these are as likely to hide a part of it as to add to it."""
    is_one = features["effects"] == 1.0 and features["signal"] <= BALANCED * features["gap"]
    return is_one and features["in_sample_left"] < NOTHING


def _overstretched(evidence: Evidence, best: Hypothesis, features: dict[str, float]) -> bool:
    """Whether a miscalibration beside an effect would have to be so large that it could imitate anything.

    It is believed beside an effect without which much is left.
    """
    is_idle = features["over_null"] < NEEDED * evidence.effective
    return bool(best.terms) and is_idle and needs_largest(evidence, best)
