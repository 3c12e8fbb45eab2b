# SPDX-License-Identifier: BSD-3-Clause
"""What of the plant may change from second to second: the columns of a schedule, and their sound values.

An effect is a change to some of these columns, and to nothing else; at their sound values the plant is sound.
"""

COLUMNS = (
    # from the command to the positioner's comparison
    "dead_time",  # [s]
    "lag",  # first order [s]
    "stroke_time",  # least time of a full stroke, 0: no limit [s]
    "input_gain",  # of the transducer before the positioner [1]
    "input_bias",  # [1]
    "curvature",  # of the positioner's characteriser, 0: straight [1]
    "cut_low",  # commands below are taken as shut [1]
    "cut_high",  # commands above one minus this are taken as open [1]
    "dead_zone",  # half width of the error that is left alone [1]
    "feedback_gain",  # of the positioner's lever [1]
    "feedback_bias",  # [1]
    "feedback_play",  # full width [1]
    "wander_in",  # added to the positioner's aim by its own firmware [1]
    # air
    "spool_share",  # of the spool's travel [1]
    "supply",  # [Pa, absolute]
    "air_leak",  # conductance of a leak of the chamber, as a share of the filling one [1]
    "lost_area",  # share of the diaphragm [1]
    # stem
    "spring_strength",  # factor on force and preload [1]
    "hardening",  # cubic part of the spring at full travel, share of its range [1]
    "coulomb",  # sliding friction [N]
    "stick",  # breakaway friction [N]
    "reach",  # of the bristles at breakaway [share of travel]
    "bend_friction",  # more friction towards the open end [N]
    "bend_begin",  # from there on [1]
    "plug_area",  # on which the drop acts [m2]
    "seized",  # 1: the stem stands
    "blocked",  # opening below which something in the way keeps the stem [1]
    "link_play",  # between actuator and the recorded stem, full width [1]
    # plug and trim
    "plug_play",  # between recorded stem and plug, full width [1]
    "plug_offset",  # [1]
    "capacity",  # factor [1]
    "bend",  # of the characteristic: phi to the power 1 + bend
    "open_max",  # opening above which no capacity is added [1]
    "leak_kv",  # past the seat, never shut [m3/h]
    "erosion_kv",  # at the seat, fading over a share of the travel [m3/h]
    "bypass_kv",  # round the valve [m3/h]
    "fittings",  # sum of loss coefficients on the nominal size [1]
    "line_zeta",  # loss between the taps in drops of the open valve [1]
    "fl_factor",  # on the recovery factor [1]
    "cavitation_loss",  # of capacity at full cavitation [1]
    "cavitation_begin",  # x_F from which on [1]
    # fluid
    "viscosity",  # kinematic, at 20 degC [m2/s]
    "viscosity_fall",  # [1/K]
    "thinning",  # viscosity falls with the shear to this power, 0: Newtonian
    "density_ratio",  # of the fluid to the sheet's [1]
    "density_slope",  # further fall with temperature from 20 degC [1/K]
    "gas_share",  # of the volume at the inlet [1]
    "tap_inertia",  # length over area between the taps [1/m]
    # meters
    "leak_before",  # to the outside, between an upstream meter and the trim [m3/h of kv]
    "leak_behind",  # to the outside, between the trim and a downstream meter [m3/h of kv]
    "back_kv",  # through a check valve behind the valve, past the meter, above `back_from` [m3/h of kv]
    "back_from",  # [Pa]
    "meter_gain",  # [1]
    "meter_bias",  # [m3/h]
    "meter_lag",  # first order [s]
    "swelling",  # of the reading per share by which p2 lies below the vapour pressure [1]
    "hum",  # share of the flow that the meter misses, per share of p1 that is throttled beyond a quarter [1]
    "beat",  # added to the flow, unseen by the pressures' scan, share [1]
    "x_gain",  # of the recorded position only [1]
    "x_bias",  # [1]
    "loop_gain",  # of the position that recording and positioner share [1]
    "loop_bias",  # [1]
    "p1_bias",  # [Pa]
    "p2_bias",  # [Pa]
)

# what acts between the recorded opening and the recorded flow; the others act between command and opening
FLOW_SIDE = COLUMNS[COLUMNS.index("plug_play") : COLUMNS.index("x_gain")] + ("p1_bias", "p2_bias")

SOUND = dict.fromkeys(COLUMNS, 0.0) | dict.fromkeys(
    ("input_gain", "feedback_gain", "spool_share", "spring_strength", "capacity", "open_max", "fl_factor"),
    1.0,
)
SOUND |= dict.fromkeys(("density_ratio", "meter_gain", "x_gain", "loop_gain"), 1.0)
