# SPDX-License-Identifier: BSD-3-Clause
"""LSSVMRegressor beside what else installs: time, memory and error, from 300 rows to a month of seconds.

    python benchmarks/lssvm.py exact          # up to 10,000 rows, interleaved with KernelRidge and dpotrf
    python benchmarks/lssvm.py real           # a set that scikit-learn ships, C and gamma chosen by each
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
import subprocess
import sys
from pathlib import Path

import numpy as np
from scipy.linalg.lapack import dpotrf

sys.path.insert(0, str(Path(__file__).parents[1]))
from benchmarks.lssvm_peers import peers, real
from benchmarks.lssvm_tools import (
    GAMMA,
    REPEATS,
    C,
    error,
    interleaved,
    machine,
    ridge,
    table,
    timed,
    trajectory,
)


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
        [("auto", 20_000, GAMMA, 1000), ("auto", 20_000, 8.0, 1000), ("auto", 86_400, GAMMA, 1000)],
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


def main():
    """Run one of the parts."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parts = ["exact", "real", "large", "path", "rows", "predict", "peers", "one"]
    parser.add_argument("part", choices=parts)
    parser.add_argument("case", nargs="*", help="of one: fit, rows, gamma, landmarks")
    parser.add_argument("--repeats", type=int, default=3)
    options = parser.parse_args()
    if options.part == "one":
        name, n, gamma, m = options.case
        one(name, int(n), float(gamma), int(m))
    elif options.part in ("large", "rows"):
        {"large": large, "rows": rows}[options.part](options.repeats)
    else:
        {"exact": exact, "real": real, "path": path, "predict": predict, "peers": peers}[options.part]()


if __name__ == "__main__":
    main()
