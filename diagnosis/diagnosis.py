"""The diagnosis of a sim-to-real gap: where it lies, what causes it, how far it shrinks."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from ..errors import InputError
from .attribution import locate
from .effects.base import Effect
from .emulator.emulation import SimulatorScene, emulate
from .emulator.jitter import along_what_it_follows, without_jitter
from .hypotheses.evidence import Evidence, Hypothesis, those_behind
from .hypotheses.heldout import HeldOut, closed_share, held_out
from .hypotheses.library import Library
from .hypotheses.refitting import refitted_beside
from .hypotheses.search import search
from .names import GAIN, MISCALIBRATION, UNKNOWN
from .reasons import reasons
from .recording.noise import rms, structured_power
from .recording.signals import Signals
from .remarks import remarks
from .result import Diagnosis, EffectReport
from .verdict.choice import Choice, choose

__all__ = ["NEAREST", "diagnose", "known_effects"]

Floats = NDArray[np.float64]
OF_TIME = ("time", "speed", "acceleration")
"""Coordinates that a recording without a clock does not have; nothing can be said of effects that show there."""
REPORTED = 5
"""Effects beyond the verdict that are reported with held-out figures."""
RIVAL = 0.05
"""An alternative at least this probable, relative to the verdict, is a stated ambiguity."""
MOST_PAIRS = 6
"""The likeliest alternatives are enough to choose the next recording."""
FEW = 0.005
"""Part of the recording that knocks must make up to be worth a second look."""
AS_MUCH = 0.03
"""Share of the gap's energy by which a simpler verdict may close less."""
NEAREST = "what comes nearest"
"""Name of the one step of a gap that is not explained."""
EXACT = 0.3
"""Structure left over, as a share of the noise, up to which an effect's law is adequate."""


def known_effects(exclude: Collection[str] = ()) -> list[Effect]:
    """Fresh instances of all registered effects but those excluded.

    Raises
    ------
    UnknownPluginError
        If an excluded id is not registered.
    """
    from . import registry

    for name in exclude:
        registry.get(name)
    return [registry.get(name)() for name in registry.ids() if name not in exclude]


def diagnose(
    signals: Signals, model: Any | None = None, exclude: Collection[str] = (), seed: int = 0, fitted: bool = False
) -> Diagnosis:
    """Diagnose the gap between a recording and its simulator.

    Parameters
    ----------
    signals : Signals
        Recordings and the simulator's outputs, see :func:`hystbench.diagnosis.inputs.read_inputs`.
    model : fitted model, optional
        The simulator itself, where it is at hand.
    exclude : collection of str
        Effects that are not to be considered.
    seed : int
        For the bootstrap intervals.
    fitted : bool
        Whether the simulator was fitted to recordings of the same joint. Then its parameters are off by whatever they
        took of an effect that it lacks: this is expected, not reported as a miscalibration beside effects.

    Raises
    ------
    InputError
        If every effect is excluded.
    """
    if not signals.timed:
        exclude = {*exclude, *(effect.id for effect in known_effects() if effect.coordinate in OF_TIME)}
    effects = known_effects(exclude)
    if not effects:
        raise InputError("every effect is excluded; leave at least one")
    # Several threads on problems as small as these wait for each other: two diagnoses at once take up to three times as long.
    with threadpool_limits(limits=1, user_api="blas"):
        return _diagnosed(signals, model, exclude, effects, seed, fitted)


def _diagnosed(
    signals: Signals, model: Any | None, exclude: Collection[str], effects: Sequence[Effect], seed: int, fitted: bool
) -> Diagnosis:
    signals, emulator = along_what_it_follows(signals) if model is None else (signals, emulate(signals, model))
    if emulator.warm_up is not None:
        # How it would answer another deflection there is not known.
        signals = replace(signals, warm_up=emulator.warm_up | ~signals.judged)
    rmse = rms(signals.gap[signals.judged])
    if fitted:
        emulator = refitted_beside(signals, model, emulator, effects)
    else:
        signals, emulator = without_jitter(signals, emulator)
    scene = SimulatorScene(signals, emulator)
    library, found, choice = _explain(Evidence(scene, fitted=fitted), effects)
    calm = False
    if not fitted and np.mean(signals.knocks) > FEW and (choice.verdict == [UNKNOWN] or len(_named(choice)) > 1):
        # What knocks may have asked for more than there is, or have hidden what there is.
        again = _explain(Evidence(scene, signals.judged & ~signals.knocks, fitted=fitted), effects)
        if _is_better(signals, again[2], choice, seed):
            library, found, choice = again
            calm = True
    evidence, floor = library.evidence, signals.noise_floor

    blank = next(h for h in found if not h.terms)
    recalibrated = held_out(evidence, evidence.fit((), (max(blank.by_scale, key=lambda s: blank.by_scale[s]),)), 0)
    _, closed_by_recalibration, _ = _closed_by(signals, recalibrated.recalibration, seed)
    reports = _effect_reports(evidence, found, choice, floor, seed)
    closed_in_all = _closed(signals, choice, seed)
    if MISCALIBRATION in choice.verdict:
        reports.append(_recalibration_report(signals, choice, floor, seed))
    not_named = reasons(choice, closed_in_all, reports)
    named = _named(choice)
    return Diagnosis(
        signals=signals,
        verdict=choice.verdict,
        confidence=choice.confidence,
        rmse=rmse,
        noise_floor=floor,
        closed_by_recalibration=closed_by_recalibration,
        closed_in_all=closed_in_all,
        places=locate(signals, _explained(choice, named), floor, seed),
        effects=sorted(reports, key=lambda r: (-r.probability, -r.closed)),
        ambiguous=_ambiguities(choice),
        emulator=emulator.name,
        emulator_error=emulator.error,
        choice=choice,
        library=library,
        waterfall=_waterfall(signals, choice, named),
        seed=seed,
        excluded=sorted(exclude),
        notes=remarks(signals, emulator, choice, not_named, model is not None, fitted, calm),
        reasons=not_named,
    )


def _explain(evidence: Evidence, effects: Sequence[Effect]) -> tuple[Library, list[Hypothesis], Choice]:
    library = Library(evidence, effects)
    found = search(library)
    library.close()
    return library, found, choose(evidence, found)


def _named(choice: Choice) -> list[str]:
    """The verdict's effects."""
    return [name for name in choice.verdict if name not in (MISCALIBRATION, UNKNOWN)]


def _closed(signals: Signals, choice: Choice, seed: int) -> float:
    return _closed_by(signals, choice.explained, seed)[1]


def _closed_by(signals: Signals, part: Floats, seed: int) -> tuple[float, float, list[float]]:
    """RMS of what ``part`` (n,) leaves of the gap, the share that it closes and its interval."""
    gap, rows = signals.gap, signals.judged
    return closed_share(gap[rows], (gap - part)[rows], signals.noise_floor, seed)


def _is_better(signals: Signals, calm: Choice, whole: Choice, seed: int) -> bool:
    """Whether a verdict without the knocks explains the gap, knocks included, by fewer effects or at all."""
    if not _named(calm):
        return False
    closed = _closed(signals, calm, seed)
    if whole.verdict == [UNKNOWN]:
        return closed >= 0.5
    fewer = set(_named(calm)) < set(_named(whole)) and _causes(calm) <= _causes(whole)
    return fewer and closed >= _closed(signals, whole, seed) - AS_MUCH


def _causes(choice: Choice) -> set[str]:
    """What a verdict blames. A simulator that is off is no fewer causes than an effect, but a gain may be that."""
    return {MISCALIBRATION if name == GAIN else name for name in choice.verdict}


def _explained(choice: Choice, named: Sequence[str]) -> dict[str, Floats]:
    """What the verdict's effects add, by the coordinate where each shows."""
    explained: dict[str, Floats] = {}
    for term in choice.hypothesis.terms:
        if term.effect.id in named:
            where = term.effect.coordinate
            explained[where] = explained.get(where, 0.0) + choice.hypothesis.part(term.effect.id)
    return explained


def _effect_reports(
    evidence: Evidence, found: Sequence[Hypothesis], choice: Choice, floor: float, seed: int
) -> list[EffectReport]:
    made = []
    marginal: dict[str, float] = {}
    for names, probability in choice.posterior.items():
        for name in names:
            marginal[name] = marginal.get(name, 0.0) + probability
    for name in choice.hypothesis.names:
        made.append(
            _report(
                evidence,
                choice.hypothesis,
                choice.held,
                name,
                _probability(choice, marginal.get(name, 0.0), name),
                floor,
                seed,
            )
        )
    alone = [h for h in found if len(h.terms) == 1 and not h.names <= choice.hypothesis.names]
    for hypothesis in alone[:REPORTED]:
        (name,) = hypothesis.names
        made.append(
            _report(
                evidence,
                hypothesis,
                held_out(evidence, hypothesis, 0),
                name,
                _probability(choice, marginal.get(name, 0.0), name),
                floor,
                seed,
            )
        )
    return made


def _probability(choice: Choice, among_known: float, name: str) -> float:
    """What is said of one effect: what is named is at least as probable as the verdict, the others as what it leaves at most."""
    return max(among_known, choice.confidence) if name in choice.verdict else min(among_known, 1.0 - choice.confidence)


def _report(
    evidence: Evidence, hypothesis: Hypothesis, held: HeldOut, name: str, probability: float, floor: float, seed: int
) -> EffectReport:
    signals = evidence.scene.signals
    rmse, closed, interval = _closed_by(signals, held.parts[name], seed)
    left = evidence.left_over(hypothesis)
    exact = np.sqrt(max(structured_power(left, signals.runs, signals.stride), 0.0)) <= EXACT * floor
    term = next(t for t in hypothesis.terms if t.effect.id == name)
    law = term.form.name
    if term in those_behind(hypothesis.terms):
        law = f"{law}, by the joint's own motion"
    return EffectReport(
        name, float(np.clip(probability, 0.0, 1.0)), rmse, closed, interval, "adequate" if exact else "form inexact",
        hypothesis.parameters(name), law, held.parts[name],
    )  # fmt: skip


def _recalibration_report(signals: Signals, choice: Choice, floor: float, seed: int) -> EffectReport:
    rmse, closed, interval = _closed_by(signals, choice.held.recalibration, seed)
    scale = choice.hypothesis.scale
    return EffectReport(
        MISCALIBRATION, choice.confidence, rmse, closed, interval, "adequate",
        {"relative_error_structure": scale[0], "relative_error_bulk": scale[1]}, "first order", choice.held.recalibration,
    )  # fmt: skip


def _ambiguities(choice: Choice) -> list[list[str]]:
    """Pairs of effects of which one could stand in for the other in the verdict."""
    if choice.verdict in ([], [UNKNOWN]):
        return []
    own = choice.hypothesis.names
    pairs: set[tuple[str, str]] = set()
    for names, odds in sorted(choice.rivals.items(), key=lambda item: -item[1]):
        out, into = own - names, names - own
        if odds >= RIVAL and len(out) == 1 and len(into) == 1 and len(pairs) < MOST_PAIRS:
            a, b = sorted((*out, *into))
            pairs.add((a, b))
    for name in choice.recalibration_rivals:
        a, b = sorted((name, MISCALIBRATION))
        pairs.add((a, b))
    return [list(pair) for pair in sorted(pairs)]


def _waterfall(signals: Signals, choice: Choice, named: Sequence[str]) -> list[tuple[str, float]]:
    rows = signals.judged
    left = signals.gap[rows]
    steps = [("the simulator as it is", rms(left))]
    if choice.verdict == [UNKNOWN]:
        # No step of it is believed, and some would be undone by others.
        nearest = choice.explained[rows]
        return [*steps, (NEAREST, rms(left - nearest))] if np.any(nearest) else steps
    parts = {name: choice.held.parts[name][rows] for name in named}
    if choice.miscalibrated:
        parts[MISCALIBRATION] = choice.held.recalibration[rows]
    while parts:
        name = min(parts, key=lambda n: rms(left - parts[n]))
        left = left - parts.pop(name)
        steps.append((name, rms(left)))
    return steps
