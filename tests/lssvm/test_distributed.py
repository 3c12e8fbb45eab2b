# SPDX-License-Identifier: BSD-3-Clause
"""Fits to parts that lie on the workers of a cluster, one of which may be lost."""

import os
import signal
import threading
import time

import numpy as np
import pytest

from sklvalve.lssvm import LSSVMRegressor

da = pytest.importorskip("dask.array", reason="needs the extra `distributed`")
distributed = pytest.importorskip("distributed", reason="needs the extra `distributed`")

# asyncio and sockets of a cluster that is being closed are no concern of these tests
pytestmark = [
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore:.*:pytest.PytestUnraisableExceptionWarning"),
]
OPTIONS = {"C": 1e3, "gamma": 0.3, "n_landmarks": 120, "tol": 1e-11, "solver": "nystrom", "random_state": 0}


def some(n=9000, seed=0):
    rng = np.random.default_rng(seed)
    X = rng.normal(size=(n, 3)) + 4.0
    y = np.sin(X.sum(axis=1)) + 0.05 * rng.normal(size=n)
    return X, y, rng.uniform(0.5, 2.0, n)


@pytest.fixture(scope="module")
def client():
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


def test_two_workers_give_the_answer_of_one_process(client):
    X, y, weight = some()
    alone = LSSVMRegressor(**OPTIONS).fit(X, y, weight)
    parts = [da.from_array(column, chunks=1700) for column in (X, y, weight)]
    found = LSSVMRegressor(**OPTIONS).fit(*parts)
    assert found.solver_ == "nystrom"
    assert found.residual_ <= 1e-9
    fresh = some(500, 1)[0]
    np.testing.assert_allclose(found.predict(fresh), alone.predict(fresh), atol=1e-8)


@pytest.mark.slow
def test_a_worker_that_is_killed_costs_time_and_not_the_answer(client):
    X, y, _ = some()
    alone = LSSVMRegressor(**OPTIONS).fit(X, y)

    def slowly(block):
        time.sleep(0.1)
        return block

    X_parts = da.from_array(X, chunks=(1000, 3)).map_blocks(slowly, dtype=float)
    first, *_ = client.run(os.getpid).values()
    begun, lost = [], threading.Event()

    def kill():
        while not begun:
            time.sleep(0.01)
        time.sleep(1.0)
        os.kill(first, signal.SIGKILL)
        lost.set()

    killer = threading.Thread(target=kill)
    killer.start()
    begun.append(True)
    found = LSSVMRegressor(**OPTIONS).fit(X_parts, da.from_array(y, chunks=1000))
    killer.join()
    assert lost.is_set()
    assert first not in client.run(os.getpid).values()
    np.testing.assert_allclose(found.predict(X[:500]), alone.predict(X[:500]), atol=1e-8)


def test_data_frames_keep_their_names(client):
    pd = pytest.importorskip("pandas")
    dd = pytest.importorskip("dask.dataframe")
    X, y, _ = some(3000)
    frame = pd.DataFrame(X, columns=["X", "P1", "P2"]).assign(F=y)
    parts = dd.from_pandas(frame, npartitions=3)
    found = LSSVMRegressor(**OPTIONS).fit(parts[["X", "P1", "P2"]], parts["F"])
    assert list(found.feature_names_in_) == ["X", "P1", "P2"]
    alone = LSSVMRegressor(**OPTIONS).fit(frame[["X", "P1", "P2"]], frame["F"])
    np.testing.assert_allclose(
        found.predict(frame[["X", "P1", "P2"]]), alone.predict(frame[["X", "P1", "P2"]]), atol=1e-8
    )


def test_without_a_cluster_threads_do_it():
    X, y, _ = some(3000)
    targets = np.column_stack([y, -2.0 * y])
    found = LSSVMRegressor(**OPTIONS).fit(
        da.from_array(X, chunks=(1000, 2)), da.from_array(targets, chunks=(1000, 1))
    )
    alone = LSSVMRegressor(**OPTIONS).fit(X, targets)
    np.testing.assert_allclose(found.predict(X[:99]), alone.predict(X[:99]), atol=1e-8)


@pytest.mark.slow
def test_what_does_not_fit_together_is_told():
    X, y, _ = some(3000)
    parts = da.from_array(X, chunks=1000)
    with pytest.raises(ValueError, match="y must be one as well"):
        LSSVMRegressor().fit(parts, y)
    with pytest.raises(ValueError, match="as many parts"):
        LSSVMRegressor().fit(parts, da.from_array(y, chunks=1500))
    with pytest.raises(ValueError, match="divide them alike"):
        LSSVMRegressor().fit(parts, da.from_array(y[:-1], chunks=1000))
    y[1500] = np.nan
    with pytest.raises(ValueError, match="must be finite"):
        LSSVMRegressor().fit(parts, da.from_array(y, chunks=1000))
    with pytest.raises(ValueError, match="uncertainty=True"):
        LSSVMRegressor(uncertainty=True).fit(parts, da.from_array(y, chunks=1000))
