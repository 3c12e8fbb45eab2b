# SPDX-License-Identifier: BSD-3-Clause
"""
A historian's export made a recording
=====================================

For the engineer with an export of the plant's historian. A stamp of its own for each tag, local time in the
night on which the clocks are set back, decimal commas, and words among the numbers: what becomes of them,
told value by value.
"""

# %%
# An export
# ---------
# Written here as a historian would: each tag only when it has moved by more than a dead band; for a while
# the connection is lost. The truth behind it is kept for the end.

from datetime import UTC, datetime, timedelta
from pathlib import Path
from tempfile import TemporaryDirectory
from zoneinfo import ZoneInfo

import matplotlib.pyplot as plt
import numpy as np

from sklvalve.recording.historian import ImportSettings, import_export

start, warsaw = datetime(2024, 10, 26, 23, 30, tzinfo=UTC), ZoneInfo("Europe/Warsaw")
rng = np.random.default_rng(0)
second = np.arange(7200)
command = np.round(50.0 + 30.0 * np.sin(np.arange(120) / 9.0) + 3.0 * rng.normal(size=120), 1).repeat(60)
flow = np.convolve(0.3 * np.pad(command, (29, 0), mode="edge"), np.full(30, 1.0 / 30.0), mode="valid")
lines = ["Tag;Time;Value;Quality"]
for tag, values, band in (("FIC101.OP [%]", command, 0.05), ("FIC101.PV [m3/h]", flow, 0.1)):
    last = np.inf
    for row, value in zip(second, values, strict=True):
        bad = 3000 < row < 3100
        if abs(value - last) > band or row in (3001, 3100):
            stamp = (start + timedelta(seconds=int(row))).astimezone(warsaw)
            text = "I/O Timeout" if bad else f"{value:.3f}".replace(".", ",")
            lines.append(f"{tag};{stamp:%d.%m.%Y %H:%M:%S};{text};{'Bad' if bad else 'Good'}")
            last = value
print(f"{len(lines) - 1} values for {2 * len(second)} seconds of two tags")
print("\n".join(lines[:4]))

# %%
# One time base
# -------------
# ``sklvalve import export.csv --out recording.csv --timezone Europe/Warsaw`` does the same from the command
# line.

with TemporaryDirectory() as folder:
    export = Path(folder) / "export.csv"
    export.write_text("\n".join(lines), encoding="utf-16")
    made = import_export([export], ImportSettings(zone="Europe/Warsaw", period=10.0, gap=20.0))
for tag, told in made.account["tags"].items():
    print(f"{tag}: {told['reports']} reports, without a value {told['bad']}, between them {told['method']}")

# %%
# What came out, beside what it was
# ---------------------------------

stamps = np.array([(datetime.fromisoformat(stamp) - start).total_seconds() for stamp in made.stamps])
fig, axes = plt.subplots(2, 1, figsize=(7, 4), sharex=True, layout="constrained")
for ax, (name, values), true in zip(axes, made.columns.items(), (command, flow), strict=True):
    ax.plot(second, true, color="0.7", linewidth=2.5, label="as it was")
    ax.plot(stamps, values, linewidth=0.9, label="imported")
    ax.set_ylabel(name)
    ax.legend()
axes[1].set_xlabel("time [s]")

# %%
# Its number
# ----------

worst = {}
for (name, values), true in zip(made.columns.items(), (command, flow), strict=True):
    known = np.isfinite(values)
    worst[name] = np.sqrt(np.mean((values - np.interp(stamps, second, true))[known] ** 2))
print(f"{len(stamps)} rows, {int(np.isnan(values).sum())} of them left empty; rms error: ", end="")
print(", ".join(f"{name} {error:.3f}" for name, error in worst.items()))
