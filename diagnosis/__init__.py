"""The registry of effects that can explain a gap between a simulator and a recording."""

from __future__ import annotations

from typing import Any

from ..plugins import Registry

__all__ = ["registry"]

registry: Registry[Any] = Registry("hystbench.effects", "effect", required=("summary",))
