# SPDX-License-Identifier: BSD-3-Clause
"""Signals that end a run: Ctrl-C, a request to terminate, a terminal that went away; all end it alike."""

import _thread
import signal
import sys
import threading
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

# a system that has no hang-up lacks its name
_ENDING = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))
_A_MOMENT = 0.05  # [s]: enough for compiled code to be left
_written: list[Path] = []
_came: list[int] = []


class Interrupted(KeyboardInterrupt):
    """A signal that ends the run, and the exit status that a shell gives it."""

    def __init__(self, number: int = signal.SIGINT) -> None:
        super().__init__()
        self.status = 128 + int(number)


@contextmanager
def signals_as_interruption() -> Iterator[None]:
    """Let Ctrl-C, a request to terminate and a hang-up end the run alike: with what was begun removed.

    A signal that is ignored stays so: nohup asks for that. A library into whose work the signal falls may
    drop the exception, since a callback from compiled code can raise none: then it is raised again a moment
    later. What else is dropped once a signal came is of the library that it fell into, and nobody's concern.
    """
    _written.clear()
    _came.clear()
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def again(dropped: "sys.UnraisableHookArgs") -> None:
        if issubclass(dropped.exc_type, Interrupted):
            timer = threading.Timer(_A_MOMENT, _thread.interrupt_main, [_came[-1]])
            timer.daemon = True
            timer.start()
        elif not _came:
            hook(dropped)

    hook = sys.unraisablehook
    before = {}
    for number in _ENDING:
        if signal.getsignal(number) in (signal.SIG_DFL, signal.default_int_handler):
            before[number] = signal.signal(number, _interrupt)
    sys.unraisablehook = again
    try:
        yield
    except Interrupted as interruption:
        # what was half made ends here, while its complaints are dropped
        traceback.clear_frames(interruption.__traceback__)
        raise
    finally:
        sys.unraisablehook = hook
        for number, handler in before.items():
            signal.signal(number, handler)


def _interrupt(number: int, frame: FrameType | None) -> None:
    _came.append(number)
    raise Interrupted(number)


@contextmanager
def no_other_error() -> Iterator[None]:
    """Let an interruption that a library has made an error of its own stay an interruption."""
    try:
        yield
    except Exception:
        if _came:
            raise Interrupted(_came[-1]) from None
        raise


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
