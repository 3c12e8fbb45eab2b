# SPDX-License-Identifier: BSD-3-Clause
"""Model files with a right checksum that lie: refused on loading, and not in the midst of a prediction."""

import copy
import io
import json
import os
import tomllib
import zipfile

import numpy as np
import pytest

from sklvalve.mismatch import load_model
from sklvalve.recording import InputError, Recording, Valve

skops_io = pytest.importorskip("skops.io", reason="model files need skops")
pytest.importorskip("pandas", reason='needs pip install "sklvalve[io]"')

from benchmarks.fuzz.seeds import SHEET, corpus, frame  # noqa: E402


@pytest.fixture(scope="module")
def sound():
    return skops_io.loads(corpus("model")[1])


def written(tmp_path, content):
    path = tmp_path / "model.skops"
    path.write_bytes(content)
    return path


def refusal(path):
    with pytest.raises(InputError) as caught:
        load_model(path)
    assert str(caught.value).isprintable()
    return str(caught.value)


def test_the_sound_one_is_read(tmp_path, sound):
    assert load_model(written(tmp_path, skops_io.dumps(sound)))["corrected"].values_["capacity"] == 41.0


def _set(*keys):
    *inner, last, value = keys

    def change(content):
        node = content
        for key in inner:
            node = node[key]
        node[last] = value

    return change


def _drop(*keys):
    *inner, last = keys

    def change(content):
        node = content
        for key in inner:
            node = node[key]
        del node[last]

    return change


STATE = "corrected"


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (_set(STATE, "values", "capacity", float("nan")), "capacity is out of range"),
        (_set(STATE, "values", "capacity", "41"), "capacity is no number"),
        (_set(STATE, "values", "capacity", True), "capacity is no number"),
        (_set(STATE, "values", "actuator_rate", 1e9), "actuator_rate is out of range"),
        (_set(STATE, "values", "meter_lag", 0.0), "meter_lag is out of range"),
        (_set(STATE, "values", "x\x1b[2J", 1.0), "a parameter has no name"),
        (_drop(STATE, "values", "trim_3"), "trim_3 is missing"),
        (_drop(STATE, "values", "capacity"), None),
        (_drop(STATE, "values", "meter_ahead"), "meter_ahead is missing"),
        (_drop(STATE, "values", "actuator_vent"), "actuator_vent is missing"),
        (_drop(STATE, "values", "knee"), "knee is missing"),
        (_drop(STATE, "values"), "values is missing"),
        (_set(STATE, "choking", 1), "choking is neither"),
        (_set(STATE, "effects", ["flow_meter_gain"] * 2), "names an effect twice"),
        (_set(STATE, "effects", [3]), "effects are no names"),
        (_set(STATE, "effects", []), "an onset belongs to no effect"),
        (_set(STATE, "onsets", {"flow_meter_gain": []}), "onsets are not in order"),
        (_set(STATE, "onsets", {"flow_meter_gain": [9.0, 5.0]}), "onsets are not in order"),
        (_set(STATE, "onsets", {"flow_meter_gain": [float("inf")]}), "an onset is out of range"),
        (_set(STATE, "seen", [1.0]), "no pair"),
        (_set(STATE, "seen", [5.0, 1.0]), "run back"),
        (_set(STATE, "trim", "rated", 0.0), "rated capacity is out of range"),
        (_set(STATE, "trim", "given", True), "given_gain is missing"),
        (_set(STATE, "trim", "knots", np.array([0.0, 0.5, 0.4, 1.0])), "do not rise"),
        (_set(STATE, "trim", "knots", np.linspace(0.0, 1.0, 5)), "rise_0 is missing"),
        (_set(STATE, "trim", "curve", np.zeros(7)), "wrong shape"),
        (_set(STATE, "correction", "support", np.zeros((12, 2))), "support has the wrong shape"),
        (_set(STATE, "correction", "support", np.full((12, 3), np.inf)), "out of range"),
        (_set(STATE, "correction", "support", [[1.0]]), "no array"),
        (_set(STATE, "correction", "coefficients", np.zeros(11)), "coefficients has the wrong shape"),
        (_set(STATE, "correction", "scale", np.zeros(3)), "scale is not above 0"),
        (
            _set(STATE, "correction", "inputs", ("opening", "dp", "os.system")),
            "input of the residual is not known",
        ),
        (_set(STATE, "correction", "inputs", ("opening", "dp", "temperature 1e-9 s")), "out of range"),
        (_set(STATE, "correction", "gamma", -1.0), "gamma is out of range"),
        (_set(STATE, "correction", "channel", "p1"), "channel is not known"),
        (_set("diagnosis", "effects", None), "its diagnosis is none"),
        (_set("diagnosis", "p", float("nan")), "damaged"),
        (_drop("diagnosis"), "damaged"),
        (_set("valve", "valve", "kv_rated", -1.0), "kv_rated must be above 0"),
    ],
)
def test_a_lie_is_refused_on_loading(tmp_path, sound, change, words):
    content = copy.deepcopy(sound)
    change(content)
    path = written(tmp_path, skops_io.dumps(content))
    if words is None:  # a simulation without the flow's part is a whole one
        model, recording = (
            load_model(path),
            Recording.from_frame(frame(), Valve.from_dict(tomllib.loads(SHEET))),
        )
        assert set(model["corrected"].simulate(recording)) == {"opening"}
        assert set(model["nominal"].simulate(recording)) == {"opening", "flow", "flow_from_command"}
    else:
        assert words in refusal(path)


def rezipped(content, change):
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    change(parts)
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, part in parts.items():
            archive.writestr(name, part)
    return target.getvalue()


def test_a_bomb_is_refused_by_what_it_declares(tmp_path, sound, monkeypatch):
    monkeypatch.setattr("sklvalve.mismatch.files.packed_model._MOST_BYTES", 1 << 20)
    content = rezipped(skops_io.dumps(sound), lambda parts: parts.update({"zeros.npy": b"\0" * (32 << 20)}))
    assert len(content) < 1 << 20
    assert "unpacks to 32.1 MiB, more than 1 MiB" in refusal(written(tmp_path, content))


def test_an_array_that_declares_more_than_it_holds(tmp_path, sound):
    header = {"descr": "<f8", "fortran_order": False, "shape": (10**9, 10**3)}

    def lie(parts):
        name = next(name for name in parts if name.endswith(".npy"))
        target = io.BytesIO()
        np.lib.format.write_array_header_1_0(target, header)
        parts[name] = target.getvalue() + b"\0" * 64

    content = rezipped(skops_io.dumps(sound), lie)
    assert "an array declares more than it holds" in refusal(written(tmp_path, content))


def test_an_object_is_not_even_built(tmp_path, sound):
    def other(parts):
        schema = json.loads(parts["schema.json"])
        schema["content"]["format"] |= {
            "__loader__": "ObjectNode",
            "__module__": "sklearn.svm",
            "__class__": "SVR",
        }
        parts["schema.json"] = json.dumps(schema)

    assert "an object that is no plain data" in refusal(
        written(tmp_path, rezipped(skops_io.dumps(sound), other))
    )


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
def test_a_pipe_is_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "model.skops")
    assert "a pipe or a device" in refusal(tmp_path / "model.skops")
