"""The Preisach model: relays over a triangle of thresholds, evaluated through its Everett function.

Source: F. Preisach 1935; D. H. Everett 1955; I. D. Mayergoyz, "Mathematical models of hysteresis", Springer 1991.

With E(a, b) the total weight of the relays with alpha <= a and beta >= b, a rise from the turning point b to a changes
the output by 2 E(a, b), a fall from a to b by −2 E(a, b), and passing an earlier turning point wipes it out. So a
sample costs O(1) however many relays there are.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.optimize import linprog, nnls

from ..errors import InputError
from .base import Condition, Floats, HysteresisModel, Run, parameter_array, parameter_number
from .least_squares import blocks, reduced
from .motion import settled_from
from .stepping import KernelStepper

__all__ = ["Preisach"]

# State: number of stored turning points, last input, last output, last direction, started; then the points (x, y).
_COUNT, _X, _Y, _DIRECTION, _STARTED, _STACK = 0, 1, 2, 3, 4, 5

TABLE_LIMIT = 4_000_000
"""Entries of the Everett table (32 MB); relays with more distinct thresholds are refused."""

DISCRETE_SHARE = 0.5
"""Data whose output stands still in more than this share of the moves were made by relays."""

RELAY_LIMIT = 1000
"""Discrete relays to be identified at most; data with more thresholds are as well described by cells."""

RIDGE = 1e-3
"""Weight of the ridge beside that of the roughness, just enough to make the solution unique."""


def _initial_state(capacity: int) -> Floats:
    # Setting the whole stack to zero would take as long as a prediction.
    state = np.empty(_STACK + 2 * (capacity + 2))
    state[:_STACK] = 0.0
    return state


@njit(cache=True)
def _virgin(x, rise_at, rise, fall_at, fall, width):
    """Change of the output from the demagnetised state to ``x``, reached without turning."""
    if width == 0.0:
        return 2.0 * (rise[np.searchsorted(rise_at, x, side="right")] - fall[np.searchsorted(fall_at, x)])
    # rise and fall hold, for each cell from zero outwards, the sum so far and the linear and quadratic parts.
    away = abs(x) / width
    sums = rise if x >= 0.0 else fall
    cells = sums.size // 3
    # The bound comes first: a float beyond the integers has no meaningful int().
    k = int(min(away, cells - 1.0))
    f = min(away - k, 1.0)
    change = 2.0 * (sums[3 * k] + f * sums[3 * k + 1] + f * f * sums[3 * k + 2])
    return change if x >= 0.0 else -change


@njit(cache=True)
def _run(x, state, params, out):
    # The state is held in local variables meanwhile: through the array each sample would cost several times as much.
    alphas, betas, table, diagonal, rise_at, rise, fall_at, fall, level, width, pace = params
    started = state[_STARTED] != 0.0
    n = int(state[_COUNT])
    last = state[_X]
    y = state[_Y]
    direction = state[_DIRECTION]
    for i in range(x.size):
        now = x[i]
        if not started:
            started = True
            direction = np.sign(now)
        elif now != last:
            towards = 1.0 if now > last else -1.0
            if towards == -direction:
                state[_STACK + 2 * n] = last
                state[_STACK + 2 * n + 1] = y
                n += 1
            direction = towards
            while n >= 2 and direction * (now - state[_STACK + 2 * n - 4]) >= 0.0:
                n -= 2
            if n == 1 and abs(now) >= abs(state[_STACK]):
                n = 0
        else:
            out[i] = y
            continue
        if n == 0:
            y = level + _virgin(now, rise_at, rise, fall_at, fall, width)
        else:
            # Everett's function of the last turn and the input: the weight of the relays between them.
            turn = state[_STACK + 2 * n - 2]
            a = max(now, turn)
            b = min(now, turn)
            if width > 0.0:
                # Uniform cells: alphas[0] is the lowest edge, and the table holds the sums at the cells' corners.
                cells = diagonal.size
                fa = min(max((a - alphas[0]) / width, 0.0), float(cells))
                fb = min(max((b - alphas[0]) / width, 0.0), float(cells))
                p = min(int(fa), cells - 1)
                q = min(int(fb), cells - 1)
                fa -= p
                fb -= q
                if p == q:
                    weight = diagonal[p] * (fa - fb)
                else:
                    low = table[p, q] + fb * (table[p, q + 1] - table[p, q])
                    high = table[p + 1, q] + fb * (table[p + 1, q + 1] - table[p + 1, q])
                    weight = low + fa * (high - low)
            elif pace > 0.0:
                # Evenly spaced thresholds: the place follows from the spacing but for rounding, which is put right.
                p = int(min(max((a - alphas[0]) * pace + 1.0, 0.0), float(alphas.size)))
                while p < alphas.size and alphas[p] <= a:
                    p += 1
                while p > 0 and alphas[p - 1] > a:
                    p -= 1
                q = int(min(max((b - betas[0]) * pace + 1.0, 0.0), float(betas.size)))
                while q < betas.size and betas[q] < b:
                    q += 1
                while q > 0 and betas[q - 1] >= b:
                    q -= 1
                weight = table[p, q]
            else:
                weight = table[np.searchsorted(alphas, a, side="right"), np.searchsorted(betas, b)]
            y = state[_STACK + 2 * n - 1] + (2.0 * weight if now >= turn else -2.0 * weight)
        last = now
        out[i] = y
    state[_STARTED] = 1.0 if started else 0.0
    state[_COUNT] = n
    state[_X] = last
    state[_Y] = y
    state[_DIRECTION] = direction


@njit(cache=True)
def _step(x, state, params, commit):
    one = np.full(1, x)
    _run(one, state if commit else state.copy(), params, one)
    return one[0]


def _common_pace(alphas: Floats, betas: Floats) -> float:
    """Thresholds per input where both sets are evenly spaced alike; 0 where they are not."""
    steps = np.concatenate([np.diff(alphas), np.diff(betas)])
    even = steps.size > 0 and np.allclose(steps, steps[0], rtol=1e-6, atol=0.0)
    return 1.0 / float(steps[0]) if even and 1.0 / float(steps[0]) < np.inf else 0.0


def _relay_parameters(alpha: Floats, beta: Floats, weights: Floats, offset: float) -> tuple[Any, ...]:
    """Everett table of discrete relays over their distinct thresholds, and the cumulative sums of the virgin curve."""
    alphas, ai = np.unique(alpha, return_inverse=True)
    betas, bi = np.unique(beta, return_inverse=True)
    if (alphas.size + 1) * (betas.size + 1) > TABLE_LIMIT:
        raise InputError(
            f"{alphas.size} x {betas.size} distinct thresholds are too many (limit {TABLE_LIMIT} pairs); "
            "put the relays on a grid"
        )
    table = np.zeros((alphas.size + 1, betas.size + 1))
    np.add.at(table, (ai + 1, bi), weights)
    table = np.cumsum(np.cumsum(table, axis=0)[:, ::-1], axis=1)[:, ::-1].copy()
    up = alpha + beta <= 0.0
    level = offset + float(weights[up].sum() - weights[~up].sum())
    order = np.argsort(alpha[~up], kind="stable")
    rise_at, rise = alpha[~up][order], np.concatenate([[0.0], np.cumsum(weights[~up][order])])
    order = np.argsort(beta[up], kind="stable")
    # Relays that start up fall where beta >= x: sums from the top.
    fall_at = beta[up][order]
    fall = np.concatenate([np.cumsum(weights[up][order][::-1])[::-1], [0.0]])
    pace = _common_pace(alphas, betas)
    return alphas, betas, table, np.zeros(1), rise_at, rise, fall_at, fall, level, 0.0, pace


def _cell_parameters(grid: Floats, offset: float, width: float) -> tuple[Any, ...]:
    """Everett corners of uniform cells; ``grid[i, j]`` is the weight of alpha cell i and beta cell j <= i."""
    cells = grid.shape[0]
    half = cells // 2
    diagonal = np.diag(grid).copy()
    table = np.zeros((cells + 1, cells + 1))
    table[1:, :-1] = grid
    table = np.cumsum(np.cumsum(table, axis=0)[:, ::-1], axis=1)[:, ::-1].copy()
    edges = width * (np.arange(cells + 1) - half)
    rise, fall = np.zeros((half, 3)), np.zeros((half, 3))
    total_up = total_down = 0.0
    for k in range(half):
        # Cells of rising alpha from zero on, above the antidiagonal, which halves the last cell of each strip.
        i = half + k
        across = grid[i, cells - 1 - i]
        linear = float(grid[i, cells - i : i + 1].sum())
        rise[k] = total_up, linear, 0.5 * across
        total_up += linear + 0.5 * across
        j = half - 1 - k
        across = grid[cells - 1 - j, j]
        linear = float(grid[j : cells - 1 - j, j].sum())
        fall[k] = total_down, linear, 0.5 * across
        total_down += linear + 0.5 * across
    level = offset + total_down - total_up
    empty = np.zeros(0)
    return edges, edges, table, diagonal, empty, rise.ravel(), empty, fall.ravel(), level, width, 0.0


class Preisach(HysteresisModel):
    """Preisach: y = offset + Σ w_i relay_i, from the demagnetised state.

    Relay i is +1 once x >= alpha_i and −1 once x <= beta_i; at first it is +1 where alpha_i + beta_i <= 0. With
    ``width`` > 0 the relays are spread evenly over square cells of a grid of that spacing about zero (those with
    alpha = beta along the diagonal, where they have no memory), so that the output is continuous.

    Parameters
    ----------
    levels : int
        Cells across the input's range; the number of unknowns grows with its square.
    signs : {"auto", "nonnegative", "clockwise", "free"}
        Signs of the weights. Non-negative ones make counter-clockwise loops. Torque-deflection loops run clockwise:
        then the weights off the diagonal are at most 0 and those on it, the part without memory, at least 0.
        ``"auto"`` decides by the sense in which the recording's loops run.
    smoothing : float
        Weight of the penalty on differences between the weights of neighbouring cells, which settles what the recording
        does not tell: between its turning points the density is interpolated.

    Notes
    -----
    ``from_parameters`` takes ``alpha`` (M,), ``beta`` (M,), ``weights`` (M,), ``offset`` and optionally ``width``.
    """

    id: ClassVar[str] = "preisach"
    title: ClassVar[str] = "Preisach"
    summary: ClassVar[str] = (
        "relays over a triangle of thresholds; any loop shape with wiping-out and congruent minor loops"
    )
    use_for: ClassVar[str] = (
        "loops of any shape with true memory (magnets, piezo stages), when the recording holds many minor loops to "
        "learn from"
    )
    not_for: ClassVar[str] = (
        "short recordings (the unknowns grow with the square of the levels), and control that needs an inverse in "
        "closed form"
    )
    source: ClassVar[str] = "Mayergoyz 1991"
    references: ClassVar[tuple[str, ...]] = ("mayergoyz1991",)
    search_grid: ClassVar[Mapping[str, Sequence[Any]]] = {"levels": (12, 24, 36)}
    estimated: ClassVar[tuple[str, ...] | None] = ("weights", "offset")

    def __init__(self, levels: int = 24, signs: str = "auto", smoothing: float = 1e-5) -> None:
        self.levels = levels
        self.signs = signs
        self.smoothing = smoothing

    # ---- identification --------------------------------------------------------------------------------------------

    def _identify(self, runs: Sequence[Run]) -> dict[str, Any]:
        if self.levels < 2:
            raise InputError(f"levels must be at least 2; it is {self.levels}")
        if self.signs not in ("auto", "nonnegative", "clockwise", "free"):
            raise InputError(f"signs must be 'auto', 'nonnegative', 'clockwise' or 'free'; it is {self.signs!r}")
        if self.smoothing < 0.0:
            raise InputError(f"smoothing must not be negative; it is {self.smoothing}")
        thresholds = _switching_thresholds(runs)
        if thresholds is not None and thresholds[0].size * thresholds[1].size > 2 * RELAY_LIMIT:
            self.notes_.append(
                f"the output is piecewise constant with {thresholds[0].size} upper and {thresholds[1].size} lower "
                "thresholds, too many to identify one by one: cells are used instead"
            )
            thresholds = None
        if thresholds is not None:
            alpha, beta = (v.ravel() for v in np.meshgrid(*thresholds, indexing="ij"))
            alpha, beta = alpha[alpha >= beta], beta[alpha >= beta]
            width = 0.0
            self.notes_.append(
                f"the output is piecewise constant: discrete relays at {thresholds[0].size} upper and "
                f"{thresholds[1].size} lower thresholds where it jumps"
            )
        else:
            low = min(float(run.x.min()) for run in runs)
            high = max(float(run.x.max()) for run in runs)
            width = (high - low) / self.levels
            cells = 2 * int(np.ceil(max(abs(low), abs(high)) / width - 1e-9))
            centres = width * (np.arange(cells) + 0.5 - cells // 2)
            inside = centres[(centres + 0.5 * width > low) & (centres - 0.5 * width < high)]
            alpha, beta = (v.ravel() for v in np.meshgrid(inside, inside, indexing="ij"))
            alpha, beta = alpha[alpha >= beta], beta[alpha >= beta]
        design, target = self._responses(runs, alpha, beta, width)
        weights, offset = self._solve(design, target, alpha, beta, self._choose_signs(runs))
        idle = float(np.mean(np.ptp(design, axis=0) < 1e-9))
        if idle > 0.0:
            self.notes_.append(
                f"{idle:.0%} of the cells never change in this recording; their weights are not identified"
            )
        return {"alpha": alpha, "beta": beta, "weights": weights, "offset": offset, "width": width}

    def _choose_signs(self, runs: Sequence[Run]) -> str:
        if self.signs != "auto":
            return self.signs
        work = sum(float(np.sum(0.5 * (run.y[1:] + run.y[:-1]) * np.diff(run.x))) for run in runs)
        # What a reversible curve stores between first and last sample is no sense of rotation.
        slope = np.polyfit(np.concatenate([r.x for r in runs]), np.concatenate([r.y for r in runs]), 1)
        work -= sum(
            float(np.polyval(np.polyint(slope), run.x[-1]) - np.polyval(np.polyint(slope), run.x[0])) for run in runs
        )
        chosen = "clockwise" if work > 0.0 else "nonnegative"
        self.notes_.append(f"loops run {'clockwise' if work > 0.0 else 'counter-clockwise'}: signs = {chosen!r}")
        return chosen

    def _responses(self, runs: Sequence[Run], alpha: Floats, beta: Floats, width: float) -> tuple[Floats, Floats]:
        """Output of every cell with unit weight at every settled sample, shape (n, M), and the measured output."""
        parts = [settled_from(run.x) for run in runs]
        # Cell after cell is written, so columns are what should lie together.
        settled = sum(run.x.size - part for run, part in zip(runs, parts, strict=True))
        design = np.empty((settled, alpha.size), order="F")
        unit = np.zeros(alpha.size)
        for column in range(alpha.size):
            unit[column] = 1.0
            params = self._kernel_parameters(alpha, beta, unit, 0.0, width)
            unit[column] = 0.0
            start = 0
            for run, part in zip(runs, parts, strict=True):
                out = np.empty_like(run.x)
                _run(run.x, _initial_state(run.x.size), params, out)
                design[start : start + out.size - part, column] = out[part:]
                start += out.size - part
        return design, np.concatenate([run.y[part:] for run, part in zip(runs, parts, strict=True)])

    def _solve(self, design: Floats, target: Floats, alpha: Floats, beta: Floats, signs: str) -> tuple[Floats, float]:
        """Weights and offset of the regularised least-squares problem under the sign constraints."""
        sign = np.where((signs == "clockwise") & (alpha > beta), -1.0, 1.0)
        # Profiling the offset out leaves it free of sign and ridge.
        mean, level = design.mean(axis=0), float(target.mean())
        penalty = np.vstack([_roughness(alpha, beta), np.sqrt(RIDGE) * np.eye(alpha.size)])
        smooth = np.sqrt(self.smoothing * target.size) * np.column_stack([penalty, np.zeros(penalty.shape[0])])
        measured = (
            np.column_stack([(design[part] - mean) * sign, target[part] - level]) for part in blocks(target.size)
        )
        triangle = reduced(itertools.chain([smooth], measured))
        factor, rotated = triangle[:-1, :-1], triangle[:-1, -1]
        if signs == "free":
            weights = np.linalg.lstsq(factor, rotated, rcond=None)[0]
        else:
            weights = nnls(factor, rotated, maxiter=30 * alpha.size)[0]
        weights = weights * sign
        return np.asarray(weights, dtype=float), level - float(mean @ weights)

    # ---- parameters ------------------------------------------------------------------------------------------------

    @classmethod
    def _check_parameters(cls, alpha: Any, beta: Any, weights: Any, offset: Any, width: Any = 0.0) -> dict[str, Any]:
        alpha = parameter_array("alpha", alpha, (None,))
        beta = parameter_array("beta", beta, (alpha.size,))
        weights = parameter_array("weights", weights, (alpha.size,))
        width = parameter_number("width", width)
        bad = np.flatnonzero(alpha < beta)
        if bad.size:
            raise InputError(f"parameter alpha[{bad[0]}] = {alpha[bad[0]]} is below beta[{bad[0]}] = {beta[bad[0]]}")
        if width < 0.0:
            raise InputError(f"parameter width must not be negative; it is {width}")
        if width > 0.0:
            for name, values in (("alpha", alpha), ("beta", beta)):
                places = values / width - 0.5
                if np.any(np.abs(places - np.round(places)) > 1e-6):
                    raise InputError(f"parameter {name}: with width > 0 the cells must be centred at (k + 1/2) width")
        return {
            "alpha": alpha,
            "beta": beta,
            "weights": weights,
            "offset": parameter_number("offset", offset),
            "width": width,
        }

    @staticmethod
    def _kernel_parameters(
        alpha: Floats, beta: Floats, weights: Floats, offset: float, width: float
    ) -> tuple[Any, ...]:
        if width == 0.0:
            return _relay_parameters(alpha, beta, weights, offset)
        half = int(np.round(max(np.abs(alpha).max(), np.abs(beta).max()) / width + 0.5))
        i, j = (np.round(v / width - 0.5).astype(int) + half for v in (alpha, beta))
        grid = np.zeros((2 * half, 2 * half))
        np.add.at(grid, (i, j), weights)
        return _cell_parameters(grid, offset, width)

    def _prepare(self) -> None:
        p = self.parameters_
        self._params = self._kernel_parameters(p["alpha"], p["beta"], p["weights"], p["offset"], p["width"])

    def _check_conditions(self) -> list[Condition]:
        p = self.parameters_
        off = p["weights"][p["alpha"] > p["beta"]]
        told = (
            f"weights off the diagonal from {off.min():.4g} to {off.max():.4g}"
            if off.size
            else "no weight off the diagonal"
        )
        return [
            Condition(
                "every closed loop runs clockwise (dissipates): no positive weight off the diagonal",
                bool(np.all(off <= 0.0)),
                told,
            ),
            Condition(
                "every closed loop runs counter-clockwise: no negative weight off the diagonal",
                bool(np.all(off >= 0.0)),
                told,
            ),
        ]

    def _input_scale(self) -> float:
        # Twice the outermost threshold, so that a search for saturation passes it.
        p = self.parameters_
        return 2.0 * float(max(np.abs(p["alpha"]).max(), np.abs(p["beta"]).max()) + p["width"]) or 1.0

    # ---- evaluation ------------------------------------------------------------------------------------------------

    def _predict_run(self, x: Floats) -> Floats:
        y = np.empty_like(x)
        _run(x, _initial_state(x.size), self._params, y)
        return y

    def stepper(self) -> KernelStepper:
        self._require_fitted()
        return KernelStepper(_step, _initial_state, self._params, _run)


def _switching_thresholds(runs: Sequence[Run]) -> tuple[Floats, Floats] | None:
    """Upper and lower thresholds where the output jumps, or None where it is not piecewise constant."""
    span = max(float(np.ptp(run.y)) for run in runs)
    moves = np.concatenate([np.diff(run.x) for run in runs])
    jumps = np.concatenate([np.diff(run.y) for run in runs])
    starts = np.concatenate([run.x[:-1] for run in runs])
    still = np.abs(jumps) <= 1e-12 * span
    moving = moves != 0.0
    if span == 0.0 or not np.any(moving) or np.mean(still[moving]) <= DISCRETE_SHARE:
        return None
    found = []
    for sign in (1.0, -1.0):
        chosen = ~still & (sign * moves > 0.0)
        ends = starts[chosen] + moves[chosen]
        low, high = np.minimum(starts[chosen], ends), np.maximum(starts[chosen], ends)
        found.append(_common_points(low, high))
    return (found[0], found[1]) if found[0].size and found[1].size else None


def _common_points(low: Floats, high: Floats) -> Floats:
    """One point in what each group of overlapping intervals has in common, in ascending order.

    Where equally spaced points fit, they are taken: two unknowns then explain every jump, and all intervals together
    place them far more exactly than each one its own. Otherwise the points are the middles.
    """
    lefts: list[float] = []
    rights: list[float] = []
    order = np.argsort(high, kind="stable")
    for a, b in zip(low[order].tolist(), high[order].tolist(), strict=True):
        if lefts and a < rights[-1]:
            lefts[-1] = max(lefts[-1], a)
        else:
            lefts.append(a)
            rights.append(b)
    left, right = np.array(lefts), np.array(rights)
    if left.size >= 3:
        # Unknowns: first point, spacing, and the least distance from the intervals' ends, which is made largest.
        rank, ones = np.arange(left.size), np.ones(left.size)
        sides = np.concatenate([np.column_stack([-ones, -rank, ones]), np.column_stack([ones, rank, ones])])
        limits = np.concatenate([-left, right])
        found = linprog([0.0, 0.0, -1.0], A_ub=sides, b_ub=limits, bounds=[(None, None), (0.0, None), (None, None)])
        if found.success:
            first, spacing, room = np.asarray(found.x).tolist()
            if room >= 0.0:
                return first + rank * spacing
    return 0.5 * (left + right)


def _roughness(alpha: Floats, beta: Floats) -> Floats:
    """Differences of the weights of neighbours, one a row; the diagonal, which has no memory, is a set of its own."""
    alphas, i = np.unique(alpha, return_inverse=True)
    betas, j = np.unique(beta, return_inverse=True)
    off = alpha > beta
    grids = []
    for chosen in (off, ~off):
        grid = np.full((alphas.size, betas.size), -1)
        grid[i[chosen], j[chosen]] = np.flatnonzero(chosen)
        grids.append(grid)
    pairs = [
        (grids[0][1:], grids[0][:-1]),
        (grids[0][:, 1:], grids[0][:, :-1]),
        (grids[1][1:, 1:], grids[1][:-1, :-1]),
    ]
    first, second = (np.concatenate([pair[side].ravel() for pair in pairs]) for side in (0, 1))
    both = (first >= 0) & (second >= 0)
    rows = np.arange(int(both.sum()))
    differences = np.zeros((rows.size, alpha.size))
    differences[rows, first[both]] = 1.0
    differences[rows, second[both]] = -1.0
    return differences


def relay_outputs(x: Floats, alpha: Floats, beta: Floats) -> NDArray[np.int8]:
    """Every relay at every sample, shape (n, M), by the definition: for figures and for checking."""
    state = np.where(alpha + beta <= 0.0, 1, -1).astype(np.int8)
    out = np.empty((x.size, alpha.size), dtype=np.int8)
    for k, value in enumerate(x):
        state[value >= alpha] = 1
        state[value <= beta] = -1
        out[k] = state
    return out
