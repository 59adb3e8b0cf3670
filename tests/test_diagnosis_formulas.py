"""Every law's equation, carried out word for word, is what the diagnosis fits."""

from __future__ import annotations

import functools
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from joints import sliders
from numpy.typing import NDArray
from scipy.special import gamma

from hystbench.diagnosis.diagnosis import known_effects
from hystbench.diagnosis.effects.base import Effect, Form
from hystbench.diagnosis.emulator.emulation import SimulatorScene, emulate
from hystbench.diagnosis.notation import WORDS, explained
from hystbench.diagnosis.recording.noise import rms
from hystbench.diagnosis.recording.signals import Signals

Floats = NDArray[np.float64]
IMPLICIT = {
    "gap at zero torque", "gap at zero torque, soft flanks", "gap at zero torque, free flight",
}  # fmt: skip
"""Laws told in prose: what they need must be found."""
SLIDERS = (5.0, 0.15), (1.0, 0.3)
"""Stiffness and level of the joint's friction."""
PERIODS = 2.5
NUMPYS = {
    "exp", "sin", "cos", "tanh", "arctan", "arcsinh", "hypot", "log", "logaddexp", "sqrt", "sign", "abs", "clip", "where", "maximum", "minimum", "max",
    "pi",
}  # fmt: skip
"""Words that need no explanation."""


@functools.cache
def scene() -> SimulatorScene:
    """A hardening spring with sliders, slow enough for its samples that ways of integrating hardly differ.

    It swings by almost half a turn, so that errors that come once a turn are looked for.
    """
    time = np.arange(4000) * 0.005
    x = 1.1 * np.sin(2 * np.pi * 0.31 * time) + 0.35 * np.sin(2 * np.pi * 0.83 * time)
    x *= 1.0 - np.exp(-time)
    y = 4.0 * x + 0.9 * x**3 + sliders(x, SLIDERS)
    channels = {"motor_temperature": 20.0 + 3.0 * np.sin(0.1 * time), "clamp_force": 5.0 + np.cos(0.7 * time)}
    signals = Signals(time, x, y, y, [slice(0, time.size)], channels)
    return SimulatorScene(signals, emulate(signals, None))


def followed(x: Floats, step: Callable[[float, int], float], start: float = 0.0) -> Floats:
    """A state that moves on at each sample."""
    state, out = start, np.empty(x.size)
    out[0] = state
    for k in range(1, x.size):
        state = out[k] = step(state, k)
    return out


def words() -> dict[str, Any]:
    """The words of :mod:`hystbench.diagnosis.notation`, written from what they are said to mean."""
    s = scene().signals
    x, time, fine = s.smooth_x, s.elapsed, 20

    def dahl(x: Floats, d: float, h: Floats | float = 1.0) -> Floats:
        high = np.broadcast_to(h, x.shape)

        def step(state: float, k: int) -> float:
            dx = (x[k] - x[k - 1]) / fine
            for _ in range(fine):
                # Implicit, for it may hold almost nothing.
                state = (state + dx / d) / (1.0 + abs(dx) / (d * max(high[k], 1e-12)))
            return state

        return followed(x, step)

    def slip(x: Floats, d: float, h: Floats | float = 1.0) -> Floats:
        high = np.broadcast_to(h, x.shape)
        return followed(x, lambda state, k: float(np.clip(state + (x[k] - x[k - 1]) / d, -high[k], high[k])))

    def film(x: Floats, d: float, w: float) -> Floats:
        def step(state: float, k: int) -> float:
            for _ in range(fine):
                moved = (x[k] - x[k - 1]) / fine - w * state * (time[k] - time[k - 1]) / fine
                state = float(np.clip(state + moved / d, -1.0, 1.0))
            return state

        return followed(x, step)

    def play(x: Floats, h: float) -> Floats:
        return followed(x, lambda p, k: min(max(p, x[k] - h), x[k] + h))

    def lowpass(u: Floats, T: float, start: float | None = None) -> Floats:
        def step(w: float, k: int) -> float:
            for part in range(1, fine + 1):
                between = u[k - 1] + (u[k] - u[k - 1]) * (part - 0.5) / fine
                w = between + (w - between) * np.exp(-(time[k] - time[k - 1]) / fine / T)
            return w

        return followed(u, step, u[0] if start is None else start)

    def creep(x: Floats, T: float, p: float, L: float) -> Floats:
        def step(f: float, k: int) -> float:
            for _ in range(fine):
                f += (x[k] - x[k - 1]) / fine - f / T * abs(f / L) ** (p - 1.0) * (time[k] - time[k - 1]) / fine
            return f

        return followed(x, step)

    def fractional(u: Floats, p: float) -> Floats:
        """Caputo's derivative of straight pieces, which from rest is the same."""
        out = np.zeros(u.size)
        for k in range(1, u.size):
            left = (time[k] - time[: k + 1]) ** (1.0 - p)
            out[k] = np.sum(np.diff(u[: k + 1]) / np.diff(time[: k + 1]) * (left[:-1] - left[1:])) / gamma(2.0 - p)
        return out

    def resonator(u: Floats, w: float, d: float) -> Floats:
        speed, substeps = 0.0, 200

        def step(z: float, k: int) -> float:
            nonlocal speed
            h = (time[k] - time[k - 1]) / substeps
            for part in range(1, substeps + 1):
                between = u[k - 1] + (u[k] - u[k - 1]) * part / substeps
                speed += h * (w * w * (between - z) - 2.0 * d * w * speed)
                z += h * speed
            return z

        return followed(u, step)

    dx = np.diff(x, prepend=x[0])
    y, spring, memory = s.y_sim, scene().spring, scene().friction

    def stronger(g: Floats | float) -> Floats:
        return sum(f * (slip(s.x, f / k, 1.0 + g) - slip(s.x, f / k)) for k, f in SLIDERS)

    def stiffer(g: Floats) -> Floats:
        return g * y + (1.0 + g) * stronger(-g / (1.0 + g))

    return {
        "x": s.x, "v": s.speed, "a": s.acceleration, "t": time, "y": y, "y_spring": spring, "y_memory": memory,
        "stronger": stronger, "stiffer": stiffer, "travel": np.cumsum(np.abs(dx)), "work": np.cumsum(np.abs(y * dx)), "damage": np.cumsum(y**2 * np.abs(dx)),
        "losses": np.maximum.accumulate(np.maximum(np.cumsum(memory * dx), 0.0)), "reversals": s.reversals,
        "swings": np.cumsum(x**2 * np.abs(dx)), "turns": s.turns,
        "dahl": dahl, "slip": slip, "film": film, "play": play, "lowpass": lowpass, "creep": creep, "fractional": fractional, "resonator": resonator,
        "plays": lambda x, h1, h2: np.mean([play(x, h) for h in np.linspace(h1, h2, 7)], axis=0),
        "heat": lambda u, T: lowpass(np.abs(u), T, 0.0), "late": lambda u, T: np.interp(time - T, time, u),
        "rise": lambda c: c - c[0], **{name: getattr(np, name) for name in NUMPYS},
        **s.channels,
    }  # fmt: skip


def middle(form: Form) -> tuple[float, ...]:
    """A shape within the law's limits, not too near them."""
    shape = []
    for name, (low, high) in zip(form.shapes, form.limits, strict=True):
        if name == "periods":
            shape.append(PERIODS)
        elif name.startswith("error"):
            shape.append(0.05 * high)
        else:
            shape.append(float(np.sign(low) * np.sqrt(low * high)) if low * high > 0.0 else 0.3 * high)
    return tuple(shape)


def sizes(form: Form) -> Floats:
    """Coefficients within the law's bounds, each another."""
    wanted = 1e-3 * (1.0 + np.arange(len(form.coefficients)))
    wanted = np.where(np.asarray(form.upper) <= 0.0, -wanted, wanted)
    return np.clip(wanted, np.maximum(form.lower, -1e9), np.minimum(form.upper, 1e9))


def carried_out(form: Form, values: dict[str, Any]) -> Floats:
    """What the equation adds to the simulator's output."""
    at, known = scene(), {**words(), **values}
    head, _, text = form.equation.partition(" ")
    operator, _, text = text.partition(" ")
    if text.startswith("z,  z = "):
        inner = text.removeprefix("z,  z = ").partition(",")[0]
        known["z"] = known["x"]
        for _ in range(30):
            known["z"] = eval(inner, {}, known)
        result = known["z"]
    elif ",  s = " in text:
        text, _, inner = text.partition(",  s = ")
        known["s"] = eval(inner, {}, known)
        result = eval(text, {}, known)
    elif ",  y = " in text:
        text, _, then = text.partition(",  y = ")
        known["x"] = eval(text, {}, known)
        known["y"] = known["y"] + at.torque_change(known["x"])
        return eval(then, {}, known) - at.torque
    else:
        result = eval(text.partition(", in the")[0].partition(", and ")[0], {}, known)
    if head == "y":
        return {"+=": result, "-=": -result, "=": result - known["y"]}[operator]
    if ", in the elastic part alone" in text:
        return at.spring_change(result)
    change = at.torque_change(result)
    if ", in the part with memory alone" in text:
        return change - at.spring_change(result)
    more = re.search(r", and (.*) more in the elastic part", text)
    if more:
        change = change + at.spring_change(result + eval(more[1], {}, known)) - at.spring_change(result)
    return change


@pytest.mark.parametrize("effect", known_effects(), ids=lambda effect: effect.id)
def test_the_equation_of_each_law_gives_what_the_law_fits(effect: Effect) -> None:
    for form in effect.forms(scene()):
        if form.name in IMPLICIT:
            continue
        shape, coefficients = middle(form), sizes(form)
        if form.about:
            # So much that it is no matter of single elements that give way.
            small = form.columns(scene(), shape) @ coefficients
            coefficients = coefficients * 0.5 * rms(scene().strength) / rms(small)
        values = {
            **dict(zip(form.coefficients, coefficients, strict=True)),
            **dict(zip(form.shapes, shape, strict=True)),
        }
        made = form.about(scene(), shape, coefficients) if form.about else form.columns(scene(), shape)
        fitted = made @ coefficients
        assert rms(fitted) > 0.0, form.name
        # Errors on the input are fitted to first order, and certain speeds are a little smaller than measured ones.
        assert rms(carried_out(form, values) - fitted) < 0.03 * rms(fitted), (form.name, form.equation)


@pytest.mark.parametrize("effect", known_effects(), ids=lambda effect: effect.id)
def test_each_equation_names_each_parameter_and_explains_its_words(effect: Effect) -> None:
    general = {"x", "v", "a", "t", "y", "z", "s"}
    for form in effect.forms(scene()):
        own = {name for name in (*form.coefficients, *form.shapes) if not name.startswith("_")}
        used = set(re.findall(r"[a-z]\w*", form.equation))
        assert own <= used, form.name
        if form.name not in IMPLICIT:
            plain = re.sub(
                r", (in the (?:elastic part|part with memory) alone|and (.*) more in the elastic part)",
                r" \2",
                form.equation,
            )
            unknown = (
                set(re.findall(r"[a-z]\w*", plain))
                - own
                - NUMPYS
                - general
                - set(WORDS)
                - set(scene().signals.channels)
            )
            assert not unknown, (form.name, unknown)


def test_words_that_explain_others_are_explained() -> None:
    told = explained(["y += softening * losses"])
    assert [line.split(":")[0] for line in told] == ["y_memory", "losses"]
