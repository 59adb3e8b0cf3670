"""Predictions that a dataset's authors published, scored like ours: same samples, same metrics."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..datasets import Dataset, Recording
from .metrics import score

__all__ = ["reference_scores", "scores_by_recording"]


def reference_scores(dataset: Dataset) -> dict[str, dict[str, Any]]:
    """Metrics of each published prediction over the test, and under ``"recordings"`` of each test recording."""
    found = {}
    for title, channel in dataset.references.items():
        estimates = [recording.channels[channel] for recording in dataset.test]
        truth = np.concatenate([recording.y for recording in dataset.test])
        keep = np.concatenate([_kept(recording) for recording in dataset.test])
        found[title] = {
            **score(truth, np.concatenate(estimates), keep),
            "recordings": [
                score(recording.y, estimate, _kept(recording))
                for recording, estimate in zip(dataset.test, estimates, strict=True)
            ],
        }
    return found


def _kept(recording: Recording) -> NDArray[np.bool_]:
    return np.arange(recording.y.size) >= recording.warm_up


def scores_by_recording(
    truth: NDArray[np.float64], estimate: NDArray[np.float64], keep: NDArray[np.bool_], labels: NDArray[np.int64]
) -> Sequence[dict[str, float]]:
    """Metrics of each recording; ``labels`` (n,) are 0, 1, … in the order of the recordings."""
    return [
        score(truth[labels == label], estimate[labels == label], keep[labels == label]) for label in np.unique(labels)
    ]
