"""Where the gap lies: its energy shared out among coordinates that are correlated with each other.

Energy that an identified effect explains is shown at the coordinate of that effect: the effect's own signal finds it
far more surely than any map does. What is left is shared out by an additive model: a smooth function of each
coordinate, positions and directions crossed, and to each coordinate its Shapley value, the mean of what it adds to
every subset of the others (Lindeman, Merenda & Gold 1980; Owen, SIAM/ASA J. Uncertainty Quant. 2, 2014).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import factorial

import numpy as np
from numpy.typing import NDArray

from .recording.signals import COORDINATES, Signals

__all__ = ["Place", "locate", "profile"]

Floats = NDArray[np.float64]
KNOTS = 6
BLOCKS = 24
RESAMPLES = 12


@dataclass(frozen=True)
class Place:
    """A coordinate's share of the gap's energy, with a 90 % interval and the range that holds most of it."""

    coordinate: str
    share: float
    interval: tuple[float, float]
    range: tuple[float, float]


def _hats(values: Floats, count: int = KNOTS) -> Floats:
    """Piecewise linear functions on quantiles of ``values``, the mean taken out."""
    knots = np.unique(np.quantile(values, np.linspace(0.0, 1.0, count)))
    if knots.size < 2:
        return np.empty((values.size, 0))
    made = np.column_stack([np.interp(values, knots, row) for row in np.eye(knots.size)])
    return made[:, 1:]


def _basis(name: str, values: Floats, torque: Floats) -> Floats:
    """What a coordinate alone can explain; odd in the direction of motion as well as even."""
    if name == "direction":
        return values[:, None]
    smooth = _hats(values)
    # A mean over time, travel or load of what changes sign with the torque is nil: such coordinates modulate it.
    carrier = torque / max(float(np.std(torque)), 1e-300)
    if name in ("time", "travel", "amplitude", "distance_since_reversal") or name not in COORDINATES:
        return np.hstack([smooth, smooth * carrier[:, None]])
    return smooth


def locate(signals: Signals, explained: dict[str, Floats], floor: float, seed: int) -> list[Place]:
    """Share the gap's energy out among the coordinates, most important first.

    Parameters
    ----------
    explained : dict of str to array
        What identified effects add, by the coordinate where they show; each shape (n,).
    floor : float
        Standard deviation of the noise: its energy belongs to no coordinate.
    """
    rows = signals.judged
    explained = {name: part[rows] for name, part in explained.items()}
    gap = signals.gap[rows]
    rest = gap - sum(explained.values(), np.zeros_like(gap))
    coordinates = {name: values[rows] for name, values in signals.coordinates.items()}
    names = [name for name in coordinates if np.ptp(coordinates[name]) > 0.0]
    blocks = [_basis(name, coordinates[name], signals.y_sim[rows]) for name in names]
    widths = [block.shape[1] for block in blocks]
    ends = np.cumsum([1, *widths])
    design = np.hstack([np.ones((rest.size, 1)), *blocks, rest[:, None]])
    edges = np.linspace(0, rest.size, BLOCKS + 1).astype(int)
    grams = np.stack([design[a:b].T @ design[a:b] for a, b in pairwise(edges)])
    energies = {name: np.add.reduceat(np.square(part), edges[:-1]) for name, part in explained.items()}
    index = [np.arange(start, stop) for start, stop in pairwise(ends)]
    rng = np.random.default_rng(seed)

    def shares(rows: NDArray[np.intp], found: dict[str, float]) -> dict[str, float]:
        samples = float(np.diff(edges)[rows].sum())
        total = dict.fromkeys(names, 0.0)
        left = max(sum(found.values()), 0.0)
        # Noise that the functions happen to fit is no structure: take out its expected share.
        spurious = floor**2 * float(ends[-1])
        keep = max(left - spurious, 0.0) / left if left > 0.0 else 0.0
        for name in names:
            total[name] += keep * max(found[name], 0.0) / samples
        for name, sums in energies.items():
            total[name] = total.get(name, 0.0) + float(sums[rows].sum()) / samples
        everything = sum(total.values())
        return {name: value / everything if everything > 0.0 else 0.0 for name, value in total.items()}

    draws = [np.arange(BLOCKS), *(rng.integers(0, BLOCKS, BLOCKS) for _ in range(RESAMPLES))]
    values = _shapley(np.stack([grams[rows].sum(axis=0) for rows in draws]), index)
    whole, *drawn = (
        shares(rows, dict(zip(names, found.tolist(), strict=True))) for rows, found in zip(draws, values, strict=True)
    )
    made = []
    for name in sorted(whole, key=lambda n: -whole[n]):
        if whole[name] < 0.005:
            continue
        low, high = np.percentile([d[name] for d in drawn], [5.0, 95.0])
        made.append(Place(
            name, whole[name], (min(float(low), whole[name]), max(float(high), whole[name])),
            _range(coordinates[name], explained.get(name, gap)),
        ))  # fmt: skip
    return made


def _shapley(grams: Floats, index: Sequence[NDArray[np.intp]]) -> Floats:
    """Shapley values of the explained energy, shape (m, blocks), from the products of all columns, shape (m, k, k).

    The last column is the target; ``index`` are the columns of each block.
    """
    size, target = len(index), grams.shape[1] - 1
    scale = np.sqrt(np.maximum(np.einsum("mii->mi", grams), 1e-300))
    scaled = grams / (scale[:, :, None] * scale[:, None, :])
    energy = grams[:, target, target]
    worth = np.empty((1 << size, grams.shape[0]))
    for subset in range(1 << size):
        columns = np.concatenate([[0], *(index[k] for k in range(size) if subset >> k & 1)])
        part = scaled[:, columns[:, None], columns] + 1e-6 * np.eye(columns.size)
        moment = scaled[:, columns, target]
        worth[subset] = np.einsum("mi,mi->m", moment, np.linalg.solve(part, moment[:, :, None])[:, :, 0]) * energy
    found = np.zeros((grams.shape[0], size))
    for k in range(size):
        for subset in range(1 << size):
            if not subset >> k & 1:
                others = subset.bit_count()
                weight = factorial(others) * factorial(size - others - 1) / factorial(size)
                found[:, k] += weight * (worth[subset | 1 << k] - worth[subset])
    return found


def _range(values: Floats, signal: Floats) -> tuple[float, float]:
    """The shortest interval of a coordinate that holds nine tenths of a signal's energy."""
    order = np.argsort(values, kind="stable")
    running = np.cumsum(np.square(signal[order]))
    running /= max(float(running[-1]), 1e-300)
    starts = np.concatenate([[0.0], running[:-1]])
    stop = np.searchsorted(running, starts + 0.9 - 1e-12)
    fits = np.flatnonzero(stop < values.size)
    ordered = values[order]
    best = fits[np.argmin(ordered[stop[fits]] - ordered[fits])]
    return float(ordered[best]), float(ordered[stop[best]])


def profile(values: Floats, gap: Floats, bins: int = 24) -> tuple[Floats, Floats, Floats]:
    """Mean and RMS of ``gap`` along a coordinate, over equally filled bins or, where it has no more values than bins
    (a direction), over each value: the places, the means, the RMS values."""
    places = np.unique(values)
    if places.size > bins:
        edges = np.unique(np.quantile(values, np.linspace(0.0, 1.0, bins + 1)))
        which = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, edges.size - 2)
        places = 0.5 * (edges[1:] + edges[:-1])
    else:
        which = np.searchsorted(places, values)
    count = np.maximum(np.bincount(which, minlength=places.size), 1)
    means = np.bincount(which, gap, places.size) / count
    rms = np.sqrt(np.bincount(which, gap**2, places.size) / count)
    return places, means, rms
