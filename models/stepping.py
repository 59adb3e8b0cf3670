"""Sample-by-sample evaluation, for real-time use and for the search inverse."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError

__all__ = ["ClockedStepper", "KernelStepper", "ReplayStepper", "Stepper", "TimedStepper"]

Floats = NDArray[np.float64]


def _block(x: ArrayLike) -> Floats:
    if np.iscomplexobj(x):
        raise InputError("a block of inputs must be real; it is complex")
    try:
        block = np.ascontiguousarray(x, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError("a block of inputs must hold numbers; it does not") from None
    if np.ndim(x) != 1 or not np.all(np.isfinite(block)):
        raise InputError(f"a block of inputs must be one row of finite numbers; this has shape {np.shape(x)}")
    return block


class Stepper:
    """Evaluates a model one sample at a time; what it gives equals ``predict``."""

    def step(self, x: float) -> float:
        """Move to the input ``x`` and return the output there."""
        raise TypeError(f"{type(self).__name__} does not define step")

    def steps(self, x: ArrayLike) -> Floats:
        """Move through a block of inputs, shape (n,), and return the outputs, shape (n,).

        The next step or block goes on from there, so a recording of any length passes in bounded memory.

        Raises
        ------
        InputError
            If the block is not one row of finite numbers.
        """
        return np.array([self.step(value) for value in _block(x).tolist()])

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
        Where its size depends on that number, its first entry counts the reversals that are stored.
    parameters:
        Passed through to the kernel.
    run:
        The same for a block, ``run(x, state, parameters, out)``; without it a block is stepped through.
    """

    def __init__(
        self,
        kernel: Callable[[float, Floats, Any, bool], float],
        initial_state: Callable[[int], Floats],
        parameters: Any,
        run: Callable[[Floats, Floats, Any, Floats], object] | None = None,
    ) -> None:
        self._kernel = kernel
        self._initial_state = initial_state
        self._parameters = parameters
        self._run = run
        self._grows = initial_state(1).size < initial_state(2).size
        self.reset()

    def reset(self) -> None:
        # A sample adds at most one reversal, so a state for 64 reversals holds 64 samples whatever they are.
        self._capacity = self._room = 64
        self._state = self._initial_state(self._capacity)

    def step(self, x: float) -> float:
        if self._room == 0:
            self._make_room(1)
        self._room -= 1
        return self._kernel(x, self._state, self._parameters, True)

    def steps(self, x: ArrayLike) -> Floats:
        if self._run is None:
            return super().steps(x)
        x = _block(x)
        if self._room < x.size:
            self._make_room(x.size)
        self._room -= x.size
        out = np.empty_like(x)
        self._run(x, self._state, self._parameters, out)
        return out

    def peek(self, x: float) -> float:
        return self._kernel(x, self._state, self._parameters, False)

    def _make_room(self, samples: int) -> None:
        """Room for so many samples, each of which may add a reversal; those wiped out meanwhile have left theirs."""
        stored = int(self._state[0]) if self._grows else 0
        if stored + samples > self._capacity // 2:
            self._capacity = 2 * (stored + samples)
            if self._grows:
                larger = self._initial_state(self._capacity)
                larger[: self._state.size] = self._state
                self._state = larger
        self._room = self._capacity - stored


class TimedStepper(Stepper):
    """Stepper of a rate-dependent model around ``kernel(x, dt, state, parameters, commit) -> y``; ``run`` takes blocks.

    ``dt`` is the time since the previous sample in s, 1 unless given, as in ``predict`` without times; at the first
    sample it has no meaning.
    """

    def __init__(
        self,
        kernel: Callable[[float, float, Floats, Any, bool], float],
        initial_state: Callable[[], Floats],
        parameters: Any,
        run: Callable[[Floats, Floats, Floats, Any, Floats], object],
    ) -> None:
        self._kernel = kernel
        self._initial_state = initial_state
        self._parameters = parameters
        self._run = run
        self.reset()

    def reset(self) -> None:
        self._state = self._initial_state()

    def step(self, x: float, dt: float = 1.0) -> float:
        return self._kernel(x, dt, self._state, self._parameters, True)

    def steps(self, x: ArrayLike, dt: ArrayLike = 1.0) -> Floats:
        """As :meth:`Stepper.steps`; ``dt`` is the time since the sample before, s, one number or shape (n,)."""
        x = _block(x)
        out = np.empty_like(x)
        self._run(x, _block(np.broadcast_to(dt, x.shape)), self._state, self._parameters, out)
        return out

    def peek(self, x: float, dt: float = 1.0) -> float:
        return self._kernel(x, dt, self._state, self._parameters, False)


class ClockedStepper(Stepper):
    """A rate-dependent model's stepper with the sampling intervals given beforehand, for the search inverse."""

    def __init__(self, stepper: TimedStepper, intervals: Floats) -> None:
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

    def __init__(self, predict_run: Callable[[Floats], Floats]) -> None:
        self._predict_run = predict_run
        self.reset()

    def reset(self) -> None:
        self._history: list[float] = []

    def step(self, x: float) -> float:
        self._history.append(float(x))
        return float(self._predict_run(np.array(self._history))[-1])

    def peek(self, x: float) -> float:
        return float(self._predict_run(np.array([*self._history, float(x)]))[-1])
