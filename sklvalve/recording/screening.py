# SPDX-License-Identifier: BSD-3-Clause
"""What is wrong with the data themselves, before any physics is asked."""

from sklvalve.recording._screen_clocks import screen_clocks
from sklvalve.recording._screen_meaning import screen_swapped, screen_units
from sklvalve.recording._screen_time import screen_compressed, screen_gaps
from sklvalve.recording._screen_tools import Finding
from sklvalve.recording._screen_values import screen_frozen, screen_quantised, screen_saturated
from sklvalve.recording.recording import Recording

_SCREENS = (
    screen_swapped,
    screen_units,
    screen_gaps,
    screen_clocks,
    screen_compressed,
    screen_frozen,
    screen_saturated,
    screen_quantised,
)


def screen_recording(recording: Recording) -> list[Finding]:
    """Say what is wrong with the data of a recording; nothing is changed or mended.

    A first cut, and a cautious one: each screen speaks only where noise, a valve at its stop or a held
    command cannot explain what it sees. None of the findings is missing physics; they say what the recording
    cannot show.

    ============  ===========================================================================================
    finding       what was seen
    ============  ===========================================================================================
    swapped       p2 above p1 in a fifth of the rows or more
    unit_suspect  opening of at most 1 in %, opening against the command, a temperature or a pressure that no
                  plant has, flow far from what the rated capacity passes
    gap           values missing in a signal, or rows missing between the times (role None)
    clock_shift   opening moves before the command, or flow before the opening, alike in all thirds of the
                  recording
    compressed    course made of straight lines of new slope, of jumps above a dead band, or of held scans
    frozen        a sensor that repeats one value far longer than its own jitter allows
    saturated     values piled up at an end of the range that is neither a stop of the stem nor no flow
    quantised     steps coarser than the noise, or than 1/300 of the signal's span; the step is stated
    ============  ===========================================================================================

    Parameters
    ----------
    recording : Recording

    Returns
    -------
    findings : list of dict
        Each with ``finding`` (a name above), ``role`` (None for the times), ``detail`` (a sentence for
        people, in the recording's own units) and ``rows`` (list of [start, stop) row spans, None where it
        concerns all rows). Plain data, fit for JSON.

    Examples
    --------
    >>> import numpy as np
    >>> from sklvalve.recording import Recording, screen_recording
    >>> flow = 0.01 + 1e-4 * np.random.default_rng(0).normal(size=500)
    >>> flow[100:110] = np.nan
    >>> recording = Recording.from_frame({"time": np.arange(500.0), "flow": flow})
    >>> [(found["finding"], found["rows"]) for found in screen_recording(recording)]
    [('gap', [[100, 110]])]
    """
    found = [each for screen in _SCREENS for each in screen(recording)]
    # a course redrawn from few points, or cut at an end of the range, stands still without being frozen
    explained = {each["role"] for each in found if each["finding"] in ("compressed", "saturated")}
    return [each for each in found if each["finding"] != "frozen" or each["role"] not in explained]
