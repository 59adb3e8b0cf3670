"""A magnetorheological damper on a testing machine: sines over amplitude, rate and coil current.

Measured: displacement and force of a damper driven with sines of 2 to 25 mm at 0.1 to 5 Hz and coil currents of 0, 0.5
and 1 A (D. Maurel E., thesis, UTFSM, Chile; tests by M. Quiroz).

The published text files hold time (s), displacement (mm), velocity (mm/s) and force (N) after the authors' own
preprocessing: a moving average over a tenth of a cycle on both channels, cut per current, mean removed. Force follows
speed as well as displacement: no rate-independent model can follow it exactly, and what is left is the dataset's lesson.

Defects and their handling:

- The moving average rounds every corner of the loop in proportion to the amplitude and cuts the amplitude: the nominal
  2 mm at 5 Hz are 1.6 mm. How quickly the force turns round in these files is partly the filter's doing.
- It hides a clearance of the mounting, which the one published raw file (:meth:`MrDamper.unfiltered`) shows as kinks
  after each turn.
- What fourth differences find in averaged data is the resolution of the digits rather than the sensors' noise.
- At 1 A the loops' areas at 0.1 and 0.25 Hz vary by up to 7 % from cycle to cycle, at 0 A they drift by 12 %, at 0.5 A
  all repeat to 1 %: the split uses 0.5 A.
"""

from __future__ import annotations

from itertools import product
from typing import ClassVar

import numpy as np

from .base import Dataset, DatasetSource, Recording
from .recorded import sensor_noise, thinned, until_first_turn
from .store import require

__all__ = ["MrDamper"]

FOLDER = "Cap7_ModeloMR/BoucWen Ajuste 1/Preprocesamiento-sinusoidales"
CURRENTS = (0.0, 0.5, 1.0)
SPLIT_CURRENT = 0.5
STRIDES = {(25, 0.1): 10, (25, 0.25): 4, (25, 0.5): 4, (10, 1): 10, (5, 3): 4, (2, 5): 1}
"""Amplitude (mm) and frequency (Hz) of the tests, and one in how many samples the benchmark takes."""

TRAIN = ((25, 0.1), (25, 0.5), (5, 3))
TEST = ((25, 0.25), (10, 1), (2, 5))

RAW_FILE = f"{FOLDER}/Datos_crudos/ME2mm5Hz.txt"
RAW_RATE = 200.0
RAW_HEADER_LINES = 7
MM_PER_UNIT, NEWTON_PER_UNIT = 10.0, 980.665
"""Of the raw file's channels, from the authors' sincronize.m."""


def _name(amplitude: float, frequency: float, current: float) -> str:
    return f"{amplitude:g} mm, {frequency:g} Hz, {current:g} A"


class MrDamper(DatasetSource):
    """Sines at 0.5 A; every condition is one recording."""

    id: ClassVar[str] = "mr-damper"
    title: ClassVar[str] = "magnetorheological damper at 0.5 A"
    summary: ClassVar[str] = (
        "recorded: force of a magnetorheological damper, 2 to 25 mm at 0.1 to 5 Hz; depends on rate"
    )
    kind: ClassVar[str] = "recorded"
    licence: ClassVar[str] = "MIT"

    def recordings(self) -> dict[str, Recording]:
        """Every published test, at all currents and at its full rate.

        Raises
        ------
        DatasetUnavailableError
            If the files are not on this machine.
        """
        files = require(self.id)
        found = {}
        for (amplitude, frequency), current in product(STRIDES, CURRENTS):
            stem = f"{amplitude:g}mm{frequency:g}Hz{current:g}A".replace("0.", "0x")
            time, x, velocity, force = np.loadtxt(files[f"{FOLDER}/Preprocesados/{stem}.txt"], unpack=True)
            name = _name(amplitude, frequency, current)
            recording = Recording(
                name,
                time - time[0],
                x,
                force,
                channels={"velocity_mm_s": velocity},
                conditions={
                    "amplitude": f"{amplitude:g} mm",
                    "frequency": f"{frequency:g} Hz",
                    "current": f"{current:g} A",
                },
            )
            found[name] = until_first_turn(recording, 0.3)
        return found

    def unfiltered(self) -> Recording:
        """The one published raw file: 2 mm, 5 Hz, five currents from 0 to 1 A one after another, mean not removed.

        Which part belongs to which current is not in the file.
        """
        lines = require(self.id)[RAW_FILE].read_text(encoding="latin-1").splitlines()[RAW_HEADER_LINES:]
        force, displacement = np.array(
            [[float(cell) for cell in line.split(",")[2:4]] for line in lines if line.strip()]
        ).T
        return Recording(
            "2 mm, 5 Hz, unfiltered",
            np.arange(force.size) / RAW_RATE,
            MM_PER_UNIT * displacement,
            NEWTON_PER_UNIT * force,
            conditions={"amplitude": "2 mm", "frequency": "5 Hz", "current": "0 to 1 A in five steps"},
        )

    def load(self) -> Dataset:
        recordings = self.recordings()
        full = {test: recordings[_name(*test, SPLIT_CURRENT)] for test in STRIDES}
        x_sigma, y_sigma = sensor_noise(list(full.values()))
        return Dataset(
            id=self.id,
            title=self.title,
            train=[thinned(full[test], STRIDES[test]) for test in TRAIN],
            test=[thinned(full[test], STRIDES[test]) for test in TEST],
            split=(
                "Trained on 25 mm at 0.1 and 0.5 Hz and 5 mm at 3 Hz, tested on 25 mm at 0.25 Hz, 10 mm at 1 Hz and 2 mm "
                "at 5 Hz: speeds within the trained ones, two amplitudes that were not trained."
            ),
            x_name="displacement",
            x_unit="mm",
            y_name="force",
            y_unit="N",
            source="DanielMaurelE/vRTHS_AMBC_MRdamper (UTFSM, Chile; experiments by Maria Quiroz)",
            licence=self.licence,
            x_sigma=x_sigma,
            y_sigma=y_sigma,
            assumptions=(
                "0.5 A was chosen because its loops repeat to 1 % from cycle to cycle; at 1 A those at 0.1 and 0.25 Hz vary "
                "by up to 7 %.",
                "Peak speeds in the training are nominally 16, 79 and 94 mm/s, in the test 39, 63 and 63 mm/s: the force "
                "grows with speed, which no rate-independent model can follow.",
                "The authors' moving average over a tenth of a cycle is in the data: the nominal 2 mm are 1.6 mm, corners "
                "are rounded in proportion to the amplitude, and the clearance of the mounting cannot be seen.",
                "Ramps at start and stop are part of the recordings; scores begin at the first large turn.",
                "Thinned to 40 to 200 samples a cycle; the moving average has already removed what that could alias.",
                "Sensor noise is estimated from fourth differences of the recordings at their full rate; after the moving "
                "average that is near the resolution of the published digits.",
            ),
        )
