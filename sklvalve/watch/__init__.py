# SPDX-License-Identifier: BSD-3-Clause
"""Many valves, day after day: each day is held against the valve's own history.

The data's way: `plant` says which valves there are and where their rows are; `days` finds the rows of a day;
`score` holds a day against the history, in a few numbers; `record` and `store` keep them; `trend` lines the
days up, and `evidence` tells from these when a valve has changed; `valve` does all this for one valve, and
diagnoses it when it calls; `run` does it for all; `site` shows it.
"""

from sklvalve.watch.evidence import detector, limit_of
from sklvalve.watch.plant import Plant, Watched, read_plant
from sklvalve.watch.run import inspected, watch
from sklvalve.watch.site import write_site
from sklvalve.watch.valve import Watch

__all__ = [
    "Plant",
    "Watch",
    "Watched",
    "detector",
    "inspected",
    "limit_of",
    "read_plant",
    "watch",
    "write_site",
]
