"""What a plug-in may do to its process without touching the cells that follow it there."""

from __future__ import annotations

import os
import random
import warnings
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import psutil

__all__ = ["no_other_processes", "restored_process_state"]


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


@contextmanager
def no_other_processes() -> Iterator[None]:
    """End every process that a plug-in forked: a copy of this one must not go on and deliver the cell a second time."""
    here = os.getpid()
    try:
        yield
    finally:
        if os.getpid() != here:
            os._exit(0)
        if _has_children():
            children = psutil.Process(here).children(recursive=True)
            for child in children:
                child.kill()
            psutil.wait_procs(children, timeout=5.0)


def _has_children() -> bool:
    """Whether any child runs: one system call, where walking the process table would cost a small cell its time."""
    try:
        os.waitpid(-1, os.WNOHANG)
    except ChildProcessError:
        return False
    return True
