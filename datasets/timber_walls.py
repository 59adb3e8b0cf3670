"""Two tests of timber shear walls: a perforated-plate connection and a rocking cross-laminated timber wall.

Published as sample data of the Python package hysteresis (C. Slotboom). The perforated plate (specimen SPC1; Drexler,
Dires, Tannert 2021) has force in kN and displacement in mm, 33,028 samples of a protocol in blocks: one primary cycle,
then trailing cycles of three quarters of it, with primaries of 3.3 to 84.5 mm. The wall (specimen TS1; R. Ganey,
thesis, University of Washington 2015) has two columns without header or units.

Defects and their handling:

- Neither has a time: samples are numbered in seconds, which says nothing of the rate.
- The connection pinches and softens, and fails in the last two blocks (primaries of 65 and 84.5 mm); the split leaves
  these out. The whole test is among the recordings.
- The wall rests over the first 8,400 of its 9,281 samples, moves by up to 4 % of its range between two samples after
  that, and its units are not stated; it is among the recordings only.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ..models.motion import turning_points
from .base import Dataset, DatasetSource, Recording
from .recorded import sensor_noise, thinned, until_first_turn
from .store import require

__all__ = ["TimberWalls"]

PLATE_FILE = "examples/WTCE Examples/SPC1.csv"
WALL_FILE = "examples/02 Basic Usage/2.2 Hysteresis with Noisey Data/TS1_Experiment_Shear.csv"
PLATE, WALL = "perforated plate SPC1", "CLT wall TS1"
TRAIN_MM, TEST_MM = (6.5, 19.5, 45.5), (13.0, 26.0)
"""Primary amplitudes of the blocks of the split."""

STRIDE = 5
QUANTUM = 0.01
"""mm and kN: the last published digit."""


class TimberWalls(DatasetSource):
    """Perforated-plate connection: trained on every other block of the protocol, tested on those between."""

    id: ClassVar[str] = "timber-walls"
    title: ClassVar[str] = "timber wall connection, cyclic shear"
    summary: ClassVar[str] = "recorded: perforated-plate connection of a timber wall; pinches and softens"
    kind: ClassVar[str] = "recorded"
    licence: ClassVar[str] = "Apache-2.0"
    extended: ClassVar[bool] = True

    def recordings(self) -> dict[str, Recording]:
        """Both published tests, sample by sample; the wall's units are not stated.

        Raises
        ------
        DatasetUnavailableError
            If the files are not on this machine.
        """
        files = require(self.id)
        force, displacement = np.loadtxt(files[PLATE_FILE], delimiter=",", skiprows=2, unpack=True)
        drift, shear = np.loadtxt(files[WALL_FILE], delimiter=",", unpack=True)
        return {
            PLATE: _recording(PLATE, displacement, force, {"units": "mm, kN", "time": "sample numbers"}),
            WALL: _recording(WALL, drift, shear, {"units": "not stated", "time": "sample numbers"}),
        }

    def load(self) -> Dataset:
        whole = self.recordings()[PLATE]
        blocks = _blocks(whole)
        train, test = ([blocks[f"primary {size:.1f} mm"] for size in sizes] for sizes in (TRAIN_MM, TEST_MM))
        sigmas = sensor_noise([*train, *test])
        return Dataset(
            id=self.id,
            title=self.title,
            train=[thinned(block, STRIDE) for block in train],
            test=[thinned(block, STRIDE) for block in test],
            split=(
                "One specimen: trained on the blocks with primary cycles of 6.5, 19.5 and 45.5 mm, tested on those of 13 and "
                "26 mm, which lie between them in amplitude and in the order of loading."
            ),
            x_name="displacement",
            x_unit="mm",
            y_name="force",
            y_unit="kN",
            source="Drexler, Dires, Tannert 2021; R. Ganey 2015; sample data of cslotboom/hysteresis",
            licence=self.licence,
            x_sigma=max(sigmas[0], QUANTUM / np.sqrt(12.0)),
            y_sigma=max(sigmas[1], QUANTUM / np.sqrt(12.0)),
            timed=False,
            assumptions=(
                "No time is published: samples are numbered in seconds. Filters that take rates from it work on a nominal "
                "clock.",
                "The licence is the repository's; the tests are by third parties.",
                "Each block is a recording of its own that begins at the turn before its primary cycle. What smaller "
                "cycles before it left behind is wiped out by the primary cycle, which is the warm-up; damage is not.",
                "The blocks of 3.3 mm (within clearance and resolution) and of 65 and 84.5 mm (failure) are not in the "
                "split.",
                f"One in {STRIDE} samples is taken; neighbours differ by about the last published digit.",
            ),
        )


def _recording(name: str, x: NDArray[np.float64], y: NDArray[np.float64], conditions: dict[str, str]) -> Recording:
    return Recording(name, np.arange(x.size, dtype=np.float64), x, y, conditions=conditions)


def _blocks(whole: Recording) -> dict[str, Recording]:
    """The blocks of the protocol by their primary amplitude: each begins at the turn before a new largest amplitude."""
    turns = turning_points(whole.x, 1.0)
    sizes = np.abs(whole.x[turns])
    largest = np.maximum.accumulate(sizes)
    # The primary's own second turn exceeds the first by rounding only.
    primary = np.flatnonzero(sizes[1:] > 1.1 * largest[:-1]) + 1
    starts = turns[primary - 1].tolist()
    found = {}
    for start, stop, size in zip(starts, [*starts[1:], whole.x.size - 1], sizes[primary], strict=True):
        part = slice(start, stop + 1)
        name = f"primary {size:.1f} mm"
        block = _recording(name, whole.x[part], whole.y[part], {"primary": f"{size:.1f} mm", **whole.conditions})
        turn = until_first_turn(block, 0.5).warm_up
        # The primary cycle ends where the motion is back at its second turn's far side: the turn after the first.
        second = until_first_turn(_recording(name, block.x[turn:], block.y[turn:], {}), 0.5).warm_up
        found[name] = Recording(name, block.time, block.x, block.y, warm_up=turn + second, conditions=block.conditions)
    return found
