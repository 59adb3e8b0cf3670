"""Which of several explanations is the simplest that does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hystbench.diagnosis import registry
from hystbench.diagnosis.emulation import SimulatorScene, emulate
from hystbench.diagnosis.evidence import Evidence, Term
from hystbench.diagnosis.operators import plays
from hystbench.diagnosis.parsimony import fewest
from hystbench.diagnosis.signals import Signals


@pytest.mark.parametrize(("power", "named"), [(0.95, {"thermal_drift"}), (0.85, {"thermal_drift", "cyclic_softening"})])
def test_a_second_effect_is_not_named_for_what_the_first_ones_law_hardly_misses(power: float, named: set[str]) -> None:
    """The gap grows with a power of time; the laws to choose from are a straight line and a square root."""
    time = np.arange(3000) * 0.01
    x = np.sin(1.9 * time) * (0.6 + 0.3 * np.sin(0.3 * time)) + 0.2 * np.sin(5.2 * time)
    sim = 4.0 * x + 2.0 * (x - plays(x, np.array([0.1]))[:, 0])
    grown = time / time[-1]
    gap = x * grown**power
    noise = np.std(gap) / 16.0 * np.random.default_rng(1).standard_normal(x.size)
    recorded = Signals(time, x, sim + gap + noise, sim, [slice(0, x.size)], {})
    evidence = Evidence(SimulatorScene(recorded, emulate(recorded, None)))
    terms = []
    for name, exponent in (("thermal_drift", 1.0), ("cyclic_softening", 0.5)):
        effect = registry.get(name)()
        law = replace(
            effect.forms(evidence.scene)[0], columns=lambda _, __, k=exponent: (x * grown**k)[:, None],
            lower=(-np.inf,), upper=(np.inf,),
        )  # fmt: skip
        terms.append(Term(effect, law, ()))
    both, one, none = (evidence.fit(terms[:count], evidence.exact) for count in (2, 1, 0))
    both.beside_exact = replace(both)
    # The second is significant in any case: what is asked is whether it is worth naming.
    assert both.score > one.score + 50.0
    energy = float(np.mean(np.square(evidence.gap))) - evidence.sigma**2
    assert fewest(evidence, [both, one, none], both, energy).names == named
