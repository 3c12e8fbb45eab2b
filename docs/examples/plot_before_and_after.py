# SPDX-License-Identifier: BSD-3-Clause
"""
Before and after: what has changed since a valve was healthy
============================================================

For the engineer who has recordings of a valve from when it was sound. A little wear hides in what the data
sheet leaves open. The valve's own hour of sound operation leaves less open, and the same rows then tell what
has changed.
"""

# %%
# One valve, before and after
# ---------------------------
# The first hour is sound. Wear at the seat is concealed in the twenty minutes behind it. The same twenty
# minutes without wear are kept for comparison. One valve is a case, no proof: it was chosen to show this.

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from sklvalve import MissingPhysicsFinder, Recording, Valve, ValveHistory
from sklvalve.datasets import make_valve_recording
from sklvalve.history import Allowance


def recorded(wear):
    """An hour of sound operation, and twenty minutes with wear, a share of rated Kv."""
    made = make_valve_recording(
        "erosion", wear, onset=3600.0, loop="wide", n_samples=4800, n_later=0, random_state=1
    )
    whole = Recording.from_frame(made.frame, Valve.from_dict(made.valve))
    return whole.slice(0, 3600), whole.slice(3600, 4800)


before, after = recorded(wear=0.015)
sound = recorded(wear=0.0)[1]

# %%
# What the history holds
# ----------------------
# It holds the calibration, how well each number of it is known, the noise, and where the valve has been; no
# rows. Here ``fit`` only learns; for a real valve ``MissingPhysicsFinder().history_of`` diagnoses it as well.

history = ValveHistory().fit(before)
sheet = next(each for each in history.parameters if each.name == "capacity")
at = history.prior_.names.index("capacity")
value, spread = history.prior_.mean[at], np.sqrt(history.prior_.covariance[at, at])
print(f"rated capacity by the sheet:   {sheet.start:.1f} +- {1.96 * sheet.spread:.2f} m3/h (95 %)")
print(f"rated capacity by the history: {value:.1f} +- {1.96 * spread:.2f} m3/h (95 %)")

# %%
# The second figure already holds what may change without a fault: a meter is set to zero again, the season
# changes, another programme drives the stem. ``Allowance`` has a standard deviation for each.

print(", ".join(f"{name} {100 * share:g} %" for name, share in vars(Allowance()).items()))

# %%
# The same rows, diagnosed twice
# ------------------------------
# The sound rows show whether the history alone raises an alarm.

by_sheet = MissingPhysicsFinder(random_state=0).fit(after).diagnosis_
since = MissingPhysicsFinder(history=history, random_state=0).fit(after).diagnosis_
untouched = MissingPhysicsFinder(history=history, random_state=0).fit(sound).diagnosis_
diagnosed = {"worn, data sheet": by_sheet, "worn, history": since, "sound, history": untouched}
for words, found in diagnosed.items():
    print(f"{words:<20}{found.verdict:<13}{', '.join(map(' or '.join, found.effects))}")

# %%
# Then and now
# ------------
# A history keeps no rows. So *then* is the simulation with the calibration of the history, driven by the
# signals of the new rows. The band is where it is expected with 95 %, allowances included. Left: the
# characteristic near the seat. Right: what is left over; beyond the band the valve has changed.


def by_opening(found, values):
    """Mean of some values in bins of the recorded opening."""
    middle = 1.5 * (np.floor(np.array(found.traces["recorded"]["opening"]) / 1.5) + 0.5)
    return pd.Series(values).groupby(middle).mean()


seen, root = since.traces["recorded"], np.sqrt(since.traces["dp"] / 1e5)  # of the pressure drop [bar]
fig, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
left.plot(seen["opening"], seen["flow"] / root, ".", color="0.75", label="recorded")
left.plot(by_opening(since, since.traces["then"]["flow"] / root), "C1-", label="then")
left.plot(by_opening(since, since.traces["corrected"]["flow"] / root), "C0--", label="now")
left.set(xlim=(-1, 25), ylim=(0, 2), xlabel="opening [%]", ylabel="flow at a drop of 1 bar [m3/h]")

band = by_opening(since, 1.96 * np.array(since.traces["then_scatter"]["flow"]))
right.fill_between(band.index, -band, band, color="C1", alpha=0.3, linewidth=0, label="expected, 95 %")
for found, words, style in ((since, "worn", "C0o-"), (untouched, "sound", "ks-")):
    over = np.array(found.traces["recorded"]["flow"]) - found.traces["then"]["flow"]
    right.plot(by_opening(found, over), style, markersize=3, linewidth=0.9, label=words)
right.set(xlabel="opening [%]", ylabel="recorded minus then [m3/h]")
for ax in (left, right):
    ax.legend()

# %%
# What has changed
# ----------------

(change,) = since.content["since_history"]["changes"]
sizes = {"wear, Kv [m3/h]": change, "flow where it acts, rms [m3/h]": change["flow"]}
pd.DataFrame({k: [v["value"], *v["ci95"]] for k, v in sizes.items()}, ["size", "95 % from", "to"]).T.round(2)

# %%
# A history says nothing of where the valve has not been. The hour has been nearly everywhere, and its first
# ten minutes have not. The share of the new rows outside, by signal:

ten = ValveHistory().fit(before.slice(0, 600)).range_
for words, outside in (("hour", history.range_.outside(after)), ("ten minutes", ten.outside(after))):
    print(f"{words:<13}" + ", ".join(f"{signal} {100 * share:.0f} %" for signal, share in outside.items()))

# %%
# Its number
# ----------

(low, high), true = change["ci95"], 0.015 * before.valve.kv_rated
print(f"Wear: Kv {change['value']:.2f} m3/h, 95 % from {low:.2f} to {high:.2f}; concealed were {true:.2f}")
