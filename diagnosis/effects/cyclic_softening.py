"""Torque that falls with the work done."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import ClassVar

import numpy as np

from .base import TRAVEL, Columns, Effect, Floats, Form, Parameter, Scene, geometric
from .parts import EXACT_PARTS, inside, unlike

__all__ = ["CyclicSoftening"]

Worn = Callable[[Scene, tuple[float, ...]], Floats]
FEWEST = 10
"""Reversals below which their number is too coarse a count."""
MORE = 1.2
"""All turns over those that are no dither, from which it matters which of them count."""
GROWN = 0.9
"""Mean of the largest deflection so far over the last, from which on it is as large as that from the start."""
SOFTENINGS = "spring_softening", "friction_softening"
"""Names of the coefficients where both parts wear, not alike."""
LOSSY = 0.3
"""Losses over all the work of the part with memory, above which they are no trace that an emulator leaves of a spring."""


def _linear(scene: Scene, shape: tuple[float, ...]) -> Floats:
    return scene.signals.travel


def _farthest(scene: Scene, shape: tuple[float, ...] = ()) -> Floats:
    # Rubber has softened as far as it was stretched (Mullins).
    return scene.signals.farthest


def _below_farthest(scene: Scene, shape: tuple[float, ...]) -> Floats:
    # Where it is stretched farther than ever it is as it was (Ogden and Roxburgh).
    s = scene.signals
    return s.farthest - np.abs(s.smooth_x)


def _below_strongest(scene: Scene, shape: tuple[float, ...]) -> Floats:
    # The same of a spring's energy, as they have it.
    s = scene.signals
    return np.asarray(1.0 - np.exp((s.smooth_x**2 - s.farthest**2) / shape[0] ** 2))


def _goes_on(scene: Scene) -> bool:
    """Whether the motion reaches farther for a while: else what depends on how far it went is a gain."""
    farthest = scene.signals.farthest
    return any(float(np.mean(farthest[run])) < GROWN * farthest[run][-1] for run in scene.signals.runs)


def _hyperbolic(scene: Scene, shape: tuple[float, ...]) -> Floats:
    travel = scene.signals.travel
    return np.asarray(travel / (shape[0] + travel))


def _travel(scene: Scene) -> Floats:
    return scene.signals.travel


def _reversals(scene: Scene) -> Floats:
    return scene.signals.reversals


def _turns(scene: Scene) -> Floats:
    return scene.signals.turns


def _logarithm(used: Callable[[Scene], Floats]) -> Worn:
    """Wear that slows down but does not end: log(1 + ``used``/constant)."""
    return lambda scene, shape: np.log1p(used(scene) / shape[0])


def _power(used: Callable[[Scene], Floats]) -> Worn:
    return lambda scene, shape: np.asarray(used(scene) ** shape[0])


def _travelled(weight: Callable[[Scene], Floats]) -> Callable[[Scene], Floats]:
    """Travel of which each bit counts by ``weight``."""

    def used(scene: Scene) -> Floats:
        s, weights = scene.signals, weight(scene)
        return s.per_run(lambda run: np.cumsum(weights[run] * np.abs(s.moved[run])))

    return used


_work = _travelled(lambda scene: np.abs(scene.torque))
# Miner's sum with the square of the load.
_damage = _travelled(lambda scene: scene.torque**2)
# Fatigue of what is bent: large deflections count more.
_swings = _travelled(lambda scene: np.square(scene.signals.smooth_x))


def _losses(scene: Scene) -> Floats:
    """Work that does not come back: of the part with memory."""
    s, friction = scene.signals, scene.friction
    return s.per_run(lambda run: np.maximum.accumulate(np.maximum(np.cumsum(friction[run] * s.moved[run]), 0.0)))


def _is_lossy(scene: Scene) -> bool:
    """Whether the losses go on: where all work comes back they are over at once, and wear by them is a gain."""
    lost, work = _losses(scene), np.abs(scene.friction * scene.signals.moved)
    return any(lost[run][-1] > LOSSY * float(np.sum(work[run])) for run in scene.signals.runs)


def _weibull(scene: Scene, shape: tuple[float, ...]) -> Floats:
    """Parts that fail one after the other: few at first, most about a travel."""
    return np.asarray(1.0 - np.exp(-((scene.signals.travel / shape[0]) ** shape[1])))


def _incubated(scene: Scene, shape: tuple[float, ...]) -> Floats:
    """A crack that has to begin before it grows."""
    return np.maximum(scene.signals.travel - shape[0], 0.0)


def _exponential(used: Callable[[Scene], Floats]) -> Worn:
    """Wear that comes to an end: 1 − exp(−``used``/constant)."""
    return lambda scene, shape: np.asarray(1.0 - np.exp(-used(scene) / shape[0]))


def _column(worn: Worn) -> Columns:
    return lambda scene, shape: -worn(scene, shape)[:, None]


def _lost(worn: Worn) -> Columns:
    return lambda scene, shape: (-worn(scene, shape) * scene.torque)[:, None]


def _within(form: Form, worn: Worn) -> list[Form]:
    """Laws like ``form``, of the whole torque, that are of its parts, of one or, not alike, of both."""
    parts = inside(form, _column(worn))
    both = [
        replace(unlike(form, _column(worn), SOFTENINGS, of), grid=(), guessed=True, refines=(form.name, *(part.name for part in parts)))
        for of in ("the friction", "the friction's strength")
    ]  # fmt: skip
    return [*parts, *both]


class CyclicSoftening(Effect):
    """The Mullins effect of rubber, wear or damage: each cycle takes a little of the torque."""

    id: ClassVar[str] = "cyclic_softening"
    title: ClassVar[str] = "cyclic softening"
    summary: ClassVar[str] = "torque that falls with accumulated travel (Mullins effect, wear, damage)"
    equation: ClassVar[str] = (
        "y −= a w y_sim (or a part of it, or of its parts or it and a spring found anew, not alike),  w = 1 − exp(−travel/L), travel/(L + travel), log(1 + travel/L), travel, "
        "1 − exp(−(travel/L)^k), max(travel − L0, 0), travel^p, M^p with M the largest |x| so far, M − |x|, 1 − exp((x² − M²)/D²), reversals^p, 1 − exp(−∫|y dx|/W), the same of ∫y² |dx|, of ∫x² |dx| or of the losses, or 1 − exp(−reversals/N), log(1 + reversals/N), small ones counted or not"
    )
    coordinate: ClassVar[str] = "travel"
    clock: ClassVar[str] = TRAVEL
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            "softening",
            "1 (1/rad of travel or deflection, 1/rad^p for a power of the travel)",
            0.0,
            np.inf,
            "relative loss in the limit, or per travel",
        ),
        Parameter("spring_softening", "as softening", 0.0, np.inf, "of the spring, where both parts wear"),
        Parameter("friction_softening", "as softening", 0.0, np.inf, "of what has memory, where both wear"),
        Parameter(
            "spring_rate", "N·m/rad, or that by unit of w", -np.inf, np.inf, "lost of a spring that is found anew"
        ),
        Parameter("spring_cubic", "N·m/rad³, or that by unit of w", -np.inf, np.inf, "lost of its cubic part"),
        Parameter(
            "travel_constant", "rad", 0.0, np.inf, "travel after which 63 % (hyperbolic: half) of the loss has come"
        ),
        Parameter("power", "1", 0.3, 3.0, "p of the travel or of the reversals, above one for damage that grows"),
        Parameter("shape", "1", 0.5, 8.0, "k, of Weibull's law"),
        Parameter("begun", "rad", 0.0, np.inf, "L0, travel from which on it wears"),
        Parameter("depth", "rad", 0.0, np.inf, "D, of the softening below the largest deflection so far"),
        Parameter("work_constant", "J", 0.0, np.inf, "W, of the work ∫|y dx|"),
        Parameter("damage_constant", "N²·m²·rad", 0.0, np.inf, "of the damage ∫y² |dx|"),
        Parameter("swing_constant", "rad³", 0.0, np.inf, "of the swings ∫x² |dx|"),
        Parameter("loss_constant", "J", 0.0, np.inf, "W', of the losses, the work ∮y dx of the part with memory"),
        Parameter("reversals_constant", "1", 0.0, np.inf, "N, half cycles after which 63 % of the loss has come"),
    )
    confused_with: ClassVar[tuple[str, ...]] = ("thermal_drift", "torque_gain")

    def forms(self, scene: Scene) -> list[Form]:
        shortest, total = scene.signals.shortest_and_longest(scene.signals.travel)
        lengths = [(t,) for t in geometric(0.04 * shortest, 1.5 * total, 7)]
        # Softening that is over within a thirtieth of every recording could not be told from a gain.
        limits = (0.03 * shortest, 3.0 * total)

        def law(
            name: str,
            equation: str,
            worn: Worn,
            shape: str,
            grid: Sequence[tuple[float, ...]],
            ends: tuple[float, float],
            most: float = 1.0,
        ) -> list[Form]:
            """A law of the whole torque, and of its parts."""
            form = Form(name, ("softening",), _lost(worn), (0.0,), (most,), (shape,), grid, [ends],
                        equation=f"y -= softening * {equation} * y")  # fmt: skip
            return [form, *_within(form, worn)]

        def proportional(name: str, worn: Worn, word: str, most: float) -> list[Form]:
            form = Form(name, ("softening",), _lost(worn), (0.0,), (1.0 / max(most, 1e-300),),
                        equation=f"y -= softening * {word} * y")  # fmt: skip
            return [form, *_within(form, worn)]

        made = [
            *proportional("linear", _linear, "travel", total),
            *law("exponential", "(1 - exp(-travel / travel_constant))", _exponential(_travel), "travel_constant", lengths, limits),
            *law("hyperbolic", "travel / (travel_constant + travel)", _hyperbolic, "travel_constant", lengths, limits),
            *law("logarithm", "log(1 + travel / travel_constant)", _logarithm(_travel), "travel_constant", lengths[1::2], limits),
            *law("power of travel", "travel**power", _power(_travel), "power", [(0.5,), (0.75,), (1.8,)], (0.3, 3.0), np.inf),
        ]  # fmt: skip
        failing = Form("Weibull", ("softening",), _lost(_weibull), (0.0,), (1.0,), ("travel_constant", "shape"),
                       [(share * total, p) for share in (0.3, 0.6) for p in (2.0, 4.0)], [limits, (0.5, 8.0)],
                       equation="y -= softening * (1 - exp(-(travel / travel_constant)**shape)) * y")  # fmt: skip
        cracked = Form("linear from a travel on", ("softening",), _lost(_incubated), (0.0,), (1.0 / max(0.2 * total, 1e-300),),
                       ("begun",), [(share * total,) for share in (0.2, 0.4, 0.6)], [(0.08 * total, 0.8 * total)],
                       equation="y -= softening * maximum(travel - begun, 0) * y")  # fmt: skip
        made += [
            failing,
            *_within(failing, _weibull),
            cracked,
            *inside(cracked, _column(_incubated), EXACT_PARTS),
        ]
        # A law that was found elsewhere goes on, however little there is to count.
        found = bool(scene.signals.sizes)
        if found or _goes_on(scene):
            far = scene.signals.stroke
            made += proportional("by largest deflection", _farthest, "farthest", far)
            made += proportional("below largest deflection", _below_farthest, "(farthest - abs(x))", far)
            made += law("below largest energy", "(1 - exp((x**2 - farthest**2) / depth**2))", _below_strongest, "depth",
                        [(share * far,) for share in (0.3, 1.0)], (0.1 * far, 5.0 * far), np.inf)  # fmt: skip
            made += law("power of largest deflection", "farthest**power", _power(_farthest), "power",
                        [(0.5,), (2.0,)], (0.3, 3.0), np.inf)  # fmt: skip
        for word, constant, used, shares in (
            ("work", "work_constant", _work, (0.1, 0.4, 1.5)),
            ("damage", "damage_constant", _damage, (0.2, 0.8)),
            ("losses", "loss_constant", _losses, (0.2, 0.8, 3.0)),
            ("swings", "swing_constant", _swings, (0.2, 0.8)),
        ):
            least, most = scene.signals.shortest_and_longest(used(scene))
            if not found and (most <= 0.0 or (used is _losses and not _is_lossy(scene))):
                continue
            # Hardly begun, it is linear.
            made += law(f"by {word}", f"(1 - exp(-{word} / {constant}))", _exponential(used), constant,
                        [(share * most,) for share in shares], (0.03 * least, 20.0 * most))  # fmt: skip
        counts = {"reversals": _reversals}
        if found or float(scene.signals.turns.max()) > MORE * float(scene.signals.reversals.max()):
            counts["turns"] = _turns
        for count, used in counts.items():
            fewest, turns = scene.signals.shortest_and_longest(used(scene))
            if turns < FEWEST and not found:
                continue
            numbers, ends = [(share * turns,) for share in (0.1, 0.3, 1.0)], (0.03 * fewest, 3.0 * turns)
            for name, equation, worn in (
                (f"by {count}", f"(1 - exp(-{count} / reversals_constant))", _exponential(used)),
                (f"logarithm of {count}", f"log(1 + {count} / reversals_constant)", _logarithm(used)),
            ):
                made += law(name, equation, worn, "reversals_constant", numbers, ends)
            made += law(
                f"power of {count}", f"{count}**power", _power(used), "power", [(0.5,), (0.8,)], (0.3, 3.0), np.inf
            )
        return made
