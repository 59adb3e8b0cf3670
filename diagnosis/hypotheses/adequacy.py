"""What may be left over: how much structure a law that is not quite right, or an emulator, leaves of a gap."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..effects.base import INPUT
from ..recording.noise import LOW_PASSED, independent, noise_levels, structured_power
from .evidence import Evidence, Hypothesis

__all__ = [
    "ALMOST_ALL",
    "INEXACT_NEAR",
    "emulated",
    "forgiven",
    "forgiven_here",
    "is_adequate",
    "left_by",
    "left_to_noise",
]

Floats = NDArray[np.float64]
INEXACT = 0.3
"""Structure that an inexact law may leave, as a share of a gap of a hundred times the noise or more."""
INEXACT_FITTED = 0.45
"""The same for a model fitted to recorded data, whose own law is inexact too."""
INEXACT_NEAR = 0.085
"""Structure that an inexact law may leave, as a share of the gap, where that is well above the noise."""
ALMOST_ALL = 0.95
"""Share of the gap's energy that effects close by themselves, so that the refitted simulator beside them does not matter."""
AT_MOST_EMULATED = 0.1
"""Share of the gap that is left to the emulator's error at most."""
KNOCK = 5.0
"""Noise levels beyond which a sample says no more against an explanation than one at this level."""
NOT_NOISE = 1.2
"""What is left over beyond the noise, as a share of it, that cannot be an error in the noise's own size."""


def left_to_noise(evidence: Evidence, left: Floats) -> float:
    """Structure left over, relative to the noise; ``left`` (n,) is zero where the evidence does not look.

    It is what lasts for several samples; where the rest is far above the noise, it counts whole, for a fast hum does not
    last and is no noise either. What knocks for a moment (flanks that meet, a stop that is hit) is cut off at what lasts.
    """
    signals, floor, looked = evidence.scene.signals, evidence.sigma, float(np.mean(evidence.rows))
    left = np.clip(left, -KNOCK * floor, KNOCK * floor)
    stride, noise = signals.stride, floor
    # A gap that changes fast hides that its noise is correlated; what is left of it does not. What lasts longer counts anyway.
    if stride < LOW_PASSED:
        levels = noise_levels(left, signals.runs)
        apart = independent(levels)
        if apart > stride:
            stride, noise = apart, max(floor, levels[apart - 1])
    lasting = float(np.sqrt(max(structured_power(left, signals.runs, stride) / looked, 0.0)) / floor)
    whole = float(np.sqrt(max(float(np.mean(np.square(left))) / looked / noise**2 - 1.0, 0.0)))
    return max(lasting, whole if whole > NOT_NOISE else 0.0)


def left_by(evidence: Evidence, hypothesis: Hypothesis) -> float:
    """Structure that a hypothesis and the simulator beside it leave, relative to the noise."""
    return left_to_noise(evidence, evidence.left_over(hypothesis))


def forgiven_here(evidence: Evidence, gap: float, bent: bool) -> float:
    """What a law may leave goes with the gap over the sensor's own noise, however coarsely the misfit is judged.

    What the deflection's noise leaves is no law's.
    """
    signals = evidence.scene.signals
    finer = evidence.sigma / signals.noise_floor
    return float(np.hypot(forgiven(gap * finer, bent, evidence.fitted) / finer, signals.jitter / evidence.sigma))


def forgiven(gap: float, refitted: bool, fitted: bool = False) -> float:
    """Structure, over the noise, that an inexact law may leave of a gap of ``gap`` times the noise.

    Beside a refitted simulator less is forgiven, for its freedom imitates most. Where the gap is far above the noise,
    no law of a textbook comes near the noise, and its share of the gap counts.
    """
    if fitted:
        return max(0.3 + 0.045 * gap, INEXACT_FITTED * gap)
    share = INEXACT * float(np.clip(np.log(max(gap, 1.0) / 16.0) / np.log(100.0 / 16.0), 0.0, 1.0))
    return max(0.2 + 0.042 * gap if refitted else max(0.3 + 0.045 * gap, INEXACT_NEAR * gap), share * gap)


def is_adequate(evidence: Evidence, hypothesis: Hypothesis, energy: float) -> bool:
    """Whether a hypothesis leaves of a gap of that ``energy`` beyond the noise no more than an inexact law may."""
    bent = evidence.is_beside_refit(hypothesis)
    return left_by(evidence, hypothesis) <= forgiven_here(evidence, float(np.sqrt(energy)) / evidence.sigma, bent)


def emulated(evidence: Evidence, hypothesis: Hypothesis, energy: float) -> float:
    """What the emulator's own error may leave over the noise, where it is asked for what explains the gap.

    That is another deflection, by effects on it, or, without any effect, errors of the simulator's parameters.
    """
    if hypothesis.terms and all(term.effect.acts_on != INPUT for term in hypothesis.terms):
        return 0.0
    error = evidence.scene.emulator.error * float(np.std(evidence.scene.signals.y_sim))
    return min(error, AT_MOST_EMULATED * float(np.sqrt(energy))) / evidence.sigma
