"""The modified Prandtl-Ishlinskii model: play operators, then dead zones without memory; its inverse in closed form.

Source: K. Kuhnen, "Modeling, identification and compensation of complex hysteretic nonlinearities: a modified
Prandtl-Ishlinskii approach", European Journal of Control 9(4), 2003.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
from numba import njit

from ..errors import InputError
from .base import Condition, Floats, HysteresisModel, InverseError, Run, parameter_array, parameter_number
from .least_squares import blocks, nonnegative, reduced
from .motion import settled_from
from .prandtl_ishlinskii import PrandtlIshlinskii, _plays, _run
from .stepping import KernelStepper

__all__ = ["ModifiedPrandtlIshlinskii"]

ROUNDS = 30
"""Gauss-Newton steps at most."""


@njit(cache=True)
def _curve(h, edges, values):
    """The superposition of dead zones: a polyline whose end segments go on."""
    k = min(max(np.searchsorted(edges, h) - 1, 0), edges.size - 2)
    return values[k] + (h - edges[k]) * ((values[k + 1] - values[k]) / (edges[k + 1] - edges[k]))


@njit(cache=True)
def _map(h, edges, values, out):
    # From one sample to the next the segment mostly stays, or its neighbour follows.
    final = edges.size - 2
    k = 0
    slope = (values[1] - values[0]) / (edges[1] - edges[0])
    for i in range(h.size):
        at = h[i]
        moved = False
        while k < final and at > edges[k + 1]:
            k += 1
            moved = True
        while k > 0 and at <= edges[k]:
            k -= 1
            moved = True
        if moved:
            slope = (values[k + 1] - values[k]) / (edges[k + 1] - edges[k])
        out[i] = values[k] + (at - edges[k]) * slope


class ModifiedPrandtlIshlinskii(HysteresisModel):
    """Play operators and dead zones in series: ``y = offset + Σ v_j S_{s_j}(h)``, ``h = Σ w_i P_{r_i}[x]``.

    P_r is the play operator as in ``prandtl-ishlinskii``. S_s is the one-sided dead zone: S_s(h) = max(h − s, 0) for
    s > 0, min(h − s, 0) for s < 0, and h for s = 0. The dead zones make the loop asymmetric and let it stiffen or
    saturate. Both parts have an inverse of their own kind if all partial sums of their weights, from zero outwards, are
    positive; that admits negative weights, hence loops of either orientation.

    Parameters
    ----------
    operators : int
        Play operators; their thresholds divide half the input's range evenly.
    dead_zones : int
        Dead zones on each side of zero; their thresholds divide the range of h evenly.
    least_slope : float
        Smallest partial sum, as a fraction of the mean slope.

    Notes
    -----
    ``from_parameters`` takes ``weights`` (N,), ``thresholds`` (N,) increasing from 0, ``dead_zone_weights`` (M,),
    ``dead_zone_thresholds`` (M,) increasing with 0 among them, and optionally ``offset``.
    """

    id: ClassVar[str] = "modified-prandtl-ishlinskii"
    title: ClassVar[str] = "Modified Prandtl-Ishlinskii"
    summary: ClassVar[str] = (
        "play operators and dead zones in series, closed-form inverse; asymmetric and stiffening loops"
    )
    use_for: ClassVar[str] = (
        "asymmetric, stiffening or saturating loops with memory that still need an inverse in closed form"
    )
    not_for: ClassVar[str] = (
        "loops that change their shape with position (not only their slope), and rate-dependent force"
    )
    source: ClassVar[str] = "Kuhnen 2003"
    references: ClassVar[tuple[str, ...]] = ("kuhnen2003",)
    extended: ClassVar[bool] = True

    def __init__(self, operators: int = 30, dead_zones: int = 6, least_slope: float = 0.03) -> None:
        self.operators = operators
        self.dead_zones = dead_zones
        self.least_slope = least_slope

    # ---- identification --------------------------------------------------------------------------------------------

    def _identify(self, runs: Sequence[Run]) -> dict[str, Any]:
        if self.operators < 1 or self.dead_zones < 0:
            raise InputError("modified-prandtl-ishlinskii needs operators >= 1 and dead_zones >= 0")
        if not 0.0 < self.least_slope < 1.0:
            raise InputError(f"least_slope must lie between 0 and 1; it is {self.least_slope}")
        # Beyond half the largest range a play operator never moves back: its threshold could not be identified.
        reach = 0.5 * max(float(np.ptp(run.x)) for run in runs)
        thresholds = reach * np.arange(self.operators) / self.operators
        first = [settled_from(run.x) for run in runs]
        play = np.concatenate([_steps(run.x, thresholds)[k:] for run, k in zip(runs, first, strict=True)])
        target = np.concatenate([run.y[k:] for run, k in zip(runs, first, strict=True)])
        span = float(np.ptp(target))
        if span == 0.0:
            raise InputError("y is constant: the model has no inverse; give a recording in which the output moves")
        # In units in which input and output have the same range every slope is of order one.
        gain = float(np.ptp(play.sum(axis=1))) / span
        sums, edges, slopes, level = self._start(play / gain, target)
        sums, slopes, level = self._refine(play / gain, target, edges, sums, slopes, level)
        # Seen from zero outwards the weights of the dead zones are the changes of slope.
        below = int(np.searchsorted(edges, 0.0))
        changes = np.diff(slopes)
        changes[:below] *= -1.0
        if np.any(np.minimum(sums * gain, slopes.min()) <= 1.01 * self.least_slope):
            self.notes_.append("least_slope is reached: the best fit without that bound would have no inverse")
        return {
            "weights": np.diff(sums / gain, prepend=0.0),
            "thresholds": thresholds,
            "dead_zone_weights": np.insert(changes, below, slopes[below]),
            "dead_zone_thresholds": np.insert(edges, below, 0.0),
            "offset": level,
        }

    def _start(self, play: Floats, target: Floats) -> tuple[Floats, Floats, Floats, float]:
        """Kuhnen's quadratic programme: Σ W_k (P_k − P_{k+1}) against the inverse curve of the output, both linear."""
        segments = 2 * self.dead_zones + 1
        low, span = float(target.min()), float(np.ptp(target))
        marks = low + span * np.arange(segments + 1) / segments
        ways = np.clip(target[:, None] - marks[:-1], 0.0, span / segments)
        floor = self.least_slope
        bounded = play.shape[1] + segments

        def rows(part: slice) -> Floats:
            columns = np.hstack([play[part], -ways[part]])
            ones = np.ones(columns.shape[0])
            return np.column_stack([columns, ones, -ones, -floor * columns.sum(axis=1)])

        rotated = reduced(rows(part) for part in blocks(target.size))
        # The curve as a whole is to have slope 1: without that all weights would shrink to their bounds.
        fixed = np.zeros(bounded + 3)
        fixed[play.shape[1] : bounded] = 1.0
        fixed[-1] = (1.0 - floor) * segments
        rotated = np.vstack([rotated, 1e3 * np.linalg.norm(rotated) * fixed])
        found = nonnegative(rotated)
        inverse_slopes = found[play.shape[1] : bounded] + floor
        marks_h = np.concatenate([[0.0], np.cumsum(inverse_slopes)]) * span / segments - (found[-2] - found[-1])
        edges, slopes = marks_h[1:-1], 1.0 / inverse_slopes
        # A dead zone at zero is the identity, so an edge must not lie there.
        edges[edges == 0.0] = 1e-12 * span
        level = float(np.interp(0.0, marks_h, marks))
        return found[: play.shape[1]] + floor, edges, slopes, level

    def _refine(
        self, play: Floats, target: Floats, edges: Floats, sums: Floats, slopes: Floats, level: float
    ) -> tuple[Floats, Floats, float]:
        """Gauss-Newton on the error of the output within the bounds; the programme minimised the one of its inverse."""
        bounds = np.concatenate([[-np.inf], edges, [np.inf]])
        operators, size = sums.size, sums.size + slopes.size
        known = np.concatenate([sums, slopes, [level]])
        floor = np.full(size + 1, self.least_slope)
        floor[-1] = 0.0

        def ways(h: Floats) -> Floats:
            return np.clip(h[:, None], bounds[:-1], bounds[1:]) - np.clip(0.0, bounds[:-1], bounds[1:])

        def residuals(trial: Floats) -> tuple[Floats, Floats, Floats]:
            h = play @ trial[:operators]
            parts = ways(h)
            return target - parts @ trial[operators:size] - trial[-1], h, parts

        def linearised(at: Floats, error: Floats, h: Floats, parts: Floats, part: slice) -> Floats:
            slope = at[operators:size][np.searchsorted(edges, h[part])]
            ones = np.ones(slope.size)
            jacobian = np.column_stack([slope[:, None] * play[part], parts[part], ones])
            return np.column_stack([jacobian, -ones, error[part] + jacobian @ (at - floor)])

        error, h, parts = residuals(known)
        damping = 1e-6
        for _ in range(ROUNDS):
            rotated = reduced(linearised(known, error, h, parts, part) for part in blocks(h.size))
            better = False
            for _ in range(6):
                ridge = np.sqrt(damping * h.size) * np.eye(size + 1, size + 3)
                ridge[-1] = 0.0
                ridge[:size, -1] = ridge.diagonal()[:size] * (known - floor)[:size]
                found = nonnegative(np.vstack([rotated, ridge]))
                trial = np.append(found[:size], found[-2] - found[-1]) + floor
                moved = residuals(trial)
                if moved[0] @ moved[0] < error @ error:
                    better = True
                    break
                damping *= 10.0
            if not better:
                break
            gained = 1.0 - (moved[0] @ moved[0]) / (error @ error)
            known, (error, h, parts) = trial, moved
            damping = max(0.1 * damping, 1e-9)
            if gained < 1e-5:
                break
        return known[:operators], known[operators:size], float(known[-1])

    # ---- parameters ------------------------------------------------------------------------------------------------

    @classmethod
    def _check_parameters(
        cls, weights: Any, thresholds: Any, dead_zone_weights: Any, dead_zone_thresholds: Any, offset: Any = 0.0
    ) -> dict[str, Any]:
        play = PrandtlIshlinskii._check_parameters(weights, thresholds)
        zones = parameter_array("dead_zone_thresholds", dead_zone_thresholds, (None,))
        if np.any(np.diff(zones) <= 0.0) or not np.any(zones == 0.0):
            raise InputError("parameter dead_zone_thresholds must increase strictly with 0 among them")
        return {
            "weights": play["weights"],
            "thresholds": play["thresholds"],
            "dead_zone_weights": parameter_array("dead_zone_weights", dead_zone_weights, (zones.size,)),
            "dead_zone_thresholds": zones,
            "offset": parameter_number("offset", offset),
        }

    def _prepare(self) -> None:
        p = self.parameters_
        self._play = PrandtlIshlinskii.from_parameters(weights=p["weights"], thresholds=p["thresholds"])
        zones, weights = p["dead_zone_thresholds"], p["dead_zone_weights"]
        at = int(np.flatnonzero(zones == 0.0)[0])
        outwards = np.cumsum(weights[at:]), np.cumsum(weights[: at + 1][::-1])[::-1]
        self._slopes = np.concatenate([outwards[1], outwards[0][1:]])
        # The polyline through all edges and one point beyond each end, which fixes the end slopes.
        edges = np.delete(zones, at)
        reach = max(1.0, float(np.max(np.abs(zones))))
        edges = np.concatenate([[min(zones[0], -reach) - reach], edges, [max(zones[-1], reach) + reach]])
        values = np.concatenate([[0.0], np.cumsum(self._slopes * np.diff(edges))])
        segment = min(max(int(np.searchsorted(edges, 0.0)) - 1, 0), edges.size - 2)
        values += p["offset"] - values[segment] + edges[segment] * self._slopes[segment]
        self._edges, self._values = edges, values

    def _check_conditions(self) -> list[Condition]:
        slope = self._slopes.min()
        return [
            *self._play.conditions_,
            Condition(
                "every partial sum of the dead zones' weights is positive", bool(slope > 0.0), f"smallest {slope:.4g}"
            ),
        ]

    # ---- evaluation ------------------------------------------------------------------------------------------------

    def _predict_run(self, x: Floats) -> Floats:
        y = self._play._predict_run(x)
        _map(y, self._edges, self._values, y)
        return y

    def stepper(self) -> KernelStepper:
        self._require_fitted()
        play = self._play.stepper()
        inner = play._kernel
        edges, values = self._edges, self._values

        def kernel(x: float, state: Floats, params: Any, commit: bool) -> float:
            return float(_curve(inner(x, state, params, commit), edges, values))

        def run(x: Floats, state: Floats, params: Any, out: Floats) -> None:
            _run(x, state, params, out)
            _map(out, edges, values, out)

        return KernelStepper(kernel, play._initial_state, play._parameters, run)

    def _invert_run(self, y: Floats, x0: float, approximate: bool) -> Floats:
        bad = [condition for condition in self.conditions_ if not condition.holds]
        if bad:
            if approximate:
                return super()._invert_run(y, x0, approximate)
            raise InverseError(
                f"no inverse exists: not fulfilled is '{bad[0].name}' ({bad[0].detail}). "
                "Pass approximate=True (command line: --approximate) to take the nearest."
            )
        h = np.empty_like(y)
        _map(y, self._values, self._edges, h)
        return self._play._invert_run(h, x0, approximate)


def _steps(x: Floats, thresholds: Floats) -> Floats:
    """P_k − P_{k+1} (the last one: P_N) at every sample, shape (n, N): their coefficients are the partial sums."""
    play = np.empty((x.size, thresholds.size))
    _plays(x, thresholds, np.zeros(thresholds.size), play)
    play[:, :-1] -= play[:, 1:]
    return play
