"""A banded rotary friction device with backlash (20 kN class), driven by sines of three amplitudes.

The published arrays hold time (s), force (N), displacement (m) and velocity (m/s) at 1024 Hz; beside them the authors
publish the force that their LuGre model predicts, which is kept as a channel and scored on the same samples.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from .base import Dataset, DatasetSource, Recording
from .recorded import sensor_noise, thinned, until_first_turn
from .store import require

__all__ = ["PUBLISHED_PREDICTION", "FrictionBacklashDamper", "full_rate_recordings"]

MEASURED = "training reproduction/datasets/dataset-2/harmonic"
PREDICTED = "training reproduction/model predictions/dataset-2 standard/harmonic"
PUBLISHED_PREDICTION = "published_lugre_n"
"""Channel with the authors' own LuGre prediction, N."""

PUBLISHED_TITLE = "LuGre (Coble et al., published)"

# Test number, nominal amplitude (in), frequency (Hz).
TRAIN = ((6, 1.0, 0.25), (7, 1.0, 0.5), (8, 1.0, 1.0))
TEST = (
    (1, 0.5, 0.25), (2, 0.5, 0.5), (3, 0.5, 1.0), (4, 0.5, 2.0), (10, 1.5, 0.25), (11, 1.5, 0.5), (12, 1.5, 1.0),
)  # fmt: skip
SAMPLES_PER_CYCLE = 128
RATE = 1024


def full_rate_recordings() -> tuple[list[Recording], list[Recording]]:
    """Training and test recordings at 1024 Hz, with the published prediction as a channel.

    Raises
    ------
    DatasetUnavailableError
        If the files are not on this machine.
    """
    files = require(FrictionBacklashDamper.id)
    parts = []
    for tests in (TRAIN, TEST):
        recordings = []
        for number, inches, frequency in tests:
            measured = np.load(files[f"{MEASURED}/test{number}.npy"], allow_pickle=False)
            predicted = np.load(files[f"{PREDICTED}/test{number}.npy"], allow_pickle=False)
            recording = Recording(
                f"{inches:g} in, {frequency:g} Hz",
                measured[:, 0] - measured[0, 0],
                measured[:, 2],
                measured[:, 1],
                channels={"velocity_m_s": measured[:, 3], PUBLISHED_PREDICTION: predicted[:, 0].astype(float)},
                conditions={"amplitude": f"{inches:g} in", "frequency": f"{frequency:g} Hz", "band tension": "36 lb"},
            )
            recordings.append(until_first_turn(recording, 0.05))
        parts.append(recordings)
    return parts[0], parts[1]


class FrictionBacklashDamper(DatasetSource):
    """Growing and then steady sines at three amplitudes."""

    id: ClassVar[str] = "friction-backlash-damper"
    title: ClassVar[str] = "banded rotary friction device with backlash"
    summary: ClassVar[str] = "recorded: 20 kN friction damper with backlash, 0.5 to 1.5 in at 0.25 to 2 Hz"
    kind: ClassVar[str] = "recorded"
    licence: ClassVar[str] = "CC-BY-SA-4.0"

    def load(self) -> Dataset:
        train, test = full_rate_recordings()
        x_sigma, y_sigma = sensor_noise([*train, *test])
        strides = {
            r.name: round(RATE / SAMPLES_PER_CYCLE / float(r.conditions["frequency"].split()[0]))
            for r in (*train, *test)
        }
        return Dataset(
            id=self.id,
            title=self.title,
            train=[thinned(r, strides[r.name]) for r in train],
            test=[thinned(r, strides[r.name]) for r in test],
            split="Trained on the three 1.0 in tests, tested on the four 0.5 in and the three 1.5 in tests.",
            x_name="displacement",
            x_unit="m",
            y_name="force",
            y_unit="N",
            source=(
                "Coble, Cao, Downey, Ricles, 2024; "
                "ARTS-Laboratory/Paper-Physics-Informed-Machine-Learning-for-Dry-Friction-and-Backlash"
            ),
            licence=self.licence,
            x_sigma=x_sigma,
            y_sigma=y_sigma,
            references={PUBLISHED_TITLE: PUBLISHED_PREDICTION},
            assumptions=(
                "Displacement and velocity in these files are 1.5 times those of the authors' other repository (nominal "
                "0.5 in are 0.0192 m here); they are used as they are.",
                f"Thinned to {SAMPLES_PER_CYCLE} samples a cycle without a filter: the stick-slip chatter, which no "
                "deterministic model follows, is aliased and stays in the error.",
                "Sensor noise is estimated from fourth differences of the recordings at 1024 Hz.",
            ),
        )
