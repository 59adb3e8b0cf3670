"""The calibration of the stated confidence: a logistic regression on what the diagnosis knows of itself.

Fitted once by maximum a-posteriori likelihood (weights ~ N(0, 2²)) on the development bank of
:mod:`hystbench.diagnosis.blind.cases` and on 340 recordings of joints made by other hands (their plants and seeds are none of
those that ``hystbench blind`` reports on).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

__all__ = ["CONFIDENCE", "INPUTS", "STATED", "confidence", "inputs", "stated"]

INPUTS = (
    "bias", "no gap", "unknown", "miscalibration alone", "miscalibration beside", "further effects",
    "log margin", "left over", "left over of unknown", "small gap", "gain beside others", "widening", "closed beside",
)  # fmt: skip
CONFIDENCE: dict[str, float] = {
    "bias": 3.050,
    "no gap": 0.369,
    "unknown": -4.212,
    "miscalibration alone": -1.784,
    "miscalibration beside": -1.980,
    "further effects": -1.213,
    "log margin": 1.240,
    "left over": -3.167,
    "left over of unknown": 1.511,
    "small gap": 0.914,
    "gain beside others": 0.786,
    "widening": -0.101,
    "closed beside": 0.465,
}
"""Weight of each input."""
STATED = (0.352, 0.874)
"""What the logit of a chosen verdict's confidence is moved by and multiplied with (J. Platt, Probabilistic outputs for support vector
machines, 1999): what is chosen with it in mind is right a little more often than it says. Fitted on 1,040 recordings of the
strangers' joints 29 to 32, the last 520 of them as they were read."""


def inputs(verdict: Sequence[str], features: Mapping[str, float]) -> dict[str, float]:
    """What the confidence depends on, each of order one."""
    named = set(verdict) - {"miscalibration", "unknown"}
    unknown, nothing = list(verdict) == ["unknown"], not verdict
    # Structure left over, against what an inexact law may leave.
    left = min(features["in_sample_left"] / features["forgiven"], 3.0)
    return {
        "bias": 1.0,
        "no gap": float(nothing),
        "unknown": float(unknown),
        "miscalibration alone": float(list(verdict) == ["miscalibration"]),
        "miscalibration beside": float("miscalibration" in verdict and bool(named)),
        "further effects": float(max(len(named) - 1, 0)),
        "log margin": math.log10(min(max(features["margin"], 1.0), 1e4)) - 2.0 if named else 0.0,
        "left over": left if named else 0.0,
        "left over of unknown": left if unknown else 0.0,
        "small gap": 1.0 / max(features["gap"], 1.0) if named or unknown else 0.0,
        "gain beside others": float("torque_gain" in named and len(named) > 1),
        "closed beside": max(0.5 - max(features["closed_alone"], -1.0), 0.0)
        if named and "miscalibration" in verdict
        else 0.0,
        "widening": max(features["signal"] / max(features["gap"], 0.1) - 1.1, 0.0) if named else 0.0,
    }


def confidence(weights: Mapping[str, float], verdict: Sequence[str], features: Mapping[str, float]) -> float:
    """Probability that ``verdict`` is right, kept within [0.02, 0.995]: a finite bank proves no more."""
    total = sum(weights[name] * value for name, value in inputs(verdict, features).items())
    return _within(1.0 / (1.0 + math.exp(-min(max(total, -30.0), 30.0))))


def stated(probability: float) -> float:
    """What is stated of a chosen verdict whose confidence is ``probability``, within [0.02, 0.995] as well."""
    inside = _within(probability)
    return _within(1.0 / (1.0 + math.exp(-STATED[0]) * ((1.0 - inside) / inside) ** STATED[1]))


def _within(probability: float) -> float:
    return min(max(probability, 0.02), 0.995)
