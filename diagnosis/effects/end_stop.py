"""A stop that is touched near the ends of the stroke."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from functools import partial
from typing import ClassVar, NamedTuple

import numpy as np

from .base import Columns, Effect, Floats, Form, Parameter, Scene
from .directions import PRESLIDING, DirectionLaw, direction_laws
from .images import is_one_sided_stiffness

__all__ = ["EndStop"]


def _columns(upper: bool, lower: bool, power: float) -> Columns:
    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        x = scene.signals.smooth_x
        made = []
        if upper:
            made.append(np.maximum(x - shape[0], 0.0) ** power)
        if lower:
            made.append(-(np.maximum(-x - shape[-1], 0.0) ** power))
        return np.column_stack(made)

    return columns


def _depth(scene: Scene, side: float, at: float) -> Floats:
    """How deep a stop on one side is pressed, rad, shape (n,)."""
    return np.maximum(side * scene.signals.smooth_x - at, 0.0)


def _damped(side: float) -> Columns:
    """A stop that loses energy by a damper that is there while it is touched."""

    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        depth = _depth(scene, side, shape[0])
        return np.column_stack([side * depth, (depth > 0.0) * scene.signals.speed])

    return columns


def _between(x: Floats, reach: float) -> tuple[float, float]:
    """Between which places the upper of two stops may be along a motion (n,): it is not met most of the time, nor for a moment."""
    middle = 0.5 * float(x.max() + x.min())
    often, hardly = (float(np.quantile(x, 1.0 - share)) for share in (SELDOM, min(FEWEST / x.size, 1.0)))
    innermost = min(INNERMOST, max(often - middle, 0.0) / reach)
    return middle + innermost * reach, middle + float(np.clip((hardly - middle) / reach, *OUTERMOST)) * reach


def _ends(x: Floats, reach: float) -> tuple[list[float], tuple[float, float]]:
    """Where the upper of two stops may begin to be looked for along a motion (n,), and between which places it may be."""
    middle, (inner, outer) = 0.5 * float(x.max() + x.min()), _between(x, reach)
    shares = (0.5 * ((inner - middle) / reach + SHARES[0]), *SHARES)
    return [middle + share * reach for share in shares], (inner, outer)


def _contact(side: float, power: float | None = None) -> Columns:
    """A stop that loses energy with its depth (Hunt & Crossley), by a power of it that is the last shape if it is not given."""

    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        signals, p = scene.signals, shape[-1] if power is None else power
        pressed = _depth(scene, side, shape[0]) ** p
        return np.column_stack([side * pressed, pressed * signals.speed])

    return columns


def _rubbing(side: float, by_speed: DirectionLaw | None = None) -> Columns:
    """A stop that rubs as it is pressed: its flank, or rubber that loses a share of its work however slowly it is pressed.

    It gives back no more than it took and never pulls: what rubs is added to what it gives back while it is pressed. It turns
    round within a distance, or ``by_speed`` within a last shape.
    """

    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        signals, back = scene.signals, side * _depth(scene, side, shape[0]) ** shape[1]
        direction = by_speed.signal(signals, shape[2]) if by_speed else signals.bristle(TURNED * signals.reach)
        return np.column_stack([back, back * 0.5 * (1.0 + side * direction)])

    return columns


class _Lossy(NamedTuple):
    """A stop that rubs, by the direction that its friction takes, and what shapes that has."""

    name: str
    direction: str
    law: Callable[[float], Columns]
    shapes: tuple[str, ...] = ()
    limits: tuple[tuple[float, float], ...] = ()
    first: tuple[float, ...] = ()

    def start(self, shape: tuple[float, ...], coefficients: Floats) -> tuple[float, ...]:
        """Its shape where a stop without losses ended."""
        return (*shape, 1.1, *self.first)


def _relaxing(side: float) -> Columns:
    """A bumper of rubber, a part of whose torque relaxes while it is pressed."""

    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        depth = _depth(scene, side, shape[0])
        return side * np.column_stack([depth, depth - scene.signals.lowpass(depth, shape[-1])])

    return columns


def _both(law: Callable[[float], Columns]) -> Columns:
    """Two stops that lose energy, each at its own place by its own damping; further shapes are common to them."""

    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        up, down = law(1.0)(scene, (shape[0], *shape[2:])), law(-1.0)(scene, shape[1:])
        return np.column_stack([up[:, 0], down[:, 0], up[:, 1], down[:, 1]])

    return columns


def _rubber(depth: Floats, thickness: float) -> Floats:
    return np.asarray(depth / np.maximum(1.0 - depth / thickness, 0.02))


def _progressive(depth: Floats, thickness: float) -> Floats:
    return np.expm1(np.minimum(depth / thickness, 50.0))


BUMPERS = (
    ("bumper", "{depth} / maximum(1 - {depth} / thickness, 0.02)", _rubber, 0.7),
    ("exponential", "(exp({depth} / thickness) - 1)", _progressive, 0.2),
)
"""Stops that stiffen as they are pressed: their equation, and the thickness to start from as a share of the reach."""
SHARES, INNERMOST, OUTERMOST = (0.45, 0.55, 0.65, 0.72, 0.79, 0.85, 0.9, 0.94, 0.97), 0.35, (0.985, 0.998)
"""Where stops begin to be looked for, and between which places they may be, from the middle of the motion on as a share of its reach:
farthest out where enough samples are beyond."""
FEWEST = 20
"""Samples that are enough."""
SELDOM = 0.2
"""Share of the time for which a stop may be met that is farther in: a few large swings do not tell where most of the motion ends."""
ANY = "Hunt-Crossley of any power"
SOMETIMES = 0.02
"""Share of the time for which a load is in a stop at least: with a spring of any kind a single sample can be had."""
STIFF, STRETCHED, FARTHEST_IN, SMALLEST = 0.02, 0.4, 0.15, 1e-12
"""Stretch of the spring before a load at the largest torque, over the reach: the least, and that to start from; where its stops are at
least, as those of the deflection; the least torque, N·m, and reach, rad."""
TURNED = 0.003
"""Way over which the friction of a stop turns round, over the reach."""
POWERS = (1.0, 2.5)
"""Limits of a contact's power of its depth: from a plate's to a blunt tip's."""
SIDES = {"upper": 1.0, "lower": -1.0}
"""By name, the direction in which each stop is pressed."""
DEPTHS = {"upper": "maximum(x - upper, 0)", "lower": "maximum(-x - lower, 0)"}
"""How deep each stop is pressed, in equations."""
DEPTHS_OF_LOAD = {
    "upper": "maximum(x - compliance * y - upper, 0)",
    "lower": "maximum(compliance * y - x - lower, 0)",
}
"""The same by a load."""


def _term(side: str, power: float | str) -> str:
    return f"stiffness_{side} * {DEPTHS[side]}" + ("" if power == 1.0 else f"**{power}")


def _lossy(side: str, power: float | str, damping: str) -> str:
    touched = f"({DEPTHS[side]} > 0)" if power == 1.0 else f"{DEPTHS[side]}**{power}"
    return f"{'-' * (side == 'lower')}{_term(side, power)} + {damping} * v * {touched}"


def _rubs(side: str, lost: str, direction: str) -> str:
    sign = "-" if side == "lower" else "+"
    taken = f"{lost} * {DEPTHS[side]}**power * (1 {sign} {direction}) / 2"
    return f"{'-' * (side == 'lower')}{_term(side, 'power')} {sign} {taken}"


def _relaxes(side: str, soft: str) -> str:
    depth = DEPTHS[side]
    return f"({_term(side, 1.0)} + {soft} * ({depth} - lowpass({depth}, time_constant)))"


def _pressed(sides: Sequence[str], equation: str, depths: Mapping[str, str] = DEPTHS) -> str:
    first, *others = (f"stiffness_{side} * {equation.format(depth=depths[side])}" for side in sides)
    return f"y {'-' if sides[0] == 'lower' else '+'}= {first}" + "".join(f" - {other}" for other in others)


def _bumper(sides: Sequence[str], law: Callable[[Floats, float], Floats]) -> Columns:
    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        ends = zip((SIDES[side] for side in sides), shape, strict=False)
        return np.column_stack([side * law(_depth(scene, side, end), shape[-1]) for side, end in ends])

    return columns


def _pressed_by(scene: Scene, side: float, end: float, compliance: float) -> Floats:
    """How deep a load that a spring moves is in a stop on one side, with its sign, rad, shape (n,)."""
    place = side * (scene.signals.smooth_x - compliance * scene.torque)
    # Where it moves is known with the spring only. On another recording a stop stays where it was found.
    low, _ = _between(place, max(0.5 * float(np.ptp(place)), SMALLEST))
    there = bool(scene.signals.sizes) or low <= end <= float(np.quantile(place, 1.0 - SOMETIMES))
    return np.asarray(side * np.maximum(place - end, 0.0) * there)


def _of_load(sides: Sequence[str]) -> Columns:
    """Stops of a load that a spring moves: the deflection without what the torque stretches the spring is where it is.

    Its friction has it meet them at another deflection than it leaves them.
    """
    return lambda scene, shape: np.column_stack(
        [_pressed_by(scene, SIDES[side], end, shape[-1]) for side, end in zip(sides, shape, strict=False)]
    )


def _where_load_is(
    scene: Scene, sides: Sequence[str], compliance: float
) -> Callable[[tuple[float, ...], Floats], tuple[float, ...]]:
    """Where stops of a load are looked for first: it meets them for as long as those of the deflection were met."""

    def start(shape: tuple[float, ...], coefficients: Floats) -> tuple[float, ...]:
        x = scene.signals.smooth_x
        place, signs = x - compliance * scene.torque, [SIDES[side] for side in sides]
        shares = [float(np.mean(sign * x < end)) for sign, end in zip(signs, shape, strict=True)]
        return (*(float(np.quantile(s * place, q)) for s, q in zip(signs, shares, strict=True)), compliance)

    return start


def _thick(thickness: float) -> Callable[[tuple[float, ...], Floats], tuple[float, ...]]:
    return lambda shape, coefficients: (*shape, thickness)


class EndStop(Effect):
    """Contact with a stop: stiff beyond a deflection, absent before it."""

    id: ClassVar[str] = "end_stop"
    title: ClassVar[str] = "end stop"
    summary: ClassVar[str] = "contact that stiffens the joint beyond a deflection near the end of the stroke"
    equation: ClassVar[str] = (
        "y += k d^p − k' d'^p,  d = max(x − a, 0), d' = max(−x − a', 0), p = 1 or 1.5, or any from 1 to 2.5 where it is damped; damped: + c v or + c d^p v while "
        "touched, or + r d^p (1 + s)/2, s the direction of pressing; relaxing: k d + k2 (d − L), τ dL/dt = d − L; or y += k d / (1 − d/d0) or k (exp(d/d0) − 1); or x in d and d' is a load's place x − q y"
    )
    coordinate: ClassVar[str] = "position"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("stiffness_upper", "N·m/rad^p", 0.0, np.inf, "of the upper stop"),
        Parameter("stiffness_lower", "N·m/rad^p", 0.0, np.inf, "of the lower stop"),
        Parameter("damping", "N·m·s/rad or N·m·s/rad^(p + 1)", 0.0, np.inf, "c, of one stop, or of the upper one"),
        Parameter(
            "damping_lower",
            "N·m·s/rad or N·m·s/rad^(p + 1)",
            0.0,
            np.inf,
            "c of the lower stop, where both are touched",
        ),
        Parameter(
            "lost_stiffness",
            "N·m/rad^p",
            0.0,
            np.inf,
            "r, by which a stop that rubs is stiffer while it is pressed, or the upper one",
        ),
        Parameter("lost_stiffness_lower", "N·m/rad^p", 0.0, np.inf, "r of the lower stop, where both are touched"),
        Parameter("relaxing", "N·m/rad", 0.0, np.inf, "k2, stiffness that relaxes, of one stop, or of the upper one"),
        Parameter("relaxing_lower", "N·m/rad", 0.0, np.inf, "the same of the lower stop, where both are touched"),
        Parameter("time_constant", "s", 0.0, np.inf, "τ, in which it does"),
        Parameter(
            "thickness",
            "rad",
            0.0,
            np.inf,
            "d0, depth at which a rubber bumper would be flat, or over which its torque grows e-fold",
        ),
        Parameter("power", "1", *POWERS, "p of the depth"),
        Parameter(
            "compliance",
            "rad/(N·m)",
            0.0,
            np.inf,
            "q, of a spring up to a load that meets the stop, whose place is x − q y",
        ),
        *(parameter for parameter in PRESLIDING if parameter.name == "transition_speed"),
        Parameter("upper", "rad", -np.inf, np.inf, "deflection a at which the upper stop is touched"),
        Parameter("lower", "rad", -np.inf, np.inf, "−deflection a' at which the lower stop is touched"),
    )
    confused_with: ClassVar[tuple[str, ...]] = ("stiffness_asymmetry", "torque_saturation", "miscalibration")
    # Their second coefficient was a friction that might have pulled.
    former: ClassVar[tuple[str, ...]] = ("upper, rubbing", "lower, rubbing", "both, rubbing")

    def imitates(self, signal: Floats, scene: Scene) -> Collection[str]:
        return ("stiffness_asymmetry",) if is_one_sided_stiffness(signal, scene) else ()

    def forms(self, scene: Scene) -> list[Form]:
        x = scene.signals.smooth_x
        reach = scene.signals.reach
        (up, top), (down, bottom) = _ends(x, reach), _ends(-x, reach)
        span, interval = float(scene.signals.elapsed.max()), scene.signals.interval
        by_speed = next(law for law in direction_laws(scene) if law.by_speed)
        lossy = [
            _Lossy("lossy", f"dahl(x, {TURNED * reach:.8g})", _rubbing),
            _Lossy("lossy by speed", by_speed.equation, partial(_rubbing, by_speed=by_speed), (by_speed.parameter,), (by_speed.limits,),
                   tuple(by_speed.grid[-1:])),
        ]  # fmt: skip
        relaxation, soon = (min(4.0 * interval, 0.01 * span), 0.04 * span), 0.01 * span
        made = []
        for power, told in ((1.0, ""), (1.5, ", Hertz")):
            made += [
                Form(f"upper{told}", ("stiffness_upper",), _columns(True, False, power), (0.0,), (np.inf,), ("upper",),
                     [(a,) for a in up], [top], equation=f"y += {_term('upper', power)}"),
                Form(f"lower{told}", ("stiffness_lower",), _columns(False, True, power), (0.0,), (np.inf,), ("lower",),
                     [(a,) for a in down], [bottom], equation=f"y -= {_term('lower', power)}"),
                Form(f"both{told}", ("stiffness_upper", "stiffness_lower"), _columns(True, True, power), (0.0, 0.0),
                     (np.inf, np.inf), ("upper", "lower"), list(zip(up, down, strict=True)), [top, bottom],
                     equation=f"y += {_term('upper', power)} - {_term('lower', power)}"),
            ]  # fmt: skip
        for (told, side), limits in zip(SIDES.items(), (top, bottom), strict=True):
            names = (f"stiffness_{told}", "damping")
            free = (0.0, 0.0), (np.inf, np.inf), (told,), (), [limits]
            made += [
                Form(f"{told}, damped", names, _damped(side), *free, (told,),
                     equation=f"y += {_lossy(told, 1.0, 'damping')}"),
                Form(f"{told}, Hunt-Crossley", names, _contact(side, 1.5), *free, (f"{told}, Hertz",),
                     equation=f"y += {_lossy(told, 1.5, 'damping')}"),
                Form(f"{told}, {ANY}", names, _contact(side), (0.0, 0.0), (np.inf, np.inf), (told, "power"), (),
                     [limits, POWERS], (told, f"{told}, Hertz", f"{told}, damped", f"{told}, Hunt-Crossley"),
                     lambda shape, _: (*shape, 1.25), equation=f"y += {_lossy(told, 'power', 'damping')}"),
                *(
                    Form(f"{told}, {kind.name}", (names[0], "lost_stiffness"), kind.law(side), (0.0, 0.0), (np.inf, np.inf),
                         (told, "power", *kind.shapes), (), [limits, POWERS, *kind.limits], (told, f"{told}, Hertz"), kind.start,
                         equation=f"y += {_rubs(told, 'lost_stiffness', kind.direction)}")
                    for kind in lossy
                ),
                Form(f"{told}, relaxing", (names[0], "relaxing"), _relaxing(side), (0.0, 0.0), (np.inf, np.inf),
                     (told, "time_constant"), (), [limits, relaxation], (told,), lambda shape, _: (*shape, soon),
                     equation=f"y {'-' if side < 0.0 else '+'}= {_relaxes(told, 'relaxing')}"),
            ]  # fmt: skip
        softest = reach / max(float(np.abs(scene.torque).max()), SMALLEST)
        for sides, ends in ((("upper",), [top]), (("lower",), [bottom]), (("upper", "lower"), [top, bottom])):
            told, stiffnesses = "both" if len(sides) > 1 else sides[0], [f"stiffness_{side}" for side in sides]
            none, most, plain = (0.0,) * len(sides), (np.inf,) * len(sides), (told, f"{told}, Hertz")
            made += [
                Form(f"{told}, {kind}", stiffnesses, _bumper(sides, law), none, most, (*sides, "thickness"), (),
                     [*ends, (0.03 * reach, 3.0 * reach)], plain, _thick(share * reach),
                     equation=_pressed(sides, equation))
                for kind, equation, law, share in BUMPERS
            ]  # fmt: skip
            farther_in = [(high - (OUTERMOST[1] - FARTHEST_IN) * reach, high) for _, high in ends]
            made.append(
                Form(f"{told}, of the load", stiffnesses, _of_load(sides), none, most, (*sides, "compliance"), (),
                     [*farther_in, (STIFF * softest, softest)], plain, _where_load_is(scene, sides, STRETCHED * softest),
                     guessed=True, equation=_pressed(sides, "{depth}", DEPTHS_OF_LOAD))
            )  # fmt: skip
        ends, all_four = [top, bottom], ("stiffness_upper", "stiffness_lower", "damping", "damping_lower")
        any_size = (0.0,) * 4, (np.inf,) * 4
        made += [
            Form("both, damped", all_four, _both(_damped), *any_size, ("upper", "lower"), (), ends, ("both",),
                 equation=f"y += {_lossy('upper', 1.0, 'damping')} + {_lossy('lower', 1.0, 'damping_lower')}"),
            Form("both, Hunt-Crossley", all_four, _both(lambda side: _contact(side, 1.5)), *any_size, ("upper", "lower"), (), ends, ("both, Hertz",),
                 equation=f"y += {_lossy('upper', 1.5, 'damping')} + {_lossy('lower', 1.5, 'damping_lower')}"),
            Form(f"both, {ANY}", all_four, _both(_contact), *any_size, ("upper", "lower", "power"), (), [*ends, POWERS],
                 ("both", "both, Hertz", "both, damped", "both, Hunt-Crossley"), lambda shape, _: (*shape, 1.25),
                 equation=f"y += {_lossy('upper', 'power', 'damping')} + {_lossy('lower', 'power', 'damping_lower')}"),
            *(
                Form(f"both, {kind.name}", (*all_four[:2], "lost_stiffness", "lost_stiffness_lower"), _both(kind.law), *any_size,
                     ("upper", "lower", "power", *kind.shapes), (), [*ends, POWERS, *kind.limits], ("both", "both, Hertz"), kind.start,
                     equation=f"y += {_rubs('upper', 'lost_stiffness', kind.direction)} + {_rubs('lower', 'lost_stiffness_lower', kind.direction)}")
                for kind in lossy
            ),
            Form("both, relaxing", (*all_four[:2], "relaxing", "relaxing_lower"), _both(_relaxing), *any_size,
                 ("upper", "lower", "time_constant"), (), [*ends, relaxation], ("both",), lambda shape, _: (*shape, soon),
                 equation=f"y += {_relaxes('upper', 'relaxing')} - {_relaxes('lower', 'relaxing_lower')}"),
        ]  # fmt: skip
        return made
