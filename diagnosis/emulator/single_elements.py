"""The torque of the elements that simulators of joints are made of, each for a weight of one.

What takes sizes one by one gives one element, shape (n,); what takes ``sizes`` (k, m) gives all, shape (n, k).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.special import expit

from ...models.dahl import friction
from ..operators.chambers import chamber
from ..operators.kernels import kernel
from ..operators.levels import attracted, elastoplastic, yielding
from ..operators.magnetic import magnetised
from ..operators.memory import bristle, enveloped, hyperbolic, lagged, lowpass, plays, pressed
from ..operators.superelastic import superelastic
from .motion import Motion

__all__ = [
    "at_low_speed",
    "behind_play",
    "belt",
    "beyond_clearance",
    "by_speed",
    "by_speed_and_side",
    "capstan",
    "corner",
    "curved",
    "curved_together",
    "damping",
    "damping_beyond",
    "gripping",
    "in_contact",
    "kink",
    "lag",
    "lagging",
    "lagging_together",
    "leaning",
    "leaves",
    "levered",
    "magnet",
    "preload",
    "pressed_by_speed",
    "ripple",
    "rubber",
    "rubber_splined",
    "slipping",
    "snubber",
    "softly_beyond_clearance",
    "stops",
    "stribeck",
    "stribeck_pressed",
    "stronger_at_rest",
    "stronger_in_motion",
    "tendon",
    "wire",
]

Floats = NDArray[np.float64]
LEAST = 0.02
"""Share of its level at the middle that a stop keeps where nothing presses it."""


def kink(motion: Motion, place: float) -> Floats:
    """A spring that engages beyond ``place``, rad, on its side of the middle."""
    return np.asarray(np.maximum(motion.x - place, 0.0) if place > 0.0 else np.minimum(motion.x - place, 0.0))


def corner(motion: Motion, place: float, width: float) -> Floats:
    """A spring that engages beyond ``place`` on either side of the middle, smooth over ``width``, rad."""
    above, below = (np.logaddexp(0.0, (x - place) / width) for x in (motion.x, -motion.x))
    return np.asarray(width * (above - below))


def ripple(motion: Motion, length: float, phase: float, power: int = 0) -> Floats:
    """A torque that comes again after a way of 2π ``length``, rad, none at rest: detents, poles and slots, teeth.

    Times a ``power`` of the deflection.
    """
    wave = np.sin(motion.x / length + phase)
    return np.asarray(wave * motion.x**power if power else wave - np.sin(phase))


def preload(motion: Motion, place: float, width: float) -> Floats:
    """A preload that turns round at ``place``, smooth over ``width``, rad; none at rest."""
    return np.asarray(expit((motion.x - place) / width) - expit(-place / width))


def damping(motion: Motion, power: float, back: float, by_place: float = 0.0) -> Floats:
    """Damping by a ``power`` of the speed, on the way back ``back`` times as much, and by a power of the deflection."""
    by_side = np.where(motion.speed > 0.0, 1.0, -back) * np.abs(motion.speed) ** power
    return np.asarray(by_side * motion.x**by_place)


def damping_beyond(motion: Motion, place: float, width: float, back: float) -> Floats:
    """Damping beyond ``place``, smooth over ``width``, rad, on the way back ``back`` times as much."""
    return damping(motion, 1.0, back) * expit((motion.x - place) / width)


def pressed_by_speed(motion: Motion, pace: float, power: float) -> Floats:
    """Friction that a ``power`` of the deflection presses, its sign smooth over ``pace``, rad/s."""
    return np.asarray(np.tanh(motion.speed / pace) * np.abs(motion.x) ** power)


def leaves(
    motion: Motion,
    length: float,
    back: float,
    growth: float,
    place: float = 0.0,
    hardening: float = 0.0,
    level: Floats | float = 1.0,
) -> Floats:
    """Friction between leaves, which are pressed together the more the farther they are bent, or by a spring that hardens.

    It is ``level`` (n,) times as strong.
    """
    along = np.broadcast_to(level, motion.x.shape)
    return length * motion.from_rest(
        enveloped, along, length=length, back=back, growth=growth, place=place, hardening=hardening
    )


def capstan(motion: Motion, length: float, exponent: float, wrap: float, growth: float) -> Floats:
    """Friction of a tendon, whose tension grows by ``growth`` (1/rad) with the deflection, over a sheath or a capstan.

    The tension on its other side is exp(``wrap`` z) as large, z a slider by Dahl of this ``length`` (rad) and ``exponent``.
    """
    return np.asarray(np.exp(growth * motion.x) * _wrapped(motion, length, exponent, wrap))


def _wrapped(motion: Motion, length: float, exponent: float, wrap: float) -> Floats:
    """What friction of a capstan adds to a tension of one, over ``wrap``; times the slider's length."""
    slid = motion.from_rest(friction, length=length, exponent=exponent)
    return np.asarray(length * (np.expm1(wrap * slid) / wrap if wrap else slid))


def belt(motion: Motion, length: float, exponent: float, back: float, growth: float) -> Floats:
    """Friction by what a belt's tensioner carries, 1 + ``growth`` x (1/rad) at the deflection x, ``back`` times as much where it lets go.

    A slider by Dahl of this ``length`` (rad) and ``exponent``, whose side tells that.
    """
    slid = motion.from_rest(friction, length=length, exponent=exponent)
    return np.asarray(length * (1.0 + growth * motion.x) * np.where(slid > 0.0, slid, back * slid))


def snubber(motion: Motion, length: float, exponent: float, back: float, growth: float) -> Floats:
    """A slider by Dahl of this ``length`` (rad) and ``exponent`` that wedges press, the more the farther off the middle.

    By ``growth`` (1/rad); it gives way at ``back`` times as much on the way back to the middle.
    """

    def answer(x: Floats) -> Floats:
        # On its way through the middle it turns from returning to moving out: no sample is there.
        passed = np.flatnonzero(x[1:] * x[:-1] < 0.0) + 1
        way = np.insert(x, passed, 0.0)
        middle = 0.5 * (way + np.concatenate([way[:1], way[:-1]]))
        returns = middle * np.diff(way, prepend=way[0]) < 0.0
        level = (1.0 + growth * np.abs(middle)) * np.where(returns, back, 1.0)
        return yielding(way, level, length, exponent)[np.insert(np.ones(x.size, dtype=bool), passed, False)]

    return length * motion.from_rest(answer)


def tendon(motion: Motion, length: float, exponent: float, wrap: float, place: float, width: float) -> Floats:
    """The same of a tendon whose tension grows by the square of how far it is pulled beyond where it is slack.

    It is slack beyond -``place``, rad, smooth over ``width``, rad; its side is the sign of that.
    """
    side = np.sign(place)
    pulled = width * np.logaddexp(0.0, (abs(place) + side * motion.x) / width) / abs(place)
    return np.asarray(np.square(pulled) * _wrapped(motion, length, exponent, side * wrap))


def leaning(motion: Motion, length: float, growth: float) -> Floats:
    """A stop that gives way at ``length``, rad, on its side of the middle later by ``growth`` (1/rad): pressed from one side."""
    return motion.from_rest(lambda x: pressed(x, length, np.inf, 1.0, level=np.maximum(1.0 + growth * x, LEAST)))


def rubber(motion: Motion, length: float) -> Floats:
    """Friction that has grown by half of what is left after ``length``, rad (Berg, Vehicle System Dynamics 30, 1998)."""
    return length * motion.from_rest(hyperbolic, length=length)


def rubber_splined(motion: Motion, length: float) -> Floats:
    """The same of a simulator that goes along a spline through the samples: it turns, and begins anew, where that overshoots a stop."""
    return length * np.concatenate([hyperbolic(way, length=length)[1::2] for way in motion.splined])


def _level(motion: Motion, pace: float, excess: float, power: float) -> Floats:
    """The Stribeck curve: it falls with a ``power`` of the speed, by ``pace`` (rad/s), from 1 + ``excess`` to 1."""
    return np.asarray(1.0 + excess * np.exp(-_power(np.abs(motion.speed / pace), power)))


def stribeck(
    motion: Motion,
    length: float,
    pace: float,
    excess: float,
    damping: float = 0.0,
    power: float = 2.0,
    level: Floats | float = 1.0,
) -> Floats:
    """A LuGre element that yields at a level which falls with speed, by ``pace`` (rad/s), from 1 + ``excess`` to 1.

    Its bristles resist their own speed by ``damping`` (s) times their stiffness; the level falls with a ``power`` of the speed, and is
    ``level`` (n,) times as high.
    """
    level = level * _level(motion, pace, excess, power)
    built_up = motion.from_rest(yielding, level, length=length)
    bending = motion.speed - np.abs(motion.speed) * built_up / level
    return length * built_up + damping * bending


def gripping(motion: Motion, length: float, pace: float, excess: float, power: float) -> Floats:
    """A Dahl bristle that is as much stiffer as it is stronger at low speed, so that it yields over the same ``length``."""
    built_up = motion.from_rest(bristle, length=length)
    return length * built_up * _level(motion, pace, excess, power)


def stribeck_pressed(motion: Motion, length: float, pace: float, excess: float, growth: float) -> Floats:
    """The same whose level grows by ``growth`` (1/rad) with the deflection, as the load of gears and bearings does."""
    return stribeck(motion, length, pace, excess, level=1.0 + growth * np.abs(motion.x))


def breaking_away(
    motion: Motion, length: float, pace: float, excess: float, damping: float, breakaway: float
) -> Floats:
    """The same of an elasto-plastic bristle, which does not creep below the share ``breakaway`` of its level."""
    level = _level(motion, pace, excess, 2.0)
    return length * motion.from_rest(
        lambda x, time, level: elastoplastic(time, x, level, length, breakaway, damping), motion.time, level
    )


def slipping(
    motion: Motion,
    length: float,
    pace: float,
    excess: float,
    settling: float,
    power: float = 2.0,
    sudden: bool = False,
) -> Floats:
    """A Maxwell slip element that holds at a level which falls with speed, by ``pace`` (rad/s), from 1 + ``excess`` to 1.

    By a ``power`` of the speed.
    """
    level = _level(motion, pace, excess, power)
    return motion.from_rest(
        lambda x, time, level: attracted(time, x, level, length, settling, sudden), motion.time, level
    )


def _somewhere(motion: Motion, answer: Callable[..., Floats], *others: Floats) -> Floats:
    """What an operator answers that knows where it is also where its memory begins elsewhere.

    It is asked for the deflection, where its memory begins, and ``others`` (n,) along the way.
    """

    def along(path: Floats, x: Floats, *others: Floats) -> Floats:
        begun = float(x[-1] - path[-1])
        return answer(path + begun, begun, *others)

    return motion.from_rest(along, motion.x, *others)


def wire(motion: Motion, length: float, power: float, after: float, tail: float, steepness: float) -> Floats:
    """A superelastic wire."""
    return _somewhere(motion, lambda x, begun: superelastic(x, length, power, after, tail, steepness, begun))


def magnet(motion: Motion, pinning: float, shape: float, coupling: float, free: float) -> Floats:
    """A magnet with pinned domains."""
    return _somewhere(motion, lambda x, begun: magnetised(x, pinning, shape, coupling, free, begun))


def leaking_chamber(
    motion: Motion, corner: float, share: float, pace: float, exponent: float, seal: float, width: float
) -> Floats:
    """A chamber of gas and its seal."""
    return _somewhere(
        motion,
        lambda x, begun, time: chamber(time, x, corner, share, pace, exponent, seal, width, begun),
        motion.time,
    )


def switching(motion: Motion, width: float, length: float, place: float) -> Floats:
    """A spring that lets go by ``length`` (rad) beyond ``place`` + ``width`` and takes hold again below ``place`` + ``length`` on the way back."""
    return _somewhere(motion, lambda x, begun: -kernel(x, width, length, place, begun))


def _late(motion: Motion, series: Floats, constant: float) -> Floats:
    """``series`` (n,) as it is told behind a lag of the time constant ``constant``, s, settled where each run begins."""
    return np.concatenate([lowpass(motion.time[run], series[run], constant) for run in motion.runs])


def by_speed(motion: Motion, pace: float, corner: float, ahead: float) -> Floats:
    """A sign of the speed that grows linearly up to ``pace`` (rad/s), its corners there rounded over ``corner`` of it.

    With wide ones it is a hyperbolic tangent. Engines for rigid bodies look at the speed that will be: ``ahead`` (s) times
    the acceleration more.
    """
    asked = np.array([[1.0], [-1.0]]) * pace + motion.speed + ahead * motion.acceleration
    size = np.abs(asked) / (corner * pace)
    # Logarithms of cosines, for they overflow.
    beyond, before = size + np.log1p(np.exp(-2.0 * size))
    return np.asarray(0.5 * corner * (beyond - before))


def by_speed_and_side(motion: Motion, pace: float, ahead: float, width: float, late: float) -> Floats:
    """A sign of the speed that is smooth over ``pace`` (rad/s) and turns earlier on the way back from either side.

    By ``ahead`` of that, smooth over ``width`` (rad) about the middle; it follows with the time constant ``late``, s.
    """
    sign = np.tanh(motion.speed / pace + ahead * np.tanh(motion.x / width))
    return _late(motion, sign, late)


def at_low_speed(motion: Motion, pace: float, corner: float) -> Floats:
    """Friction that is there at low speeds only: it falls by ``pace`` (rad/s), its sign is smooth over ``corner`` (rad/s)."""
    return np.asarray(np.tanh(motion.speed / corner) * np.exp(-np.square(motion.speed / pace)))


def in_contact(motion: Motion, place: float, width: float) -> Floats:
    """Damping of what touches beyond ``place`` on either side, a little earlier or later by ``width``, rad."""
    return np.asarray(0.5 * motion.speed * (1.0 + np.tanh((np.abs(motion.x) - place) / width)))


def lag(motion: Motion, constant: float) -> Floats:
    """By how much a deflection that follows with the time constant ``constant``, s, is behind."""
    return _late(motion, motion.x, constant) - motion.x


def _plays(motion: Motion, half_widths: Floats) -> tuple[Floats, NDArray[np.intp]]:
    """Plays (n, k) of the different ones of so many half widths, and which of them each is."""
    different, which = np.unique(half_widths, return_inverse=True)
    return np.concatenate([plays(motion.path[run], different) for run in motion.runs]), which


def stops(motion: Motion, sizes: Floats) -> Floats:
    """Springs with sliders that give way at their first size, rad."""
    played, which = _plays(motion, sizes[:, 0])
    return np.asarray(motion.path[:, None] - played[:, which])


def saturating(motion: Motion, sizes: Floats) -> Floats:
    """The same whose torque saturates within the first size, by the hyperbolic tangent of up to the second."""
    length, curvature = sizes.T
    return np.asarray(length * np.tanh(curvature * stops(motion, sizes) / length) / np.tanh(curvature))


def beyond_clearance(motion: Motion, length: float, clearance: float) -> Floats:
    """A stop that engages beyond ``clearance`` (rad) on either side of the middle: a later stage of a torsional damper."""
    engaged = motion.path - np.clip(motion.path, -clearance, clearance)
    return stops(replace(motion, course=engaged), np.array([[length]]))[:, 0]


def softly_beyond_clearance(motion: Motion, length: float, clearance: float, width: float) -> Floats:
    """A bristle that engages beyond ``clearance`` (rad) on either side of the middle, smooth over ``width`` (rad)."""
    size = np.abs(motion.path) - clearance
    engaged = size + np.hypot(size, width) - (np.hypot(clearance, width) - clearance)
    return replace(motion, course=0.5 * np.sign(motion.path) * engaged).from_rest(bristle, length=length)


def behind_play(motion: Motion, sizes: Floats) -> Floats:
    """Stops that give way at their first size (rad), each moved through a play of the second (rad): plays add up."""
    inner, of_inner = _plays(motion, sizes[:, 1])
    outer, of_outer = _plays(motion, sizes.sum(axis=1))
    return np.asarray(inner[:, of_inner] - outer[:, of_outer])


def levered(motion: Motion, length: float, slope: float, bend: float) -> Floats:
    """A stop behind a lever that is 1 + ``slope`` x + ``bend`` x² long at the deflection x: a cam, a linkage, a tendon on a bone."""
    x = motion.path
    gone = x * (1.0 + x * (slope / 2.0 + x * bend / 3.0))
    return (1.0 + x * (slope + x * bend)) * stops(replace(motion, course=gone), np.array([[length]]))[:, 0]


def stronger_at_rest(motion: Motion, sizes: Floats) -> Floats:
    """Stops times what falls with the speed by a pace (rad/s)."""
    return stops(motion, sizes) * np.exp(-np.abs(motion.speed)[:, None] / sizes[:, 1])


def stronger_in_motion(motion: Motion, sizes: Floats) -> Floats:
    """Stops times what grows with the speed, to one far above a pace (rad/s)."""
    speed = np.abs(motion.speed)[:, None]
    return stops(motion, sizes) * speed / (speed + sizes[:, 1])


def lagging(motion: Motion, sizes: Floats) -> Floats:
    """What stops change by when each lags behind by a time constant."""
    played, which = _plays(motion, sizes[:, 0])
    stops = motion.path[:, None] - played
    columns = np.empty((motion.x.size, len(sizes)))
    for k, constant in enumerate(sizes[:, 1]):
        stop = stops[:, which[k]]
        columns[:, k] = _late(motion, stop, constant) - stop
    return columns


def lagging_together(motion: Motion, sizes: Floats, weights: Floats) -> Floats:
    """Stops with the same time constant lag as one."""
    widths, of_width = np.unique(sizes[:, 0], return_inverse=True)
    constants, of_constant = np.unique(sizes[:, 1], return_inverse=True)
    shared = np.zeros((widths.size, constants.size))
    np.add.at(shared, (of_width, of_constant), weights)
    every = (lagged(motion.time[run], motion.path[run], widths, shared, constants) for run in motion.runs)
    return np.concatenate(list(every))


def curved(motion: Motion, sizes: Floats) -> Floats:
    """Products of powers of plays and of the deflection."""
    played, which = _plays(motion, sizes[:, 0])
    return np.asarray(played[:, which] ** sizes[:, 1] * motion.x[:, None] ** sizes[:, 2])


def curved_together(motion: Motion, sizes: Floats, weights: Floats) -> Floats:
    """Plays with the same powers are multiplied as one."""
    played, which = _plays(motion, sizes[:, 0])
    total = np.zeros(motion.x.size)
    for powers in np.unique(sizes[:, 1:], axis=0):
        shared = np.bincount(which, weights * np.all(sizes[:, 1:] == powers, axis=1), played.shape[1])
        total += _power(played, powers[0]) @ shared * _power(motion.x, powers[1])
    return total


def _power(base: Floats, exponent: float) -> Floats:
    # Products take far less than powers.
    return np.asarray(np.prod([base] * int(exponent), axis=0) if exponent in (1.0, 2.0, 3.0) else base**exponent)
