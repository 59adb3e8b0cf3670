"""Torque that falls with the work done."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from .base import Effect, Floats, Form, Parameter, Scene, geometric

__all__ = ["CyclicSoftening"]

FEWEST = 10
"""Reversals below which their number is too coarse a count."""


def _columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
    travel = scene.signals.travel
    worn = 1.0 - np.exp(-travel / shape[0]) if shape else travel
    return (-worn * scene.torque)[:, None]


def _hyperbolic(scene: Scene, shape: tuple[float, ...]) -> Floats:
    travel = scene.signals.travel
    return (-travel / (shape[0] + travel) * scene.torque)[:, None]


def _power(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return (-(scene.signals.travel ** shape[0]) * scene.torque)[:, None]


def _work(scene: Scene) -> Floats:
    s = scene.signals
    moved = s.per_run(lambda run: np.abs(np.diff(s.smooth_x[run], prepend=s.smooth_x[run][0])))
    return s.per_run(lambda run: np.cumsum(np.abs(scene.torque[run]) * moved[run]))


def _by_work(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return (-(1.0 - np.exp(-_work(scene) / shape[0])) * scene.torque)[:, None]


def _by_reversals(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return (-(1.0 - np.exp(-scene.signals.reversals / shape[0])) * scene.torque)[:, None]


class CyclicSoftening(Effect):
    """The Mullins effect of rubber, wear or damage: each cycle takes a little of the torque."""

    id: ClassVar[str] = "cyclic_softening"
    title: ClassVar[str] = "cyclic softening"
    summary: ClassVar[str] = "torque that falls with accumulated travel (Mullins effect, wear, damage)"
    equation: ClassVar[str] = (
        "y −= a w y_sim,  w = 1 − exp(−travel/L), travel/(L + travel), travel, travel^p, 1 − exp(−∫|y dx|/W) or "
        "1 − exp(−reversals/N)"
    )
    coordinate: ClassVar[str] = "travel"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("softening", "1 (1/rad^p for a power)", 0.0, np.inf, "relative loss in the limit, or per travel"),
        Parameter(
            "travel_constant", "rad", 0.0, np.inf, "travel after which 63 % (hyperbolic: half) of the loss has come"
        ),
        Parameter("power", "1", 0.3, 0.95, "p of the travel"),
        Parameter("work_constant", "J", 0.0, np.inf, "W, of the work ∫|y dx|"),
        Parameter("reversals_constant", "1", 0.0, np.inf, "N, half cycles after which 63 % of the loss has come"),
    )
    confused_with: ClassVar[tuple[str, ...]] = ("thermal_drift", "torque_gain")

    def forms(self, scene: Scene) -> list[Form]:
        total = float(scene.signals.travel.max())
        work = max(float(_work(scene).max()), 1e-300)
        turns = float(scene.signals.reversals.max())
        lengths = [(t,) for t in geometric(0.04 * total, 1.5 * total, 7)]
        # Softening that is over within a thirtieth of the recording could not be told from a gain.
        limits = [(0.03 * total, 3.0 * total)]
        forms = [
            Form("linear", ("softening",), _columns, (0.0,), (1.0 / max(total, 1e-300),)),
            Form("exponential", ("softening",), _columns, (0.0,), (1.0,), ("travel_constant",), lengths,
                 limits),
            Form("power of travel", ("softening",), _power, (0.0,), (np.inf,), ("power",), [(0.5,), (0.75,)],
                 [(0.3, 0.95)]),
            Form("by work", ("softening",), _by_work, (0.0,), (1.0,), ("work_constant",),
                 [(share * work,) for share in (0.1, 0.4, 1.5)], [(0.03 * work, 3.0 * work)]),
            Form("hyperbolic", ("softening",), _hyperbolic, (0.0,), (1.0,), ("travel_constant",), lengths,
                 limits),
        ]  # fmt: skip
        if turns >= FEWEST:
            forms.append(
                Form("by reversals", ("softening",), _by_reversals, (0.0,), (1.0,), ("reversals_constant",),
                     [(share * turns,) for share in (0.1, 0.3, 1.0)], [(0.03 * turns, 3.0 * turns)])
            )  # fmt: skip
        return forms
