"""A plant that MuJoCo simulates, from MuJoCo's own elements.

The joint is a shaft on a hinge whose angle is prescribed. Two models share the torque. In the *rig* hidden bodies move
by forward dynamics: slip elements (a spring tendon and a hinge with ``frictionloss``), Maxwell branches (a spring tendon
and a hinge with ``damping``), a loose shaft behind a limited tendon, a sprung flywheel. In the *link*, inverse dynamics
(``mj_inverse``) gives what the shaft itself needs: a pair of tendon springs, armature, damping, friction loss, a range.
The *sensor* is an actuator-force sensor with gain, bias, force range and delay. A geared disc whose centre is off its axis
is the encoder. The simulator is the base model with fewer slip elements.

MuJoCo has no element for Stribeck friction, friction by load, heat or wear; these are left out.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline, PchipInterpolator
from scipy.ndimage import uniform_filter1d

from .plant import Remade

__all__ = ["EFFECTS", "OUTSIDE", "MujocoJoint"]

Floats = NDArray[np.float64]
STEP, FINE_STEP = 1e-3, 4e-4
"""Longest time steps, s: as a rule, and where stiff stops are hit."""
SENSOR_STEP = 2.5e-4
HEAVY = 1e6
"""Inertia of a prescribed shaft, kg·m²: nothing that hangs on it moves it within a step."""
QUICK = 300.0
"""Natural frequency of a slip element's mass on its spring, rad/s."""
REAL_ELEMENTS, SIMULATED_ELEMENTS = 24, 20
LINK_INERTIA = 5e-4
FLANK, FLANK_DAMPING, GREASE = 800.0, 0.5, 0.01
"""Stiffness (N·m/rad) and damping (N·m·s/rad) of a loose shaft's stops, and damping between them."""
ARM, ANCHOR = 0.05, 0.12
"""Crank radius of the spring pair and distance of its anchors, m."""


@dataclass(frozen=True)
class _Design:
    """Everything that the models are built from; effects change it."""

    spring: float
    """Stiffness of each of the two tendon springs, N/m."""
    rest: float
    """Their rest length over their length in the middle."""
    stiffness: Floats
    """Of the slip elements, N·m/rad."""
    loss: Floats
    """Their friction loss, N·m."""
    branches: tuple[tuple[float, float], ...] = ()
    """Stiffness (N·m/rad) and damping (N·m·s/rad) of Maxwell branches."""
    clearance: float = 0.0
    resonator: tuple[float, float, float] | None = None
    """Inertia, stiffness and damping of a flywheel that hangs on the shaft by a spring."""
    inertia: float = 0.0
    damping: float = 0.0
    friction: tuple[float, float] = (0.0, 1.0)
    """Friction loss, and the speed (rad/s) at which it is fully there."""
    stop: tuple[float, float, float] | None = None
    """Side (±1), angle and stiffness of a range limit."""
    one_sided: tuple[float, float] = (1.0, 0.0)
    """Side and stiffness of a spring that is slack on the other side."""
    gain: float = 1.0
    bias: float = 0.0
    most: float = 1e9
    delay: float = 0.0
    encoder: tuple[float, float, float] = (1.0, 0.0, 0.0)
    """Gear ratio, eccentricity over radius, and phase (rad)."""
    zero: float = 0.0
    pushes: tuple[tuple[float, float, float], ...] = ()
    """Time (s), length (s) and torque of pushes from outside."""


# ---- the rig: what moves by itself ----------------------------------------------------------------------------------


def _rig_model(design: _Design, step: float) -> Any:
    bodies, tendons = [], []
    # Elements hang on the shaft itself, or behind the clearance on a second one.
    shaft = "loose" if design.clearance > 0.0 else "shaft"
    solver = f'solreffriction="{2.0 * step:.6g} 1" solimpfriction="0.9999 0.9999 0.001 0.5 2"'

    def body(name: str, joint: str, inertia: float, inner: str = "") -> str:
        # The sphere only satisfies the compiler: a moving body must have mass.
        sphere = '<geom type="sphere" size="0.001" mass="1e-6"/>'
        return f'<body name="{name}"><joint name="{name}" axis="0 0 1" armature="{inertia:.9g}" {joint}/>{sphere}{inner}</body>'

    def spring(name: str, of: str, stiffness: float, damping: float) -> str:
        return (
            f'<fixed name="{name}" stiffness="{stiffness:.9g}" damping="{damping:.9g}">'
            f'<joint joint="{of}" coef="1"/><joint joint="{name}" coef="-1"/></fixed>'
        )

    for k, (stiffness, loss) in enumerate(zip(design.stiffness, design.loss, strict=True)):
        bodies.append(body(f"slip{k}", f'frictionloss="{loss:.9g}" {solver}', stiffness / QUICK**2))
        tendons.append(spring(f"slip{k}", shaft, stiffness, 0.6 * stiffness / QUICK))
    for k, (stiffness, damping) in enumerate(design.branches):
        bodies.append(body(f"branch{k}", f'damping="{damping:.9g}"', stiffness / QUICK**2))
        tendons.append(spring(f"branch{k}", shaft, stiffness, 0.0))
    if design.resonator is not None:
        inertia, stiffness, damping = design.resonator
        bodies.append(body("wheel", "", inertia))
        tendons.append(spring("wheel", shaft, stiffness, damping))
    if design.clearance > 0.0:
        half = 0.5 * design.clearance
        bodies.append(body("loose", "", LINK_INERTIA, _crank()))
        tendons.append(
            f'<fixed name="coupling" damping="{GREASE}" limited="true" range="{-half:.9g} {half:.9g}" solimplimit="0.5 0.5 1e-3 0.5 2" '
            f'solreflimit="{-0.5 * FLANK / LINK_INERTIA:.9g} {-FLANK_DAMPING / LINK_INERTIA:.9g}">'
            '<joint joint="loose" coef="1"/><joint joint="shaft" coef="-1"/></fixed>'
        )
        tendons += _spring_pair(design)
    drive = body("shaft", "", HEAVY)
    # The bodies meet only in the shaft, which nothing moves: one by one (PGS) is exact, and a third faster than Newton.
    exact = 'integrator="implicitfast" solver="PGS" iterations="50" tolerance="1e-12"'
    return mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="{step:.9g}" gravity="0 0 0" {exact}><flag contact="disable" island="disable"/></option>'
        f"<worldbody>{_ANCHORS}{drive}{''.join(bodies)}</worldbody>"
        f"<tendon>{''.join(tendons)}</tendon></mujoco>"
    )


_ANCHORS = f'<site name="left" pos="-{ANCHOR} 0 0"/><site name="right" pos="{ANCHOR} 0 0"/>'


def _crank() -> str:
    return f'<site name="crank" pos="0 {ARM} 0"/>'


def _spring_pair(design: _Design) -> list[str]:
    length = float(np.hypot(ARM, ANCHOR))
    return [
        f'<spatial stiffness="{design.spring:.9g}" springlength="{design.rest * length:.9g}">'
        f'<site site="{anchor}"/><site site="crank"/></spatial>'
        for anchor in ("left", "right")
    ]


def _transmitted(design: _Design, step: float, x: Floats, speed: Floats) -> Floats:
    """Torque with which the hidden bodies load the shaft, at each step."""
    model = _rig_model(design, step)
    data = mujoco.MjData(model)
    advance = mujoco.mj_step
    angle, rate, passive, constraint = data.qpos, data.qvel, data.qfrc_passive, data.qfrc_constraint
    if design.clearance > 0.0:
        data.joint("loose").qpos[0], data.joint("loose").qvel[0] = x[0], speed[0]
    out = np.empty(x.size)
    for i, (at, pace) in enumerate(zip(x.tolist(), speed.tolist(), strict=True)):
        angle[0], rate[0] = at, pace
        advance(model, data)
        # Forces of the state before the step; the shaft is dof 0.
        out[i] = -passive[0] - constraint[0]
    return out


# ---- the link: what the prescribed shaft itself needs ---------------------------------------------------------------


def _link_model(design: _Design) -> Any:
    # Behind a clearance the shaft's own inertia is in the rig.
    inertia = (1e-9 if design.clearance > 0.0 else LINK_INERTIA) + design.inertia
    # In inverse dynamics a soft constraint of impedance d has the force J d/(1 − d) (acceleration + b speed + k depth),
    # J the inertia; with d = 1/2 that is J (…), b = 2 damping and k = 2 stiffness of a solref in its direct form.
    loss, width = design.friction
    joint = f'<joint name="shaft" axis="0 0 1" armature="{inertia:.9g}" damping="{design.damping:.9g}"'
    if loss > 0.0:
        joint += f' frictionloss="{loss:.9g}" solreffriction="0 {-0.5 * loss / (width * inertia):.9g}" solimpfriction="0.5 0.5 0.001 0.5 2"'
    if design.stop is not None:
        side, place, stiffness = design.stop
        low, high = (-9.0, place) if side > 0.0 else (-place, 9.0)
        joint += (
            f' limited="true" range="{low:.9g} {high:.9g}" solimplimit="0.5 0.5 0.001 0.5 2"'
            f' solreflimit="{-0.5 * stiffness / inertia:.9g} {-0.002 * stiffness / inertia:.9g}"'
        )
    tendons = [] if design.clearance > 0.0 else _spring_pair(design)
    side, stiffness = design.one_sided
    if stiffness > 0.0:
        tendons.append(
            f'<fixed stiffness="{stiffness:.9g}" springlength="-9 0"><joint joint="shaft" coef="{side:g}"/></fixed>'
        )
    return mujoco.MjModel.from_xml_string(
        '<mujoco><compiler angle="radian"/><option gravity="0 0 0"><flag contact="disable"/></option>'
        f'<worldbody>{_ANCHORS}<body>{joint}/><geom type="sphere" size="0.001" mass="1e-6"/>{_crank()}</body></worldbody>'
        f"<tendon>{''.join(tendons)}</tendon></mujoco>"
    )


def _needed(design: _Design, x: Floats, speed: Floats, acceleration: Floats) -> Floats:
    """Torque that the shaft itself needs, by inverse dynamics."""
    model = _link_model(design)
    data = mujoco.MjData(model)
    out = np.empty(x.size)
    for i in range(x.size):
        data.qpos[0], data.qvel[0], data.qacc[0] = x[i], speed[i], acceleration[i]
        mujoco.mj_inverse(model, data)
        out[i] = data.qfrc_inverse[0]
    return out


# ---- sensors --------------------------------------------------------------------------------------------------------


def _sensed(design: _Design, torque: Floats, interval: float) -> Floats:
    """Torque as the sensor tells it: an actuator's force with gain, bias, range and delay."""
    if (design.gain, design.bias, design.most, design.delay) == (1.0, 0.0, 1e9, 0.0):
        return torque
    # A delay is at least one time step.
    steps = int(np.ceil(interval / SENSOR_STEP)) if design.delay > 0.0 else 1
    step = interval / steps
    lag = f'delay="{design.delay:.9g}" nsample="{int(design.delay / step) + 4}" interp="cubic"' if steps > 1 else ""
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="{step:.9g}" gravity="0 0 0"/><worldbody><body><joint name="cell"/>'
        '<geom type="sphere" size="0.1"/></body></worldbody><actuator><general name="cell" joint="cell" biastype="affine" '
        f'gainprm="{design.gain:.9g}" biasprm="{design.bias:.9g}" forcelimited="true" forcerange="{-design.most:.9g} {design.most:.9g}"/>'
        f'</actuator><sensor><actuatorfrc actuator="cell" {lag}/></sensor></mujoco>'
    )
    data = mujoco.MjData(model)
    at = np.arange((torque.size - 1) * steps + 1) / steps
    fine = PchipInterpolator(np.arange(torque.size), torque)(at)
    out = np.empty(fine.size)
    for i, value in enumerate(fine.tolist()):
        data.ctrl[0] = value
        mujoco.mj_step(model, data)
        out[i] = data.sensordata[0]
    return out[::steps]


def _read_angle(design: _Design, x: Floats) -> Floats:
    """Angle as the encoder tells it: a geared disc, read about a point beside its axis, zero at home."""
    ratio, eccentricity, phase = design.encoder
    if eccentricity == 0.0:
        return x + design.zero
    model = mujoco.MjModel.from_xml_string(
        '<mujoco><worldbody><body><joint/><geom type="sphere" size="0.01"/><site name="mark" pos="1 0 0"/></body></worldbody></mujoco>'
    )
    data = mujoco.MjData(model)
    centre = eccentricity * np.array([np.cos(phase), np.sin(phase)])
    marks = np.empty((x.size + 1, 2))
    for i, angle in enumerate([0.0, *x.tolist()]):
        data.qpos[0] = ratio * angle
        mujoco.mj_kinematics(model, data)
        marks[i] = data.site_xpos[0, :2] - centre
    seen = np.unwrap(np.arctan2(marks[:, 1], marks[:, 0]))
    return (seen[1:] - seen[0]) / ratio + design.zero


# ---- effects --------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Typical:
    """Scales of the motion for which a joint was designed; they make its effects' parameters absolute."""

    reach: float
    torque: float
    most_torque: float
    speed: float
    acceleration: float
    up: float
    down: float
    duration: float


Effect = Callable[[_Design, float, _Typical, np.random.Generator], _Design]


def _viscous(d: _Design, a: float, t: _Typical, rng: np.random.Generator) -> _Design:
    return replace(d, damping=a * 0.1 * t.torque / t.speed)


def _coulomb(d: _Design, a: float, t: _Typical, rng: np.random.Generator) -> _Design:
    return replace(d, friction=(a * 0.1 * t.torque, rng.uniform(0.01, 0.05) * t.speed))


def _relaxation(d: _Design, a: float, t: _Typical, rng: np.random.Generator) -> _Design:
    stiffness, tau = a * 0.15 * t.torque / t.reach, rng.uniform(0.3, 1.5)
    return replace(d, branches=((0.6 * stiffness, 0.6 * stiffness * tau), (0.4 * stiffness, 1.6 * stiffness * tau)))


def _offset(d: _Design, a: float, t: _Typical, rng: np.random.Generator) -> _Design:
    return replace(d, bias=a * 0.1 * t.torque * rng.choice([-1.0, 1.0]))


def _gain(d: _Design, a: float, t: _Typical, rng: np.random.Generator) -> _Design:
    return replace(d, gain=1.0 + 0.1 * a * rng.choice([-1.0, 1.0]))


def _delay(d: _Design, a: float, t: _Typical, rng: np.random.Generator) -> _Design:
    return replace(d, delay=a * 0.02)


def _backlash(d: _Design, a: float, t: _Typical, rng: np.random.Generator) -> _Design:
    return replace(d, clearance=a * 0.05 * t.reach)


def _stop(d: _Design, a: float, t: _Typical, rng: np.random.Generator) -> _Design:
    side = float(rng.choice([-1.0, 1.0]))
    place = rng.uniform(0.7, 0.88) * (t.up if side > 0.0 else t.down)
    return replace(d, stop=(side, place, a * 5.0 * t.torque / t.reach))


def _inertia(d: _Design, a: float, t: _Typical, rng: np.random.Generator) -> _Design:
    return replace(d, inertia=a * 0.1 * t.torque / t.acceleration)


def _eccentric(d: _Design, a: float, t: _Typical, rng: np.random.Generator) -> _Design:
    ratio = rng.uniform(2.0, 5.0) * np.pi / (2.0 * t.reach)
    return replace(d, encoder=(ratio, min(a * 0.02 * t.reach * ratio, 0.9), rng.uniform(0.0, 6.28)))


def _deflection(d: _Design, a: float, t: _Typical, rng: np.random.Generator) -> _Design:
    return replace(d, zero=a * 0.03 * t.reach * rng.choice([-1.0, 1.0]))


def _asymmetry(d: _Design, a: float, t: _Typical, rng: np.random.Generator) -> _Design:
    return replace(d, one_sided=(float(rng.choice([-1.0, 1.0])), a * 0.2 * t.torque / t.reach))


def _saturation(d: _Design, a: float, t: _Typical, rng: np.random.Generator) -> _Design:
    # A larger size means a lower limit.
    return replace(d, most=t.most_torque / (1.0 + 0.25 * a))


EFFECTS: dict[str, Effect] = {
    "viscous_friction": _viscous,
    "coulomb_friction": _coulomb,
    "stress_relaxation": _relaxation,
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


def _resonator(d: _Design, a: float, t: _Typical, rng: np.random.Generator) -> _Design:
    """A flywheel on a spring, hardly damped: something loose that swings."""
    inertia, natural = a * 0.02 * t.torque / t.acceleration, 2.0 * np.pi * rng.uniform(0.6, 1.2)
    return replace(d, resonator=(inertia, inertia * natural**2, 0.06 * inertia * natural))


def _pushes(d: _Design, a: float, t: _Typical, rng: np.random.Generator) -> _Design:
    """Somebody leans on the joint now and then."""
    count = 12
    at, long, sign = rng.uniform(0.0, t.duration, count), rng.uniform(0.3, 2.0, count), rng.choice([-1.0, 1.0], count)
    size = a * 0.2 * t.torque * rng.uniform(0.5, 1.0, count) * sign
    return replace(d, pushes=tuple(zip(at.tolist(), long.tolist(), size.tolist(), strict=True)))


OUTSIDE: dict[str, Effect] = {"resonator": _resonator, "pushes": _pushes}
"""Effects that no entry of the registry describes."""


# ---- the joint ------------------------------------------------------------------------------------------------------


def _elements(force: float, reach: float, count: int, middle: float) -> tuple[Floats, Floats]:
    """Stiffness and friction loss of slip elements whose yield deflections are spread evenly in logarithm."""
    yields = np.geomspace(0.012 * reach, 0.7 * reach, count)
    weight = (yields / (middle * reach)) ** 0.7 * np.exp(-yields / (middle * reach))
    loss = force * weight / weight.sum()
    return loss / yields, loss


class MujocoJoint(Remade):
    """One random design; its effects' parameters are chosen for the motion ``motion(reach)`` and kept for others."""

    clean_input = True

    def __init__(self, seed: int, base_error: float, motion: Callable[[float], tuple[Floats, Floats]]) -> None:
        rng = np.random.default_rng([seed, 0])
        self.reach = float(rng.uniform(0.6, 1.1))
        spring, rest = rng.uniform(300.0, 700.0), rng.uniform(0.5, 0.9)
        force, middle = rng.uniform(0.4, 1.0), rng.uniform(0.1, 0.25)
        off = 1.0 + base_error * rng.standard_normal(4 + SIMULATED_ELEMENTS)
        self._base = _Design(spring, rest, *_elements(force, self.reach, REAL_ELEMENTS, middle))
        stiffness, loss = _elements(force * off[2], self.reach, SIMULATED_ELEMENTS, middle)
        self._simulator = _Design(spring * off[0], rest * off[1], stiffness * off[3], loss * off[4:])
        self._seed = seed
        time, x = motion(self.reach)
        torque = self._torque(self._base, time, x)
        course = CubicSpline(time, x)
        self._typical = _Typical(
            self.reach, float(np.std(torque)), float(np.max(np.abs(torque))), float(np.std(course(time, 1))),
            float(np.std(course(time, 2))), float(np.max(x)), float(-np.min(x)), float(time[-1]),
        )  # fmt: skip

    @cached_property
    def _kept(self) -> dict[Any, Floats]:
        return {}

    def real(self, time: Floats, x: Floats, sizes: Mapping[str, float]) -> tuple[Floats, Floats]:
        """Measured deflection and torque, free of noise, with effects of the given sizes."""
        known = {**EFFECTS, **OUTSIDE}
        order = list(known)
        design = self._base
        for name, size in sizes.items():
            rng = np.random.default_rng([self._seed, 2, order.index(name)])
            design = known[name](design, size, self._typical, rng)
        return _read_angle(design, x), self._torque(design, time, x)

    def simulated(self, time: Floats, x: Floats) -> Floats:
        """The simulator's torque."""
        return self._torque(self._simulator, time, x)

    def _torque(self, design: _Design, time: Floats, x: Floats) -> Floats:
        interval = float(time[1] - time[0])
        course = CubicSpline(time, x)
        moved = self._rig(design, time, x, course, interval)
        torque = moved + _needed(design, x, course(time, 1), course(time, 2))
        for at, length, size in design.pushes:
            torque -= size * np.sin(np.pi * np.clip((time - at) / length, 0.0, 1.0))
        return _sensed(design, torque, interval)

    def _rig(self, design: _Design, time: Floats, x: Floats, course: CubicSpline, interval: float) -> Floats:
        """The rig's torque at each sample; kept, because most effects leave the rig as it is."""
        key = (
            design.stiffness.tobytes(), design.loss.tobytes(), design.branches, design.clearance, design.resonator,
            interval, x.tobytes(),
        )  # fmt: skip
        if key not in self._kept:
            steps = int(np.ceil(interval / (FINE_STEP if design.clearance > 0.0 else STEP) - 1e-9))
            fine = time[0] + interval / steps * np.arange((x.size - 1) * steps + 1)
            torque = _transmitted(design, interval / steps, course(fine), course(fine, 1))
            # The converter integrates over a sampling interval, as good ones do.
            self._kept[key] = uniform_filter1d(torque, 2 * (steps // 2) + 1, mode="nearest")[::steps]
        return self._kept[key]
