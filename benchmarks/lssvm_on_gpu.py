# SPDX-License-Identifier: BSD-3-Clause
"""The LS-SVM on a GPU, by torch, beside numpy arrays on the same machine.

    SCIPY_ARRAY_API=1 python -m benchmarks.lssvm_on_gpu [ROWS ...]

Rows are those of `lssvm_tools.trajectory`. Each fit is exact and in double; times are medians of three after
one that does not count, with the arrays where they are used. The last column is the largest difference of a
prediction from numpy's, in standard deviations of the value. numpy is asked up to the rows its BLAS bears.
"""

import sys

import numpy as np
from sklearn import config_context

from benchmarks.lssvm_tools import GAMMA, C, interleaved, machine, table, trajectory

_ROWS = (1000, 4000, 10_000, 20_000, 40_000, 80_000)
_MOST_OF_NUMPY = 10_000
_HEAD = (
    "rows", "fit [s]", "predict 5,000 [s]", "memory [GiB]", "numpy: fit [s]", "predict [s]", "residual",
    "error", "differs",
)  # fmt: skip


def on_gpu(torch, rows):
    """A row of the table."""
    (X, y, _), (X_new, _, true) = trajectory(rows, 0), trajectory(5000, 1)
    X_there, y_there, new_there = (torch.asarray(column, device="cuda") for column in (X, y, X_new))
    torch.cuda.reset_peak_memory_stats()
    fitted = machine(solver="cholesky").fit(X_there, y_there)
    memory = torch.cuda.max_memory_allocated() / 2**30
    predicted = fitted.predict(new_there).cpu().numpy()
    works = {
        "fit": lambda: _settled(torch, lambda: machine(solver="cholesky").fit(X_there, y_there).residual_),
        "predict": lambda: _settled(torch, lambda: fitted.predict(new_there)),
    }
    differs = ""
    if rows <= _MOST_OF_NUMPY:
        beside = machine(solver="cholesky").fit(X, y)
        works["numpy's fit"] = lambda: machine(solver="cholesky").fit(X, y)
        works["numpy's predict"] = lambda: beside.predict(X_new)
        differs = f"{np.abs(beside.predict(X_new) - predicted).max():.1e}"
    seconds = interleaved(works, 3)
    error = float(np.sqrt(np.mean((predicted - true) ** 2)))
    numpys = [seconds.get("numpy's fit", ""), seconds.get("numpy's predict", "")]
    return [rows, seconds["fit"], seconds["predict"], memory, *numpys, fitted.residual_, error, differs]


def _settled(torch, work):
    """What some work gives, once the GPU has done it."""
    made = work()
    torch.cuda.synchronize()
    return made


def main(rows):
    """Print the table."""
    import torch

    if not torch.cuda.is_available():
        sys.exit("torch sees no GPU here; run this on a machine that has one.")
    print(f"{torch.cuda.get_device_name()}; C = {C:g}, gamma = {GAMMA:g}")
    with config_context(array_api_dispatch=True):
        table(_HEAD, [on_gpu(torch, n) for n in rows])


if __name__ == "__main__":
    main([int(word) for word in sys.argv[1:]] or _ROWS)
