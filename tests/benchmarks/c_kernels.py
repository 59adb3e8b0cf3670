"""The hand-written C kernels, compiled and run on the spot: figures of another day or machine mean nothing."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from workloads import Floats

FLAGS = ("-O3", "-march=native", "-fopenmp-simd")
ROOF = Path(os.environ.get("HYSTBENCH_ROOF", Path(__file__).parents[2].parent / "shared" / "roof"))


@dataclass(frozen=True)
class Kernel:
    """Seconds of one pass over the input, and its output."""

    median: float
    least: float
    output: Floats


def missing() -> str | None:
    """Why there are no C kernels here; None if there are."""
    if not (ROOF / "roof.c").is_file():
        return f"no roof.c in {ROOF}; name its folder with HYSTBENCH_ROOF"
    return None if shutil.which("gcc") else "gcc is not installed"


def build(folder: Path) -> Path:
    """Compile the kernels into ``folder``."""
    program = folder / "roof"
    subprocess.run(["gcc", *FLAGS, "-o", str(program), str(ROOF / "roof.c"), "-lm"], check=True)
    (folder / "out").mkdir()
    return program


def run(program: Path, x: Floats) -> dict[str, Kernel]:
    """Every kernel over the input, seven passes each."""
    source = program.parent / "input.bin"
    x.astype("<f8").tofile(source)
    told = subprocess.run([str(program), str(source)], cwd=program.parent, check=True, capture_output=True, text=True)
    found = re.findall(r"^(\S+)\s+median\s+([\d.]+) ms\s+min\s+([\d.]+)", told.stdout, flags=re.MULTILINE)
    return {
        name: Kernel(
            1e-3 * float(median), 1e-3 * float(least), np.fromfile(program.parent / "out" / f"roof_{name}.bin")
        )
        for name, median, least in found
    }
