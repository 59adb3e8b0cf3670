"""The contract that every hysteresis model keeps, and what is common to all of them.

A model is one file with one subclass of :class:`HysteresisModel`. It states how it is identified
(:meth:`~HysteresisModel._identify`), what its parameters must satisfy (:meth:`~HysteresisModel._check_parameters`) and
how its memory moves on by one sample (a :class:`~hystbench.models.stepping.Stepper`). Validation, runs, the
scikit-learn conventions, files and the search inverse live here.
"""

from __future__ import annotations

import inspect
import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from ..files import write_text
from .inversion import InverseError, InverseStepper, invert_by_search
from .stepping import ReplayStepper, Stepper

__all__ = [
    "Condition",
    "Floats",
    "HysteresisModel",
    "InverseError",
    "Run",
    "load_parameters",
    "sampling_intervals",
    "split_runs",
]

Floats = NDArray[np.float64]
SCHEMA = "hystbench/model/1"

LARGEST = 1e30
"""Data whose magnitude or range lies beyond this, or below its inverse, are refused: polynomials of them overflow."""


@dataclass(frozen=True)
class Run:
    """One uninterrupted piece of a recording: memory starts anew at its first sample."""

    x: Floats
    y: Floats
    time: Floats | None = None
    """Seconds, strictly increasing; None where no times were given."""


@dataclass(frozen=True)
class Condition:
    """A property that the source asks of the identified parameters, and whether they have it."""

    name: str
    holds: bool
    detail: str


def as_series(name: str, values: ArrayLike) -> Floats:
    """Return ``values`` as a contiguous 1-D float array, or say in one line what is wrong with it."""
    if np.iscomplexobj(values):
        raise InputError(f"{name} must be real; it is complex")
    try:
        # ascontiguousarray would turn a scalar into one sample.
        array = np.asarray(values, dtype=np.float64, order="C")
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"{name} must be a 1-D array of numbers: {error}") from None
    if array.ndim != 1:
        raise InputError(f"{name} must be 1-D; its shape is {array.shape}")
    if array.size == 0:
        raise InputError(f"{name} is empty")
    bad = np.flatnonzero(~np.isfinite(array))
    if bad.size:
        raise InputError(
            f"{name}[{bad[0]}] is {array[bad[0]]} ({bad.size} such samples); remove or interpolate them first"
        )
    return array


def split_runs(groups: ArrayLike | None, size: int) -> Iterator[slice]:
    """Yield the slices over which ``groups`` is constant: memory restarts where it changes."""
    if groups is None:
        yield slice(0, size)
        return
    labels = np.asarray(groups)
    if labels.shape != (size,):
        raise InputError(f"groups must have one label a sample, shape ({size},); its shape is {labels.shape}")
    edges = [0, *(np.flatnonzero(labels[1:] != labels[:-1]) + 1).tolist(), size]
    for start, stop in pairwise(edges):
        yield slice(start, stop)


def sampling_intervals(time: Floats | None, size: int) -> Floats:
    """Seconds since the previous sample, shape (size,), 0 at the first one; without times the samples are 1 s apart."""
    dt = np.ones(size) if time is None else np.diff(time, prepend=time[0])
    dt[0] = 0.0
    return dt


def _as_times(time: ArrayLike | None, size: int, parts: Sequence[slice]) -> Floats | None:
    """``time`` as an array that rises strictly within each run, or say in one line where it does not."""
    if time is None:
        return None
    times = as_series("time", time)
    if times.shape != (size,):
        raise InputError(f"time must have one value a sample, shape ({size},); its shape is {times.shape}")
    for part in parts:
        bad = np.flatnonzero(np.diff(times[part]) <= 0.0)
        if bad.size:
            k = part.start + int(bad[0]) + 1
            raise InputError(
                f"time must rise strictly within a run; time[{k}] = {times[k]:.6g} follows {times[k - 1]:.6g}"
            )
    return times


class HysteresisModel:
    """Base class of hysteresis models, with scikit-learn's conventions.

    The constructor stores hyperparameters and does nothing else; what :meth:`fit` learns ends in an underscore.

    Attributes
    ----------
    parameters_ : dict
        Identified parameters: floats and arrays, as :meth:`from_parameters` takes them.
    conditions_ : list of Condition
        What the source asks of the parameters, and whether it holds.
    notes_ : list of str
        What a user should know of this fit (a bound that was hit, a parameter the data cannot tell).
    fitted_samples_ : int
        Samples that it was fitted to; 0 if its parameters were given.
    """

    id: ClassVar[str]
    title: ClassVar[str]
    summary: ClassVar[str]
    use_for: ClassVar[str] = ""
    not_for: ClassVar[str] = ""
    """What the model is the right choice for and what not, for its page in the documentation."""
    source: ClassVar[str]
    references: ClassVar[tuple[str, ...]] = ()
    """BibTeX entries of the source, or keys of ``references.bib``; see :func:`hystbench.models.citation`."""
    version: ClassVar[str] = "1"
    """Raised whenever the same data would give another result, so that kept results are not mistaken for new ones."""
    rate_independent: ClassVar[bool] = True
    """Whether only the path of the input matters. A model for which it is not so overrides ``_predict_timed``."""
    extended: ClassVar[bool] = False
    """Whether a run leaves the model out unless it is asked for by name or ``--models all``."""
    benchmarked: ClassVar[bool] = True
    """Whether ``--models all`` and the tables of all models take it; not so for what another command makes and saves."""
    minimum_samples: ClassVar[int] = 8
    estimated: ClassVar[tuple[str, ...] | None] = None
    """Parameters that an identification chooses freely (None: all); the others are fixed beforehand."""
    search_grid: ClassVar[Mapping[str, Sequence[Any]]] = {}
    """Hyperparameters worth trying, by name; see :func:`hystbench.models.selection.choose_hyperparameters`."""

    parameters_: dict[str, Any]
    conditions_: list[Condition]
    notes_: list[str]
    fitted_samples_: int = 0
    search_from: Floats | None = None
    """Where :meth:`refit` has a search begin, as the model noted it in ``search_ended_``; None: anywhere."""
    search_ended_: Floats | None = None

    # ---- to be written by each model -------------------------------------------------------------------------------

    def _identify(self, runs: Sequence[Run]) -> dict[str, Any]:
        """Return the parameters identified from ``runs``; may append to ``self.notes_``."""
        raise TypeError(f"{type(self).__name__} does not define _identify")

    @classmethod
    def _check_parameters(cls, *args: Any, **parameters: Any) -> dict[str, Any]:
        """Return the parameters in canonical form, or raise InputError naming the bad one."""
        raise TypeError(f"{cls.__name__} does not define _check_parameters")

    def _prepare(self) -> None:
        """Derive what the kernels need from ``self.parameters_``; called once after every change of it."""

    def _check_conditions(self) -> list[Condition]:
        """Return the source's conditions on the parameters, checked."""
        return []

    def _predict_run(self, x: Floats) -> Floats:
        """Output over one run from the virgin state."""
        raise TypeError(f"{type(self).__name__} does not define _predict_run")

    def _predict_timed(self, x: Floats, time: Floats | None) -> Floats:
        """Output over one run at these times; a rate-independent model has no use for them."""
        return self._predict_run(x)

    def _invert_run(self, y: Floats, x0: float, approximate: bool) -> Floats:
        """Input over one run; by default a search along the model's own trajectory, sample by sample."""
        return invert_by_search(self.stepper(), y, x0, self._input_scale(), approximate)

    def _invert_timed(self, y: Floats, time: Floats | None, x0: float, approximate: bool) -> Floats:
        """Input over one run at these times; a rate-independent model has no use for them."""
        return self._invert_run(y, x0, approximate)

    def _input_scale(self) -> float:
        """A typical input amplitude, from which the search inverse takes its first steps and its limit."""
        return float(getattr(self, "x_scale_", 1.0))

    def stepper(self) -> Stepper:
        """A fresh sample-by-sample evaluator, in the virgin state; equal to :meth:`predict`."""
        self._require_fitted()
        return ReplayStepper(self._predict_run)

    def inverse_stepper(self, x0: float = 0.0, *, approximate: bool = False) -> InverseStepper:
        """The inverse one sample at a time, for a control loop: its ``step(y)`` returns x.

        Parameters are those of :meth:`invert`; a rate-independent model's inputs agree with it to the search's tolerance
        (1e-9 of the output's size).
        """
        return InverseStepper(self.stepper(), float(x0), self._input_scale(), approximate)

    # ---- the public contract ---------------------------------------------------------------------------------------

    def fit(
        self, x: ArrayLike, y: ArrayLike, groups: ArrayLike | None = None, *, time: ArrayLike | None = None
    ) -> Self:
        """Identify the parameters from a measured loop.

        Parameters
        ----------
        x, y : array_like, shape (n,)
            Input (deflection, rad unless the data says otherwise) and output (torque, N·m).
        groups : array_like, shape (n,), optional
            Labels; the memory restarts where they change.
        time : array_like, shape (n,), optional
            Seconds, rising strictly within each run. Only rate-dependent models use it; without it they take the
            samples as 1 s apart.

        Raises
        ------
        InputError
            If an array is not 1-D, finite and of equal length, has too few samples, ``time`` does not rise, or ``x`` is
            constant.
        """
        x, y = as_series("x", x), as_series("y", y)
        if x.shape != y.shape:
            raise InputError(f"x and y must have the same length; they have {x.size} and {y.size}")
        if x.size < self.minimum_samples:
            raise InputError(
                f"{x.size} samples are too few to identify {self.id}; give at least {self.minimum_samples}"
            )
        if np.ptp(x) == 0:
            raise InputError("x is constant: nothing can be identified; give a recording in which the input moves")
        for name, size in (("x", np.max(np.abs(x))), ("range of x", np.ptp(x)), ("y", np.max(np.abs(y)))):
            if size > LARGEST or 0.0 < size < 1.0 / LARGEST:
                raise InputError(f"the {name} is of the order {size:.0e}, where powers overflow; choose other units")
        parts = list(split_runs(groups, x.size))
        times = _as_times(time, x.size, parts)
        runs = [Run(x[part], y[part], None if times is None else times[part]) for part in parts]
        self.notes_ = []
        if times is None and not self.rate_independent:
            self.notes_.append("no time was given: the samples are taken as 1 s apart")
        self.x_scale_ = float(np.max(np.abs(x)))
        self.fitted_samples_ = int(x.size)
        self._set_parameters(self._check_parameters(**self._identify(runs)))
        return self

    def refit(
        self, x: ArrayLike, y: ArrayLike, groups: ArrayLike | None = None, *, time: ArrayLike | None = None
    ) -> Self:
        """A model with the same hyperparameters fitted to another loop; arguments and errors are those of :meth:`fit`.

        A model that searches for its constants starts where the search of this one ended. Where loops differ little that
        takes a fraction of the time of a search from anywhere, and finds no other minimum than the one next to it.
        """
        again = self.clone()
        again.search_from = self.search_ended_
        again.fit(x, y, groups, time=time)
        again.search_from = None
        return again

    def predict(self, x: ArrayLike, groups: ArrayLike | None = None, *, time: ArrayLike | None = None) -> Floats:
        """Output for the input ``x``, shape (n,), from the virgin state; no state is kept between calls.

        ``groups`` and ``time`` are as in :meth:`fit`.
        """
        self._require_fitted()
        x = as_series("x", x)
        y = np.empty_like(x)
        parts = list(split_runs(groups, x.size))
        times = _as_times(time, x.size, parts)
        for part in parts:
            y[part] = self._predict_timed(x[part], None if times is None else times[part])
        if not np.all(np.isfinite(y)):
            bad = int(np.flatnonzero(~np.isfinite(y))[0])
            raise InputError(
                f"the output at x[{bad}] = {x[bad]:.6g} is not finite: the input is far beyond the model's range"
            )
        return y

    def invert(
        self,
        y: ArrayLike,
        groups: ArrayLike | None = None,
        x0: float = 0.0,
        *,
        approximate: bool = False,
        time: ArrayLike | None = None,
    ) -> Floats:
        """Input that makes :meth:`predict` give ``y``, shape (n,), from the virgin state.

        Parameters
        ----------
        y : array_like, shape (n,)
            Wanted output.
        groups : array_like, optional
            Labels; the memory restarts where they change.
        x0 : float
            Where several inputs give the first output, the one nearest to ``x0`` is taken.
        approximate : bool
            Where no input gives the wanted output, take the one whose output is nearest instead of raising.
        time : array_like, shape (n,), optional
            As in :meth:`fit`.

        Raises
        ------
        InverseError
            If no inverse exists at some sample and ``approximate`` is false.
        """
        self._require_fitted()
        y = as_series("y", y)
        x = np.empty_like(y)
        parts = list(split_runs(groups, y.size))
        times = _as_times(time, y.size, parts)
        for part in parts:
            x[part] = self._invert_timed(y[part], None if times is None else times[part], float(x0), approximate)
        return x

    @classmethod
    def from_parameters(cls, **parameters: Any) -> Self:
        """A model with the given parameters, without identification; see the class for their names and shapes.

        Raises
        ------
        InputError
            If a parameter is missing, unknown, of the wrong shape or not finite.
        """
        model = cls()
        model.notes_ = []
        signature = inspect.signature(cls._check_parameters)
        try:
            signature.bind(**parameters)
        except TypeError as error:
            raise InputError(f"{cls.id}: {error}; its parameters are {', '.join(signature.parameters)}") from None
        model._set_parameters(cls._check_parameters(**parameters))
        return model

    def _set_parameters(self, parameters: dict[str, Any]) -> None:
        self.parameters_ = parameters
        self._prepare()
        self.conditions_ = self._check_conditions()

    def _require_fitted(self) -> None:
        if not hasattr(self, "parameters_"):
            raise InputError(f"this {self.id} model has no parameters yet; call fit or from_parameters first")

    def coordinates(self) -> tuple[list[str], Floats, Callable[[Floats], dict[str, Any]]]:
        """The freely chosen parameters as one vector: their labels, their values, and the way back.

        Used for standard errors; a model whose parameters depend on each other overrides it.
        """
        names = [n for n in (self.estimated or self.parameters_) if self.parameters_.get(n) is not None]
        arrays = {name: np.asarray(self.parameters_[name], dtype=np.float64) for name in names}
        labels = [
            name + (f"[{', '.join(map(str, index))}]" if index else "")
            for name, array in arrays.items()
            for index in np.ndindex(array.shape)
        ]

        def rebuild(values: Floats) -> dict[str, Any]:
            parameters = {name: value for name, value in self.parameters_.items() if value is not None}
            start = 0
            for name, array in arrays.items():
                parameters[name] = values[start : start + array.size].reshape(array.shape)
                start += array.size
            return parameters

        return labels, np.concatenate([array.ravel() for array in arrays.values()]), rebuild

    # ---- scikit-learn's conventions --------------------------------------------------------------------------------

    @classmethod
    def _hyperparameters(cls) -> list[str]:
        return (
            [name for name in inspect.signature(cls.__init__).parameters if name != "self"]
            if cls.__init__ is not object.__init__
            else []
        )

    def get_params(self, deep: bool = True) -> dict[str, Any]:
        """Hyperparameters by name."""
        return {name: getattr(self, name) for name in self._hyperparameters()}

    def set_params(self, **params: Any) -> Self:
        """Set hyperparameters by name; an unknown name raises InputError."""
        known = self._hyperparameters()
        for name, value in params.items():
            if name not in known:
                raise InputError(f"{self.id} has no hyperparameter {name!r}; it has {', '.join(known) or 'none'}")
            setattr(self, name, value)
        return self

    def clone(self) -> Self:
        """An unfitted copy with the same hyperparameters."""
        return type(self)(**self.get_params())

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{k}={v!r}' for k, v in self.get_params().items())})"

    # ---- files -----------------------------------------------------------------------------------------------------

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the model as JSON; floats keep every bit. The file appears whole or not at all."""
        self._require_fitted()
        document = {
            "schema": SCHEMA,
            "model": self.id,
            "version": self.version,
            "hyperparameters": self.get_params(),
            "parameters": {name: _plain(value) for name, value in self.parameters_.items()},
            "x_scale": self._input_scale(),
            "fitted_samples": self.fitted_samples_,
            "conditions": [vars(condition) for condition in self.conditions_],
            "notes": self.notes_,
        }
        write_text(path, json.dumps(document, indent=1, allow_nan=False) + "\n")


def _plain(value: Any) -> Any:
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else value


def load_parameters(path: str | os.PathLike[str], get: Callable[[str], type[Any]]) -> Any:
    """Read a model file; ``get`` turns its model id into the class."""
    try:
        with open(path, encoding="utf-8") as stream:
            document = json.load(stream)
    except FileNotFoundError:
        raise InputError(f"{path}: no such file; `hystbench fit` writes model files") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from None
    except (UnicodeDecodeError, json.JSONDecodeError, RecursionError) as error:
        raise InputError(f"{path}: not a model file ({error}); `hystbench fit` writes model files") from None
    if not isinstance(document, Mapping) or document.get("schema") != SCHEMA:
        raise InputError(f"{path}: not a model file (no schema {SCHEMA!r}); `hystbench fit` writes model files")
    name, parameters = document.get("model"), document.get("parameters")
    if not isinstance(name, str) or not isinstance(parameters, Mapping):
        raise InputError(f"{path}: the model file lacks its model id or its parameters")
    cls = get(name)
    try:
        model = cls.from_parameters(**parameters)
        model.set_params(**document.get("hyperparameters", {}))
        model.x_scale_ = parameter_number("x_scale", document.get("x_scale", 1.0))
        model.fitted_samples_ = int(parameter_number("fitted_samples", document.get("fitted_samples", 0)))
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"{path}: {error}") from None
    notes = document.get("notes", [])
    if not isinstance(notes, list) or not model.x_scale_ > 0.0:
        raise InputError(f"{path}: notes must be a list and x_scale positive; `hystbench fit` writes model files")
    model.notes_ = [str(note) for note in notes]
    return model


def parameter_array(name: str, value: Any, shape: tuple[int | None, ...]) -> Floats:
    """Return a parameter as a finite float array of ``shape`` (None: any length of at least 1)."""
    try:
        array = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(f"parameter {name} must be numeric, shape {_shape_text(shape)}") from None
    fits = array.ndim == len(shape) and all(
        length >= 1 and (wanted is None or length == wanted) for length, wanted in zip(array.shape, shape, strict=True)
    )
    if not fits:
        raise InputError(f"parameter {name} must have shape {_shape_text(shape)}; it has {array.shape}")
    if not np.all(np.isfinite(array)):
        raise InputError(f"parameter {name} has a value that is not finite")
    return array


def parameter_number(name: str, value: Any) -> float:
    """Return a parameter as a finite float."""
    return float(parameter_array(name, value, ()))


def _shape_text(shape: tuple[int | None, ...]) -> str:
    names = iter("NMK")
    return (
        "("
        + ", ".join(next(names) if length is None else str(length) for length in shape)
        + ("," if len(shape) == 1 else "")
        + ")"
    )
