"""What an effect is: what it says, and which signals it would leave in a gap.

An effect offers one or more *forms* of its law. A form gives, for values of its shape parameters, columns that enter
the gap linearly. So a fit is a small bounded least-squares problem inside a search over shapes (variable projection:
Golub & Pereyra, Inverse Problems 19, 2003).
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from ..recording.signals import Signals

__all__ = [
    "BOTH",
    "CLOCKS",
    "ELAPSED",
    "HIGH",
    "INPUT",
    "LOW",
    "NOT",
    "SENSOR",
    "TORQUE",
    "TRAVEL",
    "Columns",
    "ColumnsAbout",
    "Effect",
    "Form",
    "Outsider",
    "Parameter",
    "Scene",
    "at_either_end",
    "between_ends",
    "geometric",
    "overdone",
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


@dataclass(frozen=True)
class Outsider:
    """A law of what is no effect here, of which one of an effect's laws may be the image.

    Attributes
    ----------
    what : str
        In words, for the report.
    form : Form
        The law; it is fitted in place of the effect's.
    starts : sequence of tuple
        Values of its shape parameters from which these are moved.
    alike : bool
        Whether both look the same where they explain as much, so that it need not do better to be the likelier.
    """

    what: str
    form: Form
    starts: Sequence[tuple[float, ...]]
    alike: bool = False


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

    def outsider(self, form: Form, shape: tuple[float, ...], scene: Scene) -> Outsider | None:
        """What is no effect here, but of which its law ``form`` with this ``shape`` may be the image; None if there is no such."""
        return None

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
