"""What the noise of a deflection sensor makes of the output of a simulator that was fed with it.

The real joint did not move as its encoder says, to a count; a simulator that follows the counts stirs its friction and its
stiffness by them. That is no gap between the two, and no law of the deflection explains it.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from ..recording.noise import rms
from ..recording.signals import Signals
from .emulation import GENERALISED, Emulator
from .generalised import predict_beside

__all__ = ["without_jitter"]

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


def without_jitter(signals: Signals, emulator: Emulator) -> tuple[Signals, Emulator]:
    """The simulator along the smoothed deflection, where the gap shows the noise of the recorded one; else all as it was."""
    quiet = replace(signals, x=signals.smooth_x, recorded=signals.x)
    if rms(quiet.x - signals.x) < SEEN * signals.reach:
        return signals, emulator
    predict = emulator.predict
    if emulator.parameters["model"] == GENERALISED:
        predict = partial(predict_beside, emulator.parameters["parameters"], quiet)
    made = emulator.predict(signals.x) - predict(quiet.x)
    if rms(made[signals.judged]) < NOTICED * signals.noise_floor:
        return signals, emulator
    emulated, shown = (
        np.concatenate([np.diff(series[run], 4) for run in signals.runs]) for series in (made, -signals.gap)
    )
    # What differs only after a few turns is rough at so few samples that noise alone may look like any share of it.
    spread = float(np.median(np.abs(shown))) / NORMAL * float(np.sqrt(emulated @ emulated))
    if float(emulated @ shown) < max(FED * float(emulated @ emulated), SURE * spread):
        return signals, emulator
    quiet = replace(quiet, y_sim=signals.y_sim - made, jitter=STAYS * rms(made[signals.judged]))
    return quiet, replace(emulator, predict=predict)
