# SPDX-License-Identifier: BSD-3-Clause
"""
A choking valve: the paper's orifice and IEC 60534
==================================================

For the engineer who sizes with the standard and reads a paper with an orifice in it. Both are one equation
with other letters, as long as the liquid does not choke; then only one of them knows.
"""

# %%
# One opening, a falling outlet pressure
# --------------------------------------
# Water of 80 degC, 6 bar before the valve. The orifice of the paper knows an area, a density and the
# pressure in the vena contracta; told by recovery alone that pressure falls for ever. The standard holds it
# at the pressure at which the liquid boils.

import matplotlib.pyplot as plt
import numpy as np
from sklearn.linear_model import LinearRegression
from sklearn.model_selection import GridSearchCV, KFold
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler

from sklvalve import (
    LSSVMRegressor,
    ParallelHybridRegressor,
    Recording,
    SeriesHybridRegressor,
    Valve,
    ValveMechanismTransformer,
)
from sklvalve.datasets import make_valve_recording
from sklvalve.mechanism import (
    area_from_kv,
    liquid_flow,
    orifice_flow,
    vena_contracta_pressure,
    water_density,
    water_vapour_pressure,
)
from sklvalve.metrics import neg_rmse_scorer, rmse

kelvin, p1, p2 = 353.15, 6e5, np.linspace(0.8e5, 6e5, 200)
density, p_vapour = water_density(kelvin), water_vapour_pressure(kelvin)
kv, fl = 20.0, 0.85
p_vc = vena_contracta_pressure(p1, p2, fl, warn=False)
by_orifice = orifice_flow(area_from_kv(kv, fl), p1, p_vc, density)
by_standard = liquid_flow(kv, p1, p2, density, fl=fl, p_vapour=p_vapour)

fig, ax = plt.subplots(figsize=(6, 2.8), layout="constrained")
ax.plot((p1 - p2) / 1e5, 3600.0 * by_orifice, label="orifice, recovery alone")
ax.plot((p1 - p2) / 1e5, 3600.0 * by_standard, "--", label="IEC 60534-2-1")
ax.set(xlabel="pressure drop [bar]", ylabel="flow [m3/h]")
ax.legend()

# %%
# A recording of a valve that chokes
# ----------------------------------
# Its F_L is lower than its data sheet says. The trim is learnt inside the equation, once without choking
# (the paper's equation 16), once with the F_L of the sheet, and once with the F_L that blocks left out of
# the training ask for. By the sheet nothing would choke here: that is the error of the orifice.

made = make_valve_recording("choked_flow", 0.3, n_samples=1500, n_later=600, loop="wide", random_state=0)
valve = Valve.from_dict(made.valve)
columns = ("opening", "p1", "p2", "temperature")
earlier, later = (Recording.from_frame(frame, valve) for frame in (made.frame, made.later))
X, X_later = (np.column_stack([recording[role] for role in columns]) for recording in (earlier, later))
train, test = np.flatnonzero(X[:, 0] > 0.1)[::3], X_later[:, 0] > 0.1

trim = ParallelHybridRegressor(LinearRegression(), make_pipeline(StandardScaler(), LSSVMRegressor(C=10.0)))
hybrid = SeriesHybridRegressor(
    ValveMechanismTransformer(temperature=3), trim, link="log", regressor_columns=[0]
)
tried = {
    "orifice": [None],
    "F_L of the sheet": [valve.fl],
    "F_L of the data": list(np.round(np.arange(0.5, 0.96, 0.05), 2)),
}
errors, flows = {}, {}
for name, values in tried.items():
    search = GridSearchCV(hybrid, {"mechanism__fl": values}, scoring=neg_rmse_scorer, cv=KFold(3))
    search.fit(X[train], earlier["flow"][train])
    flows[name] = 3600.0 * search.predict(X_later)
    errors[name] = rmse(made.later["F"][test], flows[name][test])
    print(f"{name:17} {search.best_params_['mechanism__fl']}: {errors[name]:.2f} m3/h")

fig, ax = plt.subplots(figsize=(6, 2.8), layout="constrained")
for name, flow in flows.items():
    ax.plot(made.later["F"][test], (flow - made.later["F"])[test], ".", markersize=2, label=name)
ax.set(xlabel="recorded flow [m3/h]", ylabel="error [m3/h]")
ax.legend()

# %%
# Its number
# ----------

print(
    "Error of the flow on later rows: "
    + ", ".join(f"{error:.2f} m3/h {name}" for name, error in errors.items())
)
