# SPDX-License-Identifier: BSD-3-Clause
"""Clocks that differ: a signal that moves before its cause, or later than any valve lets it."""

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording._screen_lags import (
    Lag,
    Values,
    filled,
    lags_of,
    longest_lag,
    quick,
    rising_curve,
    slow,
)
from sklvalve.recording._screen_lines import straight_lines
from sklvalve.recording._screen_pressures import Late, pressures_late
from sklvalve.recording._screen_tools import Finding, finding, quantum, recorded
from sklvalve.recording.noise import noise_floor
from sklvalve.recording.recording import Recording

_LEAST_ROWS = 300
_ROWS_FOR_PRESSURES = 2400  # their answers are faint: in a shorter recording chance has some as clear
_LONGEST_POSITIONER = -4  # rows by which a command may come before its stem
_SURELY_TOLD, _SURELY_AHEAD = 0.8, 4.0  # where the order of two columns rests on single rows
_TOLD = 0.5  # share of a signal's quick moves that its cause must explain before their order is judged
_CLEAR = 1.5  # strongest answer over the largest elsewhere
_LATE = 3  # rows; meters and pressure lines may lag by less
Shift = tuple[str, int, str]  # role, rows late, why
_BY_NOISE = "it answers the flow's noise before that is there"
_WATCHED = ("command", "opening", "flow", "p1", "p2")


def screen_clocks(recording: Recording) -> list[Finding]:
    """Signals whose clock is off, by what comes before its cause, or after it like a pure delay.

    The command moves the stem, the stem the flow, the flow the pressures, and the pressures the flow; each
    answer's delay is estimated by least squares over all lags, forward and back. An opening that is late
    behind the command is no finding where the flow is late with it: dead time does that too.
    """
    signals = {
        role: filled(recording[role])
        for role in _WATCHED
        if role in recording and role not in recording.constants and np.ptp(filled(recording[role])) > 0.0
    }
    if len(recording) < _LEAST_ROWS or len(signals) < 2:
        return []
    usable = np.all([np.isfinite(recording[role]) for role in signals], axis=0)
    usable[1:] &= np.diff(recording.time) < 1.5 * recording.sample_time
    lags = _lags(signals, usable, longest_lag(len(recording)))
    if _exchanged(recording, signals, lags):
        detail = "moves before the command, and jitters less: the columns of the two have changed places"
        return [finding("swapped", "opening", detail)]
    late = {}
    if len(recording) >= _ROWS_FOR_PRESSURES:
        late = pressures_late(signals, usable, longest_lag(len(recording)))
    shift = _told_by_order(lags, late) or _told_by_pressures(late)
    if shift is None or not _told_by_parts(shift, signals, usable, bool(late)):
        return []
    role, rows, why = shift
    seconds = abs(rows) * recording.sample_time
    way = "late" if rows > 0 else "early"
    detail = f"about {seconds:g} s too {way}, {why}: the clocks differ, or columns are swapped"
    return [finding("clock_shift", role, detail, size=rows * recording.sample_time)]


def _lags(signals: dict[str, Values], usable: NDArray[np.bool_], longest: int) -> dict[str, Lag]:
    """Lags by name of cause and answer, where the signals are there and the answer is clear."""
    found: dict[str, Lag] = {}
    command, opening, flow = (signals.get(role) for role in ("command", "opening", "flow"))
    if command is not None and opening is not None:
        found |= _named(("command>opening",), lags_of(quick(opening), [quick(command)], usable, longest))
    if flow is not None and command is not None:
        # a controller at work moves the command in nearly every row
        at_work = usable & (slow((np.diff(command, prepend=command[0]) != 0.0).astype(float)) > 0.8)
        noise, moves = _jitter(flow, at_work), _jitter(command, at_work)
        found |= _named(("flow>command",), lags_of(-moves, [noise], at_work, longest))
    moved = opening if opening is not None else command
    if flow is None or moved is None:
        return found
    name = "opening>flow" if opening is not None else "command>flow"
    # pressures that change places say nothing of time
    if not {"p1", "p2"} <= set(signals) or (signals["p1"] < signals["p2"]).mean() > 0.05:
        return found | _named(
            (name,), lags_of(quick(flow), [quick(rising_curve(moved, flow))], usable, longest)
        )
    drop = np.maximum(signals["p1"] - signals["p2"], 1e-3 * np.ptp(signals["p1"]) + 1.0)
    root, share = slow(np.sqrt(drop)), slow(flow) / (2.0 * slow(drop))
    passes = rising_curve(moved, flow / np.sqrt(drop))
    causes = [root * quick(passes), share * quick(signals["p1"]), -share * quick(signals["p2"])]
    return found | _named((name,), lags_of(quick(flow), causes, usable, longest)[:1])


def _jitter(values: Values, rows: NDArray[np.bool_]) -> Values:
    """Second differences, the large ones cut: what sensors and controllers do from row to row."""
    bend = np.diff(values, 2, prepend=values[:2])
    most = 6.0 * float(np.median(np.abs(bend[rows]))) if rows.any() else 0.0
    return np.clip(bend, -most, most)


def _told_by_parts(
    shift: Shift, signals: dict[str, Values], usable: NDArray[np.bool_], pressures: bool
) -> bool:
    """Whether the first and the last two thirds say the same, well inside the lags that can be searched.

    A fault of the valve makes one part look as if a clock were off more easily than both. A command that
    answers noise does so where a controller is at work, which may be in one part only.
    """
    count, longest, agree = len(usable), longest_lag(len(usable)), 0
    for part in (slice(0, 2 * count // 3), slice(count // 3, count)):
        moved = {role: values[part] for role, values in signals.items()}
        if any(np.ptp(values) == 0.0 for values in moved.values()) or abs(shift[1]) > longest - 3:
            return False
        late = pressures_late(moved, usable[part], longest) if pressures else {}
        told = _told_by_order(_lags(moved, usable[part], longest), late) or _told_by_pressures(late)
        if told is None and shift[2] == _BY_NOISE:
            continue
        if told is None or told[0] != shift[0] or abs(told[1] - shift[1]) > 2:
            return False
        agree += 1
    return agree > 0


def _named(names: tuple[str, ...], lags: list[Lag]) -> dict[str, Lag]:
    return dict(zip(names, lags, strict=True)) if lags else {}


def _exchanged(recording: Recording, signals: dict[str, Values], lags: dict[str, Lag]) -> bool:
    """Whether the command is a sensor's, and the opening what drives it by the lag of a positioner."""
    stem = lags.get("command>opening")
    if stem is None or not _LONGEST_POSITIONER <= min(stem.peak, stem.half) <= -1:
        return False
    sensor, driver = (signals[role][signals[role] > 0.03] for role in ("command", "opening"))
    jitter, other = noise_floor(sensor), noise_floor(driver)
    if _before(stem) and jitter > 1.2 * other:
        # lines that a historian redrew jitter less than any command, and are early by their breadth
        values = recorded(recording, "opening")
        return straight_lines(recording.time, values, quantum(values)) is None
    if stem.peak > -1 or stem.told < _SURELY_TOLD or stem.prominence < _SURELY_AHEAD:
        return False
    if jitter > 3.0 * other and _resting(signals["opening"]) > 0.3 > _resting(signals["command"]):
        return True
    step = quantum(recorded(recording, "command"))
    jitter = noise_floor(recorded(recording, "command"))
    return step > 2.0 * quantum(recorded(recording, "opening")) and jitter > 0.5 * step


def _resting(values: Values) -> float:
    """Share of the rows that repeat the one before exactly."""
    return float((np.diff(values) == 0.0).mean())


def _before(lag: Lag | None) -> int:
    """Rows by which an answer comes before its cause, else 0."""
    if lag is None or lag.told < _TOLD or lag.prominence < _CLEAR:
        return 0
    return -min(lag.peak, lag.half) if lag.half <= -1 and lag.peak <= 0 else 0


def _after(lag: Lag | None) -> int:
    """Rows by which an answer follows its cause like a pure delay, else 0."""
    if lag is None or lag.told < _TOLD or lag.prominence < 1.8 or lag.peak < _LATE:
        return 0
    # an answer drawn out to both sides is a weak one, not a late one
    return lag.peak if lag.early < 0.2 else 0


def _told_by_order(lags: dict[str, Lag], late: dict[str, Late]) -> Shift | None:
    """The one of command, opening and flow whose clock is off: role, rows late, and why."""
    stem, water = lags.get("command>opening"), lags.get("opening>flow")
    stem_first, water_first, water_after = _before(stem), _before(water), _after(water)
    if stem_first:
        both = len(late) == 2 and all(abs(each.rows - stem_first) <= 2 for each in late.values())
        if water is None or water_after or both:
            return "opening", -stem_first, "it moves before the command, its cause"
        return "command", stem_first, "the opening moves before it, and the flow with the opening"
    if water_first:
        return _opening_or_flow(lags, water_first)
    if water_after:
        return "flow", water_after, "it follows the opening only after a pure delay"
    only = _before(lags.get("command>flow"))
    if only and lags["command>flow"].prominence >= 3.0:
        return "flow", -only, "it moves before the command, its cause"
    noise = lags.get("flow>command")
    if (
        stem is not None
        and noise is not None
        and noise.told > _TOLD
        and noise.peak <= -2
        # a command that is written early has its stem late by as much; a stem of its own is slow by any time
        and stem.peak >= max(-noise.peak, _LATE)
    ):
        return "command", noise.peak - 1, _BY_NOISE
    return None


def _opening_or_flow(lags: dict[str, Lag], rows: int) -> tuple[str, int, str]:
    """Which of the two is off where the flow moves before the opening."""
    late = lags["command>opening"].peak if "command>opening" in lags else 0
    if late >= max(2, rows - 1):
        return "opening", rows, "the flow moves before it, its cause"
    return "flow", -rows, "it moves before the opening, its cause"


def _told_by_pressures(late: dict[str, Late]) -> Shift | None:
    """The pressure whose clock is off; where both are off alike, it is the flow's, and the stem's with it."""
    off = {role: each for role, each in late.items() if each.rows}
    if len(off) == 2 and abs(off["p1"].rows - off["p2"].rows) <= 2:
        return "flow", -off["p1"].rows, "by how both pressures answer it, and it them"
    if not off:
        return None
    role = max(off, key=lambda each: off[each].evidence)
    return role, off[role].rows, "by how it answers the flow, and the flow it"
