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
strangers' joints with a gain the least was 7. Beside an emulator that is exact, and as exact as it is found to be."""
NEEDED = 0.1
"""Evidence a sample by which an effect must be better than what is said instead of it, to be there all the same: an emulator that
is not exact may leave so much that a part does no worse than the effect beside it. Of 13 parts that were off none lost above 0.02."""


def rather_own_parts(evidence: Evidence, best: Hypothesis) -> Hypothesis:
    """``best`` without those of its effects that are small errors of the simulator's own parts, which are said instead."""
    if evidence.fitted or not best.terms or is_refitted(best.scale):
        return best
    strictly = evidence.fit(best.terms, (EXACT,))
    as_emulated = evidence.fit(best.terms, (best.scale,))

    def is_own(name: str) -> bool:
        if name in STANDS_IN:
            # By chance an emulator's errors look like what a factor makes of friction, or like its opposite.
            return all(_is_own_stiffness(evidence, fitted, name) for fitted in (strictly, as_emulated))
        return _is_own_part(evidence, strictly, name)

    own = {name for name in best.names if is_own(name)}
    if not own:
        return best
    others = tuple(term for term in best.terms if term.effect.id not in own)
    off = [scale for scale in usual(evidence) if scale[1] > 0.0]
    rather = replace(evidence.fit(others, off), by_scale=evidence.fit(others).by_scale)
    return rather if best.score - rather.score < NEEDED * evidence.effective else best


def _is_own_part(evidence: Evidence, strictly: Hypothesis, name: str) -> bool:
    """Whether one parameter of the simulator that is off by a few per cent does as well as an effect beside the others."""
    of_part, without = _instead(evidence, strictly, name, evidence.scene.emulator.parts)
    least = min(AS_GOOD * evidence.effective, MOST * (strictly.score - without))
    return of_part > strictly.score - least


def _is_own_stiffness(evidence: Evidence, hypothesis: Hypothesis, name: str) -> bool:
    """Whether a stiffness that is off by a few per cent does as well as a factor on the torque beside the other effects."""
    of_part, _ = _instead(evidence, hypothesis, name, evidence.scene.spring[:, None])
    return of_part > hypothesis.score - THE_SAME


def _instead(evidence: Evidence, hypothesis: Hypothesis, name: str, parts: Floats) -> tuple[float, float]:
    """Logarithm of the evidence with the best of ``parts`` (n, k), off by a few per cent, in place of an effect, and with none."""
    rows, scale = evidence.rows, hypothesis.scale
    left = evidence.whitened(evidence.gap - (hypothesis.signal - hypothesis.part(name))[rows], scale)
    own = evidence.whitened(parts[rows], scale)
    energy = np.einsum("ij,ij->j", own, own)
    error = np.divide(own.T @ left, energy, out=np.full(energy.size, np.inf), where=energy > 0.0)
    few = np.abs(error) < FEW_PER_CENT
    unknowns = count_unknowns([term for term in hypothesis.terms if term.effect.id != name])

    def score(taken: float, more: int) -> float:
        return float(evidence.score(np.array([float(left @ left) - taken]), (scale,), unknowns + more)[0])

    return score(float(np.max(error[few] ** 2 * energy[few])), 1) if np.any(few) else -np.inf, score(0.0, 0)
