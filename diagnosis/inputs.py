"""Reading recordings and simulators, and saying in one line what does not fit together."""

from __future__ import annotations

import os
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import models
from ..bench.arguments import time_argument
from ..datasets.base import Recording
from ..datasets.recording_files import Columns, read_columns, read_recording
from ..errors import InputError
from .recording.signals import Signals

__all__ = ["MINIMUM_SAMPLES", "outputs_of", "read_inputs", "signals_from"]

Floats = NDArray[np.float64]
BEYOND = 1e6
"""Ratio of recorded and simulated torque that is a mistake, not a gap."""
MINIMUM_SAMPLES = 100
MIRRORED, SAME_MOTION = 0.8, 0.5
"""Correlation below whose negative a sign is wrong, and below which two deflections are not of the same motion."""


def read_inputs(
    recordings: Sequence[str | os.PathLike[str]],
    simulators: Sequence[str | os.PathLike[str]],
    x: str | None = None,
    y: str | None = None,
    time: str | None = None,
) -> tuple[Signals, Any | None]:
    """Read recordings and what simulates them: one model file for all, or one table of outputs for each.

    A table needs its output only. Where it has times or a deflection as well, they must be the recording's.

    Raises
    ------
    InputError
        If a file is bad or the two do not fit together; one line.
    """
    if not recordings:
        raise InputError("no recording was given; name at least one file")
    if len(simulators) == 1 and Path(simulators[0]).suffix.lower() == ".json":
        model = models.load(simulators[0])
        real = [read_recording(file, x=x, y=y, time=time) for file in recordings]
        return signals_from(real, outputs_of(model, real), [str(file) for file in recordings]), model
    if len(simulators) != len(recordings):
        raise InputError(
            f"{len(recordings)} recordings but {len(simulators)} --sim files; give one table for each, in the same order, or one model file"
        )
    real, outputs = [], []
    for file, simulated in zip(recordings, simulators, strict=True):
        recording = read_recording(file, x=x, y=y, time=time)
        sim = read_columns(simulated, {"x": x, "y": y}, time, companion=True)
        _check_pair(str(file), recording, str(simulated), sim)
        real.append(recording)
        outputs.append(sim["y"])
    return signals_from(real, outputs, [str(file) for file in recordings]), None


def outputs_of(model: Any, recordings: Sequence[Recording]) -> list[Floats]:
    """A model's output for each recording, at its times where the model depends on them."""
    return [np.asarray(model.predict(r.x, **time_argument(model.predict, r.time))) for r in recordings]


def _check_pair(file: str, real: Recording, simulated: str, sim: Columns) -> None:
    if sim["y"].size != real.x.size:
        raise InputError(
            f"{simulated}: {sim['y'].size} rows where {file} has {real.x.size}; write the simulator's output at the recording's times"
        )
    _check_times(file, real, simulated, sim)
    if "x" in sim.roles:
        _check_motion(file, real.x, simulated, sim["x"])


def _check_times(file: str, real: Recording, simulated: str, sim: Columns) -> None:
    if sim.untimed or "untimed" in real.conditions:
        # Its rows are all that tells where a sample belongs.
        return
    step = float(np.median(np.diff(real.time)))
    off = np.flatnonzero(np.abs(sim.time - real.time) > 0.25 * step)
    if off.size:
        k = int(off[0])
        raise InputError(
            f"{simulated}: row {k + 1} is at {sim.time[k]:.6g} s where {file} is at {real.time[k]:.6g} s; "
            "write the simulator's output at the recording's times"
        )


def _check_motion(file: str, x: Floats, simulated: str, there: Floats) -> None:
    spread = float(np.std(there)), float(np.std(x))
    if min(spread) > 0.0:
        _check_units(
            simulated,
            file,
            "deflection",
            spread[0] / spread[1],
            {180.0 / np.pi: "deg", np.pi / 180.0: "rad", 1000.0: "mrad or mm"},
        )
        alike = float(np.corrcoef(there, x)[0, 1])
        if alike < -MIRRORED:
            raise InputError(
                f"{simulated}: its deflection is that of {file} with the other sign; turn one of them round"
            )
        if alike < SAME_MOTION:
            raise InputError(
                f"{simulated}: its deflection is not that of {file} (correlation {alike:.2f}); "
                "write the simulator's output along the recorded motion"
            )


def _check_units(simulated: str, file: str, what: str, ratio: float, factors: dict[float, str]) -> None:
    for factor, unit in factors.items():
        if abs(ratio / factor - 1.0) < 0.15:
            raise InputError(
                f"{simulated}: its {what} is {ratio:.4g} times that of {file}, as if it were in {unit}; convert it to the recording's unit"
            )


def signals_from(recordings: Sequence[Recording], outputs: Sequence[Floats], names: Sequence[str]) -> Signals:
    """Join recordings and simulated outputs.

    Raises
    ------
    InputError
        If a recording is too short, does not move, or its output or the gap cannot be judged.
    """
    for recording, output, name in zip(recordings, outputs, names, strict=True):
        judged = recording.x.size - recording.warm_up
        if judged < MINIMUM_SAMPLES:
            raise InputError(f"{name}: {judged} samples are too few to diagnose; record at least {MINIMUM_SAMPLES}")
        for label, values in (("deflection", recording.x), ("torque", recording.y), ("simulated torque", output)):
            bad = np.flatnonzero(~np.isfinite(values))
            if bad.size:
                raise InputError(f"{name}: {label} is {values[bad[0]]} in row {bad[0] + 1}; remove such rows")
            if np.ptp(values) == 0.0:
                raise InputError(f"{name}: the {label} is constant; nothing can be diagnosed from it")
        sizes = float(np.max(np.abs(recording.y))), float(np.max(np.abs(output)))
        if max(sizes) > BEYOND * min(sizes):
            raise InputError(
                f"{name}: the recorded torque reaches {sizes[0]:.4g}, the simulated one {sizes[1]:.4g}; "
                "no effect accounts for that; check columns, units and the model's range"
            )
        gap = recording.y - output
        scale = float(np.std(recording.y))
        if np.ptp(gap) <= 1e-12 * scale and np.max(np.abs(gap)) > 1e-9 * scale:
            raise InputError(
                f"{name}: the gap is exactly constant ({gap[0]:.6g}): real and simulated torque are copies of each other; check the files"
            )
        ratio = scale / float(np.std(output))
        for factor in (1000.0, 1e-3):
            if abs(ratio / factor - 1.0) < 0.3:
                raise InputError(
                    f"{name}: the recorded torque is {ratio:.4g} times the simulated one, as if one were in N·m and the other in mN·m; "
                    "convert them to one unit"
                )
        slope = float(np.cov(recording.y, output)[0, 1]) / float(np.var(output, ddof=1))
        if float(np.corrcoef(recording.y, output)[0, 1]) < -MIRRORED and abs(slope + 1.0) < 0.3:
            raise InputError(
                f"{name}: the recorded torque is {slope:.3g} times the simulated one, as if their signs were opposite; turn one of them round"
            )
    edges = np.cumsum([0, *(r.x.size for r in recordings)]).tolist()
    shared = set.intersection(*(set(r.channels) for r in recordings))
    return Signals(
        time=np.concatenate([r.time for r in recordings]),
        x=np.concatenate([r.x for r in recordings]),
        y_real=np.concatenate([r.y for r in recordings]),
        y_sim=np.concatenate(list(outputs)),
        runs=[slice(a, b) for a, b in pairwise(edges)],
        channels={
            name: np.concatenate([r.channels[name] for r in recordings])
            for name in recordings[0].channels
            if name in shared
        },
        timed=not any(r.conditions.get("untimed") for r in recordings),
        warm_up=np.concatenate([np.arange(r.x.size) < r.warm_up for r in recordings]),
    )
