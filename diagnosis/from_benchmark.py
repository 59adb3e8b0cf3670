"""What a benchmarked model lacks: the diagnosis of its error on a dataset's test recordings."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import Any

from ..datasets.base import Dataset, Recording
from ..errors import InputError
from . import registry
from .diagnosis import diagnose
from .effects.base import SENSOR
from .inputs import outputs_of, signals_from
from .names import GAIN, MISCALIBRATION, UNKNOWN
from .recording.signals import Signals
from .result import Diagnosis

__all__ = ["diagnose_as_is_or_fitted", "diagnose_fitted", "diagnose_model", "gap_signals"]

ENCODER_ERRORS = ("deflection_offset", "encoder_eccentricity")


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
    return diagnose_fitted(gap_signals(model, dataset), model, exclude, seed)


def diagnose_fitted(signals: Signals, model: Any, exclude: Collection[str] = (), seed: int = 0) -> Diagnosis:
    """Diagnose what a model lacks that was fitted to recordings of the same joint by the same sensors."""
    return diagnose(signals, model, {*_of_sensors(), *exclude}, seed, fitted=True)


def diagnose_as_is_or_fitted(
    signals: Signals, model: Any | None, exclude: Collection[str] = (), seed: int = 0
) -> Diagnosis:
    """Diagnose a simulator of which only its file tells whether it was fitted to recordings.

    It is taken as it is first: it may have been fitted to another simulator, and an effect that a few wrong parameters
    do not hide is found that way. Where nothing known explains the gap so, or only beside wrong parameters, as a factor on
    its torque beside other effects also is, a model that was fitted is judged as one: fewer effects may do.
    """
    found = diagnose(signals, model, exclude, seed)
    named = set(found.verdict)
    doubtful = UNKNOWN in named or (len(named) > 1 and not named.isdisjoint((MISCALIBRATION, GAIN)))
    if not doubtful or not getattr(model, "fitted_samples_", 0):
        return found
    try:
        again = diagnose_fitted(signals, model, exclude, seed)
    except InputError:
        # Nothing is left to be considered.
        return found
    if again.verdict in ([UNKNOWN], [MISCALIBRATION], []) or not (UNKNOWN in named or named.issuperset(again.verdict)):
        return found
    told = "the model was fitted to recordings: where its parameters would go beside each effect was taken into account"
    return replace(again, notes=[*again.notes, told])


def gap_signals(model: Any, dataset: Dataset) -> Signals:
    """The test recordings and the model's predictions of them; warm-ups make memory, but are not judged.

    Channels that hold published predictions are left out: they are no measurements.
    """
    recordings = [_measured(recording, set(dataset.references.values())) for recording in dataset.test]
    names = [f"{dataset.id}: {recording.name}" for recording in dataset.test]
    signals = signals_from(recordings, outputs_of(model, dataset.test), names)
    return replace(signals, unit=dataset.y_unit, timed=dataset.timed)


def _of_sensors() -> set[str]:
    """Errors of the sensors: they are in the recordings to which the model was fitted as well, so it does not lack them."""
    return {*ENCODER_ERRORS, *(name for name in registry.ids() if registry.get(name).acts_on == SENSOR)}


def _measured(recording: Recording, without: set[str]) -> Recording:
    channels = {name: values for name, values in recording.channels.items() if name not in without}
    return replace(recording, channels=channels)
