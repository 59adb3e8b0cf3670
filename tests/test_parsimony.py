"""Which of several explanations is the simplest that does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hystbench.diagnosis import registry
from hystbench.diagnosis.emulator.emulation import SimulatorScene, emulate
from hystbench.diagnosis.hypotheses.adequacy import emulated
from hystbench.diagnosis.hypotheses.evidence import Evidence, Term, is_refitted
from hystbench.diagnosis.operators.memory import plays
from hystbench.diagnosis.recording.signals import Signals
from hystbench.diagnosis.verdict.own_errors import rather_errors, rather_two
from hystbench.diagnosis.verdict.parsimony import fewest

TIME = np.arange(3000) * 0.01
X = np.sin(1.9 * TIME) * (0.6 + 0.3 * np.sin(0.3 * TIME)) + 0.2 * np.sin(5.2 * TIME)
STOP = X - plays(X, np.array([0.1]))[:, 0]


def as_law(evidence: Evidence, name: str, column: np.ndarray, law_name: str = "a column") -> Term:
    """An effect whose law is ``column`` (n,) in any size, of either sign."""
    effect = registry.get(name)()
    law = replace(
        effect.forms(evidence.scene)[0], columns=lambda _, __: column[:, None], coefficients=("_size",),
        shapes=(), lower=(-np.inf,), upper=(np.inf,), name=law_name,
    )  # fmt: skip
    return Term(effect, law, ())


@pytest.mark.parametrize(("names", "allowed"), [((), True), (("backlash",), True), (("viscous_friction",), False)])
def test_what_the_emulator_lacks_is_forgiven_where_it_is_asked(names: tuple[str, ...], allowed: bool) -> None:
    sim = 4.0 * X + 2.0 * STOP
    noise = 0.02 * np.random.default_rng(1).standard_normal(X.size)
    recorded = Signals(TIME, X, 1.04 * sim + noise, sim, [slice(0, X.size)], {})
    inexact = replace(emulate(recorded, None), error=0.01)
    evidence = Evidence(SimulatorScene(recorded, inexact))
    energy = float(np.mean(np.square(evidence.gap))) - evidence.sigma**2
    terms = [as_law(evidence, name, X) for name in names]
    # A hundredth of what the simulator says, but no more than a tenth of the gap.
    assert 0.01 * np.std(sim) > 0.1 * np.sqrt(energy)
    expected = 0.1 * np.sqrt(energy) / evidence.sigma if allowed else 0.0
    assert emulated(evidence, evidence.fit(terms, ((0.06, 0.1),)), energy) == pytest.approx(expected)


@pytest.mark.parametrize(("power", "named"), [(0.95, {"thermal_drift"}), (0.85, {"thermal_drift", "cyclic_softening"})])
def test_a_second_effect_is_not_named_for_what_the_first_ones_law_hardly_misses(power: float, named: set[str]) -> None:
    """The gap grows with a power of time; the laws to choose from are a straight line and a square root."""
    sim = 4.0 * X + 2.0 * STOP
    grown = TIME / TIME[-1]
    gap = X * grown**power
    noise = np.std(gap) / 16.0 * np.random.default_rng(1).standard_normal(X.size)
    recorded = Signals(TIME, X, sim + gap + noise, sim, [slice(0, X.size)], {})
    evidence = Evidence(SimulatorScene(recorded, emulate(recorded, None)))
    named_by = (("thermal_drift", 1.0), ("cyclic_softening", 0.5))
    terms = [as_law(evidence, name, X * grown**exponent) for name, exponent in named_by]
    both, one, none = (evidence.fit(terms[:count], evidence.exact) for count in (2, 1, 0))
    both.beside_exact = replace(both)
    # The second is significant in any case: what is asked is whether it is worth naming.
    assert both.score > one.score + 50.0
    energy = float(np.mean(np.square(evidence.gap))) - evidence.sigma**2
    assert fewest(evidence, [both, one, none], both, energy).names == named


@pytest.mark.parametrize(
    ("factor", "size", "second", "both"),
    [
        (0.2, 1.0, X * STOP, True),
        (0.05, 0.1, np.abs(X) * X, False),
        (0.03, 0.3, np.abs(X) * X, True),
        (0.03, 0.05, np.abs(X) * X, False),
    ],
    ids=["better", "hardly better", "hardly better, but simple", "simple, but one of them is little"],
)
def test_two_effects_come_before_a_simulator_that_is_off_where_it_does_not_do_nearly_as_well(
    factor: float, size: float, second: np.ndarray, both: bool
) -> None:
    """A gain and another effect, which errors of the simulator imitate, the better the more the effect is a part of it."""
    sim = 4.0 * X + X**3 + 2.0 * STOP
    gap = factor * sim + size * second
    noise = np.std(gap) / 8.0 * np.random.default_rng(1).standard_normal(X.size)
    recorded = Signals(TIME, X, sim + gap + noise, sim, [slice(0, X.size)], {})
    evidence = Evidence(SimulatorScene(recorded, emulate(recorded, None)))
    terms = [as_law(evidence, *each) for each in (("torque_gain", sim), ("stiffness_asymmetry", second))]
    blank, *found = (evidence.fit(some) for some in ([], *([term] for term in terms), terms))
    for hypothesis in found:
        hypothesis.beside_exact = evidence.fit(hypothesis.terms, evidence.exact)
    energy = float(np.mean(np.square(evidence.gap))) - evidence.sigma**2
    chosen = rather_two(evidence, [blank, *found], blank, energy)
    assert found[-1].beside_exact.score > blank.score
    assert chosen.names == (found[-1].names if both else frozenset())


@pytest.mark.parametrize(
    ("second", "size", "named"),
    [
        (0.16 * X - 0.05 * X**3 + 0.06 * STOP, 1.0, {"viscous_friction"}),
        (np.abs(X), 0.1, {"viscous_friction", "stiffness_asymmetry"}),
    ],
    ids=["what errors make", "what they do not make"],
)
def test_a_second_effect_is_not_named_for_what_errors_of_the_simulator_make_as_well(
    second: np.ndarray, size: float, named: set[str]
) -> None:
    sim = 4.0 * X + X**3 + 2.0 * STOP
    first = np.gradient(X, TIME)
    gap = 0.05 * first + size * second
    noise = 0.01 * np.random.default_rng(1).standard_normal(X.size)
    recorded = Signals(TIME, X, sim + gap + noise, sim, [slice(0, X.size)], {})
    evidence = Evidence(SimulatorScene(recorded, emulate(recorded, None)))
    terms = [as_law(evidence, "viscous_friction", first), as_law(evidence, "stiffness_asymmetry", second)]
    found = [evidence.fit(terms[:count]) for count in (0, 1, 2)]
    # The second law is off by what is hardly seen.
    beside = second + 0.0018 / size * np.cos(3.0 * TIME)
    terms[1] = as_law(evidence, "stiffness_asymmetry", beside, "another column")
    both = evidence.fit(terms, evidence.exact)
    assert both.score > found[1].score
    best = rather_errors(evidence, found, both)
    assert best.names == named
    assert is_refitted(best.scale) == (len(named) == 1)
