"""How far an identified effect closes the gap on another kind of motion, said before that motion is recorded."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..emulator.emulation import SimulatorScene
from ..hypotheses.heldout import closed_share
from ..names import MISCALIBRATION, UNKNOWN
from ..recording.signals import Floats, Signals
from ..result import Diagnosis

__all__ = ["found_closed", "named_effects", "predicted_closed", "signal_on"]


def named_effects(found: Diagnosis) -> list[str]:
    """The verdict's effects."""
    return [name for name in found.verdict if name not in (MISCALIBRATION, UNKNOWN)]


def signal_on(found: Diagnosis, time: Floats, x: Floats, y_sim: Floats) -> Floats:
    """What the identified effects add to the simulator's output ``y_sim`` along another motion, N·m, shape (n,).

    The simulator answers as it was identified on the first recording, sampled alike.
    """
    target = Signals(time, x, y_sim, y_sim, [slice(0, x.size)], {}, sizes=found.signals.told_in)
    emulator = found.evidence.scene.emulator
    return found.choice.hypothesis.signal_on(SimulatorScene(target, replace(emulator, predict=emulator.anew)))


def predicted_closed(found: Diagnosis, signal: Floats) -> float:
    """Share of the gap's energy that the effects will close where they add ``signal``.

    What they left over on the first recording, beyond the noise, is expected to be there again.
    """
    left = found.signals.gap - found.choice.held.signal
    left_over = max(float(np.mean(np.square(left))) - found.noise_floor**2, 0.0)
    power = float(np.mean(np.square(signal)))
    return power / max(power + left_over, 1e-300)


def found_closed(recorded: Signals, signal: Floats, seed: int = 0) -> float:
    """Share of the recorded gap's energy beyond the noise that ``signal`` closes."""
    return closed_share(recorded.gap, recorded.gap - signal, recorded.noise_floor, seed)[1]
