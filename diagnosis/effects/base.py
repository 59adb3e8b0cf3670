"""What an effect is: what it says, and which signals it would leave in a gap.

An effect offers one or more *forms* of its law. A form gives, for values of its shape parameters, columns that enter
the gap linearly. So a fit is a small bounded least-squares problem inside a search over shapes (variable projection:
Golub & Pereyra, Inverse Problems 19, 2003).
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from ..recording.noise import rms
from ..recording.signals import Signals

__all__ = [
    "BOTH",
    "CLOCKS",
    "ELAPSED",
    "FOUND_SPRING",
    "FOUND_SPRING_EQUATION",
    "HIGH",
    "INPUT",
    "LOW",
    "NOT",
    "PARTS",
    "PRESLIDING",
    "SENSOR",
    "SETTLING",
    "TORQUE",
    "TRAVEL",
    "Columns",
    "DirectionLaw",
    "Effect",
    "Form",
    "Parameter",
    "Part",
    "Scene",
    "at_either_end",
    "between_ends",
    "by_strength",
    "direction_laws",
    "geometric",
    "inside",
    "law_of",
    "odd_spring",
    "settled",
    "settling_limits",
    "settling_start",
    "times",
    "unlike",
]

Floats = NDArray[np.float64]
INPUT, TORQUE, SENSOR = "input", "torque", "sensor"
ELAPSED, TRAVEL = "elapsed", "travel"
CLOCKS: Mapping[str, str] = {ELAPSED: "time", TRAVEL: "travel"}
"""What only grows in a recording, as :class:`~hystbench.diagnosis.recording.signals.Signals` calls it, in words."""
AT_BORDER = 0.04
"""Part of the way between a shape's limits from where it counts as having run to one."""
LOW, HIGH, BOTH, NOT = (True, False), (False, True), (True, True), (False, False)
"""Where a shape's limits border on another effect."""


@dataclass(frozen=True)
class Parameter:
    """A parameter of an effect: unit, bounds and meaning."""

    name: str
    unit: str
    lower: float
    upper: float
    meaning: str


class Scene(Protocol):
    """What an effect may look at."""

    signals: Signals

    @property
    def torque(self) -> Floats:
        """The simulator's output, N·m, shape (n,), with the effects that act before this one."""
        ...

    @property
    def spring(self) -> Floats:
        """The elastic part of the simulator's output, as far as it can be told apart, N·m, shape (n,)."""
        ...

    @property
    def friction(self) -> Floats:
        """The part that has memory, N·m, shape (n,)."""
        ...

    @property
    def strength(self) -> Floats:
        """Change of that part for a relative change of its strength by one at the same stiffness, N·m, shape (n,)."""
        ...

    def stronger(self, gain: float) -> Floats:
        """Change for a relative ``gain`` of that strength, however large, N·m, shape (n,)."""
        ...

    def stronger_at(self, gain: Floats) -> Floats:
        """The same for a ``gain`` (n,) that may change on the way, N·m, shape (n,)."""
        ...

    def torque_change(self, x: Floats) -> Floats:
        """How the simulator's output would change if its input were ``x`` instead, N·m, shape (n,)."""
        ...

    def torque_at(self, x: Floats) -> Floats:
        """The torque so far if the input were ``x`` instead, N·m, shape (n,)."""
        ...

    def held_at(self, x: Floats) -> Floats:
        """The same without what follows speed and acceleration alone, N·m, shape (n,)."""
        ...

    def remembered(self, key: Hashable, make: Callable[[], Floats]) -> Floats:
        """What ``make`` gives, kept for the next call with ``key``."""
        ...

    def spring_change(self, x: Floats) -> Floats:
        """How the elastic part alone would change if the input were ``x`` instead, N·m, shape (n,)."""
        ...


Columns = Callable[[Scene, tuple[float, ...]], Floats]
ColumnsAbout = Callable[[Scene, tuple[float, ...], Floats], Floats]


@dataclass(frozen=True)
class Form:
    """One law of an effect.

    Attributes
    ----------
    name : str
        Tells it from the effect's other laws, by which its columns are remembered.
    coefficients : sequence of str
        Names of the linear parameters, one a column.
    lower, upper : sequence of float
        Their bounds; equal bounds fix a coefficient.
    shapes : sequence of str
        Names of the shape parameters.
    grid : sequence of tuple of float
        Starting values of the shapes; ``[()]`` if there are none.
    limits : sequence of (float, float)
        Bounds of each shape during refinement.
    columns : callable
        ``columns(scene, shape) -> (n, k)``.
    refines : tuple of str
        Names of simpler forms from whose fits this one starts, in place of a grid of its own.
    start : callable, optional
        ``start(shape, coefficients)`` of that fit gives this form's first shape; by default it is the same.
    overdone : bool
        Whether it takes away what the simulator has too much of; then it must bring more than a usual law.
    guessed : bool
        Whether it finds itself what others are told, as on what part of the simulator it acts or from what load on; then, too, it
        must bring more, and beside a model that was fitted to the joint, which takes much of what it would find, it is not asked.
    borders : sequence of (bool, bool)
        Whether at the lower and the upper limit of each shape begins another effect, of which the law is only an image
        there; nowhere if empty.
    about : callable, optional
        ``about(scene, shape, coefficients) -> (n, k)`` of a law that is not linear: columns that times the coefficients give what
        it adds; ``columns`` are these where the coefficients are small.
    elsewhere : Form, optional
        The law that is left of it on other motions, where what this recording began with is not there; its coefficients are the
        first of these. By default it is the same.
    equation : str
        What a simulator has to do, in its parameters' names and the words of :mod:`hystbench.diagnosis.notation`; the
        effect's own equation where it is empty.
    """

    name: str
    coefficients: Sequence[str]
    columns: Columns
    lower: Sequence[float]
    upper: Sequence[float]
    shapes: Sequence[str] = ()
    grid: Sequence[tuple[float, ...]] = ((),)
    limits: Sequence[tuple[float, float]] = ()
    refines: tuple[str, ...] = ()
    start: Callable[[tuple[float, ...], Floats], tuple[float, ...]] | None = None
    overdone: bool = False
    guessed: bool = False
    borders: Sequence[tuple[bool, bool]] = ()
    about: ColumnsAbout | None = None
    elsewhere: Form | None = None
    equation: str = ""

    @property
    def by_ratio(self) -> tuple[bool, ...]:
        """Which shapes are lengths, times or speeds, whose steps are ratios: those whose limits have one sign."""
        return tuple(low * high > 0.0 for low, high in self.limits)

    def is_at_a_border(self, shape: Sequence[float]) -> bool:
        """Whether a shape has run to where another effect begins."""
        return any(
            (bordered[0] and place < AT_BORDER) or (bordered[1] and place > 1.0 - AT_BORDER)
            for bordered, place in zip(self.borders, self.places(shape), strict=False)
        )

    def places(self, shape: Sequence[float]) -> list[float]:
        """Where each shape is between its limits, from 0 to 1, by ratios where steps are."""
        made = []
        for value, (low, high), ratio in zip(shape, self.limits, self.by_ratio, strict=True):
            made.append(float(np.log(value / low) / np.log(high / low)) if ratio else (value - low) / (high - low))
        return made


class Effect:
    """Base class of effect plug-ins (entry-point group ``hystbench.effects``)."""

    id: ClassVar[str]
    title: ClassVar[str]
    summary: ClassVar[str]
    equation: ClassVar[str]
    coordinate: ClassVar[str]
    """Where it shows first; one of CONTRACT's coordinates."""
    acts_on: ClassVar[str] = TORQUE
    """``"input"`` (before the simulator), ``"torque"`` (beside it) or ``"sensor"`` (after everything)."""
    parameters: ClassVar[tuple[Parameter, ...]]
    confused_with: ClassVar[tuple[str, ...]] = ()
    contains: ClassVar[tuple[str, ...]] = ()
    """Simpler effects that are special cases: where they do nearly as well, they are named instead."""
    image_of: ClassVar[tuple[str, ...]] = ()
    """Effects of which its laws may be images, and are where their shapes run to a border."""
    former: ClassVar[tuple[str, ...]] = ()
    """Names of laws that older files hold and that are written otherwise now."""

    clock: ClassVar[str] = ""
    """The one of ``CLOCKS`` with which it goes on, if its laws say how."""

    def is_degenerate(self, parameters: dict[str, float], scene: Scene) -> bool:
        """Whether the fitted parameters make this effect a simpler one, on the recording of ``scene``."""
        return False

    def imitates(self, signal: Floats, scene: Scene) -> Collection[str]:
        """Ids of other effects that would add no less what it adds, ``signal`` (n,), N·m.

        By itself, or with the effects and the simulator's errors beside it.
        """
        return ()

    def forms(self, scene: Scene) -> list[Form]:
        """The laws that this recording allows to fit (none, if it cannot show the effect at all)."""
        raise TypeError(f"{type(self).__name__} does not define forms")


def geometric(low: float, high: float, count: int) -> list[float]:
    """``count`` values from ``low`` to ``high`` in equal ratios; none if the range is empty."""
    return np.geomspace(low, high, count).tolist() if 0.0 < low <= high else []


def overdone(form: Form) -> Form:
    """A law of one sign the other way round: the simulator has what the joint has not."""
    return replace(
        form, name=f"{form.name}, overdone in the simulator", lower=[-v for v in form.upper],
        upper=[-v for v in form.lower], overdone=True,
    )  # fmt: skip


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
BARELY = 0.05
"""What is left at least of a stiffness that is lost."""


A_LITTLE = 0.05
"""Gain of friction's strength that counts as small."""


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


def at_either_end(scene: Scene) -> tuple[Floats, Floats]:
    """Weights of a parameter's values at the largest deflection and at as much on the other side, shapes (n,).

    Between them it changes linearly, so that it has one sign wherever its values at the ends have.
    """
    share = 0.5 * (1.0 + scene.signals.smooth_x / scene.signals.stroke)
    return share, 1.0 - share


def between_ends(scene: Scene, upper: str, lower: str) -> str:
    """The equation of such a parameter, from the names of its values at the ends."""
    size = f"{scene.signals.stroke:.8g}"
    return f"((1 + x / {size}) * {upper} + (1 - x / {size}) * {lower}) / 2"


SETTLING = (
    Parameter("unsettled", "1", -0.4, 0.4, "q, part that is missing at the start"),
    Parameter("settling_time", "s", 0.0, np.inf, "τ, in which the rest comes"),
)
"""Parameters of what is not all there at the start; they are its shapes."""


def settled(scene: Scene, unsettled: float, settling_time: float) -> Floats:
    """Share that is there of what settles, shape (n,)."""
    return np.asarray(1.0 - unsettled * np.exp(-scene.signals.elapsed / settling_time))


def settling_limits(scene: Scene) -> list[tuple[float, float]]:
    """Limits of the shapes of what settles: what has not, to within a hundredth, when the recording ends is a drift."""
    s = scene.signals
    return [(SETTLING[0].lower, SETTLING[0].upper), (2.0 * s.interval, 0.25 * float(s.elapsed.max()))]


def settling_start(scene: Scene) -> tuple[float, float]:
    """Shapes from which what settles is refined."""
    return 0.1, 0.05 * float(scene.signals.elapsed.max())


PRESLIDING = (
    Parameter("presliding", "rad", 0.0, np.inf, "distance over which friction builds up after a turn (Dahl)"),
    Parameter("elastic_presliding", "rad", 0.0, np.inf, "elastic deflection before it slides (spring and slider)"),
    Parameter("transition_speed", "rad/s", 0.0, np.inf, "speed at which the regularised sign saturates"),
)
"""Parameters of the direction laws; a fit has the one of its law."""
