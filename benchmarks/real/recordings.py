# SPDX-License-Identifier: BSD-3-Clause
"""Recordings of a folder, each cut into one csv with the sheet that a user would write of it."""

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pandas as pd

LOOP, FLOW, ACTUATOR, OUTSIDE = "loop", "valve with flow", "actuator with position", "outside the field"
#: Made by a program of others; not counted among the real ones.
SIMULATED = "simulated by others"
WATERSAFE = {"VA_A1": "recording.csv", "VA_C1": "recording.csv", "VA_C3": "recording.csv"}
#: Runs of the cylinder: nothing commands it, so one a seal's kind shows the answer of all 51.
CYLINDERS = ("Circle_1bar", "Kidney_3bar", "O-ring257_5bar")
_KPA = 4000.0  # span of the benchmark's pressures [kPa]


class Case(NamedTuple):
    """A recording to be judged; `table` gives its rows, `sheet` its valve.toml (None: `init` drafts it)."""

    name: str
    kind: str
    table: Callable[[], pd.DataFrame]
    sheet: str | None
    label: dict | None = None
    until: str | None = None
    note: str = ""


def _sheet(time, **roles):
    """valve.toml that gives the roles of columns: role=(column, unit) or (column, unit, more lines)."""
    parts = [f'[recording]\ntime = "{time}"']
    for role, (column, unit, *more) in roles.items():
        parts.append("\n".join([f'[recording.{role}]\ncolumn = "{column}"\nunit = "{unit}"', *more]))
    return "\n".join(parts) + "\n"


def _refinery(folder, labels):
    index, loops = pd.read_csv(folder / "index.csv"), pd.read_csv(folder / "loops.csv.gz")
    windows = dict(list(loops.groupby("id")))
    for window in index.itertuples():
        role, unit = ("flow", "m3/s") if window.loop == "FIC" else ("process_value", "m")
        rows = windows[window.id]
        # two windows hold the same times twice
        once = rows.drop_duplicates("t")[["t", "op", "pv", "sp"]]
        note = f"{len(rows) - len(once)} rows of a time seen before left out" if len(once) < len(rows) else ""
        sheet = _sheet("t", command=("op", "%"), **{role: ("pv", unit)}, setpoint=("sp", unit))
        label = labels["refinery_sticking" if window.stiction else "refinery_sound"]
        note = "; ".join(part for part in (window.tag, note) if part)
        yield Case(f"refinery_{window.id}", LOOP, lambda once=once: once, sheet, label, note=note)


def _isdb(folder, labels):
    for file in sorted(folder.glob("*.csv.gz")):
        name = f"isdb_{file.name.split('.')[0]}"
        yield Case(name, LOOP, lambda file=file: pd.read_csv(file), None, labels.get(name))


def _watersafe(folder, labels):
    files = WATERSAFE | {"VA_B4": "VA_B4.csv.gz", "VA_C4": "VA_C4.csv.gz"}
    for valve, until in [*((v, "6000") for v in files), ("VA_C4", None)]:
        name = f"watersafe_{valve}" + ("" if until else "_all")
        sheet = (folder / f"{valve}.toml").read_text(encoding="utf-8")
        file = folder / files[valve]
        yield Case(name, FLOW, lambda file=file: pd.read_csv(file), sheet, labels.get(name), until)


def _belimo(folder, labels):
    file = folder / "campaign_20hz.csv.gz"
    columns = ["timestamp", "setpoint_position_%", "feedback_position_%"]
    sheet = _sheet("timestamp", command=(columns[1], "%"), opening=(columns[2], "%"))
    rows = pd.read_csv(file)
    for run, part in rows.groupby("test_id"):
        part = part[columns]
        yield Case(f"belimo_{run}", ACTUATOR, lambda part=part: part, sheet, labels["belimo"])


def _cylinder(folder, labels):
    rows = pd.read_csv(folder / "friction_100hz.csv.gz")
    for run in CYLINDERS:
        part = rows[rows["run"] == run].drop(columns="run").drop_duplicates("t_ms")
        part = part.assign(t_s=1e-3 * part.pop("t_ms"))[["t_s", "x_mm", "p_bar", "force_N"]]
        yield Case(f"cylinder_{run}", OUTSIDE, lambda part=part: part, None, note="no command is recorded")


def _tanks(folder, labels):
    rows = pd.read_csv(folder / "dataBenchmark.csv")
    sheet = _sheet("t_s", command=("pump", "1"), process_value=("level", "m"))
    for part in ("Est", "Val"):
        table = pd.DataFrame(
            {
                "t_s": 4.0 * rows.index[:1024],
                "pump": 0.1 * rows[f"u{part}"][:1024],
                "level": rows[f"y{part}"][:1024],
            }
        )
        yield Case(
            f"tanks_{part}", OUTSIDE, lambda table=table: table, sheet, note="pump and level, no valve"
        )


def _damadics(folder, labels):
    closing = 'sense = "closing"'
    hour = _sheet(
        "t_s",
        command=("LC74_20CV_pct", "%", closing),
        opening=("LC74_20X_pct", "%", closing),
        flow=("F74_00_tph", "t/h"),
        p1=("P74_00_kPa", "kPa"),
        p2=("P74_01_kPa", "kPa"),
        temperature=("T74_00_degC", "degC"),
    )
    file = folder / "actuator3_real_one_hour.csv"
    yield Case("damadics_hour", FLOW, lambda: pd.read_csv(file), hour)
    run = _sheet(
        "t_s",
        command=("CV", "1", closing),
        opening=("Xn", "1", closing),
        flow=("Fn", "m3/h"),
        p1=("P1", "kPa"),
        p2=("P2", "kPa"),
    )

    def table():
        rows = pd.read_csv(folder / "dablib_dgen_f13_incipient_run.csv")
        return rows.assign(P1=_KPA * rows["P1n"], P2=_KPA * rows["P2n"])[
            ["t_s", "CV", "P1", "P2", "Xn", "Fn"]
        ]

    note = "simulated by the original generator; the flow's scale is unknown"
    yield Case("damadics_generator", SIMULATED, table, run, labels["damadics_generator"], note=note)


# quick ones first, so that a run that is cut short has seen most recordings
_GROUPS = {
    "isdb": _isdb,
    "cylinder_friction": _cylinder,
    "cascaded_tanks": _tanks,
    "refinery_loops": _refinery,
    "belimo_actuator": _belimo,
    "damadics": _damadics,
    "watersafe": _watersafe,
}


def cases(folder):
    """Every recording of a folder; groups that it does not hold are left out."""
    labels = tomllib.loads((Path(__file__).parent / "labels.toml").read_text(encoding="utf-8"))
    for group, read in _GROUPS.items():
        if (Path(folder) / group).is_dir():
            yield from read(Path(folder) / group, labels)
