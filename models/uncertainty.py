"""How well a recording determines a model's parameters: standard errors, and the names of those it does not tell.

The output is linearised in the parameters (numerically, whatever the model), the residual's variance and correlation give
the noise, and the covariance of the parameters follows from the normal equations (L. Ljung, System Identification, 2nd
ed., section 9.4). Correlated residuals count as fewer independent samples.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError

if TYPE_CHECKING:
    from .base import HysteresisModel

__all__ = ["Uncertainty", "effective_samples", "parameter_uncertainty"]

Floats = NDArray[np.float64]
STEP = 1e-5
"""Relative step of the numerical derivatives."""

BLIND = 1e-6
"""A direction in parameter space that changes the output less than this, relative to the strongest, is not determined."""


@dataclass(frozen=True)
class Uncertainty:
    """What a recording tells of a model's parameters.

    Attributes
    ----------
    standard_errors : dict of str to float
        By parameter, or element of one such as ``"weights[7]"``; infinite where the recording does not determine it.
    undetermined : list of str
        Those that the recording does not determine.
    effective_samples : float
        Independent samples that the correlated residual is worth.
    """

    standard_errors: dict[str, float]
    undetermined: list[str]
    effective_samples: float


def effective_samples(residual: Floats) -> float:
    """Independent samples that a residual of shape (n,) is worth: n / (1 + 2 Σ ρ_k) (initial positive sequence)."""
    centred = residual - residual.mean()
    power = float(centred @ centred)
    if power == 0.0:
        return float(residual.size)
    spectrum = np.abs(np.fft.rfft(centred, 2 * residual.size)) ** 2
    correlation = np.fft.irfft(spectrum)[: residual.size] / power
    # Geyer's rule: sums of neighbouring correlations are positive until only estimation noise is left.
    pairs = correlation[1:-1:2] + correlation[2::2]
    stop = int(np.argmax(pairs <= 0.0)) if np.any(pairs <= 0.0) else pairs.size
    return residual.size / max(1.0, 1.0 + 2.0 * float(pairs[:stop].sum()))


def parameter_uncertainty(
    model: HysteresisModel,
    x: ArrayLike,
    y: ArrayLike,
    groups: ArrayLike | None = None,
    *,
    time: ArrayLike | None = None,
) -> Uncertainty:
    """Standard errors of a fitted model's parameters on the recording that it was fitted to.

    Parameters
    ----------
    model : HysteresisModel
        Fitted.
    x, y : array_like, shape (n,)
    groups, time : array_like, shape (n,), optional
        As in ``fit``.

    Raises
    ------
    InputError
        If x and y differ in length, or the model has no parameters yet.
    """
    target = np.asarray(y, dtype=np.float64)
    options = {} if model.rate_independent else {"time": time}
    reference = model.predict(x, groups=groups, **options)
    if reference.shape != target.shape:
        raise InputError(f"x and y must have the same length; they have {reference.size} and {target.size}")
    labels, values, rebuild = model.coordinates()

    def output(moved: Floats) -> Floats:
        return type(model).from_parameters(**rebuild(moved)).predict(x, groups=groups, **options)

    columns = np.column_stack([_derivative(output, values, k, reference) for k in range(values.size)])
    residual = target - reference
    independent = effective_samples(residual)
    # Where misfit, not noise, correlates the residual, few samples are left; the correction for the fit is then bounded.
    spare = max(independent - values.size, 0.5 * independent)
    variance = float(residual @ residual) / residual.size * independent / spare
    errors, blind = _standard_errors(columns * np.sqrt(independent / residual.size), variance)
    return Uncertainty(
        dict(zip(labels, errors.tolist(), strict=True)),
        [label for label, lost in zip(labels, blind, strict=True) if lost],
        independent,
    )


def _derivative(output: Callable[[Floats], Floats], values: Floats, k: int, reference: Floats) -> Floats:
    """Change of the output with one parameter, shape (n,); zero where the parameter cannot be moved at all."""
    step = STEP * max(abs(float(values[k])), 1e-2 * float(np.max(np.abs(values))), 1e-12)
    slopes = []
    for signed in (step, -step):
        moved = values.copy()
        moved[k] += signed
        try:
            slopes.append((output(moved) - reference) / signed)
        except InputError:
            # At the edge of what is allowed only one side can be seen.
            continue
    return np.mean(slopes, axis=0) if slopes else np.zeros_like(reference)


def _standard_errors(columns: Floats, variance: float) -> tuple[Floats, NDArray[np.bool_]]:
    """Standard errors by column, and which columns the data do not determine."""
    sizes = np.sqrt(np.sum(columns**2, axis=0))
    moved = sizes > 0.0
    scaled = columns / np.where(moved, sizes, 1.0)
    _, singular, directions = np.linalg.svd(scaled, full_matrices=False)
    known = (
        singular > BLIND * singular[0] if singular.size and singular[0] > 0.0 else np.zeros(singular.size, dtype=bool)
    )
    # A parameter with a share in a blind direction can be exchanged for others without a trace in the output.
    blind = (np.sum(directions[~known] ** 2, axis=0) > 1e-4) | ~moved
    spread = np.sqrt(variance * np.sum((directions[known].T / singular[known]) ** 2, axis=1))
    return np.where(blind, np.inf, spread / np.where(moved, sizes, 1.0)), blind
