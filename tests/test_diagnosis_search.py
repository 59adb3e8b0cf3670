"""The search for laws: no effect falls behind for the law that it began with."""

from __future__ import annotations

import numpy as np
import pytest
from hardening_joint import rich_motion, signals_of, spring
from numba import njit
from numpy.typing import NDArray
from simulators import motion

from hystbench.diagnosis import registry
from hystbench.diagnosis.corrected import calibrated, corrected_simulator
from hystbench.diagnosis.diagnosis import diagnose
from hystbench.diagnosis.effects.base import Form
from hystbench.diagnosis.emulator.emulation import SimulatorScene, emulate
from hystbench.diagnosis.hypotheses.evidence import Evidence, Term
from hystbench.diagnosis.hypotheses.library import Library
from hystbench.diagnosis.hypotheses.search import _behind_other_laws, _with_a_law_at_hand, search
from hystbench.diagnosis.recording.signals import Signals

Floats = NDArray[np.float64]


@njit(cache=True)
def tensioner(time: Floats, x: Floats, compliance: float, constant: float, steps: int = 8) -> Floats:
    """A preloaded arm that rubs by what it carries, on a belt that creeps under what it carries more than at rest."""
    slid, crept, last, torque, out = 0.0, 0.0, x[0], 3.6, np.zeros(x.size)
    for i in range(x.size):
        for k in range(1, steps + 1):
            before = x[max(i - 1, 0)]
            crept += (time[1] - time[0]) / steps / constant * (compliance * (torque - 3.6) - crept)
            place = before + (x[i] - before) * k / steps - crept
            towards = np.sign(place - last)
            slid = towards + (slid - towards) * np.exp(-abs(place - last) / 0.07) if place != last else slid
            last = place
            torque = 4.0 * (0.9 + place) * (1.0 + 0.1 * slid)
        out[i] = torque
    return out


def form(effect: str, name: str, evidence: Evidence) -> Form:
    return next(form for form in evidence.forms_of(registry.get(effect)()) if form.name == name)


@pytest.mark.parametrize(("place", "better"), [("distance", "linear, by distance"), ("position", None)])
def test_in_company_an_effect_takes_the_law_that_is_best_there(place: str, better: str | None) -> None:
    time, x = rich_motion()
    speed, far = np.gradient(x, time), x / np.max(np.abs(x))
    damping = 0.05 * speed * (0.5 + (np.abs(far) if place == "distance" else 0.4 * far))
    recorded = signals_of(time, x, spring(x) + damping + 0.1, spring(x))
    evidence = Evidence(SimulatorScene(recorded, emulate(recorded, None)))
    laws = ("viscous_friction", "linear, by position"), ("torque_offset", "constant")
    pair = evidence.fit([Term(registry.get(name)(), form(name, law, evidence), ()) for name, law in laws])
    found = _with_a_law_at_hand(evidence, pair)
    assert (found and found.terms[0].form.name) == better
    assert found is None or found.score > pair.score


def test_in_company_bristles_become_a_slider_where_that_is_better() -> None:
    time, x = rich_motion()
    slider = np.zeros(x.size)
    for k in range(1, x.size):
        slider[k] = np.clip(slider[k - 1] + 5.0 * (x[k] - x[k - 1]), -0.3, 0.3)
    recorded = signals_of(time, x, spring(x) + slider + 0.1, spring(x))
    evidence = Evidence(SimulatorScene(recorded, emulate(recorded, None)))
    laws = ("coulomb_friction", "presliding", (0.05,)), ("torque_offset", "constant", ())
    pair = evidence.fit([Term(registry.get(name)(), form(name, law, evidence), shape) for name, law, shape in laws])
    found = _with_a_law_at_hand(evidence, pair)
    assert found is not None
    assert found.score > pair.score
    assert found.terms[0].form.name == "elastic presliding"
    assert found.terms[0].shape == pytest.approx((0.06,), rel=0.05)


@pytest.mark.parametrize(
    ("compliance", "constant", "begun", "law"),
    [
        (0.03, 5.0, 0.0, "creep in series"),
        (0.08, 1.7, 0.0, "creep in series"),
        (0.15, 0.5, 0.0, "creep in series"),
        (0.03, 1.7, 0.4, "creep in series, since the start"),
    ],
)
def test_what_creeps_in_series_with_a_preloaded_joint_is_found_from_what_a_little_of_it_would_do(
    compliance: float, constant: float, begun: float, law: str
) -> None:
    time, x = motion(40.0, 0.0, 1.0, 2.0)
    x = x + begun
    y_sim = tensioner(time, x, 0.0, 1.0)
    y = tensioner(time, x, compliance, constant)
    noise = np.std(y - y_sim) / 16.0 * np.random.default_rng(1).standard_normal(x.size)
    recorded = Signals(time, x, y + noise, y_sim, [slice(0, x.size)], {})
    evidence = Evidence(SimulatorScene(recorded, emulate(recorded, None)))
    found = search(Library(evidence, [registry.get("stress_relaxation")()]))
    best = max(found, key=lambda hypothesis: hypothesis.score)
    (term,) = best.terms
    # Where the motion begins at rest both laws are the same.
    assert term.form.name.startswith("creep in series" if begun == 0.0 else law)
    assert term.shape == pytest.approx((constant, compliance), rel=0.1)
    assert best.rss < 1.15 * evidence.size * evidence.sigma**2
    if constant == 1.7:
        told = diagnose(recorded)
        assert told.verdict == ["stress_relaxation"]
        # It creeps under the torque that it leaves, which is not known beforehand.
        corrected = corrected_simulator(told, calibrated(told, None))
        assert np.std(corrected.predict(x) - recorded.y_real) < 1.2 * told.noise_floor


def test_laws_that_start_from_none_that_was_refined_are_looked_at() -> None:
    time, x = motion(40.0, 0.0, 1.0, 2.0)
    y_sim, y = tensioner(time, x, 0.0, 1.0), tensioner(time, x, 0.08, 1.7)
    noise = np.std(y - y_sim) / 16.0 * np.random.default_rng(1).standard_normal(x.size)
    recorded = Signals(time, x, y + noise, y_sim, [slice(0, x.size)], {})
    library = Library(
        Evidence(SimulatorScene(recorded, emulate(recorded, None))), [registry.get("stress_relaxation")()]
    )
    # As if another law had led, and what a little creep does had not been refined.
    number = next(k for k, term in enumerate(library.terms) if term.form.name == "one branch")
    fitted = library.evidence.fit([library.terms[number]])
    ((found, _),) = _behind_other_laws(library, [(fitted.score, (number,))], {fitted.names: (fitted, (number,))})
    assert found.terms[0].form.name.startswith("creep in series")
    assert found.terms[0].shape == pytest.approx((1.7, 0.08), rel=0.1)
    assert found.score > fitted.score
