# SPDX-License-Identifier: BSD-3-Clause
"""What can be measured of the table in docs/comparison.md, in one run on recordings made for it.

    python benchmarks/side_by_side.py [SEED]

Three tables: liquid flow beside `fluids`, the LS-SVM beside scikit-learn's `KernelRidge`, and a concealed
seat leakage, seen by `MissingPhysicsFinder`, by PySINDy and by two black boxes. `fluids` and `pysindy` are
left out where they are not installed. Times of the first two are medians of repeats that alternate.
"""

import os
import statistics
import sys
import time
import warnings
from importlib.metadata import PackageNotFoundError, version

import numpy as np
import pandas as pd
from sklearn.kernel_ridge import KernelRidge
from sklearn.model_selection import GridSearchCV, TimeSeriesSplit
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler

from sklvalve import LSSVMRegressor, LSSVMRegressorCV, MissingPhysicsFinder, Recording, Valve
from sklvalve.datasets import make_valve_recording
from sklvalve.mechanism import (
    liquid_kv,
    rate_liquid,
    relative_capacity,
    water_density,
    water_kinematic_viscosity,
    water_vapour_pressure,
)
from sklvalve.metrics import neg_rmse_scorer

REPEATS = 5
DUTIES, ROWS, GAMMA, C = 100_000, 2_000, 0.1, 1e3
TRAINED, LATER, LEAK = 1_800, 1_200, 0.05


def main(seed=2026):
    """Print the tables."""
    print(f"seed {seed}, load {os.getloadavg()[0]:.1f} before;", ", ".join(map(_installed, PEERS)), "\n")
    for titles, rows in (liquid(seed), regression(seed), leakage(seed)):
        print("| " + " | ".join(titles) + " |")
        print("|" + "---|" * len(titles))
        for row in rows:
            print("| " + " | ".join(_cell(value) for value in row) + " |")
        print()
    print(f"load {os.getloadavg()[0]:.1f} after")


PEERS = ("sklvalve", "fluids", "scikit-learn", "pysindy", "numpy")


def liquid(seed):
    """Sizing of 100,000 duties of water, the flow coefficients of which are known."""
    rng = np.random.default_rng(seed)
    p1 = rng.uniform(3e5, 10e5, DUTIES)
    case = {"p1": p1, "p2": p1 * rng.uniform(0.05, 0.98, DUTIES)}
    kv, kelvin = rng.uniform(1.0, 100.0, DUTIES), rng.uniform(275.0, 400.0, DUTIES)
    density, p_vapour = water_density(kelvin), water_vapour_pressure(kelvin)
    flow = rate_liquid(kv, **case, temperature=kelvin, fl=0.9, warn=False)
    ours = {"fl": 0.9, "p_vapour": p_vapour, "warn": False}
    makers = {
        "sklvalve `rate_liquid`: flow": lambda: rate_liquid(
            kv, **case, temperature=kelvin, fl=0.9, warn=False
        ),
        "sklvalve `liquid_kv`: size": lambda: liquid_kv(flow, *case.values(), density, **ours),
    }
    if _installed("fluids")[-1].isdigit():
        import fluids.vectorized

        theirs = {
            "rho": density,
            "Psat": p_vapour,
            "Pc": 22.064e6,
            "mu": water_kinematic_viscosity(kelvin) * density,
            "P1": case["p1"],
            "P2": case["p2"],
            "Q": flow,
            "FL": 0.9,
        }
        makers["fluids `size_control_valve_l`"] = lambda: fluids.vectorized.size_control_valve_l(**theirs)
    seconds, made = _timed(makers)
    known = np.isfinite(flow)
    rows = []
    for name, values in made.items():
        off = values / (flow if name.endswith("flow") else kv) - 1.0
        rows.append((name, 1e9 * seconds[name] / DUTIES, float(np.max(np.abs(off[known])))))
    return ("100,000 duties of water, choked or not", "ns a duty", "largest deviation of Kv"), rows


def regression(seed):
    """The same kernel and C on 2,000 rows, and the 2,000 between them to predict."""
    made = make_valve_recording(None, n_samples=2 * ROWS, n_later=0, loop="wide", random_state=seed)
    X, F = StandardScaler().fit_transform(made.frame[["X", "P1", "P2"]]), made.frame["F"].to_numpy()
    X, between, y = X[::2], X[1::2], F[::2] - F.mean()
    makers = {
        "`LSSVMRegressor`": lambda: LSSVMRegressor(C=C, gamma=GAMMA).fit(X, y).predict(between),
        "`KernelRidge`, target centred": lambda: (
            KernelRidge(alpha=1.0 / C, kernel="rbf", gamma=GAMMA).fit(X, y).predict(between)
        ),
    }
    seconds, predicted = _timed(makers)
    first = next(iter(predicted.values()))
    rows = [
        (name, seconds[name], _rms(F[1::2] - F.mean() - values), _rms(values - first))
        for name, values in predicted.items()
    ]
    titles = ("2,000 rows, the same kernel", "fit and predict [s]", "error [m3/h]", "from the first [m3/h]")
    return titles, rows


def leakage(seed):
    """A seat that leaks 5 % of the rated capacity: who says what, and how it predicts later rows."""
    made = make_valve_recording(
        "seat_leakage", LEAK, n_samples=TRAINED, n_later=LATER, loop="wide", random_state=seed
    )
    valve = Valve.from_dict(made.valve)
    both = pd.concat([made.frame, made.later], ignore_index=True)
    recording = Recording.from_frame(both, valve)
    sheet = _by_sheet(recording, valve)
    later = made.later["F"].to_numpy()
    rows = [("data sheet, as it stands", "nothing", _rms(later - sheet[TRAINED:]), "")]

    began = time.perf_counter()
    finder = MissingPhysicsFinder(random_state=0).fit(recording, until=TRAINED)
    told, took = finder.diagnosis_, time.perf_counter() - began
    error = told.content["fit"]["flow"]["rmse"]
    names = ", and ".join(" or ".join(each) for each in told.effects) or told.verdict
    sizes = [
        f"{k} {v['value']:.2f} {v['unit']}"
        for e in told.content["effects"]
        for k, v in e["parameters"].items()
    ]
    rows += [
        ("sklvalve, calibrated only", "nothing", error["nominal"], ""),
        ("sklvalve, `MissingPhysicsFinder`", f"{names}; {', '.join(sizes)}", error["corrected"], took),
    ]
    if _installed("pysindy")[-1].isdigit():
        for degree, name in ((1, "terms"), (2, "terms and their products")):
            rows.append((f"PySINDy, {name}", *_sparse(recording, sheet, both["F"], degree)))
    for name, model in _black_boxes().items():
        began = time.perf_counter()
        model.fit(both[["X", "P1", "P2"]][:TRAINED], both["F"][:TRAINED])
        error = _rms(later - model.predict(both[["X", "P1", "P2"]][TRAINED:]))
        rows.append((name, "nothing", error, time.perf_counter() - began))
    titles = (
        f"a leak of {LEAK * valve.kv_rated:.2f} m3/h",
        "says",
        "error, 1,200 later rows [m3/h]",
        "seconds",
    )
    return titles, rows


def _black_boxes():
    cv = TimeSeriesSplit(3, gap=60)
    grid = {"kernelridge__alpha": 1.0 / np.logspace(1, 5, 5), "kernelridge__gamma": [0.01, 0.05, 0.2]}
    ridge = make_pipeline(StandardScaler(), KernelRidge(kernel="rbf"))
    ours = LSSVMRegressorCV(cv=5, gap=60, random_state=0)
    return {
        "scikit-learn `KernelRidge`, tuned": GridSearchCV(ridge, grid, scoring=neg_rmse_scorer, cv=cv),
        "sklvalve `LSSVMRegressorCV`": make_pipeline(StandardScaler(), ours),
    }


def _by_sheet(recording, valve):
    """Flow [m3/h] by the data sheet at the recorded opening."""
    trim = relative_capacity(
        np.clip(recording["opening"], 0.0, 1.0), valve.characteristic, rangeability=valve.rangeability
    )
    case = [recording[role] for role in ("p1", "p2", "temperature")]
    return 3600.0 * rate_liquid(valve.kv_rated * trim, *case, fl=valve.fl, warn=False)


def _sparse(recording, sheet, flow, degree):
    """What sparse identification of the meter's dynamics says, its later error, and the time it took.

    The state is the recorded flow; controls are what an engineer would offer: the flow by the data sheet, the
    root of the pressure drop (a leak is a multiple of it), and both times the opening. Threshold, and whether
    time is continuous or discrete, are those with the least error of a free run over the last quarter of the
    training.
    """
    import pysindy as ps

    began = time.perf_counter()
    root = np.sqrt(np.maximum(recording["p1"] - recording["p2"], 0.0) / 1e5)
    controls = np.column_stack([sheet, root, sheet * recording["opening"], root * recording["opening"]])
    names = ["F", "F_sheet", "root_dp", "F_sheet_X", "root_dp_X"]
    size = np.array([flow[:TRAINED].std(), *controls[:TRAINED].std(axis=0)])
    F, u = (flow.to_numpy() / size[0])[:, None], controls / size[1:]

    def made(rows, threshold, discrete):
        kind = ps.DiscreteSINDy if discrete else ps.SINDy
        smooth = {} if discrete else {"differentiation_method": ps.SmoothedFiniteDifference()}
        parts = {"optimizer": ps.STLSQ(threshold=threshold, alpha=1e-3)}
        model = kind(feature_library=ps.PolynomialLibrary(degree=degree), **parts, **smooth)
        return model.fit(F[:rows], t=1.0, u=u[:rows], feature_names=names)

    def error_of(model, start, end):
        """Error of a free run from the recorded flow at `start` on, one row a step [m3/h]."""
        state, found = F[start], []
        for k in range(start, end):
            found.append(state)
            step = model.predict(state[None, :], u=u[k : k + 1])[0]
            # what runs away is stopped, so that it has an error
            state = np.clip(step if isinstance(model, ps.DiscreteSINDy) else state + step, -10.0, 10.0)
        return size[0] * _rms(F[start:end] - found)

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # of a threshold that leaves no term
        cut, tried = TRAINED - TRAINED // 4, [(t, d) for t in (0.003, 0.01, 0.03, 0.1) for d in (False, True)]
        best = min(tried, key=lambda each: error_of(made(cut, *each), cut, TRAINED))
        model = made(TRAINED, *best)
    terms = [term for term in model.equations(precision=2)[0].split(" + ") if term]
    left = "F(k+1)" if best[1] else "dF/dt"
    told = f"{left} = {' + '.join(terms[:5])}{f' and {len(terms) - 5} more' if len(terms) > 5 else ''}"
    return told, error_of(model, TRAINED, len(F)), time.perf_counter() - began


def _timed(makers):
    """Median seconds of each, repeats in turn, and what each made."""
    seconds, made = {name: [] for name in makers}, {}
    for make in makers.values():
        make()
    for _ in range(REPEATS):
        for name, make in makers.items():
            began = time.perf_counter()
            made[name] = make()
            seconds[name].append(time.perf_counter() - began)
    return {name: statistics.median(each) for name, each in seconds.items()}, made


def _rms(values):
    return float(np.sqrt(np.nanmean(np.square(values))))


def _installed(name):
    try:
        return f"{name} {version(name)}"
    except PackageNotFoundError:
        return f"{name} not installed"


def _cell(value):
    return f"{value:.3g}" if isinstance(value, float) else str(value)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
