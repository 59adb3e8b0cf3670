"""The proposed Maxwell-slip model: the printed loop, its laws inside and outside it, its inverse, and what a fit finds."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from motions import DECAYING, NESTED, Floats, nrmse, through, turning_points

from hystbench import models
from hystbench.datasets import published_loop as paper
from hystbench.errors import InputError
from hystbench.models.maxwell_slip import virtual_deformation

MaxwellSlip = models.get("maxwell-slip")

PRINTED: dict[str, Any] = {
    "ascending": paper.ASCENDING,
    "descending": paper.DESCENDING,
    "transition_pos": paper.TRANSITION_POS,
    "transition_neg": paper.TRANSITION_NEG,
}


def printed() -> Any:
    return MaxwellSlip.from_parameters(**PRINTED)


def scattered(seed: int) -> tuple[Any, float]:
    """The printed loop stretched and with its vertices moved, both branches through the origin still; and its stroke.

    (Transitions are as short as in the print: where they are longer than the stroke no motion ever leaves them.)
    """
    rng = np.random.default_rng(seed)
    stretch = rng.uniform(0.5, 2.0, 2)
    curves = {}
    for name, curve in PRINTED.items():
        moved = np.array(sorted(np.asarray(curve).tolist()))
        gaps = np.diff(moved, axis=0)
        room = 0.15 * np.minimum(gaps[:-1], gaps[1:])
        fixed = (moved[1:-1] == 0.0).all(axis=1, keepdims=True)
        moved[1:-1] += np.where(fixed, 0.0, room * rng.uniform(-1.0, 1.0, room.shape))
        curves[name] = moved * stretch
    return MaxwellSlip.from_parameters(**curves), stretch[0]


def test_the_steady_loop_passes_every_vertex_of_tables_1_and_2() -> None:
    up, down = paper.upper_branch(), paper.lower_branch()[::-1]
    up, down = up[np.argsort(up[:, 0])], down[np.argsort(-down[:, 0])]
    first = np.array([paper.VERTICES[name] for name in "ABC"])
    path = np.concatenate([first, up[-4:], down[1:], up[1:], down[1:], up[1:]])
    y = printed().predict(path[:, 0])
    np.testing.assert_allclose(y, path[:, 1], atol=1e-9)
    assert {tuple(v) for v in path.tolist()} >= {tuple(map(float, v)) for v in paper.VERTICES.values()}
    # In between as well: each side of the loop is straight from vertex to vertex.
    dense = through([0.0, 1.0, -1.0, 1.0], 4000)
    wanted = np.interp(dense[4000:8001], *paper.lower_branch()[np.argsort(paper.lower_branch()[:, 0])].T)
    np.testing.assert_allclose(printed().predict(dense)[4000:8001], wanted, atol=1e-9)


def test_the_order_of_the_vertices_does_not_matter() -> None:
    x = through(NESTED, 50)
    turned = MaxwellSlip.from_parameters(**{name: np.asarray(curve)[::-1].tolist() for name, curve in PRINTED.items()})
    np.testing.assert_array_equal(turned.predict(x), printed().predict(x))


def test_the_ancestors_conditions_tell_that_the_printed_loop_breaks_them() -> None:
    broken = {c.name for c in printed().conditions_ if not c.holds}
    # DE (9.19) is steeper than k+ (8.47), and JK (9.54) than k- (8.85).
    assert {name for name in broken if "k+" in name}
    assert {name for name in broken if "k-" in name}


@given(turning_points(-1.0, 1.0))
def test_the_output_is_continuous_rises_with_the_input_and_ignores_the_sampling(turns: list[float]) -> None:
    model = printed()
    dense = through(turns, 200)
    y = model.predict(dense)
    moved = np.diff(dense) != 0.0
    slopes = np.diff(y)[moved] / np.diff(dense)[moved]
    assert np.all(slopes > 0.0)
    assert np.all(slopes < 40.0)
    np.testing.assert_allclose(y[::50], model.predict(through(turns, 4)), atol=1e-9)


@pytest.mark.parametrize("excursion", [[0.5, 0.2, 0.5], [0.5, 0.2, 0.4, 0.3, 0.4, 0.2, 0.5], [0.9, -0.9, 0.9]])
def test_minor_loops_close_and_leave_no_trace(excursion: list[float]) -> None:
    model = printed()
    to, end = excursion[0], [1.0, -1.0, 0.3]
    without = model.predict(through([0.0, 1.0, -1.0, to, *end], 100))
    with_loop = model.predict(through([0.0, 1.0, -1.0, *excursion, *end], 100))
    np.testing.assert_allclose(with_loop[-301:], without[-301:], atol=1e-9)


@given(turning_points(-1.2, 1.2))
def test_the_inverse_is_exact_on_the_printed_loop(turns: list[float]) -> None:
    model = printed()
    y = model.predict(through([0.0, *turns], 15))
    x = model.invert(y)
    np.testing.assert_allclose(model.predict(x), y, atol=1e-6 * max(float(np.ptp(y)), 1.0))


def test_the_inverse_of_arbitrary_torques_and_beyond_its_reach() -> None:
    model = printed()
    y = through([0.0, 4.9, -5.5, 3.0, 1.0, 2.5, -4.0, 0.0], 101)
    x = model.invert(y)
    np.testing.assert_allclose(model.predict(x), y, atol=1e-6)
    with pytest.raises(
        models.InverseError, match=r"no input within .* gives the output y\[1\] = 500.*approximate=True"
    ):
        model.invert([0.0, 500.0])
    near = model.predict(model.invert([0.0, 500.0], approximate=True))
    assert near[0] == pytest.approx(0.0, abs=1e-9)
    assert near[1] > 2.5


def test_geometry_maps_the_deflection_by_equation_6() -> None:
    l1, l3, x0 = 0.03, 0.05, 0.004
    theta = 0.5 * through([0.0, 1.0, -1.0, 0.6, -0.4], 80)
    h = virtual_deformation(theta, l1, l3, x0)
    second = np.sqrt(l1**2 + l3**2 - 2 * l1 * l3 * np.cos(theta[37]))
    assert h[37] == pytest.approx((12 * (l1 + second - l3) + x0) * l1 * l3 * np.sin(theta[37]) / second, rel=1e-12)
    scale = np.array([1.3 * np.max(np.abs(h)), 1.0])
    curves = {name: np.asarray(curve) * scale for name, curve in PRINTED.items()}
    plain = MaxwellSlip.from_parameters(**curves)
    mapped = MaxwellSlip.from_parameters(**curves, geometry=(l1, l3, x0))
    y = mapped.predict(theta)
    np.testing.assert_allclose(y, plain.predict(h), atol=1e-12)
    stepper = mapped.stepper()
    np.testing.assert_allclose([stepper.step(v) for v in theta], y, atol=1e-12)
    np.testing.assert_allclose(mapped.predict(mapped.invert(y)), y, atol=1e-6)
    found = MaxwellSlip(geometry=(l1, l3, x0)).fit(theta, y)
    assert nrmse(found.predict(theta), y) < 0.05


@pytest.mark.parametrize("seed", [0, 2, 5, 21, 28])
def test_own_kind_predicts_held_out_minor_loops(seed: int) -> None:
    truth, stretch = scattered(seed)
    train = stretch * through([0.0, 1.0, -1.0, 1.0, -1.0, *DECAYING[10:30]], 211)
    test = stretch * through(NESTED, 83)
    model = MaxwellSlip().fit(train, truth.predict(train))
    assert nrmse(model.predict(test), truth.predict(test)) < 1e-3


def test_the_printed_vertices_are_identified_from_the_loop() -> None:
    model = printed()
    x = through([0.0, 1.0, -1.0, 1.0, -1.0, 0.8, -0.6, 0.5, -0.4], 400)
    found = MaxwellSlip().fit(x, model.predict(x)).parameters_
    for name, curve in PRINTED.items():
        wanted = np.array(sorted(np.asarray(curve).tolist()))
        np.testing.assert_allclose(found[name], wanted, atol=0.02, err_msg=name)


def test_noise_several_runs_and_starts_inside_the_loop() -> None:
    model = printed()
    rng = np.random.default_rng(0)
    runs = [through([0.0, 1.0, -1.0, 1.0, -1.0], 300), through([0.4, -1.0, 1.0, -0.9, 0.6], 300)]
    x, groups = np.concatenate(runs), np.repeat([0, 1], [run.size for run in runs])
    y = model.predict(x, groups=groups)
    fitted = MaxwellSlip().fit(x + 1e-3 * rng.normal(size=x.size), y + 0.02 * rng.normal(size=x.size), groups=groups)
    test = through(NESTED, 83)
    assert nrmse(fitted.predict(test), model.predict(test)) < 0.01


def test_a_fit_finds_transitions_that_follow_each_turn() -> None:
    # Two springs and stops make a loop whose transitions lie on the way back from each end.
    spring = models.get("prandtl-ishlinskii").from_parameters(weights=[6.0, -2.0, -1.0], thresholds=[0.0, 0.05, 0.1])
    x = through([0.0, 1.0, -1.0, 1.0, -1.0, 0.9, -0.9], 300)
    fitted = MaxwellSlip(vertices=2, elements=2).fit(x, spring.predict(x))
    assert any("follow each turn" in note for note in fitted.notes_)
    test = through([0.0, 1.0, -1.0, 0.7, -0.4, 0.5], 83)
    assert nrmse(fitted.predict(test)[83:], spring.predict(test)[83:]) < 0.01


def test_recordings_without_a_loop_are_told() -> None:
    x = np.linspace(-1.0, 1.0, 200)
    with pytest.raises(InputError, match="never falls"):
        MaxwellSlip().fit(x, x)
    few = np.array([0.0, 0.5, 1.0, 0.5, 0.0, -0.5, -1.0, -0.5, 0.0, 0.5, 1.0])
    with pytest.raises(InputError, match="cannot be divided into 9 segments"):
        MaxwellSlip().fit(few, few)


def _changed(name: str, value: Any) -> dict[str, Any]:
    return {**PRINTED, name: value}


@pytest.mark.parametrize(
    ("parameters", "told"),
    [
        (_changed("ascending", [[0.0, 0.0]]), "at least 2 vertices"),
        (_changed("descending", [[0.0, 0.0], [1.0, 0.0]]), "increase strictly"),
        (_changed("transition_pos", [[0.2, 0.1], [0.3, 0.2]]), "transition_pos must join"),
        (_changed("ascending", [1.0, 2.0]), r"ascending must have shape \(N, 2\)"),
        ({**PRINTED, "geometry": (2.0, 1.0, 0.0)}, "0 < l1 < l3"),
    ],
)
def test_bad_parameters_are_named(parameters: dict[str, Any], told: str) -> None:
    with pytest.raises(InputError, match=told):
        MaxwellSlip.from_parameters(**parameters)


def test_bad_hyperparameters_are_told_at_fit() -> None:
    x: Floats = through([0.0, 1.0, -1.0], 20)
    with pytest.raises(InputError, match="at least 2 vertices"):
        MaxwellSlip(vertices=1).fit(x, x)
