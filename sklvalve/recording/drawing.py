# SPDX-License-Identifier: BSD-3-Clause
"""A recording drawn over time, before any diagnosis, in the units that it was recorded in."""

from datetime import datetime
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording.errors import InputError, one_line, shown
from sklvalve.recording.signal import OPENING_ROLES, Signal
from sklvalve.recording.thinning import decimate

if TYPE_CHECKING:
    from sklvalve.recording.recording import Recording

# of one panel [inch]; of several, points to which a course is thinned
_WIDE, _HIGH, _POINTS = 7.6, 1.7, 3000
# what a command shows is asked for, and stands behind what was measured
_BEHIND = ("command", "setpoint", "simulated_flow", "simulated_opening")


def draw(recording: "Recording", roles: Any, ax: Any) -> NDArray:
    """Axes with the courses of a recording; `Recording.plot` says what it takes and gives."""
    panels = _panels(recording, _chosen(recording, roles))
    axes = _axes(ax, len(panels))
    times, label = _times(recording)
    for each, (unit, members) in zip(axes, panels, strict=True):
        for depth, role in enumerate(members):
            _course(each, recording, role, times, depth)
        each.set_ylabel(f"[{unit}]")
        each.legend(loc="upper right", fontsize="small")
        for low, _ in recording.spans[1:]:
            each.axvline(times[low], color="0.7", linewidth=0.8)
    axes[-1].set_xlabel(label)
    return axes


def _chosen(recording: "Recording", roles: Any) -> list[str]:
    if roles is None:
        chosen: list = [role for role in recording.signals if role not in recording.constants]
    else:
        try:
            chosen = [roles] if isinstance(roles, str) else list(roles)
        except TypeError:
            chosen = [None]
        if not all(isinstance(role, str) for role in chosen):
            raise InputError(f"roles is {shown(roles)}; give one role, such as 'flow', or a list of these")
        for role in chosen:
            recording[role]
    if not chosen or not len(recording):
        raise InputError(f"{recording.source}: there is nothing to draw; name roles that were recorded")
    return chosen


def _panels(recording: "Recording", roles: list[str]) -> list[tuple[str, list[str]]]:
    """Unit and roles of each panel: what is recorded in one unit, and one way, stands in one."""
    panels: dict[tuple, list[str]] = {}
    for role in roles:
        signal = recording.signal(role)
        kind = "travel" if role in OPENING_ROLES else signal.quantity
        panels.setdefault((kind, unit_words(signal)), []).append(role)
    return [(unit, sorted(members, key=_BEHIND.__contains__)) for (_, unit), members in panels.items()]


def unit_words(signal: Signal) -> str:
    """Unit of a signal, and from where or which way it counts."""
    more = ", gauge" if signal.gauge else ", closing" if signal.sense == "closing" else ""
    return f"{signal.unit}{more}"


def _times(recording: "Recording") -> tuple[NDArray, str]:
    """Times of the rows, and what to call them: dates where there are dates."""
    first = recording.stamps[0]
    if isinstance(first, str):
        begin = datetime.fromisoformat(first.strip())
        # one offset for the whole axis, that of the first row: clocks that are changed leave no gap
        offset = begin.isoformat()[-6:] if begin.utcoffset() else ""
        label = "time" if begin.tzinfo is None else f"time (UTC{offset})"
        since = np.round((recording.time - recording.time[0]) * 1e6).astype("timedelta64[us]")
        return np.datetime64(begin.replace(tzinfo=None), "us") + since, label
    if recording.pieces:
        return recording.time, "time from the first sample [s]"
    return recording.stamps.astype(float), "time [s]"


def _course(ax: Any, recording: "Recording", role: str, times: NDArray, depth: int) -> None:
    values, colour = recording.in_recorded_units(role, recording[role]), None
    for low, high in recording.spans:
        (line,) = ax.plot(
            *decimate(times[low:high], values[low:high], _POINTS),
            color=colour,
            linewidth=0.9,
            # a single row is no line
            marker="." if high - low == 1 else None,
            zorder=2.0 - 0.1 * depth,
            label=one_line(role.replace("_", " ")) if colour is None else None,
        )
        colour = line.get_color()


def _axes(ax: Any, count: int) -> NDArray:
    if ax is not None:
        axes = np.ravel(np.asarray(ax, dtype=object))
        if len(axes) != count:
            raise ValueError(
                f"ax must hold {count} axes, one for each kind of signal and unit; got {len(axes)}"
            )
        return axes
    try:
        import matplotlib.pyplot as plt
    except ImportError:
        raise ImportError('pictures need matplotlib: pip install "sklvalve[plot]"') from None
    size = (_WIDE, _HIGH * count + 0.4)
    _, axes = plt.subplots(count, 1, figsize=size, sharex=True, squeeze=False, layout="constrained")
    return axes[:, 0]
