# SPDX-License-Identifier: BSD-3-Clause
"""Progress of long work on standard error, only where a person watches."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from sklvalve.cli.terminal import safe

_FOREVER = 1e9  # s


@contextmanager
def progress() -> Iterator[Callable[[str, float], None] | None]:
    """Give a callback that takes a stage and the share done, or None where nobody watches."""
    if not sys.stderr.isatty():
        yield None
        return
    try:
        from rich.console import Console
        from rich.markup import escape
        from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
    except ImportError:  # the work can do without its bar
        yield None
        return
    columns = (
        TextColumn("{task.description:<36}"),
        BarColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    # stages differ in speed: the time left is told by all that was done so far
    console = Console(stderr=True)
    with Progress(*columns, console=console, transient=True, speed_estimate_period=_FOREVER) as bar:
        task = bar.add_task("reading", total=1.0)

        def callback(stage: str, done: float) -> None:
            bar.update(task, description=escape(safe(stage)), completed=done)

        yield callback
