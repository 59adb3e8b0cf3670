"""Compiled operators with memory that effects and the emulator are made of."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = [
    "bristle",
    "creeping",
    "dashed",
    "enveloped",
    "hardening",
    "held_inside",
    "hyperbolic",
    "lagged",
    "leaky",
    "lowpass",
    "orifice",
    "plays",
    "pressed",
    "weighed",
]

Floats = NDArray[np.float64]
SAME_STEP = 1e-9
"""Relative difference of two intervals that is only rounding of the times."""
SMOOTH = 0.4
"""Longest step along a smooth loop behind a dashpot, in its own lengths over its steepness."""
NEWTON = 30
"""Steps at most to where metal yields again, or to where what is inside a drive holds."""
THROTTLED, MOST_PARTS = 0.5, 12
"""Longest step of a spring behind a throttle, over its stretch, and steps at most between two samples."""
STABLE, DASHED = 0.3, 60
"""Longest step of what creeps through a dashpot, over its time constant, and steps at most between two samples."""


@njit(cache=True)
def _plays(x, thresholds, out):
    for j in range(thresholds.size):
        r = thresholds[j]
        p = 0.0
        for i in range(x.size):
            p = min(max(p, x[i] - r), x[i] + r)
            out[i, j] = p


@njit(cache=True)
def _bristle(x, length, out):
    s = 0.0
    for i in range(1, x.size):
        moved = x[i] - x[i - 1]
        towards = 1.0 if moved > 0.0 else -1.0
        s = towards + (s - towards) * np.exp(-abs(moved) / length)
        out[i] = s


@njit(cache=True)
def _enveloped(x, level, length, back, growth, place, hardening, out):
    f = 0.0
    out[0] = 0.0
    for i in range(1, x.size):
        moved = x[i] - x[i - 1]
        towards, over = (1.0, length) if moved > 0.0 else (-1.0, length * back)
        # What the spring of a load that is nil at ``place`` has there, over its stiffness.
        towards *= 1.0 + growth * abs((x[i] - place) * (1.0 + hardening * (x[i] * (x[i] + place) + place * place)))
        towards, over = towards * level[i], over * level[i]
        f = towards + (f - towards) * np.exp(-abs(moved) / over)
        out[i] = f


@njit(cache=True)
def _pressed(x, level, length, width, power, out):
    f = 0.0
    out[0] = 0.0
    for i in range(1, x.size):
        limit = level[i] * length * (1.0 + (abs(x[i]) / width) ** power)
        f = min(max(f + x[i] - x[i - 1], -limit), limit)
        out[i] = f


@njit(cache=True)
def _hyperbolic(x, length, out):
    f, left, left_at, way = 0.0, 0.0, x[0], 0.0
    out[0] = 0.0
    for i in range(1, x.size):
        moved = x[i] - x[i - 1]
        if moved != 0.0:
            towards = 1.0 if moved > 0.0 else -1.0
            if towards != way:
                left, left_at, way = f, x[i - 1], towards
            gone = abs(x[i] - left_at)
            f = left + towards * gone / (length * (1.0 - towards * left) + gone) * (1.0 - towards * left)
        out[i] = f


# Sums may be taken in another order: that makes it up to twice as fast.
@njit(cache=True, fastmath={"reassoc", "nsz", "contract"})
def _weighed(x, u, thresholds, stops, placed, lengths, signs, out):
    played, built = np.zeros(thresholds.size), np.zeros(lengths.size)
    before = 0.0
    for i in range(x.size):
        total, here, place = 0.0, x[i], u[i]
        for j in range(thresholds.size):
            p, low, high = played[j], here - thresholds[j], here + thresholds[j]
            p = low if p < low else p
            p = high if p > high else p
            played[j] = p
            weight = stops[j] + place * (placed[0, j] + place * (placed[1, j] + place * placed[3, j]))
            total += (weight + abs(place) * placed[2, j]) * (here - p)
        moved = here - before
        before = here
        towards = 1.0 if moved > 0.0 else -1.0
        for k in range(lengths.size):
            built[k] = towards + (built[k] - towards) * np.exp(-abs(moved) / lengths[k])
            total += signs[k] * lengths[k] * built[k]
        out[i] = total


@njit(cache=True)
def _hardening(x, length, ratio, recall, slow_ratio, slow_recall, growth, settling, out):
    torque, fast, slow, flown = 0.0, 0.0, 0.0, 0.0
    wide = length * (1.0 + growth)
    most, slow_most = ratio * recall, slow_ratio * slow_recall
    out[0] = 0.0
    for i in range(1, x.size):
        torque += x[i] - x[i - 1]
        over = torque - fast - slow
        left = length * growth * np.exp(-flown / settling)
        if abs(over) > wide - left:
            way = 1.0 if over > 0.0 else -1.0
            # Flow that brings the torque back to where it yields. Over it the back stresses approach their limits
            # exponentially, so Newton's steps from none come ever closer without passing.
            a, b, flow = most - way * fast, slow_most - way * slow, 0.0
            for _ in range(NEWTON):
                one, two = a * np.exp(-flow / recall), b * np.exp(-flow / slow_recall)
                less = left * np.exp(-flow / settling)
                beyond = way * torque - flow - most + one - slow_most + two - wide + less
                flow += beyond / (1.0 + one / recall + two / slow_recall + less / settling)
                if beyond < 1e-9 * length:
                    break
            torque -= way * flow
            flown += flow
            fast = way * (most - a * np.exp(-flow / recall))
            slow = way * (slow_most - b * np.exp(-flow / slow_recall))
        out[i] = torque


@njit(cache=True)
def _dashed_rates(q, stretch, speed, length, exponent, back, after, beside, stiffness):
    crept = (length * q + beside * speed + stiffness * stretch) / (beside + after)
    stretching = speed - crept
    c = 1.0 if q * stretching > 0.0 else back
    return stretching / length * (1.0 - c * abs(q) ** exponent), stretching


@njit(cache=True)
def _dashed(time, x, length, exponent, share, after, beside, stiffness, out):
    q, stretch, back = 0.0, 0.0, 1.0 - 2.0 * share
    steep = exponent * max(1.0, abs(back)) / (SMOOTH * length)
    fast = (1.0 + stiffness) / (STABLE * (beside + after))
    out[0] = 0.0
    for i in range(1, x.size):
        dt = time[i] - time[i - 1]
        if dt <= 0.0:
            q, stretch, out[i] = 0.0, 0.0, 0.0
            continue
        speed = (x[i] - x[i - 1]) / dt
        parts = int(min(np.ceil(max(abs(x[i] - x[i - 1]) * steep, dt * fast, 1.0)), DASHED))
        h = dt / parts
        for _ in range(parts):
            a1, b1 = _dashed_rates(q, stretch, speed, length, exponent, back, after, beside, stiffness)
            a2, b2 = _dashed_rates(
                q + 0.5 * h * a1, stretch + 0.5 * h * b1, speed, length, exponent, back, after, beside, stiffness
            )
            q = min(max(q + h * a2, -1.0), 1.0)
            stretch += h * b2
        out[i] = after * (length * q + beside * speed + stiffness * stretch) / (beside + after)


@njit(cache=True)
def _inner_step(f, place, z, dt, friction, creep, after, damping, hardening):
    # How far the inner side moves in a step until its friction, dashpot and spring hold the outer spring: implicit.
    pull = f + hardening * f * f * f - after * place - friction * z
    way = 1.0 if pull > 0.0 else -1.0
    moved = 0.0
    drag = damping / dt if dt > 0.0 else 0.0
    for _ in range(NEWTON):
        left = f - moved
        decay = (z - way) * np.exp(-abs(moved) / creep)
        over = left + hardening * left * left * left - after * (place + moved) - drag * moved - friction * (way + decay)
        steep = 1.0 + 3.0 * hardening * left * left + after + drag - friction * way * decay / creep
        further = moved + over / steep
        further = max(further, 0.0) if way > 0.0 else min(further, 0.0)
        near = abs(further - moved) < 1e-6 * creep
        moved = further
        if near:
            break
    return moved


@njit(cache=True)
def _held_inside(time, x, friction, creep, after, damping, hardening, out):
    place, z = 0.0, 0.0
    out[0] = 0.0
    for i in range(1, x.size):
        dt = time[i] - time[i - 1]
        moved = _inner_step(x[i] - place, place, z, dt, friction, creep, after, damping, hardening)
        way = 1.0 if moved > 0.0 else -1.0
        z = way + (z - way) * np.exp(-abs(moved) / creep)
        place += moved
        f = x[i] - place
        out[i] = f + hardening * f * f * f


@njit(cache=True)
def _follows(dt, tau):
    # Shares of the state, of the input before and of the input now: exact for one that is linear between samples.
    decay = np.exp(-dt / tau)
    ramp = (1.0 - decay) * tau / dt
    return decay, ramp - decay, 1.0 - ramp


@njit(cache=True)
def _lowpass(time, u, tau, out):
    state, step = u[0], 0.0
    decay, before, now = 1.0, 0.0, 0.0
    out[0] = state
    for i in range(1, u.size):
        dt = time[i] - time[i - 1]
        if abs(dt - step) > SAME_STEP * step:
            step = dt
            decay, before, now = _follows(dt, tau)
        state = decay * state + before * u[i - 1] + now * u[i]
        out[i] = state


@njit(cache=True)
def _lagged(time, x, thresholds, weights, taus, out):
    slow, p, step = taus.size, np.zeros(thresholds.size), 0.0
    state, last = np.zeros(slow), np.zeros(slow)
    decay, before, now = np.ones(slow), np.zeros(slow), np.zeros(slow)
    for i in range(x.size):
        dt = time[i] - time[i - 1] if i else 0.0
        if i and abs(dt - step) > SAME_STEP * step:
            step = dt
            for c in range(slow):
                decay[c], before[c], now[c] = _follows(dt, taus[c])
        for j in range(thresholds.size):
            p[j] = min(max(p[j], x[i] - thresholds[j]), x[i] + thresholds[j])
        total = 0.0
        for c in range(slow):
            stop = 0.0
            for j in range(thresholds.size):
                stop += weights[j, c] * (x[i] - p[j])
            state[c] = decay[c] * state[c] + before[c] * last[c] + now[c] * stop if i else stop
            last[c] = stop
            total += state[c] - stop
        out[i] = total


@njit(cache=True)
def _leaky(time, x, level, tau, out):
    f, step, decay, gain = 0.0, 0.0, 1.0, 1.0
    out[0] = 0.0
    for i in range(1, x.size):
        dt = time[i] - time[i - 1]
        if abs(dt - step) > SAME_STEP * step:
            # Exact for an input that is linear between samples, until the slider gives way.
            step = dt
            decay = np.exp(-dt / tau)
            gain = (1.0 - decay) * tau / dt if dt > 0.0 else 1.0
        f = min(max(decay * f + gain * (x[i] - x[i - 1]), -level), level)
        out[i] = f


@njit(cache=True)
def _orifice(time, x, length, pace, back, out):
    f = 0.0
    out[0] = 0.0
    for i in range(1, x.size):
        dt, moved = time[i] - time[i - 1], x[i] - x[i - 1]
        parts = 1
        if dt > 0.0:
            changing = max(abs(moved), 0.1 * abs(f))
            parts = int(min(max(np.ceil(changing / (THROTTLED * (abs(f) + 0.1 * length))), 2.0), MOST_PARTS))
        h, step = dt / parts, moved / parts
        for _ in range(parts):
            # Leaking at q/pace + (q/pace)² = |f|/length, by the exponential Rosenbrock-Euler method: stable however stiff.
            bent = 1.0 if f >= 0.0 else back
            root = np.sqrt(1.0 + 4.0 * bent * abs(f) / length)
            q = 2.0 * abs(f) / length * pace / (1.0 + root)
            rate = pace / (length * root) * h
            f += (1.0 if rate < 1e-9 else (1.0 - np.exp(-rate)) / rate) * (step - (q * h if f >= 0.0 else -q * h))
        out[i] = f


@njit(cache=True)
def _creeping(time, x, tau, power, length, out):
    f, more = 0.0, power - 1.0
    out[0] = 0.0
    for i in range(1, x.size):
        # Stretched by half of the way, let go for the interval, which is exact, and stretched by the rest.
        half, size = 0.5 * (x[i] - x[i - 1]), 0.0
        f += half
        if f != 0.0:
            size = (abs(f / length) ** -more + more * (time[i] - time[i - 1]) / tau) ** (-1.0 / more) * length
        f = (size if f > 0.0 else -size) + half
        out[i] = f


def plays(x: Floats, thresholds: Floats) -> Floats:
    """Play operators of half widths ``thresholds`` (N,), each from 0, over ``x`` (n,); shape (n, N)."""
    out = np.empty((x.size, thresholds.size))
    _plays(np.ascontiguousarray(x), np.ascontiguousarray(thresholds, dtype=np.float64), out)
    return out


def weighed(
    x: Floats, u: Floats, thresholds: Floats, stops: Floats, placed: Floats, lengths: Floats, signs: Floats
) -> Floats:
    """Sum of stops and bristles from the virgin state at zero over ``x`` (n,), shape (n,).

    Stop j has the half width ``thresholds`` (N,) and the weight stops + placed[0] u + placed[1] u² + placed[2] |u| +
    placed[3] u³, ``placed`` (4, N), at the place ``u`` (n,); bristle k the length ``lengths`` (K,) and weight ``signs``.
    """
    out = np.empty(x.size)
    # Sparse identification leaves most of them without weight.
    on = (stops != 0.0) | np.any(placed != 0.0, axis=0)
    some = signs != 0.0
    parts = (x, u, thresholds[on], stops[on], placed[:, on], lengths[some], signs[some], out)
    _weighed(*(np.ascontiguousarray(part, dtype=np.float64) for part in parts))
    return out


def lagged(time: Floats, x: Floats, thresholds: Floats, weights: Floats, taus: Floats) -> Floats:
    """What stops of half widths ``thresholds`` (k,) over ``x`` (n,) change by when they lag behind, shape (n,).

    ``weights`` (k, m) of each behind each of the time constants ``taus`` (m,), s; settled where they begin.
    """
    out = np.empty(x.size)
    parts = (time, x, thresholds, weights, taus, out)
    _lagged(*(np.ascontiguousarray(part, dtype=np.float64) for part in parts))
    return out


def bristle(x: Floats, length: float) -> Floats:
    """Direction of motion that builds up over the distance ``length`` (Dahl's presliding), shape (n,), within ±1."""
    out = np.zeros(x.size)
    _bristle(np.ascontiguousarray(x), float(length), out)
    return out


def enveloped(
    x: Floats, level: Floats, length: float, back: float, growth: float, place: float = 0.0, hardening: float = 0.0
) -> Floats:
    """A bristle between envelopes ±``level`` (n,) (1 + ``growth`` |x|) over ``x`` (n,), rad, from rest, shape (n,).

    It builds up over ``length``, rad, and on the way down over ``back`` times as much (Fancher et al., SAE paper 800905, 1980).
    The envelope goes with the torque of a spring that is nil at ``place``, rad, and hardens by ``hardening``, 1/rad².
    """
    out = np.empty(x.size)
    envelope = float(growth), float(place), float(hardening)
    _enveloped(np.ascontiguousarray(x), np.ascontiguousarray(level), float(length), float(back), *envelope, out)
    return out


def pressed(x: Floats, length: float, width: float, power: float, level: Floats | float = 1.0) -> Floats:
    """A stop over ``x`` (n,) from rest that gives way at ``length``, rad, times ``level`` (n,), and later off the middle, shape (n,).

    At twice that ``width`` off it, rad, growing with a ``power`` of the deflection: friction that the spring's load presses.
    """
    out = np.empty(x.size)
    _pressed(np.ascontiguousarray(x), level * np.ones(x.size), float(length), float(width), float(power), out)
    return out


def hardening(
    x: Floats,
    length: float,
    ratio: float,
    recall: float,
    slow_ratio: float,
    slow_recall: float,
    growth: float,
    settling: float,
) -> Floats:
    """Elastic-plastic element of unit stiffness over ``x`` (n,) from rest that yields at ``length`` and hardens, shape (n,).

    Its middle moves with the plastic flow by two back stresses, each of the stiffness ``ratio`` and recalled over the flow
    ``recall``, rad (Armstrong and Frederick, 1966; Chaboche, Int. J. Plasticity 2, 1986, 149–188); the level at which it
    yields grows by the share ``growth`` over the flow ``settling``, rad.
    """
    out = np.empty(x.size)
    back = float(ratio), float(recall), float(slow_ratio), float(slow_recall)
    _hardening(np.ascontiguousarray(x), float(length), *back, float(growth), float(settling), out)
    return out


def held_inside(
    time: Floats, x: Floats, friction: float, creep: float, after: float, damping: float, hardening: float
) -> Floats:
    """Torque of a hardening spring, of unit stiffness at rest, that what is inside a drive holds, over ``x`` (n,) from rest.

    Inside are friction of the size ``friction``, rad, that builds up over the way ``creep``, rad, a spring of the stiffness
    ``after`` and a dashpot, ``damping``, s; ``hardening`` is the spring's, 1/rad². Shape (n,). Where no time passes it is
    dragged along slowly (a harmonic drive: Tuttle and Seering, IEEE Trans. Robotics and Automation 12, 1996, 368-374).
    """
    out = np.empty(x.size)
    inside = float(friction), float(creep), float(after), float(damping), float(hardening)
    _held_inside(np.ascontiguousarray(time), np.ascontiguousarray(x), *inside, out)
    return out


def dashed(
    time: Floats, x: Floats, length: float, exponent: float, share: float, after: float, beside: float, stiffness: float
) -> Floats:
    """A :func:`.smooth_loops.smooth` element with a dashpot and a spring beside it, all behind another dashpot, over ``x`` (n,) from rest.

    The dashpots are ``beside`` and ``after``, s, and the spring ``stiffness``, over the element's stiffness; shape (n,). Where
    no time passes it is dragged along slowly (Spencer et al., J. Eng. Mech. 123, 1997, 230-238, without the spring k1).
    """
    out = np.empty(x.size)
    time, x, behind = (
        np.ascontiguousarray(time),
        np.ascontiguousarray(x),
        (float(after), float(beside), float(stiffness)),
    )
    _dashed(time, x, float(length), float(exponent), float(share), *behind, out)
    return out


def hyperbolic(x: Floats, length: float) -> Floats:
    """Friction that approaches ±1 hyperbolically with the distance from the last turn, shape (n,).

    From a turn at f it has gone half of the way to ±1 after ``length`` (1 ∓ f): Berg's friction of rubber (Vehicle System
    Dynamics 30, 1998, 197–212).
    """
    out = np.empty(x.size)
    _hyperbolic(np.ascontiguousarray(x), float(length), out)
    return out


def leaky(time: Floats, x: Floats, level: float, tau: float) -> Floats:
    """Stretch of a spring in series with a slider and a dashpot over ``x`` (n,) from rest, shape (n,).

    The slider holds until the stretch is at ``level``; the dashpot lets it go with the time constant ``tau`` (s).
    """
    out = np.empty(x.size)
    _leaky(np.ascontiguousarray(time), np.ascontiguousarray(x), float(level), float(tau), out)
    return out


def orifice(time: Floats, x: Floats, length: float, pace: float, back: float) -> Floats:
    """Stretch of a spring behind a throttle over ``x`` (n,) from rest, shape (n,): oil that is compressed and leaks.

    At the speed q it holds the stretch ``length`` (q/pace + (q/pace)²): laminar below ``pace`` (of the unit of ``x``, per s),
    turbulent above; where it pulls back the second term is ``back`` times as much (Merritt, Hydraulic Control Systems, 1967).
    """
    out = np.empty(x.size)
    _orifice(np.ascontiguousarray(time), np.ascontiguousarray(x), float(length), float(pace), float(back), out)
    return out


def creeping(time: Floats, x: Floats, tau: float, power: float, length: float) -> Floats:
    """Stretch of a spring behind a dashpot whose force goes with the ``power``-th root of its speed, from rest, shape (n,).

    At the stretch ``length`` (of the unit of ``x``) it is let go with the time constant ``tau`` (s): Norton's creep (F. H. Norton, The Creep of
    Steel at High Temperatures, 1929). ``power`` is above one.
    """
    out = np.empty(x.size)
    _creeping(np.ascontiguousarray(time), np.ascontiguousarray(x), float(tau), float(power), float(length), out)
    return out


def lowpass(time: Floats, signal: Floats, tau: float) -> Floats:
    """First-order lag of time constant ``tau`` (s) over ``signal`` (n,), settled at its first value."""
    out = np.empty(signal.size)
    _lowpass(np.ascontiguousarray(time), np.ascontiguousarray(signal), float(tau), out)
    return out
