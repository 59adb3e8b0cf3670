"""How much the ranking of Table 4 depends on noise, sampling, the definition of MRE and the reading of the loop."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ... import datasets
from ...bench.conditions import apply
from ...datasets import Dataset, Recording
from ...datasets.published_loop import TABLE_4
from .fits import DATASET, PAPER_MODELS, Fits, fit_one, scored
from .loop import READINGS, Reading
from .parallel import spread

__all__ = ["MRE_DEFINITIONS", "Ranking", "printed_rankings", "sensitivity"]

Floats = NDArray[np.float64]
NOISE = (0.0, 0.5, 1.0, 2.0, 5.0, 10.0)
"""Multiples of the assumed sensor noise, torque and angle together."""

DECIMATION = (1, 2, 4, 10)
"""Every how many-th sample is kept, of 200 Hz in training and 150 Hz in the test."""

BASELINE_DECIMATION = 4
"""All other studies run on every fourth sample: the sampling study shows that this changes little."""

METRICS = ("mae", "mre", "rmse")
SEED = 0


def _masked(share: float) -> Callable[[Floats, Floats], float]:
    def mre(error: Floats, truth: Floats) -> float:
        counted = np.abs(truth) >= share * np.max(np.abs(truth))
        return float(np.mean(np.abs(error[counted] / truth[counted])))

    return mre


MRE_DEFINITIONS: dict[str, Callable[[Floats, Floats], float]] = {
    "mean |e|/|T|, all samples with T ≠ 0": _masked(1e-12),
    "mean |e|/|T| where |T| ≥ 1 % of max |T|": _masked(0.01),
    "mean |e|/|T| where |T| ≥ 5 % of max |T| (hystbench)": _masked(0.05),
    "mean |e|/|T| where |T| ≥ 20 % of max |T|": _masked(0.20),
    "Σ |e| / Σ |T|": lambda e, t: float(np.abs(e).sum() / np.abs(t).sum()),
    "mean |e| / max |T|": lambda e, t: float(np.mean(np.abs(e)) / np.max(np.abs(t))),
    "max |e|, N·m (a reading with the printed unit)": lambda e, t: float(np.max(np.abs(e))),
}


@dataclass(frozen=True)
class Ranking:
    """One variant of the experiment, one metric, and the order of the three models under it."""

    study: str
    variant: str
    metric: str
    values: dict[str, float]
    """By model; NaN where it could not be fitted or used."""

    @property
    def order(self) -> str:
        ranked = sorted((v, PAPER_MODELS.index(m), m) for m, v in self.values.items() if np.isfinite(v))
        failed = [m for m, v in self.values.items() if not np.isfinite(v)]
        return " < ".join(m for _, _, m in ranked) + (f"; no figure: {', '.join(failed)}" if failed else "")

    @property
    def as_printed(self) -> bool:
        """Whether the order is the one that Table 4 prints for this metric."""
        return self.order == printed_rankings()[self.metric].order

    @property
    def closest(self) -> float:
        """Smallest ratio between neighbours in the order: near 1 the ranking is a toss-up."""
        ranked = sorted(v for v in self.values.values() if np.isfinite(v))
        return min((b / a for a, b in pairwise(ranked) if a > 0.0), default=float("nan"))


def printed_rankings() -> dict[str, Ranking]:
    """The orders that Table 4 prints, by metric."""
    return {
        metric: Ranking("printed", "Table 4", metric, {m: TABLE_4[m][metric] for m in PAPER_MODELS})
        for metric in METRICS
    }


def _scores(dataset: Dataset, condition: str) -> dict[str, dict[str, float]]:
    data = apply(dataset, condition, SEED)
    return {model: fit_one(model, data, inverse=False).scores.get("forward", {}) for model in PAPER_MODELS}


def _rankings(study: str, variant: str, scores: dict[str, dict[str, float]]) -> list[Ranking]:
    return [
        Ranking(study, variant, metric, {m: scores[m].get(metric, float("nan")) for m in PAPER_MODELS})
        for metric in METRICS
    ]


def _coarse(dataset: Dataset, factor: int) -> Dataset:
    return replace(
        dataset,
        train=[_decimated(r, factor) for r in dataset.train],
        test=[_decimated(r, factor) for r in dataset.test],
    )


def _decimated(recording: Recording, factor: int) -> Recording:
    return replace(
        recording,
        time=recording.time[::factor],
        x=recording.x[::factor],
        y=recording.y[::factor],
        warm_up=-(-recording.warm_up // factor),
    )


def _read_as(dataset: Dataset, reading: Reading) -> Dataset:
    def read(recording: Recording) -> Recording:
        return replace(recording, y=reading.torque(recording.x))

    return replace(dataset, train=[read(r) for r in dataset.train], test=[read(r) for r in dataset.test])


def sensitivity(fits: Fits, jobs: int = 1) -> list[Ranking]:
    """All variants; each changes one thing of the baseline (condition ``kalman``, one seed, assumed noise, 50 Hz).

    The definitions of MRE are applied to the predictions of ``fits`` themselves.
    """
    full = datasets.get(DATASET)().load()
    coarse = _coarse(full, BASELINE_DECIMATION)
    variants = [*_noise_variants(coarse), *_sampling_variants(full)]
    readings = [("reading of the loop", r.title, _read_as(coarse, r), "kalman") for r in READINGS]
    scores = spread(_scores, [(dataset, condition) for _, _, dataset, condition in [*variants, *readings]], jobs)
    found = [_rankings(v[0], v[1], s) for v, s in zip([*variants, *readings], scores, strict=True)]
    ranked = [ranking for group in found[: len(variants)] for ranking in group]
    ranked += _definitions(fits)
    return ranked + [ranking for group in found[len(variants) :] for ranking in group]


_Variant = tuple[str, str, Dataset, str]


def _noise_variants(dataset: Dataset) -> list[_Variant]:
    variants = []
    for multiple in NOISE:
        noisy = replace(dataset, x_sigma=multiple * dataset.x_sigma, y_sigma=multiple * dataset.y_sigma)
        title = f"{noisy.y_sigma:g} N·m, {noisy.x_sigma:g} rad"
        variants.append(("noise", title, noisy, "kalman" if multiple else "clean"))
    return [*variants, ("noise", "assumed noise, not filtered", dataset, "noisy")]


def _sampling_variants(full: Dataset) -> list[_Variant]:
    variants = []
    for factor in DECIMATION:
        coarse = _coarse(full, factor)
        rates = [1.0 / float(np.median(np.diff(part[0].time))) for part in (coarse.train, coarse.test)]
        variants.append(("sampling", f"{rates[0]:.0f} Hz, tested at {rates[1]:.0f} Hz", coarse, "kalman"))
    return variants


def _definitions(fits: Fits) -> list[Ranking]:
    keep = scored(fits.truth)
    truth = fits.truth.y[keep]
    found = []
    for title, definition in MRE_DEFINITIONS.items():
        values = {}
        for model in PAPER_MODELS:
            torque = fits.first(model).torque
            values[model] = float("nan") if torque is None else definition(torque[keep] - truth, truth)
        found.append(Ranking("definition of MRE", title, "mre", values))
    return found
