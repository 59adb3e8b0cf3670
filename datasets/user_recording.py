"""The user's own recording as a dataset: ``hystbench run --datasets FILE``.

A recording in a file says nothing of a split, a warm-up, units or noise. They are taken as follows, and the dataset's
assumptions say so: the last third is held out as one block that begins where the input turns, scores of it begin at
its first turn, units come from the column names, and the noise is estimated from fourth differences.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path, PurePath
from typing import ClassVar
from urllib.parse import parse_qs, urlencode

import numpy as np

from ..errors import InputError
from ..models.motion import auto_dead_band, noise_level, turning_points
from .base import Dataset, DatasetSource, Recording
from .column_roles import quantity
from .recorded import thinned, until_first_turn
from .recording_files import SUFFIXES, read_columns

__all__ = ["UserRecording", "held_out", "is_file", "with_columns"]

TRAIN_SHARE = 2.0 / 3.0
MOST_SAMPLES = 12_000
"""Longer recordings are thinned, so that every model's fit stays a matter of seconds."""

LEAST_TURNS = 3
COLUMNS = ("x", "y", "time")


class UserRecording(DatasetSource):
    """A dataset made of one file.

    Parameters
    ----------
    name : str
        Path, with other column names than the default ones after a question mark: ``loop.csv?x=angle&y=torque&time=t``.
    """

    title: ClassVar[str] = "a recording of the user's"
    summary: ClassVar[str] = "recorded: one file, its last third held out"
    kind: ClassVar[str] = "recorded"
    licence: ClassVar[str] = "the user's own"

    def __init__(self, name: str) -> None:
        self.name = name

    def load(self) -> Dataset:
        """The dataset.

        Raises
        ------
        InputError
            If the file is no recording, or its input turns too seldom to hold a part out.
        """
        path, names = _split(self.name)
        columns = read_columns(path, {"x": names.get("x"), "y": names.get("y")}, names.get("time"))
        x_column, y_column = columns.names["x"], columns.names["y"]
        if np.ptp(columns["x"]) == 0.0:
            raise InputError(f"{path}: column {x_column!r} is constant; give a recording in which the input moves")
        if np.ptp(columns["y"]) == 0.0:
            raise InputError(f"{path}: column {y_column!r} is constant; there is no output to predict")
        whole = Recording(
            path.stem, columns.time - columns.time[0], columns["x"], columns["y"], channels=columns.channels
        )
        train, test = held_out(whole, str(path))
        x_sigma, y_sigma = noise_level(whole.x), noise_level(whole.y)
        stride = -(-whole.x.size // MOST_SAMPLES)
        (x_name, x_unit), (y_name, y_unit) = quantity(x_column), quantity(y_column)
        return Dataset(
            id=self.name,
            title=f"recording {path.name}",
            train=[thinned(train, stride)],
            test=[thinned(test, stride)],
            split=(
                f"Trained on the first {train.x.size} samples, tested on the last {test.x.size}: one block, cut where the "
                "input turns."
            ),
            x_name=x_name,
            x_unit=x_unit,
            y_name=y_name,
            y_unit=y_unit,
            source=f"{path.name}, columns {x_column} and {y_column}",
            licence=self.licence,
            x_sigma=x_sigma,
            y_sigma=y_sigma,
            assumptions=(
                *columns.notes,
                *filter(None, [columns.untimed]),
                *_assumptions(train, test, stride, x_unit and y_unit),
            ),
        )


def is_file(name: str) -> bool:
    """Whether an entry of ``--datasets`` means a file: it has a folder in it or a recording's suffix."""
    path = PurePath(name.partition("?")[0])
    return "/" in name or len(path.parts) > 1 or path.suffix.lower() in SUFFIXES


def with_columns(name: str, **columns: str | None) -> str:
    """``name`` with the given column names, unless it brings its own."""
    path, own = _split(name)
    wanted = {role: column for role, column in columns.items() if column is not None} | own
    return f"{path}?{urlencode(wanted)}" if wanted else name


def _split(name: str) -> tuple[Path, dict[str, str]]:
    """Path and column names of an entry such as ``loop.csv?x=angle``."""
    text, mark, query = name.partition("?")
    if not mark or Path(name).is_file():
        return Path(name), {}
    given = {role: values[-1] for role, values in parse_qs(query).items()}
    if not given or not set(given) <= set(COLUMNS):
        raise InputError(f"{name}: after the question mark write columns, as in {text}?x=COLUMN&y=COLUMN&time=COLUMN")
    return Path(text), given


def held_out(whole: Recording, where: str) -> tuple[Recording, Recording]:
    """The recording in two: what is fitted and, from the turn nearest to two thirds of it, what is scored.

    Raises
    ------
    InputError
        If the input turns less than three times: once in either part, and once where they meet.
    """
    turns = turning_points(whole.x, auto_dead_band(whole.x))[1:-1]
    if turns.size < LEAST_TURNS:
        raise InputError(
            f"{where}: the input turns {turns.size} times; to hold a part out it must turn at least {LEAST_TURNS} times. "
            "Record more cycles, or use `hystbench fit`, which needs no held-out part"
        )
    inner = turns[1:-1]
    cut = int(inner[np.argmin(np.abs(inner - TRAIN_SHARE * whole.x.size))])
    train, test = _part(whole, 0, cut + 1, "first part"), _part(whole, cut, whole.x.size, "last part")
    band = auto_dead_band(whole.x)
    return train, until_first_turn(test, band / float(np.ptp(test.x)))


def _part(whole: Recording, start: int, stop: int, name: str) -> Recording:
    part = slice(start, stop)
    return replace(
        whole,
        name=f"{whole.name}, {name}",
        time=whole.time[part] - whole.time[start],
        x=whole.x[part],
        y=whole.y[part],
        channels={key: values[part] for key, values in whole.channels.items()},
        conditions={"part": name},
    )


def _assumptions(train: Recording, test: Recording, stride: int, units: str) -> list[str]:
    told = [
        "Scores begin at the held-out part's first turn: its memory before that is the recording's, which a model that "
        "starts anew does not have.",
        "Noise is estimated from fourth differences: a motion that is not smooth between samples counts as noise.",
    ]
    if not units:
        told.append("No unit could be read off a column's name; name columns like deflection_rad and torque_nm.")
    if stride > 1:
        told.append(f"Thinned to every {stride}th sample without a filter.")
    low, high = (float(extreme(train.x) - extreme(test.x)) for extreme in (np.min, np.max))
    beyond = max(low, -high) / float(np.ptp(train.x))
    if beyond > 0.02:
        told.append(
            f"The held-out part goes beyond the fitted range by {beyond:.0%} of it: part of the error is extrapolation."
        )
    return told
