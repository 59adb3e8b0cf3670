"""Compiled models of what has a mass: resonances, bodies and loads with dry friction behind a spring, loads that fly across a gap."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["free_flight", "held_by_load", "resonated", "sliding"]

Floats = NDArray[np.float64]
SUBSTEPS = 4
"""Steps of a mass between two samples."""
STIFFEST = 1.8
"""Frequency of a mass that swings, over that of its steps, up to which these are stable, and a little to spare."""
NEWTON, CLOSE = 20, 1e-4
"""Steps at most to the speed at which friction that follows it holds a mass, and how small one is, over the speed's scale, with which
it is there."""


@njit(cache=True)
def _rung_down(off, drift, frequency, damping, ringing, decay, c, s):
    # How far off and how fast a free resonator is one step later: over the step it decays and turns by cosine and sine.
    swing = (drift + damping * frequency * off) / ringing
    speed = (swing * ringing - damping * frequency * off) * c - (off * ringing + damping * frequency * swing) * s
    return decay * (off * c + swing * s), decay * speed


@njit(cache=True)
def _resonated(time, u, frequency, damping, out):
    ringing = frequency * np.sqrt(1.0 - damping * damping)
    place, speed = u[0], 0.0
    out[0] = place
    for i in range(1, u.size):
        dt = time[i] - time[i - 1]
        rate = (u[i] - u[i - 1]) / dt
        # Exact for an input that is linear between samples: what is left beside following it late rings down.
        late = 2.0 * damping / frequency * rate
        off, drift = place - u[i - 1] + late, speed - rate
        decay, c, s = np.exp(-damping * frequency * dt), np.cos(ringing * dt), np.sin(ringing * dt)
        off, drift = _rung_down(off, drift, frequency, damping, ringing, decay, c, s)
        place, speed = u[i] - late + off, rate + drift
        out[i] = place


@njit(cache=True)
def _held(speed, pulled, h, part, push, kept, left, share, inert, sticky, friction):
    # The speed of a mass a step later: friction holds with what it takes, and lets go where that is more than it has.
    held = (speed + h * (part * share * pulled - push)) * kept
    grip = (1.0 - share) * (pulled - inert * held) + sticky * held
    if abs(grip) > friction:
        return (speed + h * (part * (pulled - (friction if grip > 0.0 else -friction)) - push)) * left
    return held


@njit(cache=True)
def _bent(time, x, i):
    # A cubic through two samples with the slopes of their neighbours (Catmull and Rom, 1974): a mass is driven by the curvature.
    moved = x[i] - x[i - 1]
    before = 0.5 * (x[i] - x[i - 2]) if i > 1 and time[i - 1] > time[i - 2] else moved
    after = 0.5 * (x[i + 1] - x[i - 1]) if i + 1 < x.size else moved
    return before, 3.0 * moved - 2.0 * before - after, before + after - 2.0 * moved


@njit(cache=True)
def _sliding(time, x, level, frequency, damping, creep, late, early, share, upper, lower, hold, give, out):
    place, speed = 0.0, 0.0
    out[0] = 0.0
    for i in range(1, x.size):
        dt = time[i] - time[i - 1]
        if dt <= 0.0:
            place, speed = min(max(place, x[i] - level), x[i] + level), 0.0
            place = min(max(place, -lower), upper)
            out[i] = x[i] - place
            continue
        h = dt / SUBSTEPS
        # A spring that is too stiff for the step gets as much mass as it takes.
        swing = min(frequency, STIFFEST / h)
        pull = swing * swing
        friction = level * pull
        sticky = share * friction / creep
        inert = 2.0 * damping * frequency
        # Away from stops all but the speed is known before: a division in each step would take most of the time.
        holding, slipping = 1.0 / (1.0 + h * (share * inert + sticky)), 1.0 / (1.0 + h * inert)
        firm = hold * hold
        stopping = 2.0 * hold + h * firm
        ahead = early * (x[i] - x[i - 1]) / dt
        a, b, c = _bent(time, x, i)
        for k in range(SUBSTEPS):
            # The spring pulls by where the mass was: that neither damps nor drives it.
            u = k / SUBSTEPS
            pulled = pull * (ahead + x[i - 1] + u * (a + u * (b + u * c)) - place)
            touching = place > upper or place < -lower
            beyond = max(place - upper, 0.0) + min(place + lower, 0.0) if touching else 0.0
            # A stop only pushes. It is implicit, so that it stays stable however stiff.
            if touching and (hold * beyond + 2.0 * speed) * beyond > 0.0:
                kept = 1.0 / (1.0 + h * (give * (share * inert + sticky) + stopping))
                left = 1.0 / (1.0 + h * (give * inert + stopping))
                speed = _held(speed, pulled, h, give, firm * beyond, kept, left, share, inert, sticky, friction)
            else:
                speed = _held(speed, pulled, h, 1.0, 0.0, holding, slipping, share, inert, sticky, friction)
            place += h * speed
        out[i] = x[i] - place - late * speed


@njit(cache=True)
def _rubbed(pushed, stuck, kept, steep, before):
    # The speed amid a step at which what pushes is spent on the mass and on friction that follows the speed. Newton's steps
    # never pass it on the way from rest, and from beyond it the first one falls short of it.
    speed = before if before * pushed > 0.0 else 0.0
    for _ in range(NEWTON):
        grip = np.tanh(speed * steep)
        further = (pushed - kept * speed - stuck * grip) / (kept + stuck * steep * (1.0 - grip * grip))
        speed += further
        # What is left after so small a step is its square.
        if abs(further) * steep < CLOSE:
            break
        if speed * pushed <= 0.0:
            speed = 0.0
    return speed


@njit(cache=True)
def _hardened(twist, hardening):
    return twist + hardening * twist * twist * twist


@njit(cache=True)
def _held_by_load(time, x, friction, frequency, damping, width, after, hardening, late, excess, pace, by_speed, out):
    place, speed, z = 0.0, 0.0, 0.0
    pull, drag, steep = frequency * frequency, 2.0 * damping * frequency, 1.0 / width
    out[0] = 0.0
    for i in range(1, x.size):
        dt = time[i] - time[i - 1]
        if dt <= 0.0:
            held = 0.0 if by_speed else friction
            place, speed = min(max((1.0 + after) * place, x[i] - held), x[i] + held) / (1.0 + after), 0.0
            twist = x[i] - place
            z = (twist - after * place) / friction
            out[i] = _hardened(twist, hardening)
            continue
        h = dt / SUBSTEPS
        step = (x[i] - x[i - 1]) / SUBSTEPS
        drawn, damped = late * step / h, h * (drag + pull * late)
        bent = 0.5 * h * steep
        for k in range(SUBSTEPS):
            twist = x[i - 1] + step * (k + 0.5) - place
            force = _hardened(twist, hardening) - after * place + drawn
            # Springs that are too stiff for the step get as much mass as it takes.
            mass = 2.0 * max(1.0, 0.5 * h * h * pull * (1.0 + after + 3.0 * hardening * twist * twist))
            kept = mass + damped
            pushed, stuck = mass * speed + h * pull * force, h * pull * friction
            middle, turned = speed, 1.0
            # The rule of trapezoids, with the friction of the speed amid the step.
            for _ in range(2):
                level = 1.0 + excess * np.exp(-middle * middle / (pace * pace)) if excess > 0.0 else 1.0
                if by_speed:
                    middle = _rubbed(pushed, stuck * level, kept, steep, middle)
                    if excess <= 0.0:
                        break
                else:
                    # The bristle is known by the speed, so that one division tells both.
                    turning = bent / level if excess > 0.0 else bent
                    turned = 1.0 + turning * abs(middle)
                    middle = (pushed * turned - stuck * z) / (kept * turned + stuck * bent)
            if not by_speed:
                z = 2.0 * (z + bent * middle) / turned - z
            speed = 2.0 * middle - speed
            place += h * speed
        twist = x[i] - (place - 0.5 * h * speed)
        out[i] = _hardened(twist, hardening) + late * (step / h - speed)


@njit(cache=True)
def _free_flight(time, x, speed, torque, half, frequency, gap, free, hit):
    side = 1.0 if torque[0] > 0.0 else -1.0
    flying = torque[0] == 0.0
    g = 0.0 if flying else side * half
    since, start = 0.0, 0.0
    gap[0], free[0], hit[0] = g, flying, 0.0
    for i in range(1, x.size):
        moved, dt = x[i] - x[i - 1], time[i] - time[i - 1]
        hit[i] = 0.0
        if not flying and torque[i] * side <= 0.0 and moved * side < 0.0:
            flying, since, start = True, 0.0, speed[i]
        if flying:
            load = start * (np.sin(frequency * (since + dt)) - np.sin(frequency * since)) / frequency
            since += dt
            g += moved - load
            if abs(g) >= half:
                side = 1.0 if g > 0.0 else -1.0
                g = side * half
                hit[i] = (speed[i] - start * np.cos(frequency * since)) / dt
                flying = False
        gap[i], free[i] = g, flying


def free_flight(
    time: Floats, x: Floats, speed: Floats, torque: Floats, half: float, frequency: float
) -> tuple[Floats, Floats, Floats]:
    """A sprung load that flies across a clearance of ±``half`` when its ``torque`` (n,) changes sign.

    Between the flanks it swings at ``frequency`` (rad/s) about the place where it was left.

    Returns the position within the clearance (n,), 1 where the load flies (n,), and the jump of the load's speed over
    the sampling interval where it meets a flank (n,).
    """
    gap, free, hit = np.empty(x.size), np.empty(x.size), np.empty(x.size)
    time, x, speed, torque = (np.ascontiguousarray(part) for part in (time, x, speed, torque))
    _free_flight(time, x, speed, torque, float(half), float(frequency), gap, free, hit)
    return gap, free, hit


def resonated(time: Floats, u: Floats, frequency: float, damping: float) -> Floats:
    """``u`` (n,) through a resonator of unit static gain that starts settled, shape (n,).

    ``frequency`` is its natural frequency (rad/s), ``damping`` its damping ratio, below one.
    """
    out = np.empty(u.size)
    _resonated(np.ascontiguousarray(time), np.ascontiguousarray(u), float(frequency), float(damping), out)
    return out


def sliding(
    time: Floats,
    x: Floats,
    level: float,
    frequency: float,
    damping: float,
    creep: float,
    late: float,
    early: float = 0.0,
    share: float = 1.0,
    upper: float = np.inf,
    skew: float = 1.0,
    hold: float = 0.0,
    give: float = 1.0,
) -> Floats:
    """Stretch of a spring and a dashpot between the input ``x`` (n,) and a mass with dry friction, from rest, shape (n,).

    The mass has the natural ``frequency`` (rad/s) and ``damping`` ratio on the spring. Friction holds it up to the stretch
    ``level``, as engines for rigid bodies do: what holds it leaves ``share`` of the acceleration, and below the speed
    ``creep`` (rad/s) it creeps. The dashpot adds the mass's speed times ``late`` (s), taken away, and drags the mass along
    by the input's speed times ``early`` (s). Where no time passes the mass follows slowly.

    It may move up to stops at ``upper`` (rad) and, on the other side, ``skew`` times as far away. They bring it back at the
    frequency ``hold`` (rad/s), critically damped, and leave ``give`` of the acceleration. Both are the soft constraints of
    MuJoCo, whose impedance is the rest of that share (Todorov, ICRA 2014, 6054-6061).
    """
    out = np.empty(x.size)
    mass = float(level), float(frequency), float(damping), float(creep), float(late), float(early), float(share)
    stops = float(upper), float(upper * skew), float(hold), float(give)
    _sliding(np.ascontiguousarray(time), np.ascontiguousarray(x), *mass, *stops, out)
    return out


def held_by_load(
    time: Floats,
    x: Floats,
    friction: float,
    frequency: float,
    damping: float,
    width: float,
    after: float,
    hardening: float,
    late: float = 0.0,
    excess: float = 0.0,
    pace: float = 1.0,
    by_speed: bool = False,
) -> Floats:
    """Torque of a hardening spring, of unit stiffness at rest, between ``x`` (n,) and a load that swings and rubs, shape (n,).

    The load swings on the spring at ``frequency``, rad/s, with the ``damping`` ratio of its own, and a spring of the stiffness
    ``after`` holds it; ``hardening`` is the first spring's, 1/rad², and ``late`` a dashpot beside that, s. The load rubs with
    ``friction``, rad, that builds up over the way ``width``, rad, as in Dahl's model, and where there is an ``excess`` falls from
    1 + ``excess`` of that at rest by ``pace``, rad/s (Canudas de Wit et al., IEEE TAC 40, 1995); where ``by_speed`` it is the
    hyperbolic tangent of the speed over ``width``, rad/s. All is at rest at zero first. Where no time passes it is dragged along
    slowly. A series elastic actuator: Pratt and Williamson (IROS 1995, 399-406).
    """
    out = np.empty(x.size)
    load = float(friction), float(frequency), float(damping), float(width), float(after)
    more = float(hardening), float(late), float(excess), float(pace)
    _held_by_load(np.ascontiguousarray(time), np.ascontiguousarray(x), *load, *more, by_speed, out)
    return out
