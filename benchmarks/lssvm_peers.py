# SPDX-License-Identifier: BSD-3-Clause
"""The LS-SVM beside other models: on a real set, and whatever else can be installed on a trajectory."""

from functools import partial

import numpy as np

from benchmarks.lssvm_tools import GAMMA, C, error, machine, ridge, table, timed, trajectory


def real():
    """The diabetes set: 442 patients, ten columns; ten splits in halves."""
    from sklearn.datasets import load_diabetes
    from sklearn.kernel_ridge import KernelRidge
    from sklearn.model_selection import GridSearchCV, train_test_split
    from sklearn.pipeline import make_pipeline
    from sklearn.preprocessing import StandardScaler

    from sklvalve import LSSVMRegressorCV

    X, y = load_diabetes(return_X_y=True)
    Cs, gammas = np.logspace(-2.0, 3.0, 11), np.array([0.001, 0.003, 0.01, 0.03, 0.1])
    grid = {"kernelridge__alpha": 1.0 / Cs, "kernelridge__gamma": gammas}
    makers = {
        "GridSearchCV(KernelRidge), 5 folds": lambda: GridSearchCV(
            make_pipeline(StandardScaler(), KernelRidge(kernel="rbf")), grid
        ),
        "LSSVMRegressorCV": lambda: make_pipeline(
            StandardScaler(), LSSVMRegressorCV(Cs=Cs, gammas=gammas, random_state=0)
        ),
    }
    found = {name: [] for name in makers}
    for seed in range(10):
        A, B, a, b = train_test_split(X, y, test_size=0.5, random_state=seed)
        for name, make in makers.items():
            seconds, model = timed(partial(make().fit, A, a))
            found[name].append((seconds, float(np.sqrt(np.mean((model.predict(B) - b) ** 2)))))
    table(
        ["model", "seconds", "error, median of ten halves"],
        [[name, *map(float, np.median(each, axis=0))] for name, each in found.items()],
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
        "LSSVMRegressorCV, all its own": lambda: _from("sklvalve", "LSSVMRegressorCV")(random_state=0),
        "KernelRidge": ridge,
        "GaussianProcessRegressor": lambda: GaussianProcessRegressor(wide, optimizer=None),
        "SVR": lambda: SVR(C=10.0, gamma=GAMMA, epsilon=0.01),
        "HistGradientBoosting": lambda: HistGradientBoostingRegressor(max_iter=500),
        "neo-ls-svm, all its own": lambda: _from("neo_ls_svm", "NeoLSSVM")(),
        "gpytorch, ExactGP": ExactProcess,
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


class ExactProcess:
    """gpytorch's exact Gaussian process, in double, with the same kernel and noise; nothing is learnt."""

    def fit(self, X, y):
        import gpytorch
        import torch

        class Model(gpytorch.models.ExactGP):
            def __init__(self, X, y, likelihood):
                super().__init__(X, y, likelihood)
                self.mean_module = gpytorch.means.ZeroMean()
                self.covar_module = gpytorch.kernels.RBFKernel()

            def forward(self, X):
                return gpytorch.distributions.MultivariateNormal(self.mean_module(X), self.covar_module(X))

        self._likelihood = gpytorch.likelihoods.GaussianLikelihood(
            noise_constraint=gpytorch.constraints.GreaterThan(1e-8)
        ).double()
        self._model = Model(torch.tensor(X), torch.tensor(y), self._likelihood).double()
        self._model.covar_module.lengthscale = (2.0 * GAMMA) ** -0.5
        self._likelihood.noise = 1.0 / C
        self._model.eval()
        # what a prediction needs is made at the first one
        self.predict(X[:1])
        return self

    def predict(self, X):
        import gpytorch
        import torch

        with (
            torch.no_grad(),
            gpytorch.settings.fast_pred_var(False),
            gpytorch.settings.skip_posterior_variances(),
        ):
            return self._model(torch.tensor(X)).mean.numpy()


def _from(module, name):
    return getattr(__import__(module), name)
