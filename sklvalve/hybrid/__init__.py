# SPDX-License-Identifier: BSD-3-Clause
"""Physics and data joined: in series, in parallel, and one inside the other."""

from sklvalve.hybrid.parallel import ParallelHybridRegressor
from sklvalve.hybrid.series import SeriesHybridRegressor

__all__ = ["ParallelHybridRegressor", "SeriesHybridRegressor"]
