"""What a benchmarked model lacks: the diagnosis of its error on a dataset's test recordings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from ..datasets.base import Dataset, Recording
from . import registry
from .diagnosis import Diagnosis, diagnose
from .effects.base import SENSOR
from .inputs import outputs_of, signals_from
from .signals import Signals

__all__ = ["diagnose_model", "gap_signals"]

ENCODER_ERRORS = ("deflection_offset", "encoder_eccentricity")
OF_TIME = ("time", "speed", "acceleration")
"""Coordinates that a recording without a clock does not have."""


def diagnose_model(model: Any, dataset: Dataset, *, seed: int = 0, exclude: Sequence[str] = ()) -> Diagnosis:
    """Diagnose what a model lacks that was fitted to a dataset's training recordings.

    The fitted model is the simulator and the test recordings are the real joint; compare the verdict with
    :func:`hystbench.diagnosis.known_causes.known_cause`.

    Parameters
    ----------
    model : fitted model
    dataset : Dataset
    seed : int
        For the bootstrap intervals.
    exclude : sequence of str
        Effects that are not to be considered.

    Raises
    ------
    InputError
        If the test recordings cannot be diagnosed, for instance because they are too short.
    """
    left_out = {*_of_sensors(), *exclude, *(() if dataset.timed else _of_time())}
    return diagnose(gap_signals(model, dataset), model, left_out, seed, fitted=True)


def gap_signals(model: Any, dataset: Dataset) -> Signals:
    """The test recordings and the model's predictions of them, from the end of each warm-up.

    Channels that hold published predictions are left out: they are no measurements.
    """
    outputs = outputs_of(model, dataset.test)
    scored = [_scored(recording, set(dataset.references.values())) for recording in dataset.test]
    cut = [output[recording.warm_up :] for output, recording in zip(outputs, dataset.test, strict=True)]
    signals = signals_from(scored, cut, [f"{dataset.id}: {recording.name}" for recording in dataset.test])
    return replace(signals, unit=dataset.y_unit)


def _of_sensors() -> set[str]:
    """Errors of the sensors: they are in the recordings to which the model was fitted as well, so it does not lack them."""
    return {*ENCODER_ERRORS, *(name for name in registry.ids() if registry.get(name).acts_on == SENSOR)}


def _of_time() -> set[str]:
    """Effects that show over time or rates: where no clock was recorded nothing can be said of them."""
    return {name for name in registry.ids() if registry.get(name).coordinate in OF_TIME}


def _scored(recording: Recording, without: set[str]) -> Recording:
    """What comes after the warm-up, where the model's memory no longer depends on an unrecorded history."""
    start = recording.warm_up
    return replace(
        recording,
        time=recording.time[start:],
        x=recording.x[start:],
        y=recording.y[start:],
        warm_up=0,
        channels={name: values[start:] for name, values in recording.channels.items() if name not in without},
    )
