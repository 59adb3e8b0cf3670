"""What to record next: the shortest motion that tells apart what this recording cannot."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..datasets.recording_files import DEFAULT_TIME, DEFAULT_X, write_recording
from .emulator.emulation import SimulatorScene
from .hypotheses.evidence import Evidence, Hypothesis, is_refitted, trusted
from .hypotheses.refinement import refine
from .names import MISCALIBRATION
from .recording.signals import Signals
from .result import Diagnosis
from .verdict.rivals import SAME_BY_EYE, is_weighed_rightly

__all__ = ["Limits", "candidate_motions", "design_next", "margins", "motion"]

Floats = NDArray[np.float64]
SETTLED = 4.6
"""Logarithm of the tempered odds (100 to 1) at which a pair counts as told apart."""
CLEARLY = 3.0
"""So many times more than two recordings together must bring for a pair not to be stated again is asked for where it can be had."""
LONGER = 0.1
"""By so much of a pair a longer motion must tell more."""
MOST_SAMPLES = 6000


@dataclass(frozen=True)
class Limits:
    """What the recorded motion kept: lowest and highest deflection, speed, acceleration, sampling interval."""

    low: float
    high: float
    speed: float
    acceleration: float
    interval: float


def limits_of(signals: Signals) -> Limits:
    """The recording's limits; noise must not pass for speed, so the highest hundredth is left out."""
    return Limits(
        float(signals.smooth_x.min()), float(signals.smooth_x.max()),
        float(np.quantile(np.abs(signals.speed), 0.99)), float(np.quantile(np.abs(signals.acceleration), 0.99)),
        signals.interval,
    )  # fmt: skip


def motion(moves: Sequence[tuple[float, float, float]], start: float, limits: Limits) -> tuple[Floats, Floats]:
    """Half-cosine moves between turning points, each followed by a hold.

    Parameters
    ----------
    moves : sequence of (target, pace, hold)
        Target in rad, pace as a share of the fastest allowed, hold in s.
    start : float
        rad.
    """
    at, parts = start, [np.array([start])]
    for target, pace, hold in moves:
        distance = abs(target - at)
        # A half cosine over T peaks at π/2 · d/T in speed and π²/2 · d/T² in acceleration.
        fastest = max(0.5 * np.pi * distance / limits.speed, np.pi * np.sqrt(0.5 * distance / limits.acceleration))
        count = max(int(np.ceil(fastest / pace / limits.interval)), 1)
        phase = np.arange(1, count + 1) / count
        parts.append(at + (target - at) * (0.5 - 0.5 * np.cos(np.pi * phase)))
        parts.append(np.full(round(hold / limits.interval), target))
        at = target
    x: Floats = np.concatenate(parts)
    time: Floats = limits.interval * np.arange(x.size, dtype=np.float64)
    return time, x


def candidate_motions(limits: Limits) -> Iterator[tuple[str, Floats, Floats]]:
    """(what it does, time, x) of designed motions, roughly from short to long."""
    middle = min(max(0.0, limits.low), limits.high)
    up, down = limits.high, limits.low

    def ladder(shares: Sequence[float], paces: Sequence[float], hold: float = 0.0) -> list[tuple[float, float, float]]:
        return [
            move
            for share in shares
            for pace in paces
            for move in ((middle + share * (up - middle), pace, hold), (middle + share * (down - middle), pace, hold))
        ]

    rates = ladder((1.0, 0.4), (1.0, 0.25))
    holds = ladder((1.0, 0.6), (0.9,), 2.0)
    many = ladder((1.0, 0.7, 0.45, 0.2), (1.0, 0.5, 0.2, 0.08))
    home = [(middle, 0.5, 0.0)]
    idle = [(middle, 0.5, 8.0)]
    first = ladder((1.0,), (0.6, 0.6))
    stands = [(place, 0.9, 2.0) for place in (up, middle, down, middle)]
    for told, moves in (
        ("two amplitudes at a high and a low rate", rates + home),
        ("fast moves with holds", holds + home),
        ("two rates and amplitudes, then holds", rates + holds + home),
        ("holds at both ends and in the middle", stands * 2),
        ("four amplitudes at four rates", many + home),
        ("holds at both ends and in the middle, many times", stands * 10),
        (
            "four amplitudes at four rates with holds, and the first cycles again after a pause",
            first + many + holds + idle + first + home,
        ),
        ("all that twice, with long pauses", first + many + holds + idle * 2 + many + idle * 2 + first + home),
    ):
        yield (told, *motion(moves, middle, limits))


def design_next(found: Diagnosis, target: Path) -> dict[str, Any] | None:
    """Write the shortest candidate motion that settles the ambiguous pairs best to ``target``.

    Returns CONTRACT's ``next_recording``; None if nothing is ambiguous or no motion within the limits settles a pair.
    """
    if not found.ambiguous:
        return None
    limits = limits_of(found.signals)
    best: tuple[float, str, Floats, Floats, list[list[str]]] | None = None
    for told, time, x in candidate_motions(limits):
        told_apart = margins(found, time, x)
        settled = [pair for pair, margin in zip(found.ambiguous, told_apart, strict=True) if margin > 0.0]
        worth = float(np.clip(told_apart, 0.0, 1.0).sum())
        if settled and (best is None or worth > best[0] + LONGER):
            best = worth, told, time, x, settled
        if worth == len(found.ambiguous):
            break
    if best is None:
        return None
    _, told, time, x, settled = best
    write_recording(target, {DEFAULT_TIME: time, DEFAULT_X: x})
    return {"why": f"{told}, {time[-1]:.0f} s within the recorded limits", "settles": settled, "file": target.name}


def margins(found: Diagnosis, time: Floats, x: Floats) -> list[float]:
    """How well the motion would tell each ambiguous pair apart, whichever of the two were the truth.

    At 0 it is as likely as not that the new recording and the old ones together leave the pair stated again; beyond 1 they
    clearly would not.
    """
    together = found.signals.x.size + x.size
    share, known = trusted(together) / together, found.evidence.scene.emulator
    y_sim = known.anew(x)
    if x.size > MOST_SAMPLES:
        # Every so-manieth sample tells as much of so long a motion.
        step = -(-x.size // MOST_SAMPLES)
        time, x, y_sim, share = time[::step], x[::step], y_sim[::step], share * step
    blank = Signals(time, x, y_sim, y_sim, [slice(0, x.size)], _as_recorded(found.signals, time))
    scene = SimulatorScene(blank, known.along(blank))
    # What the verdict leaves now will be as correlated then.
    usual = max(SETTLED / found.choice.tempered, SAME_BY_EYE * trusted(together))
    made = []
    for pair in found.ambiguous:
        # As much as the two recordings together must bring for the pair not to be stated again.
        enough = SETTLED if MISCALIBRATION in pair and is_weighed_rightly(pair) else usual
        orders = [(true, false) for true, false in (pair, pair[::-1]) if true != MISCALIBRATION]
        # Beside the first recording each sample of the new one counts as much as each of its own.
        brought = share * min(_brought(found, scene, true, false) for true, false in orders)
        made.append((brought / enough - 1.0) / CLEARLY)
    return made


def _as_recorded(signals: Signals, time: Floats) -> dict[str, Floats]:
    """What the channels would be at ``time`` (n,) if they went as they did in the first recording, shapes (n,)."""
    first = signals.runs[0]
    return {name: np.interp(time, signals.elapsed[first], values[first]) for name, values in signals.channels.items()}


def _brought(found: Diagnosis, scene: SimulatorScene, true: str, false: str) -> float:
    """Evidence that a motion, of which the simulator's ``scene`` is known, would bring for ``true`` over ``false``."""
    truth = _with(found, true)
    rival = None if false == MISCALIBRATION else _with(found, false)
    if truth is None or (rival is None and false != MISCALIBRATION):
        return -np.inf
    planned = scene.signals
    noise = found.noise_floor * np.random.default_rng(found.seed).standard_normal(planned.x.size)
    recorded = replace(planned, y_real=planned.y_sim + truth.signal_on(scene) + noise)
    evidence = Evidence(SimulatorScene(recorded, scene.emulator))
    own = refine(evidence, evidence.fit(truth.terms)).score
    if rival is None:
        return own - evidence.fit((), tuple(scale for scale in evidence.scales if is_refitted(scale))).score
    return own - refine(evidence, evidence.fit(rival.terms)).score


def _with(found: Diagnosis, name: str) -> Hypothesis | None:
    """The verdict's explanation if it has the effect, otherwise the best explanation by the effect instead."""
    if name in found.choice.hypothesis.names:
        return found.choice.hypothesis
    swaps = [
        h
        for h in found.choice.candidates
        if name in h.names and len(h.names) == max(len(found.choice.hypothesis.names), 1)
    ]
    return max(swaps, key=lambda h: h.score, default=None)
