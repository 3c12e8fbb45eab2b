# SPDX-License-Identifier: BSD-3-Clause
"""Findings about the data switch off the effects that they mimic."""

# finding -> role it concerns (None: any) -> effects that it imitates
_MIMICS = {
    "compressed": {
        "opening": ("stiction", "backlash", "positioner_deadband", "dead_time"),
        "command": ("dead_time",),
        "flow": ("backlash",),
    },
    "frozen": {"opening": ("stiction", "positioner_deadband", "position_sensor_bias")},
    "clock_shift": {None: ("dead_time",)},
    "saturated": {"flow": ("clogging", "choked_flow"), "opening": ("supply_pressure_drop",)},
}


def effects_switched_off(data):
    """Effects that a recording's data cannot speak for.

    Parameters
    ----------
    data : list of dict
        Findings of `screen_recording`.

    Returns
    -------
    off : dict
        Effect name -> what is needed instead.
    """
    off = {}
    for finding in data:
        by_role = _MIMICS.get(finding["finding"], {})
        for effect in (*by_role.get(finding["role"], ()), *by_role.get(None, ())):
            off.setdefault(effect, f"a recording whose {finding['role']} is not {finding['finding']}")
    return off
