# SPDX-License-Identifier: BSD-3-Clause
"""Record folders: what is diagnosed, what comes after, what is behind it, and the sealed truth."""

import hashlib
import json

import numpy as np

# kinds of text that a sheet holds
_KEYS = ("column", "constant", "unit", "sense", "gauge")


def write_record(folder, table, behind, sheet, truth, rows):
    """One record; `table` and `behind` are dicts of columns over rows and later rows.

    Returns
    -------
    line : str
        SHA-256 of truth.json and the record's name, for the seal.
    """
    import pandas as pd

    folder.mkdir(parents=True)
    packed = {"index": False, "compression": {"method": "gzip", "mtime": 0}, "float_format": "%.9g"}
    frame = pd.DataFrame(table)
    frame.iloc[:rows].to_csv(folder / "recording.csv.gz", **packed)
    frame.iloc[rows:].to_csv(folder / "later.csv.gz", **packed)
    pd.DataFrame(behind).to_csv(folder / "behind.csv.gz", **packed)
    (folder / "valve.toml").write_text(toml_of(sheet), encoding="utf-8")
    told = {"name": folder.name} | truth | {"rows": rows, "rows_later": len(frame) - rows}
    text = json.dumps(plain(told), indent=1) + "\n"
    (folder / "truth.json").write_text(text, encoding="utf-8")
    return f"{hashlib.sha256(text.encode()).hexdigest()}  {folder.name}"


def plain(value):
    """The same in types that JSON has, numbers to six digits."""
    if isinstance(value, dict):
        return {key: plain(inner) for key, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(inner) for inner in value]
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    if isinstance(value, (float, np.floating)):
        return float(f"{value:.6g}")
    if isinstance(value, np.integer):
        return int(value)
    return value


def toml_of(sheet):
    """A sheet as TOML: sections, and in [recording] a section a role."""
    lines = []
    for section, content in sheet.items():
        lines.append(f"[{section}]")
        flat = {key: value for key, value in content.items() if not isinstance(value, dict)}
        lines += [f"{key} = {json.dumps(value)}" for key, value in flat.items()] + [""]
        for role, told in content.items():
            if isinstance(told, dict):
                lines.append(f"[{section}.{role}]")
                lines += [f"{key} = {json.dumps(told[key])}" for key in _KEYS if key in told] + [""]
    return "\n".join(lines)


def rounded(values, step):
    """Values as a recorder of this resolution holds them; None keeps them as they are."""
    return values if step is None else step * np.round(values / step)


def of_base(base, change=None):
    """Columns to write and columns behind them, of a stretch with or without an effect."""
    time = base.dt * np.arange(len(base.command))
    if change is None:
        seen, recorded = base.opening, base.recorded_flow
    else:
        seen, recorded, _, _ = base.with_effect(change)
        recorded = rounded(recorded, base.digits.get("F"))
    table = {"time": time, "CV": base.columns["CV"]}
    if seen is not None:
        percent = 100.0 * seen
        table["X"] = percent if change is None else rounded(percent, base.digits.get("X"))
    table |= {name: values for name, values in base.columns.items() if name != "CV"} | {"F": recorded}
    rest = base.rests()[0]
    sound = base.stem()
    moved = base.stem(change)
    own = 0.0 if rest is None else rest
    behind = {
        "time": time,
        "flow": base.passage(moved + own, change),
        "healthy_flow": base.passage(sound + own),
        "opening": 100.0 * (moved + base.sensor(change)),
        "healthy_opening": 100.0 * sound,
    }
    return table, behind


def of_loop(loop, stick=0.0, jump=0.0, onset=0.0):
    """The same of a refinery loop; its flow has a unit that nobody told, written as m3/h."""
    command, value, stem = (
        loop.run(stick, jump, onset) if stick > 0.0 else (loop.command, loop.value, loop.command)
    )
    time = loop.dt * np.arange(len(command))
    quick, per_row = loop.fast(command)
    start = quick[0]
    healthy = loop.value[0] + loop.answer(quick - start, per_row)
    # what sticking changes of the flow, at the command that was given
    off = loop.run(stick, jump, onset)[1] - loop.value if stick > 0.0 else 0.0
    told = loop.answer(quick - loop.fast(loop.command)[0], per_row)
    table = {"time": time, "CV": command, "F": value, "SP": loop.setpoint}
    behind = {
        "time": time, "flow": healthy + off - told, "healthy_flow": healthy,
        "opening": stem, "healthy_opening": command,
    }  # fmt: skip
    sheet = {
        "valve": {"tag": "loop"},
        "recording": {
            "time": "time", "command": {"column": "CV", "unit": "%"},
            "flow": {"column": "F", "unit": "m3/h"}, "setpoint": {"column": "SP", "unit": "m3/h"},
        },
    }  # fmt: skip
    return table, behind, sheet
