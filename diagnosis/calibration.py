"""The calibration of the stated confidence."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

__all__ = ["CONFIDENCE", "confidence"]

CONFIDENCE: dict[str, float] = {"bias": 2.0}
"""Weights of the logistic regression, fitted on the development bank."""


def confidence(weights: Mapping[str, float], verdict: Sequence[str], features: Mapping[str, float]) -> float:
    """Probability that ``verdict`` is right."""
    return 1.0 / (1.0 + math.exp(-weights["bias"]))
