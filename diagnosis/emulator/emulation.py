"""The simulator as the diagnosis knows it: its output, how it answers to another input, and where its parameters lead.

With a saved model the answer to another input is the model's own. With only a table of outputs, an emulator is
identified from it (see :mod:`hystbench.diagnosis.emulator.generalised`); where that is not good enough, registered models compete with it.

The simulator's own parameters may be off by a few per cent. To first order that adds a combination of the emulator's
*tangent* columns, of two kinds: the fine structure of the loop (each element's torque and its change with the
element's threshold), in which even a well calibrated simulator differs from the joint, and the bulk (elastic curve,
loop width, scale of the deflection, rates), in which it differs only if it is badly calibrated.
"""

from __future__ import annotations

import functools
from collections import OrderedDict
from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import models
from ...bench.arguments import time_argument
from ...errors import InputError
from ..recording.signals import Signals
from .generalised import (
    Generalised,
    drag_of,
    motion_beside,
    motion_of,
    predict_anew,
    predict_beside,
    predict_generalised,
    relative_error,
    spring_of,
    strengthened,
)
from .giving_way import GivingWay, without_given_way
from .kinds import KINDS
from .tangent import tangent

__all__ = ["GENERALISED", "AskingScene", "Emulator", "SimulatorScene", "answers_of", "emulate"]

Floats = NDArray[np.float64]
# Registered models that compete with the built-in emulator, in seconds rather than minutes.
COMPETITORS = "prandtl-ishlinskii", "modified-prandtl-ishlinskii", "preisach", "dahl", "duhem"
GENERALISED = "generalised"
"""Name of the built-in emulator among what rebuilds one."""
RIVALLED = 0.002
"""Error, as a share of the output, from which they compete."""
REMEMBERED, PLACES, SIMULATORS = 48, 4, 8
"""Effects' columns, scenes of other deflections, and emulators that are kept at a time."""
SMALL, GAIN_STEP, GAINS = 0.05, 0.25, (-0.78, 2.5)
"""Relative gain of friction's strength that counts as small, steps of its logarithm at which the change is computed, and between
which gains."""
HARDLY_ANY = -0.95
"""The same at which there is hardly any left."""


@dataclass(frozen=True)
class Emulator:
    """How the simulator answers to another input.

    Attributes
    ----------
    name : str
        Which model emulates; ``"the simulator itself"`` where a model file was given.
    error : float
        RMS error over the standard deviation of the simulator's output; 0 for the simulator itself.
    structure, bulk : array, shape (n, m)
        Change of the output for a relative change of each parameter by one: fine structure, and bulk.
    parts : array, shape (n, m)
        The same for what is each one parameter of friction, damping, mass and the like, however many elements follow it.
    parameters : dict
        What rebuilds it: ``model`` (a registered id, or ``"generalised"``) and ``parameters``; of a registered model also
        ``split``.
    split : dict
        Parameters of the built-in emulator, which tell its elastic curve from what has memory.
    """

    name: str
    error: float
    predict: Callable[[Floats], Floats]
    """Output over the recordings' samples for another input there."""
    anew: Callable[[Floats], Floats]
    """Output over one new motion, from the virgin state."""
    structure: Floats
    bulk: Floats
    parts: Floats
    parameters: Mapping[str, Any]
    split: Mapping[str, Any]
    warm_up: NDArray[np.bool_] | None = None
    """Samples (n,), where runs begin, at which the simulator remembers a motion before, if there are any: they say nothing of it."""
    refitted: bool = False
    """Whether ``predict`` is of the simulator fitted again beside an effect on its input, not as it is."""
    along: Callable[[Signals], Emulator] = lambda signals: emulate(signals, None)
    """The same of other signals of the simulator, from the virgin state in each of their runs."""

    @property
    def unknown(self) -> float:
        """Share of the samples that are such a warm-up."""
        return 0.0 if self.warm_up is None else float(np.mean(self.warm_up))


class SimulatorScene:
    """What effects look at: the signals, the torque so far and the simulator's answer to another input.

    Without ``emulator`` one is identified as soon as an effect asks for what it knows; many do not.
    """

    def __init__(
        self,
        signals: Signals,
        emulator: Emulator | None = None,
        torque: Floats | None = None,
        base: Floats | None = None,
    ) -> None:
        self.signals = signals
        self._torque = signals.y_sim if torque is None else torque
        self._asked = False
        """Whether the torque was asked for since this was last looked at."""
        self._of_torque: set[Hashable] = set()
        self._remembered: OrderedDict[Hashable, tuple[Floats, bool]] = OrderedDict()
        self._moved: OrderedDict[Hashable, SimulatorScene] = OrderedDict()
        """Scenes of other deflections, by what tells these."""
        self._origin: SimulatorScene | None = None
        """The scene of the recorded deflection, where this one is of another."""
        self._lasting: dict[str, Any] = {
            name: given for name, given in (("emulator", emulator), ("base", base)) if given is not None
        }

    @property
    def torque(self) -> Floats:
        """The torque so far, N·m, shape (n,)."""
        self._asked = True
        return self._torque

    @property
    def emulator(self) -> Emulator:
        """How the simulator answers to another input."""
        return self._once("emulator", lambda: emulate(self.signals, None))

    @property
    def _base(self) -> Floats:
        """The emulated output for the recorded input, N·m, shape (n,)."""
        return self._once("base", lambda: self.emulator.predict(self.signals.x))

    def torque_change(self, x: Floats) -> Floats:
        """Change of the simulator's output if its input were ``x`` (n,), N·m."""
        return self.emulator.predict(x) - self._base

    def torque_at(self, x: Floats) -> Floats:
        """The torque so far if the input were ``x`` (n,), N·m."""
        return self.emulator.predict(x) if self.emulator.refitted else self.torque + self.torque_change(x)

    def held_at(self, x: Floats) -> Floats:
        """The torque so far without what follows speed and acceleration alone, if the input were ``x`` (n,), N·m.

        All of it, where no time was recorded.
        """
        if not self.signals.timed:
            return self.torque_at(x)
        emulator, motion = self.emulator, motion_beside(self.signals, x)
        if emulator.parameters.get("model") != GENERALISED or emulator.refitted:
            return self.torque_at(x) - drag_of(emulator.split, motion)
        return self.torque - self._base + predict_generalised(emulator.split, motion, dragging=False)

    @property
    def spring(self) -> Floats:
        """The elastic part of the simulator's output, N·m, shape (n,)."""
        return self._once("spring", lambda: spring_of(self.emulator.split, self.signals.x))

    def spring_change(self, x: Floats) -> Floats:
        """Change of the elastic part alone if the input were ``x`` (n,), N·m."""
        return spring_of(self.emulator.split, x) - self.spring

    @property
    def friction(self) -> Floats:
        """The part of the simulator's output that has memory, N·m, shape (n,)."""
        output = self.signals.y_sim
        if self._origin is not None:
            output = output + self._base - self._origin._base
        return output - self.spring

    @property
    def strength(self) -> Floats:
        """Change of that part for a relative change of its strength by one at the same stiffness, N·m, shape (n,)."""
        return self._once("strength", lambda: self._slope(self.emulator.split))

    def stronger_at(self, gain: Floats) -> Floats:
        """Change of the output for a relative ``gain`` (n,) of that strength, which may change on the way, N·m, shape (n,).

        What does not say how it gives way at a level that changes is where it would be with that strength throughout.
        """
        gain = np.maximum(gain, HARDLY_ANY)
        giving: GivingWay = self._once(
            "what gives way", lambda: GivingWay(self.emulator.split, motion_of(self.signals))
        )
        change, rest = giving.change(gain), self._rest
        if rest["further"] or np.any(rest["rates"]):
            change += gain * self._rest_about(gain)
        return change

    @property
    def _rest(self) -> Mapping[str, Any]:
        """The emulator without what gives way."""
        return self._once("the rest", lambda: without_given_way(self.emulator.split))

    def _rest_about(self, gain: Floats) -> Floats:
        """Change of that over a relative ``gain`` (n,) of its strength that it has throughout, N·m, shape (n,)."""
        at = np.clip(np.log1p(gain), *np.log1p(GAINS)) / GAIN_STEP
        below = np.floor(at).astype(np.intp)
        first, last = int(below.min()), int(below.max()) + 1
        nodes = np.array([self._rest_at(k) for k in range(first, last + 1)])
        samples = np.arange(below.size)
        share = at - below
        return (1.0 - share) * nodes[below - first, samples] + share * nodes[below - first + 1, samples]

    def _rest_at(self, k: int) -> Floats:
        """The same over a gain of ``k`` steps."""
        gain = float(np.expm1(k * GAIN_STEP))

        def change() -> Floats:
            return self._stronger(gain, self._rest) / gain if k else self._slope(self._rest)

        return self._once(f"strength of the rest, {k}", change)

    def stronger(self, gain: float) -> Floats:
        """Change of the output for a relative ``gain`` of that strength, however large, N·m, shape (n,)."""
        return self._stronger(gain, self.emulator.split)

    def _slope(self, part: Mapping[str, Any]) -> Floats:
        """Change of a ``part`` of the emulator over a small gain."""
        return (self._stronger(SMALL, part) - self._stronger(-SMALL, part)) / (2.0 * SMALL)

    def _stronger(self, gain: float, part: Mapping[str, Any]) -> Floats:
        """Change of a ``part`` of the emulator for a gain that it has throughout."""
        return strengthened(part, motion_of(self.signals), gain, self.signals.timed)

    def _once(self, name: str, make: Callable[[], Any]) -> Any:
        if name not in self._lasting:
            self._lasting[name] = make()
        return self._lasting[name]

    def remembered(self, key: Hashable, make: Callable[[], Floats]) -> Floats:
        """What ``make`` gives, kept for the next call with ``key`` unless many others come between."""
        if key in self._remembered:
            self._remembered.move_to_end(key)
        else:
            before, self._asked = self._asked, False
            self._remembered[key] = make(), self._asked
            self._asked = before
            if len(self._remembered) > REMEMBERED:
                self._remembered.popitem(last=False)
        made, asked = self._remembered[key]
        self._asked |= asked
        return made

    def columns_of(self, law: Hashable, shape: Hashable, make: Callable[[], Floats]) -> Floats:
        """The same for a law's columns, of which is noted whether the torque was asked for."""
        self._asked = False
        made = self.remembered((law, shape), make)
        if self._asked:
            self._of_torque.add(law)
        return made

    def is_of_torque(self, law: Hashable) -> bool:
        """Whether the columns of a law depend on the torque so far, as far as they were asked for."""
        return law in self._of_torque

    def with_torque(self, torque: Floats) -> SimulatorScene:
        """The same scene after effects that changed the torque."""
        scene = SimulatorScene(self.signals, torque=torque)
        scene._lasting, scene._of_torque, scene._origin = self._lasting, self._of_torque, self._origin
        return scene

    def asking(self) -> AskingScene:
        """The same scene, which notes what effects ask for and remembers their columns as this one does."""
        scene = AskingScene(self.signals, torque=self._torque)
        scene._lasting, scene._of_torque, scene._remembered = self._lasting, self._of_torque, self._remembered
        return scene

    def moved_to(self, key: Hashable, deflection: Callable[[], Floats]) -> SimulatorScene:
        """The scene of a joint that moves by ``deflection()`` (n,), rad, while its sensor says what was recorded; kept for ``key``."""
        if key not in self._moved:
            x, signals = deflection(), self.signals
            recorded = None if signals.recorded is None else signals.recorded + x - signals.x
            # Numbers in laws are told in the sizes of the recording.
            moved = replace(signals, x=x, recorded=recorded, sizes=signals.told_in)
            scene = SimulatorScene(moved, self.emulator, self._torque)
            scene._of_torque, scene._origin = self._of_torque, self
            self._moved[key] = scene
            if len(self._moved) > PLACES:
                self._moved.popitem(last=False)
        self._moved.move_to_end(key)
        return self._moved[key]


class AskingScene(SimulatorScene):
    """Notes the deflection at which an effect last asked for the simulator's torque."""

    asked: Floats | None = None

    def torque_change(self, x: Floats) -> Floats:
        self.asked = x
        return super().torque_change(x)

    def held_at(self, x: Floats) -> Floats:
        self.asked = x
        return super().held_at(x)


def emulate(signals: Signals, model: Any | None) -> Emulator:
    """Identify the emulator; ``model`` is the simulator itself where it is at hand.

    The last few are remembered: the same simulator is often asked about with other effects, or beside another recorded torque.
    """
    if model is None:
        told = signals.time, signals.x, signals.y_sim, signals.recorded
        ends = tuple((run.start, run.stop) for run in signals.runs)
        content = tuple(None if series is None else series.tobytes() for series in told)
        return _identified(_Simulated((*content, ends, signals.timed), signals))
    # A model at hand answers for its memory itself.
    split = Generalised(signals, anywhere=False).parameters()
    return _of_model(model, split, "the simulator itself", 0.0, signals)


@dataclass(frozen=True)
class _Simulated:
    """A simulator's output along a motion, the same where its ``content`` is."""

    content: Hashable
    signals: Signals = field(compare=False)


@functools.lru_cache(maxsize=SIMULATORS)
def _identified(simulated: _Simulated) -> Emulator:
    """The emulator of a simulator of which only the output is known."""
    signals = simulated.signals
    own = Generalised(signals)
    best = replace(_generalised(own.parameters(), own.error, signals), warm_up=None if own.known.all() else ~own.known)
    # Tables follow much that is a law.
    rivalled = own.error > RIVALLED or any(KINDS[name].table for name in own.further)
    for name in COMPETITORS if rivalled else ():
        try:
            rival = models.get(name)().fit(signals.x, signals.y_sim, signals.groups)
        except (InputError, np.linalg.LinAlgError, RuntimeError):
            # This model cannot describe such a simulator: the emulator so far stays.
            continue
        predict = _from_recorded_start(rival, signals)
        error = relative_error(predict(signals.x)[own.known], signals.y_sim[own.known])
        if error < best.error:
            tangents = best.structure, best.bulk, best.parts
            described = _of_model(rival, best.split, name, error, signals, tangents)
            best = replace(described, predict=predict, warm_up=best.warm_up)
    return best


def _generalised(parameters: Mapping[str, Any], error: float, signals: Signals) -> Emulator:
    """The built-in emulator with these parameters."""
    further = parameters["further"]
    return Emulator(
        "generalised Prandtl-Ishlinskii" + (f" with {', '.join(further)}" if further else ""),
        error,
        functools.partial(predict_beside, parameters, signals),
        functools.partial(predict_anew, parameters, signals.interval),
        *tangent(parameters, signals),
        {"model": GENERALISED, "parameters": parameters},
        parameters,
        along=functools.partial(_generalised, parameters, error),
    )


def _from_recorded_start(model: Any, signals: Signals) -> Callable[[Floats], Floats]:
    """The model's output along another input, to which each run moves from where it was recorded to begin.

    Friction that knows only of steps would not notice that a whole run is shifted.
    """

    def predict(x: Floats) -> Floats:
        courses = (np.concatenate([signals.x[run][:1], x[run]]) for run in signals.runs)
        return np.concatenate([np.asarray(model.predict(course))[1:] for course in courses])

    return predict


def answers_of(model: Any, signals: Signals) -> Callable[[Floats], Floats]:
    """A fitted model's output over the recordings' samples for any input there."""

    def predict(x: Floats) -> Floats:
        return np.asarray(model.predict(x, signals.groups, **time_argument(model.predict, signals.time)))

    return predict


def _of_model(
    model: Any, split: Mapping[str, Any], name: str, error: float, signals: Signals,
    tangents: tuple[Floats, Floats, Floats] | None = None,
) -> Emulator:  # fmt: skip
    """A registered model as the emulator, with the ``tangents`` of the built-in one where they are known already."""

    def anew(x: Floats) -> Floats:
        time = signals.interval * np.arange(x.size, dtype=np.float64)
        return np.asarray(model.predict(x, **time_argument(model.predict, time)))

    described = {"model": model.id, "parameters": dict(model.parameters_), "split": split}
    return Emulator(
        name, error, answers_of(model, signals), anew, *(tangents or tangent(split, signals)), described, split,
        along=functools.partial(_of_model, model, split, name, error),
    )  # fmt: skip
