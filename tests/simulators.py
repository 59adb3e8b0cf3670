"""What simulators of joints are made of, each by an implementation of its own that shares no code with the emulator's elements."""

from __future__ import annotations

from collections.abc import Callable
from math import erf

import numpy as np
from joints import compiled, sliders
from material_simulators import breaking_away, flowing_gel, leaking_drive, magnet, phase_changing, steel
from numba import njit
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

Floats = NDArray[np.float64]
Pads = tuple[float, float]
NO_PADS = (-np.inf, np.inf)
Joint = Callable[..., Floats]
Load = Callable[[float, float, float, float, float], tuple[float, float]]
INTERVAL = 0.01
"""Of the samples, s."""
STEPS = 30
"""Of a load's motion between two samples."""


def motion(seconds: float, *phases: float) -> tuple[Floats, Floats]:
    """A time and a deflection that begins at zero and at rest, of three sines with these phases."""
    time = np.arange(0.0, seconds, INTERVAL)
    x = sum(
        size * np.sin(2.0 * np.pi * rate * time + phase)
        for size, rate, phase in zip((0.6, 0.3, 0.15), (0.17, 0.43, 1.1), phases, strict=True)
    )
    return time, np.asarray(x - x[0] * np.exp(-time / 0.3)) * (1.0 - np.exp(-time / 0.5))


# Each with its parameters off by ``e``, some up and some down.


def kinked(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    spring = 5.0 * x + 7.0 * (1.0 + e) * np.sign(x) * np.maximum(np.abs(x) - 0.52 * (1.0 + e), 0.0)
    return spring + sliders(x, ((6.0, 0.12 * (1.0 - e)), (2.0 * (1.0 + e), 0.15)))


def two_sliders(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Yielding at two sharp deflections, of which a coarse set of elements has neither."""
    return (1.0 + e) * x + sliders(x, ((12.5, 0.75 * (1.0 + e)), (5.8 * (1.0 - e), 0.75)))


@compiled
def rubber(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    friction, force, left, left_at, way = np.zeros(x.size), 0.0, 0.0, 0.0, 0.0
    most, length = 1.5 * (1.0 + e), 0.08 * (1.0 - e)
    for i in range(1, x.size):
        step = x[i] - x[i - 1]
        if step * way <= 0.0:
            left, left_at, way = force, x[i - 1], step
        # Berg's two branches as printed.
        mu, gone = left / most, x[i] - left_at
        up = left + gone / (length * (1.0 - mu) + gone) * (most - left)
        down = left + gone / (length * (1.0 + mu) - gone) * (most + left)
        friction[i] = force = up if step > 0.0 else down
    return 4.0 * (1.0 - e) * x + friction


@compiled
def smooth_yielding(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    z, out = 0.0, np.zeros(x.size)
    for i in range(1, x.size):
        step = (x[i] - x[i - 1]) / 40
        for _ in range(40):
            z += step * (1.0 - (z / (0.09 * (1.0 - e))) ** 2 * (0.6 * np.sign(z * step) + 0.4))
        out[i] = z
    return 3.0 * (1.0 + e) * x + 12.0 * (1.0 + e) * out


@compiled
def stribeck(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """LuGre, explicit in small steps."""
    z, out = 0.0, np.zeros(x.size)
    for i in range(1, x.size):
        speed = (x[i] - x[i - 1]) / INTERVAL
        level = (1.0 + e) * (0.8 + 0.6 * np.exp(-((speed / 0.25) ** 2)))
        for _ in range(40):
            z += INTERVAL / 40 * (speed - 60.0 * abs(speed) / level * z)
        out[i] = 60.0 * z
    return 3.0 * (1.0 - e) * x + out


@compiled
def worm_gear(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Friction by the Stribeck curve times a direction that builds up over a way, beside a spring that stiffens across."""
    z, out = 0.0, np.zeros(x.size)
    for i in range(1, x.size):
        way = np.sign(x[i] - x[i - 1])
        z = way + (z - way) * np.exp(-abs(x[i] - x[i - 1]) / (0.05 * (1.0 + e)))
        speed = (x[min(i + 1, x.size - 1)] - x[i - 1]) / (INTERVAL * (min(i + 1, x.size - 1) - i + 1))
        out[i] = (1.0 + e) * (1.3 + 0.6 * np.exp(-((speed / (0.3 * (1.0 - e))) ** 2))) * z
    return 3.0 * (1.0 - e) * x + 1.2 * (1.0 + e) * x * np.abs(x) + out


@compiled
def bodies_on_tendons(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Three light bodies that tendons pull along, damped and held by friction as engines for rigid bodies have it: it gives way before."""
    springs, levels = np.array([9.0, 4.0, 1.5]) * (1.0 + e), np.array([0.5, 0.5, 0.6]) * (1.0 - e)
    place, speed, out = np.full(3, x[0]), np.zeros(3), np.zeros(x.size)
    mass, damping, give, step = 0.005, 0.6 * (1.0 + e), 5000.0, INTERVAL / 20
    for i in range(x.size):
        for k in range(1, 21):
            pulled_by = x[max(i - 1, 0)] + (x[i] - x[max(i - 1, 0)]) * k / 20
            for j in range(3):
                pulled = mass * speed[j] + step * springs[j] * (pulled_by - place[j])
                speed[j] = pulled / (mass + step * (damping + give))
                if give * abs(speed[j]) > levels[j]:
                    speed[j] = (pulled - np.sign(pulled) * step * levels[j]) / (mass + step * damping)
                place[j] += step * speed[j]
        out[i] = np.sum(springs * (x[i] - place))
    return 2.5 * (1.0 - e) * np.sin(x) + out


def damped_bristles(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """LuGre whose bristles are damped, in small steps."""
    finely = np.arange(0.0, x.size - 1 + 1e-9, 1 / 40)
    speed = np.interp(finely, np.arange(x.size), np.gradient(x, time))
    return 3.0 * (1.0 - e) * x + _with_damped_bristles(speed, float(e))[::40]


@njit(cache=True)
def _with_damped_bristles(speed: Floats, e: float) -> Floats:
    z, out = 0.0, np.zeros(speed.size)
    for i, v in enumerate(speed):
        rate = v - 60.0 * abs(v) / (1.0 + 0.5 * np.exp(-((v / 0.2) ** 2))) / (1.0 + e) * z
        out[i] = 60.0 * z + 0.9 * (1.0 - e) * rate
        z += INTERVAL / 40 * rate
    return out


def bristles_by_the_sample(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """LuGre of a speed made from the samples on both sides, a step each."""
    z, out = 0.0, np.zeros(x.size)
    for i, v in enumerate(np.gradient(x, time)):
        settled = (1.0 + 0.5 * np.exp(-((v / 0.2) ** 2))) * (1.0 + e) / 60.0
        z = settled * np.sign(v) + (z - settled * np.sign(v)) * np.exp(-abs(v) / settled * INTERVAL)
        out[i] = 60.0 * z
    return 3.0 * (1.0 - e) * x + out


@compiled
def viscoelastic(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    branches = np.zeros(x.size)
    for constant in (0.3, 2.0, 9.0):
        force = 0.0
        for i in range(1, x.size):
            force = force * np.exp(-INTERVAL / (constant * (1.0 + e))) + 1.5 * (1.0 + e) * (x[i] - x[i - 1])
            branches[i] += force
    return 3.0 * (1.0 - e) * x + branches


@compiled
def saturating(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """A generalised Prandtl-Ishlinskii stage: each play is bent by an envelope that saturates sooner on one side."""
    out = np.zeros(x.size)
    for half in (0.05, 0.1, 0.2, 0.3):
        at = 0.0
        for i, now in enumerate(x):
            at = min(max(at, now - half), now + half)
            out[i] += (1.0 + e) * np.tanh(1.6 * (1.0 - e) * at + 0.4)
    return (1.0 + e) * x + out


FINER = 40


@njit(cache=True)
def dragged(
    time: Floats, x: Floats, stiffness: float, limit: float, mass: float, damping: float, pads: Pads = NO_PADS
) -> Floats:
    """Torque of a spring to a mass with dry and viscous friction, explicit in small steps, which may rest between two pads."""
    h = INTERVAL / FINER
    fine = np.interp(np.arange((x.size - 1) * FINER + 1) * h, time, x)
    at, speed, stretch = 0.0, 0.0, np.zeros(fine.size)
    for i, now in enumerate(fine):
        stretch[i] = now - at
        deep = max(at - pads[1], 0.0) + min(at - pads[0], 0.0)
        pad = 300.0 * deep + 1.5 * speed if deep else 0.0
        pull = stiffness * stretch[i] - (pad if pad * deep > 0.0 else 0.0)
        if speed == 0.0 and abs(pull) <= limit:
            continue
        way = np.sign(speed) if speed != 0.0 else np.sign(pull)
        speed += h * (pull - way * limit - damping * speed) / mass
        speed = speed if speed * way > 0.0 else 0.0
        at += h * speed
    return stiffness * stretch[::FINER]


def heavy(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Two masses on springs beside a third spring."""
    out = 4.0 * (1.0 + e) * x + dragged(time, x, 9.0, 0.9, 0.001, 0.15)
    return out + dragged(time, x, 5.0 * (1.0 + e), 1.3 * (1.0 - e), 0.0015, 0.12)


def between_pads(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """A mass on a spring that strikes pads of rubber."""
    return 4.0 * (1.0 + e) * x + dragged(time, x, 9.0, 0.9 * (1.0 + e), 0.003, 0.1, (-0.25, 0.3 * (1.0 - e)))


@compiled
def pinching(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Bouc-Wen with the pinching of Baber and Noori, as printed, explicit in small steps."""
    z, out = 0.0, np.zeros(x.size)
    beta, gamma, n = 2.0 * (1.0 + e), 0.8 * (1.0 - e), 1.4
    most = (1.0 / (beta + gamma)) ** (1.0 / n)
    for i in range(1, x.size):
        step = (x[i] - x[i - 1]) / 40
        for _ in range(40):
            h = 1.0 - 0.6 * (1.0 - e) * np.exp(-(((z * np.sign(step) - 0.15 * most) / (0.2 * (1.0 + e))) ** 2))
            z += h * (step - beta * abs(step) * abs(z) ** (n - 1.0) * z - gamma * step * abs(z) ** n)
        out[i] = z
    return 0.8 * (1.0 + e) * x + 3.0 * out


@compiled
def growing_metal(time: Floats, x: Floats, e: float, growth: float) -> Floats:
    """Plasticity with two back stresses that recall themselves, by small steps back to the yield limit, which may grow."""
    torque, fast, slow, flown, out = 0.0, 0.0, 0.0, 0.0, np.zeros(x.size)
    for i in range(1, x.size):
        for _ in range(40):
            torque += 10.0 * (x[i] - x[i - 1]) / 40
            limit = 0.5 * (1.0 + e) * (1.0 + growth * (1.0 - np.exp(-flown / 0.8)))
            over = abs(torque - fast - slow) - limit
            if over > 0.0:
                way = np.sign(torque - fast - slow)
                rates = 12.0 * (1.0 + e) * way - 15.0 * fast, 3.0 * (1.0 - e) * way - 2.0 * slow
                flow = over / (10.0 + way * sum(rates))
                torque, fast, slow = torque - 10.0 * way * flow, fast + rates[0] * flow, slow + rates[1] * flow
                flown += flow
        out[i] = torque
    return (1.0 + e) * x + out


def metal(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    return growing_metal(time, x, e, 0.0)


def used_metal(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Metal whose yield limit grows by a fifth as it flows."""
    return growing_metal(time, x, e, 0.2 * (1.0 - e))


@compiled
def damper(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Spencer's damper of magnetorheological fluid with both of its springs, explicit in small steps."""
    steps, behind, hysteretic, piston, out = 40, 5.0 * (1.0 - e), 0.0, 0.0, np.zeros(x.size)
    h = INTERVAL / steps
    for i in range(1, x.size):
        speed = (x[i] - x[i - 1]) / INTERVAL
        for k in range(steps):
            spring = 1.5 * (x[i - 1] + (k + 0.5) * h * speed - piston)
            inner = (12.0 * (1.0 + e) * hysteretic + 0.2 * speed + spring) / (0.2 + behind)
            slip, share = speed - inner, hysteretic / 0.08
            piston += h * inner
            hysteretic += h * (slip - 0.5 * slip * share**2 - 0.5 * abs(slip) * share * abs(share))
        out[i] = behind * inner
    return 3.0 * (1.0 - e) * x + out


def spreadsheet(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Dry and viscous friction of a speed made from one sample to the next."""
    speed = np.diff(x, prepend=x[0]) / INTERVAL
    return 4.0 * (1.0 + e) * x + 0.3 * (1.0 - e) * speed + (1.0 + e) * np.tanh(speed / (0.003 * (1.0 + e)))


def rigid_body(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """The torque that an engine for rigid bodies wants for a motion: friction of a speed that is yet to come, and inertia."""
    speed = np.gradient(x, time)
    acceleration = np.gradient(speed, time)
    friction = 0.8 * (1.0 - e) * np.clip((speed + 0.003 * acceleration) / 0.02, -1.0, 1.0)
    return 4.0 * (1.0 + e) * x + friction + 0.1 * speed + 0.02 * (1.0 + e) * acceleration


def two_sided(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Kwok's damper of magnetorheological fluid, whose friction turns earlier on the way back from either side."""
    speed = np.gradient(x, time)
    friction = np.tanh(speed / (0.3 * (1.0 + e)) + 0.7 * (1.0 - e) * np.tanh(x / 0.2))
    return 2.0 * (1.0 + e) * x + 0.4 * speed + (1.0 - e) * friction


def late_and_two_sided(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """The same whose fluid takes its time."""
    wanted = np.tanh(np.gradient(x, time) / 0.3 + 0.7 * np.tanh(x / 0.2))
    told, friction = np.zeros(x.size), 0.0
    for i, now in enumerate(wanted):
        friction += (now - friction) * (1.0 - np.exp(-INTERVAL / (0.05 * (1.0 + e))))
        told[i] = friction
    return 2.0 * (1.0 + e) * x + 0.4 * np.gradient(x, time) + (1.0 - e) * told


def maxwell_slip(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Generalised Maxwell slip: elements stick, or are drawn to a share of the Stribeck curve, in small steps."""
    out, fine = np.zeros(x.size), 20
    for stiffness, share in ((30.0, 0.4), (12.0, 0.6)):
        force, slips, before = 0.0, False, 0.0
        for i in range(1, x.size):
            speed = (x[i] - x[i - 1]) / INTERVAL
            curve = (1.0 + e) * (0.9 + 0.5 * np.exp(-((speed / 0.4) ** 2)))
            slips, before = slips and speed * before > 0.0, speed
            for _ in range(fine):
                if slips:
                    force += 12.0 * (share * np.sign(speed) - force / curve) * INTERVAL / fine
                else:
                    force += stiffness * speed * INTERVAL / fine
                    slips = abs(force) >= share * curve and force * speed > 0.0
            out[i] += force
    return 3.0 * (1.0 - e) * x + out


def many_slip_elements(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Generalised Maxwell slip of five elements, as dampers' makers write it: their level falls with the speed exponentially."""
    out, fine = np.zeros(x.size), 10
    for stiffness, share in ((20.0, 0.1), (17.0, 0.2), (10.0, 0.25), (6.5, 0.25), (3.5, 0.2)):
        force, slips = 0.0, 0.0
        for i in range(1, x.size):
            step = (x[i] - x[i - 1]) / fine
            level = share * (1.0 + e) * (1.2 + 0.5 * np.exp(-abs(step) * fine / INTERVAL / 0.4))
            for _ in range(fine):
                if slips != 0.0 and slips == np.sign(step):
                    force += slips * 14.0 * (level - abs(force)) * INTERVAL / fine
                else:
                    force, slips = force + (1.0 - e) * stiffness * step, 0.0
                    if abs(force) >= level and force * step > 0.0:
                        slips = np.sign(step)
            out[i] += force
    return 3.0 * (1.0 - e) * x + out


@compiled
def superelastic(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """A wire of shape memory alloy beside a return spring, in small steps from rest where it begins."""
    out, fine, stiffness = np.zeros(x.size), 20, 12.0
    force = 0.0
    for i in range(1, x.size):
        step = (x[i] - x[i - 1]) / fine
        for k in range(fine):
            place = x[i - 1] + step * (k + 1)
            back = 0.15 * (stiffness * place - force + 0.6 * (1.0 - e) * stiffness * erf(4.0 * place))
            over = (force - back) / (1.6 * (1.0 + e))
            force += stiffness * (step - abs(step) * over * abs(over) ** 1.6)
        out[i] = force
    return 0.8 * (1.0 - e) * x + out


def drive_line(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """A drive line of a block diagram: damped contact beyond a clearance, and friction by a formula, strongest at breakaway."""
    speed = np.gradient(x, time)
    deep = np.sign(x) * np.maximum(np.abs(x) - 0.08 * (1.0 + e), 0.0)
    touching = 1.0 / (1.0 + np.exp(-(np.abs(x) - 0.08 * (1.0 + e)) / 0.01))
    slow = speed / 0.2
    friction = 0.4 * np.tanh(speed / 0.05) + 0.3 * (1.0 - e) * np.sqrt(2.0 * np.e) * np.exp(-(slow**2)) * slow
    return 6.0 * (1.0 - e) * deep + 0.3 * (1.0 + e) * touching * speed + friction


def rolling(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Hysteresis of rolling balls, all of which is stronger at rest."""
    slow = 1.0 + 0.3 * (1.0 + e) * np.exp(-np.abs(np.gradient(x, time)) / 0.5)
    return 4.0 * (1.0 + e) * x + slow * sliders(x, ((6.0, 0.12), (2.0 * (1.0 - e), 0.3)))


def leaves(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Fancher's leaf spring as printed: its friction grows with the deflection and builds up faster one way."""
    friction, force = np.zeros(x.size), 0.0
    for i in range(1, x.size):
        step = x[i] - x[i - 1]
        envelope = np.sign(step) * (1.0 + e) * (0.8 + 0.5 * abs(x[i]))
        force = envelope + (force - envelope) * np.exp(-abs(step) / (0.05 * (1.0 - e) if step > 0.0 else 0.12))
        friction[i] = force
    return 4.0 * x + (1.0 + e) * x**3 + friction


def coupling(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """A magnetic coupling that would pull out, with domains that saturate."""
    domains = np.zeros(x.size)
    for length in (0.08, 0.12, 0.2, 0.33):
        domains += np.tanh(1.6 * sliders(x, ((1.0 / length, 1.0 + e),)))
    return 2.5 * (1.0 - e) * np.sin(1.1 * (1.0 + e) * x) + 0.5 * (1.0 + e) * domains


def wedge(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Friction between envelopes that go with the torque of a hardening spring under a preload."""
    spring = 0.9 * (1.0 - e) + 4.0 * (1.0 + e) * x + 3.0 * (1.0 - e) * x**3
    force, out = 0.0, np.zeros(x.size)
    out[0] = spring[0]
    for i in range(1, x.size):
        envelope = np.sign(x[i] - x[i - 1]) * (0.2 + 0.18 * (1.0 + e) * abs(spring[i]))
        force = envelope + (force - envelope) * np.exp(-abs(x[i] - x[i - 1]) / (0.04 * (1.0 - e)))
        out[i] = spring[i] + force
    return out


def lagging(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Sliders whose torque is told late, each by its own time."""
    out = 3.0 * (1.0 + e) * x
    for stiffness, limit, constant in ((6.0, 0.12, 0.15), (3.0 * (1.0 - e), 0.3, 0.4 * (1.0 + e))):
        late, told = sliders(x, ((stiffness, limit),)), 0.0
        for i in range(1, x.size):
            told += (late[i] - told) * (1.0 - np.exp(-INTERVAL / constant))
            out[i] += told
    return out


def hardly_yielding(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Mostly a spring: whatever emulates the loop badly is still less than a hundredth of the torque."""
    return 4.0 * (1.0 + e) * x + 0.3 * smooth_yielding(time, x, -e)


def staged_damper(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """A clutch's torsional damper, whose second stage has a spring and rubbing of its own."""
    beyond = np.sign(x) * np.maximum(np.abs(x) - 0.31 * (1.0 + e), 0.0)
    first = 3.0 * x + sliders(x, ((30.0, 0.35 * (1.0 - e)),))
    return first + 6.0 * (1.0 - e) * beyond + sliders(beyond, ((25.0, 1.3 * (1.0 + e)),))


def soft_stages(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """A coupling whose second stage, of rubber, engages softly and gives way little by little."""
    place, soft = 0.27 * (1.0 + e), 0.04 * (1.0 - e)
    depth = np.abs(x) - place
    beyond = np.sign(x) * 0.5 * (depth + np.sqrt(depth**2 + soft**2) + place - np.sqrt(place**2 + soft**2))
    reached, rubbed = 0.0, np.zeros(x.size)
    for i in range(1, x.size):
        # Exact along each sample: it comes nearer to its level by the share of the way that is gone.
        way = beyond[i] - beyond[i - 1]
        level = 1.1 * (1.0 + e) * np.sign(way)
        rubbed[i] = reached = level + (reached - level) * np.exp(-abs(way) / (0.06 * (1.0 - e)))
    return 2.2 * x + 5.0 * (1.0 - e) * beyond + rubbed + sliders(x, ((25.0, 0.3 * (1.0 + e)),))


def predamper(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """The same whose main rubbing is moved through a play, off its first stage."""
    play, moved = 0.17 * (1.0 + e), np.zeros(x.size)
    for i in range(1, x.size):
        moved[i] = min(max(moved[i - 1], x[i] - play), x[i] + play)
    spring = 1.2 * x + 5.0 * (1.0 - e) * np.maximum(x - 0.35, 0.0) + 4.0 * np.minimum(x + 0.28, 0.0)
    return spring + sliders(x, ((20.0, 0.2 * (1.0 + e)),)) + sliders(moved, ((30.0, 1.1 * (1.0 - e)),))


def pressed_by_a_cam(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """A slider that the load of a progressive spring presses."""
    load = 2.5 * (1.0 + e) * x + 4.0 * x**3
    force, friction = 0.0, np.zeros(x.size)
    for i in range(1, x.size):
        limit = 0.25 * (1.0 + e) + 0.12 * abs(load[i])
        friction[i] = force = min(max(force + 40.0 * (1.0 - e) * (x[i] - x[i - 1]), -limit), limit)
    return load + friction


def door_closer(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """A preloaded spring and oil that flows more easily one way, and hardly near the latch."""
    speed = np.gradient(x, time)
    latch = 1.0 + 2.0 * (1.0 - e) / (1.0 + np.exp((x - 0.15 * (1.0 + e)) / 0.04))
    oil = np.where(speed > 0.0, 0.15 * (1.0 - e), 0.6 * (1.0 + e) * latch) * speed
    spring = 2.0 * (1.0 + e) * np.tanh(x / 0.03) + 4.0 * (1.0 - e) * x
    return spring + oil + sliders(x, ((20.0, 0.03 * (1.0 + e)),))


def detents(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """A motor with poles behind a spring."""
    return 4.0 * (1.0 + e) * x + 0.4 * (1.0 - e) * np.sin(24.0 * x + 0.7) + sliders(x, ((15.0, 0.04 * (1.0 - e)),))


def teeth(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """A pair of gears: its stiffness waves with each tooth, its friction is pressed by what it carries."""
    carried = 5.0 * (1.0 + e) * x * (1.0 + 0.04 * (1.0 - e) * np.sin(30.0 * x + 0.4))
    mesh = 0.08 * (1.0 - e) * np.abs(carried) * np.tanh(np.gradient(x, time) / 0.05)
    return carried + mesh + sliders(x, ((10.0, 0.05 * (1.0 + e)),))


def absorber(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """An orifice that opens one way, beside a spring and seals."""
    speed = np.gradient(x, time)
    oil = np.where(speed > 0.0, 0.3 * (1.0 + e), 1.2 * (1.0 - e)) * speed * np.abs(speed) + 0.2 * (1.0 + e) * speed
    return 3.0 * (1.0 - e) * x + oil + sliders(x, ((12.0, 0.05 * (1.0 + e)),))


def tendon(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """A muscle with friction inside, whose moment arm changes as the bone turns."""
    shortened = x + 0.3 * (1.0 + e) * x**2 - 0.15 * x**3
    arm = 1.0 + 0.6 * (1.0 + e) * x - 0.45 * x**2
    return arm * (3.0 * (1.0 - e) * shortened + sliders(shortened, ((12.0, 0.3 * (1.0 + e)), (6.0, 0.8 * (1.0 - e)))))


@compiled
def harmonic_drive(time: Floats, x: Floats, e: float = 0.0, steps: int = 8) -> Floats:
    """A flexspline that hardens before what rubs inside, which a wave generator's spring and oil hold."""
    outer, hardening, inner = 8.0 * (1.0 - e), 6.0 * (1.0 + e), 12.0 * (1.0 + e)
    friction, way, oil = 0.5 * (1.0 - e), 0.01, 1.0 * (1.0 + e)
    place, state, out = 0.0, 0.0, np.zeros_like(x)
    for i in range(1, x.size):
        for k in range(1, steps + 1):
            twist = x[i - 1] + (x[i] - x[i - 1]) * k / steps - place
            torque = outer * twist + hardening * twist**3
            # Explicit, but for what is stiff.
            stiff = outer + 3.0 * hardening * twist**2 + inner + friction / way
            moved = (torque - inner * place - friction * state) / (oil * steps / INTERVAL + stiff)
            state += (np.sign(moved) - state) * (1.0 - np.exp(-abs(moved) / way))
            place += moved
        out[i] = outer * (x[i] - place) + hardening * (x[i] - place) ** 3
    return out


@njit(cache=True)
def _behind_a_spring(x: Floats, e: float, spring: float, hardening: float, load: Load) -> Floats:
    """A spring up to a ``load`` that tells its acceleration from the spring's torque, its place and its speed."""
    place, speed, state, out = 0.0, 0.0, 0.0, np.zeros_like(x)
    for i in range(1, x.size):
        for k in range(STEPS):
            twist = x[i - 1] + (x[i] - x[i - 1]) * (k + 0.5) / STEPS - place
            gained, state = load(e, spring * twist + hardening * twist**3, place, speed, state)
            speed += gained * INTERVAL / STEPS
            place += speed * INTERVAL / STEPS
        out[i] = spring * (x[i] - place) + hardening * (x[i] - place) ** 3
    return out


@njit(cache=True)
def _on_bristles(e: float, torque: float, place: float, speed: float, state: float) -> tuple[float, float]:
    mass, friction, way, step = 0.016 * (1.0 + e), 0.6 * (1.0 - e), 0.02, INTERVAL / STEPS
    level = 1.0 + 0.5 * (1.0 + e) * np.exp(-((speed / 0.3) ** 2))
    state = (state + step * speed / way) / (1.0 + step * abs(speed) / (way * level))
    return (torque - 2.0 * (1.0 + e) * place - 0.15 * (1.0 - e) * speed - friction * state) / mass, state


@njit(cache=True)
def _rubbing(e: float, torque: float, place: float, speed: float, state: float) -> tuple[float, float]:
    mass, friction = 0.02 * (1.0 + e), 0.5 * (1.0 - e)
    rubs = 0.3 * (1.0 - e) * speed + friction * np.tanh(speed / 0.1)
    return (torque - 3.0 * (1.0 + e) * place - rubs) / mass, state


def series_elastic(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """A spring before a load that swings at four times a second and rubs by bristles, held back by another spring."""
    return np.asarray(_behind_a_spring(x, float(e), 10.0 * (1.0 - e), 0.0, _on_bristles))


def rubbing_load(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """The same on a spring that hardens, with the sign of the speed, made smooth, in place of bristles."""
    return np.asarray(_behind_a_spring(x, float(e), 12.0 * (1.0 - e), 5.0 * (1.0 + e), _rubbing))


def looked_up(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """A measured characteristic: the middle and half of the width of its loop from tables, which Dahl friction goes through."""
    places = (1.0 + e) * np.linspace(-1.5, 1.5, 13)
    middle = np.array([-6.1, -5.2, -4.7, -3.4, -1.9, -0.7, 0.0, 0.4, 1.7, 2.3, 3.6, 5.3, 6.0])
    half = np.array([1.0, 0.9, 0.75, 0.85, 0.6, 0.4, 0.5, 0.6, 0.45, 0.7, 0.8, 0.9, 1.1])
    way, built = 0.0, np.zeros(x.size)
    for i in range(1, x.size):
        step = (x[i] - x[i - 1]) / 20
        for _ in range(20):
            way += step / 0.06 * max(1.0 - way * np.sign(step), 0.0) ** 1.5
        built[i] = way
    spring, friction = PchipInterpolator(places, middle), PchipInterpolator(places, half)
    return np.asarray(spring(x) + (1.0 - e) * friction(x) * built)


@compiled
def oil_chamber(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Oil that is compressed, and leaks through a gap and a hole, which is narrower one way; implicit in small steps."""
    pressure, out = 0.0, np.zeros(x.size)
    for i in range(1, x.size):
        step = (x[i] - x[i - 1]) / 40
        for _ in range(40):
            hole = 0.9 if pressure + 30.0 * step > 0.0 else 0.4 * (1.0 - e)
            # Of |p| + 30 h q = 30 |step| + before, with |p| = 1.2 q + hole q²; the sign is that of the pressure without a leak.
            full, through = pressure + 30.0 * step, 1.2 * (1.0 + e) + 30.0 * INTERVAL / 40
            q = (-through + np.sqrt(through**2 + 4.0 * hole * abs(full))) / (2.0 * hole)
            pressure = full - np.sign(full) * 30.0 * q * INTERVAL / 40
        out[i] = pressure
    return 3.0 * (1.0 + e) * x + 2.0 * x**3 + out


def pneumatic_muscle(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Sliders of a braid that all hold better the faster they slide."""
    speed = np.abs(np.gradient(x, time))
    return 4.0 * (1.0 - e) * x + (1.0 + 0.4 * (1.0 + e) * speed / (speed + 0.5)) * sliders(
        x, ((8.0, 0.3), (5.0 * (1.0 + e), 0.5))
    )


@njit(cache=True)
def slid(x: Floats, length: float, exponent: float) -> Floats:
    """Friction by Dahl over its limit, in small steps."""
    z, out = 0.0, np.zeros(x.size)
    for i in range(1, x.size):
        step = (x[i] - x[i - 1]) / 40
        for _ in range(40):
            z += step / length * max(1.0 - z * np.sign(step), 0.0) ** exponent
        out[i] = z
    return out


def belt_tensioner(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """An arm on a preloaded spring that rubs by what it carries, less where it lets go than where it is pressed."""
    carried = 4.0 * (1.0 - e) * (0.9 * (1.0 + e) + x)
    z = slid(x, 0.07 * (1.0 + e), 1.4 * (1.0 - e))
    return carried * (1.0 + np.where(z > 0.0, 0.35 * (1.0 + e), 0.15 * (1.0 - e)) * z)


@compiled
def snubber(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """A hardening spring and a wedge that it presses, which holds less on the way back to the middle, in small steps."""
    stiffness, z, out = 12.0 * (1.0 - e), 0.0, np.zeros(x.size)
    for i in range(1, x.size):
        step = (x[i] - x[i - 1]) / 40
        for k in range(40):
            place = x[i - 1] + step * (k + 0.5)
            level = (0.3 * (1.0 + e) + 0.5 * (1.0 - e) * abs(place)) * (0.6 * (1.0 + e) if place * step < 0.0 else 1.0)
            towards = np.sign(step) * level
            z = towards + (z - towards) * np.exp(-stiffness * abs(step) / level)
        out[i] = 3.0 * (1.0 + e) * x[i] + 1.5 * (1.0 - e) * x[i] ** 5 + z
    return out


def geared_bristles(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Bristles of a gear, whose level the load presses up and speed down, by the way between samples."""
    load, speed = 3.0 * (1.0 - e) * x + 1.2 * (1.0 + e) * x**3, np.gradient(x, time)
    level = (0.2 * (1.0 + e) + 0.12 * np.abs(x) * 3.0) * (1.0 + 0.5 * (1.0 - e) * np.exp(-np.square(speed / 0.2)))
    z, out = 0.0, np.zeros(x.size)
    for i in range(1, x.size):
        towards = np.sign(x[i] - x[i - 1]) * level[i]
        z = towards + (z - towards) * np.exp(-12.0 * abs(x[i] - x[i - 1]) / level[i])
        out[i] = z
    return load + out + 0.03 * (1.0 + e) * speed


def on_its_side(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Sliders that a weight presses, from one side, so that they hold better the farther it leans there."""
    forces, out = np.zeros(3), 3.0 * (1.0 + e) * x
    stiffness, limits = np.array([6.0, 4.0, 2.0]) * (1.0 - e), np.array([0.6, 1.2, 1.2]) * (1.0 + e)
    for i in range(1, x.size):
        most = limits * (1.0 + 0.5 * (1.0 - e) * x[i])
        forces = np.clip(forces + stiffness * (x[i] - x[i - 1]), -most, most)
        out[i] += forces.sum()
    return out


def strain_wave_gear(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """A stiffness for each of three ranges, as its catalogue tells them, and friction that yields gradually."""
    places = np.array([0.0, 0.25 * (1.0 + e), 0.6 * (1.0 - e), 2.0])
    torques = np.concatenate([[0.0], np.cumsum(np.array([3.0 * (1.0 - e), 5.0, 8.0 * (1.0 + e)]) * np.diff(places))])
    return np.sign(x) * np.interp(np.abs(x), places, torques) + 1.2 * (1.0 + e) * slid(x, 0.07 * (1.0 - e), 1.5)


def antagonists(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Two tendons of a stiffness that grows with their tension, each over a capstan."""
    wrap = 0.5 * (1.0 + e) * slid(x, 0.06 * (1.0 - e), 1.0)
    above, below = (np.exp(side * (1.3 * (1.0 - e) * x + wrap)) for side in (1.0, -1.0))
    return 2.0 * (1.0 + e) * (above - below)


def slack_tendons(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Two tendons whose tension grows by the square of how far they are pulled, each over a capstan; one goes slack."""
    wrap = 0.4 * (1.0 + e) * slid(x, 0.05 * (1.0 - e), 1.0)
    pulled = (np.hypot(0.7 * (1.0 + e) + side * x, 0.08) + 0.7 * (1.0 + e) + side * x for side in (1.0, -1.0))
    above, below = (np.square(0.5 * over) * np.exp(side * wrap) for over, side in zip(pulled, (1.0, -1.0), strict=True))
    return 3.0 * (1.0 - e) * (above - below)


def progressive(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """A spring that hardens by a power of the deflection."""
    spring = x + 6.0 * (1.0 + e) * np.sign(x) * np.abs(x) ** (2.4 * (1.0 - e))
    return spring + 0.8 * (1.0 - e) * slid(x, 0.05 * (1.0 + e), 0.7)


JOINTS: dict[str, tuple[Joint, float]] = {
    "kinked": (kinked, 0.005),
    "two sliders": (two_sliders, 0.002),
    "rubber": (rubber, 0.005),
    "smooth yielding": (smooth_yielding, 0.001),
    "Stribeck": (stribeck, 0.01),
    "damped bristles": (damped_bristles, 0.003),
    "bristles by the sample": (bristles_by_the_sample, 0.003),
    "viscoelastic": (viscoelastic, 0.02),
    "saturating": (saturating, 0.02),
    "heavy": (heavy, 0.002),
    "between pads": (between_pads, 0.005),
    "pinching": (pinching, 0.001),
    "metal": (metal, 0.001),
    "used metal": (used_metal, 0.002),
    "damper": (damper, 0.002),
    "spreadsheet": (spreadsheet, 0.005),
    "rigid body": (rigid_body, 0.002),
    "two-sided": (two_sided, 0.005),
    "late and two-sided": (late_and_two_sided, 0.005),
    "Maxwell slip": (maxwell_slip, 0.01),
    "many slip elements": (many_slip_elements, 0.005),
    "superelastic": (superelastic, 0.001),
    "drive line": (drive_line, 0.01),
    "rolling": (rolling, 0.005),
    "leaves": (leaves, 0.001),
    "wedge": (wedge, 0.001),
    "coupling": (coupling, 0.005),
    "hardly yielding": (hardly_yielding, 0.0003),
    "lagging": (lagging, 0.01),
    "staged damper": (staged_damper, 0.01),
    "soft stages": (soft_stages, 0.01),
    "predamper": (predamper, 0.01),
    "pressed by a cam": (pressed_by_a_cam, 0.01),
    "door closer": (door_closer, 0.01),
    "detents": (detents, 0.005),
    "teeth": (teeth, 0.01),
    "absorber": (absorber, 0.005),
    "tendon": (tendon, 0.001),
    "harmonic drive": (harmonic_drive, 0.002),
    "series elastic": (series_elastic, 0.002),
    "rubbing load": (rubbing_load, 0.002),
    "looked up": (looked_up, 0.005),
    "oil chamber": (oil_chamber, 0.005),
    "pneumatic muscle": (pneumatic_muscle, 0.005),
    "phase-changing": (phase_changing, 0.001),
    "flowing gel": (flowing_gel, 0.001),
    "breaking away": (breaking_away, 0.002),
    "leaking drive": (leaking_drive, 0.003),
    "strain wave gear": (strain_wave_gear, 0.001),
    "antagonists": (antagonists, 0.001),
    "progressive": (progressive, 0.002),
    "slack tendons": (slack_tendons, 0.002),
    "belt tensioner": (belt_tensioner, 0.001),
    "snubber": (snubber, 0.002),
    "geared bristles": (geared_bristles, 0.003),
    "on its side": (on_its_side, 0.001),
    "worm gear": (worm_gear, 0.001),
    "bodies on tendons": (bodies_on_tendons, 0.001),
    "magnet": (magnet, 0.001),
    "steel": (steel, 0.002),
}
"""With the error, as a share of the output, that the emulator may make over a motion that it never saw."""
