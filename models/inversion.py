"""The inverse of any model with a stepper, by search along its own trajectory.

Trial (``peek``) and commit (``step``) of the memory are kept apart, so the search sees exactly the branch that the
model would take and ``predict(invert(y)) = y`` holds wherever the output is reached at all.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from .stepping import Stepper

__all__ = ["InverseError", "InverseStepper", "invert_by_search"]


class InverseError(ValueError):
    """No input gives the wanted output: the message says at which sample and why."""


# The search leaves the training range by at most this factor: beyond it a model only extrapolates.
REACH = 4.0
# Brackets grow from this fraction of the input scale.
FIRST_STEP = 1e-3
CANDIDATES = 16
SLACK = 0.02


class InverseStepper:
    """The inverse one sample at a time, for a control loop: ``step(y)`` returns the input whose output is ``y``.

    Parameters
    ----------
    stepper : Stepper
        Its ``peek`` is searched and its ``step`` called once a sample. It is reset first.
    x0 : float
        The first input is searched for from here outwards.
    scale : float
        Typical input amplitude: brackets start at a thousandth of it, and the search ends at four times of it.
    approximate : bool
        Where the output is not reached, take the input whose output is nearest instead of raising.
    """

    def __init__(self, stepper: Stepper, x0: float, scale: float, approximate: bool = False) -> None:
        self._stepper = stepper
        self._x0 = x0
        self._scale = scale
        self._approximate = approximate
        self._limit = REACH * max(scale, abs(x0), 1e-12)
        self.reset()

    def reset(self) -> None:
        """Return to the virgin state."""
        self._stepper.reset()
        self._samples = 0
        self._here = self._x0
        self._reached = self._stepper.peek(self._here)
        self._first_step = self._step = FIRST_STEP * self._scale
        ends = [self._stepper.peek(self._x0 + side * self._scale) for side in (-1.0, 1.0)]
        self._output_scale = max(abs(value) for value in (*ends, self._reached, 1e-300))

    def step(self, y: float) -> float:
        """Move to the input whose output is ``y`` and return it.

        Raises
        ------
        InverseError
            If there is none within the search range and ``approximate`` is false; the memory then stays as it was.
        """
        target = float(y)
        tolerance = 1e-9 * max(self._output_scale, abs(target))
        first = self._samples == 0
        found = _search(
            self._stepper, target, self._here, self._reached, self._step, self._limit, tolerance, nearest=first
        )
        if found is None:
            if not self._approximate:
                _, error = _nearest(self._stepper, target, self._here, self._step, self._limit)
                raise InverseError(
                    f"no input gives the output y[{self._samples}] = {target:.6g}: from x = {self._here:.6g} the model "
                    f"reaches it nowhere within {-self._limit:.4g} .. {self._limit:.4g}; the nearest output is off by "
                    f"{error:.3g}. Pass approximate=True (command line: --approximate) to take the nearest."
                )
            # An answer that is not exact is not worth leaving the range of the training data.
            found, _ = _nearest(self._stepper, target, self._here, self._step, max(self._scale, abs(self._x0)))
        if not first:
            self._step = max(self._first_step, abs(found - self._here))
        self._samples += 1
        self._here = found
        self._reached = self._stepper.step(found)
        return found


def invert_by_search(
    stepper: Stepper, y: NDArray[np.float64], x0: float, scale: float, approximate: bool
) -> NDArray[np.float64]:
    """Inputs whose outputs are ``y``, shape (n,), from the stepper's virgin state; see :class:`InverseStepper`.

    Raises
    ------
    InverseError
        If some output is not reached within the search range and ``approximate`` is false.
    """
    inverse = InverseStepper(stepper, x0, scale, approximate)
    return np.array([inverse.step(target) for target in y.tolist()])


def _search(
    stepper: Stepper,
    target: float,
    here: float,
    reached: float,
    step: float,
    limit: float,
    tolerance: float,
    nearest: bool,
) -> float | None:
    """The input that gives ``target``, in the likelier direction or the nearest of both; None if there is none."""
    gap = target - reached
    if abs(gap) <= tolerance * 1e-3:
        return here
    # Outputs normally rise with the input; only where that side fails can the other one hold the answer.
    best: float | None = None
    for sign in (1.0, -1.0) if gap > 0 else (-1.0, 1.0):
        found = _search_side(stepper, target, here, gap, sign, step, limit, tolerance)
        if found is None:
            continue
        if not nearest:
            return found
        if best is None or abs(found - here) < abs(best - here):
            best = found
    return best


def _search_side(
    stepper: Stepper, target: float, here: float, gap: float, sign: float, step: float, limit: float, tolerance: float
) -> float | None:
    """The first input on one side that gives ``target``, in brackets of doubling length; None if there is none."""
    inner, inner_gap = here, gap
    reach = step
    while True:
        outer = here + sign * reach
        if abs(outer) > limit:
            outer = sign * limit
            if sign * (outer - inner) <= 0:
                return None
        outer_gap = target - stepper.peek(outer)
        if abs(outer_gap) <= tolerance * 1e-3:
            return outer
        if (outer_gap > 0) != (inner_gap > 0):
            root = _bisect(stepper, target, inner, outer)
            # A sign change can also be a jump (a branch switch at a turn): then nothing was found here.
            if abs(target - stepper.peek(root)) <= tolerance:
                return root
        inner, inner_gap = outer, outer_gap
        if abs(outer) >= limit:
            return None
        reach *= 2.0


def _bisect(stepper: Stepper, target: float, inner: float, outer: float) -> float:
    def gap(x: float) -> float:
        return stepper.peek(x) - target

    low, high = gap(inner), gap(outer)
    # At the point where the motion turns, peek may see the branch of the old direction: look just beyond it.
    if (low > 0) == (high > 0):
        inner = inner + (outer - inner) * 1e-9
        low = gap(inner)
        if (low > 0) == (high > 0):
            return outer
    return float(brentq(gap, inner, outer, xtol=1e-15 * max(1.0, abs(inner)), rtol=8.9e-16, maxiter=200))


def _nearest(stepper: Stepper, target: float, here: float, step: float, limit: float) -> tuple[float, float]:
    """The input within ``limit`` whose output is nearest to ``target``; and its error.

    Of outputs that are about as near the one with the least motion wins: a saturated model must not be driven to the
    end of its range for the last thousandth.
    """
    reaches = np.geomspace(step, 2.0 * limit, CANDIDATES)
    candidates = np.concatenate([[here], here + reaches, here - reaches])
    candidates = candidates[np.abs(candidates) <= max(limit, abs(here))]
    outputs = np.array([stepper.peek(float(c)) for c in candidates])
    errors = np.abs(outputs - target)
    # About as near: measured by the least error, but never by more than what the model can do at all.
    enough = np.flatnonzero(errors <= errors.min() + SLACK * min(errors.min(), float(np.ptp(outputs))))
    chosen = int(enough[np.argmin(np.abs(candidates[enough] - here))])
    return float(candidates[chosen]), float(errors[chosen])
