"""Where a run came from: versions, machine, command line."""

from __future__ import annotations

import os
import platform
import shutil
import subprocess
import sys
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
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
        "commit": _commit(),
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


def _commit() -> str | None:
    """The commit of the checkout that this package is run from; None if it is installed from a wheel."""
    root, git = Path(__file__).resolve().parent.parent, shutil.which("git")
    if git is None or not (root / ".git").exists():
        return None
    done = subprocess.run([git, "-C", str(root), "rev-parse", "HEAD"], capture_output=True, text=True, check=False)
    return done.stdout.strip() or None
