"""What a dataset is: recordings with a train/test split, units, a warm-up that scores skip, a source and a licence."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

__all__ = ["Dataset", "DatasetSource", "DatasetUnavailableError", "Plant", "Recording", "concatenate"]

Floats = NDArray[np.float64]


class DatasetUnavailableError(Exception):
    """The dataset's files are not on this machine: the message says which and how to get them."""


@dataclass(frozen=True)
class Recording:
    """One uninterrupted time series.

    Attributes
    ----------
    name : str
        Unique within its dataset, for instance ``"25 mm, 0.5 Hz, 0 A"``.
    time : array, shape (n,)
        Seconds, strictly increasing.
    x, y : array, shape (n,)
        Input and output, in the dataset's units.
    warm_up : int
        Scores skip this many first samples: the memory there depends on a history that was not recorded.
    channels : mapping of str to array, shape (n,)
        Further channels, for instance pressure or temperature.
    conditions : mapping of str to str
        What was varied and held during this recording, in words for people.

    Raises
    ------
    ValueError
        Where channels differ in length, the warm-up is not shorter, a figure is not finite or time does not increase.
    """

    name: str
    time: Floats
    x: Floats
    y: Floats
    warm_up: int = 0
    channels: Mapping[str, Floats] = field(default_factory=dict)
    conditions: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        sizes = {self.time.size, self.x.size, self.y.size, *(c.size for c in self.channels.values())}
        if len(sizes) != 1:
            raise ValueError(f"recording {self.name!r}: its channels differ in length")
        if not 0 <= self.warm_up < self.time.size:
            raise ValueError(f"recording {self.name!r}: the warm-up must be shorter than the recording")
        if not all(np.isfinite(series).all() for series in (self.time, self.x, self.y)):
            raise ValueError(f"recording {self.name!r}: time, input and output must be finite numbers")
        if not np.all(np.diff(self.time) > 0.0):
            raise ValueError(f"recording {self.name!r}: its time must increase from each sample to the next")


class Plant(Protocol):
    """The real thing behind synthetic data: it turns any input into the output, from the virgin state."""

    def __call__(self, time: Floats, x: Floats) -> Floats: ...


@dataclass(frozen=True)
class Dataset:
    """Recordings with a train/test split.

    Attributes
    ----------
    train, test : sequence of Recording
        The split must test generalisation: other amplitudes, rates, cycles or conditions.
    split : str
        One sentence: what differs between train and test.
    x_sigma, y_sigma : float
        Standard deviation of the sensors' white noise, in the units of x and y. For synthetic data (``plant`` is
        given) the recordings are noise-free and this is the assumed noise; for recorded data it is an estimate.
    plant : Plant or None
        For synthetic data, what a compensator drives.
    assumptions : sequence of str
        Everything that the source does not say and that had to be assumed.
    references : mapping of str to str
        Predictions of y that the source publishes: title for people, for instance ``"LuGre (Doe 2024, published)"``, and
        the channel of every test recording that holds it. Reports score them like the models' own.
    timed : bool
        Whether the times of the samples are known; otherwise they only number the samples, and nothing is said of rates.
    """

    id: str
    title: str
    train: Sequence[Recording]
    test: Sequence[Recording]
    split: str
    x_name: str
    x_unit: str
    y_name: str
    y_unit: str
    source: str
    licence: str
    x_sigma: float
    y_sigma: float
    plant: Plant | None = None
    assumptions: Sequence[str] = ()
    references: Mapping[str, str] = field(default_factory=dict)
    timed: bool = True

    def __post_init__(self) -> None:
        for title, channel in self.references.items():
            lacking = [recording.name for recording in self.test if channel not in recording.channels]
            if lacking:
                raise ValueError(
                    f"dataset {self.id!r}: {title}: test recording {lacking[0]!r} has no channel {channel!r}"
                )

    @property
    def kind(self) -> str:
        """``"synthetic"`` or ``"recorded"``."""
        return "recorded" if self.plant is None else "synthetic"


class DatasetSource:
    """Base class of dataset plug-ins (entry-point group ``hystbench.datasets``)."""

    id: ClassVar[str]
    title: ClassVar[str]
    summary: ClassVar[str]
    kind: ClassVar[str]
    """``"synthetic"`` or ``"recorded"``."""
    licence: ClassVar[str]
    extended: ClassVar[bool] = False
    """Whether ``--quick`` runs leave it out."""

    def load(self) -> Dataset:
        """Return the dataset.

        Raises
        ------
        DatasetUnavailableError
            If its files are not on this machine.
        InputError
            If a file is there but is not what the catalogue says.
        """
        raise TypeError(f"{type(self).__name__} does not define load")


def concatenate(recordings: Sequence[Recording]) -> tuple[Floats, Floats, NDArray[np.int64]]:
    """Join recordings to (x, y, groups) as ``fit`` takes them: one group a recording."""
    groups = np.repeat(np.arange(len(recordings)), [r.x.size for r in recordings])
    return (
        np.concatenate([r.x for r in recordings]),
        np.concatenate([r.y for r in recordings]),
        groups,
    )
