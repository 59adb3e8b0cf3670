"""Derivatives of broken order: what a springpot, between a spring and a dashpot, makes of a motion."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.signal import fftconvolve

__all__ = ["fractional"]

Floats = NDArray[np.float64]


def fractional(time: Floats, series: Floats, order: float) -> Floats:
    """Derivative of ``order`` (0 to 1) of what ``series`` (n,) has gone since its start, shape (n,).

    Grünwald's and Letnikov's sum (Podlubny, Fractional Differential Equations, 1999, eq. 7.2) over the median interval of
    ``time`` (n,), s; where intervals differ it is interpolated.
    """
    step = float(np.median(np.diff(time)))
    clock = np.linspace(time[0], time[-1], max(round((time[-1] - time[0]) / step), 1) + 1)
    step = clock[1] - clock[0]
    passed = np.interp(clock, time, series) - series[0]
    k = np.arange(1, clock.size)
    weights = np.concatenate([[1.0], np.cumprod((k - 1.0 - order) / k)])
    return np.interp(time, clock, step**-order * fftconvolve(weights, passed)[: clock.size])
