# SPDX-License-Identifier: BSD-3-Clause
"""What is done with a file of each kind, and what must hold of one that is accepted."""

import json
import math
import tomllib
import warnings

import numpy as np

from benchmarks.fuzz.seeds import SHEET, frame

NAMES = {
    "toml": "valve.toml",
    "csv": "recording.csv",
    "gz": "recording.csv.gz",
    "parquet": "recording.parquet",
    "export": "export.txt",
    "model": "model.skops",
    "estimator": "estimator.skops",
}


class Unsound(Exception):
    """Something that was accepted holds an infinity, or does not come back as it was written."""


def reader(kind):
    """Function of a path that reads a file of this kind as the commands do, and judges what it gives."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        prepared = {"model": _prepare_model, "estimator": _prepare_estimator}.get(kind, lambda: None)()

    def read(path, rng):
        # a warning is a sentence for a person; what is a fault comes as an exception
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            _READERS[kind](path, rng, prepared)

    return read


def _toml(path, rng, _):
    from sklvalve.recording import Valve, read_valve

    valve = read_valve(path)
    _require_finite(valve.to_dict())
    if Valve.from_dict(valve.to_dict()).to_dict() != valve.to_dict():
        raise Unsound("a valve does not come back as it was written")


def _recording(path, rng, _):
    from sklvalve.recording import Valve, read_recording, screen_recording
    from sklvalve.recording.draft import draft_valve, read_recording_columns
    from sklvalve.recording.reader import read_columns

    refused = None
    try:
        recording = read_recording(path, Valve.from_dict(tomllib.loads(SHEET), source="valve.toml"))
        _require_finite([recording.time, *recording.signals.values()], gaps=True)
        if rng.random() < 0.1:
            screen_recording(recording)
    except ValueError as error:  # what the package refuses is a ValueError too; others end here
        refused = _own(error)
    if rng.random() < 0.2:
        columns = read_recording_columns(read_columns(path).columns, str(path))
        Valve.from_dict(tomllib.loads(draft_valve(columns).text))
    if refused is not None:
        raise refused


def _own(error):
    from sklvalve.recording import InputError

    if not isinstance(error, InputError):
        raise error
    return error


def _export(path, rng, _):
    from sklvalve.recording.historian import ImportSettings, import_export
    from sklvalve.recording.historian.write import write_recording
    from sklvalve.recording.reader import read_columns

    period = rng.choice((None, None, None, 1.0, 0.5, 7.0, 1e9))
    settings = ImportSettings(
        zone=rng.choice((None, None, None, "Europe/Warsaw", "+01:00")),
        period=period,
        # both together ask for millions of rows, which take their time and are no fault
        gap=rng.choice((5.0, 5.0, 1e6, 1e-3)) if period is None else 5.0,
        day_first=rng.choice((None, None, True)),
        decimal=rng.choice((None, None, ".", ",")),
        encoding=rng.choice((None, None, None, "utf-8", "cp1250", "utf-16", "utf-7", "shift_jis")),
        keep_uncertain=rng.random() < 0.2,
    )
    made = import_export([path], settings)
    _require_finite(list(made.columns.values()), gaps=True)
    json.dumps(made.account, allow_nan=False)
    if len(made.stamps) < 20_000:
        again = path.with_name("imported.csv")
        write_recording(again, made.stamps, made.columns)
        read = read_columns(again).columns
        if list(read) != ["time", *made.columns]:
            raise Unsound("columns of an import do not come back as they were written")


def _prepare_model():
    from sklvalve.recording import Recording, Valve

    recording = Recording.from_frame(frame(), Valve.from_dict(tomllib.loads(SHEET)))
    from benchmarks.fuzz.seeds import simulated

    simulated().simulate(recording)  # compiled before the clock runs
    return recording


def _model(path, rng, recording):
    from sklvalve.mismatch import load_model

    model = load_model(path)
    for kind in ("corrected", "nominal"):
        _require_finite(list(model[kind].simulate(recording).values()), gaps=True)
    json.dumps(model["diagnosis"], allow_nan=False)


def _prepare_estimator():
    from benchmarks.fuzz.seeds import rows_of_estimators

    return rows_of_estimators()[0]


def _estimator(path, rng, rows):
    from sklvalve.mismatch import load_model

    made = load_model(path).predict(rows)
    _require_finite([np.asarray(made)], gaps=True)


def _require_finite(held, *, gaps=False):
    """No infinity, and no NaN where gaps are none, in nested data."""
    if isinstance(held, dict):
        held = [*held.values()]
    if isinstance(held, list | tuple):
        for each in held:
            _require_finite(each, gaps=gaps)
    elif isinstance(held, float) and not (math.isfinite(held) or (gaps and held != held)):
        raise Unsound(f"{held} was accepted")
    elif isinstance(held, np.ndarray) and held.dtype.kind == "f":
        bad = np.isinf(held) if gaps else ~np.isfinite(held)
        if bad.any():
            raise Unsound("an infinity was accepted")


_READERS = {
    "toml": _toml,
    "csv": _recording,
    "gz": _recording,
    "parquet": _recording,
    "export": _export,
    "model": _model,
    "estimator": _estimator,
}
