"""Error metrics: one table that scores, the report's definitions and the documentation share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["METRICS", "METRIC_VERSION", "Metric", "score"]

METRIC_VERSION = "1"
"""Raised whenever a definition changes, so that kept results are not compared with new ones."""

Floats = NDArray[np.float64]
SMALL = 0.05


def _mre(error: Floats, truth: Floats) -> float:
    counted = np.abs(truth) >= SMALL * np.max(np.abs(truth))
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = np.abs(error[counted]) / np.abs(truth[counted])
    return float(np.mean(relative)) if np.all(np.isfinite(relative)) else float("nan")


def _nrmse(error: Floats, truth: Floats) -> float:
    span = float(np.ptp(truth))
    return float(np.sqrt(np.mean(error**2))) / span if span > 0.0 else float("nan")


@dataclass(frozen=True)
class Metric:
    """One metric: smaller is better for all of them."""

    id: str
    title: str
    function: Callable[[Floats, Floats], float]
    description: str


METRICS = (
    Metric("mae", "MAE", lambda e, t: float(np.mean(np.abs(e))), "Mean absolute error, in the unit of the signal."),
    Metric(
        "mre",
        "MRE",
        _mre,
        "Mean relative error: the mean of |error| / |truth| over the samples whose |truth| is at least 5 % of its "
        "maximum; it has no unit. The source paper prints N·m and rad as the unit of its MRE and gives no definition. "
        "A relative error can have neither, so its printed figures cannot be compared with these for certain.",
    ),
    Metric(
        "rmse", "RMSE", lambda e, t: float(np.sqrt(np.mean(e**2))), "Root mean square error, in the unit of the signal."
    ),
    Metric(
        "max_abs", "max", lambda e, t: float(np.max(np.abs(e))), "Largest absolute error, in the unit of the signal."
    ),
    Metric(
        "nrmse",
        "NRMSE",
        _nrmse,
        "RMSE divided by the range (largest minus smallest) of the truth over the scored samples; it has no unit.",
    ),
)


def score(truth: ArrayLike, estimate: ArrayLike, keep: ArrayLike | None = None) -> dict[str, float]:
    """All metrics of ``estimate`` against ``truth``, and the number ``n`` of scored samples.

    Parameters
    ----------
    truth, estimate : array_like, shape (n,)
    keep : array_like of bool, shape (n,), optional
        Samples that count; the warm-up does not.

    Raises
    ------
    ValueError
        If shapes differ, nothing is left to score, or a scored value is not finite.
    """
    if np.iscomplexobj(truth) or np.iscomplexobj(estimate):
        raise ValueError("truth and estimate must be real; converting complex values would drop their imaginary parts")
    true, found = np.asarray(truth, dtype=np.float64), np.asarray(estimate, dtype=np.float64)
    if true.shape != found.shape or true.ndim != 1:
        raise ValueError(f"truth and estimate must be 1-D and alike; their shapes are {true.shape} and {found.shape}")
    if keep is not None:
        chosen = np.asarray(keep, dtype=bool)
        if chosen.shape != true.shape:
            raise ValueError(f"keep must have shape {true.shape}; it has {chosen.shape}")
        true, found = true[chosen], found[chosen]
    if true.size == 0:
        raise ValueError("no sample is left to score")
    if not (np.all(np.isfinite(true)) and np.all(np.isfinite(found))):
        raise ValueError("truth and estimate must be finite where they are scored")
    error = found - true
    return {"n": true.size, **{metric.id: metric.function(error, true) for metric in METRICS}}
