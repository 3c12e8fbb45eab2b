# SPDX-License-Identifier: BSD-3-Clause
"""Which faults of the benchmark an effect or a residual points at.

By what a fault does in the simulator, not by its title: the clogging of f1 ends the closing travel, the
friction of f4 is play, the external leakage of f5 is a share of the flow whatever the pressures, the sensor
of f13 stands within the positioner's loop. Nothing points at f14, which changes none of the six signals; f7
and f17 change signals that are measured, and show there.
"""

#: A constant factor on the flow, be it of plug, meter or density: in the flow one is the other.
_FACTOR = ("capacity_error", "flow_meter_gain", "density_change")
_GROWING = ("flow_meter_drift",)
_PLAY = ("backlash", "friction", "stiction", "presliding")

#: Fault -> effects of the catalogue that it is, in the simulator.
EFFECTS = {
    "f1": ("clogging", "stuck_valve"),
    "f2": (*_FACTOR, *_GROWING, "sedimentation", "position_sensor_bias"),
    "f3": (*_FACTOR, *_GROWING, "position_sensor_bias"),
    "f4": _PLAY,
    "f5": (*_FACTOR, *_GROWING, "sedimentation"),
    "f6": ("seat_leakage", "bypass_open"),
    "f7": ("density_change", "choked_flow", "flashing", "cavitation"),
    "f8": (*_PLAY, "rod_bend"),
    "f9": ("actuator_leak",),
    "f10": ("actuator_leak", "spring_fault"),
    "f11": ("spring_fault",),
    "f12": ("transducer_fault", "actuator_lag"),
    "f13": ("position_sensor_gain", "wrong_characteristic"),
    "f14": (),
    "f15": ("positioner_feedback_fault",),
    "f16": ("supply_pressure_drop",),
    "f17": (),
    "f18": ("seat_leakage", "bypass_open"),
    "f19": (*_FACTOR, *_GROWING),
}

#: What a residual of the position alone points at: the flow follows the position as it should.
OF_THE_ACTUATOR = frozenset(("f1", "f4", "f8", "f9", "f10", "f11", "f12", "f15", "f16"))
#: What too much, and too little, flow for the position points at.
MORE_FLOW = frozenset(("f3", "f6", "f13", "f18", "f19"))
LESS_FLOW = frozenset(("f2", "f5", "f13", "f19"))
#: Measured cause that leaves its sound range -> fault.
OF_THE_MEDIUM = {"T1": frozenset(("f7",)), "P1": frozenset(("f17",)), "P2": frozenset(("f17",))}


def faults_of(effects):
    """Faults that a class of effects points at.

    Parameters
    ----------
    effects : iterable of str

    Returns
    -------
    faults : frozenset of str

    Examples
    --------
    >>> sorted(faults_of(["bypass_open", "seat_leakage"]))
    ['f18', 'f6']
    """
    named = set(effects)
    return frozenset(fault for fault, does in EFFECTS.items() if named & set(does))
