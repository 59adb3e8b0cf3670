"""What the noise of a deflection sensor has to do with the output of a simulator: nothing, or it was fed with it.

The real joint did not move as its encoder says, to a count; a simulator that follows the counts stirs its friction and its
stiffness by them. That is no gap between the two, and no law of the deflection explains it. One that was given the wanted
motion, or has its own, knows nothing of the counts, and cannot be emulated by what they would stir.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ..recording.noise import rms
from ..recording.signals import Signals
from .emulation import GENERALISED, Emulator, emulate
from .generalised import EMULATED, predict_beside

__all__ = ["along_what_it_follows", "without_jitter"]

Floats = NDArray[np.float64]
FED = 0.5
"""Share of the roughness, as it is emulated, that the gap must have of a simulator which was fed with the noise."""
SURE = 3.0
"""Standard deviations of what the gap's own noise makes of that share, which it must be larger than."""
SEEN = 2e-5
"""Size of the noise over the deflection's reach below which it is the rounding of numbers, of which smoothing makes turns in holds."""
NOTICED = 0.1
"""Size of what the noise makes, over the noise of the gap, from which it is taken out."""
NORMAL = 0.6745
"""Median size of normal noise over its standard deviation."""
STAYS = 0.3
"""Share of it that stays: counts are correlated, the more so the slower the joint, and smoothing bends what it smooths. On eight
joints with counted deflections it was 0.2 to 0.35."""
STRANGE = 0.1
"""Correlation of a simulator's roughness with that of the deflection's noise below which it was not fed with that: on 51 recordings
of simulators that were not it was 0.065 at most."""


def along_what_it_follows(signals: Signals) -> tuple[Signals, Emulator]:
    """A simulator of which only the output is known, along the recorded deflection or, where it follows that, along the smoothed one."""
    quiet = _smoothed(signals)
    if quiet is None or _is_stirred_by(signals.x - quiet.x, signals):
        return signals, emulate(signals, None)
    along = emulate(quiet, None)
    if along.error < EMULATED:
        return quiet, along
    # Smoothing rounds what a simulator may know to be sharp.
    as_recorded = emulate(signals, None)
    return (quiet, along) if along.error < as_recorded.error else (signals, as_recorded)


def _smoothed(signals: Signals) -> Signals | None:
    """The signals along the smoothed deflection; None where that differs by no more than the rounding of numbers."""
    quiet = replace(signals, x=signals.smooth_x, recorded=signals.x)
    return None if rms(quiet.x - signals.x) < SEEN * signals.reach else quiet


def _is_stirred_by(noise: Floats, signals: Signals) -> bool:
    """Whether the simulator's output is rough where the ``noise`` (n,) of the deflection is."""
    told, made = (_roughness(series, signals) for series in (noise, signals.y_sim))
    return abs(float(told @ made)) > STRANGE * float(np.linalg.norm(told) * np.linalg.norm(made))


def _roughness(series: Floats, signals: Signals) -> Floats:
    """Fourth differences of a series (n,), in which hardly anything smooth is left, run after run."""
    return np.concatenate([np.diff(series[run], 4) for run in signals.runs])


def without_jitter(signals: Signals, emulator: Emulator) -> tuple[Signals, Emulator]:
    """The simulator along the smoothed deflection, where the gap shows the noise of the recorded one; else all as it was."""
    quiet = _smoothed(signals)
    if quiet is None:
        return signals, emulator
    predict = emulator.predict
    if emulator.parameters["model"] == GENERALISED:
        predict = partial(predict_beside, emulator.parameters["parameters"], quiet)
    made = emulator.predict(signals.x) - predict(quiet.x)
    if rms(made[signals.judged]) < NOTICED * signals.noise_floor:
        return signals, emulator
    emulated, shown = (_roughness(series, signals) for series in (made, -signals.gap))
    # What differs only after a few turns is rough at so few samples that noise alone may look like any share of it.
    spread = float(np.median(np.abs(shown))) / NORMAL * float(np.sqrt(emulated @ emulated))
    if float(emulated @ shown) < max(FED * float(emulated @ emulated), SURE * spread):
        return signals, emulator
    quiet = replace(quiet, y_sim=signals.y_sim - made, jitter=STAYS * rms(made[signals.judged]))
    return quiet, replace(emulator, predict=predict)
