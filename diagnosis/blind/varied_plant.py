"""A development plant that draws its base and the law of each effect anew for every joint.

Whoever brings a recording has a joint that nobody here has seen. So the constants of the diagnosis are chosen on many
laws of each effect rather than on one: shear-thinning and shear-thickening damping, Dahl and regularised friction, a
LuGre element with its own dynamics, contact with impacts, Hunt-Crossley stops, filters instead of delays, drifting
stiffness instead of a drifting zero. None of them shares code with the registry, few share a form.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.signal import butter, lfilter, lfilter_zi

from .plant import Remade

__all__ = ["LAWS", "OUTSIDE", "Law", "VariedJoint"]

Floats = NDArray[np.float64]
ELEMENTS = 70
SUBSTEPS = 40
"""Steps between samples where a load moves freely in a clearance."""


@njit(cache=True)
def _joint_torque(x, polynomial, stiffness, slide, out):
    """Elastic polynomial and parallel springs with sliders."""
    force = np.zeros(stiffness.size)
    last = 0.0
    for i in range(x.size):
        total, power = 0.0, 1.0
        for c in polynomial:
            total += c * power
            power *= x[i]
        for j in range(stiffness.size):
            force[j] = min(max(force[j] + stiffness[j] * (x[i] - last), -slide[j]), slide[j])
            total += force[j]
        last = x[i]
        out[i] = total


@njit(cache=True)
def _loose_load(x, dt, polynomial, stiffness, slide, half, flank, damping, inertia, out):
    """A joint that hangs on the drive by flanks with clearance: contact stiffness, contact damping, its own mass."""
    force = np.zeros(stiffness.size)
    q, rate, h = x[0], 0.0, dt / SUBSTEPS
    for i in range(x.size):
        mean = 0.0
        for s in range(SUBSTEPS):
            before = x[i - 1] if i > 0 else x[0]
            drive = before + (x[i] - before) * (s + 1) / SUBSTEPS
            pace = (x[i] - before) / dt
            depth = 0.0
            if drive - q > half:
                depth = drive - q - half
            elif q - drive > half:
                depth = drive - q + half
            contact = flank * depth + damping * (pace - rate) if depth != 0.0 else 0.0
            if contact * depth < 0.0:
                contact = 0.0
            total, power = 0.0, 1.0
            for c in polynomial:
                total += c * power
                power *= q
            for j in range(force.size):
                total += force[j]
            rate += h * (contact - total) / inertia
            moved = h * rate
            q += moved
            for j in range(force.size):
                force[j] = min(max(force[j] + stiffness[j] * moved, -slide[j]), slide[j])
            mean += contact / SUBSTEPS
        out[i] = mean


@njit(cache=True)
def _lugre(x, dt, stiffness, sliding, excess, slow, micro, out):
    """LuGre friction (Canudas de Wit et al. 1995) by exact substeps at constant speed."""
    z = 0.0
    for i in range(1, x.size):
        v = (x[i] - x[i - 1]) / dt
        level = sliding + excess * np.exp(-((v / slow) ** 2))
        decay = np.exp(-stiffness * abs(v) * dt / level)
        settled = level / stiffness * (1.0 if v > 0.0 else -1.0)
        before = z
        z = settled + (z - settled) * decay if v != 0.0 else z
        out[i] = stiffness * z + micro * (z - before) / dt


@dataclass(frozen=True)
class _Base:
    polynomial: Floats
    stiffness: Floats
    slide: Floats
    damping: float = 0.0

    def torque(self, time: Floats, x: Floats) -> Floats:
        out = np.empty_like(x)
        _joint_torque(x, self.polynomial, self.stiffness, self.slide, out)
        return out + self.damping * np.gradient(x, time) if self.damping else out


def _elements(force: float, reach: float, count: int, middle: float, width: float) -> tuple[Floats, Floats]:
    yields = np.geomspace(0.008 * reach, 0.8 * reach, count)
    share = np.exp(-0.5 * (np.log(yields / (middle * reach)) / width) ** 2)
    slide = force * share / share.sum()
    return slide / yields, slide


def _bases(rng: np.random.Generator, error: float, reach: float) -> tuple[_Base, _Base]:
    """The joint and its simulator: hardening or softening, preloaded or not, a fat loop or hardly one."""
    size = float(np.exp(rng.uniform(np.log(0.05), np.log(50.0))))
    linear = rng.uniform(3.0, 7.0)
    curve = np.array([
        rng.choice([0.0, 0.0, rng.uniform(-0.5, 0.5)]),
        linear,
        linear / reach * rng.choice([0.0, 0.0, rng.uniform(-0.15, 0.15)]),
        linear / reach**2 * rng.uniform(-0.15, 0.5),
        0.0,
        linear / reach**4 * rng.choice([0.0, rng.uniform(0.0, 0.2)]),
    ])  # fmt: skip
    force = linear * reach * float(np.exp(rng.uniform(np.log(0.02), np.log(0.35))))
    middle, width = rng.uniform(0.04, 0.3), rng.uniform(0.5, 1.3)
    damping = rng.choice([0.0, 0.0, 0.03 * linear])
    count = int(rng.choice([ELEMENTS, 40, 24]))
    off = 1.0 + error * rng.standard_normal(9)
    each = 1.0 + error * rng.standard_normal((2, count))
    k, f = _elements(force, reach, ELEMENTS, middle, width)
    real = _Base(size * curve, size * k, size * f, size * damping)
    k, f = _elements(force * off[6], reach, count, middle, width)
    simulated = _Base(size * curve * off[:6], size * k * each[0] * off[7], size * f * each[1], size * damping * off[8])
    return real, simulated


@dataclass
class _State:
    """A torque while it is put together, and the scales of the motion for which the joint was designed."""

    time: Floats
    x: Floats
    base: _Base
    reach: float
    scales: Mapping[str, float]
    torque: Floats
    measured: Floats

    @property
    def dt(self) -> float:
        return float(self.time[1] - self.time[0])

    @property
    def speed(self) -> Floats:
        return np.asarray(CubicSpline(self.time, self.x)(self.time, 1))

    def add(self, size: float, shape: Floats) -> None:
        self.torque = self.torque + 0.1 * size * self.scales["torque"] * shape


Law = Callable[[_State, float, np.random.Generator], None]


def _filtered(series: Floats, dt: float, order: int, corner: float) -> Floats:
    b, a = butter(order, min(2.0 * corner * dt, 0.95))
    return np.asarray(lfilter(b, a, series, zi=lfilter_zi(b, a) * series[0])[0])


# ---- friction --------------------------------------------------------------------------------------------------------


def _thinning(s: _State, a: float, rng: np.random.Generator) -> None:
    v = s.speed / s.scales["speed"]
    s.add(a, np.sign(v) * np.abs(v) ** rng.uniform(0.6, 0.85))


def _thickening(s: _State, a: float, rng: np.random.Generator) -> None:
    v = s.speed / s.scales["speed"]
    s.add(a, v * (1.0 + 0.2 * np.abs(v)))


def _linear_damping(s: _State, a: float, rng: np.random.Generator) -> None:
    s.add(a, s.speed / s.scales["speed"])


def _dahl(s: _State, a: float, rng: np.random.Generator) -> None:
    out = np.zeros_like(s.x)
    _lugre(s.x, s.dt, 1.0 / (rng.uniform(0.002, 0.03) * s.reach), 1.0, 0.0, 1.0, 0.0, out)
    s.add(a, out)


def _sharp(s: _State, a: float, rng: np.random.Generator) -> None:
    s.add(a, np.tanh(s.speed / (rng.uniform(0.005, 0.05) * s.scales["speed"])))


def _two_sliders(s: _State, a: float, rng: np.random.Generator) -> None:
    lengths = s.reach * np.array([rng.uniform(0.002, 0.01), rng.uniform(0.01, 0.04)])
    out = np.empty_like(s.x)
    _joint_torque(s.x - s.x[0], np.zeros(1), 0.5 / lengths, np.array([0.5, 0.5]), out)
    s.add(a, out)


def _lugre_friction(s: _State, a: float, rng: np.random.Generator) -> None:
    out = np.zeros_like(s.x)
    stiffness = 1.0 / (rng.uniform(0.003, 0.01) * s.reach)
    slow = rng.uniform(0.1, 0.35) * s.scales["speed"]
    _lugre(s.x, s.dt, stiffness, 0.6, rng.uniform(0.5, 1.2), slow, 0.3 * np.sqrt(stiffness) * 0.01, out)
    s.add(a, out)


def _curve_friction(s: _State, a: float, rng: np.random.Generator) -> None:
    v = s.speed / s.scales["speed"]
    s.add(a, np.tanh(v / 0.02) * (0.5 + rng.uniform(0.6, 1.2) * np.exp(-((np.abs(v) / rng.uniform(0.15, 0.4)) ** 0.8))))


def _mesh_friction(s: _State, a: float, rng: np.random.Generator) -> None:
    out = np.zeros_like(s.x)
    _lugre(s.x, s.dt, 1.0 / (rng.uniform(0.004, 0.02) * s.reach), 1.0, 0.0, 1.0, 0.0, out)
    s.torque = s.torque + 0.1 * a * np.abs(s.torque) * out


def _mesh_friction_sharp(s: _State, a: float, rng: np.random.Generator) -> None:
    sign = np.tanh(s.speed / (0.02 * s.scales["speed"]))
    # Less than in proportion: the teeth's contact area grows with load.
    load = s.scales["torque"] * np.abs(s.torque / s.scales["torque"]) ** rng.uniform(0.85, 1.0)
    s.torque = s.torque + 0.1 * a * load * sign


# ---- time ------------------------------------------------------------------------------------------------------------


def _branches(s: _State, taus: Sequence[float], shares: Sequence[float]) -> Floats:
    total = np.zeros_like(s.x)
    for tau, share in zip(taus, shares, strict=True):
        keep = np.exp(-s.dt / tau)
        # dF/dt = dx/dt − F/τ, exact for a ramp between samples.
        gain = tau / s.dt * (1.0 - keep)
        total += share * lfilter([gain, -gain], [1.0, -keep], s.x - s.x[0])
    return total / s.reach


def _one_branch(s: _State, a: float, rng: np.random.Generator) -> None:
    s.add(a, 2.0 * _branches(s, [rng.uniform(0.2, 3.0)], [1.0]))


def _two_branches(s: _State, a: float, rng: np.random.Generator) -> None:
    tau = rng.uniform(0.1, 0.6)
    s.add(a, 2.0 * _branches(s, [tau, tau * rng.uniform(4.0, 15.0)], [0.5, 0.5]))


def _power_law(s: _State, a: float, rng: np.random.Generator) -> None:
    taus = np.geomspace(0.05, 20.0, 9)
    shares = taus ** -rng.uniform(0.2, 0.5) / 3.0
    s.add(a, 2.0 * _branches(s, taus.tolist(), shares.tolist()))


def _relaxing_torque(s: _State, a: float, rng: np.random.Generator) -> None:
    tau = rng.uniform(0.4, 3.0)
    keep = np.exp(-s.dt / tau)
    settled = lfilter([1.0 - keep], [1.0, -keep], s.torque, zi=[keep * s.torque[0]])[0]
    s.torque = s.torque + 0.1 * a * (s.torque - settled)


def _warm_zero(s: _State, a: float, rng: np.random.Generator) -> None:
    s.add(a * rng.choice([-1.0, 1.0]), 1.0 - np.exp(-s.time / (rng.uniform(0.15, 1.0) * s.scales["duration"])))


def _warm_stiffness(s: _State, a: float, rng: np.random.Generator) -> None:
    """Losses heat the joint, and it softens."""
    power = np.abs(s.torque * s.speed) / s.scales["power"] + rng.uniform(0.0, 0.5)
    keep = np.exp(-s.dt / (rng.uniform(0.15, 0.6) * s.scales["duration"]))
    s.torque = s.torque * (1.0 - min(0.1 * a, 0.9) * lfilter([1.0 - keep], [1.0, -keep], power))


def _drifting_zero(s: _State, a: float, rng: np.random.Generator) -> None:
    u = s.time / s.scales["duration"]
    s.add(a * rng.choice([-1.0, 1.0]), u * (1.0 - rng.uniform(0.0, 0.4) * u))


def _wear_by_cycles(s: _State, a: float, rng: np.random.Generator) -> None:
    """A loss at each reversal, less each time."""
    turned = np.cumsum(np.abs(np.diff(np.sign(np.diff(s.x, prepend=s.x[0])), prepend=0.0)) > 0.5).astype(np.float64)
    most = s.scales["turns"]
    s.torque = s.torque * (1.0 - min(0.2 * a, 0.9) * (1.0 - np.exp(-turned / (rng.uniform(0.15, 0.6) * most))))


def _wear_by_work(s: _State, a: float, rng: np.random.Generator) -> None:
    work = np.cumsum(np.abs(s.torque * np.diff(s.x, prepend=s.x[0])))
    constant = rng.uniform(0.1, 0.6) * s.scales["work"]
    s.torque = s.torque * (1.0 - min(0.2 * a, 0.9) * (1.0 - np.exp(-work / constant)))


def _wear_by_travel(s: _State, a: float, rng: np.random.Generator) -> None:
    travel = np.cumsum(np.abs(np.diff(s.x, prepend=s.x[0]))) / s.scales["travel"]
    s.torque = s.torque * (1.0 - min(0.2 * a, 0.9) * travel ** rng.uniform(0.5, 0.9))


# ---- sensors ---------------------------------------------------------------------------------------------------------


def _bias(s: _State, a: float, rng: np.random.Generator) -> None:
    s.torque = s.torque + 0.1 * a * s.scales["torque"] * rng.choice([-1.0, 1.0])


def _gain(s: _State, a: float, rng: np.random.Generator) -> None:
    s.torque = s.torque * (1.0 + 0.1 * a * rng.choice([-1.0, 1.0]))


def _late(s: _State, a: float, rng: np.random.Generator) -> None:
    s.torque = CubicSpline(s.time, s.torque)(np.maximum(s.time - 0.02 * a, s.time[0]))


def _lagging(s: _State, a: float, rng: np.random.Generator) -> None:
    keep = np.exp(-s.dt / (0.02 * a))
    s.torque = lfilter([1.0 - keep], [1.0, -keep], s.torque, zi=[keep * s.torque[0]])[0]


def _second_order(s: _State, a: float, rng: np.random.Generator) -> None:
    fine = CubicSpline(s.time, s.torque)(np.linspace(s.time[0], s.time[-1], 8 * (s.time.size - 1) + 1))
    s.torque = _filtered(fine, s.dt / 8.0, 2, 0.225 / (0.02 * a))[::8]


def _limited(s: _State, a: float, rng: np.random.Generator) -> None:
    limit = 1.2 * s.scales["most torque"] / (1.0 + 0.25 * a)
    s.torque = np.clip(s.torque, -limit, limit)


def _knee(s: _State, a: float, rng: np.random.Generator) -> None:
    limit, width = 1.5 * s.scales["most torque"] / (1.0 + 0.25 * a), rng.uniform(0.02, 0.08) * s.scales["most torque"]
    over = width * np.logaddexp(0.0, (np.abs(s.torque) - limit) / width)
    s.torque = np.sign(s.torque) * (np.abs(s.torque) - over)


def _smooth_limit(s: _State, a: float, rng: np.random.Generator) -> None:
    limit = 20.0 * s.scales["most torque"] / (1.0 + a)
    s.torque = limit * 2.0 / np.pi * np.arctan(0.5 * np.pi * s.torque / limit)


def _tilted_disc(s: _State, a: float, rng: np.random.Generator) -> None:
    """Zero at home, as after homing."""
    n, phase = rng.uniform(2.5, 8.0) * 0.5 * np.pi / s.reach, rng.uniform(0.0, 6.28)
    s.measured = s.measured + 0.02 * a * s.reach * (np.sin(n * s.x + phase) - np.sin(phase))


def _two_heads(s: _State, a: float, rng: np.random.Generator) -> None:
    n, phase = rng.uniform(2.5, 6.0) * 0.5 * np.pi / s.reach, rng.uniform(0.0, 6.28, 2)
    error = np.sin(n * s.x + phase[0]) + 0.3 * np.sin(2.0 * n * s.x + phase[1])
    s.measured = s.measured + 0.02 * a * s.reach * error


def _zero(s: _State, a: float, rng: np.random.Generator) -> None:
    s.measured = s.measured + 0.03 * a * s.reach * rng.choice([-1.0, 1.0])


# ---- drive and structure ---------------------------------------------------------------------------------------------


def _dead_zone(s: _State, a: float, rng: np.random.Generator) -> None:
    half = 0.025 * a * s.reach
    inner = s.x - np.clip(s.x, -half, half)
    s.torque = s.torque + s.base.torque(s.time, inner) - s.base.torque(s.time, s.x)


def _play(s: _State, a: float, rng: np.random.Generator) -> None:
    half = 0.025 * a * s.reach
    inner, at = np.empty_like(s.x), 0.0
    for i, x in enumerate(s.x.tolist()):
        at = min(max(at, x - half), x + half)
        inner[i] = at
    s.torque = s.torque + s.base.torque(s.time, inner) - s.base.torque(s.time, s.x)


def _loose(s: _State, a: float, rng: np.random.Generator) -> None:
    out = np.empty_like(s.x)
    total = float(s.base.polynomial[1] + s.base.stiffness.sum())
    natural = 2.0 * np.pi * rng.uniform(12.0, 25.0)
    inertia = total / natural**2
    flank = rng.uniform(8.0, 20.0) * total
    damping = 2.0 * rng.uniform(0.1, 0.5) * np.sqrt(flank * inertia)
    _loose_load(
        s.x, s.dt, s.base.polynomial, s.base.stiffness, s.base.slide, 0.025 * a * s.reach, flank, damping, inertia, out
    )
    still = np.empty_like(s.x)
    _loose_load(s.x, s.dt, s.base.polynomial, s.base.stiffness, s.base.slide, 0.0, flank, damping, inertia, still)
    s.torque = s.torque + out - still


def _sides(s: _State, rng: np.random.Generator) -> tuple[float, float]:
    side = float(rng.choice([-1.0, 1.0]))
    return side, rng.uniform(0.65, 0.9) * s.scales["up" if side > 0.0 else "down"]


def _damped_stop(s: _State, a: float, rng: np.random.Generator) -> None:
    side, place = _sides(s, rng)
    depth = np.maximum(side * s.x - place, 0.0) / s.reach
    rate = rng.uniform(0.05, 0.3) * side * s.speed / s.scales["speed"]
    s.add(a, side * 50.0 * np.maximum(depth * (depth > 0.0) + 0.1 * rate * (depth > 0.0), 0.0))


def _hunt_crossley(s: _State, a: float, rng: np.random.Generator) -> None:
    side, place = _sides(s, rng)
    depth = np.maximum(side * s.x - place, 0.0) / s.reach
    rate = side * s.speed / s.scales["speed"]
    s.add(a, side * 100.0 * depth ** rng.uniform(1.2, 1.6) * np.maximum(1.0 + rng.uniform(0.0, 0.5) * rate, 0.0))


def _two_stops(s: _State, a: float, rng: np.random.Generator) -> None:
    share = rng.uniform(0.7, 0.88)
    up, down = np.maximum(s.x - share * s.scales["up"], 0.0), np.maximum(-s.x - share * s.scales["down"], 0.0)
    s.add(a, 50.0 * (up - rng.uniform(0.6, 1.4) * down) / s.reach)


def _mass(s: _State, a: float, rng: np.random.Generator) -> None:
    s.add(a, CubicSpline(s.time, s.x)(s.time, 2) / s.scales["acceleration"])


def _mass_on_shaft(s: _State, a: float, rng: np.random.Generator) -> None:
    """The mass follows through a shaft that is not quite stiff."""
    acceleration = CubicSpline(s.time, s.x)(s.time, 2) / s.scales["acceleration"]
    s.add(a, _filtered(acceleration, s.dt, 2, rng.uniform(15.0, 40.0)))


def _one_spring(s: _State, a: float, rng: np.random.Generator) -> None:
    side = float(rng.choice([-1.0, 1.0]))
    s.add(a, 2.0 * np.maximum(side * s.x, 0.0) * side / s.reach)


def _blended(s: _State, a: float, rng: np.random.Generator) -> None:
    side = float(rng.choice([-1.0, 1.0]))
    s.add(a, side * s.x / s.reach * np.tanh(s.x / (rng.uniform(0.03, 0.1) * s.reach)))


def _stronger_torque(s: _State, a: float, rng: np.random.Generator) -> None:
    side = float(rng.choice([-1.0, 1.0]))
    s.torque = s.torque * (1.0 + 0.1 * a * (side * s.x > 0.0))


LAWS: dict[str, tuple[Law, ...]] = {
    "viscous_friction": (_thinning, _thickening, _linear_damping),
    "coulomb_friction": (_dahl, _sharp, _two_sliders),
    "stribeck_friction": (_lugre_friction, _curve_friction),
    "load_dependent_friction": (_mesh_friction, _mesh_friction_sharp),
    "stress_relaxation": (_one_branch, _two_branches, _power_law, _relaxing_torque),
    "thermal_drift": (_warm_zero, _warm_stiffness, _drifting_zero),
    "cyclic_softening": (_wear_by_cycles, _wear_by_work, _wear_by_travel),
    "torque_offset": (_bias,),
    "torque_gain": (_gain,),
    "sensor_delay": (_late, _lagging, _second_order),
    "backlash": (_play, _dead_zone, _loose),
    "end_stop": (_damped_stop, _hunt_crossley, _two_stops),
    "inertia": (_mass, _mass_on_shaft),
    "encoder_eccentricity": (_tilted_disc, _two_heads),
    "deflection_offset": (_zero,),
    "stiffness_asymmetry": (_one_spring, _blended, _stronger_torque),
    "torque_saturation": (_limited, _knee, _smooth_limit),
}
"""Laws of each effect of the registry."""
SENSED = ("torque_gain", "torque_offset", "sensor_delay", "torque_saturation")
"""Effects of the torque sensor, which sees what all others made."""


# ---- what no entry of the registry describes ---------------------------------------------------------------------------


def _mains_hum(s: _State, a: float, rng: np.random.Generator) -> None:
    s.add(a, np.sin(2.0 * np.pi * rng.uniform(1.0, 8.0) * s.time + rng.uniform(0.0, 6.28)))


def _coarse(s: _State, a: float, rng: np.random.Generator) -> None:
    step = 0.1 * a * s.scales["torque"] * np.sqrt(12.0)
    s.torque = step * np.round(s.torque / step)


def _leaning(s: _State, a: float, rng: np.random.Generator) -> None:
    s.add(a, 3.0 * _filtered(rng.standard_normal(s.x.size), s.dt, 1, rng.uniform(0.2, 1.0)))


def _loosening(s: _State, a: float, rng: np.random.Generator) -> None:
    """A clamp that slips now and then: the zero of the torque jumps."""
    edges = np.sort(rng.uniform(0.05, 0.95, 6)) * s.scales["duration"]
    s.add(a, rng.standard_normal(7)[np.searchsorted(edges, s.time)])


def _rough_place(s: _State, a: float, rng: np.random.Generator) -> None:
    """Friction at one place of the stroke."""
    out = np.zeros_like(s.x)
    _lugre(s.x, s.dt, 1.0 / (0.008 * s.reach), 1.0, 0.0, 1.0, 0.0, out)
    s.add(a, 3.0 * out * np.exp(-(((s.x / s.reach - rng.uniform(-0.4, 0.4)) / 0.08) ** 2)))


OUTSIDE: dict[str, Law] = {
    "mains hum": _mains_hum, "coarse sensor": _coarse, "leaning": _leaning, "loosening": _loosening,
    "rough place": _rough_place,
}  # fmt: skip
"""Effects that no entry of the registry describes."""


class VariedJoint(Remade):
    """One random design; its effects' laws and parameters are drawn once and kept for every motion."""

    clean_input = False

    def __init__(self, seed: int, base_error: float, motion: Callable[[float], tuple[Floats, Floats]]) -> None:
        self._seed, self._base_error = seed, base_error
        self.reach = self._drawn[0]
        time, x = motion(self.reach)
        torque = self._real.torque(time, x)
        course = CubicSpline(time, x)
        speed = course(time, 1)
        self._scales = {
            "torque": float(np.std(torque)), "most torque": float(np.max(np.abs(torque))),
            "speed": float(np.std(speed)), "acceleration": float(np.std(course(time, 2))),
            "power": float(np.mean(np.abs(torque * speed))), "up": float(np.max(x)), "down": float(-np.min(x)),
            "travel": float(np.sum(np.abs(np.diff(x)))), "duration": float(time[-1]),
            "turns": max(float(np.count_nonzero(np.diff(np.sign(np.diff(x))))), 1.0),
            "work": float(np.sum(np.abs(torque * np.diff(x, prepend=0.0)))),
        }  # fmt: skip

    @cached_property
    def _drawn(self) -> tuple[float, _Base, _Base]:
        rng = np.random.default_rng([self._seed, 0])
        reach = float(np.exp(rng.uniform(np.log(0.05), np.log(2.0))))
        return reach, *_bases(rng, self._base_error, reach)

    @property
    def _real(self) -> _Base:
        return self._drawn[1]

    def law(self, name: str) -> Law:
        """The law that this joint's effect follows."""
        choices = LAWS.get(name) or (OUTSIDE[name],)
        return choices[int(np.random.default_rng([self._seed, 5]).integers(0, 60)) % len(choices)]

    def real(self, time: Floats, x: Floats, sizes: Mapping[str, float]) -> tuple[Floats, Floats]:
        """Measured deflection and torque, free of noise, with effects of the given sizes."""
        state = _State(time, x, self._real, self.reach, self._scales, self._real.torque(time, x), x.copy())
        order = [*LAWS, *OUTSIDE]
        for name in sorted(sizes, key=lambda n: (n in SENSED, order.index(n))):
            self.law(name)(state, sizes[name], np.random.default_rng([self._seed, 2, order.index(name)]))
        return state.measured, state.torque

    def simulated(self, time: Floats, x: Floats) -> Floats:
        """The simulator's torque."""
        return self._drawn[2].torque(time, x)
