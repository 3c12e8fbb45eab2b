# SPDX-License-Identifier: BSD-3-Clause
"""What a recording alone tells of the noise of its signals, beside what the noise model says."""

import numpy as np

from sklvalve.mismatch.repeats import repeats_floor
from sklvalve.mismatch.steady import drivers_of, steady_floor

# a noise model is clearly above the noise of steady stretches from here on; on healthy recordings of a plant
# with known noise it was so in none (docs/validation.md)
CLEARLY_ABOVE = 1.5
# what a floor from a few hundred rows may be wrong by
_ROUGHLY = 1.05


def model_free_noise(recording, channel, floor, achieved=None):
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
        physics. ``at_repeats``: whether the error is down at the repeats' noise, so that what drives the
        signal has nothing left to explain. Both None where there is nothing to compare.
    """
    driver, beside = drivers_of(recording, channel)
    quantum, values = recording.resolution(channel), recording[channel]
    # an error of opening is a share of travel, as that of a flow is in its unit: only the slope of it counts
    unit = abs(float(np.diff(recording.in_recorded_units(channel, np.array([0.0, 1.0])))[0]))
    found = {
        "steady": steady_floor(values, driver, beside, quantum),
        "repeats": repeats_floor(values, driver, beside, quantum),
    }
    entry: dict = {"unit": recording.unit(channel)}
    for name, told in found.items():
        value = None if told.value is None else told.value * unit
        entry[name] = {"value": value, "rows": told.rows} | ({"reason": told.reason} if told.reason else {})
    steady, repeats = entry["steady"]["value"], entry["repeats"]["value"]
    entry["noise_model_above_steady"] = steady and bool(floor * unit > CLEARLY_ABOVE * steady)
    none = achieved is None or repeats is None
    entry["at_repeats"] = None if none else bool(achieved <= _ROUGHLY * repeats)
    return entry
