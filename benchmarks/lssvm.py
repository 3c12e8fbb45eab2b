# SPDX-License-Identifier: BSD-3-Clause
"""LSSVMRegressor beside what else installs: time, memory and error, from 300 rows to a month of seconds.

    python benchmarks/lssvm.py exact          # up to 10,000 rows, interleaved with KernelRidge and dpotrf
    python benchmarks/lssvm.py large          # 20,000 and 86,400 rows, exact, each in a process of its own
    python benchmarks/lssvm.py path           # fifteen C by leaving one out, beside GridSearchCV
    python benchmarks/lssvm.py rows           # 86,400 to 2,600,000 rows on landmarks
    python benchmarks/lssvm.py predict        # 10,000 rows, and one
    python benchmarks/lssvm.py peers          # what else can be installed, where it is

Data: a control valve in the course of time, inlet and outlet pressure, opening and temperature as wandering
trajectories at one row a second, flow by the turbulent and choked equation, noise of 1 % of the flow's
deviation, features standardised.
The same gamma and C for all, held-out rows of another seed. Medians of five interleaved runs, load told.
"""

import argparse
import json
import os
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import numpy as np
from scipy.linalg.lapack import dpotrf
from scipy.signal import lfilter

C, GAMMA = 1e4, 0.25
REPEATS = 5


def wandering(rng, n, seconds):
    """A signal of mean 0 and deviation 1 that forgets within so many seconds."""
    keep = np.exp(-1.0 / seconds)
    steps = rng.standard_normal(n) * np.sqrt(1.0 - keep**2)
    steps[0] = rng.standard_normal()
    return lfilter([1.0], [1.0, -keep], steps)


def trajectory(n, seed):
    """Standardised features, flow with noise, flow without; both of deviation 1."""
    rng = np.random.default_rng(seed)
    p1 = 8e5 + 8e4 * wandering(rng, n, 300.0)
    p2 = 3e5 + 8e4 * wandering(rng, n, 200.0)
    x = np.clip(0.5 + 0.2 * wandering(rng, n, 60.0), 0.0, 1.0)
    celsius = 40.0 + 15.0 * wandering(rng, n, 2000.0)
    density = 1000.0 - 0.4 * (celsius - 20.0)
    vapour = 610.94 * np.exp(17.625 * celsius / (celsius + 243.04))
    drop = np.clip(np.minimum(p1 - p2, 0.81 * (p1 - 0.95 * vapour)), 1e3, None)
    flow = 30.0 * 40.0 ** (x - 1.0) * np.sqrt(drop / 1e5 / (density / 1000.0))
    flow = (flow - 6.0) / 4.0
    X = np.column_stack([(p1 - 8e5) / 8e4, (p2 - 3e5) / 8e4, (x - 0.5) / 0.2, (celsius - 40.0) / 15.0])
    return X, flow + 0.01 * rng.standard_normal(n), flow


def machine(**options):
    """Ours."""
    from sklvalve import LSSVMRegressor

    return LSSVMRegressor(C=C, gamma=GAMMA, random_state=0, **options)


def ridge():
    """scikit-learn's, the same without a bias."""
    from sklearn.kernel_ridge import KernelRidge

    return KernelRidge(kernel="rbf", alpha=1.0 / C, gamma=GAMMA)


def timed(work):
    """Seconds that some work takes, and what it gives."""
    began = time.perf_counter()
    made = work()
    return time.perf_counter() - began, made


def interleaved(works, repeats=REPEATS):
    """Median seconds of each of some works, taken in turns after one that does not count."""
    taken = {name: [] for name in works}
    for i in range(repeats + 1):
        for name, work in works.items():
            seconds, _ = timed(work)
            if i:
                taken[name].append(seconds)
    return {name: float(np.median(times)) for name, times in taken.items()}


def error(model, seed=99):
    """Root mean square of what a model errs on fresh rows, against the flow without noise."""
    X, _, flow = trajectory(10_000, seed)
    return float(np.sqrt(np.mean((model.predict(X) - flow) ** 2)))


def table(head, rows):
    """Print a table."""
    print(f"load {os.getloadavg()[0]:.1f}")
    print("| " + " | ".join(head) + " |\n|" + "---|" * len(head))
    for row in rows:
        print("| " + " | ".join(f"{v:.4g}" if isinstance(v, float) else str(v) for v in row) + " |")
    print()


def exact():
    """Fits of up to 10,000 rows."""
    rows = []
    for n in (300, 1000, 4000, 10_000):
        X, y, _ = trajectory(n, 0)
        gram = np.asfortranarray(
            np.exp(-GAMMA * ((X[:, None] - X) ** 2).sum(axis=2)) if n <= 4000 else np.eye(n)
        )
        gram[np.diag_indices(n)] += 1.0 / C
        works = {
            "dpotrf": lambda gram=gram: dpotrf(gram, lower=1),
            "KernelRidge": lambda X=X, y=y: ridge().fit(X, y),
            "auto": lambda X=X, y=y: machine().fit(X, y),
            "tiled": lambda X=X, y=y: machine(solver="tiled").fit(X, y),
            "pcg": lambda X=X, y=y: machine(solver="pcg").fit(X, y),
        }
        seconds = interleaved(works)
        errors = [error(model.fit(X, y)) for model in (ridge(), machine())]
        rows.append([n, *seconds.values(), *errors])
    table(["rows", "dpotrf", "KernelRidge", "auto", "tiled", "pcg", "error KernelRidge", "error"], rows)


def alone(name, *arguments):
    """A line of results of one fit in a process of its own."""
    words = [sys.executable, __file__, "one", name, *map(str, arguments)]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode:
        return {
            "failed": done.stderr.strip().splitlines()[-1] if done.stderr.strip() else f"rc {done.returncode}"
        }
    return json.loads(done.stdout.strip().splitlines()[-1])


def one(name, n, gamma, m):
    """Fit in this process; prints seconds, memory, error."""
    X, y, _ = trajectory(n, 0)
    makers = {
        "nystroem": lambda: _nystroem(gamma, m),
        "auto": lambda: machine(n_landmarks=m).set_params(gamma=gamma),
    }
    solvers = ("cholesky", "tiled", "pcg", "nystrom")
    makers |= {s: (lambda s=s: machine(solver=s, n_landmarks=m).set_params(gamma=gamma)) for s in solvers}
    before = _status("VmRSS")
    # what compiles or begins at first use is no part of a fit
    makers[name]().fit(X[:300], y[:300])
    seconds, model = timed(lambda: makers[name]().fit(X, y))
    told = {"seconds": seconds, "mb": _status("VmHWM"), "mb_over": _status("VmHWM") - before}
    told |= {"error": error(model), "residual": getattr(model, "residual_", None)}
    told |= {"solver": getattr(model, "solver_", name), "n_iter": getattr(model, "n_iter_", None)}
    print(json.dumps(told))


def _nystroem(gamma, m):
    from sklearn.kernel_approximation import Nystroem
    from sklearn.linear_model import Ridge
    from sklearn.pipeline import make_pipeline

    return make_pipeline(Nystroem(gamma=gamma, n_components=m, random_state=0), Ridge(alpha=1.0 / C))


def _status(key):
    for row in Path("/proc/self/status").read_text().splitlines():
        if row.startswith(key):
            return float(row.split()[1]) / 1024.0
    return float("nan")


def _lines(cases, repeats):
    head = [
        "fit",
        "rows",
        "gamma",
        "landmarks",
        "seconds",
        "MB",
        "MB over the data",
        "error",
        "residual",
        "steps",
    ]
    rows = []
    for name, n, gamma, m in cases:
        done = [alone(name, n, gamma, m) for _ in range(repeats)]
        if "failed" in done[0]:
            rows.append([name, n, gamma, m, done[0]["failed"], *[""] * 5])
            continue
        seconds = float(np.median([d["seconds"] for d in done]))
        last = done[-1]
        rows.append(
            [
                last["solver"],
                n,
                gamma,
                m,
                seconds,
                last["mb"],
                last["mb_over"],
                last["error"],
                last["residual"] or "",
                last["n_iter"] or "",
            ]
        )
    table(head, rows)


def large(repeats):
    """Exact fits of more rows than LAPACK takes."""
    _lines(
        [("auto", 20_000, GAMMA, 0 + 1000), ("auto", 20_000, 8.0, 1000), ("auto", 86_400, GAMMA, 1000)],
        repeats,
    )


def rows(repeats):
    """As many rows as there are, on landmarks."""
    cases = [
        ("nystroem", 86_400, GAMMA, 1000),
        ("nystrom", 86_400, GAMMA, 1000),
        ("nystrom", 86_400, GAMMA, 2000),
    ]
    cases += [
        ("pcg", 20_000, GAMMA, 1000),
        ("nystrom", 1_000_000, GAMMA, 1000),
        ("nystrom", 2_600_000, GAMMA, 1000),
    ]
    _lines(cases, repeats)


def path():
    """Fifteen values of C."""
    from sklearn.kernel_ridge import KernelRidge
    from sklearn.model_selection import GridSearchCV

    from sklvalve import LSSVMRegressorCV

    found, Cs = [], np.logspace(-1.0, 6.0, 15)
    for n in (400, 1000, 4000):
        X, y, _ = trajectory(n, 0)
        grid = GridSearchCV(KernelRidge(kernel="rbf", gamma=GAMMA), {"alpha": 1.0 / Cs}, cv=5)
        works = {
            "GridSearchCV": lambda X=X, y=y, grid=grid: grid.fit(X, y),
            "ours": lambda X=X, y=y: LSSVMRegressorCV(Cs=Cs, gammas=[GAMMA], random_state=0).fit(X, y),
        }
        seconds = interleaved(works, REPEATS if n <= 1000 else 2)
        own = LSSVMRegressorCV(Cs=Cs, gammas=[GAMMA], random_state=0).fit(X, y)
        chosen = 1.0 / grid.best_params_["alpha"]
        ratio = seconds["GridSearchCV"] / seconds["ours"]
        found.append([n, *seconds.values(), ratio, chosen, own.best_C_, error(grid), error(own)])
    table(["rows", "GridSearchCV", "ours", "times", "its C", "our C", "its error", "our error"], found)


def predict():
    """Predictions of 10,000 rows and of one."""
    from sklearn.utils.validation import validate_data

    found, new = [], trajectory(10_000, 5)[0]
    for n in (1000, 4000, 10_000):
        X, y, _ = trajectory(n, 0)
        theirs, ours = ridge().fit(X, y), machine().fit(X, y)
        many = interleaved({"their": lambda m=theirs: m.predict(new), "our": lambda m=ours: m.predict(new)})

        def hundred(work):
            return lambda: [work(new[i : i + 1]) for i in range(100)]

        single = interleaved(
            {
                "their": hundred(theirs.predict),
                "our": hundred(ours.predict),
                "validation": hundred(
                    lambda row, m=ours: validate_data(m, row, dtype=np.float64, reset=False)
                ),
            }
        )
        found.append([n, *many.values(), many["their"] / many["our"], *(1e4 * s for s in single.values())])
    table(
        [
            "rows of the fit",
            "KernelRidge, 10,000",
            "ours",
            "times",
            "one row [us]",
            "ours [us]",
            "validation [us]",
        ],
        found,
    )


def peers():
    """What else can be installed, each tried and told by its name where it is not."""
    from sklearn.ensemble import HistGradientBoostingRegressor
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import RBF, WhiteKernel
    from sklearn.svm import SVR

    wide = RBF((2.0 * GAMMA) ** -0.5, "fixed") + WhiteKernel(1.0 / C, "fixed")
    makers = {
        "LSSVMRegressor": machine,
        "KernelRidge": ridge,
        "GaussianProcessRegressor": lambda: GaussianProcessRegressor(wide, optimizer=None),
        "SVR": lambda: SVR(C=10.0, gamma=GAMMA, epsilon=0.01),
        "HistGradientBoosting": lambda: HistGradientBoostingRegressor(max_iter=500),
        "neo-ls-svm": lambda: _from("neo_ls_svm", "NeoLSSVM")(),
        "lssvr": lambda: _from("lssvr", "LSSVR")(C=C, kernel="rbf", gamma=GAMMA),
    }
    found = []
    for n in (1000, 4000):
        X, y, _ = trajectory(n, 0)
        for name, make in makers.items():
            try:
                work = partial(make().fit, X, y)
                seconds = float(np.median([timed(work)[0] for _ in range(3)]))
                found.append([name, n, seconds, error(make().fit(X, y))])
            except Exception as problem:
                # a peer that does not install or breaks is told as such
                found.append([name, n, f"{type(problem).__name__}: {problem}"[:60], ""])
    table(["model", "rows", "seconds", "error"], found)


def _from(module, name):
    return getattr(__import__(module), name)


def main():
    """Run one of the parts."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("part", choices=["exact", "large", "path", "rows", "predict", "peers", "one"])
    parser.add_argument("case", nargs="*", help="of one: fit, rows, gamma, landmarks")
    parser.add_argument("--repeats", type=int, default=3)
    options = parser.parse_args()
    if options.part == "one":
        name, n, gamma, m = options.case
        one(name, int(n), float(gamma), int(m))
    elif options.part in ("large", "rows"):
        globals()[options.part](options.repeats)
    else:
        globals()[options.part]()


if __name__ == "__main__":
    main()
