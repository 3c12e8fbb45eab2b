# SPDX-License-Identifier: BSD-3-Clause
"""
A recording that leaves many names, and the test that leaves few
================================================================

For the engineer who is asked which valve to open in the next shutdown. A flow controller holds its flow, so
that the valve hardly moves. Something is missing in the simulation, but many effects would look alike here:
the diagnosis names them all, as one class. The next test moves the same valve over its travel.
"""

# %%
# Ten minutes of normal operation
# -------------------------------
# The seat leaks; the controller keeps the opening in a narrow band.

import matplotlib.pyplot as plt
import pandas as pd

from sklvalve import MissingPhysicsFinder, Recording, Valve
from sklvalve.datasets import make_valve_recording
from sklvalve.report import ExplanationDisplay


def recorded(loop, rows, later):
    """The same valve with the same leak, its command given by a controller or by hand."""
    return make_valve_recording(
        "seat_leakage", 0.08, n_samples=rows, n_later=later, loop=loop, random_state=1
    )


today = recorded("closed", 900, 0)
valve = Valve.from_dict(today.valve)
operation = Recording.from_frame(today.frame[:600], valve)
before = MissingPhysicsFinder().fit(operation)
print(before.diagnosis_.verdict, [len(names) for names in before.diagnosis_.effects], "names")
ExplanationDisplay.from_estimator(before)

# %%
# Any of these names may be the cause: the recording does not separate them. Which test would? The finder
# simulates some ten programs of the command with each explanation in turn and takes the one whose record
# would set them furthest apart. Where no class is named, the verdict is ``cannot_tell`` instead, and the
# reasons say why.

print(before.diagnosis_.content["next_test"])

# %%
# The test
# --------
# Here the command goes over most of the travel. The new record is diagnosed together with that of today:
# both share the valve, each has its own noise. The last 300 rows are kept back.

test = recorded("wide", 600, 300)
tested = Recording.from_frame(pd.concat([test.frame, test.later]), valve)
after = MissingPhysicsFinder().fit([operation, tested], until=1200)
ExplanationDisplay.from_estimator(after)

# %%
# How far the command went in either recording:

fig, ax = plt.subplots(figsize=(6.4, 2.4), layout="constrained")
ax.hist([today.frame["CV"], test.frame["CV"]], bins=25, range=(0, 100), density=True, label=["today", "test"])
ax.set(xlabel="command [%]", ylabel="share of rows")
ax.legend()

# %%
# Its number
# ----------

many = [len(finder.diagnosis_.effects[0]) for finder in (before, after)]
error = after.diagnosis_.content["fit"]["flow"]["rmse"]
print(" or ".join(after.diagnosis_.effects[0]))
print(
    f"Names left: {many[0]} without the test, {many[1]} with it; error of the flow on 300 later rows: "
    f"{error['nominal']:.2f} m3/h before, {error['corrected']:.2f} after"
)
