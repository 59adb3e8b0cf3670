"""Sample-by-sample evaluation, for real-time use and for the search inverse."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["ClockedStepper", "KernelStepper", "ReplayStepper", "Stepper", "TimedStepper"]


class Stepper:
    """Evaluates a model one sample at a time; what it gives equals ``predict``."""

    def step(self, x: float) -> float:
        """Move to the input ``x`` and return the output there."""
        raise TypeError(f"{type(self).__name__} does not define step")

    def peek(self, x: float) -> float:
        """The output that ``step(x)`` would return, without moving: trial and commit are kept apart."""
        raise TypeError(f"{type(self).__name__} does not define peek")

    def reset(self) -> None:
        """Return to the virgin state."""
        raise TypeError(f"{type(self).__name__} does not define reset")


class KernelStepper(Stepper):
    """Stepper around a compiled function ``kernel(x, state, parameters, commit) -> y``.

    Parameters
    ----------
    kernel:
        Advances ``state`` in place when ``commit`` is true; otherwise it must leave it as it is.
    initial_state:
        Returns the virgin state for a memory of at least the given number of reversals.
    parameters:
        Passed through to the kernel.
    """

    def __init__(
        self,
        kernel: Callable[[float, NDArray[np.float64], Any, bool], float],
        initial_state: Callable[[int], NDArray[np.float64]],
        parameters: Any,
    ) -> None:
        self._kernel = kernel
        self._initial_state = initial_state
        self._parameters = parameters
        self.reset()

    def reset(self) -> None:
        # A sample adds at most one reversal, so a state for 64 reversals holds 64 samples whatever they are.
        self._capacity = self._room = 64
        self._state = self._initial_state(self._capacity)

    def step(self, x: float) -> float:
        if self._room == 0:
            self._grow()
        self._room -= 1
        return self._kernel(x, self._state, self._parameters, True)

    def peek(self, x: float) -> float:
        return self._kernel(x, self._state, self._parameters, False)

    def _grow(self) -> None:
        self._room = self._capacity
        self._capacity *= 2
        larger = self._initial_state(self._capacity)
        larger[: self._state.size] = self._state
        self._state = larger


class TimedStepper(Stepper):
    """Stepper of a rate-dependent model around ``kernel(x, dt, state, parameters, commit) -> y``.

    ``dt`` is the time since the previous sample in s, 1 unless given, as in ``predict`` without times; at the first
    sample it has no meaning.
    """

    def __init__(
        self,
        kernel: Callable[[float, float, NDArray[np.float64], Any, bool], float],
        initial_state: Callable[[], NDArray[np.float64]],
        parameters: Any,
    ) -> None:
        self._kernel = kernel
        self._initial_state = initial_state
        self._parameters = parameters
        self.reset()

    def reset(self) -> None:
        self._state = self._initial_state()

    def step(self, x: float, dt: float = 1.0) -> float:
        return self._kernel(x, dt, self._state, self._parameters, True)

    def peek(self, x: float, dt: float = 1.0) -> float:
        return self._kernel(x, dt, self._state, self._parameters, False)


class ClockedStepper(Stepper):
    """A rate-dependent model's stepper with the sampling intervals given beforehand, for the search inverse."""

    def __init__(self, stepper: TimedStepper, intervals: NDArray[np.float64]) -> None:
        self._stepper = stepper
        # One more for a peek beyond the last sample.
        self._intervals = [*intervals.tolist(), float(intervals[-1])]
        self.reset()

    def reset(self) -> None:
        self._stepper.reset()
        self._k = 0

    def step(self, x: float) -> float:
        y = self._stepper.step(x, self._intervals[self._k])
        self._k += 1
        return y

    def peek(self, x: float) -> float:
        return self._stepper.peek(x, self._intervals[self._k])


class ReplayStepper(Stepper):
    """Stepper for models that only predict whole runs: it replays the history, so a step costs O(samples so far)."""

    def __init__(self, predict_run: Callable[[NDArray[np.float64]], NDArray[np.float64]]) -> None:
        self._predict_run = predict_run
        self.reset()

    def reset(self) -> None:
        self._history: list[float] = []

    def step(self, x: float) -> float:
        self._history.append(float(x))
        return float(self._predict_run(np.array(self._history))[-1])

    def peek(self, x: float) -> float:
        return float(self._predict_run(np.array([*self._history, float(x)]))[-1])
