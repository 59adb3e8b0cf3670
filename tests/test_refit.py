"""A model fitted to another loop from where its last fit ended."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from hystbench import models
from hystbench.models import bouc_wen, separable

Floats = NDArray[np.float64]
SEARCHING = ("bouc-wen", "bouc-wen-baber-noori", "dahl", "duhem", "generalized-maxwell-slip", "lugre")
TIME = np.linspace(0.0, 20.0, 1200)
X = (0.5 + 0.025 * TIME) * np.sin(2.0 * np.pi * 0.4 * TIME)


def loop(friction: float, reach: float) -> Floats:
    """A spring beside bristles, N·m, shape (n,)."""
    return models.get("dahl").from_parameters(
        stiffness=friction / reach, friction=friction, exponent=1.0, spring=(0.0, 3.0)
    ).predict(X)  # fmt: skip


def error(model: models.HysteresisModel, y: Floats) -> float:
    return float(np.std(model.predict(X, time=TIME) - y) / np.std(y))


@pytest.mark.parametrize("name", SEARCHING)
def test_it_fits_the_other_loop_as_a_search_from_anywhere_does(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    first, other = loop(1.0, 0.1), loop(1.1, 0.13)
    cls = models.get(name)
    model, anew = cls().fit(X, first, time=TIME), cls().fit(X, other, time=TIME)
    before = model.predict(X, time=TIME)

    def searched(*_: object) -> Floats:
        raise AssertionError("it searched from anywhere")

    for module in (separable, bouc_wen):
        monkeypatch.setattr(module, "spread_points", searched)
    again = model.refit(X, other, time=TIME)
    assert error(again, other) < error(anew, other) + 2e-3
    assert np.array_equal(model.predict(X, time=TIME), before)
    # A fit knows nothing of those before it.
    with pytest.raises(AssertionError, match="from anywhere"):
        again.fit(X, other, time=TIME)


@pytest.mark.parametrize("name", ["bouc-wen", "dahl", "prandtl-ishlinskii"])
def test_one_that_was_given_its_parameters_searches_and_keeps_its_hyperparameters(name: str) -> None:
    model = models.get(name).from_parameters(**models.get(name)().fit(X, loop(1.0, 0.1), time=TIME).parameters_)
    chosen = {key: value + 1 for key, value in model.get_params().items() if key == "seed"}
    again = model.set_params(**chosen).refit(X, loop(1.1, 0.13), time=TIME)
    anew = model.clone().fit(X, loop(1.1, 0.13), time=TIME)
    assert again.get_params() == model.get_params()
    assert np.array_equal(again.predict(X, time=TIME), anew.predict(X, time=TIME))


def test_other_hyperparameters_may_leave_less_to_choose_from() -> None:
    model = models.get("bouc-wen")().fit(X, loop(1.0, 0.1))
    assert abs(model.parameters_["n"] - 2.0) > 1e-3
    assert model.set_params(n=2.0).refit(X, loop(1.1, 0.13)).parameters_["n"] == 2.0
