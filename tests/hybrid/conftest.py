# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest


@pytest.fixture
def recording():
    """A valve's signals as a data frame, and its flow with noise of an equal-percentage trim."""
    pd = pytest.importorskip("pandas")
    rng = np.random.default_rng(0)
    opening = rng.uniform(0.2, 1.0, 300)
    p2 = rng.uniform(1e5, 3e5, 300)
    X = pd.DataFrame({"p1": p2 + rng.uniform(1e4, 3e5, 300), "x": opening, "p2": p2})
    flow = 50 ** (opening - 1) * np.sqrt(X["p1"] - X["p2"])
    return X, flow.to_numpy() + 0.5 * rng.normal(size=300), flow.to_numpy()
