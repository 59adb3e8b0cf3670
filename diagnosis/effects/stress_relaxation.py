"""Viscoelastic relaxation: Maxwell branches beside the simulator."""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

import numpy as np

from .base import LOW, Columns, Effect, Floats, Form, Parameter, Scene, geometric

__all__ = ["StressRelaxation"]

QUICK = 0.25
"""Radians of the motion's mean frequency within which a branch relaxes at least."""


def _relaxing(part: Callable[[Scene], Floats]) -> Columns:
    """A branch for each time constant, which holds what of ``part`` is new."""

    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        whole = part(scene)
        return np.column_stack([whole - scene.signals.lowpass(whole, tau) for tau in shape])

    return columns


def _missing(part: Callable[[Scene], Floats]) -> Columns:
    """The simulator knows ``part`` before it relaxes: what has relaxed is missing."""
    return lambda scene, shape: np.column_stack([-scene.signals.lowpass(part(scene), tau) for tau in shape])


def _equation(part: str, *branches: tuple[str, str]) -> str:
    """Of branches with so large a share or stiffness and such a time constant."""
    return "y += " + " + ".join(f"{size} * ({part} - lowpass({part}, {constant}))" for size, constant in branches)


def _equation_down(part: str, *branches: tuple[str, str]) -> str:
    return "y -= " + " + ".join(f"{size} * lowpass({part}, {constant})" for size, constant in branches)


def _spectrum(branches: Columns) -> Columns:
    """Three branches whose time constants are as 1 : 4 : 16."""
    return lambda scene, shape: branches(scene, (shape[0], 4.0 * shape[0], 16.0 * shape[0]))


_of_deflection = _relaxing(lambda scene: scene.signals.smooth_x)
_of_torque = _relaxing(lambda scene: scene.torque)
_of_spring = _relaxing(lambda scene: scene.spring)
_creep = _missing(lambda scene: scene.torque)
_creep_of_spring = _missing(lambda scene: scene.spring)


class StressRelaxation(Effect):
    """Torque that decays while the deflection is held (rubber, polymer belts, tendons)."""

    id: ClassVar[str] = "stress_relaxation"
    title: ClassVar[str] = "stress relaxation"
    summary: ClassVar[str] = "torque that decays during a hold and rises with rate (viscoelastic Maxwell branch)"
    equation: ClassVar[str] = (
        "y += Σ k_i (x − L_i),  τ_i dL_i/dt = x − L_i   (or with y_sim, or its elastic part, in place of k x; or y −= Σ s_i L_i of either)"
    )
    coordinate: ClassVar[str] = "time"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("stiffness", "N·m/rad", 0.0, np.inf, "of the (first) Maxwell branch"),
        Parameter("stiffness_2", "N·m/rad", 0.0, np.inf, "of the second branch"),
        Parameter(
            "stiffness_3", "N·m/rad", 0.0, np.inf, "of the third branch; a spectrum has time constants 1 : 4 : 16"
        ),
        Parameter("share", "1", 0.0, np.inf, "part of the simulator's torque, or of its elastic part, that relaxes"),
        Parameter("share_2", "1", 0.0, np.inf, "of the second branch of a spectrum"),
        Parameter("share_3", "1", 0.0, np.inf, "of its third branch"),
        Parameter("time_constant", "s", 0.0, np.inf, "of the (first) branch"),
        Parameter("time_constant_2", "s", 0.0, np.inf, "of the second branch"),
    )
    confused_with: ClassVar[tuple[str, ...]] = ("viscous_friction", "sensor_delay", "miscalibration")

    def forms(self, scene: Scene) -> list[Form]:
        s = scene.signals
        span = max(float(s.elapsed[run.stop - 1]) for run in s.runs)
        # What relaxes far more slowly than the recording moves is a spring.
        high = 0.25 * span
        # A branch that follows the motion at once is a damper.
        pace = float(np.std(s.smooth_x)) / max(float(np.std(s.speed)), 1e-300)
        low = min(max(4.0 * s.interval, QUICK * pace), 0.2 * high)
        times = geometric(max(low, span / 1500.0), high, 10)
        free = (0.0,), (np.inf,)
        limits = (low, 1.2 * high)

        def two(size: str) -> list[tuple[str, str]]:
            return [(size, "time_constant"), (f"{size}_2", "time_constant_2")]

        def three(size: str) -> list[tuple[str, str]]:
            return [(size, "time_constant"), (f"{size}_2", "4 * time_constant"), (f"{size}_3", "16 * time_constant")]

        def branches(name: str, law: Columns, simpler: str, equation: str) -> Form:
            return Form(
                name, ("share", "share_2"), law, (0.0,) * 2, (np.inf,) * 2, ("time_constant", "time_constant_2"), (),
                [limits, limits], (simpler,), lambda shape, _: (max(0.4 * shape[0], low), min(2.5 * shape[0], high)),
                equation=equation,
            )  # fmt: skip

        def spectrum(name: str, law: Columns, simpler: str, equation: str) -> Form:
            return Form(
                name, ("share", "share_2", "share_3"), _spectrum(law), (0.0,) * 3, (np.inf,) * 3, ("time_constant",), (),
                [limits], (simpler,), lambda shape, _: (max(0.25 * shape[0], low),), equation=equation,
            )  # fmt: skip

        one = (("time_constant",),)
        pairs = [(a, b) for a in times[::2] for b in times[1::2] if b > 4.0 * a]
        return [
            Form("one branch", ("stiffness",), _of_deflection, *free, *one, [(t,) for t in times], [limits],
                 borders=[LOW], equation=_equation("x", two("stiffness")[0])),
            Form("of the torque", ("share",), _of_torque, *free, *one, [(t,) for t in times], [limits],
                 borders=[LOW], equation=_equation("y", two("share")[0])),
            Form("from the torque down", ("share",), _creep, *free, *one, [(t,) for t in times[::2]], [limits],
                 borders=[LOW], equation=_equation_down("y", two("share")[0])),
            Form("two branches", ("stiffness", "stiffness_2"), _of_deflection, (0.0, 0.0), (np.inf, np.inf),
                 ("time_constant", "time_constant_2"), pairs, [limits, limits], equation=_equation("x", *two("stiffness"))),
            Form("spectrum", ("stiffness", "stiffness_2", "stiffness_3"), _spectrum(_of_deflection), (0.0,) * 3, (np.inf,) * 3,
                 *one, [(t,) for t in times[:7]], [limits], equation=_equation("x", *three("stiffness"))),
            Form("from the spring down", ("share",), _creep_of_spring, *free, *one, [(t,) for t in times[::2]], [limits],
                 borders=[LOW], equation=_equation_down("y_spring", two("share")[0])),
            branches("from the torque down, two branches", _creep, "from the torque down", _equation_down("y", *two("share"))),
            spectrum("from the torque down, spectrum", _creep, "from the torque down", _equation_down("y", *three("share"))),
            branches("from the spring down, two branches", _creep_of_spring, "from the spring down", _equation_down("y_spring", *two("share"))),
            spectrum("from the spring down, spectrum", _creep_of_spring, "from the spring down", _equation_down("y_spring", *three("share"))),
            branches("two branches of the torque", _of_torque, "of the torque", _equation("y", *two("share"))),
            branches("two branches of the spring", _of_spring, "of the torque", _equation("y_spring", *two("share"))),
            spectrum("spectrum of the torque", _of_torque, "of the torque", _equation("y", *three("share"))),
            spectrum("spectrum of the spring", _of_spring, "of the torque", _equation("y_spring", *three("share"))),
        ]  # fmt: skip
