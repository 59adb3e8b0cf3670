"""Limits of time and memory that a model cannot escape."""

from __future__ import annotations

import os
import resource
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

__all__ = ["CellTimeoutError", "memory_limit", "time_limit"]

GRACE = 5.0
"""Seconds after the limit at which a process that does not react is ended."""


class CellTimeoutError(BaseException):
    """The time limit has passed. Not an Exception, so that a model's own handlers do not swallow it."""


@contextmanager
def time_limit(seconds: float) -> Iterator[None]:
    """Raise CellTimeoutError in the main thread after ``seconds``.

    Python code is interrupted by a signal. Code that never returns to the interpreter cannot be, so ``GRACE`` seconds
    later a second timer ends the process; its parent sees that and charges it to the cell.
    """

    def expired(signum: int, frame: FrameType | None) -> None:
        raise CellTimeoutError

    last_resort = threading.Timer(seconds + GRACE, os._exit, args=(70,))
    last_resort.daemon = True
    previous = signal.signal(signal.SIGALRM, expired)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    last_resort.start()
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, previous)
        last_resort.cancel()


@contextmanager
def memory_limit(gibibytes: float) -> Iterator[None]:
    """Let the process take at most ``gibibytes`` more than it has; beyond them allocations raise MemoryError.

    The kernel keeps the limit, so that it also holds in compiled code. Linux only: elsewhere it is no limit.
    """
    if not sys.platform.startswith("linux"):
        yield
        return
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[5])
    wanted = pages * resource.getpagesize() + int(gibibytes * 2**30)
    soft, hard = resource.getrlimit(resource.RLIMIT_DATA)
    ceilings = [limit for limit in (soft, hard) if limit != resource.RLIM_INFINITY]
    resource.setrlimit(resource.RLIMIT_DATA, (min([wanted, *ceilings]), hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_DATA, (soft, hard))
