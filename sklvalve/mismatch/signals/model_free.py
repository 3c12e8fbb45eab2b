# SPDX-License-Identifier: BSD-3-Clause
"""What a recording alone tells of the noise of its signals, beside what the noise model says."""

from __future__ import annotations

from typing import Any

from sklvalve.mismatch.signals.repeats import repeats_floor
from sklvalve.mismatch.signals.steady import drivers_of, steady_floor
from sklvalve.recording import Recording
from sklvalve.recording.dead_bands import step_of

# a noise model is clearly above the noise of steady stretches from here on; on healthy recordings of a plant
# with known noise it was so in none (benchmarks/concealed/results)
CLEARLY_ABOVE = 1.5
# rows that come back to the same drivers and differ by more than this many times the quick noise differ by
# more than noise: the signal remembers, or something has changed since
_ABOVE_NOISE = 2.0
# what a floor from a few hundred rows may be wrong by
_ROUGHLY = 1.05


def model_free_noise(
    recording: Recording, channel: str, floor: float, achieved: float | None = None
) -> dict[str, Any]:
    """The ``model_free`` part of a channel's ``fit`` entry of diagnosis.json, in the recording's own units.

    Parameters
    ----------
    recording : Recording
    channel : {"opening", "flow"}
    floor : float
        What the noise model says: the sensor's white noise and its quick movement [SI].
    achieved : float, default=None
        Error of the corrected simulation on held-out rows, in the recording's own unit.

    Returns
    -------
    entry : dict
        ``unit``; ``steady``: quick noise in stretches in which what drives the signal rests; ``repeats``:
        what differs between rows that come back to the same drivers, slow wander, play and friction
        included; each with ``value`` (None with a ``reason``) and ``rows``. ``noise_model_above_steady``:
        whether the noise model is clearly above the steady stretches, so that it may have taken up missing
        physics. ``repeats_above_steady``: whether rows that come back differ by more than noise does, so that
        the signal remembers or something has changed in time. ``at_repeats``: whether the error is down at
        the repeats' noise and that is noise, so that what drives the signal has nothing left to explain.
        None where there is nothing to compare.
    """
    driver, beside = drivers_of(recording, channel)
    quantum, values = step_of(recording, channel), recording[channel]
    # an error of opening is a share of travel, as that of a flow is in its unit: only the slope of it counts
    unit = abs(recording.per_si(channel))
    floors = {
        "steady": steady_floor(values, driver, beside, quantum),
        "repeats": repeats_floor(values, driver, beside, quantum),
    }
    entry: dict[str, Any] = {"unit": recording.unit(channel)}
    for name, estimate in floors.items():
        value = None if estimate.value is None else estimate.value * unit
        entry[name] = {"value": value, "rows": estimate.rows} | (
            {"reason": estimate.reason} if estimate.reason else {}
        )
    steady, repeats = entry["steady"]["value"], entry["repeats"]["value"]
    above = None if steady is None else bool(floor * unit > CLEARLY_ABOVE * steady)
    none = steady is None or repeats is None
    remembers = None if none else bool(repeats > _ABOVE_NOISE * steady)
    reached = None if none or achieved is None else bool(achieved <= _ROUGHLY * repeats and not remembers)
    entry |= {"noise_model_above_steady": above, "repeats_above_steady": remembers, "at_repeats": reached}
    return entry
