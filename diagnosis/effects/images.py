"""Whether what an effect adds is no less what another one would add."""

from __future__ import annotations

import itertools

import numpy as np

from ..recording.noise import rms
from .base import Floats, Scene

__all__ = ["is_constant_friction", "is_one_sided_stiffness", "is_shifted_spring", "is_uniform"]


def share_made(signal: Floats, column: Floats) -> float:
    """Share of the energy of ``signal`` (n,) that the best multiple of ``column`` (n,) makes."""
    together = float(signal @ column) ** 2
    return together / max(float(signal @ signal) * float(column @ column), 1e-300)


CONSTANT = 0.97
"""Share of the energy of what is added that friction of constant size would make, from which it is no less that; of 80 frictions
that fell with speed it was 0.89 at most."""
TRANSITIONS = (0.003, 0.01, 0.03, 0.1, 0.3)
"""Speeds over which the sign of such friction may be smooth, over the root mean square of the speed."""
DISTANCES = (0.003, 0.006, 0.01, 0.02, 0.04, 0.08)
"""Distances over which it may build up, over half the range of the deflection."""


def is_constant_friction(signal: Floats, scene: Scene) -> bool:
    """Whether what is added, ``signal`` (n,), N·m, is hardly anything but dry friction of constant size."""
    signals = scene.signals
    speed = signals.speed / max(rms(signals.speed), 1e-300)
    smooth = (np.tanh(speed / transition) for transition in TRANSITIONS)
    presliding = (signals.bristle(distance * signals.reach) for distance in DISTANCES)
    return any(share_made(signal, sign) > CONSTANT for sign in itertools.chain(smooth, presliding))


ONE_SIDED = 0.965
"""Share of the energy of what is added that a spring which differs by side would make, from which it is no less that; of 150
offsets, errors and stops of the deflection it was 0.962 at most for one that differs by side alone."""


def is_one_sided_stiffness(signal: Floats, scene: Scene) -> bool:
    """Whether what is added, ``signal`` (n,), N·m, is hardly anything but more stiffness on one side, or less on the other."""
    x = scene.signals.smooth_x
    # More of it from zero on, or the more the farther.
    sides = (x > 0.0, x < 0.0, np.sign(x), np.maximum(x, 0.0), np.maximum(-x, 0.0), x)
    return any(
        share_made(signal, part * side) > ONE_SIDED for part in (x, scene.spring, scene.torque) for side in sides
    )


SHIFT = 0.02
"""Shift of the deflection, over half its range, that shows what any small one does."""
SHIFTED = 0.99
"""Share of the energy of what is added that such a shift of the spring would make, from which it is no less that."""


def is_shifted_spring(signal: Floats, scene: Scene) -> bool:
    """Whether what is added, ``signal`` (n,), N·m, is hardly anything but what a shift of the deflection makes of the spring."""
    x, near = scene.signals.x, SHIFT * scene.signals.reach
    return any(share_made(signal, scene.spring_change(x + shift)) > SHIFTED for shift in (-near, near))


UNIFORM = 0.1
"""Deviation of what is added over its mean, up to which it is no less an offset of the torque."""


def is_uniform(signal: Floats) -> bool:
    """Whether what is added, ``signal`` (n,), is hardly anything but constant."""
    return float(np.std(signal)) < UNIFORM * abs(float(np.mean(signal)))
