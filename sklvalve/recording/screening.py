# SPDX-License-Identifier: BSD-3-Clause
"""What is wrong with the data themselves, before any physics is asked."""

from sklvalve.recording._screen_clocks import screen_clocks
from sklvalve.recording._screen_compressed import screen_compressed
from sklvalve.recording._screen_meaning import screen_swapped, screen_units
from sklvalve.recording._screen_pieces import screen_pieces
from sklvalve.recording._screen_swaps import screen_readings
from sklvalve.recording._screen_time import screen_gaps
from sklvalve.recording._screen_tools import Finding
from sklvalve.recording._screen_values import screen_frozen, screen_quantised, screen_saturated
from sklvalve.recording.recording import Recording

_SCREENS = (
    screen_swapped,
    screen_readings,
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
    swapped       p2 above p1 in a fifth of the rows or more; two columns that fit far better exchanged; an
                  opening that moves before the command and jitters less
    unit_suspect  opening of at most 1 in %, opening against the command, a temperature or a pressure that no
                  plant has, flow far from what the rated capacity or the sheet's trim passes, a pressure
                  that fits far better in another unit
    gap           values missing in a signal, or rows missing between the times (role None)
    clock_shift   a signal moves before its cause; or flow, or a pressure, comes late like a pure delay.
                  An opening late behind the command is none: dead time looks the same
    compressed    course made of straight lines of new slope, of jumps above a dead band, or of held scans; or
                  samples that lie on the line through their neighbours far more often than noise puts them
    frozen        a sensor that repeats one value far longer than its own jitter allows
    saturated     values piled up at an end of the range that is neither a stop of the stem nor no flow
    quantised     steps coarser than the noise, or than 1/500 of the signal's span; the step is stated
    ============  ===========================================================================================

    Parameters
    ----------
    recording : Recording

    Returns
    -------
    findings : list of dict
        Each with ``finding`` (a name above), ``role`` (None for the times), ``detail`` (a sentence for
        people, in the recording's own units) and ``rows`` (list of [start, stop) row spans, None where it
        concerns all rows). Some have ``size``: seconds that a clock is late (negative: early), the
        share of the span that a step takes, or a historian's dead band [SI]. Plain data, fit for JSON.

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
    if not recording.pieces:
        return _screened(recording)
    return screen_pieces(recording, _screened)


def _screened(recording: Recording) -> list[Finding]:
    found = [each for screen in _SCREENS for each in screen(recording)]
    return [each for each in _once(found) if not _explained(each, found)]


def _once(found: list[Finding]) -> list[Finding]:
    """One finding of a name in a channel: that of the screen that speaks first."""
    first: dict[tuple[object, object], Finding] = {}
    for each in found:
        first.setdefault((each["finding"], each["role"]), each)
    return list(first.values())


def _explained(told: Finding, found: list[Finding]) -> bool:
    """Whether another finding is the reason of this one, so that it would only mislead."""
    name, beside = told["finding"], {each["finding"] for each in found if each["role"] == told["role"]}
    everywhere = {each["finding"] for each in found}
    if name == "frozen":
        # a course redrawn from few points, or cut at an end of the range, stands still without being frozen
        return bool(beside & {"compressed", "saturated"}) or "swapped" in everywhere
    if name == "swapped":
        return ("unit_suspect", "opening") in {(each["finding"], each["role"]) for each in found}
    if name == "compressed":
        return "swapped" in everywhere
    return name == "clock_shift" and bool(everywhere & {"swapped", "unit_suspect", "compressed"})
