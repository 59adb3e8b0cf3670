"""Which model is better over all datasets, and how sure that is."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from .run_directory import RunDirectory

__all__ = ["Ranking", "rank_models"]

Floats = NDArray[np.float64]
RESAMPLES = 2000
LEVEL = 0.95


@dataclass(frozen=True)
class Ranking:
    """Models by their mean rank over the datasets (1 is best), each dataset under its reference condition.

    ``low`` and ``high`` bound the mean rank (95 %, bootstrap over datasets and seeds), NaN with a single dataset.
    ``place`` counts the models that are better for certain, plus one, and ends in ``=`` where others share it; no model is
    placed behind one with a worse mean rank.
    ``critical_difference`` is Nemenyi's and ``p`` Friedman's; NaN where the test needs more models or datasets.
    """

    models: Sequence[str]
    datasets: Sequence[str]
    mean: Floats
    low: Floats
    high: Floats
    place: Sequence[str]
    p: float
    critical_difference: float


def rank_models(run: RunDirectory, task: str) -> Ranking | None:
    """Rank the models in one task by NRMSE; None if no dataset has figures of two models.

    A model without a figure ranks last where others have one; equal errors share their ranks.
    """
    ranks: list[Floats] = []
    names: list[str] = []
    for dataset in run.datasets:
        errors = _errors(run, dataset, task)
        if np.isfinite(errors).any(axis=0).sum() >= 2:
            names.append(dataset)
            ranks.append(stats.rankdata(errors, axis=1, nan_policy="raise"))
    if not names:
        return None
    table = np.array([seeds.mean(axis=0) for seeds in ranks])
    resampled = _bootstrap(ranks)
    order = np.lexsort((np.arange(len(run.models)), table.mean(axis=0)))
    outer = np.full((2, len(run.models)), math.nan)
    if resampled is not None:
        outer = np.quantile(resampled, [(1 - LEVEL) / 2, (1 + LEVEL) / 2], axis=0)
    places = _places(table, resampled)
    k, n = len(run.models), len(names)
    p = critical = math.nan
    if k >= 3 and n >= 2:
        with np.errstate(invalid="ignore", divide="ignore"):
            p = float(stats.friedmanchisquare(*table.T).pvalue)
        critical = (
            float(stats.studentized_range.ppf(LEVEL, k, np.inf)) / math.sqrt(2.0) * math.sqrt(k * (k + 1) / 6 / n)
        )
    return Ranking(
        [run.models[i] for i in order], names, table.mean(axis=0)[order], outer[0][order], outer[1][order],
        [places[i] for i in order], p, critical,
    )  # fmt: skip


def _errors(run: RunDirectory, dataset: str, task: str) -> Floats:
    """NRMSE by seed and model, infinite where there is none; errors below rounding are equal."""
    condition = run.reference_condition(dataset)
    found = {m: run.rows(dataset, condition, task, m).set_index("seed") for m in run.models}
    seeds = sorted({int(s) for rows in found.values() for s in rows.index})
    errors = np.full((len(seeds), len(run.models)), math.inf)
    row: Any
    for j, rows in enumerate(found.values()):
        for row in rows[rows["status"] == "ok"].itertuples():
            if math.isfinite(row.nrmse):
                errors[seeds.index(row.Index), j] = max(row.nrmse, 1e-9)
    return errors


def _bootstrap(ranks: Sequence[Floats]) -> Floats | None:
    """Mean ranks, resamples x models: datasets drawn with replacement, and in each one of its seeds."""
    if len(ranks) < 2:
        return None
    rng = np.random.default_rng(0)
    sizes = np.array([seeds.shape[0] for seeds in ranks])
    padded = np.zeros((len(ranks), sizes.max(), ranks[0].shape[1]))
    for dataset, seeds in zip(padded, ranks, strict=True):
        dataset[: len(seeds)] = seeds

    def mean_ranks(index: Any, axis: int) -> Floats:
        chosen = index.astype(int)
        return np.moveaxis(padded[chosen, rng.integers(0, sizes[chosen])].mean(axis=axis - 1), -1, 0)

    with np.errstate(invalid="ignore"):
        result = stats.bootstrap(
            (np.arange(len(ranks), dtype=float),), mean_ranks, n_resamples=RESAMPLES, vectorized=True, axis=-1,
            confidence_level=LEVEL, method="percentile", rng=rng,
        )  # fmt: skip
    return np.asarray(result.bootstrap_distribution).T


def _places(table: Floats, resampled: Floats | None) -> list[str]:
    """A place counts the models that lead by a difference of mean ranks whose interval excludes 0."""
    if resampled is None:
        ahead = table.mean(axis=0)[:, None] < table.mean(axis=0)[None, :]
    else:
        ahead = np.quantile(resampled[:, None, :] - resampled[:, :, None], (1 - LEVEL) / 2, axis=0) > 0
    places = 1 + ahead.sum(axis=0)
    # A steady model may be behind for certain while an unsteady one with a worse mean is not: then neither is placed behind.
    order = np.argsort(table.mean(axis=0), kind="stable")
    places[order] = np.minimum.accumulate(places[order][::-1])[::-1]
    return [f"{place}=" if (places == place).sum() > 1 else str(place) for place in places]
