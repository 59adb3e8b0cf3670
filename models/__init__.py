"""The registry of hysteresis models.

>>> from hystbench import models
>>> m = models.get("prandtl-ishlinskii").from_parameters(weights=[1.0, 0.5], thresholds=[0.0, 0.2])
>>> m.predict([0.0, 0.5, 0.1]).round(3).tolist()
[0.0, 0.65, 0.25]
"""

from __future__ import annotations

from typing import Any

from ..plugins import Registry, UnknownPluginError
from .base import Condition, HysteresisModel, InverseError, Run, load_parameters
from .stepping import Stepper

__all__ = [
    "Condition",
    "HysteresisModel",
    "InverseError",
    "Run",
    "Stepper",
    "UnknownModelError",
    "benchmarked_ids",
    "check_model",
    "citation",
    "get",
    "ids",
    "load",
    "registry",
]


class UnknownModelError(UnknownPluginError):
    """No registered model has that id; the message lists the known ids and names the nearest one."""


registry: Registry[type[Any]] = Registry(
    "hystbench.models", "model", required=("fit", "predict"), unknown=UnknownModelError
)


def get(name: str) -> type[Any]:
    """Return the model class registered under ``name``.

    Raises
    ------
    UnknownModelError
        If there is none; the message lists the known ids and the nearest one.
    """
    return registry.get(name)


def ids() -> list[str]:
    """Ids of all registered models that can be loaded."""
    return registry.ids()


def benchmarked_ids() -> list[str]:
    """Ids of the models that stand for themselves: all but those that only another command makes."""
    return [name for name in ids() if getattr(get(name), "benchmarked", True)]


def load(path: Any) -> Any:
    """Read a model that ``save`` wrote (JSON; nothing in the file is executed).

    Raises
    ------
    InputError
        If the file is missing, is no model file, or its parameters are not valid for the model it names.
    """
    return load_parameters(path, get)


def citation(*names: str) -> str:
    """BibTeX of the sources of these models, each entry once; of all registered models if none is named.

    Raises
    ------
    UnknownModelError
        If an id is not registered.
    """
    from .citations import bibtex

    return bibtex([get(name) for name in names or ids()])


def check_model(cls: type[Any], *, seed: int = 0) -> list[str]:
    """Run the public conformance suite on a model class; return the names of the checks that passed.

    Raises :class:`hystbench.models.conformance.ConformanceError` at the first one that fails.
    """
    from .conformance import check_model as check

    return check(cls, seed=seed)
