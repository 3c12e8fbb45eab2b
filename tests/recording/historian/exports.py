# SPDX-License-Identifier: BSD-3-Clause
"""Made exports of the kinds that historians write."""

from datetime import UTC, datetime, timedelta
from zoneinfo import ZoneInfo

import numpy as np

WARSAW = ZoneInfo("Europe/Warsaw")


def moments(start, count, step):
    """Moments in UTC, `step` seconds apart."""
    first = datetime.fromisoformat(start).replace(tzinfo=UTC)
    return [first + timedelta(seconds=step * row) for row in range(count)]


def course(count, low=10.0, high=14.0, period=40.0):
    """Values that wander between two bounds, to two digits."""
    wave = np.sin(2.0 * np.pi * np.arange(count) / period)
    return np.round(0.5 * (low + high) + 0.5 * (high - low) * wave, 2)


def long_text(
    tags, stamps, values, *, separator=";", comma=True, header="Tag;Time;Value;Quality", quality="Good"
):
    """Long format: all rows of the first tag, then of the second."""
    lines = [header.replace(";", separator)]
    for tag in tags:
        for stamp, value in zip(stamps, values, strict=True):
            cell = value if isinstance(value, str) else f"{value:.2f}"
            lines.append(separator.join([tag, stamp, cell.replace(".", ",") if comma else cell, quality]))
    return "\n".join(lines) + "\n"


def wide_text(names, stamps, columns, separator=","):
    """Wide format: a column for each tag."""
    rows = [separator.join(["time", *names])]
    rows += [
        separator.join([stamp, *(cell if isinstance(cell, str) else f"{cell:.2f}" for cell in cells)])
        for stamp, *cells in zip(stamps, *columns, strict=True)
    ]
    return "\n".join(rows) + "\n"


def iso(times):
    """Stamps without a zone."""
    return [f"{time:%Y-%m-%d %H:%M:%S}" for time in times]


def local(times, zone=WARSAW, form="%d.%m.%Y %H:%M:%S"):
    """Stamps of the clock on the wall."""
    return [time.astimezone(zone).strftime(form) for time in times]
