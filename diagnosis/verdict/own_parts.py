"""Effects that are a part of the simulator again: they are that part's error where it is a few per cent, and no effect.

A joint whose damping, mass or friction is off by 4 % needs no second damper. Beside an exact simulator one is the better explanation
only because the errors of all parameters cost more than one effect: here each of them is tried by itself.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..hypotheses.evidence import Evidence, Hypothesis, count_unknowns, is_refitted
from .own_errors import usual
from .priors import STANDS_IN

__all__ = ["rather_own_parts"]

Floats = NDArray[np.float64]
EXACT = (0.0, 0.0)
"""A simulator that is right to the last detail, but for the one parameter."""
FEW_PER_CENT = 0.07
"""Relative error of one parameter up to which it is none of another kind. Of 176 effects that were right on strangers' joints
none whose law a part of the simulator comes near needed less than 0.11, but gains."""
AS_GOOD = 0.02
"""Evidence a sample by which the part, which is emulated, may do worse. Of the same effects none with so small an error did worse
by less than 0.2, but gains."""
MOST = 0.15
"""The same as a share of what the effect brings, which may be little."""
THE_SAME = 1.0
"""Logarithm of the odds up to which a factor on the spring alone is one on the whole torque: friction would tell them apart. On 18
strangers' joints with a gain the least was 7."""
NEEDED = 0.1
"""Evidence a sample by which an effect must be better than what is said instead of it, to be there all the same: an emulator that
is not exact may leave so much that a part does no worse than the effect beside it. Of 13 parts that were off none lost above 0.02."""


def rather_own_parts(evidence: Evidence, best: Hypothesis) -> Hypothesis:
    """``best`` without those of its effects that are small errors of the simulator's own parts, which are said instead."""
    if evidence.fitted or not best.terms or is_refitted(best.scale):
        return best
    strictly = evidence.fit(best.terms, (EXACT,))
    own = {name for name in best.names if _is_own_part(evidence, strictly, name)}
    if not own:
        return best
    others = tuple(term for term in best.terms if term.effect.id not in own)
    off = [scale for scale in usual(evidence) if scale[1] > 0.0]
    rather = replace(evidence.fit(others, off), by_scale=evidence.fit(others).by_scale)
    return rather if best.score - rather.score < NEEDED * evidence.effective else best


def _is_own_part(evidence: Evidence, strictly: Hypothesis, name: str) -> bool:
    """Whether one parameter of the simulator that is off by a few per cent does as well as an effect beside the others."""
    rows = evidence.rows
    left = evidence.gap - (strictly.signal - strictly.part(name))[rows]
    is_gain = name in STANDS_IN
    parts = evidence.scene.spring[rows, None] if is_gain else evidence.scene.emulator.parts[rows]
    energy = np.einsum("ij,ij->j", parts, parts)
    error = np.divide(parts.T @ left, energy, out=np.full(energy.size, np.inf), where=energy > 0.0)
    few = np.abs(error) < FEW_PER_CENT
    if not np.any(few):
        return False
    rss = float(left @ left) - float(np.max(error[few] ** 2 * energy[few]))
    free = count_unknowns([term for term in strictly.terms if term.effect.id != name])
    of_part, without = (
        float(evidence.score(np.array([left_over]), (EXACT,), unknowns)[0])
        for left_over, unknowns in ((rss, free + 1), (float(left @ left), free))
    )
    least = THE_SAME if is_gain else min(AS_GOOD * evidence.effective, MOST * (strictly.score - without))
    return of_part > strictly.score - least
