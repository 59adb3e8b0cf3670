"""Choosing hyperparameters by blocked cross-validation, and how much data a model needs.

Neighbouring samples of a loop are nearly copies of each other, so whole stretches between turning points are held out, not
single samples. A held-out stretch is predicted with the true history before it: what is scored is the model, not the
unknown start of its memory.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from .base import as_series, split_runs
from .motion import auto_dead_band, turning_points

if TYPE_CHECKING:
    from .base import HysteresisModel

__all__ = ["Candidate", "LearningPoint", "choose_hyperparameters", "cross_validate", "learning_curve"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Candidate:
    """One setting of hyperparameters and its held-out error.

    Attributes
    ----------
    hyperparameters : dict
    nrmse : float
        RMSE over all held-out samples divided by the range of the output; NaN where no fit succeeded.
    spread : float
        Standard error of ``nrmse`` over the folds.
    """

    hyperparameters: dict[str, Any]
    nrmse: float
    spread: float


@dataclass(frozen=True)
class LearningPoint:
    """Held-out error (as in :class:`Candidate`) after training on ``samples`` samples."""

    samples: int
    nrmse: float


def cross_validate(
    model: HysteresisModel,
    x: ArrayLike,
    y: ArrayLike,
    groups: ArrayLike | None = None,
    *,
    time: ArrayLike | None = None,
    folds: int = 5,
) -> Candidate:
    """Held-out error of a model's hyperparameters.

    Parameters
    ----------
    model : HysteresisModel
        Its hyperparameters are used, its parameters are not; it stays as it is.
    x, y : array_like, shape (n,)
    groups, time : array_like, shape (n,), optional
        As in ``fit``.
    folds : int
        Stretches that are held out in turn; fewer where the recording has fewer turning points.

    Raises
    ------
    InputError
        If the recording has too few turning points for two folds, or no fold can be fitted.
    """
    data = _Recording(x, y, groups, time)
    blocks = data.blocks(folds)
    errors = [data.held_out_error(model, blocks != k, blocks == k) for k in range(int(blocks.max()) + 1)]
    squares = np.array([error for error in errors if isinstance(error, float)])
    if squares.size == 0:
        raise InputError(f"{model.id} cannot be fitted to any part of this recording: {errors[0]}")
    span = float(np.ptp(data.y)) or 1.0
    each = np.sqrt(squares) / span
    spread = float(np.std(each, ddof=1) / np.sqrt(each.size)) if each.size > 1 else 0.0
    return Candidate(model.get_params(), float(np.sqrt(np.mean(squares)) / span), spread)


def choose_hyperparameters(
    cls: type[HysteresisModel],
    x: ArrayLike,
    y: ArrayLike,
    groups: ArrayLike | None = None,
    *,
    time: ArrayLike | None = None,
    grid: Mapping[str, Sequence[Any]] | None = None,
    folds: int = 5,
) -> list[Candidate]:
    """Candidates over a grid of hyperparameters, the best first.

    Parameters are those of :func:`cross_validate`; ``grid`` maps names to values (default: the class's
    ``search_grid``). Settings that cannot be fitted come last, with NaN.

    Raises
    ------
    InputError
        If there is no grid, or none of its settings can be fitted.
    """
    chosen = grid if grid is not None else cls.search_grid
    if not chosen:
        raise InputError(f"{cls.id} has no hyperparameters to choose; give a grid")
    found = []
    for values in itertools.product(*chosen.values()):
        setting = dict(zip(chosen, values, strict=True))
        try:
            found.append(cross_validate(cls().set_params(**setting), x, y, groups, time=time, folds=folds))
        except InputError as error:
            reason = error
            found.append(Candidate(setting, float("nan"), float("nan")))
    if all(np.isnan(candidate.nrmse) for candidate in found):
        raise reason
    return sorted(found, key=lambda candidate: (np.isnan(candidate.nrmse), candidate.nrmse))


def learning_curve(
    model: HysteresisModel,
    x: ArrayLike,
    y: ArrayLike,
    groups: ArrayLike | None = None,
    *,
    time: ArrayLike | None = None,
    points: int = 6,
) -> list[LearningPoint]:
    """Held-out error against the amount of training data.

    The last third of the recording (in stretches between turning points) is held out; training takes growing parts of
    the rest, from its beginning. Parameters are those of :func:`cross_validate`.
    """
    data = _Recording(x, y, groups, time)
    blocks = data.blocks(3 * points)
    last = int(blocks.max())
    test = blocks > (2 * last) // 3
    found = []
    for k in range(int(blocks[~test].max()) + 1):
        train = (blocks <= k) & ~test
        error = data.held_out_error(model, train, test)
        if isinstance(error, float):
            found.append(LearningPoint(int(train.sum()), float(np.sqrt(error) / (float(np.ptp(data.y)) or 1.0))))
    return found


class _Recording:
    """Samples with their runs, and the fits to parts of them."""

    def __init__(self, x: ArrayLike, y: ArrayLike, groups: ArrayLike | None, time: ArrayLike | None) -> None:
        self.x, self.y = as_series("x", x), as_series("y", y)
        if self.x.shape != self.y.shape:
            raise InputError(f"x and y must have the same length; they have {self.x.size} and {self.y.size}")
        self.runs = list(split_runs(groups, self.x.size))
        self.labels = np.repeat(np.arange(len(self.runs)), [part.stop - part.start for part in self.runs])
        self.time = None if time is None else as_series("time", time)

    def blocks(self, wanted: int) -> NDArray[np.intp]:
        """Number of the stretch that each sample lies in: up to ``wanted`` of about equal length, cut at turns."""
        cuts = []
        for part in self.runs:
            turns = turning_points(self.x[part], auto_dead_band(self.x[part]))[1:-1]
            cuts += (part.start + turns).tolist()
            if part.start:
                cuts.append(part.start)
        places = np.array(sorted(set(cuts)), dtype=np.intp)
        if places.size == 0:
            raise InputError("the input never turns: nothing can be held out; give a recording with turning points")
        ideal = np.linspace(0, self.x.size, wanted + 1)[1:-1]
        edges = np.unique(places[np.argmin(np.abs(places[:, None] - ideal), axis=0)])
        return np.searchsorted(edges, np.arange(self.x.size), side="right")

    def held_out_error(
        self, model: HysteresisModel, train: NDArray[np.bool_], test: NDArray[np.bool_]
    ) -> float | InputError:
        """Mean squared error over ``test`` after a fit to ``train``, or why there is no fit."""
        # A gap in the training samples ends a run: memory does not carry over it.
        pieces = np.cumsum(np.diff(train, prepend=train[0]) != 0) + train.size * self.labels
        trial = model.clone()
        try:
            trial.fit(self.x[train], self.y[train], groups=pieces[train], **self._times(trial, train))
            everything = np.ones(train.size, dtype=bool)
            predicted = trial.predict(self.x, groups=self.labels, **self._times(trial, everything))
        except InputError as error:
            return error
        return float(np.mean((predicted[test] - self.y[test]) ** 2))

    def _times(self, model: HysteresisModel, chosen: NDArray[np.bool_]) -> dict[str, Any]:
        return {} if model.rate_independent or self.time is None else {"time": self.time[chosen]}
