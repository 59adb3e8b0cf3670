"""Models that each do one thing wrong."""

import os
import time

import numpy as np

from .models import Duck

# Compilation and warm-up see short series; what goes wrong must go wrong in a cell.
SHORT = 500


class Raises(Duck):
    def predict(self, x, groups=None):
        if len(x) > SHORT:
            raise RuntimeError("no <b>idea</b>\nwhat to do")
        return super().predict(x, groups)


class ReturnsNan(Duck):
    def predict(self, x, groups=None):
        return np.full(len(x), np.nan)


class Hangs(Duck):
    def fit(self, x, y, groups=None):
        while len(x) > SHORT:
            try:
                time.sleep(0.05)
            except Exception:
                continue
        return super().fit(x, y, groups)


class Exits(Duck):
    def fit(self, x, y, groups=None):
        if len(x) > SHORT:
            os._exit(3)
        return super().fit(x, y, groups)


class Messy(Duck):
    """Prints, changes NumPy's error state, its global generator and the working directory, and spoils its inputs."""

    def fit(self, x, y, groups=None):
        print("printed by a model")
        super().fit(x, y, groups)
        np.seterr(all="raise")
        np.random.seed(1)  # noqa: NPY002
        os.chdir("/")
        x[:] = 0.0
        return self


class Incomplete:
    """A model without predict."""

    def fit(self, x, y, groups=None):
        return self
