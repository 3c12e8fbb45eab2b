# SPDX-License-Identifier: BSD-3-Clause
"""Sound files of every kind, made here, from which mutations begin."""

import gzip
import io
from types import SimpleNamespace

import numpy as np
import pandas as pd

SHEET = """[valve]
tag = "FV-101"
kv_rated = 40.0
characteristic = "equal_percentage"
rangeability = 40.0
shutoff = 0.02
fl = [[0.0, 0.95], [1.0, 0.85]]
fd = 0.46
xt = 0.7
nominal_size = 50.0
inlet_pipe = 80.0
travel = 38.1
[fluid]
name = "water"
vapour_pressure = 2.3
critical_pressure = 22064.0
[actuator]
kind = "pneumatic"
fail = "closed"
supply_pressure = 340.0
spring_range = [20.0, 100.0]
effective_area = 290.0
positioner = true
stroke_time = 8.0
dead_band = 0.5
[simulation]
physics = ["choked_flow"]
[recording]
time = "time"
[recording.command]
column = "CV"
unit = "%"
sense = "closing"
[recording.opening]
column = "X"
unit = "mm"
[recording.p1]
column = "P1"
unit = "bar"
gauge = true
[recording.p2]
constant = 1.0
unit = "MPa"
[recording.temperature]
column = "T"
unit = "degF"
[recording.flow]
column = "F"
unit = "m3/h"
"""
_ROWS = 40


def frame(dated=False):
    """A small recording in the units of the sheet."""
    k = np.arange(_ROWS)
    wave = 0.5 + 0.4 * np.sin(k / 5.0)
    stamps = [f"2024-06-28T10:{s // 60:02d}:{s % 60:02d}" for s in k] if dated else (100.0 + k).tolist()
    return pd.DataFrame(
        {
            "time": stamps,
            "CV": 100.0 - 100.0 * wave,
            "X": 38.1 * wave,
            "P1": 20.0 + 0.1 * wave,
            "T": 70.0 + k,
            "F": 10.0 * wave,
        }
    )


def corpus(kind):
    """Seeds of a kind, each the content of a file.

    Parameters
    ----------
    kind : {"toml", "csv", "gz", "parquet", "export", "model", "estimator"}

    Returns
    -------
    seeds : list of bytes
    """
    return _MAKERS[kind]()


def _csv():
    texts = [frame(dated).to_csv(index=False, float_format="%.6g") for dated in (False, True)]
    quoted = texts[0].replace("CV,X", '"CV","X"').replace("\n", "\r\n")
    gaps = texts[1].replace(",70,", ",,").replace(",71,", ",NaN,")
    return [text.encode() for text in (*texts, quoted, gaps)]


def _parquet():
    made = []
    for dated, settings in (
        (False, {"index": False}),
        (True, {"compression": "gzip"}),
        (False, {"compression": "zstd", "use_dictionary": False}),
    ):
        target = io.BytesIO()
        frame(dated).to_parquet(target, **settings)
        made.append(target.getvalue())
    table = frame(True)
    table.index = pd.to_datetime(table.pop("time")).rename("time")
    target = io.BytesIO()
    table.assign(note=["a", None] * (_ROWS // 2)).to_parquet(target)
    return [*made, target.getvalue()]


def _export():
    table = frame(True)
    stamps = [stamp.replace("T", " ") for stamp in table["time"]]
    german = [f"28.06.2024 {stamp[11:]}" for stamp in stamps]
    wide = "Zeit;FIC1.PV [m3/h];FIC1.OP [%]\n" + "".join(
        f"{s};{f:.2f};{c:.1f}\n".replace(".", ",").replace("28,06,2024", "28.06.2024")
        for s, f, c in zip(german, table["F"], table["CV"], strict=True)
    )
    long = "Tag;Time;Value;Quality\n" + "".join(
        f"{tag};{s};{v:.3f};{'Bad' if k == 7 else 'Good'}\n"
        for tag, column in (("FIC1.PV", "F"), ("FIC1.OP", "CV"))
        for k, (s, v) in enumerate(zip(stamps, table[column], strict=True))
    )
    zoned = "time,FIC1.PV,FIC1.PV quality\n" + "".join(
        f"{s}+02:00,{v:.3f} m3/h,192\n" for s, v in zip(stamps, table["F"], strict=True)
    )
    unix = "timestamp\tF\tP\n" + "".join(
        f"{1719560000000 + 1000 * k}\t{k}.5\t1,234.5\n" for k in range(_ROWS)
    )
    excel = "sep=,\nDate,Time,F\n" + "".join(f"06/28/2024,10:{k:02d}:00 AM,{k}\n" for k in range(_ROWS))
    texts = [wide.encode("cp1252"), *(text.encode() for text in (long, zoned, unix, excel))]
    return [*texts, wide.encode("utf-16"), gzip.compress(long.encode(), mtime=0)]


def _model():
    made = []
    for correction in (None, _correction()):
        simulation = simulated(correction)
        finder = SimpleNamespace(
            corrected_simulation_=simulation,
            nominal_simulation_=simulation,
            diagnosis_=SimpleNamespace(to_dict=lambda: {"schema": "sklvalve.diagnosis/1", "effects": []}),
        )
        made.append(_saved(finder))
    return made


def _estimator():
    from sklearn.pipeline import make_pipeline
    from sklearn.preprocessing import StandardScaler

    from sklvalve.hybrid import SeriesHybridRegressor
    from sklvalve.lssvm import LSSVMRegressor

    X, flow = rows_of_estimators()
    scaled = make_pipeline(StandardScaler(), LSSVMRegressor(gamma=0.3, C=100.0)).fit(X, flow)
    hybrid = SeriesHybridRegressor(regressor_columns=[0]).fit(X, flow)
    alone = LSSVMRegressor(gamma=1e-10, C=10.0, uncertainty=True).fit(X, flow)
    # with a trial of known result, and with one that is made up
    return [_saved(scaled, rows=X), _saved(scaled), _saved(hybrid, rows=X), _saved(alone)]


def rows_of_estimators():
    """Opening and both pressures [Pa], and the flow of a valve of Kv 40 [m3/s]."""
    wave = np.sin(np.arange(_ROWS) / 5.0)
    X = np.column_stack([0.5 + 0.4 * wave, 6e5 + 5e4 * np.cos(np.arange(_ROWS) / 3.0), 3e5 + 4e4 * wave])
    return X, 40.0 * X[:, 0] ** 2 * np.sqrt((X[:, 1] - X[:, 2]) / 1e5) / 3600.0


def _saved(model, **settings):
    """A model file's content."""
    import tempfile
    from pathlib import Path

    from sklvalve.mismatch import save_model

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "model.skops"
        save_model(path, model, **settings)
        return path.read_bytes()


def simulated(correction=None):
    """A simulation as a diagnosis leaves it, with an effect that began at a moment."""
    import tomllib

    from sklvalve.mismatch.effects import CATALOGUE
    from sklvalve.recording import Valve
    from sklvalve.simulation import ValveSimulation

    values = {
        "actuator_filter": 0.4, "actuator_gain": 30.0, "actuator_reset": 0.02, "actuator_rate": 2.0,
        "actuator_coulomb": 0.01, "actuator_feedback": 0.02, "actuator_vent": 1.05, "actuator_loop": 0.05,
        "actuator_delay": 1.0, "position_zero": 4e-4, "capacity": 41.0, "meter_lag": 0.8, "meter_ahead": 0.9,
        "flow_zero": -9e-6, "stem_zero": -4e-4, "dp_zero": 70.0, "fl_scale": 0.95, "fl_slope": 0.07,
        "knee": 8.0,
        **{f"trim_{k}": 0.01 * (-1) ** k for k in range(7)},
    }  # fmt: skip
    effect = next(e for e in CATALOGUE if e.key == "flow_meter_gain")
    values |= {f"{effect.key}.{p.name}": p.starts[0] for p in effect.parameters}
    state = {
        "values": values,
        "choking": True,
        "effects": [effect.key],
        "onsets": {effect.key: [5.0, 9.0]},
        "seen": [100.0, 139.0],
        "trim": {"knots": None, "rated": 40.0, "given": False, "curve": None},
        "correction": correction,
    }
    return ValveSimulation.from_state(Valve.from_dict(tomllib.loads(SHEET)), state, (effect,))


def _correction():
    rng = np.random.default_rng(0)
    return {
        "channel": "flow",
        "inputs": ("opening", "dp", "temperature 60 s"),
        "centre": np.array([0.5, 10.0, 300.0]),
        "scale": np.array([0.2, 1.0, 5.0]),
        "support": rng.standard_normal((12, 3)),
        "coefficients": rng.standard_normal(12),
        "intercept": 0.1,
        "gamma": 0.5,
        "span": 1e-4,
    }


_MAKERS = {
    "toml": lambda: [SHEET.encode(), b"[valve]\nkv_rated = 40.0\n", SHEET.replace("\n", "\r\n").encode()],
    "csv": _csv,
    "gz": lambda: [gzip.compress(each, mtime=0) for each in _csv()],
    "parquet": _parquet,
    "export": _export,
    "model": _model,
    "estimator": _estimator,
}
KINDS = tuple(_MAKERS)
