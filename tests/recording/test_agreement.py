# SPDX-License-Identifier: BSD-3-Clause
"""A valve.toml whose values no plant has, or that contradict each other."""

import pytest

from sklvalve.recording import InputError, Valve
from tests.recording.test_valve import changed


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (changed("actuator", spring_range=[99.99, 100.0]), ["spring_range", "at least 5 kPa apart", "unit"]),
        (changed("actuator", spring_range=[20, 20.0000001]), ["spring_range", "at least 5 kPa apart"]),
        (changed("actuator", spring_range=[20.0, 1e4]), ["spring_range", "at most 1000 kPa", "10000"]),
        (changed("actuator", supply_pressure=1e9), ["supply_pressure", "at most 2000 kPa", "1e+09"]),
        (changed("actuator", supply_pressure=3.4), ["supply_pressure", "at least 10", "3.4"]),
        (changed("actuator", supply_pressure=20.0), ["supply_pressure = 20 kPa does not exceed 20 kPa"]),
        (changed("fluid", critical_pressure=1), ["critical_pressure must be at least 200 and", "got 1"]),
        (changed("fluid", vapour_pressure=25000.0), ["vapour_pressure = 25000 kPa", "22064 kPa"]),
        (
            changed("fluid", vapour_pressure=4000.0, critical_pressure=4000.0),
            ["vapour_pressure = 4000 kPa is not below the critical pressure, 4000 kPa"],
        ),
        (changed("valve", kv_rated=10**400), ["[valve] kv_rated must be a finite number", "1000", "..."]),
        (changed("valve", kv_rated=1e300), ["[valve] kv_rated must be above 0 and at most 1e+06 m3/h"]),
        (changed("valve", tag=16**5000), ["tag must be a text in quotes; got more than can be shown"]),
        (
            changed("recording.opening", column="CV", unit="%"),
            ["[recording.opening] names column 'CV', which is the command already", "its own column"],
        ),
        (changed("recording.flow", column="t"), ["[recording.flow] names column 't'", "is the time"]),
        (
            changed("recording", process_value={"column": "CV", "unit": "%"}),
            ["[recording.process_value] names column 'CV'", "the command already"],
        ),
    ],
)
def test_what_cannot_be_gets_one_sentence(data, words):
    with pytest.raises(InputError) as caught:
        Valve.from_dict(data, source="FV.toml")
    sentence = str(caught.value)
    assert sentence.startswith("FV.toml: ")
    assert "\n" not in sentence
    assert len(sentence) < 300
    assert all(word in sentence for word in words), sentence


def test_constants_and_process_values_may_repeat_a_role():
    flow = {"column": "F", "unit": "m3/h"}
    for roles in ({"process_value": flow, "flow": flow}, {"flow": flow, "process_value": flow}):
        assert Valve.from_dict({"recording": roles}).roles["process_value"].column == "F"
    same = {"constant": 101.325, "unit": "kPa"}
    assert Valve.from_dict({"recording": {"p1": same, "p2": same}}).roles["p2"].constant == 101.325


def test_actuators_as_they_are_built():
    for supply, spring in ((140.0, [20.0, 100.0]), (36.0, [20.0, 100.0]), (1000.0, [0.0, 600.0])):
        actuator = {"supply_pressure": supply, "spring_range": spring}
        assert Valve.from_dict({"actuator": actuator}).spring_range == (spring[0] * 1e3, spring[1] * 1e3)
