# SPDX-License-Identifier: BSD-3-Clause
"""Recordings of one simulated plant, and changed copies of them."""

from dataclasses import replace
from functools import cache

import numpy as np

from sklvalve.datasets import make_valve_recording
from sklvalve.recording import Recording, Valve

ROWS = 1_200


@cache
def made():
    """A healthy valve, its first rows and the ones behind them."""
    bunch = make_valve_recording(None, loop="wide", n_samples=ROWS, n_later=ROWS, random_state=3)
    valve = Valve.from_dict(bunch.valve)
    return tuple(Recording.from_frame(frame, valve) for frame in (bunch.frame, bunch.later))


def named(recording, name):
    """The same recording from a file of that name."""
    return replace(recording, source=f"plant/{name}.csv")


def without(recording, *roles):
    """The same recording without some signals."""
    return replace(recording, signals={r: v for r, v in recording.signals.items() if r not in roles})


def changed(recording, **signals):
    """The same recording with other values of some signals."""
    return replace(recording, signals=recording.signals | signals)


def held(recording, role, value=None):
    """The same recording in which a signal holds one value."""
    value = float(np.nanmedian(recording[role])) if value is None else value
    return changed(recording, **{role: np.full(len(recording), value)})


def dated(recording, day, offset=""):
    """The same recording, begun at midnight of a day."""
    seconds = (recording.time - recording.time[0]).astype(int)
    moments = np.datetime64(day) + seconds.astype("timedelta64[s]")
    return replace(recording, stamps=np.array([f"{each}{offset}" for each in moments], dtype=object))


def of_sheet(recording, **fields):
    """The same recording of a valve whose data sheet says something else."""
    return replace(recording, valve=replace(recording.valve, **fields))
