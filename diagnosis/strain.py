"""How far off a simulator's own parameters would have to be to explain a gap by themselves."""

from __future__ import annotations

import numpy as np

from .evidence import Evidence

__all__ = ["is_strained"]

BELIEVED = 100.0
"""Sum of the squared errors of all parameters, over those of one that is off by a tenth, up to which a simulator is only badly
calibrated. Of 66 strangers' simulators that were off by 3 to 5 % none needed more, of 15 that were blamed for an effect not known here 8."""
FEW = 3000
"""Samples that are enough."""


def is_strained(evidence: Evidence) -> bool:
    """Whether the errors that close a gap without any effect are so large that an effect is likelier which is not known here."""
    emulator, scales = evidence.scene.emulator, evidence.scales
    some = np.flatnonzero(evidence.rows)[:: max(evidence.size // FEW, 1)]
    fine, coarse = (max(scale[k] for scale in scales) for k in (0, 1))
    tangents = np.hstack([fine * emulator.structure[some], coarse * emulator.bulk[some]]) / evidence.sigma
    gap = evidence.scene.signals.gap[some] / evidence.sigma
    errors = np.linalg.solve(tangents.T @ tangents + np.eye(tangents.shape[1]), tangents.T @ gap)
    # A preload is what is left of larger ones that cancel: how far it is off says nothing.
    told = np.ptp(tangents, axis=0) > 0.0
    return float(np.sum(np.square(errors[told]))) > BELIEVED
