"""The simulator as the diagnosis knows it: its output, how it answers to another input, and where its parameters lead.

With a saved model the answer to another input is the model's own. With only a table of outputs, an emulator is
identified from it: elastic polynomial + stop operators and Dahl bristles (weights of one sign) + stops weighed by position +
rate terms, a generalised Prandtl-Ishlinskii model. Where that is not good enough, registered models compete with it.

The simulator's own parameters may be off by a few per cent. To first order that adds a combination of the emulator's
*tangent* columns, of two kinds: the fine structure of the loop (each element's torque and its change with the
element's threshold), in which even a well calibrated simulator differs from the joint, and the bulk (elastic curve,
loop width, scale of the deflection, rates), in which it differs only if it is badly calibrated.
"""

from __future__ import annotations

import itertools
from collections import OrderedDict
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from .. import models
from ..bench.arguments import time_argument
from ..errors import InputError
from ..models.least_squares import blocks, reduced
from .operators import bristle, plays, weighed
from .signals import Signals, differentiate

__all__ = [
    "Emulator",
    "Generalised",
    "SimulatorScene",
    "answers_of",
    "emulate",
    "predict_generalised",
    "spring_of",
    "strength_of",
]

Floats = NDArray[np.float64]
ELEMENTS = 14
BRISTLES = 5
BIAS = 1e-5
PLACES = 4
"""Ways in which an element's torque may depend on where it is."""
STEEPNESS = (0.02, 0.08, 0.3)
DEGREE = 5
# Registered models that compete with the built-in emulator, in seconds rather than minutes.
COMPETITORS = ("prandtl-ishlinskii", "preisach", "dahl")
GOOD_ENOUGH = 0.01
REMEMBERED = 48
"""Effects' columns that are kept at a time."""


@dataclass(frozen=True)
class Emulator:
    """How the simulator answers to another input.

    Attributes
    ----------
    name : str
        Which model emulates; ``"the simulator itself"`` where a model file was given.
    error : float
        RMS error over the standard deviation of the simulator's output; 0 for the simulator itself.
    structure, bulk : array, shape (n, m)
        Change of the output for a relative change of each parameter by one: fine structure, and bulk.
    parameters : dict
        What rebuilds it: ``model`` (a registered id, or ``"generalised"``) and ``parameters``; of a registered model also
        ``split``.
    split : dict
        Parameters of the built-in emulator, which tell its elastic curve from what has memory.
    """

    name: str
    error: float
    predict: Callable[[Floats], Floats]
    """Output over the recordings' samples for another input there."""
    anew: Callable[[Floats], Floats]
    """Output over one new motion, from the virgin state."""
    structure: Floats
    bulk: Floats
    parameters: Mapping[str, Any]
    split: Mapping[str, Any]


class SimulatorScene:
    """What effects look at: the signals, the torque so far and the simulator's answer to another input."""

    def __init__(
        self, signals: Signals, emulator: Emulator, torque: Floats | None = None, base: Floats | None = None
    ) -> None:
        self.signals = signals
        self.emulator = emulator
        self.torque = signals.y_sim if torque is None else torque
        self._base = emulator.predict(signals.x) if base is None else base
        self._remembered: OrderedDict[Hashable, Floats] = OrderedDict()
        self._lasting: dict[str, Floats] = {}

    def torque_change(self, x: Floats) -> Floats:
        """Change of the simulator's output if its input were ``x`` (n,), N·m."""
        return self.emulator.predict(x) - self._base

    @property
    def spring(self) -> Floats:
        """The elastic part of the simulator's output, N·m, shape (n,)."""
        return self._once("spring", lambda: spring_of(self.emulator.split, self.signals.x))

    def spring_change(self, x: Floats) -> Floats:
        """Change of the elastic part alone if the input were ``x`` (n,), N·m."""
        return spring_of(self.emulator.split, x) - self.spring

    @property
    def friction(self) -> Floats:
        """The part of the simulator's output that has memory, N·m, shape (n,)."""
        return self.signals.y_sim - self.spring

    @property
    def strength(self) -> Floats:
        """Change of that part for a relative change of its strength by one at the same stiffness, N·m, shape (n,)."""
        return self._once("strength", lambda: strength_of(self.emulator.split, self.signals.x, self.signals.runs))

    def _once(self, name: str, make: Callable[[], Floats]) -> Floats:
        if name not in self._lasting:
            self._lasting[name] = make()
        return self._lasting[name]

    def remembered(self, key: Hashable, make: Callable[[], Floats]) -> Floats:
        """What ``make`` gives, kept for the next call with ``key`` unless many others come between."""
        if key in self._remembered:
            self._remembered.move_to_end(key)
            return self._remembered[key]
        made = make()
        self._remembered[key] = made
        if len(self._remembered) > REMEMBERED:
            self._remembered.popitem(last=False)
        return made

    def with_torque(self, torque: Floats) -> SimulatorScene:
        """The same scene after effects that changed the torque."""
        scene = SimulatorScene(self.signals, self.emulator, torque, self._base)
        scene._lasting = self._lasting
        return scene


def emulate(signals: Signals, model: Any | None) -> Emulator:
    """Identify the emulator; ``model`` is the simulator itself where it is at hand."""
    own = Generalised(signals)
    if model is not None:
        return _of_model(model, signals, *own.tangent(), own.parameters())
    best = Emulator(
        "generalised Prandtl-Ishlinskii",
        own.error,
        own.predict,
        own.anew,
        *own.tangent(),
        {"model": "generalised", "parameters": own.parameters()},
        own.parameters(),
    )
    for name in COMPETITORS if own.error > GOOD_ENOUGH else ():
        try:
            rival = models.get(name)().fit(signals.x, signals.y_sim, signals.groups)
        except (InputError, np.linalg.LinAlgError, RuntimeError):
            # This model cannot describe such a simulator: the emulator so far stays.
            continue
        error = _relative_error(np.asarray(rival.predict(signals.x, signals.groups)), signals.y_sim)
        if error < best.error:
            best = replace(_of_model(rival, signals, best.structure, best.bulk, best.split), name=name, error=error)
    return best


def answers_of(model: Any, signals: Signals) -> Callable[[Floats], Floats]:
    """A fitted model's output over the recordings' samples for any input there."""

    def predict(x: Floats) -> Floats:
        return np.asarray(model.predict(x, signals.groups, **time_argument(model.predict, signals.time)))

    return predict


def _of_model(model: Any, signals: Signals, structure: Floats, bulk: Floats, split: Mapping[str, Any]) -> Emulator:
    def anew(x: Floats) -> Floats:
        time = signals.interval * np.arange(x.size, dtype=np.float64)
        return np.asarray(model.predict(x, **time_argument(model.predict, time)))

    described = {"model": model.id, "parameters": dict(model.parameters_), "split": split}
    return Emulator("the simulator itself", 0.0, answers_of(model, signals), anew, structure, bulk, described, split)


def _relative_error(predicted: Floats, wanted: Floats) -> float:
    return float(np.sqrt(np.mean(np.square(predicted - wanted))) / max(float(np.std(wanted)), 1e-300))


class Generalised:
    """Elastic polynomial, stop operators and rate terms, identified by non-negative least squares."""

    def __init__(self, signals: Signals) -> None:
        self.signals = signals
        self.reach = max(float(np.max(np.abs(signals.x))), 1e-300)
        self.thresholds = np.geomspace(0.004, 0.8, ELEMENTS) * self.reach
        self.lengths = np.geomspace(0.01, 0.4, BRISTLES) * self.reach
        self.fast = max(float(np.std(signals.speed)), 1e-300)
        elastic, stops, placed = self._parts(signals.x)
        rates = self._rates()
        free = np.hstack([elastic, placed, rates])

        def identified(sign: float) -> tuple[float, Floats]:
            """Error and solution whose elements with memory have weights of one sign."""
            found = _solve(free, sign * stops, signals.y_sim)
            found[free.shape[1] :] *= sign
            return _relative_error(free @ found[: free.shape[1]] + stops @ found[free.shape[1] :], signals.y_sim), found

        self.error, solution = identified(1.0)
        if self.error > GOOD_ENOUGH:
            # What lags behind its input, as a piezo stage does, turns the other way round.
            error, turned = identified(-1.0)
            if error < self.error:
                self.error, solution = error, turned
        n_elastic, n_placed = elastic.shape[1], placed.shape[1]
        self.elastic = solution[:n_elastic]
        self.placed = solution[n_elastic : n_elastic + n_placed]
        self.rates = solution[n_elastic + n_placed : free.shape[1]]
        self.weights = solution[free.shape[1] :]

    def _rates(self) -> Floats:
        return _rates(self.signals.speed, self.signals.acceleration, self.fast)

    def parameters(self) -> dict[str, Floats | float]:
        """All that :func:`predict_generalised` needs."""
        return {
            "reach": self.reach, "thresholds": self.thresholds, "lengths": self.lengths, "elastic": self.elastic,
            "placed": self.placed, "weights": self.weights, "rates": self.rates, "fast": self.fast,
        }  # fmt: skip

    def _parts(self, x: Floats) -> tuple[Floats, Floats, Floats]:
        return _parts(x, self.signals.runs, self.reach, self.thresholds, self.lengths)

    def predict(self, x: Floats) -> Floats:
        signals = self.signals
        change = x - signals.x
        speed, acceleration = signals.speed, signals.acceleration
        if np.any(change):
            # The change is far smoother than the measured input, so it may be differentiated as it is.
            added = signals.per_run(lambda run: np.gradient(change[run], signals.time[run]))
            speed = speed + added
            acceleration = acceleration + signals.per_run(lambda run: np.gradient(added[run], signals.time[run]))
        return predict_generalised(self.parameters(), x, signals.runs, speed, acceleration)

    def anew(self, x: Floats) -> Floats:
        """Output over one new motion, sampled as the recordings are."""
        time = self.signals.interval * np.arange(x.size, dtype=np.float64)
        _, speed, acceleration = differentiate(time, x)
        return predict_generalised(self.parameters(), x, [slice(0, x.size)], speed, acceleration)

    def tangent(self) -> tuple[Floats, Floats]:
        """Columns (n, m) of structure and bulk, each the change for a relative error of one of some parameter."""
        x = self.signals.x
        elastic, stops, placed = self._parts(x)
        # An element that the sparse fit left out shares its neighbours' size: its parameters are unknown, not exact.
        weights = np.maximum(
            np.abs(self.weights), 0.5 * np.abs(np.convolve(self.weights, np.ones(3) / 3.0, mode="same"))
        )
        # A spring has no torque at rest, so neither has the change of a stiffness; a preload may be off by itself.
        at_rest = np.polynomial.legendre.legvander(0.0, DEGREE)
        preload = np.full((x.size, 1), float(at_rest[0] @ self.elastic))
        sprung = elastic[:, 1:] - at_rest[:, 1:]
        curve = sprung * self.elastic[1:]
        odd, even = curve[:, ::2].sum(axis=1), curve[:, 1::2].sum(axis=1)
        width = stops @ self.weights + placed @ self.placed
        size_odd, size_even = float(np.std(odd)), float(np.std(even))
        unit = sprung / np.maximum(np.std(sprung, axis=0), 1e-300)
        shapes = unit * np.array([size_odd if k % 2 == 0 else size_even for k in range(DEGREE)]) * 0.4
        small = 1e-3
        stretched = (self.predict((1.0 + small) * x) - self.predict((1.0 - small) * x)) / (2.0 * small)
        stronger = _stronger(x, self.signals.runs, self.thresholds, self.lengths)
        structure = np.hstack([stops * weights, stronger * weights])
        rates = self._rates() * self.rates
        by_place = (placed * self.placed).reshape(x.size, PLACES, -1).sum(axis=2)
        bulk = np.column_stack([
            shapes, odd, even, preload, width, _uncancelled(by_place), stretched, _uncancelled(rates),
        ])  # fmt: skip
        return structure, bulk


def _uncancelled(columns: Floats) -> Floats:
    """Columns (n, k) of which none is larger than their sum: what cancels is no parameter of the simulator."""
    whole = float(np.sqrt(np.mean(np.square(columns.sum(axis=1)))))
    sizes = np.sqrt(np.mean(np.square(columns), axis=0))
    return columns * np.minimum(1.0, whole / np.maximum(sizes, 1e-300))


def _parts(
    x: Floats, runs: Sequence[slice], reach: float, thresholds: Floats, lengths: Floats
) -> tuple[Floats, Floats, Floats]:
    """Columns of the elastic curve, of the elements with memory, and of stops weighed by position."""
    stops, signs = _elements(x, runs, thresholds, lengths)
    u = _place(x, reach)
    elastic: Floats = np.asarray(np.polynomial.legendre.legvander(u, DEGREE))
    placed = np.hstack([stops[:, 2::2] * weight[:, None] for weight in _weights(u)])
    return elastic, np.hstack([stops, signs]), placed


def _elements(x: Floats, runs: Sequence[slice], thresholds: Floats, lengths: Floats) -> tuple[Floats, Floats]:
    """Stops and bristles, shapes (n, thresholds) and (n, lengths)."""
    stops = x[:, None] - np.concatenate([plays(x[run], thresholds) for run in runs])
    # Like the stops, bristles come from the virgin state at zero to where a recording begins.
    whole = [np.concatenate([[0.0], x[run]]) for run in runs]
    signs = [np.concatenate([bristle(way, length)[1:] for way in whole]) * length for length in lengths]
    return stops, np.column_stack(signs) if signs else np.empty((x.size, 0))


def _place(x: Floats, reach: float) -> Floats:
    # Polynomials are not to be trusted far beyond the recorded stroke: they end there.
    return np.asarray(np.clip(x / reach, -1.3, 1.3))


def _weights(u: Floats) -> tuple[Floats, ...]:
    """How an element's torque may depend on its place, ``PLACES`` of them."""
    return u, u * u, np.abs(u), u**3


def _rates(speed: Floats, acceleration: Floats, fast: float) -> Floats:
    """What a simulator with friction of its own may know of speed: damping, inertia, a regularised sign."""
    return np.column_stack([speed, acceleration, *(np.tanh(speed / (share * fast)) for share in STEEPNESS)])


def predict_generalised(
    parameters: Mapping[str, Any], x: Floats, runs: Sequence[slice], speed: Floats, acceleration: Floats
) -> Floats:
    """Output of the built-in emulator, N·m, shape (n,), from the virgin state in each run."""
    u, weights = _place(x, parameters["reach"]), np.asarray(parameters["weights"])
    thresholds, lengths = np.asarray(parameters["thresholds"]), np.asarray(parameters["lengths"])
    placed = np.zeros((PLACES, thresholds.size))
    placed[:, 2::2] = np.reshape(parameters["placed"], (PLACES, -1))
    stops, signs = weights[: thresholds.size], weights[thresholds.size :]
    y = np.polynomial.legendre.legval(u, parameters["elastic"])
    # Summed as they come: the columns that an identification needs are never made.
    y += np.concatenate([weighed(x[run], u[run], thresholds, stops, placed, lengths, signs) for run in runs])
    return np.asarray(y + _rates(speed, acceleration, float(parameters["fast"])) @ parameters["rates"])


def spring_of(parameters: Mapping[str, Any], x: Floats) -> Floats:
    """The elastic part of the built-in emulator's output, without torque at rest, N·m, shape (n,)."""
    elastic = np.asarray(parameters["elastic"])
    curve = np.polynomial.legendre.legval(_place(x, parameters["reach"]), elastic)
    return np.asarray(curve - np.polynomial.legendre.legval(0.0, elastic))


def strength_of(parameters: Mapping[str, Any], x: Floats, runs: Sequence[slice]) -> Floats:
    """Change of the built-in emulator's output for a relative change by one of the strength of what has memory."""
    thresholds, lengths, weights = (np.asarray(parameters[name]) for name in ("thresholds", "lengths", "weights"))
    return np.asarray(_stronger(x, runs, thresholds, lengths) @ weights)


def _stronger(x: Floats, runs: Sequence[slice], thresholds: Floats, lengths: Floats) -> Floats:
    """Change of each element for a relative change by one of its strength at the same stiffness."""
    wider, narrower = (np.hstack(_elements(x, runs, scale * thresholds, scale * lengths)) for scale in (1.05, 0.95))
    return np.asarray((wider - narrower) / 0.1)


def _solve(free: Floats, bounded: Floats, target: Floats) -> Floats:
    """Least squares with free columns and non-negative ones; returns the free unknowns first."""
    columns = np.hstack([free, bounded])
    scale = np.sqrt(np.mean(np.square(columns), axis=0))
    scale[scale == 0.0] = 1.0
    columns = columns / scale
    # A small ridge keeps nearly equal columns from cancelling each other with huge weights; it is larger on the elements
    # with memory, so that what is elastic goes to the elastic curve and not to elements that hardly ever yield.
    strength = np.concatenate([np.full(free.shape[1], 1e-7), np.full(bounded.shape[1], BIAS)])
    ridge = np.diag(np.sqrt(strength * columns.shape[0]))
    padded = np.column_stack([ridge, np.zeros(columns.shape[1])])
    measured = (np.column_stack([columns[part], target[part]]) for part in blocks(target.size))
    triangle = reduced(itertools.chain([padded], measured))
    k = free.shape[1]
    matrix, wanted = triangle[:-1, :-1], triangle[:-1, -1]
    # The free unknowns come first in the triangle: below their rows only the bounded ones are left.
    positive = nnls(matrix[k:, k:], wanted[k:], maxiter=50 * columns.shape[1])[0]
    rest = np.linalg.solve(matrix[:k, :k], wanted[:k] - matrix[:k, k:] @ positive)
    return np.concatenate([rest, positive]) / scale
