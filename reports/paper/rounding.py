"""What rounded inputs allow a recomputed figure to be."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence

__all__ = ["half_step", "interval", "verdict"]


def half_step(decimals: int) -> float:
    """Half a unit of the last printed digit."""
    return 0.5 * 10.0**-decimals


def interval(function: Callable[..., float], values: Sequence[float], halves: Sequence[float]) -> tuple[float, float]:
    """Least and greatest ``function(*values)`` when each value may be off by its half step.

    Only the corners of the box are tried, which is exact for functions that are monotonic in every argument; sums,
    slopes and products of positive figures are.
    """
    corners = itertools.product(*((v - h, v + h) if h else (v,) for v, h in zip(values, halves, strict=True)))
    results = [function(*corner) for corner in corners]
    return min(results), max(results)


def verdict(printed: float, decimals: int, recomputed: float, allowed: tuple[float, float]) -> str:
    """``"exact"`` to the printed digit, ``"within rounding"`` of the printed inputs, or ``"contradicts"``."""
    # A figure on the edge of two roundings (2.24165 to four digits) may be printed either way.
    half = half_step(decimals) * (1.0 + 1e-6)
    if abs(recomputed - printed) <= half:
        return "exact"
    return "within rounding" if allowed[0] - half <= printed <= allowed[1] + half else "contradicts"
