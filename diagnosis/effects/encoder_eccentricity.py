"""A deflection sensor with a periodic error."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from typing import ClassVar

import numpy as np
from scipy.signal import find_peaks

from .base import INPUT, LOW, NOT, Columns, Effect, Floats, Form, Outsider, Parameter, Scene, geometric
from .images import is_one_sided_stiffness
from .parts import SETTLED_AT_HOME, settled_at_home

__all__ = ["EncoderEccentricity"]

SIZES = ("error_sin", "error_cos", "error_sin_2", "error_cos_2")
MOSTLY_OFFSET = 5.0
"""Mean of the error over its deviation, from which it is no eccentricity."""
SMALL = 1e-3
"""Error over the reach at which the answer of the simulator is linear in it."""
ONCE = (0.4, 0.65)
"""Waves within the stroke of an error that comes once a turn at which it is looked for as such: of longer ones little is seen, and
shorter ones need not be known to come once."""
TOLD = 0.8
"""What an error of the spring alone must leave of what a torque that waves with the place leaves of the gap's energy: on a linear
spring both are the same, and of five such errors that were named on strangers' joints none was an encoder's."""
DETENTS = np.linspace(-0.25, 0.25, 5)
"""Where waves of a torque are looked for: by how many more within the stroke than those of an encoder's error."""
FINE, ENOUGH = 3, 4000
"""How many of the periods that are too short to try them all are tried, and of how many samples they are chosen."""
OF_SPRING = "sine, of the spring"
ZEROED = "zero at home"
"""How laws are called by which the encoder's error is zero there; by others only the friction is, which has settled."""


def _error(sizes: Sequence[float], angle: Floats) -> tuple[Floats, Floats]:
    """The periodic error and its derivative by the angle (n,), for sine and cosine of each harmonic in turn in ``sizes``."""
    sine, cosine = np.sin(angle), np.cos(angle)
    error, steepness = np.zeros_like(angle), np.zeros_like(angle)
    sine_k, cosine_k = sine, cosine
    for k, (p, q) in enumerate(zip(sizes[::2], sizes[1::2], strict=True), start=1):
        if k > 1:
            sine_k, cosine_k = sine_k * cosine + cosine_k * sine, cosine_k * cosine - sine_k * sine
        error += p * sine_k + q * cosine_k
        steepness += k * (p * cosine_k - q * sine_k)
    return error, steepness


def _by_waves(change: Callable[[Floats], Floats], scene: Scene, angle: float) -> Floats:
    """What ``change`` makes of sine and cosine of so many times the deflection in its reading, over their size, N·m/rad, shape (n, 2)."""
    x, small = scene.signals.x, SMALL * scene.signals.reach
    return np.column_stack([change(x + small * wave) / small for wave in (np.sin(angle * x), np.cos(angle * x))])


def _waves(scene: Scene, angle: float) -> Floats:
    """That of the whole torque. The laws differ in what is zero at home, and ask for the same waves."""
    return scene.remembered(("waves", angle), lambda: _by_waves(scene.torque_change, scene, angle))


def _shift(scene: Scene, home: str) -> Floats | float:
    """What an offset of the reading adds that makes up for the cosine at home, over its size, N·m/rad, shape (n,)."""
    if not home:
        return 0.0
    x, small = scene.signals.x, SMALL * scene.signals.reach
    shift = scene.remembered("shift", lambda: scene.torque_change(x - small) / small)
    return shift + scene.spring_change(x + small) / small if home == SETTLED_AT_HOME else shift


def _columns(harmonics: int, home: str = "") -> Columns:
    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        made = np.hstack([_waves(scene, k * shape[0]) for k in range(1, harmonics + 1)])
        made[:, 1::2] += np.reshape(_shift(scene, home), (-1, 1))
        return made

    return columns


def _of_spring(scene: Scene, shape: tuple[float, ...]) -> Floats:
    """Bearings turn by what the joint turns; only the spring is where the sensor says."""
    return _by_waves(scene.spring_change, scene, shape[0])


def _fine(scene: Scene, low: float, high: float) -> list[float]:
    """The likeliest of many periods, from ``low`` to ``high``, by waves of the torque with the place and of its slope.

    A start must be within half a wave over the stroke: of waves this short that would be many to carry through the simulator.
    """
    signals = scene.signals
    rows = np.flatnonzero(signals.judged)
    rows = rows[:: 1 + rows.size // ENOUGH]
    x, small = signals.x, SMALL * signals.reach
    slope = np.reshape(scene.torque_change(x + small) / small, (-1, 1))[rows]
    angles = np.arange(low, high, 0.25 * np.pi / signals.reach)
    closed = []
    for n in angles:
        waves = np.column_stack([np.sin(n * x[rows]), np.cos(n * x[rows])])
        columns = np.hstack([waves, slope * waves])
        moment = columns.T @ signals.gap[rows]
        closed.append(moment @ np.linalg.lstsq(columns.T @ columns, moment, rcond=1e-10)[0])
    peaks = find_peaks(np.concatenate([[0.0], closed, [0.0]]))[0] - 1
    return [float(angles[k]) for k in sorted(peaks, key=lambda k: -closed[k])[:FINE]]


def _is_told_from_detents(scene: Scene, angles: Sequence[float]) -> bool:
    """Whether waves of the spring alone close the gap clearly better than waves of the torque with the place would."""
    signals = scene.signals
    x, rows = signals.x, signals.judged
    gap = signals.gap[rows]

    def left(columns: Floats) -> float:
        seen = columns[rows]
        return float(np.sum(np.square(gap - seen @ np.linalg.lstsq(seen, gap, rcond=1e-10)[0])))

    of_spring = min(left(_of_spring(scene, (n,))) for n in angles)
    of_place = min(left(np.column_stack([np.sin(n * x), np.cos(n * x) - 1.0])) for n in angles)
    return of_spring < TOLD * of_place


def _detents(harmonics: int) -> Columns:
    """A torque that waves with the place, and its mean."""

    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        x = scene.signals.smooth_x
        angles = [k * shape[0] * x for k in range(1, harmonics + 1)]
        return np.column_stack([wave(angle) for angle in angles for wave in (np.sin, np.cos)] + [np.ones_like(x)])

    return columns


def _of_true_angle(home: str = "") -> Columns:
    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        periods, sizes = shape[0], shape[1:]
        x = scene.signals.x
        true = x
        at_home = sum(sizes[1::2]) if home else 0.0
        # Newton's steps for z = x + p sin(N z) + q cos(N z) + …; the slope is kept from making them leap.
        for _ in range(3):
            error, steepness = _error(sizes, periods * true)
            true = true - (true - x - error + at_home) / np.maximum(1.0 - periods * steepness, 0.3)
        if home == SETTLED_AT_HOME:
            return settled_at_home(scene, true + at_home, true)[:, None]
        return scene.torque_change(true)[:, None]

    return columns


def _once_a_turn(law: Columns) -> Columns:
    """A law whose first shape is how many periods a turn has, of one."""
    return lambda scene, shape: law(scene, (1.0, *shape))


def _equation(harmonics: int, home: str, of: str = "x") -> str:
    """The equation of a periodic error of the measured angle x or of the true one, z."""

    def wave(number: str, times: str) -> str:
        cosine = f"cos({times}periods * {of})"
        cosine = f"({cosine} - 1)" if home else cosine
        return f"error_sin{number} * sin({times}periods * {of}) + error_cos{number} * {cosine}"

    waves = [wave("", ""), wave("_2", "2 * ")][:harmonics]
    equation = f"x = x + {' + '.join(waves)}" if of == "x" else f"x = z,  z = x + {' + '.join(waves)}"
    more = " + ".join(SIZES[1 : 2 * harmonics : 2])
    return f"{equation}, and {more} more in the elastic part" if home == SETTLED_AT_HOME else equation


def _from_sine(shape: tuple[float, ...], coefficients: Floats) -> tuple[float, ...]:
    return (*shape, float(coefficients[0]), float(coefficients[1]))


def _from_sine_twice(shape: tuple[float, ...], coefficients: Floats) -> tuple[float, ...]:
    return (*_from_sine(shape, coefficients), 0.0, 0.0)


class EncoderEccentricity(Effect):
    """Eccentric disc, magnet or gear: the measured deflection is wrong periodically."""

    id: ClassVar[str] = "encoder_eccentricity"
    title: ClassVar[str] = "encoder eccentricity"
    summary: ClassVar[str] = "periodic error of the deflection (eccentric disc, magnet or gear)"
    equation: ClassVar[str] = (
        "x → z, z = x + p sin(N z) + q cos(N z) [+ p2 sin(2 N z) + q2 cos(2 N z)] [− q − q2: zero at home, or only in what has memory], or with x on the right for z, or only in the elastic part"
    )
    coordinate: ClassVar[str] = "position"
    acts_on: ClassVar[str] = INPUT
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("error_sin", "rad", -np.inf, np.inf, "p, sine part of the error"),
        Parameter("error_cos", "rad", -np.inf, np.inf, "q, cosine part"),
        Parameter("error_sin_2", "rad", -np.inf, np.inf, "p2, sine part of its second harmonic"),
        Parameter("error_cos_2", "rad", -np.inf, np.inf, "q2, cosine part of it"),
        Parameter("periods", "1/rad·2π", 0.0, np.inf, "N, periods a turn; one where the error comes once a turn"),
    )
    confused_with: ClassVar[tuple[str, ...]] = ("deflection_offset", "torque_gain", "miscalibration")
    # A wave longer than the stroke is hardly more than its mean.
    image_of: ClassVar[tuple[str, ...]] = ("deflection_offset",)

    def imitates(self, signal: Floats, scene: Scene) -> Collection[str]:
        return ("stiffness_asymmetry",) if is_one_sided_stiffness(signal, scene) else ()

    def is_degenerate(self, parameters: dict[str, float], scene: Scene) -> bool:
        # Harmonics that cancel but for their mean are an offset of the deflection.
        angle = parameters.get("periods", 1.0) * scene.signals.x
        error, _ = _error([parameters.get(name, 0.0) for name in SIZES], angle)
        return abs(float(np.mean(error))) > MOSTLY_OFFSET * float(np.std(error))

    def outsider(self, form: Form, shape: tuple[float, ...], scene: Scene) -> Outsider:
        # Magnets, teeth and balls hold a joint at equal distances: a sensor's error is felt in all that follows the deflection.
        periods = shape[0] if "periods" in form.shapes else 1.0
        step = np.pi / scene.signals.reach
        starts = [(periods + more * step,) for more in DETENTS if periods + more * step > 0.0]
        harmonics = len({*form.coefficients, *form.shapes}.intersection(SIZES)) // 2
        any_size = (np.inf,) * (2 * harmonics + 1)
        waves = Form(
            "a torque that waves with the place", (*(f"_wave_{k}" for k in range(2 * harmonics)), "_mean"), _detents(harmonics),
            tuple(-size for size in any_size), any_size, ("periods",), (), [(0.3 * min(starts)[0], 2.0 * max(starts)[0])],
        )  # fmt: skip
        return Outsider(f"{waves.name}, as detents make,", waves, starts, form.name == OF_SPRING)

    def forms(self, scene: Scene) -> list[Form]:
        reach = scene.signals.reach
        # At least half a period within the stroke, at most thirty; slower waves are an offset and a gain.
        low, short, high = (waves * np.pi / reach for waves in (0.5, 12.0, 30.0))
        usual = geometric(low, short, 36)
        grid = [(n,) for n in (*usual, *_fine(scene, short, high))]
        wide = 0.2 * reach
        small = (-wide,) * 2, (wide,) * 2
        unit = ("_unit",), (1.0,), (1.0,)
        span, size = (low, high), (-wide, wide)
        made = []
        for home in ("", ZEROED, SETTLED_AT_HOME):
            told = f", {home}" if home else ""
            sine = f"sine{told}"
            made += [
                Form(sine, SIZES[:2], _columns(1, home), *small, ("periods",), grid, [span], borders=[LOW],
                     equation=_equation(1, home)),
                # The error is a function of the true angle: as one of the measured angle it has harmonics.
                Form(f"sine of the true angle{told}", unit[0], _of_true_angle(home), *unit[1:], ("periods", *SIZES[:2]), (),
                     [span, *[size] * 2], (sine,), _from_sine, borders=[LOW, NOT, NOT], equation=_equation(1, home, "z")),
                Form(f"two harmonics of the true angle{told}", unit[0], _of_true_angle(home), *unit[1:],
                     ("periods", *SIZES), (), [span, *[size] * 4], (sine,), _from_sine_twice,
                     borders=[LOW, *[NOT] * 4], equation=_equation(2, home, "z")),
                Form(f"two harmonics{told}", SIZES, _columns(2, home), (-wide,) * 4, (wide,) * 4, ("periods",), (), [span],
                     (sine,), borders=[LOW], equation=_equation(2, home)),
            ]  # fmt: skip
            if ONCE[0] < reach / np.pi < ONCE[1]:
                once = f"once a turn{told}"
                equations = (_equation(1, home), _equation(2, home, "z"))
                plain, of_true_angle = (equation.replace("periods * ", "") for equation in equations)
                made += [
                    Form(once, SIZES[:2], _once_a_turn(_columns(1, home)), *small, equation=plain),
                    Form(f"once a turn of the true angle, two harmonics{told}", unit[0], _once_a_turn(_of_true_angle(home)),
                         *unit[1:], SIZES, (), [size] * 4, (once,), _from_sine_twice, equation=of_true_angle),
                ]  # fmt: skip
        if _is_told_from_detents(scene, usual):
            made.append(
                # Short waves of a spring alone are those that detents make, on any spring.
                Form(OF_SPRING, SIZES[:2], _of_spring, *small, ("periods",), (), [span], ("sine",),
                     lambda shape, _: (min(shape[0], short),), borders=[LOW],
                     equation=f"{_equation(1, '')}, in the elastic part alone")
            )  # fmt: skip
        return made
