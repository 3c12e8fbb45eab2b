# SPDX-License-Identifier: BSD-3-Clause
"""Progress of long work on standard error, only where a person watches."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def progress() -> Iterator[Callable[[str, float], None] | None]:
    """Give a callback that takes a stage and the share done, or None where nobody watches."""
    if not sys.stderr.isatty():
        yield None
        return
    try:
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
    except ImportError:  # the work can do without its bar
        yield None
        return
    columns = TextColumn("{task.description:<36}"), BarColumn(), TimeElapsedColumn()
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("reading", total=1.0)

        def callback(stage: str, done: float) -> None:
            bar.update(task, description=stage, completed=done)

        yield callback
