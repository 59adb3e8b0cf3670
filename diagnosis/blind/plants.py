"""Plants for the blind check. They share neither code nor functional form with the registry of effects.

A plant is a joint torque as a function of the true motion. Its effects follow other laws than the registry's
candidates wherever another law is physical: Carreau instead of power-law viscosity, Jenkins elements instead of
exponential presliding, an algebraic Stribeck curve of broken power, a spectrum of relaxation times, a heat balance, hyperbolic wear,
an encoder that errs as a function of the true angle, rounded stops and limits.

Development plants (parallel slip elements; a Bouc-Wen ODE; joints whose laws are drawn anew, in ``varied_plant``) and a
test plant (an asymmetric, position-dependent slip plant with a hardening spring) keep tuning and reporting apart.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from .motions import MOTIONS
from .plant import Case, Joint, Made, Plant, Remade, sized
from .varied_plant import VariedJoint

__all__ = ["EFFECTS", "MUJOCO", "OUTSIDE", "PLANTS", "VARIED", "AnalyticJoint", "Case", "Made", "make", "plant_of"]

Floats = NDArray[np.float64]
MUJOCO, VARIED = "mujoco", "varied"
"""Names of the plants that are simulated by MuJoCo, and whose laws are drawn anew for each joint."""


@njit(cache=True)
def _slip(x, stiffness, slide, out):
    """Parallel Jenkins elements: spring and slider in series; total force at each sample."""
    force = np.zeros(stiffness.size)
    last = 0.0
    for i in range(x.size):
        moved = x[i] - last
        last = x[i]
        total = 0.0
        for j in range(force.size):
            f = force[j] + stiffness[j] * moved
            limit = slide[j]
            force[j] = limit if f > limit else (-limit if f < -limit else f)
            total += force[j]
        out[i] = total


@njit(cache=True)
def _bouc_wen(x, stiffness, strength, sharpness, out):
    """Normalised Bouc-Wen, dz/dx = stiffness (1 − |z/strength|^n sgn(z dx)), by substeps along the path."""
    z = 0.0
    last = 0.0
    for i in range(x.size):
        moved = x[i] - last
        last = x[i]
        steps = 1 + int(abs(moved) * stiffness / (0.02 * strength))
        h = moved / steps
        for _ in range(steps):
            s = 1.0 if z * h > 0.0 else -1.0
            slope = stiffness * (1.0 - s * abs(z / strength) ** sharpness)
            middle = z + 0.5 * h * slope
            s = 1.0 if middle * h > 0.0 else -1.0
            z += h * stiffness * (1.0 - s * abs(middle / strength) ** sharpness)
        out[i] = z


# ---- base plants ----------------------------------------------------------------------------------------------------


def _distribution(
    rng: np.random.Generator, elements: int, force: float, reach: float, spread: float
) -> tuple[Floats, Floats]:
    """Stiffness and sliding force of parallel elements whose yield deflections are spread evenly in logarithm."""
    yields = np.geomspace(0.01 * reach, spread * reach, elements)
    share = np.exp(-0.5 * (np.log(yields / (0.12 * reach)) / 1.1) ** 2)
    slide = force * share / share.sum()
    return slide / yields, slide


@dataclass(frozen=True)
class _Base:
    """A base plant: real and simulated joint of one random design."""

    reach: float
    real: Callable[[Floats], Floats]
    simulated: Callable[[Floats], Floats]
    clean_input: bool = False
    """Whether the simulator is driven by the motion without the encoder's noise."""


def _off(rng: np.random.Generator, error: float, size: int | None = None) -> Any:
    return 1.0 + error * rng.standard_normal(size)


def _slip_plant(rng: np.random.Generator, error: float) -> _Base:
    reach = rng.uniform(0.6, 1.2)
    stiffness, cubic, force = rng.uniform(3.0, 7.0), rng.uniform(0.0, 2.0), rng.uniform(0.5, 1.2)
    k60, f60 = _distribution(rng, 60, force, reach, 0.7)
    k19, f19 = _distribution(rng, 19, force, reach, 0.7)
    a, b, c = _off(rng, error), _off(rng, error), _off(rng, error)
    each, limit = _off(rng, error, 19), _off(rng, error, 19)

    def real(x: Floats) -> Floats:
        out = np.empty_like(x)
        _slip(x, k60, f60, out)
        return out + stiffness * x + cubic * x**3

    def simulated(x: Floats) -> Floats:
        out = np.empty_like(x)
        _slip(x, k19 * c * each, f19 * c * limit, out)
        return out + stiffness * a * x + cubic * b * x**3

    return _Base(reach, real, simulated)


def _bouc_wen_plant(rng: np.random.Generator, error: float) -> _Base:
    reach = rng.uniform(0.5, 1.0)
    stiffness, cubic = rng.uniform(3.0, 8.0), rng.uniform(-0.5, 3.0)
    steep, strength, sharp = rng.uniform(6.0, 15.0), rng.uniform(0.4, 1.0), rng.uniform(1.0, 1.8)
    a, b, c, d = (_off(rng, error) for _ in range(4))

    def run(x: Floats, p: tuple[float, ...]) -> Floats:
        out = np.empty_like(x)
        _bouc_wen(x, p[2], p[3], sharp, out)
        return out + p[0] * x + p[1] * x**3

    return _Base(
        reach,
        lambda x: run(x, (stiffness, cubic, steep, strength)),
        lambda x: run(x, (stiffness * a, cubic * b, steep * c, strength * d)),
        clean_input=True,
    )


def _asymmetric_plant(rng: np.random.Generator, error: float) -> _Base:
    """Friction grows with |x| and the spring hardens differently up and down (a belt over pulleys)."""
    reach = rng.uniform(0.7, 1.1)
    stiffness, up, down = rng.uniform(3.0, 6.0), rng.uniform(0.5, 2.0), rng.uniform(0.5, 2.0)
    force, place = rng.uniform(0.4, 0.9), rng.uniform(0.2, 0.6)
    k40, f40 = _distribution(rng, 40, 1.0, reach, 0.5)
    k15, f15 = _distribution(rng, 15, 1.0, reach, 0.5)
    a, b, c, d, e = (_off(rng, error) for _ in range(5))
    limit = _off(rng, error, 15)

    def run(x: Floats, k: Floats, f: Floats, p: tuple[float, ...]) -> Floats:
        out = np.empty_like(x)
        _slip(x, k, f, out)
        spring = p[0] * x + p[1] * np.maximum(x, 0.0) ** 3 - p[2] * np.maximum(-x, 0.0) ** 3
        return spring + p[3] * (1.0 + p[4] * (x / reach) ** 2) * out

    return _Base(
        reach,
        lambda x: run(x, k40, f40, (stiffness, up, down, force, place)),
        lambda x: run(x, k15, f15 * limit, (stiffness * a, up * b, down * c, force * d, place * e)),
    )


PLANTS: dict[str, Callable[[np.random.Generator, float], _Base]] = {
    "slip": _slip_plant,
    "bouc-wen": _bouc_wen_plant,
    "asymmetric": _asymmetric_plant,
}


# ---- effects of the plants ------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Typical:
    """Scales of the motion for which a joint was designed; they make its effects' parameters absolute."""

    torque: float
    most_torque: float
    speed: float
    acceleration: float
    power: float
    up: float
    down: float
    travel: float
    duration: float

    @classmethod
    def of(cls, time: Floats, x: Floats, torque: Floats) -> _Typical:
        speed = np.gradient(x, time)
        return cls(
            float(np.std(torque)), float(np.max(np.abs(torque))), float(np.std(speed)),
            float(np.std(CubicSpline(time, x)(time, 2))), float(np.mean(np.abs(torque * speed))),
            float(np.max(x)), float(-np.min(x)), float(np.sum(np.abs(np.diff(x)))), float(time[-1]),
        )  # fmt: skip


@dataclass
class _Joint:
    """The state while a real torque is put together; each effect changes it by a size ``a`` (1 is typical)."""

    time: Floats
    x: Floats
    base: _Base
    typical: _Typical
    torque: Floats
    measured: Floats
    speed: Floats = field(init=False)

    def __post_init__(self) -> None:
        self.speed = np.gradient(self.x, self.time)

    @property
    def scale(self) -> float:
        return self.typical.torque


def _jenkins_sign(x: Floats, length: float) -> Floats:
    out = np.empty_like(x)
    _slip(x - x[0], np.array([1.0 / length]), np.array([1.0]), out)
    return out


def _viscous(j: _Joint, a: float, rng: np.random.Generator) -> None:
    typical = j.typical.speed
    j.torque = j.torque + a * 0.1 * j.scale * (j.speed / typical) * (1.0 + (j.speed / (3.0 * typical)) ** 2) ** -0.1


def _coulomb(j: _Joint, a: float, rng: np.random.Generator) -> None:
    j.torque = j.torque + a * 0.1 * j.scale * _jenkins_sign(j.x, rng.uniform(0.004, 0.02) * j.base.reach)


def _stribeck(j: _Joint, a: float, rng: np.random.Generator) -> None:
    slow = rng.uniform(0.1, 0.3) * j.typical.speed
    curve = 0.5 + rng.uniform(0.8, 1.5) / (1.0 + np.abs(j.speed / slow) ** 1.5)
    j.torque = j.torque + a * 0.1 * j.scale * curve * _jenkins_sign(j.x, 0.006 * j.base.reach)


def _load_friction(j: _Joint, a: float, rng: np.random.Generator) -> None:
    load = np.sqrt(j.torque**2 + (0.03 * j.scale) ** 2)
    j.torque = j.torque + a * 0.1 * load * _jenkins_sign(j.x, rng.uniform(0.006, 0.03) * j.base.reach)


def _relaxation(j: _Joint, a: float, rng: np.random.Generator) -> None:
    """Three Maxwell branches half a decade apart, stepped implicitly."""
    first = rng.uniform(0.2, 1.0)
    dt = np.diff(j.time, prepend=j.time[0] - (j.time[1] - j.time[0]))
    moved = np.diff(j.x, prepend=0.0)
    total = np.zeros_like(j.x)
    for tau, share in zip(first * np.array([1.0, 3.0, 9.0]), (0.4, 0.35, 0.25), strict=True):
        force = 0.0
        branch = np.empty_like(j.x)
        for i in range(j.x.size):
            force = (force + moved[i]) / (1.0 + dt[i] / tau)
            branch[i] = force
        total += share * branch
    j.torque = j.torque + a * 0.2 * j.scale / j.base.reach * total


def _thermal(j: _Joint, a: float, rng: np.random.Generator) -> None:
    """Heat balance: losses in proportion to |torque · speed| against cooling by convection; the zero follows."""
    power = np.abs(j.torque * j.speed) / j.typical.power + 0.3
    tau = rng.uniform(0.2, 0.8) * j.typical.duration
    temperature = np.empty_like(j.x)
    t = 0.0
    dt = j.time[1] - j.time[0]
    for i in range(j.x.size):
        # Warm air rises faster: natural convection goes with the power 5/4 of the temperature.
        t += dt * (power[i] - t * max(t, 0.0) ** 0.25) / tau
        temperature[i] = t
    j.torque = j.torque + a * 0.1 * j.scale * temperature


def _softening(j: _Joint, a: float, rng: np.random.Generator) -> None:
    travel = np.cumsum(np.abs(np.diff(j.x, prepend=j.x[0])))
    constant = rng.uniform(0.1, 0.5) * j.typical.travel
    j.torque = j.torque * (1.0 - min(a * 0.2, 0.9) * travel / (constant + travel))


def _offset(j: _Joint, a: float, rng: np.random.Generator) -> None:
    j.torque = j.torque + a * 0.1 * j.scale * rng.choice([-1.0, 1.0])


def _gain(j: _Joint, a: float, rng: np.random.Generator) -> None:
    j.torque = j.torque * (1.0 + a * 0.1 * rng.choice([-1.0, 1.0]))


def _delay(j: _Joint, a: float, rng: np.random.Generator) -> None:
    late = a * 0.02
    spline = CubicSpline(j.time, j.torque)
    j.torque = spline(np.clip(j.time - late, j.time[0], None))


def _backlash(j: _Joint, a: float, rng: np.random.Generator) -> None:
    half = 0.5 * a * 0.05 * j.base.reach
    follower = np.empty_like(j.x)
    at = 0.0
    for i in range(j.x.size):
        if j.x[i] - at > half:
            at = j.x[i] - half
        elif at - j.x[i] > half:
            at = j.x[i] + half
        follower[i] = at
    j.torque = j.torque + j.base.real(follower) - j.base.real(j.x)


def _stop(j: _Joint, a: float, rng: np.random.Generator) -> None:
    sign = rng.choice([-1.0, 1.0])
    depth = np.maximum(sign * j.x - rng.uniform(0.7, 0.88) * (j.typical.up if sign > 0.0 else j.typical.down), 0.0)
    soft = 0.02 * j.base.reach
    j.torque = j.torque + sign * a * 5.0 * j.scale / j.base.reach * (np.sqrt(depth**2 + soft**2) - soft)


def _inertia(j: _Joint, a: float, rng: np.random.Generator) -> None:
    acceleration = CubicSpline(j.time, j.x)(j.time, 2)
    j.torque = j.torque + a * 0.1 * j.scale * acceleration / j.typical.acceleration


def _eccentric(j: _Joint, a: float, rng: np.random.Generator) -> None:
    n = rng.uniform(3.0, 9.0) * np.pi / j.base.reach / 2.0
    phase = rng.uniform(0.0, 6.28)
    error = np.sin(n * j.x + phase) + 0.1 * np.sin(2.0 * n * j.x)
    j.measured = j.measured + a * 0.02 * j.base.reach * error


def _deflection(j: _Joint, a: float, rng: np.random.Generator) -> None:
    j.measured = j.measured + a * 0.03 * j.base.reach * rng.choice([-1.0, 1.0])


def _asymmetry(j: _Joint, a: float, rng: np.random.Generator) -> None:
    side = rng.choice([-1.0, 1.0])
    # A rounded knee that leaves no offset on either side.
    soft = 0.015 * j.base.reach
    j.torque = j.torque + side * a * 0.2 * j.scale / j.base.reach * soft * np.logaddexp(0.0, side * j.x / soft)


def _saturation(j: _Joint, a: float, rng: np.random.Generator) -> None:
    # A larger size means a lower limit.
    limit = 1.5 * j.typical.most_torque / (1.0 + 0.25 * a)
    j.torque = j.torque / (1.0 + np.abs(j.torque / limit) ** 12) ** (1.0 / 12.0)


EFFECTS: dict[str, Callable[[_Joint, float, np.random.Generator], None]] = {
    "viscous_friction": _viscous,
    "coulomb_friction": _coulomb,
    "stribeck_friction": _stribeck,
    "load_dependent_friction": _load_friction,
    "stress_relaxation": _relaxation,
    "thermal_drift": _thermal,
    "cyclic_softening": _softening,
    "torque_offset": _offset,
    "torque_gain": _gain,
    "sensor_delay": _delay,
    "backlash": _backlash,
    "end_stop": _stop,
    "inertia": _inertia,
    "encoder_eccentricity": _eccentric,
    "deflection_offset": _deflection,
    "stiffness_asymmetry": _asymmetry,
    "torque_saturation": _saturation,
}
"""In the registry's ids."""


def _hum(j: _Joint, a: float, rng: np.random.Generator) -> None:
    j.torque = j.torque + a * 0.1 * j.scale * np.sin(
        2.0 * np.pi * rng.uniform(2.0, 6.0) * j.time + rng.uniform(0.0, 6.28)
    )


def _wandering(j: _Joint, a: float, rng: np.random.Generator) -> None:
    """A load that wanders at random (Ornstein-Uhlenbeck, 0.3 s)."""
    noise = rng.standard_normal(j.x.size)
    keep = np.exp(-(j.time[1] - j.time[0]) / 0.3)
    state, out = 0.0, np.empty_like(j.x)
    for i in range(j.x.size):
        state = keep * state + np.sqrt(1.0 - keep * keep) * noise[i]
        out[i] = state
    j.torque = j.torque + a * 0.1 * j.scale * out


def _jumps(j: _Joint, a: float, rng: np.random.Generator) -> None:
    """A sensor whose zero jumps."""
    edges = np.sort(rng.uniform(0.0, j.typical.duration, 9))
    levels = rng.standard_normal(10)
    j.torque = j.torque + a * 0.1 * j.scale * levels[np.searchsorted(edges, j.time)]


def _detent(j: _Joint, a: float, rng: np.random.Generator) -> None:
    """A friction bump at one place."""
    place = rng.uniform(-0.4, 0.4) * j.base.reach
    bump = np.exp(-(((j.x - place) / (0.06 * j.base.reach)) ** 2))
    j.torque = j.torque + a * 0.3 * j.scale * bump * _jenkins_sign(j.x, 0.01 * j.base.reach)


OUTSIDE: dict[str, Callable[[_Joint, float, np.random.Generator], None]] = {
    "hum": _hum, "wandering load": _wandering, "zero jumps": _jumps, "local friction": _detent,
}  # fmt: skip
"""Effects that no entry of the registry describes."""


SENSED = ("torque_gain", "torque_offset", "sensor_delay", "torque_saturation")
"""Effects of the torque sensor, which sees what all others made."""


class AnalyticJoint(Remade):
    """A joint of one of :data:`PLANTS`; its effects' parameters are chosen for the motion ``x`` and kept for others."""

    def __init__(
        self, plant: str, seed: int, base_error: float, motion: Callable[[float], tuple[Floats, Floats]]
    ) -> None:
        self._design = plant, seed, base_error
        self._seed = seed
        self.reach = self._base.reach
        # A Bouc-Wen simulator drifts under input noise (it breaks Drucker's postulate): it is given the clean motion.
        self.clean_input = self._base.clean_input
        time, x = motion(self.reach)
        self._typical = _Typical.of(time, x, self._base.real(x))

    @cached_property
    def _base(self) -> _Base:
        plant, seed, base_error = self._design
        return PLANTS[plant](np.random.default_rng([seed, 0]), base_error)

    def real(self, time: Floats, x: Floats, sizes: Mapping[str, float]) -> tuple[Floats, Floats]:
        """Measured deflection and torque, free of noise, with effects of the given sizes."""
        state = _Joint(time, x, self._base, self._typical, self._base.real(x), x.copy())
        known = {**EFFECTS, **OUTSIDE}
        order = list(known)
        for name in sorted(sizes, key=lambda n: (n in SENSED, order.index(n))):
            known[name](state, sizes[name], np.random.default_rng([self._seed, 2, order.index(name)]))
        return state.measured, state.torque

    def simulated(self, time: Floats, x: Floats) -> Floats:
        """The simulator's torque."""
        return self._base.simulated(x)


def plant_of(case: Case, seconds: float = 45.0, rate: float = 100.0) -> tuple[Plant, Floats, Floats]:
    """The case's plant, and the motion along which it is recorded."""

    def motion(reach: float) -> tuple[Floats, Floats]:
        return MOTIONS[case.motion](np.random.default_rng([case.seed, 1]), reach, seconds, rate)

    if case.plant == MUJOCO:
        from .mujoco_plant import MujocoJoint

        joint: Joint = MujocoJoint(case.seed, case.base_error, motion)
    elif case.plant == VARIED:
        joint = VariedJoint(case.seed, case.base_error, motion)
    else:
        joint = AnalyticJoint(case.plant, case.seed, case.base_error, motion)
    time, x = motion(joint.reach)
    return sized(joint, case.effects, case.ratio, time, x), time, x


def make(case: Case, seconds: float = 45.0, rate: float = 100.0) -> Made:
    """Make the recording of ``case``.

    The noise is fixed and each effect's size is found such that its own gap has ``ratio`` times the noise's RMS.
    """
    plant, time, x = plant_of(case, seconds, rate)
    return plant.record(time, x, np.random.default_rng([case.seed, 3]))
