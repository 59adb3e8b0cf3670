"""Simulators of matter: alloys that change their phase, gels that flow, bristles that break away, gas that leaks, magnets, steel.

As those of :mod:`simulators` each has its parameters off by ``e``, some up and some down, and shares no code with the emulator.
"""

from __future__ import annotations

import itertools

import numpy as np
from joints import compiled
from numpy.typing import NDArray

__all__ = ["breaking_away", "flowing_gel", "leaking_drive", "magnet", "phase_changing", "steel"]

Floats = NDArray[np.float64]
INTERVAL = 0.01
"""Of the samples, s."""


def phase_changing(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """Five wires a side that change their phase one after the other when pulled, and back again at a lower force."""
    stiffness, hardening, way = 15.0, 0.8, 0.4 * (1.0 + e)
    starts = np.array([0.65, 0.8, 1.0, 1.2, 1.35])
    total = 2.0 * (1.0 - e) * x
    for side in (1.0, -1.0):
        changed, there, back = np.zeros(starts.size), 4.5 * (1.0 - e) * starts, 2.0 * (1.0 + e) * starts
        for i, pulled in enumerate(np.maximum(side * x, 0.0)):
            # The share that has changed at which the wire is just at the force that changes more of it, or less.
            more = (stiffness * pulled - there) / (stiffness * way + hardening)
            less = (stiffness * pulled - back) / (stiffness * way + hardening)
            changed = np.clip(np.clip(changed, more, less), 0.0, 1.0)
            total[i] += side * stiffness * float(np.mean(pulled - way * changed))
    return np.asarray(total)


@compiled
def flowing_gel(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """A gel that flows beyond its yield point, by the square of how far it is over it, in small steps, beside a spring."""
    force, out, fine = 0.0, np.zeros(x.size), 40
    for i in range(1, x.size):
        step = (x[i] - x[i - 1]) / fine
        for _ in range(fine):
            force += 25.0 * step
            over = max(abs(force) - 2.5 * (1.0 + e), 0.0)
            force -= np.sign(force) * min(25.0 * INTERVAL / fine * over**2 / (0.8 * (1.0 - e)), over)
        out[i] = force
    return 3.0 * (1.0 + e) * x + out


@compiled
def breaking_away(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """An elasto-plastic bristle whose friction falls with the speed and that resists its own, in small steps."""
    z, out, fine = 0.0, np.zeros(x.size), 20
    stiffness = 12.0 * (1.0 - e)
    for i in range(1, x.size):
        speed = (x[i] - x[i - 1]) / INTERVAL
        most = (1.2 * (1.0 + e) + 0.6 * np.exp(-((speed / 0.25) ** 2))) / stiffness
        least, moved = 0.7 / stiffness, 0.0
        for _ in range(fine):
            share = 0.0
            if z * speed > 0.0 and abs(z) > least:
                share = 0.5 - 0.5 * np.cos(np.pi * min((abs(z) - least) / (most - least), 1.0))
            moved = speed * (1.0 - share * abs(z) / most)
            z += moved * INTERVAL / fine
        out[i] = stiffness * z + 0.2 * moved
    return 5.0 * (1.0 + e) * x + out


@compiled
def leaking_drive(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """A pneumatic drive of two chambers that leak to what surrounds them, whose pressure presses the seal."""
    over, out, fine, rubs = np.zeros(2), np.zeros(x.size), 10, 0.0
    sides, reach = np.array([1.0, -1.0]), 2.2 * (1.0 + e)
    volume = 1.0 + sides * x[0] / reach
    for i in range(1, x.size):
        rubs = min(max(rubs + (x[i] - x[i - 1]) / 0.05, -1.0), 1.0)
        for k in range(fine):
            now = 1.0 + sides * (x[i - 1] + (x[i] - x[i - 1]) * (k + 1) / fine) / reach
            over = (1.0 + over) * (volume / now) ** 1.3 - 1.0
            over -= INTERVAL / fine * 0.15 * (1.0 - e) / now * over / np.sqrt(np.abs(over) + 0.05)
            volume = now
        out[i] = 12.0 * (over[1] - over[0]) + (1.0 + 1.5 * (1.0 + e) * np.abs(over).sum()) * rubs
    return 4.0 * (1.0 - e) * x + out


@compiled
def magnet(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """A magnetic drive by Jiles and Atherton's equation in small explicit steps, beside a spring."""
    shape, pinned, coupling, bends = 0.2 * (1.0 + e), 0.15 * (1.0 - e), 0.03, 0.2 * (1.0 + e)
    held = whole = 0.0
    out, fine = np.zeros(x.size), 40
    for i in range(1, x.size):
        step = (x[i] - x[i - 1]) / fine
        way = np.sign(step)
        for k in range(fine):
            seen = (x[i - 1] + (k + 0.5) * step + coupling * whole) / shape
            aligned = 1.0 / np.tanh(seen) - 1.0 / seen if abs(seen) > 1e-4 else seen / 3.0
            if (aligned - held) * way > 0.0:
                held += step * way * (aligned - held) / (pinned - coupling * abs(aligned - held))
            whole = bends * aligned + (1.0 - bends) * held
        out[i] = whole
    return 2.0 * (1.0 - e) * x + 0.7 * (1.0 + e) * x**3 + 3.0 * (1.0 - e) * out


def steel(time: Floats, x: Floats, e: float = 0.0) -> Floats:
    """A bar of steel by Menegotto and Pinto, branch by branch, beside a hardening spring."""
    yields, after, sharp = 0.2 * (1.0 + e), 0.05 * (1.0 - e), 8.0 * (1.0 - e)
    turns = np.flatnonzero(np.diff(np.sign(np.diff(x)))) + 1
    ends = [0, *turns.tolist(), x.size - 1]
    force, farthest = np.zeros(x.size), {1.0: yields, -1.0: -yields}
    for start, stop in itertools.pairwise(ends):
        way = float(np.sign(x[stop] - x[start]))
        if start:
            farthest[-way] = -way * max(-way * farthest[-way], -way * x[start])
            # The way out is elastic; beyond, the line through the first yield on that side.
            meets = (way * yields * (1.0 - after) - force[start] + x[start]) / (1.0 - after)
        else:
            meets = way * yields
        excursion = abs(farthest[way] - meets) / yields if start else 0.0
        power = sharp * (1.0 - 0.6 * excursion / (0.3 + excursion))
        along = (x[start : stop + 1] - x[start]) / (meets - x[start])
        rise = after * along + (1.0 - after) * along / (1.0 + along**power) ** (1.0 / power)
        force[start : stop + 1] = force[start] + (meets - x[start]) * rise
    return 1.5 * (1.0 + e) * x + (1.0 - e) * x**3 + 4.0 * (1.0 - e) * force
