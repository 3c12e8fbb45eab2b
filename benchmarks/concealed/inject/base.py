# SPDX-License-Identifier: BSD-3-Clause
"""A healthy stretch of a real recording, and a simple model of it whose residual is the real noise.

A record is the model with an effect, plus what the recording holds beyond the model without one. Without an
effect it is the recording itself, to the last digit.
"""

from dataclasses import dataclass, field

import numpy as np

from benchmarks.concealed.inject.passage import Fluid, Trim, flow
from benchmarks.concealed.inject.stem import stem


@dataclass(frozen=True, eq=False)
class Base:
    """A stretch of a recording, with the model fitted to it.

    Attributes
    ----------
    name, source : str
        Which stretch; "watersafe" or "damadics".
    rows : int
        Rows to diagnose; those behind are the later ones.
    dt : float
        Seconds a row.
    command, opening, recorded_flow : ndarray of shape (n_rows,)
        Recorded, in fractions and m3/h; `opening` is None where nobody recorded it.
    fluid : Fluid
    trim : Trim
    sound : dict of float
        What the healthy valve is like, in the words of `stem` and `flow`.
    zero, gain : float
        Opening = zero + gain * stem.
    sheet : dict
        What a valve.toml says.
    columns : dict of ndarrays
        Columns of the recording that no effect changes, as they are written.
    digits : dict
        Steps in which X [%] and F [m3/h] were recorded.
    """

    name: str
    source: str
    rows: int
    dt: float
    command: np.ndarray
    opening: np.ndarray | None
    recorded_flow: np.ndarray
    fluid: Fluid
    trim: Trim
    sound: dict
    zero: float = 0.0
    gain: float = 1.0
    sheet: dict = field(default_factory=dict)
    columns: dict = field(default_factory=dict)
    digits: dict = field(default_factory=dict)

    def now(self, change=None):
        """The sound values, a value a row, with those of `change` added or put in their place."""
        rows = len(self.command)
        out = {name: np.full(rows, value) for name, value in self.sound.items()}
        for name, (how, values) in (change or {}).items():
            values = np.broadcast_to(values, (rows,))
            if how == "more":
                out[name] = out.get(name, np.zeros(rows)) + values
            else:
                # where an effect does not act yet, NaN leaves the sound value
                sound = out.get(name, np.full(rows, NEUTRAL.get(name, 0.0)))
                out[name] = np.where(np.isnan(values), sound, values)
        return out

    def stem(self, change=None):
        """Opening of the stem that the model gives, before any sensor."""
        return self.zero + self.gain * stem(self.command, self.now(change))

    def sensor(self, change=None):
        """What the position sensor reads above the stem."""
        return self.now(change).get("sensor_bias", np.zeros(len(self.command)))

    def passage(self, stem_opening, change=None):
        """Flow [m3/h] that the model gives for a stem's opening."""
        return flow(stem_opening, self.trim, self.fluid, self.now(change))

    def rests(self):
        """What the recording holds beyond the model: of the opening (None without one) and of the flow."""
        modelled = self.stem()
        if self.opening is None:
            return None, self.recorded_flow - self.passage(modelled)
        return self.opening - modelled, self.recorded_flow - self.passage(self.opening)

    def with_effect(self, change=None):
        """Signals with an effect: opening as recorded, flow as recorded, and both without noise."""
        of_opening, of_flow = self.rests()
        stem_opening = self.stem(change)
        seen = None
        # what the model of the stem leaves over is motion of the stem, so that the plug makes it too
        if of_opening is not None:
            stem_opening = stem_opening + of_opening
            seen = stem_opening + self.sensor(change)
        made = self.passage(stem_opening, change)
        return seen, np.maximum(made + of_flow, np.minimum(self.recorded_flow, 0.0)), stem_opening, made

    def unexplained(self, seen, recorded_flow, change=None):
        """Rests of given signals under an explanation: of the opening (None without one) and of the flow."""
        if seen is None:
            return None, recorded_flow - self.passage(self.stem(change), change)
        plug_side = seen - self.sensor(change)
        return plug_side - self.stem(change), recorded_flow - self.passage(plug_side, change)


NEUTRAL = {"opening_speed": np.inf, "closing_speed": np.inf, "cap": np.inf, "fl": 1.0}
