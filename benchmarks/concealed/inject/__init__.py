# SPDX-License-Identifier: BSD-3-Clause
"""Effects put by physics into real healthy recordings: real noise, real excitation, a known effect.

    python -m benchmarks.concealed.inject FOLDER DATA --seed 7
    python -m benchmarks.concealed.inject.judge FOLDER

DATA holds the folders watersafe, damadics and refinery_loops. A record is the recording plus what a simple
model, fitted to the healthy stretch, changes by when an effect is put into it; without an effect it is the
recording itself. In the refinery's loops the controller answers. Nothing here shares code with
`sklvalve.simulation` or `sklvalve.mismatch`.

What to know of it: watersafe's valves are slow and one has play, so that the untouched stretch has names
already and only new ones count; the stretches are few, so that untouched records are not independent of
those with an effect in the same stretch; in watersafe and in the boiler's hour no controller answers.
"""

from benchmarks.concealed.inject.make import make

__all__ = ["make"]
