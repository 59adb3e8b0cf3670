"""Where a run came from: versions, machine, command line."""

from __future__ import annotations

import os
import platform
import sys
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import psutil

from .cells import PACKAGES

__all__ = ["describe"]


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"


def describe(command: list[str]) -> dict[str, Any]:
    """Versions, machine, command line and start time, as ``run.json`` holds them."""
    names = (*PACKAGES, "pandas", "pyarrow", "matplotlib", "joblib", "pytest-benchmark")
    return {
        "command": command,
        "versions": {"python": platform.python_version(), **{name: _version(name) for name in names}},
        "machine": {
            "system": f"{platform.system()} {platform.release()}",
            "processor": _processor(),
            "cores": os.cpu_count(),
            "memory_gib": round(psutil.virtual_memory().total / 2**30, 1),
            "byte_order": sys.byteorder,
        },
        "started": datetime.now(UTC).isoformat(timespec="seconds"),
    }


def _processor() -> str:
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as stream:
            for line in stream:
                if line.startswith("model name"):
                    return line.partition(":")[2].strip()
    except OSError:
        pass  # not Linux: platform knows a name there
    return platform.processor() or platform.machine()
