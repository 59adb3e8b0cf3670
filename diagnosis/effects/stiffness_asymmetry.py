"""A joint that is stiffer on one side."""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import ClassVar

import numpy as np

from .base import BOTH, NOT, Columns, Effect, Floats, Form, Parameter, Scene
from .images import is_shifted_spring
from .parts import FOUND_SPRING, FOUND_SPRING_EQUATION, PARTS, Part, odd_spring

__all__ = ["StiffnessAsymmetry"]


def _torque(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return np.maximum(scene.torque, 0.0)[:, None]


def _torque_lower(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return np.minimum(scene.torque, 0.0)[:, None]


def _torque_opposed(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return np.abs(scene.torque)[:, None]


def _quadratic(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return np.square(scene.signals.smooth_x)[:, None]


def _hardening(scene: Scene) -> Floats:
    """A spring without stiffness at zero that hardens both ways, rad²."""
    return scene.signals.smooth_x * np.abs(scene.signals.smooth_x)


def _sided(side: float, part: Callable[[Scene], Floats]) -> Columns:
    """A part of the torque on one side (±1), or of opposite sign on both (0)."""

    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        x = scene.signals.smooth_x
        return (part(scene) * (np.sign(x) if side == 0.0 else (side * x > 0.0)))[:, None]

    return columns


def _progressively(side: float) -> Columns:
    """A spring on one side (±1) that is stiffer the farther it goes."""

    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        beyond = np.maximum(side * scene.signals.smooth_x, 0.0)
        return side * np.column_stack([beyond, beyond**2])

    return columns


def _rounded(side: float, part: Callable[[Scene], Floats]) -> Columns:
    """The same where the change from one side to the other is not sharp."""

    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        turned = np.tanh(scene.signals.smooth_x / shape[0])
        return (part(scene) * (turned if side == 0.0 else 0.5 * (1.0 + side * turned)))[:, None]

    return columns


def _ramped(side: float) -> Columns:
    """The spring, whose relative change grows on one side (±1) up to a place and stays there."""

    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        return (scene.spring * np.clip(side * scene.signals.smooth_x / shape[0], 0.0, 1.0))[:, None]

    return columns


def _from_place(side: float, settled: bool) -> Columns:
    """Stiffer from a place on that is not the zero, on the side of ±1 of it; all of the change is rounded.

    ``settled`` if it makes no torque at zero, so that what it makes on the other side is a preload.
    """

    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        place, knee = shape
        at_zero = np.logaddexp(0.0, -side * place / knee) if settled else 0.0
        return (side * knee * (np.logaddexp(0.0, side * (scene.signals.smooth_x - place) / knee) - at_zero))[:, None]

    return columns


def _found_anew(side: float) -> Columns:
    """An odd spring of its own on one side (±1), where the simulator's is not told from its friction."""
    return lambda scene, shape: odd_spring(scene) * (side * scene.signals.smooth_x > 0.0)[:, None]


def _unequal(scene: Scene, shape: tuple[float, ...]) -> Floats:
    """Stiffer on one side and softer on the other, each by a part of its own."""
    x, spring = scene.signals.smooth_x, scene.spring
    return np.column_stack([spring * (x > 0.0), -spring * (x < 0.0)])


def _progressive(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return (scene.spring * scene.signals.smooth_x / scene.signals.reach)[:, None]


def _loaded(side: float) -> Columns:
    """The spring while the whole torque is of one sign (±1)."""
    return lambda scene, shape: (scene.spring * (side * scene.torque > 0.0))[:, None]


def _hardening_by(side: float) -> Columns:
    """A spring that hardens with a power of the deflection on one side (±1)."""

    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        beyond = np.maximum(side * scene.signals.smooth_x, 0.0) / scene.signals.reach
        return (side * beyond ** shape[0])[:, None]

    return columns


def _exponential(side: float, settled: bool) -> Columns:
    """One spring of a pair that pull against each other and stiffen with what they carry: it is the stiffer one, on the side of ±1.

    ``settled`` if it makes no torque at zero.
    """

    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        made = np.exp(side * scene.signals.smooth_x / shape[0])
        return (side * shape[0] * (made - settled))[:, None]

    return columns


def _stretched(side: float) -> Columns:
    """Stiffer inside the joint: on one side its elements see a larger deflection."""

    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        x = scene.signals.x
        return scene.torque_change(x + shape[0] * side * np.maximum(side * x, 0.0))[:, None]

    return columns


SIDES = (1.0, "", "-", "upper side"), (-1.0, "-", "", "lower side")
"""Of the deflection: as a factor, as an equation's sign, the other way round and in words."""
ONE_SIDED = 1e-3
"""Share of its energy by which a law must differ from a factor on the torque, or on the spring, to be of one side only."""


def _is_a_factor(form: Form, scene: Scene) -> bool:
    """Whether all that was seen of the joint is on the law's side."""
    if form.shapes:
        return False
    for column in form.columns(scene, ()).T:
        for whole in (scene.torque, scene.spring):
            energy = float(column @ column) * float(whole @ whole)
            if energy > 0.0 and float(column @ whole) ** 2 > (1.0 - ONE_SIDED) * energy:
                return True
    return False


class StiffnessAsymmetry(Effect):
    """Different stiffness for positive and negative deflection."""

    id: ClassVar[str] = "stiffness_asymmetry"
    title: ClassVar[str] = "stiffness asymmetry"
    summary: ClassVar[str] = "stiffer on one side than on the other (unequal springs, one-sided contact)"
    equation: ClassVar[str] = (
        "y += k max(±x, 0), k |x| (sharp or rounded), the first also from another place on, k2 x² (also on one side, there beside k), k x + k3 x³ on one side, Y (±x/X)^p on one side of the stroke X, k L exp(±x/L), g y_sim or its elastic part on one side (also growing up to a place), under torque of one sign, in proportion to x or of opposite sign "
        "on both, or x → x + s max(±x, 0)"
    )
    coordinate: ClassVar[str] = "position"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("extra_stiffness", "N·m/rad", -np.inf, np.inf, "added on one side"),
        Parameter(
            "extra_stiffness_slope",
            "N·m/rad²",
            -np.inf,
            np.inf,
            "k2, of a stiffness that grows across zero or from there on",
        ),
        Parameter(
            "extra_stretch", "1", -0.6, 1.5, "s, relative difference of one side's stiffness at the same strength"
        ),
        Parameter("extra_gain", "1", -1.0, 1.0, "relative difference of one side"),
        Parameter("other_gain", "1", -1.0, 1.0, "the same of the negative side the other way round"),
        Parameter("spring_rate", "N·m/rad", -np.inf, np.inf, "added on one side, of a spring that is found anew"),
        Parameter("spring_cubic", "N·m/rad³", -np.inf, np.inf, "of its cubic part"),
        Parameter("extra_torque", "N·m", -np.inf, np.inf, "Y, of one side at the stroke's end"),
        Parameter("power", "1", 1.2, 5.0, "p, with which that grows"),
        Parameter("place", "rad", -np.inf, np.inf, "from which on it is stiffer, where that is not the zero"),
        Parameter(
            "growth", "rad", 0.0, np.inf, "deflection over which the stiffness of one spring of a pair grows e-fold"
        ),
        Parameter("ramp", "rad", 0.0, np.inf, "deflection up to which that difference grows"),
        Parameter("knee", "rad", 0.0, np.inf, "width over which the stiffness changes"),
    )
    confused_with: ClassVar[tuple[str, ...]] = ("end_stop", "deflection_offset", "torque_gain")
    # With a constant torque beside it, which is what a shift of a spring makes.
    image_of: ClassVar[tuple[str, ...]] = ("deflection_offset",)

    def imitates(self, signal: Floats, scene: Scene) -> Collection[str]:
        return self.image_of if is_shifted_spring(signal, scene) else ()

    def forms(self, scene: Scene) -> list[Form]:
        free = (-np.inf,), (np.inf,)
        gain = (-1.0,), (1.0,)
        reach = scene.signals.reach
        knee = [(1e-3 * reach, 0.3 * reach)]
        made = [
            Form("positive torque", ("extra_gain",), _torque, *gain, equation="y += extra_gain * maximum(y, 0)"),
            Form("negative torque", ("extra_gain",), _torque_lower, *gain, equation="y += extra_gain * minimum(y, 0)"),
            Form(
                "opposed by the sign of torque",
                ("extra_gain",),
                _torque_opposed,
                *gain,
                equation="y += extra_gain * abs(y)",
            ),
            Form(
                "quadratic", ("extra_stiffness_slope",), _quadratic, *free, equation="y += extra_stiffness_slope * x**2"
            ),
            Form("quadratic, upper side", ("extra_stiffness_slope",), _sided(1.0, _hardening), *free,
                 equation="y += extra_stiffness_slope * x * maximum(x, 0)"),
            Form("quadratic, lower side", ("extra_stiffness_slope",), _sided(-1.0, _hardening), *free,
                 equation="y += extra_stiffness_slope * x * maximum(-x, 0)"),
        ]  # fmt: skip
        sides = ("extra_gain", "other_gain"), _unequal
        told_unequal = "y += where(x > 0, extra_gain, -other_gain) * y_spring"
        made += [
            Form("elastic torque, stiffer above and softer below", *sides, (0.0,) * 2, (1.0,) * 2, equation=told_unequal),
            Form("elastic torque, softer above and stiffer below", *sides, (-1.0,) * 2, (0.0,) * 2, equation=told_unequal),
            Form("elastic torque, progressive", ("extra_gain",), _progressive, *gain,
                 equation=f"y += extra_gain * x / {reach:.8g} * y_spring"),
            Form("elastic torque, under positive torque", ("extra_gain",), _loaded(1.0), *gain,
                 equation="y += extra_gain * (y > 0) * y_spring"),
            Form("elastic torque, under negative torque", ("extra_gain",), _loaded(-1.0), *gain,
                 equation="y += extra_gain * (y < 0) * y_spring"),
        ]  # fmt: skip
        made += [
            Form(f"progressive, {told}", ("extra_stiffness", "extra_stiffness_slope"), _progressively(side), (0.0,) * 2, (np.inf,) * 2,
                 equation=f"y += {sign}(extra_stiffness * maximum({sign}x, 0) + extra_stiffness_slope * maximum({sign}x, 0)**2)")
            for side, sign, _, told in SIDES
        ]  # fmt: skip
        made += [
            Form(f"hardening, {told}", ("extra_torque",), _hardening_by(side), *free, ("power",), (), [(1.2, 5.0)],
                 (f"quadratic, {told}",), lambda shape, coefficients: (2.5,),
                 equation=f"y += {sign}extra_torque * (maximum({sign}x, 0) / {reach:.8g})**power")
            for side, sign, _, told in SIDES
        ]  # fmt: skip
        made += [
            Form(f"exponential, {told}{at_zero}", ("extra_stiffness",), _exponential(side, bool(at_zero)), *free, ("growth",), (),
                 [(0.25 * reach, 1.5 * reach)], ("quadratic", f"quadratic, {told}", f"progressive, {told}"),
                 lambda shape, coefficients: (0.6 * reach,),
                 equation=f"y += {sign}extra_stiffness * growth * {grown}")
            for side, sign, _, told in SIDES
            for at_zero, grown in (
                ("", f"exp({sign}x / growth)"), (", none at zero", f"(exp({sign}x / growth) - 1)"),
            )
        ]  # fmt: skip
        made += [
            Form(f"elastic torque, {told}, ramped", ("extra_gain",), _ramped(side), *gain, ("ramp",), (),
                 [(0.05 * reach, reach)], (f"elastic torque, {told}",), lambda shape, coefficients: (0.4 * reach,),
                 equation=f"y += extra_gain * y_spring * minimum(maximum({sign}x / ramp, 0), 1)")
            for side, sign, _, told in SIDES
        ]  # fmt: skip
        middle = 0.5 * float(scene.signals.smooth_x.min() + scene.signals.smooth_x.max())
        made += [
            # Nearer to the ends it would be a stop.
            Form(f"from a place on, {told}{at_zero}", ("extra_stiffness",), _from_place(side, bool(at_zero)), *free, ("place", "knee"), (),
                 [(middle - 0.25 * reach, middle + 0.25 * reach), *knee], tuple(law.format(told) for law in simpler),
                 lambda shape, coefficients: (middle, *(shape or (0.03 * reach,))), borders=[BOTH, NOT],
                 equation=f"y += {sign}extra_stiffness * knee * {rounded}")
            for side, sign, other, told in SIDES
            for at_zero, rounded, simpler in (
                ("", f"logaddexp(0, {sign}(x - place) / knee)", ("spring, {}",)),
                (", none at zero", f"(logaddexp(0, {sign}(x - place) / knee) - logaddexp(0, {other}place / knee))",
                 ("spring, {}", "spring, {}, rounded", "elastic torque, {}, rounded")),
            )
        ]  # fmt: skip
        made += [
            Form(f"of a spring found anew, {told}", FOUND_SPRING, _found_anew(side), (-np.inf,) * 2, (np.inf,) * 2, grid=(), guessed=True,
                 refines=tuple(f"{law}, {told}" for law in ("spring", "elastic torque", "progressive")),
                 equation=f"y += ({sign}x > 0) * ({FOUND_SPRING_EQUATION})")
            for side, sign, _, told in SIDES
        ]  # fmt: skip
        for what, part, name, bounds in (
            ("spring", Part("x", lambda scene: scene.signals.smooth_x), "extra_stiffness", free),
            ("torque", Part("y", lambda scene: scene.torque), "extra_gain", gain),
            ("elastic torque", PARTS["the spring"], "extra_gain", gain),
        ):
            for side, told, sharply, roundly in (
                (1.0, "upper side", "(x > 0)", "(1 + tanh(x / knee)) / 2"),
                (-1.0, "lower side", "(x < 0)", "(1 - tanh(x / knee)) / 2"),
                (0.0, "both sides", "sign(x)", "tanh(x / knee)"),
            ):
                sharp = f"{what}, {told}"
                made += [
                    Form(sharp, (name,), _sided(side, part.of), *bounds, equation=f"y += {name} * {part.symbol} * {sharply}"),
                    Form(f"{sharp}, rounded", (name,), _rounded(side, part.of), *bounds, ("knee",), (), knee, (sharp,),
                         lambda shape, coefficients: (0.03 * reach,), equation=f"y += {name} * {part.symbol} * {roundly}"),
                ]  # fmt: skip
                if what == "torque" and side != 0.0:
                    made.append(
                        Form(f"stiffness, {told}", ("_unit",), _stretched(side), (1.0,), (1.0,), ("extra_stretch",), (),
                             [(-0.6, 1.5)], (sharp, f"elastic {sharp}"), lambda shape, coefficients: (float(coefficients[0]),),
                             equation=f"x = x + extra_stretch * {'maximum' if side > 0.0 else 'minimum'}(x, 0)")
                    )  # fmt: skip
        # A law that was found elsewhere may see one side only where it goes on.
        return made if scene.signals.sizes else [form for form in made if not _is_a_factor(form, scene)]
