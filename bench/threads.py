"""One numerical thread a process, unless the user says otherwise. Import it before NumPy.

The fits' matrices are small: threads of the linear-algebra library spin more than they work, and runs use processes.
"""

from __future__ import annotations

import os

__all__ = ["LIBRARIES"]

LIBRARIES = ("OMP", "OPENBLAS", "MKL", "NUMBA")

for library in LIBRARIES:
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")
