"""Time limits that a hanging model cannot escape."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

__all__ = ["CellTimeoutError", "time_limit"]

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
