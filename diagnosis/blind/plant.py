"""What every plant of the blind check is: a joint that can be driven along any motion, with a simulator beside it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from ..recording.signals import Signals

__all__ = ["BASE_ERROR", "Case", "Joint", "Made", "Plant", "Recorded", "Remade", "sized"]

Floats = NDArray[np.float64]
NOISE = 0.004
"""Standard deviation of the torque's noise over that of the torque."""
ENCODER_NOISE = 1e-4
"""Standard deviation of the deflection's noise over the reach."""
SMALLEST, LARGEST = 1e-4, 60.0
"""Sizes of an effect between which the one with the wanted gap is searched; 1 is typical."""
GUESS, CORRECTIONS, CLOSE = 0.04, 5, 0.02
BASE_ERROR = 0.04
"""Relative error of a badly calibrated simulator's parameters."""


@dataclass(frozen=True)
class Case:
    """What a blind recording is made of. Everything random follows from ``seed``."""

    plant: str
    effects: tuple[str, ...]
    ratio: float
    """RMS of each effect's gap over the torque noise."""
    base_error: float
    """Relative error of the simulator's parameters (standard deviation)."""
    motion: str
    seed: int
    excluded: tuple[str, ...] = ()


@dataclass(frozen=True)
class Recorded:
    """A recording and the simulator's output."""

    time: Floats
    x: Floats
    y_real: Floats
    y_sim: Floats

    @property
    def signals(self) -> Signals:
        """What the diagnosis may see."""
        return Signals(self.time, self.x, self.y_real, self.y_sim, [slice(0, self.x.size)], {})


@dataclass(frozen=True)
class Made(Recorded):
    """A recording, the simulator's output, and what only the scorer may see."""

    noise: float
    oracle_closed: float
    contributions: dict[str, Floats]


class Joint(Protocol):
    """One random design of a plant, its parameters absolute: the same joint whatever the motion.

    All arrays have shape (n,), in s, rad and N·m, sampled at equal intervals.
    """

    reach: float
    clean_input: bool
    """Whether the simulator is driven by the measured motion without the encoder's noise."""

    def real(self, time: Floats, x: Floats, sizes: Mapping[str, float]) -> tuple[Floats, Floats]:
        """Measured deflection and torque, free of noise, with effects of the given sizes."""
        ...

    def simulated(self, time: Floats, x: Floats) -> Floats:
        """The simulator's torque."""
        ...


class Remade:
    """A joint that is pickled without its cached properties: these are made again where they are asked for."""

    def __getstate__(self) -> dict[str, Any]:
        kind = type(self)
        return {k: v for k, v in vars(self).items() if not isinstance(getattr(kind, k, None), cached_property)}


@dataclass(frozen=True)
class Plant:
    """A joint with effects of fixed sizes, ready to be recorded along any motion."""

    joint: Joint
    sizes: Mapping[str, float]
    noise: float

    def record(self, time: Floats, x: Floats, rng: np.random.Generator) -> Made:
        """Drive the joint along ``x`` from rest, and keep what the scorer asks for."""
        measured, torque = self.joint.real(time, x, self.sizes)
        seen = self._sensed(time, x, measured, torque, rng)
        none = self.joint.real(time, x, {})[1]
        # The oracle adds the true effect to the very simulator that is given.
        truth = torque - self._base_at(time, x, measured, none)
        gap = seen.y_real - seen.y_sim
        floor = self.noise**2
        before, left = float(np.mean(np.square(gap))), float(np.mean(np.square(gap - truth)))
        oracle = 1.0 - (left - floor) / max(before - floor, 1e-300)
        alone = {name: self.contribution(time, x, name, none) for name in self.sizes}
        return Made(time, seen.x, seen.y_real, seen.y_sim, self.noise, oracle, alone)

    def drive(self, time: Floats, x: Floats, rng: np.random.Generator) -> Recorded:
        """The same recording alone, which takes much less."""
        return self._sensed(time, x, *self.joint.real(time, x, self.sizes), rng)

    def _sensed(self, time: Floats, x: Floats, measured: Floats, torque: Floats, rng: np.random.Generator) -> Recorded:
        seen = measured + ENCODER_NOISE * self.joint.reach * rng.standard_normal(x.size)
        y_real = torque + self.noise * rng.standard_normal(x.size)
        y_sim = self.joint.simulated(time, measured if self.joint.clean_input else seen)
        return Recorded(time, seen, y_real, y_sim)

    def contribution(self, time: Floats, x: Floats, name: str, none: Floats | None = None) -> Floats:
        """Gap that one effect would leave beside an exact simulator, N·m, shape (n,)."""
        return _alone(self.joint, time, x, name, self.sizes[name], none)

    def _base_at(self, time: Floats, x: Floats, measured: Floats, none: Floats) -> Floats:
        return none if np.array_equal(measured, x) else self.joint.real(time, measured, {})[1]


def _alone(joint: Joint, time: Floats, x: Floats, name: str, size: float, none: Floats | None = None) -> Floats:
    measured, torque = joint.real(time, x, {name: size})
    if none is not None and np.array_equal(measured, x):
        return torque - none
    return torque - joint.real(time, measured, {})[1]


def sized(joint: Joint, effects: tuple[str, ...], ratio: float, time: Floats, x: Floats) -> Plant:
    """Choose each effect's size such that its own gap along ``x`` has ``ratio`` times the noise's RMS."""
    none = joint.real(time, x, {})[1]
    noise = NOISE * float(np.std(none))

    def excess(log_size: float, name: str) -> float:
        gap = _alone(joint, time, x, name, float(np.exp(log_size)), none)
        return float(np.log(max(np.sqrt(np.mean(np.square(gap))), 1e-12) / (ratio * noise)))

    def size_of(name: str) -> float:
        # Most gaps grow about as the size does, so a few corrections by the ratio that is missed are enough.
        guess = float(np.log(GUESS * ratio))
        for _ in range(CORRECTIONS):
            missed = excess(guess, name)
            if abs(missed) < CLOSE:
                return float(np.exp(guess))
            guess = float(np.clip(guess - missed, np.log(SMALLEST), np.log(LARGEST)))
        return float(np.exp(brentq(excess, np.log(SMALLEST), np.log(LARGEST), args=(name,), xtol=CLOSE)))

    return Plant(joint, {name: size_of(name) for name in effects}, noise)
