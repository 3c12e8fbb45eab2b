# SPDX-License-Identifier: BSD-3-Clause
"""Effects put by physics into real healthy recordings: real noise, real excitation, a known effect.

    python -m benchmarks.concealed.inject FOLDER DATA --seed 7
    python -m benchmarks.concealed.inject.judge FOLDER

DATA holds the folders watersafe, damadics and refinery_loops. A record is the recording plus what a simple
model, fitted to the healthy stretch, changes by when an effect is put into it; without an effect it is the
recording itself. In the refinery's loops the controller answers. Nothing here shares code with
`sklvalve.simulation` or `sklvalve.mismatch`.

What to know of it:

- Watersafe's valves are slow and have play, so that the untouched stretch has names already and only new ones
  count. Nobody published their sheets: capacity, curve and outlet level in a record's valve.toml are those
  that the valve's other stretch taught.
- The stretches are few, so that records in the same stretch are not independent of each other.
- In watersafe and in the boiler's hour no controller answers an effect; in the refinery's loops it does.
- Sizes are 1, 2 or 3 times the one whose distance from no effect is 25 under the real noise, whose change is
  half a percent of flow or travel, and which lies outside of what a sheet leaves open (`noise`).
- What the model of a stretch gets wrong stays where it was when an effect moves an edge in time.
"""

from benchmarks.concealed.inject.make import make

__all__ = ["make"]
