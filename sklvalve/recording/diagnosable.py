# SPDX-License-Identifier: BSD-3-Clause
"""What must hold before a recording is diagnosed: else its finding would be wrong, or none."""

import numpy as np

from sklvalve.recording._mistaken import (
    require_likely_signals,
    require_liquid_water,
    require_magnitudes,
)
from sklvalve.recording._supported import require_supported
from sklvalve.recording._tell import column_of, written
from sklvalve.recording.errors import InputError
from sklvalve.recording.recording import Recording
from sklvalve.recording.standing import stem_may_stand

# rows of a recording; fewer hold no effect apart from another
FEWEST_ROWS = 120
# rows with all that a channel needs: in all, and left when any quarter of the recording is held out
_FEWEST_TOGETHER, _FEWEST_LEFT = 40, 20
_BLOCKS = 4


def require_diagnosable(recording: Recording) -> None:
    """Refuse a recording from which no diagnosis, or only a wrong one, can come.

    `read_recording` takes all that can be screened, plotted and kept; this asks for what a diagnosis needs
    besides: a valve of a kind that can be simulated, signals that are not evidently in another unit or of the
    other sense, and enough rows in which what drives a signal, and the signal itself, move. An opening may
    hold one value where the command moves and the flow does not follow it: the stem may have seized.

    Parameters
    ----------
    recording : Recording
        The rows that the diagnosis is to use.

    Raises
    ------
    InputError
        With one sentence that names the column, or the key of the valve.toml, and the mend.

    Examples
    --------
    >>> import numpy as np
    >>> from sklvalve.recording import InputError, Recording
    >>> from sklvalve.recording.diagnosable import require_diagnosable
    >>> time = np.arange(200.0)
    >>> frame = {"time": time, "command": np.full(200, 0.5), "flow": 0.01 + 1e-4 * np.sin(time)}
    >>> try:
    ...     require_diagnosable(Recording.from_frame(frame))
    ... except InputError as error:
    ...     print(str(error).split(", from")[0])
    data frame: column 'command' (command) holds one value, 0.5
    """
    require_supported(recording.valve)
    require_rows(recording)
    _require_values(recording)
    require_likely_signals(recording)
    _require_target(recording)
    for driver in ("simulated_opening", "command"):
        if driver in recording and "opening" in recording:
            _require_channel(recording, "opening", driver)
            break
    if "flow" in recording:
        _require_pressure_drop(recording)
        for driver in ("simulated_flow", "opening", "command"):
            if driver in recording:
                _require_channel(recording, "flow", driver)
                break


def is_loop(recording: Recording) -> bool:
    """Whether a recording is a loop known by command and value only.

    Parameters
    ----------
    recording : Recording

    Returns
    -------
    loop : bool
        True with a command and a flow or another process value, and neither opening, nor pressures at the
        valve, nor a simulation's columns.
    """
    more = {"opening", "p1", "p2", "actuator_pressure", "simulated_flow", "simulated_opening"}
    held = set(recording.signals)
    loop = "command" in held and ("process_value" in held or "flow" in held)
    return loop and not held & more


def require_rows(recording: Recording, more: str = "") -> None:
    """Refuse a recording that is too short to be diagnosed, whatever it holds.

    Parameters
    ----------
    recording : Recording
        The rows that the diagnosis is to use.
    more : str, default=""
        What else may mend it, behind the number of rows to give.

    Raises
    ------
    InputError
        If there are fewer than `FEWEST_ROWS`.
    """
    if len(recording) < FEWEST_ROWS:
        raise InputError(
            f"{recording.source}: {len(recording)} rows are too few for a diagnosis; "
            f"give at least {FEWEST_ROWS}{more}"
        )


def require_predictable(recording: Recording) -> None:
    """Refuse a recording for which no simulation gives more than nonsense, whichever of its signals it needs.

    Parameters
    ----------
    recording : Recording

    Raises
    ------
    InputError
        If a value is far beyond any plant, or water would boil before the valve.
    """
    require_magnitudes(recording)
    require_liquid_water(recording)


def _require_target(recording: Recording) -> None:
    for role in ("flow", "opening"):
        if f"simulated_{role}" in recording and role not in recording:
            raise InputError(
                f"{column_of(recording, f'simulated_{role}')} is a simulation of the {role}, which is not "
                f"recorded; name the column of the recorded {role}, or leave the role out"
            )


def _require_values(recording: Recording) -> None:
    for role, values in recording.signals.items():
        if not np.isfinite(values).any():
            raise InputError(
                f"{column_of(recording, role)} holds no value in the {len(recording)} rows to be used; "
                "use more rows, or leave the role out"
            )


def _require_channel(recording: Recording, channel: str, driver: str) -> None:
    """Both move, and are recorded together in enough rows of more than one part of the recording."""
    for role in (driver, channel):
        if not (role == "opening" and stem_may_stand(recording)):
            _require_movement(recording, role)
    together = np.isfinite(recording[channel]) & np.isfinite(recording[driver])
    needed = [driver]
    if channel == "flow":
        for role in ("p1", "p2"):
            if role in recording and role not in recording.constants:
                together &= np.isfinite(recording[role])
                needed.append(role)
    left = together.sum() - max(part.sum() for part in np.array_split(together, _BLOCKS))
    others = ", ".join(needed)
    if together.sum() < _FEWEST_TOGETHER:
        raise InputError(
            f"{column_of(recording, channel)}: only {together.sum()} of {len(recording)} rows hold it "
            f"together with {others}; give at least {_FEWEST_TOGETHER} such rows"
            + (", or leave the role out" if channel == "opening" or together.sum() == 0 else "")
        )
    if left < _FEWEST_LEFT:
        raise InputError(
            f"{column_of(recording, channel)}: nearly all rows that hold it together with {others} lie in "
            "one quarter of the recording, which leaves no other to prove a diagnosis on; "
            "give rows that hold it throughout"
        )


def _require_movement(recording: Recording, role: str) -> None:
    values = recording[role]
    seen = values[np.isfinite(values)]
    if np.ptp(seen) <= 1e-9 * np.abs(seen).max():
        raise InputError(
            f"{column_of(recording, role)} holds one value, {written(recording, role, seen[0])}, from first "
            "to last row; a diagnosis needs a recording in which it moves"
        )


def _require_pressure_drop(recording: Recording) -> None:
    if not {"p1", "p2"} <= set(recording.signals):
        return
    drop = recording["p1"] - recording["p2"]
    if not np.isfinite(drop).any():
        raise InputError(
            f"{column_of(recording, 'p1')}: no row holds it together with p2; record both in the same rows, "
            "or leave both roles out"
        )
    if not (drop > 0.0).any():
        raise InputError(
            f"{column_of(recording, 'p1')}: p1 is nowhere above p2, so nothing drives a flow; name the "
            "columns before and behind the valve, or leave both roles out"
        )
