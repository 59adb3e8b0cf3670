"""How far a gap shrinks, on samples that the fit never saw."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..recording.noise import rms
from .evidence import Evidence, Hypothesis
from .refinement import refine

__all__ = ["HeldOut", "closed_share", "held_out"]

Floats = NDArray[np.float64]
FOLDS = 5
BLOCKS_A_FOLD = 12
"""At least."""
SHORTEST = 2
"""Samples of the shortest blocks, for what lasts a few samples in all."""
MARGIN = 0.1
"""Part of a block's length that is left out of the fit on either side of it, so that memory does not leak."""
UNSEEN = 0.01
"""Power of a column where a fit looks, over its power on the whole recording, below which the fit says nothing of it."""
RESAMPLES = 400


@dataclass(frozen=True)
class HeldOut:
    """A hypothesis' output where its fit was blind.

    Attributes
    ----------
    signal : array, shape (n,)
        What all effects add.
    parts : dict of str to array
        What each effect adds.
    recalibration : array, shape (n,)
        What the refitted simulator adds.
    """

    signal: Floats
    parts: dict[str, Floats]
    recalibration: Floats


def _blocks_of(hypothesis: Hypothesis) -> int:
    """Blocks a fold, so many that no effect hides in one of them, such as a stop that is touched once beside others."""
    return max((_blocks(hypothesis.part(name)) for name in hypothesis.names), default=BLOCKS_A_FOLD)


def _blocks(signal: Floats) -> int:
    """Blocks a fold, so many that a signal does not hide in one of them."""
    energy = np.square(signal)
    total = float(energy.sum())
    if total == 0.0:
        return BLOCKS_A_FOLD
    busy = total**2 / float(energy @ energy)
    return int(np.clip(signal.size / (FOLDS * busy / 5.0), BLOCKS_A_FOLD, max(signal.size // (SHORTEST * FOLDS), 1)))


def _folds(evidence: Evidence, blocks: int) -> list[tuple[NDArray[np.bool_], NDArray[np.bool_]]]:
    """(seen, held out) rows of each fold: interleaved blocks with margins."""
    n = evidence.scene.torque.size
    edges = np.linspace(0, n, FOLDS * blocks + 1).astype(int)
    margin = int(MARGIN * n / (FOLDS * blocks))
    made = []
    for fold in range(FOLDS):
        out, near = np.zeros(n, dtype=bool), np.zeros(n, dtype=bool)
        for block in range(fold, FOLDS * blocks, FOLDS):
            out[edges[block] : edges[block + 1]] = True
            near[max(edges[block] - margin, 0) : edges[block + 1] + margin] = True
        made.append((~near, out))
    return made


def held_out(evidence: Evidence, hypothesis: Hypothesis, evaluations: int = 4) -> HeldOut:
    """Fit ``hypothesis`` again on each fold's seen samples and evaluate it on the others.

    ``evaluations`` limits how far the shapes may move in each fold (0: they stay).
    """
    n = evidence.scene.torque.size
    signal, recalibration = np.zeros(n), np.zeros(n)
    parts = {name: np.zeros(n) for name in hypothesis.names}
    for kept, out in _folds(evidence, _blocks_of(hypothesis)):
        seen = kept & evidence.rows
        part = evidence.on(seen)
        fitted = part.fit(hypothesis.terms, (hypothesis.scale,))
        if evaluations:
            fitted = refine(part, fitted, evaluations, (hypothesis.scale,))
        # What happened in the blocks held out alone cannot be known from the others: nothing is predicted of it.
        power = np.mean(np.square(fitted.columns), axis=0)
        unseen = np.mean(np.square(fitted.columns[seen]), axis=0) < UNSEEN * power
        fitted.coefficients = np.where(unseen, 0.0, fitted.coefficients)
        whole = fitted.signal
        signal[out] = whole[out]
        for name in parts:
            parts[name][out] = fitted.part(name)[out]
        if hypothesis.scale != (0.0, 0.0):
            recalibration[out] = part.absorbed(part.gap - whole[seen], hypothesis.scale)[out]
    return HeldOut(signal, parts, recalibration)


def closed_share(gap: Floats, after: Floats, floor: float, seed: int) -> tuple[float, float, list[float]]:
    """RMS of what is left, share of the gap's energy beyond the noise that is closed, and its 90 % interval.

    The interval is a block bootstrap (Kuensch, Ann. Statist. 17, 1989) with blocks of a fortieth of the recording.
    """
    edges = np.linspace(0, gap.size, min(40, max(gap.size // 8, 2)) + 1).astype(int)
    sizes = np.diff(edges)
    before_sums = np.add.reduceat(np.square(gap), edges[:-1])
    after_sums = np.add.reduceat(np.square(after), edges[:-1])
    rng = np.random.default_rng(seed)
    drawn = rng.integers(0, sizes.size, (RESAMPLES, sizes.size))

    def share(rows: NDArray[np.intp]) -> Floats:
        count = sizes[rows].sum(axis=-1)
        before = before_sums[rows].sum(axis=-1) / count - floor**2
        left = after_sums[rows].sum(axis=-1) / count - floor**2
        return 1.0 - left / np.maximum(before, 1e-300)

    if np.mean(np.square(gap)) <= floor**2:
        # There is nothing to close.
        return rms(after), 0.0, [0.0, 0.0]
    everything = float(share(np.arange(sizes.size)))
    # A bootstrap sample in which the gap is not above the noise says nothing about its share.
    interval = np.percentile(np.clip(share(drawn), min(-10.0, 2.0 * everything), 1.5), [5.0, 95.0])
    low, high = sorted((min(float(interval[0]), everything), max(float(interval[1]), everything)))
    return rms(after), everything, [low, high]
