"""Which timings may be compared: those of one machine, one boot and one day."""

from __future__ import annotations

import hashlib
import platform
from datetime import UTC, datetime
from functools import lru_cache
from pathlib import Path

import psutil

__all__ = ["session_id"]


def session_id() -> str:
    """A name for this machine since it was started, today.

    Identical code differs by less than a percent within one session and by a quarter between two machines of the same
    kind, so that times are compared within a session only. Being hashed, the name tells nothing of the machine.
    """
    day = datetime.now(UTC).date().isoformat()
    return hashlib.sha256(f"{_machine()}|{day}".encode()).hexdigest()[:16]


@lru_cache(maxsize=1)
def _machine() -> str:
    parts = [platform.node(), platform.machine()]
    for path in ("/etc/machine-id", "/proc/sys/kernel/random/boot_id"):
        try:
            parts.append(Path(path).read_text(encoding="ascii").strip())
        except (OSError, ValueError):
            parts.append(f"{psutil.boot_time():.0f}")
    return "|".join(parts)
