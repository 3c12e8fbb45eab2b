# SPDX-License-Identifier: BSD-3-Clause
"""
LS-SVM or kernel ridge regression
=================================

For the data scientist who has KernelRidge in a pipeline. An LS-SVM solves the same system with a bias that
costs nothing, drops in where KernelRidge stands, and knows its errors on rows left out in closed form: a
whole path of C for little more than one fit.
"""

# %%
# Flow of a sound valve from opening and pressures
# ------------------------------------------------

from time import perf_counter

import matplotlib.pyplot as plt
import numpy as np
from sklearn.compose import TransformedTargetRegressor
from sklearn.kernel_ridge import KernelRidge
from sklearn.model_selection import GridSearchCV, TimeSeriesSplit
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler

from sklvalve import LSSVMRegressor, LSSVMRegressorCV
from sklvalve.datasets import make_valve_recording
from sklvalve.metrics import neg_rmse_scorer, rmse

made = make_valve_recording(None, n_samples=1200, n_later=600, loop="wide", random_state=5)
X, y = made.frame[["X", "P1", "P2"]], made.frame["F"]
X_later, y_later = made.later[X.columns], made.later["F"]

# %%
# The same search for both
# ------------------------
# Blocks in order of time, with a gap: neighbouring rows of a recording resemble each other. KernelRidge has
# no bias and falls back to zero where it has seen nothing, so it gets a second chance with its target
# centred.

Cs, gammas = np.logspace(1, 5, 5), [0.01, 0.05, 0.2]
cv = TimeSeriesSplit(3, gap=60)
searches = {
    "KernelRidge": GridSearchCV(
        make_pipeline(StandardScaler(), KernelRidge(kernel="rbf")),
        {"kernelridge__alpha": 1.0 / Cs, "kernelridge__gamma": gammas},
        scoring=neg_rmse_scorer,
        cv=cv,
    ),
    "KernelRidge, centred": GridSearchCV(
        TransformedTargetRegressor(
            make_pipeline(StandardScaler(), KernelRidge(kernel="rbf")), transformer=StandardScaler()
        ),
        {"regressor__kernelridge__alpha": 1.0 / Cs, "regressor__kernelridge__gamma": gammas},
        scoring=neg_rmse_scorer,
        cv=cv,
    ),
    "LSSVMRegressor": GridSearchCV(
        make_pipeline(StandardScaler(), LSSVMRegressor()),
        {"lssvmregressor__C": Cs, "lssvmregressor__gamma": gammas},
        scoring=neg_rmse_scorer,
        cv=cv,
    ),
    "LSSVMRegressorCV": make_pipeline(
        StandardScaler(), LSSVMRegressorCV(Cs=Cs, gammas=gammas, cv=5, gap=60, random_state=0)
    ),
}
errors = {}
for name, search in searches.items():
    began = perf_counter()
    search.fit(X, y)
    errors[name] = rmse(y_later, search.predict(X_later))
    print(f"{name:20} {perf_counter() - began:5.2f} s, error on later rows {errors[name]:.3f} m3/h")

# %%
# The prediction, and how sure it is where little was recorded
# ------------------------------------------------------------

sure = make_pipeline(
    StandardScaler(),
    LSSVMRegressor(
        **{p: getattr(searches["LSSVMRegressorCV"][-1], f"best_{p}_") for p in ("C", "gamma")},
        uncertainty=True,
    ),
).fit(X, y)
mean, std = sure.predict(X_later, return_std=True)
time = made.later["time"]
fig, ax = plt.subplots(figsize=(7, 2.8), layout="constrained")
ax.plot(time, y_later, ".", markersize=3, label="recorded")
ax.plot(time, mean, linewidth=1, label="predicted")
ax.fill_between(time, mean - 2 * std, mean + 2 * std, alpha=0.3, label="two standard deviations")
ax.set(xlabel="time [s]", ylabel="flow [m3/h]")
ax.legend(ncols=3)

# %%
# Its number
# ----------

print(
    "Error of the flow on 600 later rows: "
    + ", ".join(f"{error:.3f} m3/h by {name}" for name, error in errors.items())
)
