"""A magnetorheological damper on a press: sines of several amplitudes and rates at a coil current of 1 A.

The published files hold time (s), displacement (mm), velocity (mm/s) and force (N), after the authors' moving average
over a tenth of a cycle and without their mean. Force follows speed as well as displacement: no rate-independent model
can follow it exactly, and what is left is the dataset's lesson.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from .base import Dataset, DatasetSource, Recording
from .recorded import sensor_noise, thinned, until_first_turn
from .store import require

__all__ = ["MrDamper"]

FOLDER = "Cap7_ModeloMR/BoucWen Ajuste 1/Preprocesamiento-sinusoidales/Preprocesados"

# File stem, amplitude (mm), frequency (Hz), stride.
TRAIN = (("25mm0x1Hz", 25.0, 0.1, 20), ("25mm0x5Hz", 25.0, 0.5, 4), ("5mm3Hz", 5.0, 3.0, 4))
TEST = (("25mm0x25Hz", 25.0, 0.25, 8), ("10mm1Hz", 10.0, 1.0, 10), ("2mm5Hz", 2.0, 5.0, 1))


class MrDamper(DatasetSource):
    """Sines at 1 A; every condition is one recording."""

    id: ClassVar[str] = "mr-damper"
    title: ClassVar[str] = "magnetorheological damper at 1 A"
    summary: ClassVar[str] = (
        "recorded: force of a magnetorheological damper, 2 to 25 mm at 0.1 to 5 Hz; depends on rate"
    )
    kind: ClassVar[str] = "recorded"
    licence: ClassVar[str] = "MIT"

    def load(self) -> Dataset:
        files = require(self.id)
        parts: dict[str, list[Recording]] = {"train": [], "test": []}
        full = []
        for part, conditions in (("train", TRAIN), ("test", TEST)):
            for stem, amplitude, frequency, stride in conditions:
                columns = np.loadtxt(files[f"{FOLDER}/{stem}1A.txt"], unpack=True)
                recording = until_first_turn(
                    Recording(
                        f"{amplitude:g} mm, {frequency:g} Hz",
                        columns[0] - columns[0][0],
                        columns[1],
                        columns[3],
                        channels={"velocity_mm_s": columns[2]},
                        conditions={
                            "amplitude": f"{amplitude:g} mm",
                            "frequency": f"{frequency:g} Hz",
                            "current": "1 A",
                        },
                    ),
                    0.3,
                )
                full.append(recording)
                parts[part].append(thinned(recording, stride))
        x_sigma, y_sigma = sensor_noise(full)
        return Dataset(
            id=self.id,
            title=self.title,
            train=parts["train"],
            test=parts["test"],
            split="Trained on 25 mm at 0.1 and 0.5 Hz and 5 mm at 3 Hz, tested on 25 mm at 0.25 Hz, 10 mm at 1 Hz and 2 mm at 5 Hz.",
            x_name="displacement",
            x_unit="mm",
            y_name="force",
            y_unit="N",
            source="DanielMaurelE/vRTHS_AMBC_MRdamper (UTFSM, Chile; experiments by Maria Quiroz)",
            licence=self.licence,
            x_sigma=x_sigma,
            y_sigma=y_sigma,
            assumptions=(
                "The authors' moving average over a tenth of a cycle is in the data: the nominal 2 mm are 1.6 mm, and the "
                "clearance of the mounting cannot be seen.",
                "Ramps at start and stop are part of the recordings; scores begin at the first large turn.",
                "Thinned to about 100 samples a cycle (40 at 5 Hz); the moving average has already removed what that could alias.",
                "Sensor noise is estimated from fourth differences of the recordings at their full rate.",
            ),
        )
