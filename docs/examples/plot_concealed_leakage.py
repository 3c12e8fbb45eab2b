# SPDX-License-Identifier: BSD-3-Clause
"""
A concealed leak, found and simulated
=====================================

For the engineer whose valve passes more than its data sheet says. A seat leaks in a simulated recording of
a quarter of an hour; nobody tells the finder. It says what is missing, how large it is, and predicts the
ten minutes that follow better than before.
"""

# %%
# A recording in which something is concealed
# -------------------------------------------
# The plant is finer than the simulation that is held against it and shares no code with it. One row a
# second: command, stem position, two pressures, temperature and flow. The last 600 rows serve for nothing
# but the final figures.

import pandas as pd

from sklvalve import MissingPhysicsFinder, Recording, Valve
from sklvalve.datasets import make_valve_recording
from sklvalve.report import ExplanationDisplay, FitImprovementDisplay, SignatureDisplay, summary_sentence

made = make_valve_recording("seat_leakage", 0.05, n_samples=900, n_later=600, loop="wide", random_state=7)
valve = Valve.from_dict(made.valve)
recording = Recording.from_frame(pd.concat([made.frame, made.later]), valve)

# %%
# What does the simulation leave out?
# -----------------------------------

finder = MissingPhysicsFinder(random_state=0).fit(recording, until=900)
diagnosis = finder.diagnosis_.to_dict()
print(summary_sentence(diagnosis))

# %%
# A leak through the seat and an open bypass are the same equation, so that no signal of the valve tells
# them apart. They are named together, as equals, and the next test says how to part them.

ExplanationDisplay.from_estimator(finder)
print(diagnosis["next_test"])

# %%
# The signature of the valve: near the seat the recorded flow lies above the simulated one, and the
# corrected simulation goes with it.

SignatureDisplay.from_estimator(finder)

# %%
# Rows that no fit has seen
# -------------------------
# The black box is an LS-SVM on the same signals with their lags; the dashed line is the noise of the meter.

FitImprovementDisplay.from_estimator(finder)

found = diagnosis["effects"][0]["parameters"]
name, size = next(iter(found.items()))
true = 0.05 * valve.kv_rated
low, high = size["ci95"]
print(f"{name}: {size['value']:.2f} m3/h, 95 % from {low:.2f} to {high:.2f}; concealed were {true:.2f} m3/h")

# %%
# Its number
# ----------

rmse = diagnosis["fit"]["flow"]["rmse"]
print(
    f"Error of the flow on 600 later rows: {rmse['nominal']:.3f} m3/h before, {rmse['corrected']:.3f} after"
)
