# SPDX-License-Identifier: BSD-3-Clause
"""What an engineer would know of the simulated actuator: the valve.toml of its recordings."""

import numpy as np

from sklvalve.damadics.actuator import constants_of
from sklvalve.damadics.flow import RECOVERY, RECOVERY_AT, SHUTS_FROM


def valve_sheet(actuator=None, *, nominal=False, tag="DAMADICS"):
    """What is known of a simulated actuator and of its recordings, in the structure of a valve.toml.

    Parameters
    ----------
    actuator : Actuator, {1, 2, 3} or None, default=None
        None is that of the benchmark, 3.
    nominal : bool, default=False
        Name the frame's ``X_nominal`` as the simulation that a diagnosis corrects, in place of its own of
        positioner and actuator. The benchmark's actuator is slower than a data sheet tells, and the jet
        pushes its stem: against a sheet alone a sound one is found wanting.
    tag : str, default="DAMADICS"
        Name of the valve.

    Returns
    -------
    sheet : dict of dict
        What :meth:`sklvalve.Valve.from_dict` takes, for frames of `make_damadics`. The trim is the
        benchmark's own, kv = kv_rated exp(-n (1 - opening)); F_L is the root of its recovery coefficient.
        Of what was measured only the six signals that a diagnosis may use are named.

    Raises
    ------
    ValueError
        If there is no such actuator.

    Examples
    --------
    >>> from sklvalve import Valve
    >>> from sklvalve.damadics import valve_sheet
    >>> valve = Valve.from_dict(valve_sheet())
    >>> valve.kv_rated, round(valve.rangeability, 1), valve.roles["opening"].sense
    (120.0, 148.4, 'closing')
    """
    actuator = constants_of(actuator)
    recovery = sorted(zip((1.0 - RECOVERY_AT).round(6), np.sqrt(RECOVERY).round(6), strict=True))
    bench = actuator.spring / actuator.effective_area * actuator.preload
    sheet = {
        "valve": {
            "tag": tag,
            "kv_rated": actuator.kv,
            "characteristic": "equal_percentage",
            "rangeability": round(float(np.exp(actuator.slope)), 3),
            "shutoff": round(1.0 - SHUTS_FROM, 6),
            "fl": [[float(opening), float(factor)] for opening, factor in recovery],
            "nominal_size": 1e3 * actuator.plug,
            "travel": round(1e3 * actuator.stroke, 6),
        },
        "fluid": {"name": "water"},
        "actuator": {
            "fail": "open",
            "supply_pressure": 1e-3 * actuator.supply,
            "spring_range": [
                round(1e-3 * bench, 2),
                round(1e-3 * bench * (1.0 + actuator.stroke / actuator.preload), 2),
            ],
            "effective_area": round(1e4 * actuator.effective_area, 3),
            "positioner": True,
        },
        "simulation": {"physics": ["choked_flow"]},
        "recording": {
            "time": "time",
            "command": {"column": "CV", "unit": "%", "sense": "closing"},
            "opening": {"column": "X", "unit": "%", "sense": "closing"},
            "p1": {"column": "P1", "unit": "kPa", "gauge": False},
            "p2": {"column": "P2", "unit": "kPa", "gauge": False},
            "temperature": {"column": "T1", "unit": "degC"},
            "flow": {"column": "F_in_range", "unit": "t/h"},
        },
    }
    if nominal:
        sheet["recording"]["simulated_opening"] = {"column": "X_nominal", "unit": "%", "sense": "closing"}
    return sheet
