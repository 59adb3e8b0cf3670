"""A synthetic dataset and one that cannot be loaded."""

import numpy as np

from hystbench.datasets import Dataset, DatasetSource, Recording

from .models import _stop


def plant(time, x):
    return 2.0 * x + 0.5 * _stop(x, 0.2)


class SampleLoop(DatasetSource):
    id = "sample-loop"
    title = "<script>alert(1)</script>"
    summary = "a spring and a stop"
    kind = "synthetic"
    licence = "CC0-1.0"

    def load(self):
        time = np.arange(1200) / 100.0
        parts = {}
        for name, amplitude in (("train", 1.0), ("test", 0.7)):
            x = amplitude * np.sin(2.0 * np.pi * 0.4 * time)
            parts[name] = [Recording(f"{amplitude:g} rad", time, x, plant(time, x), 100)]
        return Dataset(
            id=self.id, title=self.title, train=parts["train"], test=parts["test"], split="Another amplitude.",
            x_name="angle", x_unit="rad", y_name="torque", y_unit="N·m", source="this file", licence=self.licence,
            x_sigma=1e-3, y_sigma=5e-3, plant=plant,
        )  # fmt: skip


class RaisingDataset(DatasetSource):
    id = "sample-dataset-raises"
    title = "raises"
    summary = "cannot be loaded"
    kind = "synthetic"
    licence = "CC0-1.0"

    def load(self):
        raise OSError("the disk is on fire")
