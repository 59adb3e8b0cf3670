"""Whether what explains a gap is only the image of a cause that is no effect here."""

from __future__ import annotations

from dataclasses import dataclass, replace

from ..hypotheses.evidence import Evidence, Hypothesis, Term
from ..hypotheses.refinement import refine

__all__ = ["Instead", "instead"]

BETTER = 10.0
"""Logarithm of the odds by which a cause that is no effect here must do better to be the likelier, or may do worse where both look the
same. Of 53 encoder errors on strangers' joints detents did worse by 770 at least. Of 13 detents, five of which passed for such an error,
they did better by 350 at least on ten; on two, by the law of a linear spring alone, they were between -4 and 2, and one was unknown
in any case."""


@dataclass(frozen=True)
class Instead:
    """An effect of the verdict, and in words what is none here and explains the gap in its place."""

    term: Term
    what: str


def instead(evidence: Evidence, hypothesis: Hypothesis) -> Instead | None:
    """What is no effect here but explains the gap so well in place of one of a hypothesis' effects that it is likelier."""
    for k, term in enumerate(hypothesis.terms):
        other = term.effect.outsider(term.form, term.shape, evidence.scene)
        if other is None:
            continue
        beside = hypothesis.terms[:k] + hypothesis.terms[k + 1 :]
        tried = (evidence.fit([*beside, replace(term, form=other.form, shape=shape)]) for shape in other.starts)
        best = refine(evidence, max(tried, key=lambda h: h.score))
        if best.score > max(hypothesis.by_scale.values()) + (-BETTER if other.alike else BETTER):
            return Instead(term, other.what)
    return None
