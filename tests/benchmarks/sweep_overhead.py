"""What a run costs beside its cells: `python tests/benchmarks/sweep_overhead.py [CELLS]`, 10,000 by default.

The cells are the smallest that `hystbench run` makes: the cheapest model on one clean loop, timed as briefly as --quick
times. Overhead is the share of the processes' time that went to anything but computing cells: starting and feeding the
processes, keys, and writing each finished cell at once, so that a killed run loses none. It is told of processor
time (the parent's included), which neighbours on the machine leave alone, and of the wall clock, which they do not.
"""

from __future__ import annotations

import json
import os
import resource
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from hystbench import datasets, models
from hystbench.bench import cells, run
from hystbench.bench.cells import CellSpec

JOBS = 2


def sweep(count: int) -> dict[str, float]:
    """Measure one run of ``count`` cells of the fastest built-in model on the built-in loop with the fewest samples."""
    name, condition = "vsa-published", "clean"
    dataset = datasets.get(name)().load()
    digest = cells.data_hash(dataset)
    specs = [
        CellSpec(
            "linear" if "linear" in models.ids() else "cubic",
            name,
            condition,
            seed,
            digest,
            False,
            60.0,
            run.QUICK_TIMING_TIME,
        )
        for seed in range(count)
    ]
    plan = run.Plan(specs, {name: dataset}, {name: digest}, [specs[0].model], list(range(count)))
    with tempfile.TemporaryDirectory() as folder:
        arrived, cpu = [time.perf_counter()], _processor_time()
        run.run(plan, Path(folder), JOBS, True, ["sweep"], lambda cell: arrived.append(time.perf_counter()))
        end = time.perf_counter()
        cpu = _processor_time() - cpu
        done = [json.loads(path.read_text()) for path in Path(folder, "cells").glob("*.json")]
    elapsed, computed = ([cell[name] for cell in done] for name in ("elapsed_s", "cpu_s"))
    return {
        "cells": count,
        "wall_s": end - arrived[0],
        "start_s": arrived[1] - arrived[0],
        "end_s": end - arrived[-1],
        "cell_ms": 1e3 * float(np.median(computed)),
        "overhead of processor time": 1.0 - sum(computed) / cpu,
        "overhead of wall clock": 1.0 - sum(elapsed) / (JOBS * (end - arrived[0])),
    }


def _processor_time() -> float:
    """Of this process and of those of its children that have ended, s."""
    usage = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(u.ru_utime + u.ru_stime for u in usage)


if __name__ == "__main__":
    os.environ.update({"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"})
    for key, value in sweep(int(sys.argv[1]) if len(sys.argv) > 1 else 10_000).items():
        print(f"{key:<30}{value:.4g}")
