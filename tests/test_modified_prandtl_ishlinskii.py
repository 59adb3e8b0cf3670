"""Modified Prandtl-Ishlinskii: against plays and dead zones one by one, its inverse, and what a fit finds."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from motions import DECAYING, NESTED, Floats, nrmse, through, turning_points

from hystbench import models
from hystbench.errors import InputError

MPI = models.get("modified-prandtl-ishlinskii")


def definition(x: Floats, p: dict[str, Any]) -> Floats:
    """Kuhnen's operators, one by one and sample by sample."""
    play, out = np.zeros(len(p["thresholds"])), []
    for value in x:
        play = np.clip(play, value - p["thresholds"], value + p["thresholds"])
        h = float(p["weights"] @ play)
        y = p["offset"]
        for s, v in zip(p["dead_zone_thresholds"], p["dead_zone_weights"], strict=True):
            y += v * (max(h - s, 0.0) if s > 0 else min(h - s, 0.0) if s < 0 else h)
        out.append(y)
    return np.array(out)


def random_parameters(seed: int, sides: tuple[int, int]) -> dict[str, Any]:
    rng = np.random.default_rng(seed)
    below, above = sides
    outwards = [rng.uniform(0.3, 2.0, n) for n in (below, above)]
    middle = 1.0
    return {
        "weights": np.diff(rng.uniform(0.3, 2.0, 6), prepend=0.0),
        "thresholds": np.concatenate([[0.0], np.sort(rng.uniform(0.05, 0.9, 5))]),
        "dead_zone_weights": np.concatenate(
            [np.diff(outwards[0], prepend=middle)[::-1], [middle], np.diff(outwards[1], prepend=middle)]
        ),
        "dead_zone_thresholds": np.concatenate(
            [np.sort(-rng.uniform(0.1, 1.5, below)), [0.0], np.sort(rng.uniform(0.1, 1.5, above))]
        ),
        "offset": 0.3,
    }


@given(turning_points(-1.5, 1.5), st.integers(0, 5), st.sampled_from([(2, 3), (0, 2), (2, 0), (0, 0)]))
def test_output_and_inverse_are_those_of_the_definition(turns: list[float], seed: int, sides: tuple[int, int]) -> None:
    parameters = random_parameters(seed, sides)
    model = MPI.from_parameters(**parameters)
    assert all(condition.holds for condition in model.conditions_)
    x = through(turns, 5)
    y = model.predict(x)
    np.testing.assert_allclose(y, definition(x, parameters), atol=1e-12)
    np.testing.assert_allclose(model.invert(y), x, atol=1e-10)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_own_kind_predicts_held_out_minor_loops(seed: int) -> None:
    truth = MPI.from_parameters(**random_parameters(seed, (2, 3)))
    train, test = through(DECAYING, 60), through(NESTED, 83)
    model = MPI().fit(train, truth.predict(train))
    wanted = truth.predict(test)
    assert nrmse(model.predict(test), wanted) < 5e-3
    assert nrmse(truth.predict(model.invert(wanted)), wanted) < 1e-2
    plain = models.get("prandtl-ishlinskii")().fit(train, truth.predict(train))
    assert nrmse(model.predict(test), wanted) < 0.3 * nrmse(plain.predict(test), wanted)


def test_without_dead_zones_it_is_the_prandtl_ishlinskii_model() -> None:
    train, test = through(DECAYING, 40), through(NESTED, 30)
    truth = models.get("prandtl-ishlinskii").from_parameters(
        weights=[2.0, -0.5, 0.3], thresholds=[0.0, 0.2, 0.5], offset=0.4
    )
    model = MPI(operators=10, dead_zones=0).fit(train, truth.predict(train))
    assert model.parameters_["dead_zone_thresholds"].tolist() == [0.0]
    assert nrmse(model.predict(test), truth.predict(test)) < 1e-3


def test_without_positive_partial_sums_the_inverse_says_so() -> None:
    parameters = {"weights": [1.0], "thresholds": [0.0], "dead_zone_thresholds": [0.0, 0.5]}
    model = MPI.from_parameters(**parameters, dead_zone_weights=[1.0, -1.5])
    with pytest.raises(models.InverseError, match=r"dead zones' weights.*smallest -0\.5.*approximate=True"):
        model.invert([0.1, 0.2])
    assert abs(model.predict(model.invert([0.1, 0.6], approximate=True))[1] - 0.5) < 0.03


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"dead_zone_thresholds": [0.1, 0.2]}, "0 among them"),
        ({"dead_zone_thresholds": [0.0, 0.0]}, "increase strictly"),
        ({"dead_zone_weights": [1.0]}, "dead_zone_weights must have shape"),
        ({"thresholds": [0.1]}, "begin with 0"),
    ],
)
def test_bad_parameters_are_named(changed: dict[str, Any], told: str) -> None:
    good = {"weights": [1.0], "thresholds": [0.0], "dead_zone_weights": [1.0, 0.5], "dead_zone_thresholds": [0.0, 0.5]}
    with pytest.raises(InputError, match=told):
        MPI.from_parameters(**{**good, **changed})


def test_constant_outputs_and_bad_hyperparameters_are_told_at_fit() -> None:
    x = through([0.0, 1.0, -1.0], 20)
    with pytest.raises(InputError, match="y is constant"):
        MPI().fit(x, np.ones_like(x))
    for hyper in ({"operators": 0}, {"dead_zones": -1}, {"least_slope": 1.0}):
        with pytest.raises(InputError, match=next(iter(hyper))):
            MPI(**hyper).fit(x, x)
