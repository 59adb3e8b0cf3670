"""What a model is given beside its series: the sample times, if it has a use for them."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["interval_arguments", "time_argument"]


def time_argument(method: Callable[..., Any], time: NDArray[np.float64]) -> dict[str, Any]:
    """``{"time": time}`` for a bound method that takes it, of a model that does not call itself rate-independent."""
    if getattr(getattr(method, "__self__", None), "rate_independent", False):
        return {}
    return {"time": time} if "time" in inspect.signature(method).parameters else {}


def interval_arguments(step: Callable[..., Any], time: NDArray[np.float64]) -> list[tuple[float, ...]]:
    """Further arguments of ``step`` at each sample: the time since the previous one where the stepper takes it."""
    if "dt" not in inspect.signature(step).parameters:
        return [()] * time.size
    # The first sample has no predecessor: its interval is not used.
    return [(float(interval),) for interval in np.diff(time, prepend=time[0])]
