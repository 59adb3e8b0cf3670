"""Noise and filtering as a condition: clean, noisy, Kalman-filtered and smoothed signals of one dataset.

Synthetic recordings are noise-free; white sensor noise of the dataset's stated deviation is added to input and output.
Recorded data carry their own noise. The Kalman filter is causal, with a constant-acceleration motion model; the
smoother runs backwards over it (Rauch-Tung-Striebel). Input and output go through filters of the same gain, because
a lag between them would open a loop that is not there.
"""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_discrete_are
from scipy.optimize import minimize_scalar

from ..datasets import Dataset, Recording
from ..models.motion import auto_dead_band, turning_points

__all__ = ["CONDITIONS", "Conditioned", "apply", "conditions_for", "tune"]

Floats = NDArray[np.float64]

CONDITIONS = {
    "clean": "the noise-free signals",
    "noisy": "white sensor noise on input and output",
    "recorded": "the signals as they were recorded",
    "kalman": "causal Kalman filter, constant acceleration",
    "smoothed": "Rauch-Tung-Striebel smoother on the same model",
}
ORDER = 3
"""States of the motion model: position, velocity, acceleration. 2 would be constant velocity."""

TUNING_SAMPLES = 4000
DIFFUSE = 1e4
"""Deviation of the first velocity and acceleration, in the sensor's deviations per sampling step."""


@dataclass(frozen=True)
class Conditioned:
    """A dataset as models see it under a condition.

    Attributes
    ----------
    train, test : list of Recording
        What the sensors (and the filter) give.
    truth : list of Recording
        What the test is scored against: the noise-free signals, or the recording itself.
    filter : dict of str to float
        ``x_noise_rms``, ``y_noise_rms`` (NaN where the truth is unknown), ``true_reversals``, ``false_reversals`` of
        the test input.
    """

    train: list[Recording]
    test: list[Recording]
    truth: list[Recording]
    filter: dict[str, float]


def conditions_for(dataset: Dataset) -> tuple[str, ...]:
    """The conditions that make sense for a dataset."""
    first = ("recorded",) if dataset.kind == "recorded" else ("clean", "noisy")
    return (*first, "kalman", "smoothed")


def apply(dataset: Dataset, condition: str, seed: int) -> Conditioned:
    """The dataset under a condition; the same arguments give the same samples on any machine and process.

    Raises
    ------
    ValueError
        If the condition does not apply to the dataset.
    """
    if condition not in conditions_for(dataset):
        raise ValueError(f"condition {condition!r} does not apply to {dataset.kind} data such as {dataset.id}")
    train, test = list(dataset.train), list(dataset.test)
    if dataset.kind == "synthetic" and condition != "clean":
        train = [_with_noise(r, dataset, seed, k) for k, r in enumerate(train)]
        test = [_with_noise(r, dataset, seed, len(train) + k) for k, r in enumerate(test)]
    if condition in ("kalman", "smoothed"):
        sigmas = (dataset.x_sigma, dataset.y_sigma)
        ratio = tune(train, sigmas)
        train = [_filtered(r, sigmas, ratio, condition == "smoothed") for r in train]
        test = [_filtered(r, sigmas, ratio, condition == "smoothed") for r in test]
    return Conditioned(train, test, list(dataset.test), _describe(dataset, test))


def _with_noise(recording: Recording, dataset: Dataset, seed: int, index: int) -> Recording:
    noisy = []
    for channel, (series, sigma) in enumerate(((recording.x, dataset.x_sigma), (recording.y, dataset.y_sigma))):
        generator = np.random.default_rng([seed, zlib.crc32(dataset.id.encode()), index, channel])
        noisy.append(series + sigma * generator.standard_normal(series.size))
    return replace(recording, x=noisy[0], y=noisy[1])


def _describe(dataset: Dataset, test: Sequence[Recording]) -> dict[str, float]:
    known = dataset.kind == "synthetic"
    true = seen = 0
    for mine, original in zip(test, dataset.test, strict=True):
        # The reversals of a recording are those that rise above its own noise.
        band = 0.0 if known else max(auto_dead_band(original.x), 8.0 * dataset.x_sigma)
        true += turning_points(original.x, band).size - 2
        seen += turning_points(mine.x).size - 2
    rms = [float("nan"), float("nan")]
    if known:
        for k, name in enumerate(("x", "y")):
            errors = [getattr(m, name) - getattr(o, name) for m, o in zip(test, dataset.test, strict=True)]
            rms[k] = float(np.sqrt(np.mean(np.concatenate(errors) ** 2)))
    return {
        "x_noise_rms": rms[0],
        "y_noise_rms": rms[1],
        "true_reversals": float(true),
        "false_reversals": float(seen - true),
    }


# ---- the filter ----------------------------------------------------------------------------------------------------


def _motion(step: float) -> tuple[Floats, Floats]:
    """Transition matrix and process noise of unit density of a chain of integrators over ``step`` seconds."""
    k = np.arange(ORDER)
    factorial = np.cumprod(np.concatenate([[1.0], np.arange(1.0, 2 * ORDER)]))
    lag = k[None, :] - k[:, None]
    transition = np.where(lag >= 0, step ** np.maximum(lag, 0) / factorial[np.maximum(lag, 0)], 0.0)
    power = ORDER - 1 - k
    total = power[:, None] + power[None, :] + 1
    noise = step**total / (total * factorial[power][:, None] * factorial[power][None, :])
    return transition, noise


def tune(recordings: Sequence[Recording], sigmas: tuple[float, float]) -> float:
    """Process noise density in units of the measurement variance, 1/s^(2 ORDER − 1), common to input and output.

    It maximises the likelihood of the innovations of the training recordings' first samples, with the measurement
    noise fixed at the sensors' deviations. The common ratio gives input and output the same gain.
    """
    # Processes whose cells need no filter are spared the import, which takes longer than many a cell.
    from scipy.signal import lfilter

    pieces = []
    for recording in recordings:
        step = float(np.median(np.diff(recording.time)))
        for series, sigma in zip((recording.x, recording.y), sigmas, strict=True):
            pieces.append((step, (series - series[0])[:TUNING_SAMPLES] / max(sigma, 1e-6 * np.ptp(series), 1e-300)))

    def cost(logarithm: float) -> float:
        total = 0.0
        gains: dict[float, tuple[Floats, Floats, float]] = {}
        for step, series in pieces:
            if step not in gains:
                gains[step] = _innovation_filter(step, 10.0**logarithm)
            numerator, denominator, variance = gains[step]
            innovations = lfilter(numerator, denominator, series)
            total += float(innovations @ innovations) / variance + series.size * float(np.log(variance))
        return total

    # In steps of the sampling the ratio spans from a frozen state to one that follows every sample.
    step = float(np.median([p[0] for p in pieces]))
    scale = (2 * ORDER - 1) * np.log10(1.0 / step)
    return float(10.0 ** minimize_scalar(cost, bounds=(scale - 12.0, scale + 3.0), method="bounded").x)


def _innovation_filter(step: float, ratio: float) -> tuple[Floats, Floats, float]:
    """The steady filter from measurements to innovations, for unit measurement variance, and their variance."""
    from scipy.signal import ss2tf

    transition, noise = _motion(step)
    # In steps as the unit of time the matrices are well scaled.
    scale = np.diag(step ** np.arange(ORDER))
    inverse = np.diag(step ** -np.arange(float(ORDER)))
    transition, noise = scale @ transition @ inverse, scale @ (ratio * noise) @ scale
    observe = np.eye(1, ORDER)
    covariance = solve_discrete_are(transition.T, observe.T, noise, np.eye(1))
    variance = float(covariance[0, 0] + 1.0)
    gain = transition @ covariance @ observe.T / variance
    numerator, denominator = ss2tf(transition - gain @ observe, gain, -observe, np.eye(1))
    return numerator[0], denominator, variance


def _filtered(recording: Recording, sigmas: tuple[float, float], ratio: float, smooth: bool) -> Recording:
    filtered = [
        _filter(recording.time, series, max(sigma, 1e-6 * float(np.ptp(series)), 1e-300), ratio, smooth)
        for series, sigma in zip((recording.x, recording.y), sigmas, strict=True)
    ]
    return replace(recording, x=filtered[0], y=filtered[1])


def _filter(time: Floats, series: Floats, sigma: float, ratio: float, smooth: bool) -> Floats:
    # Importing filterpy takes a second; only filtered conditions pay for it.
    from filterpy.kalman import KalmanFilter

    steps = np.diff(time, prepend=2.0 * time[0] - time[1])
    uniform = np.ptp(steps) <= 1e-6 * steps[0]
    step = float(np.median(steps))
    # Steps as the unit of time and the sensor's deviation as the unit of the signal keep the covariances well scaled.
    models = {}
    for length in [1.0] if uniform else np.unique(steps / step).tolist():
        transition, noise = _motion(length)
        models[length] = (transition, ratio * step ** (2 * ORDER - 1) * noise)
    chosen = [models[1.0]] * series.size if uniform else [models[length] for length in (steps / step).tolist()]
    transitions, noises = [m[0] for m in chosen], [m[1] for m in chosen]
    kalman = KalmanFilter(dim_x=ORDER, dim_z=1)
    kalman.H = np.eye(1, ORDER)
    kalman.R = np.eye(1)
    kalman.x = np.zeros((ORDER, 1))
    # Nothing is known of the first velocity and acceleration; a bound from the data would not be causal.
    kalman.P = np.diag([1.0, *([DIFFUSE**2] * (ORDER - 1))])
    scaled = (series - series[0]) / sigma
    means, covariances, _, _ = kalman.batch_filter(list(scaled), Fs=transitions, Qs=noises)
    if smooth:
        means = kalman.rts_smoother(means, covariances, Fs=transitions, Qs=noises)[0]
    return series[0] + sigma * np.ascontiguousarray(means[:, 0].reshape(-1))
