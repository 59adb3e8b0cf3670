"""What evidence is worth: on long recordings, on what one block alone shows, and where little is left to explain."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from joints import sliders
from motions import swelling
from numpy.typing import NDArray

from hystbench.diagnosis import registry
from hystbench.diagnosis.diagnosis import diagnose
from hystbench.diagnosis.emulator.emulation import SimulatorScene, emulate
from hystbench.diagnosis.hypotheses.evidence import Evidence, Term
from hystbench.diagnosis.hypotheses.heldout import closed_share, held_out
from hystbench.diagnosis.hypotheses.refinement import refine
from hystbench.diagnosis.recording.signals import Signals

Floats = NDArray[np.float64]
NOISE = 0.01


def joint(x: Floats) -> Floats:
    return 4.0 * x + 0.6 * x**3 + sliders(x, ((6.0, 0.12), (2.0, 0.15), (0.8, 0.16)))


def motion(size: int, seconds: float = 40.0) -> tuple[Floats, Floats]:
    return swelling(size, seconds / size)


def signals(time: Floats, x: Floats, y_real: Floats, y_sim: Floats | None = None) -> Signals:
    noise = NOISE * np.random.default_rng(3).standard_normal(x.size)
    return Signals(time, x, y_real + noise, joint(x) if y_sim is None else y_sim, [slice(0, x.size)], {})


def scene_of(made: Signals) -> SimulatorScene:
    return SimulatorScene(made, emulate(made, None))


def term(scene: SimulatorScene, effect: str, law: str, shape: tuple[float, ...] = ()) -> Term:
    plugin = registry.get(effect)()
    return Term(plugin, next(form for form in plugin.forms(scene) if form.name == law), shape)


@pytest.mark.parametrize("effect", ["torque_offset", "viscous_friction"])
def test_evidence_does_not_grow_with_the_sampling_rate(effect: str) -> None:
    brought = []
    for size in (8_000, 32_000):
        time, x = motion(size)
        scene = scene_of(signals(time, x, joint(x) + 0.02 + 0.02 * np.gradient(x, time)))
        evidence = Evidence(scene)
        law = registry.get(effect)().forms(scene)[0].name
        brought.append(evidence.fit((term(scene, effect, law),)).score - evidence.fit(()).score)
    assert brought[0] > 100.0
    # Four times the samples would bring four times as much.
    assert brought[1] == pytest.approx(brought[0], rel=0.4)


def test_what_one_block_alone_shows_is_not_predicted_from_the_others() -> None:
    time = np.arange(4000) * 0.01
    # A stop that is met slowly many times and once at speed: its damping shows in a single block.
    x = 0.9 * np.sin(2 * np.pi * 0.1 * time)
    hit = (time > 20.2) & (time < 20.5)
    x = np.where(hit, x + 0.5 * np.sin(np.pi * (time - 20.2) / 0.3), x)
    speed = np.gradient(x, time)
    beyond = np.maximum(x - 0.5, 0.0)
    real = joint(x) + 6.0 * beyond + np.where(hit & (beyond > 0.0) & (speed > 1.0), 0.8 * speed, 0.0)
    made = signals(time, x, real)
    scene = scene_of(made)
    stop = term(scene, "end_stop", "upper", (0.5,))

    def columns(of: SimulatorScene, shape: tuple[float, ...]) -> Floats:
        # Beyond the stop the other blocks show next to nothing of it.
        share = np.where(of.signals.speed > 1.0, 1.0, 1e-7)
        fast = np.where(of.signals.x > shape[0], share * of.signals.speed, 0.0)
        return np.column_stack([np.maximum(of.signals.x - shape[0], 0.0), fast])

    form = replace(
        stop.form, columns=columns, coefficients=("stiffness", "damping"), lower=(-np.inf,) * 2, upper=(np.inf,) * 2
    )
    evidence = Evidence(scene)
    hypothesis = evidence.fit((replace(stop, form=form),), ((0.0, 0.0),))
    held = held_out(evidence, hypothesis, 0)
    _, closed, _ = closed_share(made.gap, made.gap - held.signal, NOISE, 0)
    assert 0.8 < closed <= 1.0
    # The blow itself is foretold by nothing.
    assert np.max(np.abs(held.signal[hit])) < 6.0 * np.max(beyond) + 0.1


def test_a_stop_met_once_does_not_hide_behind_what_is_always_there() -> None:
    time, x = motion(3000, 30.0)
    # Only the last samples reach the stop; blocks that suit the inertia would keep all of them from every fit.
    x = x + 4.0 * np.maximum(time - 29.4, 0.0) ** 2
    beyond = np.maximum(x - np.sort(x)[-10], 0.0)
    assert np.flatnonzero(beyond)[0] == 2991
    acceleration = np.gradient(np.gradient(x, time), time)
    found = diagnose(signals(time, x, joint(x) + 0.008 * acceleration + beyond / np.max(beyond)))
    assert set(found.verdict) == {"inertia", "end_stop"}
    assert found.choice.features["closed"] > 0.9


def moves_and_rests(size: int, seed: int) -> tuple[Floats, Floats]:
    rng, x, at, k = np.random.default_rng(seed), np.zeros(size), 0.0, 50
    while k < size:
        to, moving, resting = rng.uniform(-0.9, 0.9), int(rng.uniform(20, 120)), int(rng.uniform(20, 100))
        way = 0.5 - 0.5 * np.cos(np.pi * np.arange(1, moving + 1) / moving)
        x[k:] = to
        x[k : k + moving] = (at + (to - at) * way)[: size - k]
        at, k = to, k + moving + resting
    return np.arange(size) * 0.01, x


def test_little_that_is_left_does_not_call_for_company() -> None:
    # Friction that flips within a sample and keeps its direction at rest: a few samples at each turn fit no smooth law.
    time, x = moves_and_rests(4000, 2)
    way = np.sign(np.diff(x, prepend=0.0))
    last = np.maximum.accumulate(np.where(way != 0.0, np.arange(way.size), 0))
    found = diagnose(signals(time, x, joint(x) + 0.16 * way[last]))
    assert found.verdict == ["coulomb_friction"]


def test_half_cycles_are_counted_and_a_dither_is_none() -> None:
    time, x = motion(4000)
    rng = np.random.default_rng(1)
    dither = 0.01 * np.sin(2 * np.pi * 7.0 * time) + 1e-4 * rng.standard_normal(time.size)
    calm, shaken = signals(time, x, joint(x)), signals(time, x + dither, joint(x + dither))
    turns = calm.reversals[-1]
    assert 24 <= turns <= 60
    assert shaken.reversals[-1] == pytest.approx(turns, abs=4)
    assert np.all(np.diff(calm.reversals) >= 0.0)


def test_softening_by_the_logarithm_of_half_cycles_is_named() -> None:
    time, x = motion(4000)
    count = np.cumsum(np.abs(np.diff(np.sign(np.gradient(x)), prepend=1.0)) > 1.0)
    real = joint(x) * (1.0 - 0.06 * np.log1p(count / 3.0))
    assert diagnose(signals(time, x, real)).verdict == ["cyclic_softening"]
    # Travel passes for half cycles here; the law itself finds what was put in, where every turn is a full one.
    x = 0.9 * np.sin(2 * np.pi * 0.5 * time)
    count = np.floor(time + 0.5)
    scene, exact = scene_of(signals(time, x, joint(x) * (1.0 - 0.06 * np.log1p(count / 3.0)))), ((0.0, 0.0),)
    evidence = Evidence(scene)
    start = evidence.fit((term(scene, "cyclic_softening", "logarithm of reversals", (8.0,)),), exact)
    named = refine(evidence, start, 20, exact).parameters("cyclic_softening")
    assert named["softening"] == pytest.approx(0.06, rel=0.1)
    assert named["reversals_constant"] == pytest.approx(3.0, rel=0.25)


def test_wear_by_every_turn_is_named_where_many_are_small() -> None:
    time, x = motion(4000)
    x = x + 0.03 * np.sin(2.0 * np.pi * 5.0 * time) * (np.sin(0.55 * time) > 0.0)
    way = np.sign(np.diff(x, append=x[-1]))
    count = np.cumsum(way[1:] * way[:-1] < 0.0, dtype=float)
    recorded = signals(time[1:], x[1:], joint(x)[1:] * (1.0 - 0.1 * count / count[-1]))
    assert recorded.turns[-1] > 2.0 * recorded.reversals[-1]
    found = diagnose(recorded)
    assert found.verdict == ["cyclic_softening"]
    assert found.effects[0].law == "power of turns"


def test_limits_that_differ_much_are_one_saturation() -> None:
    time, x = motion(4000)
    found = diagnose(signals(time, x, np.clip(joint(x), -1.2, 2.6)))
    assert found.verdict == ["torque_saturation"]
    limits = found.choice.hypothesis.parameters("torque_saturation")
    assert limits["limit"] == pytest.approx(2.6, rel=0.02)
    assert limits["limit_below"] == pytest.approx(1.2, rel=0.02)
