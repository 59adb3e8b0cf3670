"""What is told besides a verdict: what it rests on, what in the gap is of the sensors, and why something is not named."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from .emulator.emulation import Emulator
from .recording.noise import rms
from .recording.signals import Signals
from .verdict.choice import Choice

__all__ = ["remarks"]


def remarks(
    signals: Signals,
    emulator: Emulator,
    choice: Choice,
    not_named: Sequence[str],
    has_model: bool,
    fitted: bool,
    calm: bool,
) -> list[str]:
    """The notes of a diagnosis, in the order in which they are read.

    Parameters
    ----------
    signals : Signals
    emulator : Emulator
        What answers for the simulator.
    choice : Choice
    not_named : sequence of str
        See :func:`hystbench.diagnosis.reasons.reasons`.
    has_model, fitted : bool
        Whether the simulator itself was at hand, and whether it was fitted to the joint.
    calm : bool
        Whether moments at which something knocks were left out.
    """
    made = [*_of_the_simulator(signals, emulator, has_model, calm), *_of_the_sensors(signals, choice), *not_named]
    if fitted:
        made.append(
            "the confidence was calibrated on simulators that were not fitted to the joint: take it as a rank here"
        )
    return made


def _of_the_simulator(signals: Signals, emulator: Emulator, has_model: bool, calm: bool) -> Iterator[str]:
    """What was done to the recording and its simulator before anything was explained."""
    if calm:
        share = 100.0 * np.mean(signals.knocks)
        yield f"{share:.2g} % of the samples were left out, about moments at which something knocks"
    if not has_model:
        yield f"the simulator is emulated by {emulator.name}, error {100.0 * emulator.error:.2g} % of its output"
    if emulator.unknown > 0.0:
        yield (
            f"the simulator remembers a motion before the recording: the first {100.0 * emulator.unknown:.2g} % of the samples"
            " are not judged"
        )
    if signals.recorded is not None:
        noise = rms(signals.recorded - signals.x)
        yield (
            f"the simulator's output shows the noise of the recorded deflection ({noise:.2g}): what that makes of it was taken out"
            if signals.jitter
            else f"the simulator's output shows no noise of the deflection's sensor ({noise:.2g}): it is emulated along the smoothed"
            " deflection"
        )
    if not signals.timed:
        yield "no time was recorded, so nothing can be said of rates and of drifts"


def _of_the_sensors(signals: Signals, choice: Choice) -> Iterator[str]:
    """What makes up the gap and is of the sensors or of the sampling."""
    if choice.hum > 0.0:
        yield f"the gap hums at {choice.hum:.3g} Hz, or at a frequency that the sampling folds there: shield or filter it"
    if choice.spikes > 0.0:
        most = np.max(np.abs(signals.gap[signals.judged]))
        yield (
            f"{100.0 * choice.spikes:.2g} % of the samples stand out of the noise, by up to {most:.3g} {signals.unit}: look for"
            " lost samples, a loose contact or interference"
        )
    if choice.roughness > 0.0:
        yield (
            f"what passes for noise is {choice.roughness:.2g} times stronger while the joint moves: a ripple that changes with"
            " every sample, or a rattle; record slow strokes, or more densely"
        )
    if choice.torque_step > 0.0:
        yield f"the recorded torque comes in steps of {choice.torque_step:.3g} {signals.unit}: they are the gap; record it finer"
