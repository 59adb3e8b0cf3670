"""Plug-in registries on entry points: models, datasets and effects, the built-in ones included."""

from __future__ import annotations

import difflib
import warnings
from functools import cached_property
from importlib.metadata import EntryPoint, entry_points
from typing import Any, Generic, TypeVar

from .errors import InputError

__all__ = ["BrokenPluginWarning", "Registry", "UnknownPluginError"]

T = TypeVar("T")


class UnknownPluginError(InputError, KeyError):
    """An id that no plug-in registered; the message lists the known ids and names the nearest one."""

    def __str__(self) -> str:  # KeyError would show the message's repr
        return str(self.args[0])


class BrokenPluginWarning(UserWarning):
    """A plug-in that could not be loaded: it is named and skipped."""


class Registry(Generic[T]):
    """The plug-ins of one entry-point group, loaded when first asked for.

    Parameters
    ----------
    group:
        Entry-point group, for instance ``"hystbench.models"``.
    kind:
        The singular noun for messages, for instance ``"model"``.
    required:
        Attributes that a plug-in must have; one that lacks any is broken.
    unknown:
        Exception class for unknown ids.
    """

    def __init__(
        self,
        group: str,
        kind: str,
        *,
        required: tuple[str, ...] = (),
        unknown: type[UnknownPluginError] = UnknownPluginError,
    ) -> None:
        self.group = group
        self.kind = kind
        self._required = required
        self._unknown = unknown
        self._loaded: dict[str, T] = {}
        self.broken: dict[str, str] = {}

    @cached_property
    def _entry_points(self) -> dict[str, EntryPoint]:
        found: dict[str, EntryPoint] = {}
        # Built-in plug-ins first: another package that takes one of their ids must not silently replace them.
        for point in sorted(entry_points(group=self.group), key=lambda p: not p.value.startswith("hystbench.")):
            first = found.setdefault(point.name, point)
            if first.value != point.value:
                self._skip(
                    f"{point.name} ({point.value})",
                    f"the id is taken by {first.value}; rename it in that package's pyproject.toml",
                )
        return found

    def _skip(self, name: str, reason: str) -> None:
        self.broken[name] = reason
        warnings.warn(f"{self.kind} plug-in {name} skipped: {reason}", BrokenPluginWarning, stacklevel=3)

    def ids(self) -> list[str]:
        """Ids of all plug-ins that load, the built-in ones first."""
        return [name for name in self._entry_points if self._load(name) is not None]

    def modules(self) -> set[str]:
        """Names of the modules that the plug-ins are in; none is loaded for that."""
        return {point.module for point in self._entry_points.values()}

    def _load(self, name: str) -> T | None:
        if name in self._loaded:
            return self._loaded[name]
        if name in self.broken:
            return None
        point = self._entry_points[name]
        try:
            plugin: Any = point.load()
            missing = [attribute for attribute in self._required if not hasattr(plugin, attribute)]
            if missing:
                raise TypeError(f"it lacks {', '.join(missing)}")
        # A plug-in is someone else's code and may raise anything on import, SystemExit included.
        except (Exception, SystemExit) as error:
            self._skip(f"{name} ({point.value})", f"{type(error).__name__}: {error}")
            self.broken.setdefault(name, f"{type(error).__name__}: {error}")
            return None
        self._loaded[name] = plugin
        return self._loaded[name]

    def get(self, name: str) -> T:
        """Return the plug-in called ``name``.

        Raises
        ------
        UnknownPluginError
            If no plug-in has that id; the message lists the known ids and the nearest one.
        InputError
            If the plug-in exists but cannot be loaded.
        """
        if name in self._entry_points:
            plugin = self._load(name)
            if plugin is None:
                raise InputError(f"{self.kind} {name!r} cannot be loaded: {self.broken[name]}; repair or uninstall it")
            return plugin
        known = self.ids()
        nearest = difflib.get_close_matches(name, known, n=1, cutoff=0.0)
        hint = f"; did you mean {nearest[0]!r}?" if nearest else ""
        raise self._unknown(f"unknown {self.kind} {name!r}{hint} Known: {', '.join(known) or 'none'}.")
