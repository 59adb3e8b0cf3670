"""Building packages as pip would and putting them where Python finds them, without touching the environment."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def install_wheel(source: Path, work: Path) -> Path:
    """Build the project in ``source`` in a copy of it and unpack its wheel to a folder for PYTHONPATH."""
    copy = work / "source"
    ignored = shutil.ignore_patterns(".*", "*.egg-info", "build", "dist", "__pycache__", "hystbench-*")
    shutil.copytree(source, copy, ignore=ignored)
    build = "import setuptools.build_meta as b; print(b.build_wheel('dist'))"
    done = subprocess.run([sys.executable, "-c", build], cwd=copy, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    site = work / "site"
    with zipfile.ZipFile(next((copy / "dist").glob("*.whl"))) as wheel:
        wheel.extractall(site)
    return site


def hystbench(
    *arguments: object, cwd: Path, site: Path | None = None, **environment: str
) -> subprocess.CompletedProcess[str]:
    """Run the command in a process of its own, with ``site`` on its path."""
    env = {**os.environ, **environment}
    if site is not None:
        env["PYTHONPATH"] = str(site)
    command = [sys.executable, "-m", "hystbench", *map(str, arguments)]
    return subprocess.run(command, cwd=cwd, env=env, capture_output=True, text=True, check=False, timeout=300)
