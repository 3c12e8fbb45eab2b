# SPDX-License-Identifier: BSD-3-Clause
"""
One's own simulation, given as a column
=======================================

For the engineer who has a simulation already, in whatever program. Its output goes into the recording as
one column more; nothing of it need be known here. The finder takes it as the thing to be corrected.
"""

# %%
# The recording, and the simulation of the user's
# -----------------------------------------------
# Something blocks the passage from an opening on. The simulation knows the data sheet, the opening and the
# pressures, and nothing of a blockage.

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from sklvalve import MissingPhysicsFinder, Recording, Valve
from sklvalve.datasets import make_valve_recording
from sklvalve.mechanism import rate_liquid, relative_capacity
from sklvalve.report import summary_sentence

made = make_valve_recording("clogging", 0.4, n_samples=900, n_later=600, loop="wide", random_state=3)
sheet = made.valve["valve"]
frame = pd.concat([made.frame, made.later], ignore_index=True)


def simulated(frame):
    """Flow [m3/h] by the data sheet; the stand-in for a program of the user's own."""
    trim = relative_capacity(
        np.clip(frame["X"] / 100.0, 0.0, 1.0), sheet["characteristic"], rangeability=sheet.get("rangeability")
    )
    p1, p2, kelvin = 1e3 * frame["P1"], 1e3 * frame["P2"], 273.15 + frame["T1"]
    return 3600.0 * rate_liquid(sheet["kv_rated"] * trim, p1, p2, kelvin, fl=sheet["fl"])


frame["F_sim"] = simulated(frame)

# %%
# One line more in the valve.toml (here: one entry of a dict) says which column it is.

made.valve["recording"]["simulated_flow"] = {"column": "F_sim", "unit": "m3/h"}
recording = Recording.from_frame(frame, Valve.from_dict(made.valve))
finder = MissingPhysicsFinder(random_state=0).fit(recording, until=900)
print(summary_sentence(finder.diagnosis_.to_dict()))

# %%
# The sentence begins at the error of the user's simulation after its calibration: gain, zeros, response and
# trim within their tolerance. The number at the end of this page begins at the raw column, which errs more.

# %%
# The corrected simulation is the user's own, changed by what was found
# ---------------------------------------------------------------------

corrected = recording.in_recorded_units("flow", finder.corrected_simulation_.simulate(recording)["flow"])
later = slice(900, None)

fig, ax = plt.subplots(figsize=(6, 3.4), layout="constrained")
drop = np.sqrt((frame["P1"] - frame["P2"]) / 100.0)
for flow, name in ((frame["F"], "recorded"), (frame["F_sim"], "own simulation"), (corrected, "corrected")):
    ax.plot(frame["X"][later], (flow / drop)[later], ".", markersize=3, label=name)
ax.set(xlabel="opening [%]", ylabel="flow over root of the drop [m3/h at 1 bar]")
ax.legend()

# %%
# Its number
# ----------

before, after = (np.sqrt(np.nanmean((frame["F"] - flow)[later] ** 2)) for flow in (frame["F_sim"], corrected))
print(f"Error of the flow on 600 later rows: {before:.2f} m3/h by the raw simulation, {after:.2f} corrected")
