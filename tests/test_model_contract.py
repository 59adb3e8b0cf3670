"""Every registered model keeps the public contract, and the suite that says so notices models that do not."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from hystbench import models
from hystbench.models import conformance

LINE = "prandtl-ishlinskii"


@pytest.mark.parametrize("name", models.ids())
def test_registered_models_pass_every_check_they_can(name: str) -> None:
    passed = models.check_model(models.get(name))
    skipped = {check.__name__ for check, _ in conformance.CHECKS} - set(passed)
    assert skipped <= {"sampling_does_not_matter"}
    assert models.get(name).rate_independent == (not skipped)


def test_six_models_are_always_registered() -> None:
    always = {"maxwell-slip", "cubic", "bouc-wen", "preisach", "prandtl-ishlinskii", "choi-backlash"}
    assert always <= set(models.ids())
    for name in always:
        cls = models.get(name)
        assert cls.id == name
        assert cls.title
        assert cls.summary
        assert cls.source


class Duck:
    """The least that the contract allows: fit and predict."""

    def fit(self, x: Any, y: Any, groups: Any = None) -> Duck:
        x, y = self._series(x), self._series(y)
        if x.size != y.size or not 1e-9 < np.ptp(x) < 1e9 or np.abs(y).max() > 1e9:
            raise ValueError("x and y must be of equal length, and x must move")
        if groups is not None and len(groups) != x.size:
            raise ValueError("one group a sample")
        self.line_ = np.polyfit(x, y, 1)
        return self

    def predict(self, x: Any, groups: Any = None) -> Any:
        x = self._series(x)
        if groups is not None and len(groups) != x.size:
            raise ValueError("one group a sample")
        y = np.polyval(self.line_, x)
        if not np.all(np.isfinite(y)):
            raise ValueError("beyond range")
        return y

    @staticmethod
    def _series(values: Any) -> Any:
        if np.iscomplexobj(values):
            raise ValueError("complex")
        try:
            array = np.asarray(values, dtype=float)
        except TypeError:
            raise ValueError("no numbers") from None
        if array.ndim != 1 or array.size == 0 or not np.all(np.isfinite(array)):
            raise ValueError("not a finite series")
        return array


def test_a_model_with_fit_and_predict_only_can_pass() -> None:
    passed = models.check_model(Duck)
    assert "groups_restart_the_memory" in passed
    assert not {"inverse_is_exact", "stepper_equals_predict", "files_keep_every_bit"} & set(passed)


class _Defects:
    """One defect each, mixed into a model that passes; the key is the check that must notice."""

    class hyperparameters_round_trip:
        def __init__(self, operators: int = 40) -> None:
            super().__init__(operators=operators)
            self.operators = 2 * operators

    class unfitted_predict_raises:
        def predict(self, x: Any, groups: Any = None) -> Any:
            return super().predict(x, groups) if hasattr(self, "parameters_") else np.zeros(len(x))

    class fit_returns_self:
        def fit(self, x: Any, y: Any, groups: Any = None) -> None:
            super().fit(x, y, groups)

    class predict_is_finite_and_shaped:
        def predict(self, x: Any, groups: Any = None) -> Any:
            return super().predict(x, groups)[:, None]

    class fit_and_predict_keep_their_inputs:
        def fit(self, x: Any, y: Any, groups: Any = None) -> Any:
            super().fit(x, y, groups)
            y[:] = 0.0
            return self

    class predict_is_stateless:
        other = 0

        def predict(self, x: Any, groups: Any = None) -> Any:
            self.other += len(x) == 100
            return super().predict(x, groups) + 1e-12 * self.other

    class predict_is_causal:
        def predict(self, x: Any, groups: Any = None) -> Any:
            return super().predict(x, groups) + 1e-3 * x[-1]

    class arrays_of_any_kind_work:
        def predict(self, x: Any, groups: Any = None) -> Any:
            return super().predict(x.astype(float), groups)

    class groups_restart_the_memory:
        def predict(self, x: Any, groups: Any = None) -> Any:
            return super().predict(x)

    class sampling_does_not_matter:
        def _predict_run(self, x: Any) -> Any:
            return super()._predict_run(x) + 1e-3 * np.diff(x, prepend=x[0])

    class stepper_equals_predict:
        def stepper(self) -> Any:
            stepper = super().stepper()
            stepper.step(1.5)
            return stepper

    class steppers_are_independent:
        def stepper(self) -> Any:
            if not hasattr(self, "shared"):
                self.shared = super().stepper()
            return self.shared

    class blocks_equal_predict:
        def stepper(self) -> Any:
            stepper = super().stepper()
            whole = stepper.steps
            stepper.steps = lambda x: (stepper.reset(), whole(x))[1]
            return stepper

    class peek_does_not_move:
        def stepper(self) -> Any:
            stepper = super().stepper()
            stepper.peek = stepper.step
            return stepper

    class inverse_is_exact:
        def invert(self, y: Any, groups: Any = None, x0: float = 0.0) -> Any:
            return np.asarray(y) / 3.0

    class parameters_make_the_same_model:
        @classmethod
        def from_parameters(cls, **parameters: Any) -> Any:
            return super().from_parameters(**{**parameters, "offset": 0.1})

    class files_keep_every_bit:
        def save(self, path: Any) -> None:
            self.parameters_["weights"] = np.round(self.parameters_["weights"], 12)
            super().save(path)

    class bad_input_is_a_value_error:
        def predict(self, x: Any, groups: Any = None) -> Any:
            return super().predict(np.nan_to_num(x), groups)

    class extreme_values_never_give_nan:
        def predict(self, x: Any, groups: Any = None) -> Any:
            y = super().predict(x, groups)
            return np.where(np.abs(y) > 1e200, np.nan, y)


@pytest.mark.parametrize("check", [check for check, _ in conformance.CHECKS], ids=lambda check: check.__name__)
def test_each_check_notices_its_defect(check: Callable[[Any], None]) -> None:
    good = models.get(LINE)
    broken = type("Broken", (getattr(_Defects, check.__name__), good), {})
    with pytest.raises(conformance.ConformanceError) as caught:
        models.check_model(broken)
    assert "\n" not in str(caught.value)
    assert str(caught.value).startswith(f"Broken fails {check.__name__}: ")


def test_an_unexpected_exception_names_the_check() -> None:
    class Raises(Duck):
        def predict(self, x: Any, groups: Any = None) -> Any:
            raise KeyError("first line\nsecond line")

    with pytest.raises(
        conformance.ConformanceError, match=r"^Raises fails unfitted_predict_raises: KeyError"
    ) as caught:
        models.check_model(Raises)
    assert "\n" not in str(caught.value)
