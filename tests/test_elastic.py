"""The elastic law: against the printed geometry and numpy's interpolation, and what a fit finds."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from motions import DECAYING, nrmse, through

from hystbench import models
from hystbench.errors import InputError

Elastic = models.get("elastic")
GEOMETRY = (0.02, 0.05, 0.004)


def test_torque_of_the_geometry_is_eq_a12() -> None:
    l1, l3, x0 = GEOMETRY
    theta = np.linspace(-1.0, 1.0, 41)
    l2 = np.sqrt(l1**2 + l3**2 - 2.0 * l1 * l3 * np.cos(theta))
    torque = 5000.0 * (12.0 * (l1 + l2 - l3) + x0) * l1 * l3 * np.sin(theta) / l2
    model = Elastic.from_parameters(vertices=[[-1.0, -5000.0], [1.0, 5000.0]], geometry=GEOMETRY)
    np.testing.assert_allclose(model.predict(theta), torque, atol=1e-9)
    np.testing.assert_allclose(model.invert(torque), theta, atol=1e-9)
    stepper = model.stepper()
    np.testing.assert_allclose([stepper.step(t) for t in theta], torque, atol=1e-9)
    fitted = Elastic(segments=1, geometry=GEOMETRY).fit(theta, torque)
    np.testing.assert_allclose(fitted.predict(theta), torque, atol=1e-6)


def test_a_polyline_on_the_fits_own_grid_is_recovered_and_is_numpys_interpolation() -> None:
    vertices = np.column_stack([np.linspace(-1.0, 1.0, 9), [-5.0, -3.0, -2.0, -1.9, 0.0, 0.4, 2.0, 2.2, 6.0]])
    truth = Elastic.from_parameters(vertices=vertices)
    x = through([0.0, 1.0, -1.0, *DECAYING[3:]], 40)
    np.testing.assert_allclose(truth.predict(x), np.interp(x, *vertices.T), atol=1e-12)
    found = Elastic(segments=8).fit(x, truth.predict(x)).parameters_["vertices"]
    np.testing.assert_allclose(found, vertices, atol=1e-9)
    beyond = np.array([-2.0, 2.0])
    np.testing.assert_allclose(truth.predict(beyond), [-5.0 - 8.0, 6.0 + 15.2], atol=1e-12)


def test_a_falling_curve_leaves_a_rising_one_with_an_inverse_and_says_so() -> None:
    x = through([0.0, 1.0, -1.0, 1.0], 50)
    model = Elastic().fit(x, -x)
    assert "16 of 16 segments" in model.notes_[0]
    assert np.all(np.diff(model.parameters_["vertices"], axis=0) > 0.0)
    np.testing.assert_allclose(model.predict(model.invert(model.predict(x))), model.predict(x), atol=1e-9)


def test_it_follows_the_middle_of_a_loop() -> None:
    x = through([0.0, 1.0, -1.0, 1.0, -1.0], 200)
    y = 2.0 * x + x**3 + 0.3 * np.sign(np.gradient(x))
    settled = slice(200, None)
    assert nrmse(Elastic().fit(x, y).predict(x)[settled], (2.0 * x + x**3)[settled]) < 0.03


@pytest.mark.parametrize(
    ("parameters", "told"),
    [
        ({"vertices": [[0.0, 0.0]]}, "at least 2 rows"),
        ({"vertices": [[0.0, 0.0], [1.0, 0.0]]}, "increasing strictly"),
        ({"vertices": [[0.0, 0.0], [1.0, 1.0]], "geometry": [0.05, 0.02, 0.0]}, "0 < l1 < l3"),
    ],
)
def test_bad_parameters_are_named(parameters: dict[str, Any], told: str) -> None:
    with pytest.raises(InputError, match=told):
        Elastic.from_parameters(**parameters)
