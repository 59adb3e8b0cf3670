"""Cases of the diagnosis' development bank."""

from __future__ import annotations

import numpy as np

from hystbench.diagnosis.blind.cases import Case, bank
from hystbench.diagnosis.blind.plants import plant_of
from hystbench.diagnosis.diagnosis import diagnose
from hystbench.diagnosis.result import Diagnosis


def developed(seed: int, *plants: str) -> tuple[Case, Diagnosis]:
    """A case of the development bank (of the varied plant, if none is named) and what is said of it."""
    (case,) = [case for case in bank(plants or ("varied",), 1, 1000 * (seed // 1000)) if case.seed == seed]
    joint, time, x = plant_of(case, 45.0)
    made = joint.record(time, x, np.random.default_rng([case.seed, 3]))
    return case, diagnose(made.signals, exclude=case.excluded)
