"""The diagnosis of a gap between a simulator and a recording, and the registry of effects that can explain it.

>>> from hystbench import diagnosis
>>> "viscous_friction" in diagnosis.registry.ids()
True
"""

from __future__ import annotations

from typing import Any

from ..plugins import Registry

__all__ = ["diagnose", "registry"]

registry: Registry[Any] = Registry(
    "hystbench.effects",
    "effect",
    required=("id", "title", "summary", "equation", "coordinate", "acts_on", "parameters", "forms"),
)


def diagnose(*arguments: Any, **options: Any) -> Any:
    """Diagnose a gap; see :func:`hystbench.diagnosis.diagnosis.diagnose`."""
    from .diagnosis import diagnose as run

    return run(*arguments, **options)
