"""The proposed Maxwell-slip model: polylines in virtual deformation joined by modified Maxwell-slip transitions.

Source: H. Qin, Z. Zhang, Z. Hou, L. Li, K. Liu, S. Bai, "Modeling and analysis of hysteresis using the Maxwell-slip
model for variable stiffness actuators", section 3 (Eqs. 2-17) and section 5.

Reading of the paper
--------------------
The major loop is an *upper* curve that rising motion follows and a *lower* curve that falling motion follows, both
polylines (Eqs. 8, 9), closed at both ends by the transitions P (Eq. 10, x >= 0) and Q (x < 0). Each transition is a
polyline because it is a sum of elements that stick and then slip one after another (Eqs. 2, 3, 16, 17); divided by its
length e_0 and height it gives the *shape* v(d/e), from 0 to 1, by which any transition proceeds over the distance d.

At a turning point the torque leaves its curve for the opposite one. With G the gap to that curve at the turning point
and e the distance at which a chord of the transition's mean slope k (Eq. 12) from the turning point meets it (Eqs. 11,
13, 14), the gap shrinks as G (1 − v(d/e)): Eq. 17's scaling of the elements by the deformation error e. For a straight
opposite curve and a straight shape this is the chord itself.

Where the opposite curve is at least as steep as the chord (the printed loop is, on DE and JK, against the condition
that the model inherits), the chord would never meet it: the gap then closes at the rate ``CLOSING`` k.

A turn inside a transition starts a path of the same shape back to the previous turning point (Eq. 15 updates turning
points only on the curves); passing that point resumes the interrupted path. So minor loops close, the memory wipes
out, and every path is a polyline whose inverse is the same path with its axes exchanged (section 5).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

from ..errors import InputError
from .base import Condition, Floats, HysteresisModel, InverseError, Run, parameter_array
from .motion import auto_dead_band, settled_from, turning_points
from .polyline import closed_loops, hat_basis
from .stepping import KernelStepper

__all__ = ["MaxwellSlip", "virtual_deformation"]

CLOSING = 0.05
"""Least rate at which a transition closes its gap, as a fraction of its mean slope."""

TIE = 0.02
"""Divisions of the loop whose training errors differ by less than this fraction count as equal."""

BINS = 512
"""Parts of equal width into which a polyline is divided to find a segment at once."""

OVERSHOOT = 0.01
"""A transition may pass the curve that it joins by this fraction of the gap (rounding, noise); the rest is an error."""

# State: stored turning points, last input, last output, last direction, started, gap and length of the base
# transition; then the turning points (x, y).
_COUNT, _X, _Y, _DIRECTION, _STARTED, _GAP, _LENGTH, _STACK = 0, 1, 2, 3, 4, 5, 6, 7


def virtual_deformation(theta: ArrayLike, l1: float, l3: float, x0: float) -> Floats:
    """Virtual deformation h(θ) of Eq. 6 for six branches (N = 6), in the units of length squared over length.

    Parameters
    ----------
    theta : array_like
        Deflection, rad.
    l1, l3, x0 : float
        Crank and following link length and preload elongation, in one unit of length.
    """
    theta = np.asarray(theta, dtype=np.float64)
    l2 = np.sqrt(l1**2 + l3**2 - 2.0 * l1 * l3 * np.cos(theta))
    return (12.0 * (l1 + l2 - l3) + x0) * l1 * l3 * np.sin(theta) / l2


def _initial_state(capacity: int) -> Floats:
    # Setting the whole stack to zero would take as long as a prediction.
    state = np.empty(_STACK + 2 * (capacity + 2))
    state[:_STACK] = 0.0
    return state


@njit(cache=True)
def _segment(x, vertices, k, first, final):
    """Index k with vertices[k] < x <= vertices[k + 1], within first .. final − 1; mostly the guess or its neighbour."""
    low = first
    high = final - 1
    k = min(max(k, low), high)
    if x > vertices[k + 1]:
        low = min(k + 1, high)
        k = low
    elif x <= vertices[k]:
        high = max(k - 1, low)
        k = high
    while low < high:
        if x > vertices[k + 1]:
            low = min(k + 1, high)
        elif x <= vertices[k]:
            high = max(k - 1, low)
        else:
            break
        k = (low + high) // 2
    return k


@njit(cache=True)
def _run(x, state, params, out):
    # The state is held in local variables meanwhile, and both curves (and both shapes) lie in one array: arrays chosen
    # or unpacked at each sample would cost many times as much. Bins of equal width lead to a polyline's segment.
    vx, vy, rates, lower_from, bins, bins_from, per_bin, sx, sy, closings, negative_from, shape_bins, slopes = params
    started = state[_STARTED] != 0.0
    n = int(state[_COUNT])
    last = state[_X]
    y = state[_Y]
    direction = state[_DIRECTION]
    gap = state[_GAP]
    total_length = state[_LENGTH]
    bins_each = bins.size // 2
    shape_bins_each = shape_bins.size // 2
    # The path: where it began, the turning point that it aims at, its height, and one over its length.
    at_x = 0.0
    at_y = 0.0
    aim = 0.0
    height = 0.0
    per_length = 0.0
    side = 0
    shape = 0
    known = False
    for i in range(x.size):
        now = x[i]
        if not started:
            # Midway between the curves, as the paper's start in A = G is on both.
            y = 0.0
            for first, final in ((0, lower_from - 1), (lower_from, vx.size - 1)):
                k = _segment(now, vx, first, first, final)
                y += 0.5 * (vy[k] + (now - vx[k]) * rates[k])
            started = True
            last = now
            n = 1
            state[_STACK] = now
            state[_STACK + 1] = y
            out[i] = y
            continue
        if now == last:
            out[i] = y
            continue
        towards = 1.0 if now > last else -1.0
        if towards != direction or not known or direction * (now - aim) >= 0.0:
            turned = False
            if towards != direction:
                if direction != 0.0:
                    state[_STACK + 2 * n] = last
                    state[_STACK + 2 * n + 1] = y
                    n += 1
                turned = n == 1
                direction = towards
            # Passing the turning point that the path aims at closes the minor loop and resumes the interrupted path.
            while n >= 2 and direction * (now - state[_STACK + 2 * n - 4]) >= 0.0:
                turned = n == 2
                n = max(n - 2, 1)
            side = 0 if direction > 0.0 else 1
            first, final = (0, lower_from - 1) if side == 0 else (lower_from, vx.size - 1)
            if n >= 1:
                at_x = state[_STACK + 2 * n - 2]
                at_y = state[_STACK + 2 * n - 1]
            shape = 0 if at_x >= 0.0 else 1
            if turned:
                # The base transition from the turning point to the curve ahead: its gap, and its length by Eqs. 11-14.
                k = _segment(at_x, vx, first, first, final)
                gap = direction * (vy[k] + (at_x - vx[k]) * rates[k] - at_y)
                total_length = 0.0
                if abs(gap) <= 1e-12 * (vy[final] - vy[first]):
                    gap = 0.0
                elif gap > 0.0:
                    left = gap
                    at = at_x
                    while True:
                        # A turning point on a vertex belongs to the segment ahead.
                        if direction > 0.0:
                            while k < final - 1 and at >= vx[k + 1]:
                                k += 1
                            end = vx[k + 1] if k < final - 1 else np.inf
                        else:
                            while k > first and at <= vx[k]:
                                k -= 1
                            end = vx[k] if k > first else -np.inf
                        rate = max(slopes[shape] - rates[k], CLOSING * slopes[shape])
                        stretch = abs(end - at)
                        if rate * stretch >= left:
                            total_length += left / rate
                            break
                        left -= rate * stretch
                        total_length += stretch
                        at = end
                else:
                    # The curves cross here (the printed ones do near H): approach from beyond, slowly enough to rise.
                    steepest = 0.0
                    for p in range(*((0, negative_from - 1) if shape == 0 else (negative_from, sx.size - 1))):
                        steepest = max(steepest, closings[p])
                    total_length = slopes[2 + shape]
                    gentlest = rates[k]
                    while True:
                        # Only the segments on the way count: a flat one elsewhere must not delay this transition.
                        needed = -2.0 * gap * steepest / gentlest
                        total_length = max(total_length, needed)
                        reached = gentlest
                        p = k
                        end = at_x + direction * total_length
                        while first <= p < final and direction * (end - vx[p if direction > 0.0 else p + 1]) > 0.0:
                            reached = min(reached, rates[p])
                            p += 1 if direction > 0.0 else -1
                        if reached == gentlest:
                            break
                        gentlest = reached
            if n >= 2:
                aim = state[_STACK + 2 * n - 4]
                height = state[_STACK + 2 * n - 3] - at_y
                per_length = 1.0 / abs(aim - at_x)
            else:
                aim = direction * np.inf
                per_length = 1.0 / total_length if total_length > 0.0 else 0.0
            known = True
        way = abs(now - at_x)
        if n == 1 and way >= total_length:
            n = 0
        closed = 0.0
        if n >= 1:
            u = min(way * per_length, 1.0)
            q = shape_bins[shape * shape_bins_each + min(int(u * shape_bins_each), shape_bins_each - 1)]
            q += int(u > sx[q + 1])
            while u > sx[q + 1]:
                q += 1
            closed = sy[q] + (u - sx[q]) * closings[q]
        if n >= 2:
            y = at_y + closed * height
        else:
            place = (now - bins_from[side]) * per_bin[side]
            k = bins[side * bins_each + int(min(max(place, 0.0), bins_each - 1.0))]
            final = lower_from - 1 if side == 0 else vx.size - 1
            k += int(k < final - 1 and now > vx[k + 1])
            while k < final - 1 and now > vx[k + 1]:
                k += 1
            y = vy[k] + (now - vx[k]) * rates[k]
            if n == 1:
                y -= direction * gap * (1.0 - closed)
        last = now
        out[i] = y
    state[_STARTED] = 1.0 if started else 0.0
    state[_COUNT] = n
    state[_X] = last
    state[_Y] = y
    state[_DIRECTION] = direction
    state[_GAP] = gap
    state[_LENGTH] = total_length


@njit(cache=True)
def _step(x, state, params, commit):
    one = np.full(1, x)
    _run(one, state if commit else state.copy(), params, one)
    return one[0]


@njit(cache=True)
def _next_vertex(state, params):
    """The next input, in the direction of motion, at which the current path bends (infinite where it never does)."""
    vx, _vy, _rates, lower_from, _bins, _from, _per_bin, sx, _sy, _closings, negative_from, _shape_bins, _slopes = (
        params
    )
    direction = state[_DIRECTION]
    x = state[_X]
    n = int(state[_COUNT])
    ahead = np.inf
    # A bend within rounding of the present input has been reached.
    reached = 1e-13 * (vx[lower_from - 1] - vx[0])
    if n <= 1:
        first, final = (0, lower_from - 1) if direction > 0.0 else (lower_from, vx.size - 1)
        # The end segments are continued, so the outer vertices are no bends.
        for k in range(first + 1, final):
            distance = direction * (vx[k] - x)
            if distance > reached:
                ahead = min(ahead, distance)
    if n >= 1:
        at_x = state[_STACK + 2 * n - 2]
        first, final = (0, negative_from - 1) if at_x >= 0.0 else (negative_from, sx.size - 1)
        length = state[_LENGTH] if n == 1 else abs(state[_STACK + 2 * n - 4] - at_x)
        for k in range(first + 1, final + 1 if n == 1 else final):
            distance = direction * (at_x - x) + sx[k] * length
            if distance > reached:
                ahead = min(ahead, distance)
    if n >= 2 and direction * (state[_STACK + 2 * n - 4] - x) <= ahead:
        # To the bit, for only from there on the interrupted path resumes.
        return state[_STACK + 2 * n - 4]
    return x + direction * ahead


@njit(cache=True)
def _invert(y, state, params, out, reach):
    """Follow the path from vertex to vertex and exchange its axes on the segment that holds the output.

    Returns the index of the first sample that could not be reached within ``reach``, or the number of samples.
    """
    for i in range(y.size):
        if i == 0:
            _step(out[0], state, params, True)
            continue
        target = y[i]
        while target != state[_Y]:
            direction = 1.0 if target > state[_Y] else -1.0
            x0, y0 = state[_X], state[_Y]
            if direction != state[_DIRECTION]:
                # A short move makes the turn, so that the new path's vertices are known.
                trial = state.copy()
                nudge = x0 + direction * 1e-9 * reach
                _step(nudge, trial, params, True)
                x1 = _next_vertex(trial, params)
                if x1 == nudge:
                    x1 = nudge + direction * 1e-9 * reach
            else:
                x1 = _next_vertex(state, params)
            if abs(x1) > reach:
                x1 = direction * reach
                if direction * (x1 - x0) <= 0.0:
                    return i
            if abs(x1 - x0) <= 1e-13 * reach:
                _step(x1, state, params, True)
                continue
            y1 = _step(x1, state.copy(), params, True)
            if direction * (y1 - y0) <= 0.0:
                return i
            if direction * (target - y1) >= 0.0:
                _step(x1, state, params, True)
                if state[_Y] == y1 and target == y1:
                    break
                continue
            x = x0 + (target - y0) * (x1 - x0) / (y1 - y0)
            if x == x0:
                break
            _step(x, state, params, True)
            break
        out[i] = state[_X]
    return y.size


class MaxwellSlip(HysteresisModel):
    """Polyline curves in virtual deformation joined by modified Maxwell-slip transitions.

    Parameters
    ----------
    vertices : int
        Vertices of each curve (the paper's tables have 6).
    elements : int
        Maxwell-slip elements of each transition (the paper's Table 2 has 4). The fit divides each branch into
        ``vertices − 1 + elements`` segments; how many of them are the transition is decided by the training error, and
        this number wins ties.
    geometry : tuple of float, optional
        (l1, l3, x0): the input is the deflection θ and is first mapped to the virtual deformation h(θ) of Eq. 6.
        None: the input is the virtual deformation itself.

    Notes
    -----
    ``from_parameters`` takes ``ascending`` (m, 2), ``descending`` (m, 2), ``transition_pos`` (N+1, 2) and
    ``transition_neg`` (N+1, 2): vertices (x, y) in any order, as Tables 1 and 2 print them, and optionally
    ``geometry`` (3,). A transition joins the ends of the two curves; it may continue the curve that motion follows
    towards the end (as the printed one does), or lie on the way back from it.
    """

    id: ClassVar[str] = "maxwell-slip"
    title: ClassVar[str] = "Maxwell-slip with virtual deformation"
    summary: ClassVar[str] = "the proposed model: polyline curves, Maxwell-slip transitions, exact inverse"
    use_for: ClassVar[str] = (
        "compliant joints whose measured loop has bends and different branches, with minor loops, where an exact "
        "inverse is needed for torque control"
    )
    not_for: ClassVar[str] = (
        "loops whose branches cross or bend back (it can only rise), force that follows speed, and a major loop "
        "that was never recorded: branches are read from it"
    )
    source: ClassVar[str] = "Qin et al., Eqs. 2-17 and section 5"
    references: ClassVar[tuple[str, ...]] = ("qin-maxwell-slip-vsa",)
    search_grid: ClassVar[Mapping[str, Sequence[Any]]] = {"vertices": (4, 6, 8), "elements": (2, 4)}

    def __init__(
        self, vertices: int = 6, elements: int = 4, geometry: tuple[float, float, float] | None = None
    ) -> None:
        self.vertices = vertices
        self.elements = elements
        self.geometry = geometry

    # ---- identification --------------------------------------------------------------------------------------------

    def _identify(self, runs: Sequence[Run]) -> dict[str, Any]:
        if self.vertices < 2 or self.elements < 1:
            raise InputError("maxwell-slip needs at least 2 vertices a curve and 1 element a transition")
        if self.geometry is not None:
            runs = [Run(virtual_deformation(run.x, *self.geometry), run.y) for run in runs]
        rising, falling = self._major_loop(runs)
        segments = self.vertices - 1 + self.elements
        try:
            loops = closed_loops(rising, falling, segments)
        except ValueError as error:
            raise InputError(
                f"the largest loop cannot be divided into {segments} segments a branch: {error}; "
                "give a longer recording or fewer vertices and elements"
            ) from None
        # The loop alone does not tell where transitions lie nor where they end: the motion within it does.
        counts = sorted(range(1, segments), key=lambda n: abs(n - self.elements))
        splits = [(ahead, n, loop) for n in counts for ahead in (True, False) for loop in loops]
        errors = [self._training_error(_assemble(*loop, n, ahead), runs) for ahead, n, loop in splits]
        span = max(float(np.ptp(run.y)) for run in runs)
        best = int(np.argmax(np.array(errors) <= min(errors) * (1.0 + TIE) + 1e-6 * span))
        ahead, elements, (upper, lower) = splits[best]
        other = min(error for (way, _, _), error in zip(splits, errors, strict=True) if way is not ahead)
        self.notes_.append(
            f"transitions of {elements} elements "
            + ("continue the curve towards each end, as in the paper" if ahead else "follow each turn")
            + f" (training RMSE {errors[best]:.3g}, the other way {other:.3g})"
        )
        parameters = _assemble(upper, lower, elements, ahead)
        if self.geometry is not None:
            parameters["geometry"] = self.geometry
        return parameters

    def _training_error(self, candidate: dict[str, Any], runs: Sequence[Run]) -> float:
        """RMSE of a division of the loop into curves and transitions; infinite where it is none."""
        trial = type(self)()
        try:
            trial._set_parameters(self._check_parameters(**candidate))
        except InputError:
            # The loop closes the other way: these vertices leave no gap for such a transition.
            return float("inf")
        residuals = [(trial._predict_run(run.x) - run.y)[settled_from(run.x) :] for run in runs]
        return float(np.sqrt(np.mean(np.concatenate(residuals) ** 2)))

    def _major_loop(self, runs: Sequence[Run]) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
        """Points of the largest half cycles, rising and falling."""
        halves: list[tuple[float, bool, Floats, Floats]] = []
        for run in runs:
            points = turning_points(run.x, auto_dead_band(run.x))
            # The first half cycle starts from an unknown memory; it serves only if there is no other.
            first = 1 if points.size > 3 else 0
            for start, stop in zip(points[first:-1], points[first + 1 :], strict=True):
                x, y = run.x[start : stop + 1], run.y[start : stop + 1]
                halves.append((abs(x[-1] - x[0]), bool(x[-1] > x[0]), x, y))
        branches = []
        for up in (True, False):
            spans = [span for span, rises, _, _ in halves if rises is up]
            if not spans:
                raise InputError(
                    f"the input never {'rises' if up else 'falls'}: a loop needs both; give a recording that turns"
                )
            chosen = [(x, y) for span, rises, x, y in halves if rises is up and span >= 0.97 * max(spans)]
            branches.append((np.concatenate([x for x, _ in chosen]), np.concatenate([y for _, y in chosen])))
        return branches[0], branches[1]

    # ---- parameters ------------------------------------------------------------------------------------------------

    @classmethod
    def _check_parameters(
        cls, ascending: Any, descending: Any, transition_pos: Any, transition_neg: Any, geometry: Any = None
    ) -> dict[str, Any]:
        curves = {
            "ascending": ascending,
            "descending": descending,
            "transition_pos": transition_pos,
            "transition_neg": transition_neg,
        }
        checked: dict[str, Any] = {}
        for name, value in curves.items():
            curve = parameter_array(name, value, (None, 2))
            if curve.shape[0] < 2:
                raise InputError(f"parameter {name} needs at least 2 vertices; it has {curve.shape[0]}")
            curve = curve[np.argsort(curve[:, 0], kind="stable")]
            if np.any(np.diff(curve, axis=0) <= 0.0):
                raise InputError(f"parameter {name}: x and y must both increase strictly from vertex to vertex")
            checked[name] = curve
        _join(checked, "transition_pos", top=True)
        _join(checked, "transition_neg", top=False)
        checked["geometry"] = None
        if geometry is not None:
            l1, l3, x0 = parameter_array("geometry", geometry, (3,))
            if not (0 < l1 < l3 and x0 >= 0):
                raise InputError("parameter geometry must be (l1, l3, x0) with 0 < l1 < l3 and x0 >= 0")
            checked["geometry"] = np.array([l1, l3, x0])
        return checked

    def _prepare(self) -> None:
        p = self.parameters_
        # A curve that a transition continues includes it; beyond the loop every curve goes on with its last slope,
        # but where a transition has closed the loop both go on along its mean slope and stay together.
        upper, lower = p["ascending"], p["descending"]
        shapes, slopes, lengths = [], [], []
        for name, top in (("transition_pos", True), ("transition_neg", False)):
            transition = p[name]
            length, height = transition[-1] - transition[0]
            mean_slope = height / length
            ahead = _join(p, name, top) == "ahead"
            outer = transition[-1] if top else transition[0]
            beyond = outer + (1.0 if top else -1.0) * np.array([length, height])
            if ahead:
                if top:
                    upper = np.vstack([upper, transition[1:], beyond])
                    lower = np.vstack([lower, beyond])
                    shape = (transition - transition[0]) / (transition[-1] - transition[0])
                else:
                    lower = np.vstack([beyond, transition[:-1], lower])
                    upper = np.vstack([beyond, upper])
                    shape = 1.0 - ((transition - transition[0]) / (transition[-1] - transition[0]))[::-1]
            else:
                curve = lower if top else upper
                (x1, y1), (x2, y2) = (curve[-2], curve[-1]) if top else (curve[0], curve[1])
                inner = curve[-1] if top else curve[0]
                continued = inner[1] + (y2 - y1) / (x2 - x1) * (transition[:, 0] - inner[0])
                gap = outer[1] - (continued[-1] if top else continued[0])
                if (gap if top else -gap) <= 1e-3 * height:
                    raise InputError(f"parameter {name} closes no gap between the continued curves")
                remaining = (transition[:, 1] - continued) / gap
                shape = np.column_stack([np.abs(transition[:, 0] - outer[0]) / length, 1.0 - remaining])
                if top:
                    shape = shape[::-1]
                closed = shape[:, 1].copy()
                shape[:, 1] = np.maximum.accumulate(np.clip(closed, 0.0, 1.0))
                if np.max(np.abs(shape[:, 1] - closed)) > OVERSHOOT:
                    raise InputError(f"parameter {name} must approach the continued curve from vertex to vertex")
                # Rising strictly, so that minor loops of this shape have an inverse.
                shape[:, 1] += 1e-6 * (shape[:, 0] - shape[:, 1])
            shape[0], shape[-1] = 0.0, 1.0
            shapes.append(np.ascontiguousarray(shape.T))
            slopes.append(mean_slope)
            lengths.append(length)
        self._curves = (*upper.T, *lower.T)
        self._slopes = np.array([*slopes, *lengths])
        curves = [np.ascontiguousarray(curve.T) for curve in (upper, lower)]
        self._params = (
            *_polylines(curves),
            upper.shape[0],
            np.concatenate([_bins(curve[0], place) for curve, place in zip(curves, (0, upper.shape[0]), strict=True)]),
            np.array([curve[0, 0] for curve in curves]),
            np.array([BINS / np.ptp(curve[0]) for curve in curves]),
            *_polylines(shapes),
            shapes[0].shape[1],
            np.concatenate(
                [_bins(shape[0], place) for shape, place in zip(shapes, (0, shapes[0].shape[1]), strict=True)]
            ),
            self._slopes,
        )

    def _check_conditions(self) -> list[Condition]:
        """The conditions of the model's ancestor (second source paper, Eqs. 14, 19, 20) on these curves."""
        upper_x, upper_y, lower_x, lower_y = self._curves
        slopes = self._slopes
        grid = np.union1d(upper_x, lower_x)
        ends = [self.parameters_[name][row, 0] for name in ("ascending", "descending") for row in (0, -1)]
        inside = grid[(grid >= min(ends)) & (grid <= max(ends))]
        gap = np.interp(inside, upper_x, upper_y) - np.interp(inside, lower_x, lower_y)
        conditions = [
            Condition(
                "the ascending curve lies above the descending one",
                bool(np.all(gap >= -1e-9 * np.ptp(upper_y))),
                f"smallest gap {gap.min():.4g} at x = {inside[np.argmin(gap)]:.4g}",
            )
        ]
        for name, sign, slope in (("k+", 1.0, slopes[0]), ("k-", -1.0, slopes[1])):
            steepest = 0.0
            for curve in (self.parameters_["ascending"], self.parameters_["descending"]):
                side = np.maximum(sign * curve[1:, 0], sign * curve[:-1, 0]) > 0.0
                rates = (np.diff(curve[:, 1]) / np.diff(curve[:, 0]))[side]
                steepest = max(steepest, float(rates.max(initial=0.0)))
            conditions.append(
                Condition(
                    f"the transition slope {name} exceeds every slope of the curves on its side",
                    bool(slope > steepest),
                    f"{name} = {slope:.4g}, steepest segment {steepest:.4g}",
                )
            )
        return conditions

    def coordinates(self) -> tuple[list[str], Floats, Callable[[Floats], dict[str, Any]]]:
        """The loop's distinct vertices: transitions share theirs with the curves that they join."""
        names = ("ascending", "descending", "transition_pos", "transition_neg")
        sizes = [self.parameters_[name].shape[0] for name in names]
        vertices, places = np.unique(np.vstack([self.parameters_[n] for n in names]), axis=0, return_inverse=True)
        labels = [f"vertex ({x:.4g}, {y:.4g}) {axis}" for x, y in vertices.tolist() for axis in "xy"]

        def rebuild(values: Floats) -> dict[str, Any]:
            moved = values.reshape(-1, 2)[places.ravel()]
            parameters = dict(zip(names, np.split(moved, np.cumsum(sizes)[:-1]), strict=True))
            geometry = self.parameters_["geometry"]
            return parameters if geometry is None else parameters | {"geometry": geometry}

        return labels, vertices.ravel(), rebuild

    # ---- evaluation ------------------------------------------------------------------------------------------------

    def _map(self, x: Floats) -> Floats:
        geometry = self.parameters_["geometry"]
        return x if geometry is None else virtual_deformation(x, *geometry)

    def _predict_run(self, x: Floats) -> Floats:
        y = np.empty_like(x)
        _run(self._map(x), _initial_state(x.size), self._params, y)
        return y

    def stepper(self) -> KernelStepper:
        self._require_fitted()
        geometry = self.parameters_["geometry"]
        if geometry is None:
            return KernelStepper(_step, _initial_state, self._params, _run)

        def kernel(x: float, state: Floats, params: Any, commit: bool) -> float:
            return float(_step(float(virtual_deformation(x, *geometry)), state, params, commit))

        def run(x: Floats, state: Floats, params: Any, out: Floats) -> None:
            _run(virtual_deformation(x, *geometry), state, params, out)

        return KernelStepper(kernel, _initial_state, self._params, run)

    def _invert_run(self, y: Floats, x0: float, approximate: bool) -> Floats:
        upper_x, upper_y, lower_x, lower_y = self._curves
        reach = 4.0 * max(abs(upper_x[0]), abs(upper_x[-1]))
        # The first sample lies midway between the curves, which both rise: exchange the axes of the middle curve.
        grid = np.union1d(np.union1d(upper_x, lower_x), [-reach, reach])
        middle = 0.5 * (_extended(grid, upper_x, upper_y) + _extended(grid, lower_x, lower_y))
        out = np.empty_like(y)
        out[0] = np.interp(y[0], middle, grid)
        # Each sample can close a loop and open another, and a vertex in between is a sample of its own.
        capacity = y.size * (upper_x.size + lower_x.size + 8)
        missed = _invert(y, _initial_state(min(capacity, 2 * y.size + 64)), self._params, out, reach)
        if missed < y.size or not middle[0] <= y[0] <= middle[-1]:
            if approximate:
                return super()._invert_run(y, x0, approximate)
            raise InverseError(
                f"no input within {-reach:.4g} .. {reach:.4g} gives the output y[{missed % y.size}] = "
                f"{y[missed % y.size]:.6g}; pass approximate=True (command line: --approximate) to take the nearest"
            )
        geometry = self.parameters_["geometry"]
        return out if geometry is None else _deflection(out, *geometry)


def _polylines(pair: Sequence[Floats]) -> tuple[Floats, Floats, Floats]:
    """Two polylines (2, m) end to end: x, y, and each segment's slope (none where one ends and the other begins)."""
    x, y = np.hstack(pair)
    with np.errstate(divide="ignore", invalid="ignore"):
        return x, y, np.append(np.diff(y) / np.diff(x), 0.0)


def _bins(x: Floats, place: int) -> NDArray[np.int64]:
    """For each of ``BINS`` parts of equal width the segment in which it begins, counted from ``place``."""
    begin = x[0] + np.ptp(x) * np.arange(BINS) / BINS
    return place + np.clip(np.searchsorted(x, begin, side="right") - 1, 0, x.size - 2)


def _extended(x: Floats, curve_x: Floats, curve_y: Floats) -> Floats:
    return hat_basis(x, curve_x) @ curve_y


def _deflection(h: Floats, l1: float, l3: float, x0: float) -> Floats:
    """The deflection whose virtual deformation is ``h`` (Eq. 6 solved for θ), on the rising range about zero."""
    grid = np.linspace(0.0, np.pi, 2001)
    values = virtual_deformation(grid, l1, l3, x0)
    top = int(np.argmax(np.diff(values) <= 0.0)) or grid.size - 1
    beyond = np.flatnonzero(np.abs(h) > values[top])
    if beyond.size:
        raise InverseError(
            f"no deflection has the virtual deformation {h[beyond[0]]:.6g} at sample {beyond[0]}: "
            f"the largest is {values[top]:.6g}, at {grid[top]:.4g} rad"
        )

    def gap(theta: float, wanted: float) -> float:
        return float(virtual_deformation(theta, l1, l3, x0)) - wanted

    return np.array([np.sign(v) * brentq(gap, 0.0, grid[top], args=(abs(v),), xtol=1e-14) for v in h])


def _join(curves: dict[str, Any], name: str, top: bool) -> str:
    """Where a transition lies: ``"ahead"`` continues the curve that motion follows towards the end, ``"behind"`` is the
    way back from it."""
    transition = curves[name]
    towards, back = ("ascending", "descending") if top else ("descending", "ascending")
    inner, outer = (transition[0], transition[-1]) if top else (transition[-1], transition[0])
    end = {key: curves[key][-1 if top else 0] for key in (towards, back)}
    near = 1e-9 * np.maximum(np.ptp(curves["ascending"], axis=0), np.ptp(curves["descending"], axis=0))
    if np.all(np.abs(inner - end[towards]) <= near) and np.all(np.abs(outer - end[back]) <= near):
        return "ahead"
    if np.all(np.abs(inner - end[back]) <= near) and np.all(np.abs(outer - end[towards]) <= near):
        return "behind"
    raise InputError(
        f"parameter {name} must join the {'upper' if top else 'lower'} ends of the ascending and descending curves; "
        f"it runs from {transition[0].tolist()} to {transition[-1].tolist()}, they end at "
        f"{curves['ascending'][-1 if top else 0].tolist()} and {curves['descending'][-1 if top else 0].tolist()}"
    )


def _assemble(upper: Floats, lower: Floats, elements: int, ahead: bool) -> dict[str, Any]:
    """Divide the two branches of the major loop into curves and transitions."""
    n = elements
    if ahead:
        return {
            "ascending": upper[:-n],
            "descending": lower[n:],
            "transition_pos": upper[-n - 1 :],
            "transition_neg": lower[: n + 1],
        }
    return {
        "ascending": upper[n:],
        "descending": lower[:-n],
        "transition_pos": lower[-n - 1 :],
        "transition_neg": upper[: n + 1],
    }
