# SPDX-License-Identifier: BSD-3-Clause
"""Signals that end a run: Ctrl-C, a request to terminate, a terminal that went away; all end it alike."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

# a system that has no hang-up lacks its name
_ENDING = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))
_written: list[Path] = []


class Interrupted(KeyboardInterrupt):
    """A signal that ends the run, and the exit status that a shell gives it."""

    def __init__(self, number: int = signal.SIGINT) -> None:
        super().__init__()
        self.status = 128 + int(number)


@contextmanager
def signals_as_interruption() -> Iterator[None]:
    """Let a request to terminate, and a hang-up, end the run as Ctrl-C does: with what was begun removed.

    A signal that is ignored stays so: nohup asks for that.
    """
    _written.clear()
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {}
    for number in _ENDING[1:]:
        if signal.getsignal(number) == signal.SIG_DFL:
            before[number] = signal.signal(number, _interrupt)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _interrupt(number: int, frame: FrameType | None) -> None:
    raise Interrupted(number)


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Hold the signals back for a moment, so that what is inside is done in full; then they act."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    came: list[int] = []
    before = {}
    for number in _ENDING:
        handler = signal.getsignal(number)
        if callable(handler):
            before[number] = handler
            signal.signal(number, lambda which, frame: came.append(which))
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        if came:
            before[came[0]](came[0], None)


def note_written(paths: list[Path]) -> None:
    """Remember what is complete, so that an interruption afterwards does not deny it."""
    _written.extend(paths)


def sentence() -> str:
    """What an interrupted run left behind."""
    if not _written:
        return "interrupted; nothing was written"
    return f"interrupted; complete and written before: {', '.join(str(path) for path in _written)}"
