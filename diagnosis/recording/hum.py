"""Whether what passes for noise is a hum: electrical, or of a pump or fan, often aliased."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter
from scipy.signal import welch

from .signals import Signals

__all__ = ["hum"]

Floats = NDArray[np.float64]
SEGMENT = 512
"""Samples of a stretch whose spectrum is taken; a hum that wanders stays within one of its lines."""
NEIGHBOURS = 31
STANDS_OUT = 20.0
"""Power density over the neighbours' median at which a line is more than noise; of eight stretches it stays below five."""
FEWEST = 8
MOST = 0.3
"""Share of the gap's energy that the line must have."""


def hum(signals: Signals) -> float:
    """Frequency (Hz) of a narrow line that makes up much of the gap; 0 if there is none.

    Noise is told from structure by how little it lasts, so a fast hum passes for noise. Noise has no lines, though
    (periodogram averaged over segments: Welch, IEEE Trans. Audio Electroacoust. 15, 1967).
    """
    spectra, weights = [], []
    for run in signals.runs:
        size = run.stop - run.start
        if size < FEWEST * SEGMENT // 2:
            continue
        frequencies, density = welch(signals.gap[run], 1.0 / signals.interval, nperseg=SEGMENT)
        spectra.append(density)
        weights.append(size)
    if not spectra:
        return 0.0
    density = np.average(spectra, axis=0, weights=weights)[2:]
    # Nothing comes after the fastest line: its neighbours are those before it. Slow structure, at the other end, is its own.
    beyond = np.concatenate([density, density[-2 : -2 - NEIGHBOURS // 2 : -1]])
    ratio = density / np.maximum(median_filter(beyond, NEIGHBOURS, mode="nearest")[: density.size], 1e-300)
    k = int(np.argmax(ratio))
    line = density[max(k - 3, 0) : k + 4]
    return float(frequencies[k + 2]) if ratio[k] > STANDS_OUT and line.sum() > MOST * density.sum() else 0.0
