"""A joint of a hardening spring and three sliders, moved by swelling tones, and recordings of it."""

from __future__ import annotations

import numpy as np
from joints import sliders
from motions import swelling
from numpy.typing import NDArray
from scipy.signal import lfilter

from hystbench.diagnosis.diagnosis import diagnose
from hystbench.diagnosis.recording.signals import Signals
from hystbench.diagnosis.result import Diagnosis

Floats = NDArray[np.float64]
NOISE = 0.012
STEP = 0.01
ELEMENTS = ((6.0, 0.12), (2.0, 0.15), (0.8, 0.16))


def spring(x: Floats) -> Floats:
    return 4.0 * x + 0.6 * x**3


def friction(x: Floats) -> Floats:
    return sliders(x, ELEMENTS)


def joint(x: Floats) -> Floats:
    return spring(x) + friction(x)


def lagged(u: Floats, tau: float) -> Floats:
    """``u`` (n,) behind a lag of the first order that was at rest, by the sample."""
    return np.asarray(lfilter([STEP / tau], [1.0, STEP / tau - 1.0], u))


TIME, X = swelling()
SPEED = np.gradient(X, TIME)
ACCELERATION = np.gradient(SPEED, TIME)
TRAVEL = np.cumsum(np.abs(np.diff(X, prepend=X[0])))
SIGN = np.tanh(SPEED / 0.02)


def signals(y_real: Floats, seed: int = 5, y_sim: Floats | None = None) -> Signals:
    noise = NOISE * np.random.default_rng(seed).standard_normal(X.size)
    return Signals(TIME, X, y_real + noise, joint(X) if y_sim is None else y_sim, [slice(0, X.size)], {})


def friction_that_is_off() -> Floats:
    """Each slider's stiffness and level by an error of its own."""
    return sliders(X, [(k * s, f * s) for (k, f), s in zip(ELEMENTS, (1.05, 0.96, 1.04), strict=True)])


def diagnosed(y_real: Floats, exclude: tuple[str, ...] = ()) -> Diagnosis:
    return diagnose(signals(y_real), exclude=exclude)
