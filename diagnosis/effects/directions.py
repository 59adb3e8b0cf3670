"""How dry friction takes the direction of motion."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ..recording.noise import rms
from ..recording.signals import Signals
from .base import Floats, Form, Parameter, Scene, overdone

__all__ = ["PRESLIDING", "DirectionLaw", "direction_laws", "overdone_friction"]


def overdone_friction(forms: Sequence[Form]) -> list[Form]:
    """Those of the forms of dry friction that may be overdone: presliding the other way round would be a clearance."""
    return [overdone(form) for form in forms if form.shapes == ("transition_speed",)]


@dataclass(frozen=True)
class DirectionLaw:
    """How dry friction takes the direction of motion: a signal within ±1 with one shape parameter."""

    name: str
    parameter: str
    equation: str
    signal: Callable[[Signals, float], Floats]
    grid: Sequence[float]
    limits: tuple[float, float]

    @property
    def by_speed(self) -> bool:
        """Whether it turns round within a speed, and not within a distance."""
        return self.parameter == "transition_speed"


def direction_laws(scene: Scene) -> list[DirectionLaw]:
    """The usual regularisations of sgn(v): presliding, exponential or elastic, and a steep function of speed."""
    signals = scene.signals
    reach, fast = signals.reach, rms(signals.speed)
    lengths = [0.002 * reach, 0.012 * reach, 0.06 * reach]
    distances = (5e-5 * reach, 0.3 * reach)
    return [
        DirectionLaw("presliding", "presliding", "dahl(x, presliding)", Signals.bristle, lengths, distances),
        DirectionLaw(
            "elastic presliding", "elastic_presliding", "slip(x, elastic_presliding)", Signals.slipping, lengths, distances
        ),
        DirectionLaw(
            "regularised", "transition_speed", "tanh(v / transition_speed)", lambda s, w: np.tanh(s.certain_speed / w),
            [0.01 * fast, 0.06 * fast], (0.002 * fast, 0.3 * fast),
        ),
    ]  # fmt: skip


PRESLIDING = (
    Parameter("presliding", "rad", 0.0, np.inf, "distance over which friction builds up after a turn (Dahl)"),
    Parameter("elastic_presliding", "rad", 0.0, np.inf, "elastic deflection before it slides (spring and slider)"),
    Parameter("transition_speed", "rad/s", 0.0, np.inf, "speed at which the regularised sign saturates"),
)
"""Parameters of the direction laws; a fit has the one of its law."""
