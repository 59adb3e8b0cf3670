"""Lost motion in the drive."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import ClassVar

import numpy as np
from scipy.optimize import root

from ..operators.masses import free_flight
from ..operators.memory import plays
from ..recording.noise import rms
from .base import INPUT, Columns, Effect, Floats, Form, Parameter, Scene, geometric
from .parts import SETTLED_AT_HOME, settled_at_home

__all__ = ["Backlash"]

ROUNDS, MIXED, SETTLED = 6, 3, 1e-3
"""Steps at most to where the joint lies within a clearance, of how many before each is made, and what is left of one, over the
clearance's half, where it is there."""
NEAR, MOVING, STEEP = 0.3, 1e-4, 0.9
"""Torque (over its standard deviation) that is near zero, way between samples (over the stroke) that is motion, and the
quantile of the slopes there that the steps rest on: too steep only makes them shorter."""
AT_FLANK = 1e-6
"""Distance from a flank, over the clearance's half, that is contact."""
OF_SPRING, IN_SPRING = "of the spring", "in the elastic part alone"
OF_FRICTION, IN_FRICTION = "of the friction", "in the part with memory alone"
FLANKS = np.linspace(-1.0, 1.0, 7)
BEHIND = "x = x - g in all that does not follow speed or acceleration alone,  "
IN_SERIES = (
    BEHIND + "g where that adds up to y = 0 if it is within ±clearance / 2, else at the flank to which it presses"
)
SOFTLY = BEHIND + "g = clearance / 2 * tanh(y / flank_torque) where that adds up to y"
TAKEN = (
    "(hypot({x} + clearance / 2, rounding * clearance / 2) - hypot({x} - clearance / 2, rounding * clearance / 2)) / 2"
)
ROUNDED = f"x = x - {TAKEN}"
ROUNDINGS = (0.02, 2.0)
"""Of flanks, over half of the gap."""
IN_FLIGHT = (
    "x = x - g,  g at the flank ±clearance / 2 to which y presses it, without what follows speed or acceleration alone; where "
    "that passes zero the load flies across, swinging at load_frequency from its speed there: no torque until it hits, then "
    "load_inertia times its change of speed"
)
"""Equations of a clearance in series with the joint, of hard and of soft flanks, and of a load that has inertia."""


def _play(scene: Scene, shape: tuple[float, ...]) -> Floats:
    s = scene.signals
    width = np.array([0.5 * shape[0]])
    return s.per_run(lambda run: plays(s.x[run], width)[:, 0])


def _play_about(flank: float) -> Columns:
    # The joint was zeroed while it was pressed to one flank.
    return lambda scene, shape: _play(scene, shape) + flank * 0.5 * shape[0]


def _soft_play(scene: Scene, shape: tuple[float, ...]) -> Floats:
    # Flanks that yield: teeth or wires that meet one after the other.
    s, (width, softness) = scene.signals, shape
    halves = 0.5 * width * (1.0 + softness * FLANKS)
    return s.per_run(lambda run: plays(s.x[run], halves).mean(axis=1))


def _gap(scene: Scene, shape: tuple[float, ...]) -> Floats:
    x, half = scene.signals.x, 0.5 * shape[0]
    return x - np.clip(x, -half, half)


def _pressed_alone(scene: Scene, shape: tuple[float, ...]) -> Floats:
    """What a gap about zero adds whose flanks, as a strap's or a jaw's, press and do not pull, N·m, shape (n, 1)."""
    behind = _gap(scene, shape)
    side = np.sign(behind)
    return (side * np.maximum(side * (scene.torque + scene.torque_change(behind)), 0.0) - scene.torque)[:, None]


def _gap_elsewhere(scene: Scene, shape: tuple[float, ...]) -> Floats:
    x, half, middle = scene.signals.x, 0.5 * shape[0], shape[1]
    # The joint was zeroed where it lay at rest.
    return x - (np.clip(x - middle, -half, half) - np.clip(-middle, -half, half))


def _gap_about(scene: Scene, shape: tuple[float, ...]) -> Floats:
    # It was zeroed at the flank that the gap's middle leaves it at.
    x, half, middle = scene.signals.x, 0.5 * shape[0], shape[1]
    return x - np.clip(x - middle, -half, half)


def _middles(width: float) -> list[float]:
    """Places for a gap of a width, both as shares of the reach: a narrow one is found only near its own place."""
    step = max(0.8 * width, 0.03)
    return (step * np.arange(0.5, 0.4 / step)).tolist()


def _soft_gap(scene: Scene, shape: tuple[float, ...]) -> Floats:
    # The flanks are met gradually: tanh instead of clip.
    x, half = scene.signals.x, 0.5 * shape[0]
    return x - half * np.tanh(x / half)


def _rounded(x: Floats, half: float, rounding: float) -> Floats:
    """What a gap about zero takes, rad, its flanks rounded over ``rounding`` of its half."""
    return np.asarray(0.5 * (np.hypot(x + half, rounding * half) - np.hypot(x - half, rounding * half)))


def _rounded_gap(scene: Scene, shape: tuple[float, ...]) -> Floats:
    clearance, rounding = shape
    return _rounded_gap_about(scene, (clearance, 0.0, rounding))


def _rounded_gap_about(scene: Scene, shape: tuple[float, ...]) -> Floats:
    x, half, (middle, rounding) = scene.signals.x, 0.5 * shape[0], shape[1:]
    return x - _rounded(x - middle, half, rounding)


def _rounded_gap_elsewhere(scene: Scene, shape: tuple[float, ...]) -> Floats:
    half, (middle, rounding) = 0.5 * shape[0], shape[1:]
    return _rounded_gap_about(scene, shape) + _rounded(np.array(-middle), half, rounding)


def _before(behind: Columns) -> Columns:
    """What a clearance before the whole joint adds, with the deflection ``behind`` it."""
    return lambda scene, shape: scene.torque_change(behind(scene, shape))[:, None]


def _before_the_spring(behind: Columns) -> Columns:
    """Bearings and seals rub before the clearance, only the spring lies behind it."""
    return lambda scene, shape: scene.spring_change(behind(scene, shape))[:, None]


def _settled_before(behind: Columns, at_rest: Columns) -> Columns:
    """The spring knows where the flanks are, friction only how it moved since it lay ``at_rest``."""
    return lambda scene, shape: settled_at_home(scene, behind(scene, shape), at_rest(scene, shape))[:, None]


def _before_the_friction(behind: Columns) -> Columns:
    """A brake's pads or a damper's bushing have play, the spring has none."""

    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        x = behind(scene, shape)
        return (scene.held_at(x) - _held(scene) - scene.spring_change(x))[:, None]

    return columns


def _across(scene: Scene, width: float) -> Floats:
    """Position within a clearance in series with the joint, rad, shape (n,): several laws of one width ask for it."""
    return scene.remembered(("across", width), lambda: _crossed(scene, 0.5 * width))


def _crossed(scene: Scene, half: float) -> Floats:
    """Position within a clearance of ±``half`` in series with the joint, rad, shape (n,).

    Loaded, it lies at the flank that the torque presses it to; where the torque is nil the joint stands still and the
    motion carries it across. So the joint's deflection is the one without torque, as near as the flanks let it come.
    Damping and mass are the drive's: a joint that had them would leave its place slowly, and here it would be thrown from
    one to the next.
    """
    x, stiffness = scene.signals.smooth_x, _slope(scene, half)

    def step(joint: Floats, torque: Floats) -> Floats:
        return np.clip(joint - torque / stiffness, x - half, x + half) - joint

    return _settled(scene, half, step)


def _pressed(scene: Scene, half: float, soft: float) -> Floats:
    """Position within a clearance of ±``half`` in series with the joint whose flanks yield over a torque of ``soft``, rad."""
    x, stiffness = scene.signals.smooth_x, _slope(scene, half)

    def step(joint: Floats, torque: Floats) -> Floats:
        pressure = np.tanh(torque / soft)
        return (x - half * pressure - joint) / (1.0 + half * stiffness / soft * (1.0 - pressure**2))

    return _settled(scene, half, step)


def _settled(scene: Scene, half: float, step: Callable[[Floats, Floats], Floats]) -> Floats:
    """Position within ±``half`` where a ``step`` (n,), made of the joint's deflection and its torque, leads nowhere, rad, shape (n,).

    The steps are Newton's, of all samples at once with one stiffness. Friction makes a joint stiffer where it turns, and what
    it was before a turn matters: mixed with those before they find their way (Anderson, J. ACM 12, 1965, 547-560).
    """
    x = scene.signals.smooth_x
    noise = scene.signals.x - x

    def further(joint: Floats) -> Floats:
        return step(joint, scene.held_at(joint + noise))

    found = root(
        further, x + step(x, _held(scene)), method="anderson",
        options={
            "maxiter": ROUNDS, "fatol": SETTLED * half, "tol_norm": rms, "line_search": None,
            "jac_options": {"alpha": 1.0, "M": MIXED},
        },
    )  # fmt: skip
    return x - np.clip(found.x, x - half, x + half)


def _by_the_torque(scene: Scene, shape: tuple[float, ...]) -> Floats:
    # All of the torque, its mass's and damper's too, tells the flank, as it would be without a clearance.
    return scene.signals.x - 0.5 * shape[0] * np.tanh(scene.torque / shape[1])


def _slope(scene: Scene, half: float) -> float:
    """The slope on which the steps rest, N·m/rad."""
    return _stiffness(scene) or _probed(scene, half)


def _held(scene: Scene) -> Floats:
    """Torque of what would lie behind a clearance, N·m, shape (n,)."""
    return scene.remembered("held", lambda: scene.held_at(scene.signals.x))


def _stiffness(scene: Scene) -> float:
    """How steeply that torque passes zero, N·m/rad; 0 where it does not."""

    def made() -> Floats:
        x, torque = scene.signals.smooth_x, _held(scene)
        way, change = np.abs(np.diff(x)), np.abs(np.diff(torque))
        passing = (np.abs(torque[1:]) < NEAR * np.std(torque)) & (way > MOVING * np.ptp(x))
        return np.quantile(change[passing] / way[passing], [STEEP]) if np.any(passing) else np.zeros(1)

    return float(scene.remembered("held, its stiffness", made)[0])


def _probed(scene: Scene, half: float) -> float:
    """The same from the torque at either flank."""
    x = scene.signals.x
    across = np.abs(scene.held_at(x + half) - scene.held_at(x - half))
    return max(float(np.max(across)) / (2.0 * half), 1e-300)


def _series(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return _loosened(scene, _across(scene, shape[0]))[:, None]


def _loosened(scene: Scene, across: Floats) -> Floats:
    """Change of the simulator's output for a position within the clearance, N·m; what drags is felt as before."""
    felt = _held(scene)
    return scene.held_at(scene.signals.x - across) - felt


def _soft_series(scene: Scene, shape: tuple[float, ...]) -> Floats:
    width, soft = shape
    return _loosened(scene, scene.remembered(("pressed", shape), lambda: _pressed(scene, 0.5 * width, soft)))[:, None]


def _flight(scene: Scene, shape: tuple[float, ...]) -> Floats:
    s, half, frequency = scene.signals, 0.5 * shape[0], shape[1]
    settled = _across(scene, shape[0])
    # Pressed to a flank, or, where a load without inertia would be between them, to none.
    pressed = np.sign(settled) * (np.abs(settled) >= (1.0 - AT_FLANK) * half)
    flown = [free_flight(s.time[run], s.smooth_x[run], s.speed[run], pressed[run], half, frequency) for run in s.runs]
    across, free, hit = (np.concatenate(parts) for parts in zip(*flown, strict=True))
    # A load that flies has the simulator's mass and damping with it.
    change = scene.torque_change(s.x - across)
    # Nothing loads the drive while the load flies.
    return np.column_stack([np.where(free > 0.0, -scene.torque, change), hit])


def _either(
    name: str, behind: Columns, shapes: Sequence[str], grid: Sequence[tuple[float, ...]], limits: Sequence[tuple[float, float]],
    equation: str, simpler: str = "", start: Callable[[tuple[float, ...], Floats], tuple[float, ...]] | None = None,
) -> list[Form]:  # fmt: skip
    """A clearance before the whole joint, and the same before its spring alone."""
    whole = Form(
        name, ("_unit",), _before(behind), (1.0,), (1.0,), shapes, grid, limits, (simpler,) if simpler else (), start,
        equation=equation,
    )  # fmt: skip
    return [
        whole,
        replace(
            whole, name=f"{name}, {OF_SPRING}", columns=_before_the_spring(behind), equation=f"{equation}, {IN_SPRING}",
            refines=(f"{simpler}, {OF_SPRING}",) if simpler else (),
        ),
    ]  # fmt: skip


class Backlash(Effect):
    """Clearance: after a turn the input moves a way before the load follows."""

    id: ClassVar[str] = "backlash"
    title: ClassVar[str] = "backlash"
    summary: ClassVar[str] = (
        "clearance that must be crossed after a turn, or around zero torque, before torque builds up"
    )
    equation: ClassVar[str] = (
        "x → play(x; b/2), ± b/2 where it was zeroed at a flank, or the mean of plays from b/2 (1 − c) to b/2 (1 + c), x → x − clip(x − m, ±b/2), + clip(−m, ±b/2) if zeroed there or without torque that pulls, "
        "x → x − b/2 tanh(2x/b), each also in the elastic part of y_sim alone (the first in its friction), or x → x − g, g across ±b/2 where y passes "
        "zero (at once, as b/2 tanh(y/f), there or where y was without it, or a load of inertia J that swings across and hits)"
    )
    coordinate: ClassVar[str] = "distance_since_reversal"
    acts_on: ClassVar[str] = INPUT
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("clearance", "rad", 0.0, np.inf, "total width b"),
        Parameter("softness", "1", 0.0, 1.0, "c, spread of the clearance over its width, of flanks that yield"),
        Parameter("rounding", "1", *ROUNDINGS, "of the flanks of a gap, over b/2"),
        Parameter("flank_torque", "N·m", 0.0, np.inf, "f, over which flanks yield to which the torque presses"),
        Parameter("middle", "rad", -np.inf, np.inf, "m, deflection in the middle of the gap"),
        Parameter("load_inertia", "kg·m²", 0.0, np.inf, "J, of a load that hits the flanks"),
        Parameter("load_frequency", "rad/s", 0.0, np.inf, "at which that load swings between them"),
    )
    confused_with: ClassVar[tuple[str, ...]] = ("coulomb_friction", "sensor_delay", "miscalibration")

    def forms(self, scene: Scene) -> list[Form]:
        reach = scene.signals.reach
        grid = [(b,) for b in geometric(0.0015 * reach, 0.5 * reach, 13)]
        few = grid[4::2]
        limits = [(5e-4 * reach, reach)]
        x = scene.signals.smooth_x
        amid, far = 0.5 * float(x.max() + x.min()), 0.5 * float(np.ptp(x))
        elsewhere = [*limits, (amid - 0.6 * far, amid + 0.6 * far)]
        at = "x = x - clip(x - middle, -clearance / 2, clearance / 2) + clip(-middle, -clearance / 2, clearance / 2)"
        strong = float(np.std(scene.torque))
        return [
            *_either("lost motion at turns", _play, ("clearance",), grid, limits, "x = play(x, clearance / 2)"),
            *(
                form
                for flank, sign, told in ((1.0, "+", "upper"), (-1.0, "-", "lower"))
                for form in _either(
                    f"lost motion at turns, zeroed at the {told} flank", _play_about(flank), ("clearance",), (), limits,
                    f"x = play(x, clearance / 2) {sign} clearance / 2", "lost motion at turns",
                )
            ),
            *(
                Form(f"lost motion at turns, zeroed at the {told} flank, {SETTLED_AT_HOME}", ("_unit",),
                     _settled_before(_play_about(flank), _play), (1.0,), (1.0,), ("clearance",), (), limits,
                     ("lost motion at turns", f"lost motion at turns, zeroed at the {told} flank, {OF_SPRING}"),
                     equation=f"x = play(x, clearance / 2), and {sign}clearance / 2 more in the elastic part")
                for flank, sign, told in ((1.0, "", "upper"), (-1.0, "-", "lower"))
            ),
            Form(f"lost motion at turns, {OF_FRICTION}", ("_unit",), _before_the_friction(_play), (1.0,), (1.0,), ("clearance",),
                 (), limits, ("lost motion at turns",), equation=f"x = play(x, clearance / 2), {IN_FRICTION}"),
            *_either("lost motion at turns, soft flanks", _soft_play, ("clearance", "softness"), (), [*limits, (0.05, 1.0)],
                     "x = plays(x, clearance / 2 * (1 - softness), clearance / 2 * (1 + softness))",
                     "lost motion at turns", lambda shape, coefficients: (shape[0], 0.5)),
            *_either("gap around zero", _gap, ("clearance",), grid[2::2], limits,
                     "x = x - clip(x, -clearance / 2, clearance / 2)"),
            Form("gap around zero, flanks that only press", ("_unit",), _pressed_alone, (1.0,), (1.0,), ("clearance",), (), limits,
                 ("gap around zero", "gap at zero torque"),
                 equation="x = x - clip(x, -clearance / 2, clearance / 2),  y = sign(x) * maximum(sign(x) * y, 0)"),
            Form("gap elsewhere", ("_unit",), _before(_gap_elsewhere), (1.0,), (1.0,), ("clearance", "middle"),
                 [(b * far, amid + side * m * far) for b in (0.02, 0.05, 0.12, 0.3) for m in _middles(b) for side in (-1.0, 1.0)],
                 elsewhere, equation=at),
            Form(f"gap elsewhere, {OF_SPRING}", ("_unit",), _before_the_spring(_gap_elsewhere), (1.0,), (1.0,),
                 ("clearance", "middle"), (), elsewhere, (f"gap around zero, {OF_SPRING}", "gap elsewhere"),
                 lambda shape, coefficients: (*shape, 0.0)[:2], equation=f"{at}, {IN_SPRING}"),
            *(
                Form(f"gap elsewhere, zeroed at a flank{told}", ("_unit",), before(_gap_about), (1.0,), (1.0,),
                     ("clearance", "middle"), (), elsewhere, (f"gap elsewhere{told}", f"gap around zero{told}"),
                     lambda shape, coefficients: (*shape, 0.0)[:2],
                     equation="x = x - clip(x - middle, -clearance / 2, clearance / 2)" + inside)
                for told, before, inside in (("", _before, ""), (f", {OF_SPRING}", _before_the_spring, f", {IN_SPRING}"))
            ),
            Form(f"gap elsewhere, {SETTLED_AT_HOME}", ("_unit",), _settled_before(_gap_about, _gap_elsewhere), (1.0,), (1.0,),
                 ("clearance", "middle"), (), elsewhere, ("gap elsewhere", f"gap elsewhere, zeroed at a flank, {OF_SPRING}"),
                 equation=f"{at}, and -clip(-middle, -clearance / 2, clearance / 2) more in the elastic part"),
            *_either("soft gap", _soft_gap, ("clearance",), (), limits, "x = x - clearance / 2 * tanh(2 * x / clearance)",
                     "gap around zero"),
            Form("gap around zero, rounded", ("_unit",), _before(_rounded_gap), (1.0,), (1.0,), ("clearance", "rounding"), (),
                 [*limits, ROUNDINGS], ("gap around zero", "soft gap"), lambda shape, coefficients: (shape[0], 0.2),
                 equation=ROUNDED.format(x="x")),
            *(
                Form(f"{name}, rounded", ("_unit",), _before(behind), (1.0,), (1.0,), ("clearance", "middle", "rounding"), (),
                     [*elsewhere, ROUNDINGS], (name,), lambda shape, coefficients: (*shape, 0.2),
                     equation=ROUNDED.format(x="(x - middle)") + back)
                for name, behind, back in (
                    ("gap elsewhere", _rounded_gap_elsewhere, f" + {TAKEN.format(x='(-middle)')}"),
                    ("gap elsewhere, zeroed at a flank", _rounded_gap_about, ""),
                )
            ),
            Form("gap at zero torque", ("_unit",), _series, (1.0,), (1.0,), ("clearance",), few, limits, equation=IN_SERIES),
            Form("gap at zero torque, soft flanks", ("_unit",), _soft_series, (1.0,), (1.0,), ("clearance", "flank_torque"), (),
                 [*limits, (0.01 * strong, strong)], ("gap at zero torque",), lambda shape, coefficients: (shape[0], 0.1 * strong),
                 equation=SOFTLY),
            Form("gap where all the torque was zero before", ("_unit",), _before(_by_the_torque), (1.0,), (1.0,), ("clearance", "flank_torque"),
                 [(b, 0.1 * strong) for (b,) in few], [*limits, (0.003 * strong, strong)],
                 equation="x = x - clearance / 2 * tanh(y / flank_torque)"),
            Form("gap at zero torque, free flight", ("_unit", "load_inertia"), _flight, (1.0, 0.0), (1.0, np.inf),
                 ("clearance", "load_frequency"), [(b, w) for (b,) in grid[3:11:2] for w in (40.0, 120.0, 400.0)],
                 [*limits, (10.0, 3000.0)], equation=IN_FLIGHT),
        ]  # fmt: skip
