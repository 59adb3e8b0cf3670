"""How precisely a recording determines the parameters of the effects that were found in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as student

from .evidence import Evidence, Hypothesis, Term, effect_columns, spans

__all__ = ["intervals", "told"]

Floats = NDArray[np.float64]
BLOCKS = 40
"""Stretches of the recording whose misfits are taken as independent."""
STEP = 0.01
"""Part of a shape, or of its bounds where it may have either sign, by which it is moved to see what it does."""
ALIKE = 1e-9
"""Eigenvalue of the normalised products below which parameters do the same."""
FAR = 1.5
"""Change of a scale's logarithm that the recording must contradict for the scale to be determined."""
CONTRADICTED = 3.0
"""Standard errors that this takes."""


@dataclass(frozen=True)
class _Fitted:
    """A fitted parameter: of one effect's coefficients, or the shape ``j`` of the term ``k``.

    ``slope`` (n,) is the change of all effects' torque with it, or with its logarithm where that is searched (``by_ratio``).
    """

    effect: str
    name: str
    value: float
    bounds: tuple[float, float]
    by_ratio: bool
    slope: Floats
    place: tuple[int, int]

    def interval(self, error: float) -> tuple[float, float]:
        wide = float(student.ppf(0.975, BLOCKS - 1)) * error
        ends = [self.moved(sign * wide) if self.by_ratio else self.value + sign * wide for sign in (-1.0, 1.0)]
        low, high = np.clip(sorted(ends), *self.bounds).tolist()
        return low, high

    def moved(self, ratio: float) -> float:
        """A scale whose logarithm changed by ``ratio``, within its bounds."""
        return float(np.clip(self.value * np.exp(min(ratio, 700.0)), *self.bounds))


def intervals(evidence: Evidence, hypothesis: Hypothesis) -> dict[str, dict[str, tuple[float, float] | None]]:
    """95 % intervals of the fitted parameters, by effect and name; None for what the recording does not determine.

    Least squares linearised at the fit, all parameters of all effects together and beside the refitted simulator, with
    the cluster-robust covariance of Liang and Zeger (Biometrika 73, 1986) over stretches of time: what is left over
    need not be white. Shapes that can have one sign only (lengths, times, limits) are scales: their intervals are
    symmetric in the logarithm, and they are determined if values far off are contradicted as well.
    """
    fitted = _parameters(evidence, hypothesis)
    if not fitted:
        return {}
    columns = np.column_stack([_seen(evidence, hypothesis, one.slope) for one in fitted])
    left = _seen(evidence, hypothesis, evidence.scene.signals.gap - hypothesis.signal)
    errors = _standard_errors(columns, left)

    def is_open(i: int) -> bool:
        """Whether a scale that is determined by its slope could as well be far off."""
        one = fitted[i]
        for end in (one.moved(-FAR), one.moved(FAR)):
            if abs(np.log(end / one.value)) < CONTRADICTED * errors[i]:
                continue
            far = evidence.fit(_with_shape(hypothesis.terms, one.place, end), (hypothesis.scale,))
            changed = _seen(evidence, hypothesis, far.signal - hypothesis.signal)
            if _standard_errors(changed[:, None], left)[0] > 1.0 / CONTRADICTED:
                return True
        return False

    found: dict[str, dict[str, tuple[float, float] | None]] = {one.effect: {} for one in fitted}
    for i, (one, error) in enumerate(zip(fitted, errors, strict=True)):
        lost = not np.isfinite(error) or (one.by_ratio and (error > FAR / CONTRADICTED or is_open(i)))
        found[one.effect][one.name] = None if lost else one.interval(error)
    return found


def told(interval: tuple[float, float] | None) -> str:
    """An interval in words, with as many digits as tell its ends apart."""
    if interval is None:
        return "not determined by this recording"
    low, high = interval
    wide = (high - low) / max(abs(low), abs(high), 1e-300)
    digits = int(np.clip(1.0 - np.floor(np.log10(max(wide, 1e-9))), 3, 6))
    return f"{low:.{digits}g} to {high:.{digits}g}"


def _parameters(evidence: Evidence, hypothesis: Hypothesis) -> list[_Fitted]:
    made: list[_Fitted] = []
    for k, (term, own) in enumerate(zip(hypothesis.terms, spans(hypothesis.terms), strict=True)):
        form = term.form
        for j, (name, bounds) in enumerate(
            zip(form.coefficients, zip(form.lower, form.upper, strict=True), strict=True)
        ):
            if bounds[0] < bounds[1]:
                at = own.start + j
                value, slope = float(hypothesis.coefficients[at]), _along(evidence, hypothesis, k, at)
                made.append(_Fitted(term.effect.id, name, value, bounds, False, slope, (k, -1)))
        shapes = zip(form.shapes, term.shape, form.limits, form.by_ratio, strict=True)
        for j, (name, value, bounds, by_ratio) in enumerate(shapes):
            step = STEP * (abs(value) if by_ratio else bounds[1] - bounds[0])
            low, high = (float(np.clip(value + sign * step, *bounds)) for sign in (-1.0, 1.0))
            slope = _torque(evidence, hypothesis, (k, j), high) - _torque(evidence, hypothesis, (k, j), low)
            slope *= (value if by_ratio else 1.0) / (high - low)
            made.append(_Fitted(term.effect.id, name, value, bounds, by_ratio, slope, (k, j)))
    return made


def _along(evidence: Evidence, hypothesis: Hypothesis, k: int, i: int) -> Floats:
    """How what all effects add changes with coefficient ``i``, one of term ``k``, shape (n,)."""
    value = hypothesis.coefficients[i]
    if hypothesis.terms[k].form.about is None or value == 0.0:
        return hypothesis.columns[:, i]
    ends = []
    for sign in (1.0, -1.0):
        moved = hypothesis.coefficients.copy()
        moved[i] = value * (1.0 + sign * STEP)
        ends.append(effect_columns(evidence.scene, hypothesis.terms, moved) @ moved)
    return np.asarray((ends[0] - ends[1]) / (2.0 * STEP * value))


def _torque(evidence: Evidence, hypothesis: Hypothesis, place: tuple[int, int], value: float) -> Floats:
    """What all effects add where one shape is ``value``, shape (n,)."""
    terms, guess = _with_shape(hypothesis.terms, place, value), hypothesis.coefficients
    return effect_columns(evidence.scene, terms, guess) @ guess


def _with_shape(terms: Sequence[Term], place: tuple[int, int], value: float) -> tuple[Term, ...]:
    """Terms of which one has another shape; ``place`` is the number of the term and the number of its shape."""
    k, j = place
    shape = (*terms[k].shape[:j], value, *terms[k].shape[j + 1 :])
    return (*terms[:k], replace(terms[k], shape=shape), *terms[k + 1 :])


def _seen(evidence: Evidence, hypothesis: Hypothesis, series: Floats) -> Floats:
    """``series`` (n,) where it counts, whitened for the freedom of the simulator's parameters."""
    return evidence.whitened(series[evidence.rows], hypothesis.scale)


def _standard_errors(columns: Floats, left: Floats) -> Floats:
    """Of the weights of ``columns`` (n, k) where ``left`` (n,) is left over, shape (k,); infinite where they do nothing or the same."""
    sizes = np.linalg.norm(columns, axis=0)
    acting = sizes > 1e-9 * max(float(sizes.max()), 1e-300)
    scaled = columns[:, acting] / sizes[acting]
    values, vectors = np.linalg.eigh(scaled.T @ scaled)
    alike = values < ALIKE
    inverse = (vectors[:, ~alike] / values[~alike]) @ vectors[:, ~alike].T
    starts = np.linspace(0, left.size, BLOCKS + 1).astype(int)[:-1]
    scores = np.add.reduceat(scaled * left[:, None], starts, axis=0)
    covariance = inverse @ (scores.T @ scores) @ inverse * BLOCKS / (BLOCKS - 1)
    error = np.sqrt(np.maximum(np.diag(covariance), 0.0)) / sizes[acting]
    error[np.any(np.abs(vectors[:, alike]) > 1e-3, axis=1)] = np.inf
    errors = np.full(sizes.size, np.inf)
    errors[acting] = error
    return errors
