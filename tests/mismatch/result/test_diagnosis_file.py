# SPDX-License-Identifier: BSD-3-Clause
"""A saved diagnosis is the same when it is read, appears whole or not at all, and executes nothing."""

import io
import json
import os
import pickle
import zipfile

import numpy as np
import pytest

from sklvalve.mismatch import Diagnosis
from sklvalve.recording import InputError

CONTENT = {
    "schema": "sklvalve.diagnosis/1",
    "verdict": "named",
    "effects": [{"members": [{"name": "clogging", "probability": None}], "parameters": {}}],
    "sentence": "größer als 5 °C",
}
TRACES = {
    "time": np.arange(5.0),
    "units": {"flow": "m3/h"},
    "recorded": {"flow": np.array([1.0, np.nan, np.inf, 3.0, 4.0])},
    "flagged": np.array([True, False, False, False, True]),
    "pressure_ratio": None,
    "begins": [0, np.int64(3)],
    "until": 4,
}


def same(before, now):
    assert type(before) is type(now)
    if isinstance(before, dict):
        assert list(before) == list(now)
        for key in before:
            same(before[key], now[key])
    elif isinstance(before, np.ndarray):
        assert before.dtype == now.dtype
        np.testing.assert_array_equal(before, now)
    else:
        assert before == now


@pytest.fixture
def file(tmp_path):
    return tmp_path / "valve.diagnosis"


def test_what_is_read_is_what_was_saved(file):
    Diagnosis(CONTENT, TRACES).save(file)
    read = Diagnosis.load(str(file))
    same(CONTENT, read.to_dict())
    same(TRACES | {"begins": [0, 3]}, read.traces)
    assert [path.name for path in file.parent.iterdir()] == [file.name]


def test_a_diagnosis_of_a_recording_comes_back(file, found_healthy):
    diagnosis = found_healthy.diagnosis_
    diagnosis.save(file)
    read = Diagnosis.load(file)
    assert read.to_dict() == diagnosis.to_dict()
    same(diagnosis.traces, read.traces)
    assert read._repr_html_() == diagnosis._repr_html_()


@pytest.mark.parametrize("error", [KeyboardInterrupt, OSError])
def test_a_file_is_replaced_whole_or_not_at_all(file, monkeypatch, error):
    Diagnosis(CONTENT).save(file)
    before = file.read_bytes()

    def fails(*_, **__):
        raise error

    monkeypatch.setattr(np, "save", fails)
    with pytest.raises((KeyboardInterrupt, InputError)):
        Diagnosis(CONTENT | {"verdict": "cannot_tell"}, TRACES).save(file)
    assert file.read_bytes() == before
    assert [path.name for path in file.parent.iterdir()] == [file.name]


def test_what_cannot_be_saved_is_refused_and_leaves_no_file(file):
    for traces in ({"time": np.array([object()])}, {"time": object()}, {1: np.ones(3)}):
        with pytest.raises(InputError, match="the traces hold more than numbers, texts and arrays"):
            Diagnosis(CONTENT, traces).save(file)
    with pytest.raises(InputError, match=r"cannot be written .*; name a file"):
        Diagnosis(CONTENT).save(file / "no" / "folder")
    assert not list(file.parent.iterdir())


def test_what_is_no_saved_diagnosis_is_refused_in_one_sentence(file):
    with pytest.raises(InputError, match="cannot be read"):
        Diagnosis.load(file)
    Diagnosis(CONTENT, TRACES).save(file)
    whole = file.read_bytes()
    for damaged in (b"", b"{}", whole[: len(whole) // 2], pickle.dumps(CONTENT)):
        file.write_bytes(damaged)
        with pytest.raises(InputError, match="no saved diagnosis, or it is damaged"):
            Diagnosis.load(file)
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("diagnosis.json", json.dumps(CONTENT))
        archive.writestr("traces.json", json.dumps({"format": "sklvalve.saved_diagnosis/9", "traces": {}}))
    with pytest.raises(InputError, match="save the diagnosis anew"):
        Diagnosis.load(file)


class Harm:
    """Does something when it is unpickled."""

    def __init__(self, where):
        self.where = where

    def __reduce__(self):
        return os.mkdir, (self.where,)


def test_nothing_in_a_file_is_executed(file, tmp_path):
    buffer = io.BytesIO()
    np.save(buffer, np.array([Harm(str(tmp_path / "harmed"))], dtype=object), allow_pickle=True)
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("diagnosis.json", json.dumps(CONTENT))
        traces = {"time": {"array in": "0.npy"}}
        archive.writestr(
            "traces.json", json.dumps({"format": "sklvalve.saved_diagnosis/1", "traces": traces})
        )
        archive.writestr("0.npy", buffer.getvalue())
    with pytest.raises(InputError, match="no saved diagnosis, or it is damaged"):
        Diagnosis.load(file)
    assert not (tmp_path / "harmed").exists()
