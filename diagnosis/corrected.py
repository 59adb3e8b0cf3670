"""The corrected simulator: as a model file that ``hystbench predict`` runs, and as a formula for people."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.signal import savgol_coeffs

from .. import models
from ..bench.arguments import time_argument
from ..errors import InputError
from ..models.base import HysteresisModel, Run, parameter_array, parameter_number
from .emulator.emulation import GENERALISED, Emulator, SimulatorScene, emulate
from .emulator.generalised import Generalised, motion_of, predict_generalised, spring_of
from .emulator.kinds import KINDS
from .emulator.motion import Motion
from .hypotheses.evidence import Term, effect_columns, elsewhere, spans, those_behind
from .hypotheses.precision import told
from .hypotheses.refitting import fitted_again
from .names import MISCALIBRATION, UNKNOWN
from .notation import GENERAL, explained
from .recording.noise import rms
from .recording.signals import TOLD, Signals
from .result import Diagnosis

__all__ = ["CorrectedSimulator", "calibrated", "corrected_simulator", "formula"]

Floats = NDArray[np.float64]
ARRAYS = ("thresholds", "lengths", "elastic", "placed", "weights", "rates")
NUMBERS = ("reach", "fast")
ROUNDS, SETTLED = 20, 1e-4
"""Times at most that effects are told the torque that they leave, and its change, over its deviation, that is none."""
PLAIN, FEWEST = 2, 5
"""Samples of a plain difference, and the fewest of a local cubic that tells a speed from noise."""
BEHIND = "behind"
"""Says in a model file that an effect acts on the deflection that the effects on the input leave."""
CLEAR = 0.02
"""Noise of a plain difference, over the speed, that needs no smoothing."""
INELASTIC = {"reach": 1.0, "elastic": [0.0], "thresholds": [], "lengths": [], "weights": []}
"""Of a model file that does not tell the elastic part: all is friction."""


@dataclass(frozen=True)
class _CausalSignals(Signals):
    """Signals whose speed uses no later sample, as a real-time simulator needs it, but so many up to each one."""

    window: int = PLAIN

    @cached_property
    def interval(self) -> float:
        return float(self.time[1] - self.time[0]) if self.time.size > 1 else 1.0

    @cached_property
    def _motion(self) -> tuple[Floats, Floats, Floats]:
        if self.window == PLAIN:
            speed = np.diff(self.x, prepend=self.x[0]) / self.interval
            return self.x, speed, np.diff(speed, prepend=speed[0]) / self.interval
        before = np.concatenate([np.full(self.window - 1, self.x[0]), self.x])
        speed, acceleration = (
            np.convolve(before, savgol_coeffs(self.window, 3, order, self.interval, pos=self.window - 1), "valid")
            for order in (1, 2)
        )
        return self.x, speed, acceleration


class CorrectedSimulator(HysteresisModel):
    """A simulator with the effects that a diagnosis found added to it.

    ``fit`` identifies the built-in emulator alone, a Prandtl-Ishlinskii model with an elastic polynomial, Dahl bristles,
    position-dependent width and such further elements as it needs; ``hystbench diagnose`` adds effects.

    ``from_parameters`` takes ``interval`` (s between samples, because effects depend on time), ``base`` (``model``: a
    registered id or ``"generalised"``, its ``parameters``, and for a registered model ``split``: parameters of the built-in
    emulator, which tell its elastic part), ``effects`` (each ``effect``, ``form``, ``shape``, ``coefficients``, and ``behind``
    if it acts on the deflection that those on the input leave) and ``window`` (samples of the local cubic that gives speeds of a
    noisy deflection; 2, the default, for differences) and ``sizes`` (``reach``, ``stroke``, ``strongest`` of the recording on
    which the effects were found; by default those of what is predicted).
    """

    id: ClassVar[str] = "corrected-simulator"
    title: ClassVar[str] = "Corrected simulator"
    summary: ClassVar[str] = "a simulator or its emulator with the effects that a diagnosis found added"
    source: ClassVar[str] = "hystbench diagnose"
    rate_independent: ClassVar[bool] = False
    extended: ClassVar[bool] = True
    benchmarked: ClassVar[bool] = False

    def __init__(self, interval: float = 0.01) -> None:
        self.interval = interval

    def _identify(self, runs: Sequence[Run]) -> dict[str, Any]:
        edges = np.cumsum([0, *(run.x.size for run in runs)]).tolist()
        y = np.concatenate([run.y for run in runs])
        signals = Signals(
            time=np.concatenate([np.arange(run.x.size) * self.interval for run in runs]),
            x=np.concatenate([run.x for run in runs]),
            y_real=y,
            y_sim=y,
            runs=[slice(a, b) for a, b in pairwise(edges)],
            channels={},
        )
        base = {"model": GENERALISED, "parameters": Generalised(signals).parameters()}
        return {"interval": self.interval, "base": base, "effects": [], "window": _window(signals), "sizes": {}}

    @classmethod
    def _check_parameters(
        cls, interval: Any, base: Any, effects: Any, window: Any = PLAIN, sizes: Any = None
    ) -> dict[str, Any]:
        interval, window = parameter_number("interval", interval), parameter_number("window", window)
        if interval <= 0.0:
            raise InputError(f"parameter interval must be positive; it is {interval}")
        if window != PLAIN and not (window >= FEWEST and window % 2 == 1):
            raise InputError(f"parameter window must be {PLAIN} or an odd number from {FEWEST} on; it is {window:g}")
        if not isinstance(base, Mapping) or not isinstance(base.get("parameters"), Mapping):
            raise InputError("parameter base must hold model and parameters")
        if base.get("model") == GENERALISED:
            checked: dict[str, Any] = {"parameters": _checked_emulator(base["parameters"])}
        else:
            made = models.get(str(base.get("model"))).from_parameters(**base["parameters"])
            checked = {"parameters": {name: _plain(value) for name, value in made.parameters_.items()}}
            if base.get("split") is not None:
                checked["split"] = _checked_emulator(base["split"])
        if not isinstance(effects, Sequence) or isinstance(effects, str):
            raise InputError("parameter effects must be a list")
        kept = []
        for k, entry in enumerate(effects):
            if not isinstance(entry, Mapping) or set(entry) - {BEHIND} != {"effect", "form", "shape", "coefficients"}:
                raise InputError(f"parameter effects[{k}] must hold effect, form, shape and coefficients")
            behind = entry.get(BEHIND, False)
            if not isinstance(behind, bool):
                raise InputError(f"parameter effects[{k}]: {BEHIND} must be true or false; it is {behind!r}")
            kept.append({
                "effect": str(entry["effect"]), "form": str(entry["form"]),
                "shape": [parameter_number("shape", v) for v in entry["shape"]],
                "coefficients": [parameter_number("coefficients", v) for v in entry["coefficients"]],
                **_told_if(behind),
            })  # fmt: skip
        return {
            "interval": interval, "base": {"model": str(base["model"]), **checked}, "effects": kept, "window": int(window),
            "sizes": _checked_sizes(sizes or {}),
        }  # fmt: skip

    def _prepare(self) -> None:
        from . import registry

        base = self.parameters_["base"]
        if base["model"] == GENERALISED:
            inner = base["parameters"]
            self._split = inner
            self._base = lambda x: predict_generalised(inner, self._motion(x))
        else:
            model = models.get(base["model"]).from_parameters(**base["parameters"])
            interval = self.parameters_["interval"]
            self._split = base.get("split", INELASTIC)
            self._base = lambda x: np.asarray(
                model.predict(x, **time_argument(model.predict, interval * np.arange(x.size, dtype=np.float64)))
            )
        self._effects = [(registry.get(entry["effect"])(), entry) for entry in self.parameters_["effects"]]
        for effect, entry in self._effects:
            if entry["form"] in effect.former:
                raise InputError(
                    f"the law '{entry['form']}' of {effect.id} is written otherwise since this file was made: diagnose the recording again"
                )

    def _motion(self, x: Floats) -> Motion:
        """The motion with speed and acceleration from samples up to each one."""
        return motion_of(self._signals(x, x))

    def _signals(self, x: Floats, y: Floats) -> _CausalSignals:
        time = self.parameters_["interval"] * np.arange(x.size)
        return _CausalSignals(
            time, x, y, y, [slice(0, x.size)], {}, sizes=self.parameters_["sizes"], window=self.parameters_["window"]
        )

    def _predict_run(self, x: Floats) -> Floats:
        y = self._base(x)
        if not self._effects:
            return y
        made = y
        # What creeps in series does so under the torque that it leaves.
        for _ in range(1 + ROUNDS):
            before, made = made, self._with_effects(x, y, made)
            if np.max(np.abs(made - before)) <= SETTLED * np.std(made):
                break
        return made

    def _with_effects(self, x: Floats, y: Floats, felt: Floats) -> Floats:
        """The simulator's output ``y`` (n,) with the effects, where those that follow the joint's torque follow ``felt`` (n,)."""
        signals = replace(self._signals(x, y), y_real=felt)
        nothing = np.empty((x.size, 0))
        scene = SimulatorScene(
            signals, Emulator("", 0.0, self._base, self._base, nothing, nothing, nothing, {}, self._split)
        )
        terms, coefficients = [], []
        for effect, entry in self._effects:
            form = next((f for f in effect.forms(scene) if f.name == entry["form"]), None)
            # A form is absent only where it adds nothing (no torque yet that could saturate).
            if form is not None:
                terms.append(Term(effect, form, tuple(entry["shape"]), behind=entry.get(BEHIND, False)))
                coefficients += entry["coefficients"]
        guess = np.array(coefficients)
        columns = effect_columns(scene, terms, guess)
        return np.asarray(y + columns @ guess)


def _told_if(behind: bool) -> dict[str, bool]:
    return {BEHIND: True} if behind else {}


def _checked_sizes(given: Any) -> dict[str, float]:
    if not isinstance(given, Mapping) or (given and set(given) != set(TOLD)):
        raise InputError(f"parameter sizes must hold {', '.join(TOLD)}, or nothing")
    sizes = {name: parameter_number(name, value) for name, value in given.items()}
    if any(value <= 0.0 for value in sizes.values()):
        raise InputError(f"parameter sizes must be positive; they are {sizes}")
    return sizes


def _checked_emulator(given: Any) -> dict[str, Any]:
    """Parameters of the built-in emulator."""
    if not isinstance(given, Mapping):
        raise InputError("parameter base must hold parameters by name")
    missing = [name for name in (*ARRAYS, *NUMBERS) if name not in given]
    if missing:
        raise InputError(f"parameter base lacks {', '.join(missing)}")
    arrays = {name: parameter_array(name, given[name], (None,)).tolist() for name in ARRAYS}
    numbers = {name: parameter_number(name, given[name]) for name in NUMBERS}
    begun = given.get("begun", False)
    if not isinstance(begun, bool):
        raise InputError(f"parameter begun must be true or false; it is {begun!r}")
    return arrays | numbers | {"begun": begun, "further": _checked_further(given.get("further", {}))}


def _checked_further(given: Any) -> dict[str, Any]:
    """Further elements of the built-in emulator; files of earlier versions have none."""
    if not isinstance(given, Mapping):
        raise InputError("parameter further must hold elements by kind")
    checked = {}
    for kind, elements in given.items():
        if kind not in KINDS or not isinstance(elements, Mapping) or set(elements) != {"sizes", "weights"}:
            raise InputError(f"parameter further: {kind!r} must be one of {', '.join(KINDS)}, with sizes and weights")
        sizes = parameter_array("sizes", elements["sizes"], (None, KINDS[kind].width))
        positive = np.setdiff1d(np.arange(sizes.shape[1]), KINDS[kind].signed)
        if np.any(sizes[:, positive] < 0.0) or (0 in positive and np.any(sizes[:, 0] == 0.0)):
            raise InputError(
                f"parameter further: sizes of {kind!r} must not be negative, and the first of each positive"
            )
        for place, (low, high) in KINDS[kind].between.items():
            if np.any((sizes[:, place] <= low) | (sizes[:, place] >= high)):
                raise InputError(
                    f"parameter further: size {place + 1} of {kind!r} must be above {low:g} and below {high:g}"
                )
        weights = parameter_array("weights", elements["weights"], (sizes.shape[0],))
        checked[kind] = {"sizes": sizes.tolist(), "weights": weights.tolist()}
    return checked


def _plain(value: Any) -> Any:
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else value


def _named(found: Diagnosis) -> tuple[Term, ...]:
    """The verdict's effects."""
    return found.choice.hypothesis.terms if set(found.verdict) - {MISCALIBRATION, UNKNOWN} else ()


def calibrated(found: Diagnosis, model: Any | None) -> Emulator:
    """The simulator as the diagnosis knows it, with its own parameters where they should be beside the verdict's effects.

    A ``model`` of a registered kind stays such a model; a simulator that is not off stays as it is.
    """
    emulator = found.evidence.scene.emulator
    if not found.choice.miscalibrated or found.verdict in ([], [UNKNOWN]):
        return emulator
    # First-order changes of parameters are no parameters: one is identified from the output that they make.
    recalibration = found.evidence.recalibration(found.choice.hypothesis)
    signals = replace(found.signals, y_sim=found.signals.y_sim + recalibration)
    again = None if model is None else fitted_again(model, signals, signals.x, signals.y_sim)
    return emulate(signals, None if again is None else again[0])


def corrected_simulator(found: Diagnosis, emulator: Emulator) -> CorrectedSimulator:
    """The calibrated simulator (see :func:`calibrated`) with the verdict's effects.

    Effects that follow a measured channel are left out, because a model file sees the deflection alone, and then it is
    not calibrated beside them either; the formula has them.
    """
    entries = []
    terms, coefficients = elsewhere(_named(found), found.choice.hypothesis.coefficients)
    behind = those_behind(terms)
    for term, own in zip(terms, spans(terms), strict=True):
        if not _follows_a_channel(found, term):
            entries.append({
                "effect": term.effect.id, "form": term.form.name, "shape": list(term.shape),
                "coefficients": coefficients[own].tolist(), **_told_if(term in behind),
            })  # fmt: skip
    base = (emulator if len(entries) == len(terms) else found.evidence.scene.emulator).parameters
    signals = found.signals
    made = CorrectedSimulator.from_parameters(
        interval=signals.interval, base=base, effects=entries, window=_window(signals), sizes=signals.told_in
    )
    made.interval = signals.interval
    made.x_scale_ = float(np.max(np.abs(signals.x)))
    return made


def _window(signals: Signals) -> int:
    """Samples that tell a speed as far as the recorded deflection's noise asks for it: the most that its recordings have."""
    noise, samples = (max(of) for of in zip(*signals.smoothing, strict=True))
    is_quiet = np.sqrt(2.0) * noise / signals.interval < CLEAR * rms(signals.speed)
    return PLAIN if is_quiet else samples


def _follows_a_channel(found: Diagnosis, term: Term) -> bool:
    return any(channel in term.form.name for channel in found.signals.channels)


def formula(found: Diagnosis, emulator: Emulator) -> str:
    """What to change in the simulator to get the calibrated one with the verdict's effects; empty if there is nothing."""
    lines, equations = [], []
    if MISCALIBRATION in found.verdict:
        spring, friction = _factors(found, emulator)
        lines.append(
            f"calibrate the simulator's own parameters anew: by and large its elastic torque times {spring:.3g}, "
            f"what has memory times {friction:.3g}"
        )
    terms = _named(found)
    behind, before = those_behind(terms), " and ".join(term.effect.title for term in terms if term.tells_deflection)
    for term in terms:
        equation = term.form.equation or term.effect.equation
        where = f", by the deflection that {before} leaves" if term in behind else ""
        lines += [f"add {term.effect.title} ({term.form.name}){where}:", f"    {equation}"]
        equations.append(equation)
        described = {parameter.name: parameter for parameter in term.effect.parameters}
        between = found.parameter_intervals.get(term.effect.id, {})
        for name, value in found.choice.hypothesis.parameters(term.effect.id).items():
            # A plug-in's effect may describe less than the built-in ones do, and what it holds fixed has no interval.
            one = described.get(name)
            unit = f" {one.unit}" if one and one.unit != "1" else ""
            interval = f"   ({told(between[name])})" if name in between else ""
            lines.append(f"    {name} = {value:.6g}{unit}{interval}" + (f"   {one.meaning}" if one else ""))
        if _follows_a_channel(found, term):
            lines.append("    (not in corrected.json, which sees the deflection alone)")
    if equations:
        lines += ["", GENERAL, *explained(equations)]
    return "\n".join(lines)


def _factors(found: Diagnosis, emulator: Emulator) -> tuple[float, float]:
    """By how much the elastic part and the part with memory of the calibrated simulator exceed those of the given one."""
    given, x, motion = found.evidence.scene.emulator, found.signals.x, motion_of(found.signals)
    parts = []
    for split in (given.split, emulator.split):
        spring = spring_of(split, x)
        parts.append((spring, predict_generalised(split, motion) - spring))
    elastic, memory = (
        float(after @ before) / max(float(before @ before), 1e-300) for before, after in zip(*parts, strict=True)
    )
    return elastic, memory
