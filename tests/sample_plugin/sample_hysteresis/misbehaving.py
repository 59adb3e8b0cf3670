"""Models that each do one thing wrong."""

import os
import time
from typing import ClassVar

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
        os.write(1, b"written by a model\n")
        super().fit(x, y, groups)
        np.seterr(all="raise")
        np.random.seed(1)  # noqa: NPY002
        os.chdir("/")
        x[:] = 0.0
        return self


class Leaks(Duck):
    """Takes memory without end and never gives it back."""

    hoard: ClassVar[list] = []

    def fit(self, x, y, groups=None):
        while len(x) > SHORT:
            self.hoard.append(np.ones(500_000))
        return super().fit(x, y, groups)


class Forks(Duck):
    """Leaves a process that sleeps behind, and one that goes on as if it were the first."""

    def fit(self, x, y, groups=None):
        if len(x) > SHORT:
            if os.fork() == 0:
                time.sleep(600)
            os.fork()
        return super().fit(x, y, groups)


class Interrupts(Duck):
    def fit(self, x, y, groups=None):
        if len(x) > SHORT:
            raise KeyboardInterrupt
        return super().fit(x, y, groups)


class Incomplete:
    """A model without predict."""

    def fit(self, x, y, groups=None):
        return self
