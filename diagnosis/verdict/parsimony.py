"""The simplest of the explanations that do: effects that are not worth naming are left out again."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..effects.base import INPUT
from ..hypotheses.adequacy import ALMOST_ALL, INEXACT_NEAR, is_adequate, left_by
from ..hypotheses.evidence import Evidence, Hypothesis, is_refitted
from ..hypotheses.heldout import held_out
from ..hypotheses.search import NOTHING

__all__ = ["beside_exact", "fewest", "hardly_worse", "in_place_of", "simplest", "special_cases"]

WORTH = 0.04
"""Share of the gap's energy that an effect must close beside the others."""
WORTH_FITTED = 0.1
"""The same beside a model that was fitted to the joint: there the largest cause is asked for."""
INDIFFERENT = 0.1
"""The same as a share of the noise's energy, whatever the gap."""
CONTAINED = 0.001
"""Share of the effect's energy within which a special case is preferred to the general effect."""
HARDLY_WORSE = 0.02
"""Evidence a sample that a refitted simulator must bring beside an effect to be more than that effect's own misfit."""
WELL_ABOVE = 6.0
"""Gap over noise from which little that is left can be told from nothing."""
MANY = 3
"""Of so many effects beside an exact simulator, one might be what stands in for a refit."""
PATCHES = 0.3
"""Evidence a sample that further effects may bring although there is nothing left for them to explain."""
ONE_MORE = 0.1
"""Evidence a sample that one effect may bring of several that leave nothing beside an exact simulator, and not be one of them."""
FURTHER = 0.05
"""The same beside an exact simulator, where nothing but a law that is not quite exact gives them anything to explain."""


def simplest(evidence: Evidence, ranked: Sequence[Hypothesis], energy: float) -> Hypothesis:
    """The best hypothesis, less the effects that are not worth naming, general effects replaced by special cases.

    Whether an effect alone is better than none is for the evidence to say; here only company is judged.
    """
    top = best = ranked[0]
    worth = WORTH_FITTED if evidence.fitted else WORTH
    by_names: dict[frozenset[str], Hypothesis] = {}
    for hypothesis in ranked:
        by_names.setdefault(hypothesis.names, hypothesis)

    def beside_same_simulator(names: frozenset[str]) -> tuple[Hypothesis | None, float]:
        known = by_names.get(names)
        if known is None:
            return None, np.inf
        laws = [known.terms, *([known.beside_exact.terms] if known.beside_exact else ())]
        fitted = min((evidence.fit(terms, (top.scale,)) for terms in laws), key=lambda h: h.rss)
        fitted.by_scale, fitted.beside_exact = known.by_scale, known.beside_exact
        return fitted, (left_of(fitted) - left_of_top()) / energy

    def left_of(hypothesis: Hypothesis) -> float:
        """Mean square left over; beside a model that was fitted to the joint, which bends to anything, on unseen samples."""
        return _left_unseen(evidence, hypothesis) if evidence.fitted else hypothesis.rss / evidence.size

    @functools.cache
    def left_of_top() -> float:
        return left_of(top)

    def does_without_refit(names: frozenset[str], fewer: frozenset[str]) -> bool:
        """Whether effects beside an exact simulator explain the gap better than fewer do beside one that is off."""
        exact, refitted = by_names[names].beside_exact, by_names[fewer]
        if evidence.fitted or exact is None or not is_refitted(refitted.scale) or exact.score <= refitted.score:
            return False
        patched = exact.score - beside_exact(evidence, refitted).score <= PATCHES * evidence.effective
        return (
            len(names) < MANY
            and not patched
            and _closes_almost_all(evidence, exact, energy)
            and is_adequate(evidence, exact, energy)
        )

    @functools.cache
    def leaves_nothing() -> bool:
        """An inexact law that another effect patches leaves something, or it needs a simulator that is off.

        What acts on the deflection is known only as far as the simulator is emulated.
        """
        known = all(term.effect.acts_on != INPUT for term in top.terms)
        return known and not evidence.fitted and not is_refitted(top.scale) and left_by(evidence, top) < NOTHING

    changed, explained = True, is_adequate(evidence, top, energy)
    while changed:
        changed = False
        options: list[tuple[float, Hypothesis]] = []
        for name in best.names:
            size = evidence.rms_of(best.part(name)) ** 2 / energy
            if len(best.names) > 1:
                smaller, loss = beside_same_simulator(best.names - {name})
                if smaller is None:
                    continue
                indifferent = loss * energy < INDIFFERENT * evidence.sigma**2
                # Beside a fitted model two effects may share one cause in any proportion.
                little = loss < worth and (evidence.fitted or size < 3.0 * worth)
                enough = indifferent or (
                    little and (not explained or is_adequate(evidence, by_names[smaller.names], energy))
                )
                lost = best.score - by_names[smaller.names].score
                if lost > ONE_MORE * evidence.effective and leaves_nothing():
                    continue
                if enough and not does_without_refit(best.names, smaller.names):
                    options.append((loss, smaller))
            for special in next(term.effect for term in best.terms if term.effect.id == name).contains:
                other, loss = beside_same_simulator((best.names - {name}) | {special})
                if other is not None and loss < CONTAINED * min(size, 1.0):
                    options.append((loss, other))
        if options:
            best, changed = min(options, key=lambda option: option[0])[1], True
    if best is top:
        return best
    # What little was left out may be the simulator's: the rest is judged beside the simulator that suits it.
    own = by_names[best.names]
    own = own if own.score > best.score else best
    # ``ranked`` begins with the most probable: one as simple that comes before was not what the first was simplified to.
    before = ranked[: ranked.index(by_names[best.names])]
    rival = next((h for h in before if 0 < len(h.terms) <= len(best.terms) and special_cases(h) != best.names), own)
    return rival if rival.score > own.score else own


def _left_unseen(evidence: Evidence, hypothesis: Hypothesis) -> float:
    """Mean square that a hypothesis and the refitted simulator leave where no fit saw the gap."""
    held, rows = held_out(evidence, hypothesis), evidence.rows
    return float(np.mean(np.square(evidence.gap - (held.signal + held.recalibration)[rows])))


def special_cases(hypothesis: Hypothesis) -> frozenset[str]:
    """Names of the effects with the general ones replaced by their special cases."""
    return frozenset(name for t in hypothesis.terms for name in (t.effect.contains or (t.effect.id,)))


def fewest(evidence: Evidence, ranked: Sequence[Hypothesis], best: Hypothesis, energy: float) -> Hypothesis:
    """The fewest effects that leave no more than an inexact law may, beside a simulator that is exact.

    What is left is significant wherever the noise is low, and further effects or a refit patch it; but the gap is
    explained.
    """
    if evidence.fitted or not best.terms or (len(best.terms) == 1 and not is_refitted(best.scale)):
        return best
    exact = hardly_worse(evidence, best)
    gap = float(np.sqrt(energy)) / evidence.sigma
    if gap < WELL_ABOVE:
        return exact
    allowed, least = INEXACT_NEAR * gap, best.score - (PATCHES if exact is best else FURTHER) * evidence.effective

    def leaves_little(hypothesis: Hypothesis) -> bool:
        return left_by(evidence, hypothesis) <= allowed

    blank = next(h for h in ranked if not h.terms)
    if exact is best and leaves_little(blank):
        # A simulator that is off would do: it needs no effects beside it, but where there are any it may be right.
        return blank if len(best.terms) > 1 and is_refitted(best.scale) and blank.score > least else best
    for size in range(1, len(best.terms) + 1):
        made = []
        for hypothesis in ranked:
            if len(hypothesis.terms) != size or (size == len(best.terms) and hypothesis.names != best.names):
                continue
            beside = beside_exact(evidence, hypothesis)
            if beside.score > least and _closes_almost_all(evidence, beside, energy) and leaves_little(beside):
                made.append((beside.score, in_place_of(hypothesis, beside)))
        if made:
            return max(made, key=lambda pair: pair[0])[1]
    return exact


def hardly_worse(evidence: Evidence, hypothesis: Hypothesis) -> Hypothesis:
    """The same effects beside an exact simulator where a refitted one is hardly better; else ``hypothesis``."""
    close = hypothesis.beside_exact
    few = len(hypothesis.terms) < MANY
    if evidence.fitted or not few or close is None:
        return hypothesis
    near = close.score > hypothesis.score - HARDLY_WORSE * evidence.effective
    return in_place_of(hypothesis, close) if near else hypothesis


def beside_exact(evidence: Evidence, hypothesis: Hypothesis) -> Hypothesis:
    """The best that is known of the same effects beside an exact simulator."""
    return hypothesis.beside_exact or evidence.fit(hypothesis.terms, evidence.exact)


def _closes_almost_all(evidence: Evidence, hypothesis: Hypothesis, energy: float) -> bool:
    """Whether effects close it by themselves: not by what even an exact simulator's fine structure may take."""
    left = float(np.mean(np.square(evidence.gap - hypothesis.signal[evidence.rows]))) - evidence.sigma**2
    return left <= (1.0 - ALMOST_ALL) * energy


def in_place_of(hypothesis: Hypothesis, beside: Hypothesis) -> Hypothesis:
    """``beside``, found beside an exact simulator, with the evidence that there is for the same effects beside any."""
    by_scale = {**hypothesis.by_scale, **beside.by_scale}
    return replace(beside, by_scale=by_scale, score=max(hypothesis.score, beside.score))
