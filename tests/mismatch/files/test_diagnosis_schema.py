# SPDX-License-Identifier: BSD-3-Clause
"""The JSON Schema of diagnosis.json: real diagnoses fit it, wrong ones do not, and no list falls behind."""

import ast
import copy
import re
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

import sklvalve
from sklvalve.datasets import make_valve_recording
from sklvalve.history import Allowance
from sklvalve.history.by_itself import ByItself
from sklvalve.history.operating_range import COUNTED
from sklvalve.history.rehearsal import Rehearsal
from sklvalve.mismatch import CATALOGUE, MissingPhysicsFinder, diagnosis_schema
from sklvalve.mismatch.decide.compare import NOTHING, Row
from sklvalve.mismatch.decide.grade import LEVELS
from sklvalve.mismatch.decide.rules import ORDER, Rule
from sklvalve.mismatch.describe.episodes import TimeProfile
from sklvalve.mismatch.effects import EVENTS, LATE
from sklvalve.mismatch.effects.base import Effect
from sklvalve.mismatch.loop import stick_slip
from sklvalve.mismatch.loop.methods import MethodResult
from sklvalve.mismatch.loop.oscillation import Oscillation
from sklvalve.recording import Recording, Valve
from sklvalve.recording.draft.assumed import DATA_SHEET
from sklvalve.recording.signal import ROLES
from tests.mismatch.conftest import record

jsonschema = pytest.importorskip("jsonschema", reason="needs jsonschema, of the extra `test`")

SCHEMA = diagnosis_schema()
DEFS = SCHEMA["$defs"]
FEW = ["clogging", "seat_leakage", "flow_meter_bias"]


def wrong(content):
    """Places at which a diagnosis breaks the schema."""
    return [error.json_path for error in jsonschema.Draft202012Validator(SCHEMA).iter_errors(content)]


def loop_of(stick):
    rng = np.random.default_rng(0)
    time = 10.0 * np.arange(400)
    command = 0.5 + 0.02 * np.sin(time / 300.0) + 0.015 * np.sin(time / 127.0)
    command += 0.0005 * rng.standard_normal(400)
    stem = stick_slip(command, stick=stick, slip=0.0) if stick else command
    flow = 0.01 * stem + 2e-5 * rng.standard_normal(400)
    return Recording.from_frame({"time": time, "command": command, "flow": flow})


@pytest.fixture(scope="module")
def sticking():
    return MissingPhysicsFinder().fit(loop_of(0.02)).diagnosis_.content


@pytest.fixture(scope="module")
def leak(found_leaking):
    return found_leaking.diagnosis_.content


def test_it_is_a_schema():
    jsonschema.Draft202012Validator.check_schema(SCHEMA)


def test_each_call_gives_a_copy():
    diagnosis_schema()["$defs"].clear()
    assert diagnosis_schema() == SCHEMA


def parts(schema):
    """Every schema within a schema, itself first."""
    yield schema
    for key in ("properties", "$defs"):
        for each in schema.get(key, {}).values():
            yield from parts(each)
    for key in ("items", "additionalProperties", "propertyNames"):
        if isinstance(schema.get(key), dict):
            yield from parts(schema[key])
    for each in schema.get("anyOf", []):
        yield from parts(each)


def test_every_set_of_keys_is_closed_and_every_key_described():
    for part in parts(SCHEMA):
        assert part.get("type") != "object" or part is SCHEMA or "additionalProperties" in part
        for name, each in part.get("properties", {}).items():
            assert each.get("description"), name
            if each.get("type") in ("number", ["number", "null"]):
                assert re.search(r"\[.+\]", each["description"]), f"{name} has no unit"


def test_every_definition_is_used():
    used = {part["$ref"].removeprefix("#/$defs/") for part in parts(SCHEMA) if "$ref" in part}
    assert used | {"valve_diagnosis", "loop_diagnosis"} == set(DEFS)


def test_a_sound_valve_fits(found_healthy):
    content = found_healthy.diagnosis_.content
    assert content["verdict"] == "no_mismatch"
    assert wrong(content) == []


def test_a_named_fault_with_later_rows_fits(leak):
    assert (leak["verdict"], leak["proof"]) == ("named", "later_rows")
    assert wrong(leak) == []


def test_exchanged_columns_fit(healthy):
    exchanged = healthy.signals | {"command": healthy["opening"], "opening": healthy["command"]}
    content = MissingPhysicsFinder().fit(replace(healthy, signals=exchanged)).diagnosis_.content
    assert (content["verdict"], content["fit"]) == ("cannot_tell", {})
    assert content["mismatch"]["p_value"] is None
    assert wrong(content) == []


def test_a_loop_that_sticks_fits(sticking):
    assert sticking["verdict"] == "named"
    assert wrong(sticking) == []


def test_a_loop_that_follows_fits():
    content = MissingPhysicsFinder().fit(loop_of(0.0)).diagnosis_.content
    assert content["verdict"] != "named"
    assert wrong(content) == []


@pytest.mark.slow
def test_a_valve_since_its_history_fits():
    made = make_valve_recording(
        "clogging", 0.3, onset=1800.0, loop="wide", n_samples=2400, n_later=0, random_state=3
    )
    whole = Recording.from_frame(made.frame, Valve.from_dict(made.valve))
    finder = MissingPhysicsFinder(effects=FEW, n_jobs=1)
    history = finder.history_of(whole.slice(0, 1200))
    later = MissingPhysicsFinder(effects=FEW, history=history, n_jobs=1).fit(whole.slice(1200, 2400))
    content = later.diagnosis_.content
    assert content["since_history"]["by_itself"] is not None
    assert wrong(content) == []


@pytest.mark.slow
def test_a_fault_of_the_history_fits():
    made = make_valve_recording("clogging", 0.3, loop="wide", n_samples=2400, n_later=0, random_state=3)
    whole = Recording.from_frame(made.frame, Valve.from_dict(made.valve))
    history = MissingPhysicsFinder(effects=FEW, n_jobs=1).history_of(whole.slice(0, 1200))
    later = MissingPhysicsFinder(effects=FEW, history=history, n_jobs=1).fit(whole.slice(1200, 2400))
    content = later.diagnosis_.content
    assert content["since_history"]["held"]
    assert wrong(content) == []


@pytest.mark.slow
def test_several_recordings_fit():
    whole = record("seat_leakage", 0.05, random_state=1, n_later=1200)
    several = [whole.slice(0, 1200), whole.slice(1200, 2400)]
    content = MissingPhysicsFinder(effects=FEW, n_jobs=1).fit(several).diagnosis_.content
    assert len(content["location"]["recordings"]) == len(content["provenance"]["recordings"]) == 2
    assert wrong(content) == []


@pytest.mark.slow
def test_what_no_effect_explains_fits():
    made = make_valve_recording(None, loop="wide", n_samples=1200, n_later=0, random_state=4)
    frame = made.frame.copy()
    frame["F"] *= 1.0 + 0.15 * np.sin(2.0 * np.pi * frame["X"] / frame["X"].max())
    recording = Recording.from_frame(frame, Valve.from_dict(made.valve))
    content = MissingPhysicsFinder(effects=["flow_meter_bias"], n_jobs=1).fit(recording).diagnosis_.content
    assert content["verdict"] == "none_of_these"
    assert content["unknown"]["curve"]["at"]
    assert wrong(content) == []


def _changed(content, path, value):
    content = copy.deepcopy(content)
    *inner, last = path
    place = content
    for key in inner:
        place = place[key]
    place[last] = value
    return content


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("schema",), "sklvalve.diagnosis/2"),
        (("verdict",), "healthy"),
        (("subject",), "pump"),
        (("mismatch", "p_value"), 2.0),
        (("mismatch", "detected"), "yes"),
        (("effects",), []),
        (("effects", 0, "probability"), 2.0),
        (("effects", 0, "members", 0, "probability"), -0.1),
        (("effects", 0, "members", 0, "name"), "rust"),
        (("effects", 0, "grade", "level"), "sure"),
        (("effects", 0, "kind"), "defect"),
        (("effects", 0, "blocks"), ["pump"]),
        (("effects", 0, "colour"), "red"),
        (("effects", 0, "onset"), "noon"),
        (("comparison", 0, "posterior"), 1.5),
        (("rules", 0, "name"), "luck"),
        (("fit", "level"), {}),
        (("fit", "flow", "noise_floor"), None),
        (("location", "course"), "now and then"),
        (("provenance", "recording_sha256"), "none"),
        (("colour",), "red"),
        (("sampling",), {}),
    ],
)
def test_what_is_wrong_is_refused(leak, path, value):
    assert wrong(_changed(leak, path, value))


@pytest.mark.parametrize("key", sorted(DEFS["valve_diagnosis"]["required"]))
def test_a_key_that_lacks_is_missed(leak, key):
    assert wrong({name: part for name, part in leak.items() if name != key})


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("verdict",), "none_of_these"),
        (("comparison",), []),
        (("methods", 0, "says"), "perhaps"),
        (("effects", 0, "members", 0, "probability"), 0.9),
        (("fit", "opening"), {}),
    ],
)
def test_what_is_wrong_of_a_loop_is_refused(sticking, path, value):
    assert wrong(_changed(sticking, path, value))


def test_names_and_forms_are_those_of_the_catalogue():
    known = [*CATALOGUE, *EVENTS, *LATE]
    assert DEFS["effect_name"]["enum"] == list(dict.fromkeys(effect.name for effect in known))
    assert DEFS["effect_form"]["enum"] == list(dict.fromkeys(effect.key for effect in known))
    assert {"const": NOTHING} in DEFS["comparison_row"]["properties"]["hypothesis"]["anyOf"]


def test_rules_are_those_that_are_asked_in_their_order():
    assert DEFS["rule"]["properties"]["name"]["enum"] == list(ORDER)
    assert DEFS["valve_diagnosis"]["properties"]["rules"]["maxItems"] == len(ORDER)


def test_levels_and_roles_and_ranges_are_those_of_the_code():
    assert DEFS["grade"]["properties"]["level"]["enum"] == list(LEVELS)
    assert DEFS["role"]["enum"] == list(ROLES)
    assert DEFS["visited"]["enum"] == list(COUNTED)
    assert DEFS["data_finding"]["properties"]["role"]["anyOf"][1]["enum"] == [DATA_SHEET, None]


def _documented(kind, name):
    """Values that a docstring lists of an attribute, as ``name : {"one", "other"}``."""
    return ast.literal_eval(re.search(rf"^ +{name} : (\{{.*\}})$", kind.__doc__, re.M)[1])


@pytest.mark.parametrize(
    ("values", "kind", "name", "more"),
    [
        (DEFS["verdict"]["enum"], ByItself, "verdict", set()),
        (DEFS["block"]["enum"], Effect, "block", set()),
        (DEFS["kind"]["enum"], Effect, "kind", set()),
        (DEFS["comparison_row"]["properties"]["time_profile"]["enum"], Row, "time_profile", set()),
        # what several findings do in several ways
        (DEFS["location"]["properties"]["course"]["enum"], TimeProfile, "kind", {"in several ways"}),
        (DEFS["method"]["properties"]["says"]["enum"], MethodResult, "says", set()),
        (DEFS["oscillation"]["properties"]["signal"]["enum"], Oscillation, "signal", set()),
    ],
)
def test_values_are_those_that_docstrings_list(values, kind, name, more):
    assert set(values) == _documented(kind, name) | more


def test_defects_of_the_data_are_those_that_the_screens_tell():
    folder = Path(sklvalve.__file__).parent / "recording"
    told = set()
    for file in folder.rglob("*.py"):
        for call in re.findall(r"\bfinding\(([^,]*),", file.read_text(encoding="utf-8")):
            told |= set(re.findall(r'"(\w+)"', call))
    assert told == set(DEFS["data_finding"]["properties"]["finding"]["enum"])


def test_methods_are_those_that_are_applied(sticking):
    applied = [each["method"] for each in sticking["methods"]]
    assert set(DEFS["method"]["properties"]["method"]["enum"]) == set(applied)


def _items(*path):
    part = DEFS["since_history"]["properties"]
    for key in path:
        part = part[key]
    return part


@pytest.mark.parametrize(
    ("part", "kind", "more"),
    [
        (DEFS["comparison_row"], Row, set()),
        (DEFS["rule"], Rule, set()),
        (DEFS["method"], MethodResult, set()),
        (DEFS["oscillation"], Oscillation, set()),
        (_items("rehearsals", "items"), Rehearsal, set()),
        (_items("by_itself", "anyOf", 0), ByItself, {"sentence"}),
    ],
    ids=["comparison", "rules", "methods", "oscillation", "rehearsals", "by_itself"],
)
def test_keys_are_the_fields_that_they_come_from(part, kind, more):
    assert set(part["properties"]) == {field.name for field in fields(kind)} | more


def test_allowances_are_those_of_a_history():
    names = _items("allowances", "items", "properties", "name", "enum")
    assert names == [field.name for field in fields(Allowance)]
