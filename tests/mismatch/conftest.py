# SPDX-License-Identifier: BSD-3-Clause
"""Recordings with something concealed in them, or nothing, and their diagnoses."""

import pytest

from sklvalve.datasets import make_valve_recording
from sklvalve.mismatch import MissingPhysicsFinder
from sklvalve.recording import Recording, Valve

ROWS = 1200


def record(effect=None, strength=None, *, random_state, onset=0.0, n_later=0):
    """A recording of the plant, 1,200 rows and `n_later` more, moved over most of its travel."""
    made = make_valve_recording(
        effect,
        strength,
        onset=onset,
        loop="wide",
        n_samples=ROWS + n_later,
        n_later=0,
        random_state=random_state,
    )
    return Recording.from_frame(made.frame, Valve.from_dict(made.valve))


@pytest.fixture(scope="session")
def healthy():
    return record(random_state=0)


@pytest.fixture(scope="session")
def leaking():
    """A seat that begins to leak at 500 s; 300 rows more than a diagnosis is to use."""
    return record("seat_leakage", 0.05, random_state=1, onset=500.0, n_later=300)


@pytest.fixture(scope="session")
def found_healthy(healthy):
    return MissingPhysicsFinder().fit(healthy)


@pytest.fixture(scope="session")
def found_leaking(leaking):
    return MissingPhysicsFinder().fit(leaking, until=ROWS)


# the names of the catalogue and where they sit, as they were designed
DESIGNED = {
    "actuator": "stiction friction backlash presliding positioner_deadband spring_fault supply_pressure_drop "
    "actuator_leak rod_bend actuator_lag slew_limit dead_time transducer_fault positioner_feedback_fault "
    "stem_load tight_shutoff positioner_characteriser stuck_valve",
    "valve": "capacity_error wrong_characteristic clogging sedimentation erosion seat_leakage bypass_open "
    "external_leakage choked_flow cavitation flashing viscous_flow gas_expansion density_change "
    "viscosity_change backlash",
    "line": "piping_reducers line_loss flow_inertia two_phase",
    "measurement": "flow_meter_gain flow_meter_bias flow_meter_drift position_sensor_bias "
    "position_sensor_gain inlet_pressure_bias outlet_pressure_bias sensor_lag",
}


def agree(content):
    """Assert that verdict, rules, effects and table of a diagnosis say the same."""
    failed = [rule["name"] for rule in content["rules"] if not rule["passed"]]
    assert (content["verdict"] == "named") == (not failed), failed
    by_name = {rule["name"]: rule for rule in content["rules"]}
    if "rarity" in by_name:
        assert by_name["rarity"]["value"] == pytest.approx(content["mismatch"]["p_value"], rel=1e-3)
        assert by_name["rarity"]["passed"] == (by_name["rarity"]["value"] <= content["mismatch"]["alpha"])
    heads = [row for row in content["comparison"] if row["stands"] and row["rank"] == 1]
    if content["verdict"] == "named":
        names = [effect["members"][0]["name"] for effect in content["effects"]]
        assert set(names) <= {row["hypothesis"] for row in heads}
        assert content["comparison"][0]["stands"]
