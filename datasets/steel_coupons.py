"""Structural steel under cyclic strain: true stress against true strain, with cyclic hardening.

Measured: coupons in a testing machine (de Castro e Sousa, Suzuki, Lignos, Eng. Struct. 2020, the Voce-Chaboche inverse
problem; Hartloper, de Castro e Sousa, Lignos). Three tests are published: one of constant cycles of ±2 %, one of
variable amplitude up to 3 %, and one of growing amplitude on a coupon from an HEM 320 C section, at 10 Hz.

Defects and their handling:

- The first two were down-sampled by the authors to some 60 samples a cycle and have no time. Their samples are
  numbered in seconds, which says nothing of the rate of strain.
- The virgin curve has a yield plateau that no later cycle has; it lies within the warm-up.
- The variable-amplitude test ends with holds and partial unloading.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np
import pandas as pd

from .base import Dataset, DatasetSource, Recording
from .recorded import sensor_noise, until_first_turn
from .store import require

__all__ = ["SteelCoupons"]

CONSTANT, VARIABLE, GROWING = "constant ±2 %", "variable amplitude", "HEM 320 C, growing amplitude"
FILES = {
    CONSTANT: "examples/example_1.csv",
    VARIABLE: "examples/example_2.csv",
    GROWING: "Examples/HEM320C-LP8_Specimen_1_processed_data.csv",
}


class SteelCoupons(DatasetSource):
    """Trained on cycles of constant amplitude, tested on variable amplitude."""

    id: ClassVar[str] = "steel-coupons"
    title: ClassVar[str] = "structural steel coupons, cyclic strain"
    summary: ClassVar[str] = "recorded: true stress and strain of steel, constant and variable amplitude; hardens"
    kind: ClassVar[str] = "recorded"
    licence: ClassVar[str] = "MIT"
    extended: ClassVar[bool] = True

    def recordings(self) -> dict[str, Recording]:
        """Every published test, sample by sample.

        Raises
        ------
        DatasetUnavailableError
            If the files are not on this machine.
        """
        files = require(self.id)
        found = {}
        for name, path in FILES.items():
            table = pd.read_csv(files[path])
            strain, stress = (table[column].to_numpy(np.float64) for column in ("e_true", "Sigma_true"))
            timed = "Time[s]" in table
            time = table["Time[s]"].to_numpy(np.float64) if timed else np.arange(strain.size, dtype=np.float64)
            conditions = {"protocol": name, "time": "as published" if timed else "sample numbers"}
            found[name] = until_first_turn(Recording(name, time - time[0], strain, stress, conditions=conditions), 0.1)
        return found

    def load(self) -> Dataset:
        recordings = self.recordings()
        x_sigma, y_sigma = sensor_noise([recordings[GROWING]])
        return Dataset(
            id=self.id,
            title=self.title,
            train=[recordings[CONSTANT]],
            test=[recordings[VARIABLE]],
            split="Trained on cycles of ±2 % strain, tested on variable amplitude up to 3 %: memory and other amplitudes.",
            x_name="true strain",
            x_unit="1",
            y_name="true stress",
            y_unit="MPa",
            source=(
                "de Castro e Sousa, Suzuki, Lignos, Eng. Struct. 2020 (AlbanoCastroSousa/RESSPyLab); "
                "Hartloper, de Castro e Sousa, Lignos (ahartloper/rlmtp)"
            ),
            licence=self.licence,
            x_sigma=x_sigma,
            y_sigma=y_sigma,
            timed=False,
            assumptions=(
                "No time is published for the two tests of the split: samples are numbered in seconds. Filters that take "
                "rates from it work on a nominal clock.",
                "The authors down-sampled them to about 60 samples a cycle, so their noise cannot be told from their "
                "curvature; the stated noise is that of the third test, which has its full rate.",
                "Both are taken for one material; the files do not say so.",
                "The steel hardens over the first cycles; models without that memory of cycles keep the difference as "
                "error.",
                "Scores begin at the first large turn; the virgin curve with its yield plateau comes before it.",
            ),
        )
