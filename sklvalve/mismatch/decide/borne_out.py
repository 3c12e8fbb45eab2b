# SPDX-License-Identifier: BSD-3-Clause
"""How often names held on sealed records, as the numbers of a calibration."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Numbers:
    """Numbers by which `probability` is calibrated.

    Attributes
    ----------
    intercept : float
        Log odds of a class where all else is usual.
    of_name : float
        Weight of the log odds of the leading name.
    of_grounds : tuple of float
        Change of the log odds for each factor of ten of the p-value below `USUAL_P`; beside a stronger
        finding; with coarse values; and where the effect may vanish.
    few_signals : tuple of float
        Offset and slope of the log odds where the opening or a pressure is not recorded.
    held : dict
        Leading name -> (classes that held the truth, classes).
    with_history : tuple of float
        As `few_signals`, where the recording is held against a history of the valve.
    held_with_history : dict
        As `held`, of such recordings; they count beside those of `held`.
    left_over : tuple of float
        What is added to the log odds where it is known what a class leaves of its difference, and for each
        nat that it leaves (`probability.left_over`).
    """

    intercept: float
    of_name: float
    of_grounds: tuple[float, float, float, float]
    few_signals: tuple[float, float]
    held: dict[str, tuple[int, int]] = field(default_factory=dict)
    with_history: tuple[float, float] = (0.0, 1.0)
    held_with_history: dict[str, tuple[int, int]] = field(default_factory=dict)
    left_over: tuple[float, float] = (0.0, 0.0)

    def held_by(self, history: bool) -> dict[str, tuple[int, int]]:
        """Leading name -> (classes that held the truth, classes), those with a history counted in or not."""
        if not history:
            return self.held
        return summed(self.held, self.held_with_history)


def summed(
    first: dict[str, tuple[int, int]], second: dict[str, tuple[int, int]]
) -> dict[str, tuple[int, int]]:
    """Counts of two sets of records together, by leading name."""
    pairs = {name: (first.get(name, (0, 0)), second.get(name, (0, 0))) for name in {**first, **second}}
    return {name: (a + c, b + d) for name, ((a, b), (c, d)) in pairs.items()}


#: Of a mismatch that is usual among those found; says only where the intercept is taken. The sealed records
#: were judged before stretches counted: what then had 1e-4 now has 1e-5, median of 19 from 3e-5 to 3e-4 then.
USUAL_P = 1e-5

#: Of the 1,733 classes reported in the seven sealed runs of the concealed benchmark, 1,573 of which held a
#: true name, printed by ``python -m benchmarks.concealed.calibrate``. How numbers fitted to six of the runs
#: did on the seventh is in benchmarks/concealed/results/README.md.
SEALED = Numbers(
    intercept=2.406,
    of_name=1.065,
    of_grounds=(0.299, -0.517, -0.953, -0.580),
    few_signals=(-0.136, 0.594),
    held={
        "actuator_lag": (48, 49),
        "actuator_leak": (37, 45),
        "backlash": (116, 121),
        "bypass_open": (60, 61),
        "capacity_error": (10, 11),
        "cavitation": (9, 13),
        "choked_flow": (2, 3),
        "clogging": (63, 70),
        "dead_time": (53, 53),
        "density_change": (42, 43),
        "erosion": (42, 45),
        "external_leakage": (57, 69),
        "flashing": (15, 15),
        "flow_meter_bias": (80, 89),
        "flow_meter_drift": (39, 46),
        "flow_meter_gain": (23, 28),
        "friction": (11, 23),
        "inlet_pressure_bias": (19, 23),
        "line_loss": (34, 34),
        "outlet_pressure_bias": (23, 30),
        "piping_reducers": (12, 12),
        "position_sensor_bias": (51, 54),
        "position_sensor_gain": (99, 105),
        "positioner_characteriser": (42, 42),
        "positioner_deadband": (108, 111),
        "positioner_feedback_fault": (37, 40),
        "presliding": (1, 4),
        "rod_bend": (0, 5),
        "seat_leakage": (53, 55),
        "sedimentation": (3, 3),
        "sensor_lag": (55, 55),
        "slew_limit": (49, 49),
        "spring_fault": (4, 4),
        "stem_load": (3, 6),
        "stiction": (87, 92),
        "stuck_valve": (32, 33),
        "supply_pressure_drop": (29, 39),
        "tight_shutoff": (25, 26),
        "transducer_fault": (18, 30),
        "two_phase": (21, 25),
        "viscosity_change": (15, 23),
        "viscous_flow": (15, 15),
        "wrong_characteristic": (31, 34),
    },
    # of 635 classes told of 1334 records with a history, 577 held a true name; printed by the same
    # command with --histories
    with_history=(0.548, 0.855),
    held_with_history={
        "actuator_lag": (23, 26),
        "actuator_leak": (8, 10),
        "backlash": (37, 37),
        "bypass_open": (27, 27),
        "capacity_error": (3, 4),
        "cavitation": (9, 15),
        "choked_flow": (14, 16),
        "clogging": (14, 14),
        "dead_time": (32, 32),
        "density_change": (31, 32),
        "erosion": (10, 10),
        "external_leakage": (28, 29),
        "flashing": (3, 3),
        "flow_inertia": (1, 1),
        "flow_meter_bias": (29, 33),
        "flow_meter_drift": (5, 7),
        "flow_meter_gain": (6, 6),
        "friction": (2, 3),
        "inlet_pressure_bias": (7, 8),
        "line_loss": (10, 10),
        "outlet_pressure_bias": (8, 9),
        "piping_reducers": (5, 6),
        "position_sensor_bias": (44, 48),
        "position_sensor_gain": (33, 36),
        "positioner_characteriser": (14, 14),
        "positioner_deadband": (22, 22),
        "positioner_feedback_fault": (9, 10),
        "presliding": (1, 3),
        "rod_bend": (1, 1),
        "seat_leakage": (15, 15),
        "sedimentation": (3, 3),
        "sensor_lag": (18, 18),
        "slew_limit": (12, 17),
        "spring_fault": (2, 3),
        "stiction": (19, 19),
        "stuck_valve": (6, 6),
        "supply_pressure_drop": (3, 8),
        "tight_shutoff": (3, 3),
        "transducer_fault": (10, 14),
        "two_phase": (7, 7),
        "viscosity_change": (6, 7),
        "viscous_flow": (11, 13),
        "wrong_characteristic": (26, 30),
    },
    # of 862 classes of 15 draws, judged by twelve commits up to 8810834, 70 of them wrong; printed by
    # ``python -m benchmarks.concealed.calibrate_left_over``. By numbers fitted without the draw it leaves, of
    # classes with 0.6 or more, 782 right and 56 wrong, as before 778 and 56; log loss falls from 210 to 199
    left_over=(0.704, -0.1265),
)
