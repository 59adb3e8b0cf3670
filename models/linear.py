"""The linear spring: what an engineer without a hysteresis model uses."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
from numba import njit

from ..errors import InputError
from .base import Condition, Floats, HysteresisModel, InverseError, Run, parameter_number
from .stepping import KernelStepper

__all__ = ["Linear"]


def _initial_state(capacity: int) -> Floats:
    return np.zeros(1)


@njit(cache=True)
def _step(x, state, params, commit):
    return params[0] * x + params[1]


class Linear(HysteresisModel):
    """y = stiffness·x + offset, by least squares.

    ``from_parameters`` takes ``stiffness`` and optionally ``offset``.
    """

    id: ClassVar[str] = "linear"
    title: ClassVar[str] = "Linear spring"
    summary: ClassVar[str] = "y = k x + b, no memory; what every other model must beat"
    use_for: ClassVar[str] = "the stiffness at a glance, and as the baseline of baselines"
    not_for: ClassVar[str] = "anything that bends or loops"
    source: ClassVar[str] = "Hooke's law; Choi et al. 2017, Eq. 40"
    references: ClassVar[tuple[str, ...]] = ("choi2017",)
    extended: ClassVar[bool] = True

    def _identify(self, runs: Sequence[Run]) -> dict[str, Any]:
        x, y = (np.concatenate([getattr(run, name) for run in runs]) for name in "xy")
        away = x - x.mean()
        stiffness = float(away @ (y - y.mean()) / (away @ away))
        return {"stiffness": stiffness, "offset": float(y.mean() - stiffness * x.mean())}

    @classmethod
    def _check_parameters(cls, stiffness: Any, offset: Any = 0.0) -> dict[str, Any]:
        return {"stiffness": parameter_number("stiffness", stiffness), "offset": parameter_number("offset", offset)}

    def _check_conditions(self) -> list[Condition]:
        stiffness = self.parameters_["stiffness"]
        return [
            Condition("the spring is not slack (the inverse exists)", stiffness != 0.0, f"stiffness {stiffness:.4g}")
        ]

    def _predict_run(self, x: Floats) -> Floats:
        with np.errstate(over="ignore"):
            return self.parameters_["stiffness"] * x + self.parameters_["offset"]

    def stepper(self) -> KernelStepper:
        self._require_fitted()
        return KernelStepper(
            _step,
            _initial_state,
            (self.parameters_["stiffness"], self.parameters_["offset"]),
            lambda x, state, params, out: np.copyto(out, self._predict_run(x)),
        )

    def _invert_run(self, y: Floats, x0: float, approximate: bool) -> Floats:
        stiffness, offset = self.parameters_["stiffness"], self.parameters_["offset"]
        if stiffness == 0.0:
            missed = np.flatnonzero(y != offset)
            if missed.size and not approximate:
                raise InverseError(
                    f"no input gives the output y[{missed[0]}] = {y[missed[0]]:.6g}: the stiffness is 0; "
                    "pass approximate=True (command line: --approximate) to keep the input"
                )
            return np.full_like(y, x0)
        x: Floats = (y - offset) / stiffness
        if not np.all(np.isfinite(x)):
            raise InputError("the output is far beyond the model's range")
        return x
