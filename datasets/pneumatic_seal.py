"""An O-ring seal of a pneumatic piston at 1 to 7 bar: friction that grows with the load on the seal.

The published files have no header. Their columns are time (ms), three voltages (laser, pressure, load cell),
displacement (mm), pressure (bar) and force (N). The force is pressure times piston area plus friction; the friction is
the output here, so that recordings at different pressures share one scale.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from .base import Dataset, DatasetSource, Recording
from .recorded import sensor_noise, thinned, until_first_turn
from .store import require

__all__ = ["PneumaticSeal"]

FOLDER = "results_pneumatic-actuator/data/friction"
START_UP_ROWS = 15
"""The author drops them: the logger's and the regulator's start."""

STRIDE = 4
MID_STROKE = (10.0, 25.0)
"""mm. Away from the ends friction does not depend on position, so there the piston's area can be read off."""

Floats = NDArray[np.float64]


class PneumaticSeal(DatasetSource):
    """About ten strokes at each of four pressures."""

    id: ClassVar[str] = "pneumatic-seal"
    title: ClassVar[str] = "pneumatic piston with an O-ring seal"
    summary: ClassVar[str] = "recorded: friction of an O-ring seal, 40 mm strokes at 1 to 7 bar; depends on the load"
    kind: ClassVar[str] = "recorded"
    licence: ClassVar[str] = "CC0-1.0"

    def load(self) -> Dataset:
        files = require(self.id)
        raw = {
            bar: np.loadtxt(files[f"{FOLDER}/O-ring_{bar}bar.csv"], unpack=True)[:, START_UP_ROWS:]
            for bar in (1, 3, 5, 7)
        }
        area = _effective_area(raw[3], raw[5])
        recordings = {bar: _recording(bar, columns, area) for bar, columns in raw.items()}
        x_sigma, y_sigma = sensor_noise(list(recordings.values()))
        return Dataset(
            id=self.id,
            title=self.title,
            train=[thinned(recordings[bar], STRIDE) for bar in (3, 5)],
            test=[thinned(recordings[bar], STRIDE) for bar in (1, 7)],
            split="Trained at 3 and 5 bar, tested at 1 and 7 bar: the load on the seal differs.",
            x_name="displacement",
            x_unit="mm",
            y_name="friction force",
            y_unit="N",
            source="E. Zillen, MSc thesis, TU Delft, 2021; EvaZillen/3D-printed-pneumatic-actuator",
            licence=self.licence,
            x_sigma=x_sigma,
            y_sigma=y_sigma,
            assumptions=(
                f"Friction = force − pressure · {area:.2f} N/bar; the factor is read off the training recordings "
                "(difference of the mean mid-stroke force between 5 and 3 bar).",
                f"The first {START_UP_ROWS} rows are dropped, as the author does.",
                f"Thinned to every {STRIDE}th sample (about 40 ms; a stroke takes some 5 s). The logger's gaps of up to "
                "0.3 s (one of 2.7 s at 3 bar) stay in the time column.",
                "Sensor noise is estimated from fourth differences of the recordings at their full rate.",
            ),
        )


def _effective_area(low: Floats, high: Floats) -> float:
    """Piston area, N/bar, from two recordings: columns as published."""
    levels = []
    for columns in (low, high):
        x, pressure, force = columns[4], columns[5], columns[6]
        middle = (x > MID_STROKE[0]) & (x < MID_STROKE[1])
        rising = np.gradient(x) > 0.0
        # Friction has opposite signs on the two strokes: the mean of their means is free of it.
        levels.append([np.mean([np.mean(v[middle & side]) for side in (rising, ~rising)]) for v in (pressure, force)])
    (p0, f0), (p1, f1) = levels
    return float((f1 - f0) / (p1 - p0))


def _recording(bar: int, columns: Floats, area: float) -> Recording:
    pressure, force = columns[5], columns[6]
    return until_first_turn(
        Recording(
            f"{bar} bar",
            (columns[0] - columns[0][0]) / 1000.0,
            columns[4],
            force - area * pressure,
            channels={"pressure_bar": pressure, "force_n": force},
            conditions={"pressure": f"{bar} bar", "seal": "O-ring"},
        ),
        0.5,
    )
