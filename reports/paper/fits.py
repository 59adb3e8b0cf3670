"""Every registered model identified on the published loop, once for all tables and figures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import datasets, models
from ...bench.conditions import Conditioned, apply
from ...bench.metrics import score
from ...datasets import Recording, concatenate
from .parallel import spread

__all__ = ["PAPER_MODELS", "Fits", "Fitted", "fit_models", "fit_one", "scored"]

Floats = NDArray[np.float64]
PAPER_MODELS = ("maxwell-slip", "cubic", "bouc-wen")
"""The three models of the first paper's Tables 4 and 5, in its order of merit."""

DATASET = "vsa-published"


@dataclass(frozen=True)
class Fitted:
    """One model under one seed: its predictions over the test and its scores; ``message`` says why one is missing."""

    model: Any
    torque: Floats | None
    deflection: Floats | None
    scores: dict[str, dict[str, float]]
    message: str = ""


@dataclass(frozen=True)
class Fits:
    """The paper's models under all seeds of one condition, further models under the first seed."""

    condition: str
    seeds: tuple[int, ...]
    data: Conditioned
    results: dict[tuple[str, int], Fitted]

    @property
    def models(self) -> list[str]:
        return list(dict.fromkeys(model for model, _ in self.results))

    @property
    def truth(self) -> Recording:
        return self.data.truth[0]

    @property
    def keep(self) -> NDArray[np.bool_]:
        """The samples that count: what comes before the first top does not."""
        return scored(self.truth)

    def first(self, model: str) -> Fitted:
        return self.results[model, self.seeds[0]]

    def median(self, model: str, task: str, metric: str) -> float:
        """Median of a score over the model's seeds; NaN where one failed."""
        runs = [self.results[key] for key in self.results if key[0] == model]
        values = [run.scores.get(task, {}).get(metric, np.nan) for run in runs]
        return float(np.median(values))


def scored(recording: Recording) -> NDArray[np.bool_]:
    """The samples after the warm-up."""
    return np.arange(recording.x.size) >= recording.warm_up


def fit_models(
    names: Sequence[str] | None = None,
    condition: str = "kalman",
    seeds: Sequence[int] = (0, 1, 2),
    jobs: int = 1,
) -> Fits:
    """Fit and test models on the published loop.

    Parameters
    ----------
    names : sequence of str, optional
        Model ids (default: all that stand for themselves, the paper's three first).
    condition : str
        What is done to the signals, see :data:`hystbench.bench.conditions.CONDITIONS`.
    seeds : sequence of int
        Seeds of the assumed sensor noise; models other than the paper's three use the first one only.
    jobs : int
        Processes.
    """
    if names is None:
        names = [*PAPER_MODELS, *(name for name in models.benchmarked_ids() if name not in PAPER_MODELS)]
    dataset = datasets.get(DATASET)().load()
    conditioned = {seed: apply(dataset, condition, seed) for seed in seeds}
    # Models beyond the paper's three stand beside no printed figure: one seed shows where they are.
    keys = [(name, seed) for name in names for seed in (seeds if name in PAPER_MODELS else seeds[:1])]
    fitted = spread(fit_one, [(name, conditioned[seed]) for name, seed in keys], jobs)
    return Fits(condition, tuple(seeds), conditioned[seeds[0]], dict(zip(keys, fitted, strict=True)))


def fit_one(name: str, data: Conditioned, inverse: bool = True) -> Fitted:
    """Fit one model and score its torque, and the deflection of its inverse unless that is not wanted."""
    x, y, groups = concatenate(data.train)
    truth, seen = data.truth[0], data.test[0]
    keep = scored(truth)
    scores: dict[str, dict[str, float]] = {}
    fitted = torque = deflection = None
    try:
        fitted = models.get(name)()
        fitted.fit(x, y, groups=groups)
        torque = np.asarray(fitted.predict(seen.x), dtype=np.float64)
        scores["forward"] = score(truth.y, torque, keep)
        if inverse:
            deflection = np.asarray(fitted.invert(seen.y, x0=float(seen.x[0]), approximate=True), dtype=np.float64)
            scores["inverse"] = score(truth.x, deflection, keep)
    # A plug-in of another package may fail in any way: its row then says so, and the others stay.
    except Exception as error:
        return Fitted(fitted, torque, deflection, scores, " ".join(f"{type(error).__name__}: {error}".split())[:300])
    return Fitted(fitted, torque, deflection, scores)
