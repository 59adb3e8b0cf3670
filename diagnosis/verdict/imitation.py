"""Laws that explain a gap, but would look the same if it were another effect's."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..emulator.emulation import SimulatorScene
from ..hypotheses.evidence import Hypothesis, Term

__all__ = ["Image", "imaged_by", "imitations", "without_image"]

Floats = NDArray[np.float64]


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


def imaged_by(hypothesis: Hypothesis) -> set[frozenset[str]]:
    """The sets of effects of which a hypothesis with images may be the image."""
    instead = (term.effect.image_of if term.is_an_image else (term.effect.id,) for term in hypothesis.terms)
    return {frozenset(names) for names in itertools.product(*instead)}
