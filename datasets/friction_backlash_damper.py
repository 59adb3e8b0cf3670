"""A banded rotary friction device with backlash (20 kN class), driven by sines of three amplitudes.

Measured: displacement and force at 1024 Hz, nominally 0.5, 1.0 and 1.5 in at 0.25 to 2 Hz with the band tensioned to
36 lb, each with the force that the authors' LuGre model predicts (Coble, Cao, Downey, Ricles, "Physics-Informed Machine
Learning for Dry Friction and Backlash Modeling in Structural Control Systems", 2024); and, from a second repository, 1
in at 1 Hz at tensions of 20, 25 and 70 lb.

Arrays of the first repository: time (s), force (N), displacement (m), velocity (m/s). Files of the second: time (s),
displacement (in), force (kip), velocity (in/s).

Defects and their handling:

- Displacement and velocity in the first repository are 1.5 times those of the second for the same test: the nominal
  0.5 in are 0.0192 m there. Which of the two is the damper's own motion is not said. Both are given as published.
- While the band slides it sticks and slips some 50 times a second, by up to 4 kN.
- Positive and negative sliding forces differ (about +13.5 and -17 kN), and the nominal band tension does not tell the
  normal load: readings from 35 to 80 lb give nearly the same force.

How far a model can come. The three steady cycles of a test repeat their displacement to 0.2 % of its range (0.75 % at 1.5
in, 1 Hz), but not their force: :func:`scatter` finds 0.015 to 0.042 of its range between them, 0.18 to 0.40 of the
published LuGre model's error. A model that is a function of the motion cannot follow that; it is 5 to 14 % of the LuGre
model's squared error on the steady cycles. Share of the LuGre model's NRMSE on each test, at 1024 Hz after the first turn:

=====================  ======  =======  =====  =====================  ============================
test                   LuGre   scatter  stops  modified P.-I. (here)  stops fitted to that test
=====================  ======  =======  =====  =====================  ============================
0.5 in, 0.25 Hz        0.084   0.18     0.64   0.43                   0.59
0.5 in, 0.5 Hz         0.084   0.21     0.69   0.52                   0.63
0.5 in, 1 Hz           0.081   0.31     0.78   0.66                   0.69
0.5 in, 2 Hz           0.106   0.40     1.06   1.00                   0.64
1.5 in, 0.25 Hz        0.061   0.28     0.66   0.55                   0.48
1.5 in, 0.5 Hz         0.064   0.26     0.72   0.61                   0.40
1.5 in, 1 Hz           0.068   0.33     0.89   0.79                   0.64
=====================  ======  =======  =====  =====================  ============================

"Stops" are 25 stop elements of signed weight and an offset by least squares on the training tests; the last column is
the same fitted to the test itself, so the best that any such set can do. ``modified-prandtl-ishlinskii`` does better
because the loop is not symmetric. What is left beyond the scatter grows with the rate: the band's force falls with speed
and the moving mass shows, most at 0.5 in and 2 Hz, faster than any training test and with a vibration of 16 Hz; neither is
a function of position. Fitting gains that fall with speed and an inertia on top brings the modified Prandtl-Ishlinskii
model to 0.30, 0.39, 0.56, 0.92, 0.64, 0.68 and 0.68.
"""

from __future__ import annotations

import json
from typing import ClassVar

import numpy as np

from .base import Dataset, DatasetSource, Recording
from .recorded import sensor_noise, thinned, until_first_turn
from .store import require

__all__ = ["PUBLISHED_PREDICTION", "FrictionBacklashDamper", "scatter"]

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

TENSIONS = (20, 25, 70)
TENSION_FOLDER = "data/dataset-1/characterization datasets"
METRE_PER_INCH = 0.0254
NEWTON_PER_KIP = 4448.2216152605


class FrictionBacklashDamper(DatasetSource):
    """Growing, steady and fading sines at 36 lb: trained at 1.0 in, tested at 0.5 and 1.5 in."""

    id: ClassVar[str] = "friction-backlash-damper"
    title: ClassVar[str] = "banded rotary friction device with backlash"
    summary: ClassVar[str] = "recorded: 20 kN friction damper with backlash, 0.5 to 1.5 in at 0.25 to 2 Hz"
    kind: ClassVar[str] = "recorded"
    licence: ClassVar[str] = "CC-BY-SA-4.0"

    def recordings(self) -> dict[str, Recording]:
        """Every test in the catalogue at its full rate; those at 36 lb with the published prediction as a channel.

        Raises
        ------
        DatasetUnavailableError
            If the files are not on this machine.
        """
        files = require(self.id)
        found = {}
        for number, inches, frequency in (*TRAIN, *TEST):
            measured = np.load(files[f"{MEASURED}/test{number}.npy"], allow_pickle=False)
            predicted = np.load(files[f"{PREDICTED}/test{number}.npy"], allow_pickle=False)
            recording = Recording(
                _name(inches, frequency),
                measured[:, 0] - measured[0, 0],
                measured[:, 2],
                measured[:, 1],
                channels={"velocity_m_s": measured[:, 3], PUBLISHED_PREDICTION: predicted[:, 0].astype(float)},
                conditions=_conditions(inches, frequency, 36),
            )
            found[recording.name] = until_first_turn(recording, 0.05)
        for tension in TENSIONS:
            path = files[f"{TENSION_FOLDER}/1Hz{tension}lbtension.json"]
            time, x, force, velocity = np.array(json.loads(path.read_text(encoding="utf-8"))["data"])[:, :4].T
            recording = Recording(
                f"{_name(1.0, 1.0)}, {tension} lb",
                time - time[0],
                METRE_PER_INCH * x,
                NEWTON_PER_KIP * force,
                channels={"velocity_m_s": METRE_PER_INCH * velocity},
                conditions=_conditions(1.0, 1.0, tension),
            )
            found[recording.name] = until_first_turn(recording, 0.05)
        return found

    def load(self) -> Dataset:
        recordings = self.recordings()
        train, test = ([recordings[_name(*test[1:])] for test in tests] for tests in (TRAIN, TEST))
        x_sigma, y_sigma = sensor_noise([*train, *test])
        return Dataset(
            id=self.id,
            title=self.title,
            train=[thinned(r, round(_period(r) / SAMPLES_PER_CYCLE)) for r in train],
            test=[thinned(r, round(_period(r) / SAMPLES_PER_CYCLE)) for r in test],
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
                "Between the steady cycles of one test, whose displacements are the same, the force scatters by 0.18 to 0.40 "
                "of the published LuGre model's NRMSE: stick-slip that no function of the motion can follow.",
                f"Thinned to {SAMPLES_PER_CYCLE} samples a cycle without a filter: the stick-slip vibration is aliased and "
                "stays in the error.",
                "Whether the published model was identified from these tests too is not recorded with the files.",
                "Sensor noise is estimated from fourth differences of the recordings at 1024 Hz.",
            ),
        )


def scatter(recording: Recording) -> float:
    """Deviation of the force between a test's steady cycles, over its range after the warm-up: NRMSE of the best function of the phase.

    Cycles are steady that cover at least 97 % of the whole displacement. From K cycles the squared deviations from their
    mean are divided by K - 1, so that few cycles do not look more alike than they are.

    Parameters
    ----------
    recording : Recording
        At the full rate, with its frequency among its conditions.
    """
    period = _period(recording)
    cycles = range(recording.x.size // period)
    parts = [slice(k * period, (k + 1) * period) for k in cycles]
    steady = [part for part in parts if np.ptp(recording.x[part]) > 0.97 * np.ptp(recording.x)]
    force = np.array([recording.y[part] for part in steady])
    variance = np.sum((force - force.mean(axis=0)) ** 2) / ((len(steady) - 1) * period)
    return float(np.sqrt(variance) / np.ptp(recording.y[recording.warm_up :]))


def _period(recording: Recording) -> int:
    """Samples a cycle at the full rate."""
    return round(RATE / float(recording.conditions["frequency"].split()[0]))


def _name(inches: float, frequency: float) -> str:
    return f"{inches:g} in, {frequency:g} Hz"


def _conditions(inches: float, frequency: float, tension: float) -> dict[str, str]:
    return {"amplitude": f"{inches:g} in", "frequency": f"{frequency:g} Hz", "band tension": f"{tension:g} lb"}
