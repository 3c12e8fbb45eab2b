# SPDX-License-Identifier: BSD-3-Clause
"""How far apart explanations of a record are, by the plant that made it, with no part of what is tested."""

from benchmarks.concealed.distances.between import between
from benchmarks.concealed.distances.detectable import Detectable, detectable
from benchmarks.concealed.distances.scene import Scene

__all__ = ["Detectable", "Scene", "between", "detectable"]
