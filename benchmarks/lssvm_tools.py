# SPDX-License-Identifier: BSD-3-Clause
"""Data, clocks and tables of the benchmark of the LS-SVM."""

import os
import time

import numpy as np
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
    p1 = 8e5 + 8e4 * wandering(rng, n, 40.0)
    p2 = 3e5 + 8e4 * wandering(rng, n, 30.0)
    x = np.clip(0.5 + 0.2 * wandering(rng, n, 20.0), 0.0, 1.0)
    celsius = 40.0 + 15.0 * wandering(rng, n, 60.0)
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
