"""Friction in proportion to the load."""

from __future__ import annotations

from collections.abc import Callable
from types import MappingProxyType
from typing import ClassVar

import numpy as np

from ..operators.levels import slid, yielding
from .base import BOTH, LOW, NOT, Columns, Effect, Floats, Form, Parameter, Scene
from .directions import PRESLIDING, DirectionLaw, direction_laws, overdone_friction
from .parts import FOUND_SPRING, FOUND_SPRING_EQUATION, PARTS, Part, by_strength, odd_spring

__all__ = ["LoadDependentFriction"]
BARELY = 1e-9
"""Load, over the largest, below which contacts hold nothing."""
CURVED, POWER, PRESLIDING_POWER = 1.6, 2.5, 1.25
"""Powers of the load: from which it starts where friction is known to grow more than in proportion, and the highest that friction
goes with, of contacts that spread or wedge, by speed and else. What builds up over a distance as well passes for a clearance then (a
cycloidal drive's was taken for it), and so does what only a load beyond a threshold presses beside a model that was fitted."""
CONTACTS = MappingProxyType({
    "presliding": ("pressed bristles", "dahl", yielding),
    "elastic presliding": ("pressed slider", "slip", slid),
})  # fmt: skip
"""Contacts of constant stiffness by the law of direction that they follow: what they are called, in words and in equations, and
their motion."""
LOAD_WORDS = ("pressure", "load", "force", "tension", "preload", "clamp", "bar")


def _columns(law: DirectionLaw, load: Callable[[Scene], Floats]) -> Callable[[Scene, tuple[float, ...]], Floats]:
    return lambda scene, shape: (np.abs(load(scene)) * law.signal(scene.signals, shape[0]))[:, None]


def _by_a_found_spring(law: DirectionLaw) -> Columns:
    """By the torque of an odd spring, which the simulator has and which is not told from its friction."""
    return lambda scene, shape: np.abs(odd_spring(scene)) * law.signal(scene.signals, shape[0])[:, None]


def _measured(channel: str) -> Callable[[Scene], Floats]:
    return lambda scene: scene.signals.channels[channel]


def _efficiency(law: DirectionLaw, load: Callable[[Scene], Floats]) -> Callable[[Scene, tuple[float, ...]], Floats]:
    """Losses of a gear that differ by whether it drives or is driven back."""

    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        carried = load(scene)
        lost = np.abs(carried) * law.signal(scene.signals, shape[0])
        driving = lost * carried > 0.0
        return np.column_stack([lost * driving, lost * ~driving])

    return columns


def _by_side(law: DirectionLaw, load: Callable[[Scene], Floats]) -> Callable[[Scene, tuple[float, ...]], Floats]:
    """Contacts of which one side carries one sign of the load, and another the other."""

    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        carried = load(scene)
        lost = np.abs(carried) * law.signal(scene.signals, shape[0])
        return np.column_stack([lost * (carried > 0.0), lost * (carried <= 0.0)])

    return columns


def _powered(law: DirectionLaw, load: Callable[[Scene], Floats]) -> Callable[[Scene, tuple[float, ...]], Floats]:
    """Contacts that flatten, so that friction grows less than the load, or that spread, so that it grows more."""

    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        most = scene.signals.strongest
        return (most * np.abs(load(scene) / most) ** shape[1] * law.signal(scene.signals, shape[0]))[:, None]

    return columns


def _beyond(law: DirectionLaw, load: Callable[[Scene], Floats]) -> Callable[[Scene, tuple[float, ...]], Floats]:
    """Contacts that only what exceeds a load presses together."""

    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        pressing = np.maximum(np.abs(load(scene)) - shape[1], 0.0)
        return (pressing * law.signal(scene.signals, shape[0]))[:, None]

    return columns


def _biased(law: DirectionLaw, load: Callable[[Scene], Floats]) -> Callable[[Scene, tuple[float, ...]], Floats]:
    """Contacts that carry a weight or a preload as well."""
    return lambda scene, shape: (np.abs(load(scene) + shape[1]) * law.signal(scene.signals, shape[0]))[:, None]


def _lifting(law: DirectionLaw, load: Callable[[Scene], Floats]) -> Callable[[Scene, tuple[float, ...]], Floats]:
    """Contacts that a preload presses together, until the load lifts them off; its sign is the bias'."""

    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        pressing = np.maximum(np.sign(shape[1]) * (load(scene) + shape[1]), 0.0)
        return (pressing * law.signal(scene.signals, shape[0]))[:, None]

    return columns


def _pressed(
    load: Callable[[Scene], Floats], most: float, sliding: Callable[[Floats, Floats, float], Floats]
) -> Columns:
    """Contacts of constant stiffness that give way later the more they are pressed together, ``most`` at the largest load.

    A second shape is their level where the joint is driven back, over the one where it drives.
    """

    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        signals, carried = scene.signals, load(scene)
        level = np.abs(carried) / most
        if len(shape) > 1:
            level *= np.where(carried * signals.speed > 0.0, 1.0, shape[1])
        level = np.maximum(level, BARELY)
        return most * signals.per_run(lambda run: sliding(signals.smooth_x[run], level[run], shape[0]))[:, None]

    return columns


def _loaded(scene: Scene, shape: tuple[float, ...]) -> Floats:
    """The load over the largest torque, shape (n, 1): the elements inside the joint slide later the more it is loaded."""
    return (np.abs(scene.spring) / scene.signals.strongest)[:, None]


class LoadDependentFriction(Effect):
    """Friction of gears, joints and belts: Coulomb's law with a normal force that the transmitted load makes."""

    id: ClassVar[str] = "load_dependent_friction"
    title: ClassVar[str] = "load-dependent friction"
    summary: ClassVar[str] = "friction in proportion to the transmitted load (gear teeth, pulleys, pressed seals)"
    equation: ClassVar[str] = (
        "y += μ |y_sim| s   (|load channel|, Y |y_sim/Y|^p with the largest torque Y, max(|y_sim| − T, 0), or the elastic part, or |k x + k3 x³|, in place of |y_sim|; μ' where the joint is driven "
        "back, or the load is negative; or |y_sim + bias|, or that on one side only; contacts of constant stiffness that give way at μ |y_sim|, or at μ' |y_sim|; or friction inside the joint that slides later under load)"
    )
    coordinate: ClassVar[str] = "load"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            "friction_coefficient",
            "1",
            -np.inf,
            np.inf,
            "friction over load; negative where the simulator has too much",
        ),
        Parameter("friction_coefficient_back", "1", 0.0, np.inf, "μ', where the joint is driven back"),
        Parameter("friction_coefficient_below", "1", 0.0, np.inf, "where the load is negative, if it differs there"),
        Parameter("spring_rate", "N·m/rad", 0.0, np.inf, "friction by deflection, of a spring that is found anew"),
        Parameter("spring_cubic", "N·m/rad³", -np.inf, np.inf, "of its cubic part"),
        Parameter("bias", "N·m", -np.inf, np.inf, "load that the contacts carry besides: a weight, a preload"),
        Parameter("driven_ratio", "1", 0.1, 10.0, "μ' / μ"),
        Parameter("power", "1", 0.4, POWER, "p of the load"),
        Parameter("threshold", "N·m", 0.0, np.inf, "T, load beyond which the contacts are pressed together"),
        Parameter(
            "strength_gain", "1", 0.0, np.inf, "relative gain of the friction's strength under the largest torque"
        ),
        *PRESLIDING,
    )
    confused_with: ClassVar[tuple[str, ...]] = ("coulomb_friction", "miscalibration")

    def forms(self, scene: Scene) -> list[Form]:
        loads = {"torque": Part("y", lambda scene: scene.torque)}
        for name, values in scene.signals.channels.items():
            if any(word in name.lower() for word in LOAD_WORDS) and np.ptp(values) > 0.05 * np.max(np.abs(values)):
                loads[name] = Part(name, _measured(name))
        laws, strongest = direction_laws(scene), scene.signals.strongest
        most = f"{strongest:.8g}"
        made = [
            Form(f"by {name}, {law.name}", ("friction_coefficient",), _columns(law, load.of), (0.0,), (np.inf,),
                 (law.parameter,), [(value,) for value in law.grid], [law.limits],
                 equation=f"y += friction_coefficient * abs({load.symbol}) * {law.equation}")
            for name, load in loads.items()
            for law in laws
        ]  # fmt: skip
        less = overdone_friction(made)
        carried = {"torque": loads["torque"], "elastic torque": PARTS["the spring"]}

        def steepest(law: DirectionLaw) -> float:
            return POWER if law.by_speed else PRESLIDING_POWER

        def simpler(of: str, direction: str) -> tuple[str, ...]:
            """Laws from which those start that are not in proportion to the load, and seem to differ by side at first."""
            by_torque = [f"by a power of torque, {direction}", f"by torque beyond a threshold, {direction}"]
            return (
                f"by {of}, {direction}",
                f"by {of}, unequal sides, {direction}",
                *(by_torque if of != "torque" else []),
            )

        for law in laws:
            simple = (f"by torque, {law.name}",)
            made += [
                Form(f"by elastic torque, {law.name}", ("friction_coefficient",), _columns(law, carried["elastic torque"].of), (0.0,), (np.inf,),
                     (law.parameter,), (), [law.limits], simple,
                     equation=f"y += friction_coefficient * abs(y_spring) * {law.equation}"),
                Form(f"by a spring found anew, {law.name}", FOUND_SPRING, _by_a_found_spring(law), (0.0, -np.inf), (np.inf,) * 2,
                     (law.parameter,), (), [law.limits], (*simple, f"by elastic torque, {law.name}"), guessed=True,
                     equation=f"y += ({FOUND_SPRING_EQUATION}) * sign(x) * {law.equation}"),
                *(
                    Form(f"by {of}, driving and driven, {law.name}", ("friction_coefficient", "friction_coefficient_back"),
                         _efficiency(law, load.of), (0.0,) * 2, (np.inf,) * 2, (law.parameter,), (), [law.limits], (f"by {of}, {law.name}",),
                         equation=f"y += where({load.symbol} * s > 0, friction_coefficient, friction_coefficient_back) * "
                         f"abs({load.symbol}) * s,  s = {law.equation}")
                    for of, load in carried.items()
                ),
                *(
                    Form(f"by a power of {of}, {law.name}", ("friction_coefficient",), _powered(law, load.of), (0.0,), (1.0,),
                         (law.parameter, "power"), (), [law.limits, (0.4, steepest(law))], simpler(of, law.name), lambda shape, _: (shape[0], 1.0 if len(shape) == 1 else CURVED),
                         borders=[NOT, LOW], equation=f"y += friction_coefficient * {most} * abs({load.symbol} / {most})**power * {law.equation}")
                    for of, load in carried.items()
                ),
                *(
                    Form(f"by {of} beyond a threshold, {law.name}", ("friction_coefficient",), _beyond(law, load.of), (0.0,), (np.inf,),
                         (law.parameter, "threshold"), (), [law.limits, (0.02 * strongest, 0.8 * strongest)], simpler(of, law.name),
                         lambda shape, _: (shape[0], 0.2 * strongest), guessed=not law.by_speed,
                         equation=f"y += friction_coefficient * maximum(abs({load.symbol}) - threshold, 0) * {law.equation}")
                    for of, load in (carried.items() if law.name != "elastic presliding" else ())
                ),
                *(
                    Form(f"by {of}, unequal sides, {law.name}", ("friction_coefficient", "friction_coefficient_below"),
                         _by_side(law, load.of), (0.0,) * 2, (np.inf,) * 2, (law.parameter,), (), [law.limits], (f"by {of}, {law.name}",),
                         equation=f"y += where({load.symbol} > 0, friction_coefficient, friction_coefficient_below) * "
                         f"abs({load.symbol}) * {law.equation}")
                    for of, load in carried.items()
                ),
                *(
                    Form(f"by {of} and a bias, {law.name}", ("friction_coefficient",), _biased(law, load.of), (0.0,), (np.inf,),
                         (law.parameter, "bias"), (), [law.limits, (-0.8 * strongest, 0.8 * strongest)], (f"by {of}, unequal sides, {law.name}",),
                         lambda shape, found: (*shape, (0.2 if found[0] > found[1] else -0.2) * strongest),
                         borders=[NOT, BOTH], equation=f"y += friction_coefficient * abs({load.symbol} + bias) * {law.equation}")
                    for of, load in carried.items()
                ),
                *(
                    Form(f"by {of} and a bias, lifting off, {law.name}", ("friction_coefficient",), _lifting(law, load.of), (0.0,), (np.inf,),
                         (law.parameter, "bias"), (), [law.limits, (-1.5 * strongest, 1.5 * strongest)], (f"by {of} and a bias, {law.name}",),
                         equation=f"y += friction_coefficient * maximum(sign(bias) * ({load.symbol} + bias), 0) * {law.equation}")
                    for of, load in carried.items()
                ),
            ]  # fmt: skip
        for of, load in {**loads, **carried}.items():
            pressing = f"abs({load.symbol})"
            largest = strongest if of in carried else float(np.max(np.abs(load.of(scene))))
            told_most = f"{largest:.8g}"
            for law in (law for law in laws if law.name in CONTACTS):
                contact, word, sliding = CONTACTS[law.name]
                told = f"{word}(x, {law.parameter}, {pressing} / {told_most})"
                made.append(
                    Form(f"by {of}, {contact}", ("friction_coefficient",), _pressed(load.of, largest, sliding), (0.0,), (np.inf,),
                         (law.parameter,), (), [law.limits], (f"by {of}, {law.name}",),
                         equation=f"y += friction_coefficient * {told_most} * {told}")
                )  # fmt: skip
        for of, load in carried.items():
            pressing = f"abs({load.symbol})"
            for law in (law for law in laws if law.name in CONTACTS):
                contact, word, sliding = CONTACTS[law.name]
                level = f"{pressing} / {most} * where({load.symbol} * v > 0, 1, driven_ratio)"
                made.append(
                    Form(f"by {of}, driving and driven, {contact}", ("friction_coefficient",), _pressed(load.of, strongest, sliding),
                         (0.0,), (np.inf,), (law.parameter, "driven_ratio"), (), [law.limits, (0.1, 10.0)],
                         (f"by {of}, {contact}", *(f"by {of}, driving and driven, {other}" for other in CONTACTS)),
                         lambda shape, found: (shape[0], float(found[1] / found[0]) if found.size > 1 and found[0] > 0.0 else 0.7),
                         equation=f"y += friction_coefficient * {most} * {word}(x, {law.parameter}, {level})")
                )  # fmt: skip
        columns, about = by_strength(_loaded)
        inside = Form("inside the joint", ("strength_gain",), columns, (0.0,), (np.inf,), about=about,
                      equation=f"y += stronger(strength_gain * abs(y_spring) / {most})")  # fmt: skip
        return [*made, *less, inside]
