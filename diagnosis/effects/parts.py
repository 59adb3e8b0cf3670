"""What changes inside a joint where not all of its torque does, and laws by which it does."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from .base import Columns, ColumnsAbout, Floats, Form, Scene

__all__ = [
    "EXACT_PARTS",
    "FOUND_SPRING",
    "FOUND_SPRING_EQUATION",
    "PARTS",
    "SETTLED_AT_HOME",
    "Part",
    "by_strength",
    "inside",
    "law_of",
    "odd_spring",
    "settled_at_home",
    "times",
    "unlike",
]


class Part(NamedTuple):
    """A part of the joint's torque: how equations call it, and what it is, N·m, shape (n,).

    Of what has memory that is no more than how the torque changes with it; then ``changed(scene, gain)`` is the change for a
    relative gain, (n,), that is not small, and equations ask for that.
    """

    symbol: str
    of: Callable[[Scene], Floats]
    changed: Callable[[Scene, Floats], Floats] | None = None


PARTS: Mapping[str, Part] = {
    "the spring": Part("y_spring", lambda scene: scene.spring),
    "the friction": Part("y_memory", lambda scene: scene.friction),
    # What is stiffer and no stronger is in all larger, and then weaker.
    "the stiffness": Part(
        "stiffer", lambda scene: scene.torque - scene.strength, lambda scene, gain: _stiffened(scene, gain)
    ),
    "the friction's strength": Part(
        "stronger", lambda scene: scene.strength, lambda scene, gain: scene.stronger_at(gain)
    ),
}  # fmt: skip
"""What may change inside the joint when not all of its torque does, by name: the elastic curve, all that has memory, the
slope of both, or the level at which friction slides."""
EXACT_PARTS = "the spring", "the friction"
"""Those that are known as they are, whatever the change: a strength that changes with a corner is not known well enough."""
SETTLED_AT_HOME = "friction settled at home"
"""How laws are called by which only the spring knows where the deflection is; see :func:`settled_at_home`."""
BARELY = 0.05
"""What is left at least of a stiffness that is lost."""
A_LITTLE = 0.05
"""Gain of friction's strength that counts as small."""


def settled_at_home(scene: Scene, x: Floats, moved: Floats) -> Floats:
    """Change of the simulator's output, N·m, shape (n,), if its spring were at ``x`` (n,) and its friction had ``moved`` (n,), rad.

    Friction that lay at rest when the recording began knows only how the joint has moved since.
    """
    return scene.torque_change(moved) + scene.spring_change(x) - scene.spring_change(moved)


def times(laws: Columns, *parts: Callable[[Scene], Floats]) -> Columns:
    """``laws`` (n, k) times each of the parts (n,), side by side, shape (n, k × parts)."""
    return lambda scene, shape: np.hstack([laws(scene, shape) * part(scene)[:, None] for part in parts])


def inside(form: Form, laws: Columns, parts: Collection[str] = PARTS) -> list[Form]:
    """Forms like ``form``, which scales the whole torque by ``laws`` (n, k), that scale a part of it.

    The equation of ``form`` ends in that torque, ``y``. Where ``laws`` is one column the last of them finds that part anew.
    """
    made = []
    for name, part in ((name, PARTS[name]) for name in parts):
        of = replace(form, name=f"{form.name}, of {name}", columns=times(laws, part.of), grid=form.grid[::2])
        if part.changed is None:
            made.append(replace(of, equation=form.equation.removesuffix("y") + part.symbol))
        else:
            gain = form.equation.removesuffix(" * y").replace("y += ", "").replace("y -= ", "-")
            made.append(replace(of, about=_about(laws, part), equation=f"y += {part.symbol}({gain})"))
    return [*made, _of_a_spring_found_anew(form, laws, made)] if len(form.coefficients) == 1 else made


def unlike(form: Form, laws: Columns, changes: tuple[str, str], friction: str) -> Form:
    """A law like ``form`` of one coefficient, which scales the whole torque by ``laws`` (n, 1), by which the spring and what has
    memory change, but not alike: by coefficients named ``changes``.

    ``friction`` is that part's name: of all that has memory, or of the level at which it slides.
    """
    spring, second = PARTS["the spring"], PARTS[friction]
    sign, law = form.equation.split()[1].removesuffix("="), law_of(form)
    if second.changed is None:
        equation = f"y {sign}= {law} * ({changes[0]} * {spring.symbol} + {changes[1]} * {second.symbol})"
    else:
        less = sign.removeprefix("+")
        equation = f"y += {less}{changes[0]} * {law} * {spring.symbol} + {second.symbol}({less}{changes[1]} * {law})"
    return replace(
        form, name=f"{form.name}, of spring and {friction.removeprefix('the ')}", coefficients=changes, equation=equation,
        columns=times(laws, spring.of, second.of), lower=(*form.lower,) * 2, upper=(*form.upper,) * 2,
        about=_about_second(laws, spring, second) if second.changed else None,
    )  # fmt: skip


def law_of(form: Form) -> str:
    """What a form of one coefficient scales the whole torque by, for a coefficient of one, from its equation."""
    return form.equation.split("= ", 1)[1].removeprefix(f"{form.coefficients[0]} * ").removesuffix(" * y")


def _of_a_spring_found_anew(form: Form, laws: Columns, parts: Sequence[Form]) -> Form:
    """The whole torque and an odd spring change by ``laws`` (n, 1): the spring alone, or what is left of the torque without it.

    Of many joints an emulator does not tell which part of the torque is elastic; how the gap changes may.
    """

    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        return np.hstack([form.columns(scene, shape), laws(scene, shape) * odd_spring(scene)])

    return replace(
        form, name=f"{form.name}, of a spring found anew", coefficients=(*form.coefficients, *FOUND_SPRING), columns=columns,
        lower=(*form.lower, -np.inf, -np.inf), upper=(*form.upper, np.inf, np.inf), grid=(), guessed=True,
        refines=(form.name, *(part.name for part in parts)), equation=f"{form.equation} + {law_of(form)} * ({FOUND_SPRING_EQUATION})",
    )  # fmt: skip


FOUND_SPRING = "spring_rate", "spring_cubic"
"""Names of the coefficients of a spring that an effect finds itself."""
FOUND_SPRING_EQUATION = f"{FOUND_SPRING[0]} * x + {FOUND_SPRING[1]} * x**3"


def odd_spring(scene: Scene) -> Floats:
    """Columns of these, shape (n, 2)."""
    x = scene.signals.smooth_x
    return np.column_stack([x, x * x * x])


def _stiffened(scene: Scene, gain: Floats) -> Floats:
    """Change for a relative ``gain`` (n,) of all stiffnesses that leaves what slides as strong as it was, N·m, shape (n,)."""
    left = np.maximum(1.0 + gain, BARELY)
    return gain * scene.torque + left * scene.stronger_at(-gain / left)


def _about(laws: Columns, part: Part) -> ColumnsAbout:
    """Columns of a part that changes by ``laws`` (n, k)."""
    return lambda scene, shape, coefficients: _columns_about(scene, part, laws(scene, shape), coefficients)


def _about_second(laws: Columns, first: Part, second: Part) -> ColumnsAbout:
    """Columns of two parts that change by ``laws`` (n, 1), of which the second's change is not linear."""

    def columns(scene: Scene, shape: tuple[float, ...], coefficients: Floats) -> Floats:
        relative = laws(scene, shape)
        return np.hstack([
            relative * first.of(scene)[:, None], _columns_about(scene, second, relative, coefficients[1:]),
        ])  # fmt: skip

    return columns


def _columns_about(scene: Scene, part: Part, relative: Floats, coefficients: Floats) -> Floats:
    """Columns of a part that changes by ``relative`` (n, k): what goes beyond the linear they share as they make the gain."""
    assert part.changed is not None
    makes = coefficients * np.mean(np.square(relative), axis=0)
    made = relative * part.of(scene)[:, None]
    whole = float(coefficients @ makes)
    if whole > 0.0:
        beyond = part.changed(scene, relative @ coefficients) - made @ coefficients
        made += beyond[:, None] * (makes / whole)
    return made


def by_strength(share: Columns) -> tuple[Columns, ColumnsAbout]:
    """Columns of friction inside the joint whose strength has a relative gain of the coefficient times ``share`` (n, 1), which may
    change within a swing: where they are linear, and where not."""

    def about(scene: Scene, shape: tuple[float, ...], coefficients: Floats) -> Floats:
        gain = max(float(coefficients[0]), A_LITTLE)
        return (scene.stronger_at(gain * share(scene, shape)[:, 0]) / gain)[:, None]

    return lambda scene, shape: about(scene, shape, np.zeros(1)), about
