"""How far off a simulator's own parameters would have to be to explain a gap by themselves."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..hypotheses.evidence import Evidence

__all__ = ["is_beyond_belief", "is_strained", "largest_error"]

Floats = NDArray[np.float64]
BELIEVED = 150.0
"""Sum of the squared errors of all parameters, over those of one that is off by a tenth, up to which a simulator is only badly
calibrated. Of 79 strangers' simulators that were off by 3 to 5 % two needed more, which were followed to 3 and 4 % only; of 15 that
were blamed for an effect not known here 7."""
LARGEST = 6.0
"""The same of one parameter's error: 4.5 at most on the former; one more of the latter needs more."""
BEYOND_BELIEF, LARGEST_AT_ALL = 400.0, 10.0
"""The same of a simulator that is not even badly calibrated, though no effect known here explains the gap either. Of 188 strangers'
simulators that were off by 3 to 5 % alone eight, followed to 0.1 to 0.6 %, had been called unknown for errors of up to 290 and 8.2;
of 186 gaps of effects not known here none was, and those that errors could make needed 640, or 12.8 of one."""
FINE = 0.5
"""Weight of the errors of fine structure: neighbouring elements make up for each other, and for what an emulator lacks."""


def is_strained(evidence: Evidence) -> bool:
    """Whether the errors that close a gap without any effect are so large that an effect is likelier."""
    return _exceeds(evidence, BELIEVED, LARGEST)


def is_beyond_belief(evidence: Evidence) -> bool:
    """Whether they are so large that they are no explanation, whether or not there is another."""
    return _exceeds(evidence, BEYOND_BELIEF, LARGEST_AT_ALL)


def largest_error(evidence: Evidence) -> float:
    """The largest of these errors, over a tenth."""
    return _largest(_errors(evidence))


def _exceeds(evidence: Evidence, together: float, single: float) -> bool:
    told = _errors(evidence)
    return float(told @ told) > together or _largest(told) > single


def _errors(evidence: Evidence) -> Floats:
    emulator, errors = evidence.scene.emulator, evidence.errors()
    errors[: emulator.structure.shape[1]] *= FINE
    # A preload is what is left of larger ones that cancel: how far it is off says nothing.
    varies = np.concatenate([np.ptp(tangents, axis=0) for tangents in (emulator.structure, emulator.bulk)]) > 0.0
    return np.asarray(errors[varies])


def _largest(errors: Floats) -> float:
    return float(np.max(np.abs(errors), initial=0.0))
