# SPDX-License-Identifier: BSD-3-Clause
"""An opening that holds one value while the command moves: a seized stem, or a sensor that stands still?"""

import numpy as np

from sklvalve.recording.recording import Recording

# a command that moves by less may stay within an ordinary friction band
_MOVES = 0.02
# a flow that follows the command has this much correlation with it, at one of these delays at least
_FOLLOWS = 0.5
_DELAYS = (0, 1, 2, 5, 10, 20, 40)
_FEWEST = 20


def stem_may_stand(recording: Recording, start: int = 0, stop: int | None = None) -> bool:
    """Whether rows in which the opening holds one value may be those of a seized stem.

    They may where the command moves by more than 2 % of travel meanwhile, and the flow, freed from the
    pressure drop by its root where that is recorded, does not follow it (correlation at most 0.5 at every
    delay up to 40 rows): a flow that follows tells that the stem moves, and only its sensor stands still.

    Parameters
    ----------
    recording : Recording
    start, stop : int
        The rows in which the opening holds one value; all unless given.

    Returns
    -------
    may : bool

    Examples
    --------
    >>> import numpy as np
    >>> from sklvalve.recording import Recording
    >>> from sklvalve.recording.standing import stem_may_stand
    >>> command = 0.5 + 0.2 * np.sin(np.arange(200.0) / 9)
    >>> frame = {"time": np.arange(200.0), "command": command, "opening": np.full(200, 0.5), "flow": command}
    >>> stem_may_stand(Recording.from_frame(frame))
    False
    """
    if "command" not in recording or "opening" not in recording:
        return False
    command = recording["command"][start:stop]
    if not np.isfinite(command).any() or np.nanmax(command) - np.nanmin(command) <= _MOVES:
        return False
    if "flow" not in recording:
        return True
    passed = recording["flow"][start:stop]
    if {"p1", "p2"} <= set(recording.signals):
        drop = (recording["p1"] - recording["p2"])[start:stop]
        passed = passed / np.sqrt(np.where(drop > 0.0, drop, np.nan))
    delays = [k for k in _DELAYS if k <= len(command) - _FEWEST]
    return all(_correlation(command[: len(command) - k], passed[k:]) <= _FOLLOWS for k in delays)


def _correlation(cause: np.ndarray, answer: np.ndarray) -> float:
    both = np.isfinite(cause) & np.isfinite(answer)
    if both.sum() < _FEWEST or np.ptp(cause[both]) == 0.0 or np.ptp(answer[both]) == 0.0:
        return 0.0
    return float(np.corrcoef(cause[both], answer[both])[0, 1])
