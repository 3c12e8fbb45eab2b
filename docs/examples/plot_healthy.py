# SPDX-License-Identifier: BSD-3-Clause
"""
Nothing is missing: what a healthy report says
==============================================

For the one who fears false alarms. Most valves are sound, and no two of them are as their data sheet has
it: capacity, trim, zeros and response lie somewhere within a tolerance. That is calibration. What the
finder says of such a valve, and how sure it is.
"""

# %%
# A sound valve whose trim, zeros and response are drawn within their tolerances, under a flow controller
# with set-point steps:

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from sklvalve import MissingPhysicsFinder, Recording, Valve
from sklvalve.datasets import make_valve_recording
from sklvalve.mechanism import rate_liquid, relative_capacity
from sklvalve.report import FitImprovementDisplay, to_text

made = make_valve_recording(None, n_samples=900, n_later=600, loop="closed", random_state=2)
valve = Valve.from_dict(made.valve)
recording = Recording.from_frame(pd.concat([made.frame, made.later]), valve)
finder = MissingPhysicsFinder(random_state=0).fit(recording, until=900)
print(to_text(finder.diagnosis_.to_dict()))

# %%
# The p-value is the share of healthy simulated recordings that lie as far from their simulation as this
# one, or further. It is made of ranks among healthy recordings that went through the whole search. On the 50
# healthy valves of the newest sealed draw it was uniform (Kolmogorov-Smirnov p 0.19), and none raised an
# alarm.
#
# Every effect of the catalogue is tried at several sizes, so the strongest of them always gains something.
# A large strength alone is therefore no alarm. What counts is the strength of healthy recordings with as
# much noise and travel, in standard deviations. Effects that act throughout and effects that begin within
# the recording are held against their own:

evidence = finder.evidence_
for look in ("throughout", "within"):
    typical = evidence.law.tables[look].typical(evidence.covariates)
    print(f"strongest effect, {look}: {evidence.looks[look]:.2f}; typical of healthy ones: {typical:.2f}")

# %%
# Calibration alone
# -----------------
# The data sheet as it stands, in the equation of IEC 60534-2-1, beside the calibrated simulation, on rows
# that nothing was fitted to.

later = Recording.from_frame(made.later, valve)
kv = valve.kv_rated * relative_capacity(
    later["opening"], valve.characteristic, rangeability=valve.rangeability
)
sheet = later.in_recorded_units(
    "flow", rate_liquid(kv, later["p1"], later["p2"], later["temperature"], fl=valve.fl)
)
calibrated = later.in_recorded_units("flow", finder.nominal_simulation_.simulate(later)["flow"])

fig, ax = plt.subplots(figsize=(7, 2.8), layout="constrained")
for values, name in ((made.later["F"], "recorded"), (sheet, "data sheet"), (calibrated, "calibrated")):
    ax.plot(made.later["time"], values, label=name, linewidth=0.9)
ax.set(xlabel="time [s]", ylabel="flow [m3/h]")
ax.legend(ncols=3)
FitImprovementDisplay.from_estimator(finder)

# %%
# Its number
# ----------


def rmse(flow):
    """Error of a flow on the later rows [m3/h]."""
    return np.sqrt(np.mean((made.later["F"] - flow) ** 2))


p_value = finder.diagnosis_.content["mismatch"]["p_value"]
print(
    f"No alarm (p = {p_value:.2f}); error of the flow on 600 later rows: "
    f"{rmse(sheet):.3f} m3/h by the data sheet, {rmse(calibrated):.3f} calibrated"
)
