"""What a plug-in may do to its process without touching the cells that follow it there."""

from __future__ import annotations

import os
import random
import warnings
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

__all__ = ["restored_process_state"]


@contextmanager
def restored_process_state() -> Iterator[None]:
    """Put back the working directory, the environment and the global settings of NumPy and random afterwards."""
    folder, environment = os.getcwd(), dict(os.environ)
    errors, printing = np.geterr(), np.get_printoptions()
    numpy_state, random_state = np.random.get_state(), random.getstate()  # noqa: NPY002 (only kept, never drawn from)
    try:
        with warnings.catch_warnings():
            yield
    finally:
        os.chdir(folder)
        if dict(os.environ) != environment:
            os.environ.clear()
            os.environ.update(environment)
        np.seterr(**errors)
        np.set_printoptions(**printing)
        np.random.set_state(numpy_state)  # noqa: NPY002
        random.setstate(random_state)
