"""Whether what drifts or wears goes on with the clock that its cause has.

Where one cause is not known here, the other explains a slow change nearly as well; but its own laws do better if time and travel
change places.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from ..effects.base import CLOCKS, Form
from ..emulator.emulation import SimulatorScene
from ..hypotheses.evidence import Evidence, Hypothesis, Term
from ..hypotheses.refinement import refine
from ..recording.signals import Floats, Signals
from .rivals import SAME_BY_EYE

__all__ = ["OtherClock", "follows_another_clock"]

TRIED = 3
"""Laws that are refined on another clock."""


@dataclass(frozen=True)
class OtherClock:
    """An effect of the verdict that would explain more if it followed another clock, one of no effect that is known here."""

    term: Term
    clock: str


def follows_another_clock(evidence: Evidence, hypothesis: Hypothesis, found: Sequence[Hypothesis]) -> OtherClock | None:
    """The effect of ``hypothesis`` whose laws do better on another clock; None where an effect that has that one is ``found``."""
    if not evidence.scene.signals.timed:
        return None
    known = {term.effect.clock for h in found for term in h.terms}
    for k, term in enumerate(hypothesis.terms):
        for clock in CLOCKS:
            if not term.effect.clock or clock in known:
                continue
            others = hypothesis.terms[:k] + hypothesis.terms[k + 1 :]
            best = _best_on(evidence, term, others, clock)
            if best - hypothesis.score > SAME_BY_EYE * evidence.effective:
                return OtherClock(term, clock)
    return None


def _best_on(evidence: Evidence, term: Term, others: tuple[Term, ...], clock: str) -> float:
    """Evidence for the best of an effect's laws on another clock."""
    scene = SimulatorScene(_changed(evidence.scene.signals, term.effect.clock, clock), evidence.scene.emulator)

    def on_it(form: Form) -> Form:
        def columns(_: object, shape: tuple[float, ...]) -> Floats:
            return form.columns(scene, shape)

        return replace(form, name=f"{form.name}, on another clock", columns=columns)

    starts = []
    for form in (on_it(form) for form in term.effect.forms(scene) if form.grid):
        terms = (replace(term, form=form, shape=shape) for shape in form.grid)
        starts.append(max((evidence.fit([*others, each]) for each in terms), key=lambda h: h.score))
    likeliest = sorted(starts, key=lambda h: -h.score)[:TRIED]
    return max(refine(evidence, start).score for start in likeliest)


def _changed(signals: Signals, one: str, other: str) -> Signals:
    """The same in which the clock ``one`` shows what the ``other`` does, over as long a time or way."""
    changed = replace(signals)
    shown, kept = getattr(signals, other), getattr(signals, one)
    # A cached property is what its instance's dictionary says.
    vars(changed)[one] = shown * (float(kept.max()) / max(float(shown.max()), 1e-300))
    return changed
