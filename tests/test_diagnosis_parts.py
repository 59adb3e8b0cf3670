"""The diagnosis' parts against independent references: fits, folds, shares, motions, scores, seals."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import lsq_linear

from hystbench.diagnosis import registry
from hystbench.diagnosis.attribution import locate, profile
from hystbench.diagnosis.emulator.emulation import SimulatorScene, emulate
from hystbench.diagnosis.emulator.selection import Selection
from hystbench.diagnosis.excitation import Limits, candidate_motions
from hystbench.diagnosis.hypotheses.boxed import boxed_least_squares
from hystbench.diagnosis.hypotheses.evidence import Evidence, Term, effect_columns
from hystbench.diagnosis.hypotheses.heldout import _folds, closed_share
from hystbench.diagnosis.hypotheses.refinement import refine
from hystbench.diagnosis.operators.memory import bristle, lowpass, plays
from hystbench.diagnosis.recording.noise import structured_power
from hystbench.diagnosis.recording.signals import Signals


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10_000), k=st.integers(1, 2))
def test_boxed_least_squares_is_the_bounded_minimum(seed: int, k: int) -> None:
    rng = np.random.default_rng(seed)
    columns, target = rng.standard_normal((30, k)), rng.standard_normal(30)
    lower, upper = np.full(k, -0.1), np.full(k, 0.15)
    beta, reduction = boxed_least_squares((columns.T @ columns)[None], (columns.T @ target)[None], lower, upper)
    reference = lsq_linear(columns, target, (lower, upper), tol=1e-12)
    assert np.all(beta[0] >= lower - 1e-9)
    assert np.all(beta[0] <= upper + 1e-9)
    rss = target @ target - reduction[0]
    assert rss == pytest.approx(np.sum((target - columns @ beta[0]) ** 2), rel=1e-6)
    assert rss <= 2.0 * reference.cost * (1.0 + 2e-3)


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10_000), k=st.integers(2, 8))
def test_boxed_least_squares_of_many_free_unknowns_is_that_of_numpy(seed: int, k: int) -> None:
    rng = np.random.default_rng(seed)
    columns = rng.standard_normal((3, 40, k)) * 10.0 ** rng.uniform(-3.0, 3.0, k)
    target = rng.standard_normal((3, 40))
    free = np.full(k, np.inf)
    grams, moments = columns.transpose(0, 2, 1) @ columns, np.einsum("mnk,mn->mk", columns, target)
    beta, reduction = boxed_least_squares(grams, moments, -free, free)
    for rows, wanted, found, less in zip(columns, target, beta, reduction, strict=True):
        reference = np.linalg.lstsq(rows, wanted, rcond=None)[0]
        assert found == pytest.approx(reference, rel=1e-5, abs=1e-6 * np.max(np.abs(reference)))
        assert less == pytest.approx(wanted @ wanted - np.sum((wanted - rows @ reference) ** 2), rel=1e-6)


def test_elements_are_chosen_by_what_parts_of_a_recording_say_of_the_others() -> None:
    """The error by products is that by rows: each part predicted by weights that the others make best."""
    rng = np.random.default_rng(4)
    x = np.cumsum(rng.standard_normal(2000))
    x = 0.5 * x / np.max(np.abs(x))
    kinks = np.maximum(x[:, None] - np.linspace(-0.4, 0.4, 9), 0.0)
    elastic = np.column_stack([np.ones(x.size), x])
    target = 1.0 + 3.0 * x + 5.0 * kinks[:, 6] + 0.05 * rng.standard_normal(x.size)
    selection = Selection({"elastic": elastic, "kinks": kinks}, target, ())
    base = {"elastic": selection.places["elastic"]}
    fold = (np.arange(x.size) * 20 // x.size) % 4
    errors = []
    for k in range(4):
        weights = np.linalg.lstsq(elastic[fold != k], target[fold != k], rcond=None)[0]
        errors.append(np.sum((target - elastic @ weights)[fold == k] ** 2))
    assert selection.error(base) == pytest.approx(np.exp(0.5 * np.mean(np.log(errors))), rel=1e-3)
    at = selection.places["kinks"]
    assert selection.best_of(at, base) == [at[6]]
    grown = selection.grow(base, ["kinks"], ["kinks"])
    assert grown["kinks"].tolist() == [at[6]]


def test_equal_bounds_fix_a_coefficient() -> None:
    beta, _ = boxed_least_squares(
        np.eye(2)[None], np.array([[3.0, 3.0]]), np.array([1.0, -np.inf]), np.array([1.0, np.inf])
    )
    assert beta[0] == pytest.approx([1.0, 3.0])


def test_a_law_sees_the_torque_that_others_made_wherever_it_is_first_asked() -> None:
    """Corrections and other motions begin with the coefficients: nothing was asked of their simulator before."""
    time = np.arange(2000) * 0.01
    x = np.sin(1.9 * time) * (0.6 + 0.3 * np.sin(0.3 * time))
    recorded = Signals(time, x, 4.0 * x, 4.0 * x, [slice(0, x.size)], {})
    named = (("viscous_friction", ""), ("torque_gain", ""), ("torque_saturation", "hard"))
    scene = SimulatorScene(recorded, emulate(recorded, None))
    terms = []
    for name, law in named:
        effect = registry.get(name)()
        form = next(form for form in effect.forms(scene) if law in ("", form.name))
        terms.append(Term(effect, form, form.grid[0]))
    viscous, _, limited = terms
    guess = np.concatenate([np.full(len(viscous.form.coefficients), 0.3), [0.2], [1.0]])
    made = effect_columns(SimulatorScene(recorded, scene.emulator), terms, guess)
    first = len(viscous.form.coefficients)
    damped = recorded.y_sim + made[:, :first] @ guess[:first]
    assert made[:, first] == pytest.approx(damped)
    raised = damped + 0.2 * made[:, first]
    limit = limited.shape[0]
    assert made[:, first + 1] == pytest.approx(np.clip(raised, -limit, limit) - raised)
    assert made[:, :first] == pytest.approx(effect_columns(scene, [viscous]))


def test_what_a_law_remembers_of_the_torque_counts_as_asking_for_it() -> None:
    time = np.arange(500) * 0.01
    x = np.sin(3.0 * time)
    scene = SimulatorScene(Signals(time, x, x, 2.0 * x, [slice(0, x.size)], {}))

    def twice() -> np.ndarray:
        return scene.remembered("twice", lambda: 2.0 * scene.torque)[:, None]

    for law in ("first", "second"):
        assert scene.columns_of(law, (), twice)[:, 0] == pytest.approx(4.0 * x)
        assert scene.is_of_torque(law)
    scene.columns_of("third", (), lambda: scene.signals.x[:, None])
    assert not scene.is_of_torque("third")


def test_a_set_is_fitted_beside_an_exact_simulator_as_if_there_were_no_other() -> None:
    """A limit sees the torque that another effect made; beside a refitted simulator that is quite another torque."""
    time = np.arange(3000) * 0.01
    x = np.sin(1.9 * time) * (0.6 + 0.3 * np.sin(0.3 * time)) + 0.2 * np.sin(5.2 * time)
    sim = 4.0 * x + 2.0 * (x - plays(x, np.array([0.1]))[:, 0])
    real = np.clip(sim + 1.2 * np.minimum(x, 0.0), -3.3, 3.3) + 0.01 * np.random.default_rng(1).standard_normal(x.size)
    recorded = Signals(time, x, real, sim, [slice(0, x.size)], {})
    evidence = Evidence(SimulatorScene(recorded, emulate(recorded, None)))
    terms = []
    for name, law, shape in (("stiffness_asymmetry", "spring, lower side", ()), ("torque_saturation", "hard", (2.9,))):
        effect = registry.get(name)()
        form = next(form for form in effect.forms(evidence.scene) if form.name == law)
        terms.append(Term(effect, form, shape))
    among_all = evidence.fit(terms)
    assert among_all.scale not in evidence.exact
    for scale in evidence.exact:
        # The torque so far is that of the likeliest of these: another's own would do better by 1.3.
        assert among_all.by_scale[scale] >= evidence.fit(terms, (scale,)).score - 1.5


def test_shapes_are_refined_beside_a_law_without_torque_here() -> None:
    """As a limit that other effects leave no torque for."""
    time = np.arange(3000) * 0.01
    x = np.sin(1.9 * time) * (0.6 + 0.3 * np.sin(0.3 * time)) + 0.2 * np.sin(5.2 * time)
    sim = 4.0 * x + 2.0 * (x - plays(x, np.array([0.1]))[:, 0])
    real = sim + 0.3 * np.tanh(np.gradient(x, time) / 0.2)
    recorded = Signals(time, x, real, sim, [slice(0, x.size)], {})
    evidence = Evidence(SimulatorScene(recorded, emulate(recorded, None)))
    friction, limit = (registry.get(name)() for name in ("coulomb_friction", "torque_saturation"))
    law = next(form for form in friction.forms(evidence.scene) if form.shapes)
    beyond = replace(
        next(form for form in limit.forms(evidence.scene) if form.name == "hard"),
        columns=lambda scene, shape: np.zeros((x.size, 1)), lower=(-np.inf,), upper=(np.inf,),
    )  # fmt: skip
    start = evidence.fit([Term(friction, law, law.grid[0]), Term(limit, beyond, (3.0,))])
    refined = refine(evidence, start, 20)
    assert refined.score > start.score
    assert np.all(np.isfinite(refined.signal))


def test_evidence_beside_a_simulator_that_is_off_is_that_of_normal_errors_of_its_parameters() -> None:
    time = np.arange(1500) * 0.02
    x = np.sin(1.9 * time) * (0.6 + 0.3 * np.sin(0.3 * time)) + 0.2 * np.sin(5.2 * time)

    def joint(e: float) -> np.ndarray:
        return 4.0 * (1.0 + e) * x + 2.0 * (x - plays(x, np.array([0.1 * (1.0 - e)]))[:, 0])

    real = joint(0.05) + 0.02 * np.random.default_rng(1).standard_normal(x.size)
    recorded = Signals(time, x, real, joint(0.0), [slice(0, x.size)], {})
    emulator = emulate(recorded, None)
    evidence = Evidence(SimulatorScene(recorded, emulator))
    for scale in evidence.scales:
        tangents = np.hstack([scale[0] * emulator.structure, scale[1] * emulator.bulk]) / evidence.sigma
        covariance = np.eye(x.size) + tangents @ tangents.T
        assert evidence.complexity(scale) == pytest.approx(0.5 * np.linalg.slogdet(covariance)[1], abs=0.1)
        left = recorded.gap @ np.linalg.solve(covariance, recorded.gap)
        assert evidence.fit((), (scale,)).rss == pytest.approx(left, rel=1e-3)
        white = evidence.whitened(recorded.gap, scale)
        assert white @ white == pytest.approx(left, rel=1e-3)


def test_operators_match_their_definitions() -> None:
    x = np.cumsum(np.random.default_rng(2).standard_normal(200)) * 0.1
    at = 0.0
    for value, played in zip(x, plays(x, np.array([0.3]))[:, 0], strict=True):
        at = min(max(at, value - 0.3), value + 0.3)
        assert played == at
    ramp = np.linspace(0.0, 1.0, 2001)
    assert bristle(ramp, 0.1)[-1] == pytest.approx(1.0 - np.exp(-10.0), rel=1e-6)
    time = np.linspace(0.0, 2.0, 401)
    # A lag of τ follows a ramp τ behind, once the start has died away.
    assert lowpass(time, time, 0.1)[-1] == pytest.approx(2.0 - 0.1, abs=1e-6)


def test_folds_hold_out_every_sample_once_and_keep_their_distance() -> None:
    class Scene:
        torque = np.zeros(5000)

    class Fake:
        scene = Scene()

    counted = np.zeros(5000, dtype=int)
    for seen, out in _folds(Fake(), 12):  # type: ignore[arg-type]
        assert not np.any(seen & out)
        counted += out
        near = np.flatnonzero(out)
        for k in (near.min(), near.max()):
            assert not seen[max(k - 5, 0) : k + 6].any()
    assert np.all(counted == 1)


def test_structured_power_ignores_white_noise_and_measures_the_rest() -> None:
    rng = np.random.default_rng(3)
    noise = rng.standard_normal(40_000)
    wave = 2.0 * np.sin(np.arange(40_000) * 0.01)
    assert abs(structured_power(noise, [slice(0, noise.size)])) < 0.02
    assert structured_power(wave + noise, [slice(0, noise.size)]) == pytest.approx(2.0, rel=0.05)


def test_closed_share_counts_beyond_the_noise_and_brackets_itself() -> None:
    rng = np.random.default_rng(4)
    gap = np.sin(np.arange(20_000) * 0.01) + 0.1 * rng.standard_normal(20_000)
    half = gap - 0.5 * np.sin(np.arange(20_000) * 0.01)
    rmse, closed, (low, high) = closed_share(gap, half, 0.1, 0)
    assert closed == pytest.approx(0.75, abs=0.01)
    assert low <= closed <= high
    assert rmse == pytest.approx(np.sqrt(0.125 + 0.01), rel=0.02)


def test_closed_share_of_what_widens_the_gap_many_times_has_an_interval_about_itself() -> None:
    rng = np.random.default_rng(7)
    gap = rng.standard_normal(4000)
    _, closed, (low, high) = closed_share(gap, 12.0 * rng.standard_normal(4000), 0.1, 0)
    assert low < closed < high
    assert high - low < 0.2 * abs(closed)


def test_a_gap_is_drawn_at_each_direction_and_over_bins_of_a_deflection() -> None:
    rng = np.random.default_rng(6)
    direction, deflection = rng.choice([-1.0, 1.0], 900), rng.uniform(-1.0, 1.0, 900)
    places, means, rms = profile(direction, 2.0 * direction + 0.5)
    assert places.tolist() == [-1.0, 1.0]
    assert np.allclose([means, rms], [[-1.5, 2.5], [1.5, 2.5]])
    places, means, _ = profile(deflection, deflection, bins=9)
    assert places.size == 9
    assert np.allclose(means, places, atol=0.02)


def test_where_gives_a_drift_to_time_and_a_spring_to_position() -> None:
    time = np.arange(4000) * 0.01
    x = np.sin(time) + 0.4 * np.sin(2.7 * time)
    noise = 0.01 * np.random.default_rng(5).standard_normal(time.size)
    for added, coordinate in ((0.2 * np.sin(3.0 * x), "position"), (0.01 * time, "time")):
        signals = Signals(time, x, 4.0 * x + added + noise, 4.0 * x, [slice(0, time.size)], {})
        places = locate(signals, {}, 0.01, 0)
        shares = {place.coordinate: place.share for place in places}
        assert sum(shares.values()) == pytest.approx(1.0, abs=0.05)
        wanted = {"time", "travel"} if coordinate == "time" else {"position", "load"}
        assert places[0].coordinate in wanted
        assert sum(shares.get(name, 0.0) for name in wanted) > 0.6
        for place in places:
            assert place.interval[0] <= place.share <= place.interval[1]


@settings(max_examples=15, deadline=None)
@given(
    low=st.floats(-1.5, -0.2), high=st.floats(0.2, 1.5), speed=st.floats(0.3, 5.0), acceleration=st.floats(1.0, 40.0)
)
def test_designed_motions_keep_the_recorded_limits(low: float, high: float, speed: float, acceleration: float) -> None:
    limits = Limits(low, high, speed, acceleration, 0.01)
    for _, time, x in candidate_motions(limits):
        assert np.all(np.diff(time) > 0.0)
        assert x.min() >= low - 1e-9
        assert x.max() <= high + 1e-9
        assert np.max(np.abs(np.diff(x))) / 0.01 <= speed * 1.001
        assert np.max(np.abs(np.diff(x, 2))) / 0.01**2 <= acceleration * 1.05
