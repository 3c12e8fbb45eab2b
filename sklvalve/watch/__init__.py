# SPDX-License-Identifier: BSD-3-Clause
"""Many valves, day after day: each day is held against the valve's own history.

The data's way: `plant` says which valves there are and where their rows are; `days` finds the rows of a day;
`score` holds a day against the history, in a few numbers; `evidence` tells from these when a valve has
changed.
"""
