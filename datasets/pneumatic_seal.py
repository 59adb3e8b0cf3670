"""Piston seals of a pneumatic actuator at 1 to 7 bar: friction that grows with the load on the seal.

Measured: a piston in a 25 mm bore driven to and fro over about 39 mm at 5 to 14 mm/s, with the chamber held at 1, 3, 5 or
7 bar by a regulator; laser displacement, pressure and load cell every 10 ms or so (E. Zillen, MSc thesis, TU Delft,
2021). Two seals: an O-ring and a lip seal, NAPN.

The published files have no header. Their columns are time (ms), three voltages (laser, pressure, load cell),
displacement (mm), pressure (bar) and force (N).

Defects and their handling:

- The load cell carries the pressure force, many times the friction, and with it the regulator's error: the pressure
  is about 0.1 bar (5 N) higher on the stroke that compresses. The output here is the friction alone, the force minus
  pressure times the piston's effective area. It is therefore smaller than half the width of the raw loop.
- The first 15 rows are the logger's and the regulator's start; they are dropped, as the author does.
- The logger paused now and then, up to 0.3 s within a stroke; the time stamps are kept.
- ``Circle_*`` in the repository are copies of ``O-ring_*`` and are not in the catalogue.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ..models.motion import directions
from .base import Dataset, DatasetSource, Recording
from .recorded import sensor_noise, thinned, until_first_turn
from .store import require

__all__ = ["PneumaticSeal", "effective_area"]

Floats = NDArray[np.float64]

FOLDER = "results_pneumatic-actuator/data/friction"
SEALS = ("NAPN", "O-ring")
PRESSURES = (1, 3, 5, 7)
SPLIT_SEAL = "NAPN"
TRAIN, TEST = (1, 5), (3, 7)
"""bar."""

START_UP_ROWS = 15
STRIDE = 5
MID_STROKE = (10.0, 25.0)
"""mm. Away from the ends friction has its full size on both strokes, so there the piston's area can be read off."""


class PneumaticSeal(DatasetSource):
    """NAPN seal, about ten strokes at each of four pressures: trained at 1 and 5 bar, tested at 3 and 7 bar."""

    id: ClassVar[str] = "pneumatic-seal"
    title: ClassVar[str] = "pneumatic piston seal, friction at 1 to 7 bar"
    summary: ClassVar[str] = "recorded: friction of a piston seal, 40 mm strokes at 1 to 7 bar; depends on the load"
    kind: ClassVar[str] = "recorded"
    licence: ClassVar[str] = "CC0-1.0"

    def recordings(self) -> dict[str, Recording]:
        """Every published test of both seals at its full rate; the friction is the output.

        Raises
        ------
        DatasetUnavailableError
            If the files are not on this machine.
        """
        files = require(self.id)
        found = {}
        for seal in SEALS:
            raw = {
                bar: np.loadtxt(files[f"{FOLDER}/{seal}_{bar}bar.csv"], unpack=True)[:, START_UP_ROWS:]
                for bar in PRESSURES
            }
            area = effective_area([raw[bar] for bar in TRAIN])
            for bar, columns in raw.items():
                name = f"{seal}, {bar} bar"
                found[name] = _recording(name, columns, area, {"seal": seal, "pressure": f"{bar} bar"})
        return found

    def load(self) -> Dataset:
        recordings = self.recordings()
        train, test = ([recordings[f"{SPLIT_SEAL}, {bar} bar"] for bar in bars] for bars in (TRAIN, TEST))
        x_sigma, y_sigma = sensor_noise([*train, *test])
        return Dataset(
            id=self.id,
            title=self.title,
            train=[thinned(recording, STRIDE) for recording in train],
            test=[thinned(recording, STRIDE) for recording in test],
            split=(
                "NAPN seal: trained at 1 and 5 bar, tested at 3 bar, between the trained pressures, and at 7 bar, beyond "
                "them."
            ),
            x_name="displacement",
            x_unit="mm",
            y_name="friction force",
            y_unit="N",
            source="E. Zillen, MSc thesis, TU Delft, 2021; EvaZillen/3D-printed-pneumatic-actuator",
            licence=self.licence,
            x_sigma=x_sigma,
            y_sigma=y_sigma,
            assumptions=(
                "Friction = force − pressure · effective area. The area is read off the training pressures: how the "
                "mid-stroke force, meant over both strokes, rises from 1 to 5 bar. Whatever of the friction is equal on "
                "both strokes goes into it.",
                "The models see the position, not the pressure: trained at 1 and 5 bar they predict about the friction of 3 "
                "bar and too little at 7 bar. That error is the load's, not the memory's.",
                "The NAPN seal was chosen because its friction depends on pressure most; the O-ring is among the recordings.",
                f"The first {START_UP_ROWS} rows are dropped, as the author does.",
                f"Thinned to every {STRIDE}th sample without a filter (about 50 ms, 0.3 to 0.7 mm). The logger's gaps of up to "
                "0.3 s stay in the time column.",
                "Sensor noise is estimated from fourth differences of the recordings at their full rate.",
            ),
        )


def effective_area(tests: Sequence[Floats]) -> float:
    """Effective piston area, N/bar, from two or more tests at different pressures: columns as published.

    Friction opposes the motion, so the mean of both strokes is free of it; the area is how that mean rises with
    pressure.
    """
    pressures: list[float] = []
    forces: list[float] = []
    for columns in tests:
        x, pressure, force = columns[4], columns[5], columns[6]
        middle = (x > MID_STROKE[0]) & (x < MID_STROKE[1])
        way = directions(x, dead_band=1.0)
        for levels, series in ((pressures, pressure), (forces, force)):
            levels.append(float(np.mean([np.median(series[middle & (way == side)]) for side in (1, -1)])))
    return float(np.polyfit(pressures, forces, 1)[0])


def _recording(name: str, columns: Floats, area: float, conditions: dict[str, str]) -> Recording:
    pressure, force = columns[5], columns[6]
    return until_first_turn(
        Recording(
            name,
            (columns[0] - columns[0][0]) / 1000.0,
            columns[4],
            force - area * pressure,
            channels={"pressure_bar": pressure, "force_n": force},
            conditions=conditions,
        ),
        0.5,
    )
