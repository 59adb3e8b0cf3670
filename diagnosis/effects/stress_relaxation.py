"""Viscoelastic relaxation: Maxwell branches beside the simulator."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import ClassVar

import numpy as np

from .base import BOTH, HIGH, LOW, NOT, Columns, Effect, Floats, Form, Parameter, Scene, geometric
from .parts import FOUND_SPRING, FOUND_SPRING_EQUATION, PARTS, Part, odd_spring

__all__ = ["StressRelaxation"]

AWAY = 0.02
"""Deflection of the first sample, over the reach, from which it is not sure that the joint had been at rest."""
NONE = 1e-4
"""Preload, over the torque's deviation, that is none."""
QUICK = 0.25
"""Radians of the motion's mean frequency within which a branch relaxes at least."""


def _relaxing(part: Callable[[Scene], Floats]) -> Columns:
    """A branch for each time constant, which holds what of ``part`` is new."""

    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        whole = part(scene)
        return np.column_stack([whole - scene.signals.lowpass(whole, tau) for tau in shape])

    return columns


def _missing(part: Callable[[Scene], Floats]) -> Columns:
    """The simulator knows ``part`` before it relaxes: what has relaxed is missing."""
    return lambda scene, shape: np.column_stack([-scene.signals.lowpass(part(scene), tau) for tau in shape])


def _in_between(part: Callable[[Scene], Floats]) -> Columns:
    """The simulator knows ``part`` while it relaxes: a share of what has relaxed is missing, the rest of it still to come."""
    return lambda scene, shape: np.hstack([_relaxing(part)(scene, shape), _missing(part)(scene, shape)])


def _of_a_found_spring(branches: Callable[[Callable[[Scene], Floats]], Columns]) -> Columns:
    """The same of an odd spring, which the simulator has and which is not told from its friction."""

    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        linear, cubic = odd_spring(scene).T
        return np.hstack([branches(lambda _: linear)(scene, shape), branches(lambda _: cubic)(scene, shape)])

    return columns


def _spectrum(branches: Columns) -> Columns:
    """Three branches whose time constants are as 1 : 4 : 16."""
    return lambda scene, shape: branches(scene, (shape[0], 4.0 * shape[0], 16.0 * shape[0]))


def _creeping(scene: Scene, shape: tuple[float, ...]) -> Floats:
    """A branch whose dashpot yields the more the more it is loaded."""
    tau, power = shape
    return scene.signals.creeping(scene.signals.smooth_x, tau, power, scene.signals.reach)[:, None]


def _crept_away(part: Part) -> Columns:
    """What such a branch of ``part`` no longer holds is missing."""

    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        risen, (tau, power) = _since_the_start(part).of(scene), shape
        return (scene.signals.creeping(risen, tau, power, scene.signals.strongest) - risen)[:, None]

    return columns


def _springpot(part: Callable[[Scene], Floats]) -> Columns:
    """A spectrum without end: relaxation by a power of time."""
    return lambda scene, shape: scene.signals.fractional(part(scene), shape[0])[:, None]


def _preload(scene: Scene) -> float:
    """Torque of the joint's spring where the deflection is nil, or least, N·m: what crept under it had when the joint was zeroed."""

    def made() -> Floats:
        x = scene.signals.x
        least = np.full_like(x, np.clip(0.0, x.min(), x.max()))
        there = np.median(scene.spring + scene.spring_change(least))
        return np.array([there if abs(there) > NONE * np.std(scene.torque) else 0.0])

    return float(scene.remembered("preload", made)[0])


def _crept(scene: Scene, time_constant: float) -> Floats:
    """What a spring and a dashpot side by side, in series with the joint, are stretched by for a compliance of one."""
    return scene.signals.lowpass(scene.signals.y_real - _preload(scene), time_constant)


def _crept_since_the_start(scene: Scene, time_constant: float) -> Floats:
    """The same where nothing had crept when the recording began."""
    s = scene.signals
    first = s.per_run(lambda run: np.full(run.stop - run.start, s.y_real[run.start] - _preload(scene)))
    return _crept(scene, time_constant) - first * np.exp(-s.elapsed / time_constant)


def _in_series(scene: Scene, shape: tuple[float, ...]) -> Floats:
    """The first order of a small compliance."""
    crept = _crept(scene, shape[0])
    small = 1e-3 * scene.signals.reach / max(float(np.max(np.abs(crept))), 1e-300)
    return scene.torque_change(scene.signals.x - small * crept)[:, None] / small


def _compliant_in_series(crept: Callable[[Scene, float], Floats]) -> Columns:
    return lambda scene, shape: scene.torque_change(scene.signals.x - shape[1] * crept(scene, shape[0]))[:, None]


def _law(part: Part, down: bool, *branches: tuple[str, str]) -> tuple[Columns, str]:
    """The columns and the equation of branches, each told by its size and its time constant.

    They hold what of ``part`` is new, or, ``down`` from it, what of it has relaxed is missing.
    """
    y = part.symbol
    terms = (f"{size} * lowpass({y}, {c})" if down else f"{size} * ({y} - lowpass({y}, {c}))" for size, c in branches)
    return (_missing if down else _relaxing)(part.of), f"y {'-' if down else '+'}= {' + '.join(terms)}"


def _begun_before(form: Form, *instead: str) -> Form:
    """The same where the recording begins amid a motion: what the branch held then decays.

    It is sought from ``instead`` as well, where a law of one branch took its place.
    """

    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        return np.column_stack([form.columns(scene, shape), *(np.exp(-scene.signals.elapsed / tau) for tau in shape)])

    held = [f"held{told.removeprefix('time_constant')}" for told in form.shapes]
    sign = " - " if "-=" in form.equation else " + "
    return replace(
        form, name=f"{form.name}, begun before", coefficients=(*form.coefficients, *held), columns=columns,
        lower=(*form.lower, *[-np.inf] * len(held)), upper=(*form.upper, *[np.inf] * len(held)), grid=(), refines=(form.name, *instead),
        start=lambda shape, found: shape if form.start is None or found.size > 1 else form.start(shape, found), elsewhere=form,
        equation=sign.join([form.equation, *(f"{h} * exp(-t / {tau})" for h, tau in zip(held, form.shapes, strict=True))]),
    )  # fmt: skip


def _since_the_start(part: Part) -> Part:
    """What has come to ``part`` since the recording began."""

    def columns(scene: Scene) -> Floats:
        whole = part.of(scene)
        return scene.signals.per_run(lambda run: whole[run] - whole[run][0])

    return Part(f"rise({part.symbol})", columns)


DEFLECTION, TORQUE = Part("x", lambda scene: scene.signals.smooth_x), Part("y", lambda scene: scene.torque)
SPRING = PARTS["the spring"]


def _from_a_rest(part: Part) -> Columns:
    """Relaxation towards where the joint is from where it had rested before the recording began."""

    def columns(scene: Scene, shape: tuple[float, ...]) -> Floats:
        s, u, (tau, rest) = scene.signals, part.of(scene), shape
        first = u - _since_the_start(part).of(scene)
        return (rest - s.lowpass(u, tau) - (rest - first) * np.exp(-s.elapsed / tau))[:, None]

    return columns


class StressRelaxation(Effect):
    """Torque that decays while the deflection is held (rubber, polymer belts, tendons)."""

    id: ClassVar[str] = "stress_relaxation"
    title: ClassVar[str] = "stress relaxation"
    summary: ClassVar[str] = "torque that decays during a hold and rises with rate (viscoelastic Maxwell branch)"
    equation: ClassVar[str] = (
        "y += Σ k_i (x − L_i),  τ_i dL_i/dt = x − L_i   (or with y_sim, or its elastic part, in place of k x; or y −= Σ s_i (L_i − r) of either, r being where the joint had rested before); or y += k dᵖx/dtᵖ with 0 < p < 1; "
        "or y += k f,  df/dt = dx/dt − (f / τ) |f / X|^(p − 1) with the stroke X; or x → x − c,  τ dc/dt = (y − p)/K − c with the preload p"
    )
    coordinate: ClassVar[str] = "time"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("stiffness", "N·m/rad", 0.0, np.inf, "of the (first) Maxwell branch"),
        Parameter("stiffness_2", "N·m/rad", 0.0, np.inf, "of the second branch"),
        Parameter(
            "stiffness_3", "N·m/rad", 0.0, np.inf, "of the third branch; a spectrum has time constants 1 : 4 : 16"
        ),
        Parameter("share", "1", 0.0, np.inf, "part of the simulator's torque, or of its elastic part, that relaxes"),
        Parameter("share_2", "1", 0.0, np.inf, "of the second branch of a spectrum"),
        Parameter("share_3", "1", 0.0, np.inf, "of its third branch"),
        Parameter(
            "share_relaxed", "1", 0.0, np.inf, "part of the elastic torque that the simulator has though it relaxes"
        ),
        Parameter(
            "spring_rate", "N·m/rad", 0.0, np.inf, "of a spring that relaxes, where the simulator's is not known"
        ),
        Parameter("spring_cubic", "N·m/rad³", -np.inf, np.inf, "by which that spring hardens or softens"),
        Parameter("time_constant", "s", 0.0, np.inf, "of the (first) branch"),
        Parameter("held", "N·m", -np.inf, np.inf, "what the branch held when the recording began amid a motion"),
        Parameter("rest", "N·m", -np.inf, np.inf, "torque to which the joint had relaxed before the recording began"),
        Parameter("held_2", "N·m", -np.inf, np.inf, "what the second one held"),
        Parameter("compliance", "rad/(N·m)", 0.0, np.inf, "1/K, of what creeps in series with the joint"),
        Parameter(
            "springpot",
            "N·m·s^p/rad or s^p",
            0.0,
            np.inf,
            "of a fractional element on the deflection, or on the torque or its elastic part",
        ),
        Parameter("order", "1", 0.05, 0.8, "p of its derivative: between a spring's, 0, and a damper's, 1"),
        Parameter("power", "1", 1.2, 4.0, "p, of the load with which its dashpot yields, in τ at the stroke's end"),
        Parameter("time_constant_2", "s", 0.0, np.inf, "of the second branch"),
    )
    confused_with: ClassVar[tuple[str, ...]] = ("viscous_friction", "sensor_delay", "miscalibration")

    def forms(self, scene: Scene) -> list[Form]:
        s = scene.signals
        span = max(float(s.elapsed[run.stop - 1]) for run in s.runs)
        # What relaxes far more slowly than the recording moves is a spring.
        high = 0.25 * span
        # A branch that follows the motion at once is a damper.
        pace = float(np.std(s.smooth_x)) / max(float(np.std(s.speed)), 1e-300)
        low = min(max(4.0 * s.interval, QUICK * pace), 0.2 * high)
        times = geometric(max(low, span / 1500.0), high, 10)
        limits = (low, 1.2 * high)
        # That of a power-law dashpot is its time constant at the largest torque: at smaller ones it is slower.
        creeping = (0.02 * low, 1.2 * high)
        # Nor may the slowest of three branches be one by itself.
        spread = (low, 0.3 * high)

        def two(size: str) -> list[tuple[str, str]]:
            return [(size, "time_constant"), (f"{size}_2", "time_constant_2")]

        def three(size: str) -> list[tuple[str, str]]:
            return [(size, "time_constant"), (f"{size}_2", "4 * time_constant"), (f"{size}_3", "16 * time_constant")]

        def branch(name: str, part: Part, down: bool, size: str = "share") -> Form:
            law, equation = _law(part, down, (size, "time_constant"))
            return Form(
                name, (size,), law, (0.0,), (np.inf,), ("time_constant",), [(t,) for t in (times[::2] if down else times)],
                [limits], borders=[LOW], equation=equation,
            )  # fmt: skip

        def branches(name: str, part: Part, down: bool, simpler: str) -> Form:
            law, equation = _law(part, down, *two("share"))
            return Form(
                name, ("share", "share_2"), law, (0.0,) * 2, (np.inf,) * 2, ("time_constant", "time_constant_2"), (),
                [limits, limits], (simpler,), lambda shape, _: (max(0.4 * shape[0], low), min(2.5 * shape[0], high)),
                equation=equation,
            )  # fmt: skip

        def spectrum(name: str, part: Part, down: bool, simpler: str) -> Form:
            law, equation = _law(part, down, *three("share"))
            return Form(
                name, ("share", "share_2", "share_3"), _spectrum(law), (0.0,) * 3, (np.inf,) * 3, ("time_constant",), (),
                [spread], (simpler,), lambda shape, _: (max(0.25 * shape[0], low),), equation=equation,
            )  # fmt: skip

        def springpot(name: str, part: Part, simpler: str) -> Form:
            return Form(
                name, ("springpot",), _springpot(part.of), (0.0,), (np.inf,), ("order",), (), [(0.05, 0.8)], (simpler,),
                lambda shape, _: (0.3,), borders=[BOTH], equation=f"y += springpot * fractional({part.symbol}, order)",
            )  # fmt: skip

        def yielding(name: str, part: Part, *simpler: str) -> Form:
            y = part.symbol
            return Form(
                name, ("share",), _crept_away(part), (0.0,), (np.inf,), ("time_constant", "power"), (), [creeping, (1.2, 4.0)],
                simpler, lambda shape, _: (shape[0], 1.6), borders=[LOW, HIGH],
                equation=f"y -= share * (rise({y}) - creep({y}, time_constant, power, {scene.signals.strongest:.8g}))",
            )  # fmt: skip

        def found_anew(name: str, law: Callable[[Callable[[Scene], Floats]], Columns], equation: str) -> Form:
            return Form(
                name, FOUND_SPRING, _of_a_found_spring(law), (0.0, -np.inf), (np.inf, np.inf), ("time_constant",), (), [limits],
                tuple(form.name for form in single), guessed=True, borders=[LOW], equation=equation,
            )  # fmt: skip

        settled = f"lowpass({SPRING.symbol}, time_constant)"
        preload = _preload(scene)
        loaded = f"y {'+' if preload < 0.0 else '-'} {abs(preload):.8g}" if preload else "y"
        in_series = f"x = x - compliance * lowpass({loaded}, time_constant)"
        # As soft as that the joint itself would hardly move.
        soft = 0.5 * s.reach / max(float(np.max(np.abs(s.y_real - preload))), 1e-300)
        in_full = Form(
            "creep in series", ("_unit",), _compliant_in_series(_crept), (1.0,), (1.0,), ("time_constant", "compliance"), (),
            [limits, (1e-4 * soft, soft)], ("creep in series, small",), lambda shape, found: (*shape, float(found[0])),
            borders=[LOW, NOT], equation=in_series,
        )  # fmt: skip
        pairs = [(a, b) for a in times[::2] for b in times[1::2] if b > 4.0 * a]
        of_two, told_two = _law(DEFLECTION, False, *two("stiffness"))
        of_three, told_three = _law(DEFLECTION, False, *three("stiffness"))
        single = [
            branch("one branch", DEFLECTION, False, "stiffness"),
            branch("of the torque", TORQUE, False),
            branch("from the torque down", TORQUE, True),
            branch("from the spring down", SPRING, True),
        ]
        down = [
            branches("from the torque down, two branches", TORQUE, True, "from the torque down"),
            branches("from the spring down, two branches", SPRING, True, "from the spring down"),
        ]
        up = [
            branches("two branches of the torque", TORQUE, False, "of the torque"),
            branches("two branches of the spring", SPRING, False, "of the torque"),
        ]
        dashpots = tuple(f"power-law dashpot, from the {part} down" for part in ("torque", "spring"))
        risen = tuple(f"from the {part} down, of its rise" for part in ("torque", "spring"))

        def since_a_rest(simpler: str, rise: str, part: Part) -> Form:
            u = part.symbol
            return Form(
                f"{simpler}, since a rest", ("share",), _from_a_rest(part), (0.0,), (np.inf,), ("time_constant", "rest"), (),
                [limits, (-s.strongest, s.strongest)], (simpler, rise),
                lambda shape, _: (shape[0], float(part.of(scene)[0])), borders=[LOW, NOT],
                equation=f"y -= share * (lowpass({u}, time_constant) - rest + (rest - {u} + rise({u})) * exp(-t / time_constant))",
            )  # fmt: skip

        begun_away = abs(s.smooth_x[0]) > AWAY * s.reach
        begun_amid = begun_away and len(s.runs) == 1
        # What a joint was held at before may be the rest from which it relaxes.
        fresh = [
            form
            for name, part in zip(risen, (_since_the_start(TORQUE), _since_the_start(SPRING)), strict=True)
            for form in (branch(name, part, True), branches(f"{name}, two branches", part, True, name))
        ]
        return [
            *single,
            *(fresh if begun_away else ()),
            since_a_rest("from the torque down", risen[0], TORQUE),
            since_a_rest("from the spring down", risen[1], SPRING),
            *(_begun_before(form) for form in (*single, *up) if begun_amid),
            *(_begun_before(form, dashpot) for form, dashpot in zip(down, dashpots, strict=True) if begun_amid),
            Form("two branches", ("stiffness", "stiffness_2"), of_two, (0.0, 0.0), (np.inf, np.inf),
                 ("time_constant", "time_constant_2"), pairs, [limits, limits], equation=told_two),
            Form("spectrum", ("stiffness", "stiffness_2", "stiffness_3"), _spectrum(of_three), (0.0,) * 3, (np.inf,) * 3,
                 ("time_constant",), [(t,) for t in times if t < spread[1]], [spread], equation=told_three),
            # With a high power it is a slider.
            Form("power-law dashpot", ("stiffness",), _creeping, (0.0,), (np.inf,), ("time_constant", "power"),
                 [(t, 2.0) for t in geometric(0.1 * low, high, 6)], [creeping, (1.2, 4.0)],
                 borders=[LOW, HIGH],
                 equation=f"y += stiffness * creep(x, time_constant, power, {s.reach:.8g})"),
            yielding(dashpots[0], TORQUE, "from the torque down", risen[0]),
            yielding(dashpots[1], SPRING, "from the spring down", risen[1]),
            Form("creep in series, small", ("compliance",), _in_series, (0.0,), (np.inf,), ("time_constant",),
                 [(t,) for t in times[::2]], [limits], borders=[LOW], equation=in_series),
            in_full,
            replace(
                in_full, name="creep in series, since the start", columns=_compliant_in_series(_crept_since_the_start),
                refines=(*in_full.refines, in_full.name), start=lambda shape, found: (*shape, float(found[0]))[:2],
                equation=f"x = x - compliance * (lowpass({loaded}, time_constant) - ({loaded} - rise(y)) * exp(-t / time_constant))",
            ),
            found_anew("of a spring found anew, down", _missing, f"y -= lowpass({FOUND_SPRING_EQUATION}, time_constant)"),
            found_anew("of a spring found anew", _relaxing,
                       f"y += {FOUND_SPRING_EQUATION} - lowpass({FOUND_SPRING_EQUATION}, time_constant)"),
            *down,
            *up,
            spectrum("from the torque down, spectrum", TORQUE, True, "from the torque down"),
            spectrum("from the spring down, spectrum", SPRING, True, "from the spring down"),
            # Of a simulator that was identified at the usual speeds: neither as stiff as at first nor as soft as in the end.
            Form("of the spring, in between", ("share", "share_relaxed"), _in_between(SPRING.of), (0.0,) * 2, (np.inf,) * 2,
                 ("time_constant",), (), [limits], ("from the spring down",), borders=[LOW],
                 equation=f"y += share * (y_spring - {settled}) - share_relaxed * {settled}"),
            spectrum("spectrum of the torque", TORQUE, False, "of the torque"),
            spectrum("spectrum of the spring", SPRING, False, "of the torque"),
            springpot("fractional", DEFLECTION, "one branch"),
            springpot("fractional, of the torque", TORQUE, "of the torque"),
            springpot("fractional, of the spring", SPRING, "of the torque"),
        ]  # fmt: skip
