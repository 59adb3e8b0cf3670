"""The built-in emulator: a generalised Prandtl-Ishlinskii model that is identified from a table of outputs.

Elastic polynomial + stop operators and Dahl bristles (weights of one sign) + stops weighed by position + rate terms, and where
that is not good enough what simulators are made of besides (see :mod:`hystbench.diagnosis.emulator.kinds`).
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Collection, Mapping
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..operators.memory import bristle, plays, weighed
from ..recording.noise import rms
from ..recording.signals import Signals, differentiate
from .elements import drag_among, kinks_moved, strengthened_among, torque_of
from .growth import PLACED, RATES, STOPS, TABLED, Growth
from .kind import ELASTIC
from .kinds import KERNELS, KINDS, KINKS
from .motion import DIFFERENCES, Extent, Motion
from .placing import Choices
from .selection import CLEARLY, places_of, solve, spread

__all__ = [
    "Generalised",
    "as_seen",
    "drag_of",
    "elements_of",
    "motion_beside",
    "motion_of",
    "parts_of",
    "predict_anew",
    "predict_beside",
    "predict_generalised",
    "rates_of",
    "relative_error",
    "spacing",
    "spring_of",
    "stops_along",
    "strengthened",
]

Floats = NDArray[np.float64]
ELEMENTS, FINER = 14, 40
"""Stops; the finer ones contain the others."""
SIGNS = 1.0, -1.0
"""Of the weights of what has memory, the usual one first."""
BY_SPEED = "friction by speed"
SMOOTH = "smooth"
"""Derivatives of the motion without its noise."""
BRISTLES = 5
PLACINGS = 4
"""Steps in which kinks are moved to their places."""
RATES_NEEDED = 1.1
"""Error without the rate terms, over that with them, from which they are needed."""
EMULATED = 0.001
"""Error, as a share of the output, from which further elements are looked for."""
PLACES = 4
"""Ways in which an element's torque may depend on where it is."""
STEEPNESS = (0.02, 0.08, 0.3)
DEGREE = 5
ELSEWHERE, CLOSER = 0.001, 0.97
"""Place where a run begins, over the reach, from which it is asked whether memory begins there too, and how much of the error must
be left of one that begins at zero."""
BEFORE, LATEST, CUTS = 2.5, 0.3, 60
"""How much less a run is followed at its beginning than from there on where it depends on what was before it, the largest share of a
run that may, and places that are tried for its end."""
UNTOLD, UNTOLD_CLOSER = 0.03, 0.5
"""Share of a run that is left out where it does not tell how much should be, and how much of the error must be left without it."""
MASKED = 4
"""Times at most that the beginning is left out: what is followed better without a part of it shows how much more should be."""
FEW, RESOLVED = 3000, 1e-4
"""Samples that are enough to tell derivatives apart, and what of their columns is told there, over the largest."""
GOOD_ENOUGH = 0.01
"""Error, as a share of the output, from which elements of the other sign are tried."""
FARTHER, ALL_THE_SAME = 1.2, 0.02
"""Error along other derivatives, over that along those at hand, from which they are not those of the simulator whatever is moved, and
up to which difference they are the same to it."""


class Generalised:
    """Elastic polynomial, stop operators, rate terms and further elements, identified by non-negative least squares.

    Memory begins at zero, or, where ``anywhere`` and that is closer, where each run does; or, where what was before a run is
    what is not followed, anywhere, and the beginning of the run is not looked at.
    """

    def __init__(self, signals: Signals, anywhere: bool = True) -> None:
        self.signals = signals
        self.reach = max(float(np.max(np.abs(signals.x))), 1e-300)
        self.lengths = np.geomspace(0.01, 0.4, BRISTLES) * self.reach
        self.fast = max(float(np.std(signals.speed)), 1e-300)
        self._choices: dict[tuple[bool, str], Choices] = {}
        """Along the motion from where memory begins, by its derivatives; of use only until all is identified."""
        self.placing = [name for name in KINDS if name != KERNELS]
        self.signs: tuple[float, ...] = SIGNS
        """Those of what has memory that may be the simulator's."""
        self._find_anywhere(anywhere)
        if self.error > TABLED:
            self._take_if_closer(self._find_kernels, CLEARLY)
        self._choices.clear()

    def _find_anywhere(self, anywhere: bool) -> None:
        """Identify all, of a simulator whose memory may begin ``anywhere``."""
        signals = self.signals
        self.known = np.ones(signals.x.size, dtype=np.bool_)
        starts = max(abs(float(signals.x[run][0])) for run in signals.runs)
        self._find_either(anywhere and starts > ELSEWHERE * self.reach)
        for _ in range(MASKED if anywhere else 0):
            if self.error < EMULATED or not self._leave_out_what_began_before():
                break

    def _leave_out_what_began_before(self) -> bool:
        """Identify all anew from where each run has forgotten what was before it, where that is what is not followed.

        Whether it was, and is followed more closely so.
        """
        runs, wanted = self.signals.runs, self.signals.y_sim
        predicted = self.predict(self.signals.x)
        cuts, enough = [_begins_to_follow((predicted - wanted)[run]) for run in runs], CLOSER
        if self.known.all() and not any(cuts) and self.error > GOOD_ENOUGH:
            # What is badly followed all along does not tell.
            cuts, enough = [int(UNTOLD * wanted[run].size) for run in runs], UNTOLD_CLOSER
        known = self.known.copy()
        for run, cut in zip(runs, cuts, strict=True):
            known[run][:cut] = False
        if np.array_equal(known, self.known):
            return False
        before, followed = vars(self).copy(), relative_error(predicted[known], wanted[known])
        begun, self.known = self.begun, known
        # Whatever it was, its memory may as well have begun at zero, where no spring has a preload because of that.
        self._find_either(begun)
        if self.error > enough * followed:
            vars(self).update(before)
            return False
        return True

    def _take_if_closer(self, identify: Callable[[], None], share: float = 1.0) -> float:
        """``identify`` anew and keep that if it leaves less than this share of the error. Returns what it leaves."""
        found = self._tried(identify)
        if found["error"] < share * self.error:
            vars(self).update(found)
        return float(found["error"])

    def _tried(self, identify: Callable[[], None]) -> dict[str, Any]:
        """All that ``identify`` finds, without keeping it."""
        before = vars(self).copy()
        identify()
        found = vars(self).copy()
        vars(self).update(before)
        return found

    def _find_either(self, elsewhere: bool) -> None:
        """Identify all, of a simulator whose memory begins at zero or, if ``elsewhere`` and that is closer, where each run does."""
        self._find(begun=False)
        if elsewhere and self.error > EMULATED:
            self._take_if_closer(lambda: self._find(begun=True), CLOSER)

    def _find(self, begun: bool, signs: tuple[float, ...] = SIGNS) -> None:
        """Identify all, of a simulator whose memory begins where each run does or at zero, its weights of one of these ``signs``."""
        motion = motion_of(self.signals)
        self.begun, self.motion, self.derivatives = begun, motion.begun() if begun else motion, SMOOTH
        # Weights of one sign; what lags behind its input, as a piezo stage does, turns the other way round.
        self._identify(signs[0], ELEMENTS, {})
        usual = vars(self).copy()
        if len(signs) > 1 and (self.error > GOOD_ENOUGH or np.any(self.rates)):
            self._take_if_closer(lambda: self._identify(signs[1], ELEMENTS, {}))
        if self.error > EMULATED:
            self._grow_by_derivatives()
        undecided = False
        if self.sign != usual["sign"] and self.error > EMULATED:
            # Which sign was closer by a little before anything had grown says little of which is afterwards.
            grown = self.error
            other = self._take_if_closer(lambda: self._grow_from(usual))
            undecided = CLEARLY < other / grown < 1.0 / CLEARLY
        self.signs = signs if undecided else (self.sign,)

    def _grow_from(self, start: Mapping[str, Any]) -> None:
        """The same as :meth:`_grow_by_derivatives` from what had been identified at ``start``."""
        vars(self).update(start)
        self._grow_by_derivatives()

    def _grow_by_derivatives(self) -> None:
        """Identify all anew with the derivatives of the motion that the simulator takes, where its friction tells them."""
        if not self.signals.timed:
            self._grow(self.placing)
            return
        start = vars(self).copy()
        motions = {name: self.motion.differenced(name) for name in (SMOOTH, *DIFFERENCES)}
        elements = elements_of(self.motion, self.thresholds, self.lengths)
        left = {name: self._left_by_speed(motion, elements) for name, motion in motions.items()}
        others = sorted(DIFFERENCES, key=left.__getitem__)
        first = others[0] if left[others[0]] < CLEARLY * left[SMOOTH] else SMOOTH
        self.derivatives, self.motion = first, motions[first]
        self._grow(self.placing)
        by_speed = [name for name, kind in KINDS.items() if kind.by_speed]
        if first != SMOOTH or not set(by_speed).intersection(self.further):
            return

        def weigh_along(derivatives: str) -> None:
            self.derivatives, self.motion = derivatives, motions[derivatives]
            further = {name: found["sizes"] for name, found in self.further.items()}
            self._identify(self.sign, self.thresholds.size, further)

        def grow_along(derivatives: str) -> None:
            vars(self).update(start, derivatives=derivatives, motion=motions[derivatives])
            self._grow([name for name in by_speed if name in self.placing])

        for other in others:
            if self.error > EMULATED:
                # Growing takes its time: with the same sizes first.
                here, there = self.error, self._tried(functools.partial(weigh_along, other))["error"]
                if there < FARTHER * here and abs(there - here) > ALL_THE_SAME * here:
                    self._take_if_closer(functools.partial(grow_along, other))

    def _grow(self, placing: Collection[str]) -> None:
        """Identify all anew with as many stops and with the further elements that are needed.

        Of the kinds that are moved to their places those in ``placing`` are tried.
        """
        elements, further = self._enlarged(placing)
        if elements > ELEMENTS or further or self.derivatives != SMOOTH:
            self._identify(self.sign, elements, further)
        for _ in range(PLACINGS):
            # There are none, or none is left: a kink at the end of the stroke has no torque, so no weight either.
            if KINKS not in self.further:
                break
            further[KINKS] = self._placed_kinks()
            self._identify(self.sign, elements, further)

    def _identify(self, sign: float, elements: int, further: Mapping[str, Floats]) -> None:
        """Weights of all elements, of which those with memory have one sign."""
        signals = self.signals
        self.sign = sign
        self.thresholds = _thresholds(self.reach, elements)
        elastic, stops, placed = parts_of(self.motion, self.reach, self.thresholds, self.lengths)
        made = {name: KINDS[name].columns(self.motion, sizes) for name, sizes in further.items()}
        free = {ELASTIC: elastic, PLACED: placed, RATES: self._rates()}
        free |= {name: made[name] for name in made if not KINDS[name].one_sign}
        bounded = {STOPS: sign * stops} | {name: sign * made[name] for name in made if KINDS[name].one_sign}
        columns = np.hstack([*free.values(), *bounded.values()])
        places, several = places_of(free | bounded), sum(part.shape[1] for part in free.values())
        seen, wanted = (
            (columns, signals.y_sim) if self.known.all() else (columns[self.known], signals.y_sim[self.known])
        )
        moments = seen.T @ wanted
        products = np.block([[seen.T @ seen, moments[:, None]], [moments, wanted @ wanted]])

        def solved(at: NDArray[np.intp]) -> tuple[Floats, float]:
            """Weights of the columns ``at``, zero of the others, and the error that they leave."""
            weights = np.zeros(columns.shape[1])
            free_ones = int(np.count_nonzero(at < several))
            chosen = np.ix_([*at, -1], [*at, -1])
            weights[at] = solve(products[chosen], elastic.shape[1], free_ones, wanted.size)
            return weights, relative_error(seen @ weights, wanted)

        everything = np.arange(columns.shape[1])
        solution, self.error = solved(everything)
        # Speed is as good as friction where all strokes are alike, but it answers quite differently to another input:
        # it has to be needed.
        calm, without = solved(np.delete(everything, places[RATES]))
        if without < RATES_NEEDED * self.error:
            solution, self.error = calm, without
        found = {name: solution[at] * (sign if name in bounded else 1.0) for name, at in places.items()}
        self.elastic, self.placed, self.rates, self.weights = (
            found.pop(name) for name in (ELASTIC, PLACED, RATES, STOPS)
        )
        self.further = {
            name: {"sizes": further[name][weights != 0.0], "weights": weights[weights != 0.0]}
            for name, weights in found.items()
            if np.any(weights)
        }

    def _find_kernels(self) -> None:
        """Identify all with kernels: many of them follow much that is another law, so by themselves, and only where none was found.

        Where memory began, and until when it is not known, was found without them.
        """
        self.placing = [KERNELS]
        self._find(self.begun, self.signs)
        if KERNELS not in self.further:
            self.error = np.inf

    def _enlarged(self, placing: Collection[str]) -> tuple[int, dict[str, Floats]]:
        """How many stops, and the sizes of which further elements, are needed."""
        signals = self.signals
        elastic, stops, placed = parts_of(self.motion, self.reach, _thresholds(self.reach, FINER), self.lengths)
        there = {ELASTIC: elastic, STOPS: stops, PLACED: placed, RATES: self._rates()}
        few = np.concatenate([np.arange(0, FINER, spacing(FINER)), np.arange(FINER, stops.shape[1])])
        kinds = dict(KINDS)
        if not signals.timed:
            # There is no telling at which speed anything gives way.
            kinds = {name: kind for name, kind in KINDS.items() if not (kind.timed or (kind.limits and kind.by_speed))}
        along = self.begun, self.derivatives
        if along not in self._choices:
            self._choices[along] = Choices(self._extent, self.motion)
        growth = Growth(there, few, self.sign, kinds, self._choices[along], signals.y_sim, self.known)
        finer, further = growth.needed(placing)
        return FINER if finer else ELEMENTS, further

    def _placed_kinks(self) -> Floats:
        """Sizes of the kinks, moved to where they leave least, by one step of a Gauss-Newton method."""
        sizes, weights = self.further[KINKS]["sizes"], self.further[KINKS]["weights"]
        moved = kinks_moved(self.motion, sizes, weights)
        left = self.signals.y_sim - self.predict(self.signals.x)
        kinks = KINDS[KINKS].columns(self.motion, sizes)
        elastic = _elastic(self.signals.x, self.reach)
        columns = np.hstack([moved, kinks, elastic])[self.known]
        step = np.linalg.lstsq(columns, left[self.known], rcond=1e-10)[0][: weights.size]
        most = 0.04 * self.reach
        return np.clip(sizes + np.clip(step, -most, most)[:, None], -self.reach, self.reach)

    def _left_by_speed(self, motion: Motion, elements: Floats) -> float:
        """What friction that knows the speed of ``motion`` leaves beside the elements in any case, N·m.

        These are ``elements`` (n, any) wherever memory knows the deflection as it does in this one's motion.
        """
        if motion.path is not self.motion.path:
            elements = elements_of(motion, self.thresholds, self.lengths)
        some, kind = spread(self.known, FEW), KINDS[BY_SPEED]
        rates = rates_of(motion.speed, motion.acceleration, self.fast)
        friction = kind.columns(motion, kind.sizes(self._extent))
        elastic = _elastic(motion.x, self.reach)
        columns = np.hstack([part[some] for part in (elastic, elements, rates, friction)])
        columns /= np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
        target = self.signals.y_sim[some]
        # Least squares by the products' modes, which takes less than by the singular values of so many rows.
        sizes, modes = np.linalg.eigh(columns.T @ columns)
        told = sizes > RESOLVED**2 * sizes[-1]
        weights = modes[:, told] @ ((modes[:, told].T @ (columns.T @ target)) / sizes[told])
        return rms(target - columns @ weights)

    @cached_property
    def _extent(self) -> Extent:
        signals = self.signals
        duration = max(float(signals.time[run][-1] - signals.time[run][0]) for run in signals.runs)
        return Extent(self.reach, self.fast, signals.interval, duration)

    def _rates(self) -> Floats:
        return rates_of(self.motion.speed, self.motion.acceleration, self.fast)

    def parameters(self) -> dict[str, Any]:
        """All that :func:`predict_generalised` needs."""
        return {
            "reach": self.reach, "thresholds": self.thresholds, "lengths": self.lengths, "elastic": self.elastic,
            "placed": self.placed, "weights": self.weights, "rates": self.rates, "fast": self.fast,
            "further": self.further, "derivatives": self.derivatives, "begun": self.begun,
        }  # fmt: skip

    def predict(self, x: Floats) -> Floats:
        return predict_beside(self.parameters(), self.signals, x)


def predict_anew(parameters: Mapping[str, Any], interval: float, x: Floats) -> Floats:
    """Output of what was identified over one new motion, of samples ``interval`` seconds apart."""
    time = interval * np.arange(x.size, dtype=np.float64)
    _, speed, acceleration = differentiate(time, x)
    return predict_generalised(parameters, Motion(time, x, [slice(0, x.size)], lambda: (speed, acceleration)))


def predict_beside(parameters: Mapping[str, Any], signals: Signals, x: Floats) -> Floats:
    """Output of what was identified for another input ``x`` (n,) at the samples of ``signals``."""
    return predict_generalised(parameters, motion_beside(signals, x))


def relative_error(predicted: Floats, wanted: Floats) -> float:
    """RMS of the difference over the standard deviation of what is wanted."""
    return rms(predicted - wanted) / max(float(np.std(wanted)), 1e-300)


def _begins_to_follow(left: Floats) -> int:
    """From which sample on much less is ``left`` (n,) of a run than before; 0 where it is not so."""
    squares = np.cumsum(np.square(left)) + 1e-300
    cuts = np.unique(np.linspace(0.0, LATEST * left.size, CUTS + 1).astype(np.intp))[1:]
    if not cuts.size:
        return 0
    first, rest = squares[cuts - 1] / cuts, (squares[-1] - squares[cuts - 1] + 1e-300) / (left.size - cuts)
    # Where two levels make what is left likelier than anywhere else.
    at = int(np.argmin(cuts * np.log(first) + (left.size - cuts) * np.log(rest)))
    return int(cuts[at]) if first[at] > BEFORE**2 * rest[at] else 0


def motion_of(signals: Signals) -> Motion:
    """The recorded input as the emulator's elements see it."""
    return Motion(signals.time, signals.x, signals.runs, lambda: (signals.speed, signals.acceleration))


def motion_beside(signals: Signals, x: Floats) -> Motion:
    """Another input ``x`` (n,) at the samples of ``signals`` as the emulator's elements see it."""
    change = x - signals.x
    if not np.any(change):
        return motion_of(signals)

    def slopes() -> tuple[Floats, Floats]:
        # The change is far smoother than the measured input, so it may be differentiated as it is.
        added = signals.slope(change)
        return signals.speed + added, signals.acceleration + signals.slope(added)

    return Motion(signals.time, x, signals.runs, slopes, recorded=signals.x)


def _thresholds(reach: float, count: int) -> Floats:
    return np.geomspace(0.004, 0.8, count) * reach


def _elastic(x: Floats, reach: float) -> Floats:
    return np.asarray(np.polynomial.legendre.legvander(_place(x, reach), DEGREE))


def elements_of(motion: Motion, thresholds: Floats, lengths: Floats) -> Floats:
    """Stops and then bristles, shape (n, thresholds + lengths)."""
    stops = motion.path[:, None] - np.concatenate([plays(motion.path[run], thresholds) for run in motion.runs])
    bristles = [length * motion.from_rest(bristle, length=length) for length in lengths]
    return np.column_stack([stops, *bristles])


def parts_of(motion: Motion, reach: float, thresholds: Floats, lengths: Floats) -> tuple[Floats, Floats, Floats]:
    """Columns of the elastic curve, of the elements with memory, and of stops weighed by position."""
    elements = elements_of(motion, thresholds, lengths)
    placed = elements[:, : thresholds.size][:, _placed(thresholds.size)]
    weighed_so = [placed * w[:, None] for w in _weights(_place(motion.x, reach))]
    return _elastic(motion.x, reach), elements, np.hstack(weighed_so)


def _place(x: Floats, reach: float) -> Floats:
    # Polynomials are not to be trusted far beyond the recorded stroke: they end there.
    return np.asarray(np.clip(x / reach, -1.3, 1.3))


def spacing(elements: int) -> int:
    """How many of so many stops there are for each coarse one."""
    return max((elements - 1) // (ELEMENTS - 1), 1)


def _placed(elements: int) -> slice:
    """Those stops whose torque may depend on where they are: the same ones however many there are between them."""
    every = 2 * spacing(elements)
    return slice(every, None, every)


def _by_place(parameters: Mapping[str, Any]) -> Floats:
    """Weights of all stops for each way in which their torque may depend on where they are, shape (``PLACES``, stops)."""
    count = np.asarray(parameters["thresholds"]).size
    placed = np.zeros((PLACES, count))
    placed[:, _placed(count)] = np.reshape(parameters["placed"], (PLACES, -1))
    return placed


def stops_along(parameters: Mapping[str, Any], x: Floats) -> Floats:
    """Weights of all stops, N·m/rad, where the joint is, at ``x`` (n,), shape (n, stops)."""
    placed = _by_place(parameters)
    everywhere = np.asarray(parameters["weights"])[: placed.shape[1]]
    if not np.any(placed):
        return np.broadcast_to(everywhere, (x.size, everywhere.size))
    return everywhere + np.column_stack(_weights(_place(x, parameters["reach"]))) @ placed


def _weights(u: Floats) -> tuple[Floats, ...]:
    """How an element's torque may depend on its place, ``PLACES`` of them."""
    # A power takes many times as long as a product.
    return u, u * u, np.abs(u), u * u * u


def rates_of(speed: Floats, acceleration: Floats, fast: float) -> Floats:
    """What a simulator with friction of its own may know of speed: damping, inertia, a regularised sign."""
    return np.column_stack([speed, acceleration, *(np.tanh(speed / (share * fast)) for share in STEEPNESS)])


def predict_generalised(parameters: Mapping[str, Any], motion: Motion, dragging: bool = True) -> Floats:
    """Output of the built-in emulator, N·m, shape (n,), from the virgin state in each run; or without what :func:`drag_of` is."""
    motion = as_seen(parameters, motion)
    path, weights = motion.path, np.asarray(parameters["weights"])
    u = _place(motion.x, parameters["reach"])
    thresholds, lengths = np.asarray(parameters["thresholds"]), np.asarray(parameters["lengths"])
    placed = _by_place(parameters)
    stops, signs = weights[: thresholds.size], weights[thresholds.size :]
    y = np.polynomial.legendre.legval(u, parameters["elastic"])
    # Summed as they come: the columns that an identification needs are never made, and most have no weight.
    stopping, bristling = (stops != 0.0) | np.any(placed != 0.0, axis=0), signs != 0.0
    thresholds, stops, placed = thresholds[stopping], stops[stopping], np.ascontiguousarray(placed[:, stopping])
    lengths, signs = lengths[bristling], signs[bristling]
    y += np.concatenate([weighed(path[run], u[run], thresholds, stops, placed, lengths, signs) for run in motion.runs])
    y += torque_of(parameters.get("further", {}), motion, dragging=dragging)
    return np.asarray(y + _drag(parameters, motion) if dragging else y)


def drag_of(parameters: Mapping[str, Any], motion: Motion) -> Floats:
    """What of the built-in emulator's output follows speed and acceleration alone, N·m, shape (n,)."""
    motion = as_seen(parameters, motion)
    return _drag(parameters, motion) + drag_among(parameters.get("further", {}), motion)


def _drag(parameters: Mapping[str, Any], motion: Motion) -> Floats:
    if not np.any(parameters["rates"]):
        return np.zeros(motion.x.size)
    return np.asarray(rates_of(motion.speed, motion.acceleration, float(parameters["fast"])) @ parameters["rates"])


def as_seen(parameters: Mapping[str, Any], motion: Motion) -> Motion:
    """A motion with the derivatives that the simulator takes, from where its memory begins."""
    motion = motion.begun() if parameters.get("begun", False) else motion
    return motion.differenced(str(parameters.get("derivatives", SMOOTH)))


def spring_of(parameters: Mapping[str, Any], x: Floats) -> Floats:
    """The elastic part of the built-in emulator's output, N·m, shape (n,): what it has at rest is a preload."""
    elastic = np.asarray(parameters["elastic"])
    curve = np.polynomial.legendre.legval(_place(x, parameters["reach"]), elastic)
    kinks = torque_of(parameters.get("further", {}), Motion(x, x, [slice(0, x.size)], lambda: (x, x)), ELASTIC)
    return np.asarray(curve + kinks)


def strengthened(parameters: Mapping[str, Any], motion: Motion, gain: float, timed: bool = True) -> Floats:
    """Change of the built-in emulator's output for a relative ``gain`` of the strength of what has memory, N·m, shape (n,).

    And, where the motion is ``timed``, of friction that knows the speed alone: without a clock it only tells the direction.
    """
    rates, fast = np.array(parameters["rates"]), float(np.std(as_seen(parameters, motion).speed))
    if timed:
        rates[-len(STEEPNESS) :] *= 1.0 + gain
    stronger = dict(parameters) | {
        "thresholds": (1.0 + gain) * np.asarray(parameters["thresholds"]),
        "lengths": (1.0 + gain) * np.asarray(parameters["lengths"]),
        "rates": rates,
        "further": strengthened_among(parameters.get("further", {}), gain, fast),
    }
    return predict_generalised(stronger, motion) - predict_generalised(parameters, motion)
