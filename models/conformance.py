"""The public conformance suite: what every hysteresis model promises, as checks that a plug-in's author can run.

>>> from hystbench import models
>>> "fit_returns_self" in models.check_model(models.get("cubic"))
True

Every model needs ``fit`` and ``predict``. What else it offers (``invert``, ``stepper``, ``from_parameters``, ``save``,
``get_params``, a claim of rate independence) is checked where present. Each check is one function below, in the order
in which they run; its name is what :func:`check_model` returns.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property, partial
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from .base import Floats, load_parameters

__all__ = ["CHECKS", "ConformanceError", "check_model"]

STEPPER_TOLERANCE = 1e-9
"""Largest difference of stepper and predict, as a fraction of the output's range."""

RATE_TOLERANCE = 1e-6
"""Largest difference between two samplings of one motion, as a fraction of the output's range."""

INVERSE_TOLERANCE = 1e-6
"""Largest difference of predict(invert(y)) and y, as a fraction of the output's range."""


class ConformanceError(AssertionError):
    """A model breaks the contract; the message names the check, what was expected and what came out."""


@dataclass
class Case:
    """A model class and a recording of a clockwise, slightly asymmetric loop with minor loops to try it on."""

    cls: type[Any]
    seed: int

    @cached_property
    def recording(self) -> tuple[Floats, Floats]:
        """Input and output, shape (n,) each; the motion begins at 0 and its first two turns span the whole range."""
        rng = np.random.default_rng(self.seed)
        sizes = np.concatenate([[1.0, 1.0], np.sort(rng.uniform(0.2, 1.0, 8))[::-1], [0.9]])
        turns = np.concatenate([[0.0], sizes * np.where(np.arange(sizes.size) % 2 == 0, 1.0, -1.0)])
        pieces = [a + (b - a) * np.arange(48) / 48.0 for a, b in pairwise(turns)]
        x = np.concatenate([*pieces, turns[-1:]])
        y = 3.0 * x + 0.2 * x**2 + 0.6 * x**3
        for width, stiffness in ((0.05, 4.0), (0.12, 2.0), (0.25, 1.0)):
            y += stiffness * _stop_operator(x, width)
        return x, y

    @property
    def x(self) -> Floats:
        return self.recording[0]

    @cached_property
    def fitted(self) -> Any:
        return self.cls().fit(*(v.copy() for v in self.recording))

    @cached_property
    def predicted(self) -> Floats:
        return np.array(self.fitted.predict(self.x.copy()))

    @cached_property
    def range(self) -> float:
        return max(float(np.ptp(self.predicted)), 1e-300)


def _stop_operator(x: Floats, width: float) -> Floats:
    """Elastic up to ``width``, then slipping."""
    out = np.empty_like(x)
    state = last = 0.0
    for k, value in enumerate(x.tolist()):
        state = min(max(state + value - last, -width), width)
        last = value
        out[k] = state
    return out


def _expect(condition: bool, message: str) -> None:
    if not condition:
        raise ConformanceError(message)


def _expect_same(name: str, found: Any, wanted: Floats) -> None:
    """To the bit."""
    found = np.asarray(found)
    _expect(found.shape == wanted.shape, f"{name}: expected shape {wanted.shape}, got {found.shape}")
    differing = np.flatnonzero(found != wanted)
    if differing.size:
        k = differing[0]
        raise ConformanceError(
            f"{name}: expected the same outputs to the bit; {differing.size} of {wanted.size} differ, "
            f"first at sample {k}: {found[k]!r} instead of {wanted[k]!r}"
        )


def _expect_close(name: str, found: Any, wanted: Floats, tolerance: float, scale: float) -> None:
    found = np.asarray(found)
    _expect(found.shape == wanted.shape, f"{name}: expected shape {wanted.shape}, got {found.shape}")
    errors = np.abs(found - wanted)
    k = int(np.argmax(np.where(np.isfinite(errors), errors, np.inf)))
    _expect(
        bool(errors[k] <= tolerance * scale),
        f"{name}: expected a difference of at most {tolerance:g} of the output's range; "
        f"it is {errors[k] / scale:.3g} at sample {k} ({found[k]:.9g} instead of {wanted[k]:.9g})",
    )


def _expect_value_error(name: str, call: Callable[[], Any]) -> None:
    try:
        call()
    except ValueError as error:
        _expect(
            "\n" not in str(error) and str(error) != "",
            f"{name}: expected a ValueError with a message of one line; it is {str(error)!r}",
        )
        return
    raise ConformanceError(f"{name}: expected a ValueError; nothing was raised")


# ---- the checks, in order ------------------------------------------------------------------------------------------


def hyperparameters_round_trip(case: Case) -> None:
    """The constructor stores hyperparameters as given; get_params, set_params and clone hand them on."""
    model = case.cls()
    params = model.get_params()
    for name, value in params.items():
        _expect(hasattr(model, name), f"expected the constructor to store {name!r} as an attribute of that name")
        _expect(getattr(model, name) is value, f"expected get_params()[{name!r}] to be the attribute itself")
    again = case.cls(**params)
    _expect(again.get_params() == params, f"expected cls(**get_params()) to keep {params}; got {again.get_params()}")
    _expect(model.set_params(**params) is model, "expected set_params to return self")
    if params:
        name = next(iter(params))
        marker = object()
        model.set_params(**{name: marker})
        _expect(model.get_params()[name] is marker, f"expected set_params to set {name!r} without changing the value")
        if hasattr(model, "clone"):
            _expect(model.clone().get_params()[name] is marker, f"expected clone() to keep the value of {name!r}")


def unfitted_predict_raises(case: Case) -> None:
    """Predicting before fit is an error, not an answer (scikit-learn's NotFittedError is both types)."""
    try:
        case.cls().predict(case.x)
    except (ValueError, AttributeError):
        return
    raise ConformanceError("expected predict before fit to raise ValueError or AttributeError; it returned")


def fit_returns_self(case: Case) -> None:
    model = case.cls()
    x, y = (v.copy() for v in case.recording)
    _expect(model.fit(x, y) is model, "expected fit to return the model itself")
    case.__dict__["fitted"] = model


def fit_and_predict_keep_their_inputs(case: Case) -> None:
    """Read-only arrays work, so nothing is written into them; and the same data give the same model."""
    x, y = (v.copy() for v in case.recording)
    x.setflags(write=False)
    y.setflags(write=False)
    again = case.cls().fit(x, y)
    _expect_same("predict after a second fit on the same data", again.predict(x), case.predicted)


def predict_is_finite_and_shaped(case: Case) -> None:
    y = case.fitted.predict(case.x)
    _expect(isinstance(y, np.ndarray), f"expected predict to return a NumPy array; got {type(y).__name__}")
    _expect(y.shape == case.x.shape, f"expected predict to return shape {case.x.shape}; got {y.shape}")
    _expect(y.dtype == np.float64, f"expected predict to return float64; got {y.dtype}")
    bad = np.flatnonzero(~np.isfinite(y))
    _expect(bad.size == 0, f"expected finite outputs; {bad.size} are not, first at sample {bad[:1]}")
    _expect_same("predict for the second time", y, case.predicted)
    one = case.fitted.predict(case.x[5:6])
    _expect(np.shape(one) == (1,), f"expected one output for one sample; got shape {np.shape(one)}")


def predict_is_stateless(case: Case) -> None:
    case.fitted.predict(case.x[:100] * 0.5)
    _expect_same("predict after another predict", case.fitted.predict(case.x), case.predicted)


def predict_is_causal(case: Case) -> None:
    """The output at a sample depends on the samples up to it."""
    n = case.x.size // 2
    _expect_same("predict of the first half alone", case.fitted.predict(case.x[:n]), case.predicted[:n])


def arrays_of_any_kind_work(case: Case) -> None:
    """Lists, integers, object arrays, float32 and arrays that are not contiguous."""
    x = np.round(8.0 * case.x[:200])
    wanted = np.asarray(case.fitted.predict(x))
    kinds: dict[str, Any] = {
        "a list": x.tolist(),
        "integers": x.astype(np.int64),
        "an object array": x.astype(object),
        "float32": x.astype(np.float32),
        "a strided array": np.repeat(x, 2)[::2],
    }
    for kind, values in kinds.items():
        _expect_same(f"predict of {kind}", case.fitted.predict(values), wanted)
    x, y = (np.repeat(v, 2)[::2] for v in case.recording)
    _expect_same("predict after a fit on strided arrays", case.cls().fit(x, y).predict(case.x), case.predicted)


def groups_restart_the_memory(case: Case) -> None:
    first, second = case.x[:200], case.x[120:400]
    x = np.concatenate([first, second])
    wanted = np.concatenate([case.fitted.predict(first), case.fitted.predict(second)])
    for labels in ((0, 1), ("b", "a")):
        groups = np.repeat(labels, [first.size, second.size])
        _expect_same("predict with groups", case.fitted.predict(x, groups=groups), wanted)
    x, y = case.recording
    groups = np.repeat([0, 1], [240, x.size - 240])
    model = case.cls().fit(x, y, groups=groups)
    _expect(bool(np.all(np.isfinite(model.predict(x, groups=groups)))), "expected finite outputs after fit with groups")
    _expect_value_error("fit with groups of another length", lambda: case.cls().fit(x, y, groups=groups[:-1]))
    _expect_value_error("predict with groups of another length", lambda: case.fitted.predict(x, groups=groups[:-1]))


def sampling_does_not_matter(case: Case) -> None:
    """Rate independence: samples inserted on the way and pauses change nothing at the samples in common."""
    x = case.x
    between = np.random.default_rng(case.seed).uniform(0.05, 0.95, (2, x.size - 1))
    between.sort(axis=0)
    dense = np.empty(3 * x.size - 2)
    dense[::3] = x
    for k in (0, 1):
        dense[k + 1 :: 3] = x[:-1] + between[k] * np.diff(x)
    found = np.asarray(case.fitted.predict(dense))[::3]
    _expect_close("predict with samples inserted in between", found, case.predicted, RATE_TOLERANCE, case.range)
    found = np.asarray(case.fitted.predict(np.repeat(x, 3)))
    for k in range(3):
        _expect_close("predict with pauses", found[k::3], case.predicted, RATE_TOLERANCE, case.range)


def stepper_equals_predict(case: Case) -> None:
    stepper = case.fitted.stepper()
    found = [stepper.step(v) for v in case.x.tolist()]
    _expect_close("step by step", np.array(found), case.predicted, STEPPER_TOLERANCE, case.range)
    stepper.reset()
    found = [stepper.step(v) for v in case.x[:100].tolist()]
    _expect_close("step by step after reset", np.array(found), case.predicted[:100], STEPPER_TOLERANCE, case.range)


def blocks_equal_predict(case: Case) -> None:
    """A run cut anywhere, single steps in between, comes out the same."""
    stepper = case.fitted.stepper()
    if not hasattr(stepper, "steps"):
        return
    cuts = np.sort(np.random.default_rng(case.seed).integers(0, case.x.size, 9))
    found: list[float] = []
    for k, part in enumerate(np.split(case.x, cuts)):
        if k % 3 == 2:
            found += [stepper.step(v) for v in part.tolist()]
        else:
            found += np.asarray(stepper.steps(part)).tolist()
    _expect_close("block by block", np.array(found), case.predicted, STEPPER_TOLERANCE, case.range)


def steppers_are_independent(case: Case) -> None:
    """Two steppers of one model, one of them moved far away, do not see each other."""
    one, other = case.fitted.stepper(), case.fitted.stepper()
    found = []
    for v in case.x[:150].tolist():
        found.append(one.step(v))
        other.step(-0.7 * v)
    _expect_close("step beside another stepper", np.array(found), case.predicted[:150], STEPPER_TOLERANCE, case.range)


def peek_does_not_move(case: Case) -> None:
    stepper = case.fitted.stepper()
    trials = np.random.default_rng(case.seed).uniform(-1.0, 1.0, (150, 3))
    found = []
    for v, others in zip(case.x[:150].tolist(), trials.tolist(), strict=True):
        for other in others:
            stepper.peek(other)
        seen = stepper.peek(v)
        found.append(stepper.step(v))
        _expect(seen == found[-1], f"expected peek({v!r}) to be what step returns, {found[-1]!r}; it is {seen!r}")
    _expect_close("step after peeking elsewhere", np.array(found), case.predicted[:150], STEPPER_TOLERANCE, case.range)


def inverse_is_exact(case: Case) -> None:
    """predict(invert(y)) = y for an output of the model itself, which certainly has an inverse."""
    y = case.predicted
    before = y.copy()
    x = np.asarray(case.fitted.invert(y))
    _expect_same("the outputs that invert was given", y, before)
    _expect(bool(np.all(np.isfinite(x))), "expected finite inputs from invert")
    _expect_close("predict(invert(y))", case.fitted.predict(x), y, INVERSE_TOLERANCE, case.range)
    first, second = y[:150], y[:200]
    groups = np.repeat([0, 1], [first.size, second.size])
    wanted = np.concatenate([case.fitted.invert(first), case.fitted.invert(second)])
    _expect_same("invert with groups", case.fitted.invert(np.concatenate([first, second]), groups=groups), wanted)


def parameters_make_the_same_model(case: Case) -> None:
    again = case.cls.from_parameters(**case.fitted.parameters_)
    _expect_same("predict after from_parameters(**parameters_)", again.predict(case.x), case.predicted)
    _expect_value_error("from_parameters with an unknown name", lambda: case.cls.from_parameters(no_such_parameter=1.0))
    for name in case.fitted.parameters_:
        changed = {**case.fitted.parameters_, name: np.nan}
        _expect_value_error(f"from_parameters({name}=nan)", partial(case.cls.from_parameters, **changed))


def files_keep_every_bit(case: Case) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "model.json"
        case.fitted.save(path)
        again = load_parameters(path, lambda name: case.cls)
    _expect_same("predict after save and load", again.predict(case.x), case.predicted)
    if hasattr(again, "get_params"):
        wanted, found = case.fitted.get_params(), again.get_params()
        _expect(found == wanted, f"expected save and load to keep the hyperparameters {wanted}; got {found}")
    if hasattr(again, "invert"):
        y = case.predicted[:100]
        _expect_same("invert after save and load", again.invert(y), np.asarray(case.fitted.invert(y)))


def bad_input_is_a_value_error(case: Case) -> None:
    x, y = case.recording

    def spoiled(values: Floats, bad: float) -> Floats:
        result = values.copy()
        result[values.size // 3] = bad
        return result

    series: dict[str, Any] = {
        "a NaN": spoiled(x, np.nan),
        "an infinite value": spoiled(x, np.inf),
        "an empty array": x[:0],
        "a 2-D array": np.column_stack([x, x]),
        "complex numbers": x + 0.5j,
        "text": ["a"] * x.size,
        "None": None,
    }
    for kind, bad in series.items():
        _expect_value_error(f"fit with {kind} as x", partial(case.cls().fit, bad, y))
        _expect_value_error(f"fit with {kind} as y", partial(case.cls().fit, x, bad))
        _expect_value_error(f"predict of {kind}", partial(case.fitted.predict, bad))
        if hasattr(case.cls, "invert"):
            _expect_value_error(f"invert of {kind}", partial(case.fitted.invert, bad))
    few = max(1, getattr(case.cls, "minimum_samples", 2) - 1)
    _expect_value_error("fit with x and y of unequal length", lambda: case.cls().fit(x, y[:-1]))
    _expect_value_error(f"fit with {few} sample(s)", lambda: case.cls().fit(x[60 : 60 + few], y[60 : 60 + few]))
    _expect_value_error("fit with constant x", lambda: case.cls().fit(np.full_like(x, 0.3), y))


def extreme_values_never_give_nan(case: Case) -> None:
    """Huge and denormal numbers, and outputs that never move: a finite answer or a ValueError, nothing in between."""
    x, y = case.recording

    def refitted(x: Floats, y: Floats, at: Floats) -> Any:
        return case.cls().fit(x, y).predict(at)

    def answers() -> Iterator[tuple[str, Callable[[], Any]]]:
        for scale in (1e300, 1e-310):
            yield f"predict at {scale:g}", partial(case.fitted.predict, scale * x)
            yield f"fit with x at {scale:g}", partial(refitted, scale * x, y, scale * x)
            yield f"fit with y at {scale:g}", partial(refitted, x, scale * y, x)
        yield "fit with constant y", partial(refitted, x, np.full_like(y, 0.7), x)

    for name, answer in answers():
        try:
            found = np.asarray(answer())
        except ValueError:
            continue
        bad = np.flatnonzero(~np.isfinite(found))
        _expect(bad.size == 0, f"{name}: expected finite outputs or a ValueError; {bad.size} outputs are not finite")


CHECKS: tuple[tuple[Callable[[Case], None], str | None], ...] = (
    (hyperparameters_round_trip, "get_params"),
    (unfitted_predict_raises, None),
    (fit_returns_self, None),
    (predict_is_finite_and_shaped, None),
    (fit_and_predict_keep_their_inputs, None),
    (predict_is_stateless, None),
    (predict_is_causal, None),
    (arrays_of_any_kind_work, None),
    (groups_restart_the_memory, None),
    (sampling_does_not_matter, "rate_independent"),
    (stepper_equals_predict, "stepper"),
    (steppers_are_independent, "stepper"),
    (blocks_equal_predict, "stepper"),
    (peek_does_not_move, "stepper"),
    (inverse_is_exact, "invert"),
    (parameters_make_the_same_model, "from_parameters"),
    (files_keep_every_bit, "save"),
    (bad_input_is_a_value_error, None),
    (extreme_values_never_give_nan, None),
)
"""Every check with the attribute that a class must have (and that must not be false) for it to run."""


def check_model(cls: type[Any], *, seed: int = 0) -> list[str]:
    """Check that a model class keeps the contract of :mod:`hystbench.models`.

    Parameters
    ----------
    cls : type
        The model class; it need not be registered.
    seed : int
        Varies the recording that the model is tried on.

    Returns
    -------
    list of str
        Names of the checks that passed; those for what the class does not offer are not among them.

    Raises
    ------
    ConformanceError
        At the first check that fails: one line with the check, what was expected and what came out.
    """
    case = Case(cls, seed)
    passed = []
    for check, needed in CHECKS:
        if needed is not None and not getattr(cls, needed, False):
            continue
        try:
            check(case)
        except ConformanceError as error:
            raise ConformanceError(f"{cls.__name__} fails {check.__name__}: {error}") from None
        # The model is someone else's code and may raise anything; the author needs to know where.
        except Exception as error:
            told = " ".join(str(error).split())
            raise ConformanceError(f"{cls.__name__} fails {check.__name__}: {type(error).__name__}: {told}") from error
        passed.append(check.__name__)
    return passed
