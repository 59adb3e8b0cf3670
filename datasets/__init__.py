"""The registry of datasets: synthetic loops with a known plant, and recorded loops."""

from __future__ import annotations

from typing import Any

from ..plugins import Registry, UnknownPluginError
from .base import Dataset, DatasetSource, DatasetUnavailableError, Plant, Recording, concatenate

__all__ = [
    "Dataset",
    "DatasetSource",
    "DatasetUnavailableError",
    "Plant",
    "Recording",
    "UnknownDatasetError",
    "concatenate",
    "get",
    "ids",
    "registry",
    "source",
]


class UnknownDatasetError(UnknownPluginError):
    """No registered dataset has that id; the message lists the known ids and names the nearest one."""


registry: Registry[type[Any]] = Registry(
    "hystbench.datasets", "dataset", required=("load",), unknown=UnknownDatasetError
)


def get(name: str) -> type[Any]:
    """Return the dataset class registered under ``name``; raises UnknownDatasetError if there is none."""
    return registry.get(name)


def source(name: str) -> Any:
    """The dataset source that ``name`` means: a registered one by its id, or a recording in a file by its path.

    Raises
    ------
    UnknownDatasetError
        If it is no id and does not look like a file.
    """
    try:
        return get(name)()
    except UnknownDatasetError:
        from .user_recording import UserRecording, is_file

        if not is_file(name):
            raise
        return UserRecording(name)


def ids() -> list[str]:
    """Ids of all registered datasets that can be loaded (their files may still be absent)."""
    return registry.ids()
