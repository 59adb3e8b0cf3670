"""Slow drift with time or temperature, of the zero, of the stiffness or, as a torque sensor's, of both."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import ClassVar

import numpy as np

from .base import ELAPSED, LOW, Columns, Effect, Floats, Form, Parameter, Scene, geometric
from .parts import PARTS, inside, times, unlike

__all__ = ["ThermalDrift"]


def _warming(scene: Scene, shape: tuple[float, ...]) -> Floats:
    t = scene.signals.elapsed
    return (1.0 - np.exp(-t / shape[0]) if shape else t)[:, None]


def _diffusing(scene: Scene, shape: tuple[float, ...]) -> Floats:
    """Heat that soaks into a body that is thick, by the root of the time if it is steady."""
    return (scene.signals.elapsed ** shape[0])[:, None]


def _heated(scene: Scene, power: Floats, time_constant: float) -> Floats:
    """Temperature by ``power`` (n,) against cooling, of a joint that starts cold."""
    s = scene.signals
    # The lag settles at its first input.
    return (s.lowpass(power, time_constant) - power[0] * np.exp(-s.elapsed / time_constant))[:, None]


def _self_heating(scene: Scene, shape: tuple[float, ...]) -> Floats:
    """By what the drive puts in, |y v|, of which a drive and a gear lose their share."""
    return _heated(scene, np.abs(scene.torque * scene.signals.speed), shape[0])


def _viscous_heating(scene: Scene, shape: tuple[float, ...]) -> Floats:
    """By what a lubricant or an eddy current turns into heat."""
    return _heated(scene, np.square(scene.signals.speed), shape[0])


def _friction_heating(scene: Scene, shape: tuple[float, ...]) -> Floats:
    """By what does not come back: the losses of the part with memory."""
    return _heated(scene, np.abs(scene.friction * scene.signals.speed), shape[0])


def _copper_heating(scene: Scene, shape: tuple[float, ...]) -> Floats:
    """By the current of a motor or a coil, also where nothing moves."""
    return _heated(scene, np.square(scene.torque), shape[0])


def _switched_on(scene: Scene, shape: tuple[float, ...]) -> Floats:
    """A drive or a heater that is switched on during the recording."""
    since = np.maximum(scene.signals.elapsed - shape[1], 0.0)
    return (1.0 - np.exp(-since / shape[0]))[:, None]


def _switched_off(scene: Scene, shape: tuple[float, ...]) -> Floats:
    """One that is switched off: what has warmed up cools down again."""
    return _warming(scene, shape[:1]) - _switched_on(scene, shape)


def _wave(scene: Scene, shape: tuple[float, ...]) -> Floats:
    """Day and night, or a heater that cycles: a slow wave that starts at zero."""
    angle = 2.0 * np.pi * scene.signals.elapsed / shape[0]
    return np.column_stack([np.sin(angle), np.cos(angle) - 1.0])


def _wave_begun_before(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return np.asarray(_wave(scene, shape) + np.array([0.0, 1.0]))


def _channel(name: str) -> Columns:
    def rise(scene: Scene, shape: tuple[float, ...]) -> Floats:
        return (scene.signals.channels[name] - scene.signals.channels[name][0])[:, None]

    return rise


def _both_heats(scene: Scene, shape: tuple[float, ...]) -> Floats:
    """Losses, and what heats all the time: electronics, a holding current, the surroundings."""
    return np.hstack([_self_heating(scene, shape), _warming(scene, shape)])


def _torque(scene: Scene) -> Floats:
    return scene.torque


def _zero(scene: Scene) -> Floats:
    return np.ones_like(scene.torque)


EXPONENTIAL = "(1 - exp(-t / time_constant))"
DIFFUSING = "t**power"
HEATED, RUBBED, CHURNED = "heat(y * v, time_constant)", "heat(y_memory * v, time_constant)", "heat(v**2, time_constant)"
CURRENT = "heat(y**2, time_constant)"
SINCE = "(1 - exp(-maximum(t - switched, 0) / time_constant))"
"""Warming in equations: in time, steadily or soaking in, by what the drive puts in, by losses, by the square of the speed or of the torque, since a time."""
POWERS = 0.35, 2.5
"""Of the time by which heat soaks in."""


def _slow_wave(name: str) -> str:
    return f"{name} * sin(2 * pi * t / period) + {name}_cos * (cos(2 * pi * t / period) - 1)"


def _slow_wave_begun_before(name: str) -> str:
    return f"{name} * sin(2 * pi * t / period) + {name}_cos * cos(2 * pi * t / period)"


def _both(warming: str) -> str:
    """Drift of the zero and of the stiffness."""
    return f"zero_drift * {warming} + stiffness_drift * {warming} * y"


def _each(warming: str) -> str:
    """Drift of the spring and of the friction."""
    return f"spring_drift * {warming} * y_spring + friction_drift * {warming} * y_memory"


def _form(
    name: str,
    equation: str,
    coefficients: tuple[str, ...],
    columns: Columns,
    shapes: Sequence[str] = (),
    grid: Sequence[tuple[float, ...]] = ((),),
    limits: Sequence[tuple[float, float]] = (),
) -> Form:
    """A law that may drift either way."""
    count = len(coefficients)
    return Form(name, coefficients, columns, (-np.inf,) * count, (np.inf,) * count, shapes, grid, limits,
                borders=[LOW] * len(shapes), equation=f"y += {equation}")  # fmt: skip


class ThermalDrift(Effect):
    """The joint or its torque sensor warms up during the recording."""

    id: ClassVar[str] = "thermal_drift"
    title: ClassVar[str] = "thermal drift"
    summary: ClassVar[str] = "zero or stiffness that drifts with time or temperature while the joint warms up"
    equation: ClassVar[str] = (
        "y += a w, a w y_sim (or a part of it) or both, a w + a2 w2, or w times a sum of its parts or a spring found anew,  w = 1 − exp(−t/τ), t, 1 − exp(−(t − t0)/τ) from t0 on or the difference of these two, t^p, lagged |y v|, v², y² or |f v| of the part f with memory, sin(2πt/P) with "
        "b (cos(2πt/P) − 1) or b cos(2πt/P), or temperature rise"
    )
    coordinate: ClassVar[str] = "time"
    clock: ClassVar[str] = ELAPSED
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("zero_drift", "N·m, N·m/s, N·m/W or N·m/K", -np.inf, np.inf, "drift of the zero"),
        Parameter("zero_drift_idle", "N·m", -np.inf, np.inf, "part of it by what heats all the time"),
        Parameter("stiffness_drift", "1, 1/s, 1/W, s²/rad² or 1/K", -np.inf, np.inf, "relative drift of the torque"),
        Parameter("spring_drift", "1 or 1/W", -np.inf, np.inf, "relative drift of the elastic torque"),
        Parameter("friction_drift", "1 or 1/W", -np.inf, np.inf, "relative drift of what has memory"),
        Parameter(
            "spring_rate",
            "N·m/rad, or that /s, /W, s²/rad² or /K",
            -np.inf,
            np.inf,
            "change of a spring that is found anew",
        ),
        Parameter("spring_cubic", "N·m/rad³, or that /s, /W, s²/rad² or /K", -np.inf, np.inf, "of its cubic part"),
        Parameter("zero_drift_cos", "N·m", -np.inf, np.inf, "b, cosine part of a slow wave of the zero"),
        Parameter("stiffness_drift_cos", "1", -np.inf, np.inf, "b, cosine part of a slow wave of the torque"),
        Parameter("time_constant", "s", 0.0, np.inf, "of warming up"),
        Parameter("power", "1", 0.0, np.inf, "p of the time"),
        Parameter("switched", "s", 0.0, np.inf, "t0, when what heats was switched on or off"),
        Parameter("period", "s", 0.0, np.inf, "P of a slow wave"),
    )
    confused_with: ClassVar[tuple[str, ...]] = ("cyclic_softening", "torque_gain", "torque_offset")

    def forms(self, scene: Scene) -> list[Form]:
        s = scene.signals
        shortest, span = s.shortest_and_longest(s.elapsed)
        constants = [(t,) for t in geometric(0.05 * shortest, 1.5 * span, 6)]
        # Warming up that is over within a thirtieth of every recording could not be told from an offset or a gain.
        limits = [(0.03 * shortest, 3.0 * span)]
        zero, stiffness = ("zero_drift",), ("stiffness_drift",)
        # Spring and grease warm up together, but not alike.
        each, both = ("spring_drift", "friction_drift"), (PARTS["the spring"].of, PARTS["the friction"].of)
        waves = ("period",), [(share * span,) for share in (0.6, 1.2, 2.4)], [(0.5 * span, 4.0 * span)]
        warming = ("time_constant",), constants, limits
        heating = ("time_constant",), constants[1::2], limits
        # What heats all the time and has soon settled would be an offset.
        slowly = (
            ("time_constant",),
            [(t,) for t in geometric(0.2 * shortest, 1.2 * span, 3)],
            [(0.12 * shortest, 3.0 * span)],
        )
        heated = _form("stiffness, self-heating", f"stiffness_drift * {HEATED} * y", stiffness,
                       times(_self_heating, _torque), *heating)  # fmt: skip
        steadily = _form("stiffness, linear", "stiffness_drift * t * y", stiffness, times(_warming, _torque))
        warmed = _form("stiffness, exponential", f"stiffness_drift * {EXPONENTIAL} * y", stiffness,
                       times(_warming, _torque), *warming)  # fmt: skip
        rubbed = _form("stiffness, friction heating", f"stiffness_drift * {RUBBED} * y", stiffness,
                       times(_friction_heating, _torque), *heating)  # fmt: skip
        churned = _form("stiffness, viscous heating", f"stiffness_drift * {CHURNED} * y", stiffness,
                        times(_viscous_heating, _torque), *heating)  # fmt: skip
        fed = _form("stiffness, heating by torque", f"stiffness_drift * {CURRENT} * y", stiffness,
                    times(_copper_heating, _torque), *heating)  # fmt: skip
        switching = ("time_constant", "switched"), [(a * span, b * span) for a in (0.1, 0.35) for b in (0.2, 0.35, 0.55)], [
            *limits, (0.08 * span, 0.8 * span)
        ]  # fmt: skip
        waved = _form("stiffness, slow wave", f"({_slow_wave('stiffness_drift')}) * y", (*stiffness, "stiffness_drift_cos"),
                      times(_wave, _torque), *waves)  # fmt: skip
        made = [
            _form("zero, linear", "zero_drift * t", zero, _warming),
            _form("zero, exponential", f"zero_drift * {EXPONENTIAL}", zero, _warming, *warming),
            _form("zero, self-heating", f"zero_drift * {HEATED}", zero, _self_heating, *heating),
            _form("zero, friction heating", f"zero_drift * {RUBBED}", zero, _friction_heating, *heating),
            _form("zero, heating by torque", f"zero_drift * {CURRENT}", zero, _copper_heating, *heating),
            _form("zero, slow wave", _slow_wave("zero_drift"), (*zero, "zero_drift_cos"), _wave, *waves),
            _form("zero, slow wave, begun before", _slow_wave_begun_before("zero_drift"), (*zero, "zero_drift_cos"), _wave_begun_before, *waves),
            _form("stiffness, slow wave, begun before", f"({_slow_wave_begun_before('stiffness_drift')}) * y",
                  (*stiffness, "stiffness_drift_cos"), times(_wave_begun_before, _torque), *waves),
            _form("zero, self-heating and warming", f"zero_drift * {HEATED} + zero_drift_idle * {EXPONENTIAL}",
                  (*zero, "zero_drift_idle"), _both_heats, *slowly),
            heated,
            steadily,
            *inside(steadily, _warming),
            warmed,
            waved,
            _form("zero and stiffness, linear", _both("t"), zero + stiffness, times(_warming, _zero, _torque)),
            _form("zero and stiffness, exponential", _both(EXPONENTIAL), zero + stiffness, times(_warming, _zero, _torque), *warming),
            _form("zero and stiffness, self-heating", _both(HEATED), zero + stiffness, times(_self_heating, _zero, _torque), *heating),
            _form("spring and friction, exponential", _each(EXPONENTIAL), each, times(_warming, *both), *warming),
            _form("spring and friction, self-heating", _each(HEATED), each, times(_self_heating, *both), *heating),
            *inside(heated, _self_heating),
            rubbed,
            *inside(rubbed, _friction_heating),
            churned,
            *inside(churned, _viscous_heating),
            fed,
            *inside(warmed, _warming),
            *inside(waved, _wave),
        ]  # fmt: skip
        for form, laws in (
            (warmed, _warming), (steadily, _warming), (heated, _self_heating), (churned, _viscous_heating),
        ):  # fmt: skip
            grown = tuple(f"{form.name}, of {name}" for name in PARTS)
            slid = unlike(form, laws, each, "the friction's strength")
            made.append(replace(slid, grid=(), guessed=True, refines=(form.name, *grown)))
        for told, of, names, columns in (
            ("zero", f"zero_drift * {DIFFUSING}", zero, _diffusing),
            ("stiffness", f"stiffness_drift * {DIFFUSING} * y", stiffness, times(_diffusing, _torque)),
            ("zero and stiffness", _both(DIFFUSING), zero + stiffness, times(_diffusing, _zero, _torque)),
        ):
            simpler = (f"{told}, exponential", f"{told}, linear")
            soaked = _form(f"{told}, power of time", of, names, columns, ("power",), (), [POWERS])
            made.append(replace(soaked, refines=simpler, start=lambda shape, coefficients: (0.7,)))
        for told, since, law in (
            ("switched on", SINCE, _switched_on), ("switched off", f"({EXPONENTIAL} - {SINCE})", _switched_off),
        ):  # fmt: skip
            late = _form(
                f"stiffness, {told}", f"stiffness_drift * {since} * y", stiffness, times(law, _torque), *switching
            )
            made += [_form(f"zero, {told}", f"zero_drift * {since}", zero, law, *switching), late]
        for name, values in s.channels.items():
            if "temp" in name.lower() and np.ptp(values) > 0.0:
                rise, risen = _channel(name), f"rise({name})"
                by_channel = _form(
                    f"stiffness by {name}", f"stiffness_drift * {risen} * y", stiffness, times(rise, _torque)
                )
                made += [
                    _form(f"zero by {name}", f"zero_drift * {risen}", zero, rise),
                    by_channel,
                    *inside(by_channel, rise),
                    _form(f"zero and stiffness by {name}", _both(risen), zero + stiffness, times(rise, _zero, _torque)),
                ]  # fmt: skip
        return made
