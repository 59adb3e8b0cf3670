"""How precisely the effects' parameters are known: intervals hold what is true as often as they say."""

from __future__ import annotations

import numpy as np
import pytest
from joints import sliders
from numpy.typing import NDArray
from scipy.signal import lfilter

from hystbench.diagnosis import registry
from hystbench.diagnosis.corrected import calibrated, formula
from hystbench.diagnosis.diagnosis import diagnose
from hystbench.diagnosis.emulator.emulation import SimulatorScene, emulate
from hystbench.diagnosis.hypotheses.evidence import Evidence, Term
from hystbench.diagnosis.hypotheses.precision import intervals, told
from hystbench.diagnosis.hypotheses.refinement import polish, refine
from hystbench.diagnosis.recording.signals import Signals

Floats = NDArray[np.float64]
NOISE = 0.02
TIME = np.arange(3000) * 0.01
X = np.sin(2 * np.pi * 0.31 * TIME) * (0.6 + 0.3 * np.sin(2 * np.pi * 0.047 * TIME)) + 0.2 * np.sin(5.2 * TIME)
SPEED = np.gradient(X, TIME)
DAMPING, POWER, FRICTION = 0.06, 1.3, 0.08
DRAWS = 20


def joint(x: Floats) -> Floats:
    return 4.0 * x + 0.6 * x**3 + sliders(x, ((6.0, 0.12), (2.0, 0.15), (0.8, 0.16)))


def signals(y_real: Floats, noise: Floats) -> Signals:
    return Signals(TIME, X, y_real + noise, joint(X), [slice(0, X.size)], {})


def white(rng: np.random.Generator) -> Floats:
    return NOISE * rng.standard_normal(X.size)


def coloured(rng: np.random.Generator) -> Floats:
    """Of the same size, with a correlation time of ten samples."""
    keep = np.exp(-0.1)
    return lfilter([NOISE * np.sqrt(1.0 - keep**2)], [1.0, -keep], rng.standard_normal(X.size + 100))[100:]


@pytest.mark.parametrize("noise", [white, coloured])
def test_intervals_hold_the_truth_as_often_as_they_say(noise) -> None:  # type: ignore[no-untyped-def]
    truth = {"damping": DAMPING, "power": POWER}
    held = dict.fromkeys(truth, 0)
    effect = registry.get("viscous_friction")()
    for draw in range(DRAWS):
        real = joint(X) + DAMPING * np.abs(SPEED) ** POWER * np.sign(SPEED)
        recorded = signals(real, noise(np.random.default_rng(draw)))
        evidence = Evidence(SimulatorScene(recorded, emulate(recorded, None)))
        form = next(form for form in effect.forms(evidence.scene) if form.name == "power law")
        start = evidence.fit((Term(effect, form, (1.0,)),), evidence.exact)
        fitted = polish(evidence, refine(evidence, start, 20, evidence.exact))
        found = intervals(evidence, fitted)["viscous_friction"]
        for name, value in truth.items():
            low, high = found[name] or (-np.inf, np.inf)
            held[name] += low <= value <= high
            # Twenty times wider would hold it always.
            assert high - low < 0.3 * value
    # 95 % of 20 are 19; fewer than 16 come by chance once in four hundred.
    assert min(held.values()) >= 16


@pytest.mark.thorough(but_one_in=3)
@pytest.mark.parametrize("draw", range(3))
def test_a_long_recording_is_used_whole_for_the_figures_of_the_verdict(draw: int) -> None:
    # Laws are compared on a part of it; a figure from that part would miss its interval three times too often.
    time = np.linspace(0.0, 30.0, 12_000)
    x = np.interp(time, TIME, X)
    speed = np.gradient(x, time)
    real = joint(x) + DAMPING * np.abs(speed) ** 1.43 * np.sign(speed)
    noise = NOISE * np.random.default_rng(draw).standard_normal(x.size)
    found = diagnose(Signals(time, x, real + noise, joint(x), [slice(0, x.size)], {}))
    assert found.verdict == ["viscous_friction"]
    low, high = found.parameter_intervals["viscous_friction"]["power"] or (0.0, np.inf)
    best = found.choice.hypothesis
    (term,) = best.terms
    for step in (-0.125, 0.125):
        # Half a standard error to either side.
        moved = Term(term.effect, term.form, (term.shape[0] + step * (high - low),), term.laws)
        assert found.evidence.fit((moved,), (best.scale,)).rss > best.rss


def test_a_limit_that_was_never_reached_is_not_determined() -> None:
    top = 0.75 * float(np.max(joint(X)))
    soft = np.where(joint(X) > 0.0, joint(X) / (1.0 + np.abs(joint(X) / top) ** 8) ** (1.0 / 8.0), joint(X))
    found = diagnose(signals(soft, white(np.random.default_rng(1))))
    assert found.verdict == ["torque_saturation"]
    known = found.parameter_intervals["torque_saturation"]
    low, high = known["limit"] or (0.0, 0.0)
    assert low < top < high
    assert high - low < 0.1 * top
    assert known["limit_below"] is None
    assert "not determined by this recording" in formula(found, calibrated(found, None))


@pytest.mark.parametrize(
    ("ends", "words"),
    [
        ((157.233, 157.373), "157.23 to 157.37"),
        ((0.1, 0.2), "0.1 to 0.2"),
        ((-0.0043, 0.0104), "-0.0043 to 0.0104"),
        (None, "not determined by this recording"),
    ],
)
def test_an_interval_has_the_digits_that_tell_its_ends_apart(ends: tuple[float, float] | None, words: str) -> None:
    assert told(ends) == words


def test_every_figure_of_the_verdict_has_its_interval() -> None:
    friction = FRICTION * np.tanh(SPEED / 0.01)
    found = diagnose(signals(joint(X) + DAMPING * SPEED + friction, white(np.random.default_rng(3))))
    assert set(found.verdict) == {"viscous_friction", "coulomb_friction"}
    entries = {entry["name"]: entry for entry in found.document()["effects"]}
    for name in found.verdict:
        known = entries[name]["parameter_intervals"]
        assert set(known) == set(entries[name]["parameters"])
        for parameter, value in entries[name]["parameters"].items():
            if known[parameter] is not None:
                low, high = known[parameter]
                assert low <= value * (1.0 + 1e-5)
                assert high >= value * (1.0 - 1e-5)
    assert not any(entry["parameter_intervals"] for name, entry in entries.items() if name not in found.verdict)
