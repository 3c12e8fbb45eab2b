# SPDX-License-Identifier: BSD-3-Clause
"""What may be wrong inside an actuator, as the scan of its stem takes it."""

import numpy as np

# what else may be wrong in an actuator, in the order of the columns of `faults`; all are zero in a sound one
FAULTS = (
    "preload",  # added to the pressure at which the spring begins to give way [travels of spring]
    "stiffness",  # added to the spring's stiffness [travels of spring over a travel]
    "hardening",  # its force with the cube of the travel [travels of spring]
    "leak",  # nozzle from the chamber to the air, share of the spool's capacity [1]
    "rod",  # friction that grows along the travel [travels of spring over a travel] ...
    "rod_from",  # ... from here on, measured as air drives the stem [1]
    "load",  # force on the stem, against the air [travels of spring]
    "feedback_play",  # whole play between the stem and the positioner's lever [1]
    "bristle",  # stiffness of the friction's bristles in place of the ordinary one [travels of spring]
    "capacity",  # added to the spool's capacity, share of it [1]
    "stop_low",  # how much of its travel is closed to the stem where the spring drives it [1]
    "stop_high",  # and where the air drives it [1]
)


def columns_of_faults(drive, rows):
    """Faults of a drive (a number or an array under each name of `FAULTS`) as the scan takes them."""
    columns = [drive[name] for name in FAULTS]
    if all(isinstance(column, float) and column == 0.0 for column in columns):
        return np.empty((0, len(FAULTS)))
    faults = np.empty((rows, len(FAULTS)))
    for i, column in enumerate(columns):
        faults[:, i] = column
    return faults
