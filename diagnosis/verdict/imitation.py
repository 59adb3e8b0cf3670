"""Laws that explain a gap, but would look the same if it were another effect's."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..emulator.emulation import SimulatorScene
from ..hypotheses.evidence import Evidence, Hypothesis, Term
from ..hypotheses.refinement import refine
from ..hypotheses.search import successors

__all__ = ["Image", "imaged_by", "imitations", "within_range", "without_image"]

Floats = NDArray[np.float64]
AS_GOOD = 3.0
"""Logarithm of the odds up to which a law within its range is as good as one that has run to the end of it."""
STARTS, MOST = 3, 3000
"""Choices of laws and starting shapes, in place of those at the end of their range, that are refined, and that are compared."""


@dataclass(frozen=True)
class Image:
    """A law that explains the gap but may be the image of an effect that is not known here."""

    term: Term
    of: Sequence[str]
    """Ids of what would look the same; of a law at the end of its range, of what it may be there."""


def without_image(hypothesis: Hypothesis) -> Hypothesis:
    """The same without another law of its effects beside an exact simulator that is an image."""
    close = hypothesis.beside_exact
    return replace(hypothesis, beside_exact=None) if close and close.images else hypothesis


def imitations(
    scene: SimulatorScene, found: Sequence[Hypothesis], best: Hypothesis, recalibration: Floats
) -> list[Image]:
    """Those of its terms that add no less what another effect would which is not known here to compete.

    By themselves, or together with what others and the simulator's ``recalibration`` (n,) make of it.
    """
    known = set().union(*(hypothesis.names for hypothesis in found))
    together = best.signal, best.signal + recalibration
    made = []
    for term in best.terms:
        imitated = (term.effect.imitates(signal, scene) for signal in (best.part(term.effect.id), *together))
        if others := set().union(*imitated) - known:
            made.append(Image(term, sorted(others)))
    return made


def within_range(evidence: Evidence, hypothesis: Hypothesis, found: Sequence[Hypothesis]) -> list[Hypothesis]:
    """The same effects by other laws in place of those at the end of their range, and with what these may be the image of
    beside them; those that do no worse to speak of.

    A set that leaves nothing was tried with few laws, and with no further effect.
    """
    others = set().union(*(term.effect.image_of for term in hypothesis.images)) - hypothesis.names
    alone = [h.terms[0] for h in found if len(h.names) == 1 and h.names <= others]
    laws = [_starts(evidence, term) if term.is_an_image else [term] for term in hypothesis.terms]
    made = (_best_of(evidence, [*laws, *beside]) for beside in ([], *([_starts(evidence, term)] for term in alone)))
    return [h for h in made if h is not None and h.score >= hypothesis.score - AS_GOOD]


def _starts(evidence: Evidence, term: Term) -> list[Term]:
    """All laws of an effect that have starting shapes, at each of these."""
    forms = [form for form in term.effect.forms(evidence.scene) if not form.refines]
    starts = [replace(term, form=form, shape=tuple(shape)) for form in forms for shape in form.grid]
    return [start for start in starts if not start.is_an_image]


def _best_of(evidence: Evidence, laws: Sequence[Sequence[Term]]) -> Hypothesis | None:
    """The best choice of one law for each effect, refined; None if it runs to the end of its range again."""
    laws = list(laws)
    while math.prod(map(len, laws)) > MOST:
        longest = max(range(len(laws)), key=lambda k: len(laws[k]))
        laws[longest] = laws[longest][::2]
    options: dict[tuple[tuple[str, str], ...], tuple[Term, ...]] = {}
    for terms in sorted(itertools.product(*laws), key=lambda terms: -evidence.sparse.fit(terms).score):
        # One law at several places would lead to the same.
        options.setdefault(tuple(term.law for term in terms), terms)
    made = [refine(evidence, evidence.fit(terms)) for terms in itertools.islice(options.values(), STARTS)]
    # Where one of these ends a law may start that it is the first step to.
    made += [better for hypothesis in tuple(made) for better in successors(evidence, hypothesis)]
    best = max((h for h in made if not h.images), key=lambda h: h.score, default=None)
    return best and replace(best, beside_exact=evidence.fit(best.terms, evidence.exact))


def imaged_by(hypothesis: Hypothesis) -> set[frozenset[str]]:
    """The sets of effects of which a hypothesis with images may be the image."""
    instead = (_imaged(term) if term.is_an_image else [{term.effect.id}] for term in hypothesis.terms)
    return {frozenset().union(*sets) for sets in itertools.product(*instead)}


def _imaged(term: Term) -> list[set[str]]:
    """What a law at the end of its range may be: another effect, or the same one by another law, alone or beside that."""
    others = term.effect.image_of
    return [{term.effect.id}, *({name} for name in others), *({term.effect.id, name} for name in others)]
