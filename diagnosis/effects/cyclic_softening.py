"""Torque that falls with the work done."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from .base import Effect, Floats, Form, Parameter, Scene, geometric

__all__ = ["CyclicSoftening"]


def _columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
    travel = scene.signals.travel
    worn = 1.0 - np.exp(-travel / shape[0]) if shape else travel
    return (-worn * scene.torque)[:, None]


def _hyperbolic(scene: Scene, shape: tuple[float, ...]) -> Floats:
    travel = scene.signals.travel
    return (-travel / (shape[0] + travel) * scene.torque)[:, None]


class CyclicSoftening(Effect):
    """The Mullins effect of rubber, wear or damage: each cycle takes a little of the torque."""

    id: ClassVar[str] = "cyclic_softening"
    title: ClassVar[str] = "cyclic softening"
    summary: ClassVar[str] = "torque that falls with accumulated travel (Mullins effect, wear, damage)"
    equation: ClassVar[str] = "y −= a w y_sim,  w = 1 − exp(−travel/L), travel/(L + travel) or travel"
    coordinate: ClassVar[str] = "travel"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("softening", "1 (1/rad where linear)", 0.0, 1.0, "relative loss in the limit, or per travel"),
        Parameter(
            "travel_constant", "rad", 0.0, np.inf, "travel after which 63 % (hyperbolic: half) of the loss has come"
        ),
    )
    confused_with: ClassVar[tuple[str, ...]] = ("thermal_drift", "torque_gain")

    def forms(self, scene: Scene) -> list[Form]:
        total = float(scene.signals.travel.max())
        lengths = [(t,) for t in geometric(0.04 * total, 1.5 * total, 7)]
        # Softening that is over within a thirtieth of the recording could not be told from a gain.
        limits = [(0.03 * total, 3.0 * total)]
        return [
            Form("linear", ("softening",), _columns, (0.0,), (1.0 / max(total, 1e-300),)),
            Form("exponential", ("softening",), _columns, (0.0,), (1.0,), ("travel_constant",), lengths,
                 limits),
            Form("hyperbolic", ("softening",), _hyperbolic, (0.0,), (1.0,), ("travel_constant",), lengths,
                 limits),
        ]  # fmt: skip
