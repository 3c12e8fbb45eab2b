# SPDX-License-Identifier: BSD-3-Clause
"""The benchmark's actuator in the course of time, with faults and with the noise of its sensors."""

import numpy as np

from sklvalve.damadics import march
from sklvalve.damadics.actuator import Actuator
from sklvalve.damadics.excitation import at_steps, standard

# of the span of a signal
_SIGMA, _HUM, _HUM_HERTZ = 1.414e-3, 2.5e-3, 50.0
#: Spans of the transducers: pressures [Pa], temperature [degC], flow [t/h].
SPANS = {"P1": 4e6, "P2": 4e6, "T1": 200.0, "F": 40.0}
#: The six signals that a diagnosis may use.
SIGNALS = ("CV", "P1", "P2", "T1", "X", "F")
#: What the simulator knows beyond them, with its units.
EXTENDED = {
    "x": "m",
    "F_tph": "t/h",
    "Fvc": "N",
    "Ps": "Pa",
    "CVI": "1",
    "Ps_shown": "1",
    "Pz_shown": "1",
    "CVI_shown": "1",
}
# seconds marched at once, so that a day takes no more memory than this
_CHUNK = 60.0


class ActuatorSimulator:
    """The DAMADICS benchmark's actuator: positioner, servo-motor and valve, with its nineteen faults.

    Parameters
    ----------
    actuator : Actuator, default=None
        Its constants; None are those of the benchmark.
    noise : bool, default=True
        Of the sensors, and of the command within the positioner.
    hum : bool, default=False
        The 50 Hz that the original adds to every sensor; it is zero at whole seconds.
    sign : {"library", "help"}, default="library"
        Whether f14 and f19 multiply their signals by 1 - f, as the library does, or by 1 + f, as its help
        text has it.
    pressure_span : float, default=1e6
        Of the signals Ps and Pz as shown [Pa]; the help text has 0.6e6.

    Examples
    --------
    >>> from sklvalve.damadics import ActuatorSimulator
    >>> from sklvalve.damadics.excitation import step_test
    >>> run = ActuatorSimulator(noise=False).simulate(40.0, step_test)
    >>> run["X"][[25, 27, 30, 35]].round(2)
    array([0.5 , 0.71, 0.96, 1.  ])
    """

    def __init__(self, actuator=None, *, noise=True, hum=False, sign="library", pressure_span=1e6):
        if sign not in ("library", "help"):
            raise ValueError(f"sign must be 'library' or 'help', got {sign!r}.")
        self.actuator, self.noise, self.hum = actuator or Actuator(), noise, hum
        self.sign, self.pressure_span = sign, pressure_span

    def simulate(self, duration, excitation=standard, faults=(), *, step=1.0, random_state=None):
        """Simulate from rest.

        Parameters
        ----------
        duration : float
            [s]; the last row is the last multiple of `step` before it.
        excitation : callable, default=standard
            Of an array of times [s]; as in `sklvalve.damadics.excitation`.
        faults : sequence of Profile, default=()
        step : float, default=1.0
            Between two rows [s], a multiple of 0.0025 s.
        random_state : int, RandomState instance or None, default=None

        Returns
        -------
        run : dict of ndarray of shape (n,)
            ``t`` [s]; the six signals over their spans [1], stem X and command CV as a share of closing; what
            `EXTENDED` has; ``f1`` to ``f19``, strengths of the faults.

        Raises
        ------
        ValueError
            If times are not what they should be, or the excitation misses a signal.
        """
        every = round(step / march.STEP)
        if every < 1 or abs(every * march.STEP - step) > 1e-9:
            raise ValueError(f"step must be a multiple of {march.STEP} s, got {step!r}.")
        if not duration >= step:
            raise ValueError(f"duration must be at least one step of {step} s, got {duration!r}.")
        rng = np.random.default_rng(random_state)
        table, drivers = self._marched(round(duration / march.STEP), excitation, faults, every, rng)
        return self._shown(table, drivers, step, rng)

    def _marched(self, many, excitation, faults, every, rng):
        par, state = self.actuator.packed(), self.actuator.at_rest()
        profiles = np.array([fault.row() for fault in faults]).reshape(-1, 6)
        chunk = every * max(1, round(_CHUNK / march.STEP / every))
        tables, drivers = [], []
        for first in range(0, many, chunk):
            steps = np.arange(first, min(first + chunk, many))
            inputs = at_steps(excitation, steps * march.STEP, self.actuator.supply)
            noise = self._noise(steps * march.STEP, rng)
            out = np.empty((-(-len(steps) // every), 27))
            march.march(first, inputs, noise, state, par, profiles, every, out)
            tables.append(out)
            drivers.append(inputs[::every])
        return np.concatenate(tables), np.concatenate(drivers)

    def _noise(self, t, rng):
        noise = _SIGMA * rng.standard_normal(len(t)) if self.noise else np.zeros(len(t))
        if self.hum:
            noise += _HUM * np.sin(2.0 * np.pi * _HUM_HERTZ * t)
        return noise

    def _shown(self, table, drivers, step, rng):
        t = step * np.arange(len(table))
        x, flow, force, pressure, output = table[:, :5].T
        f = {number: table[:, 7 + number] for number in range(1, 20)}
        sign = -1.0 if self.sign == "library" else 1.0
        ideal = {
            "P1": table[:, 5] / SPANS["P1"],
            "P2": table[:, 6] / SPANS["P2"],
            "T1": table[:, 7] / SPANS["T1"],
            "X": x / self.actuator.stroke * (1.0 + 1.25 * f[13]),
            "F": flow / SPANS["F"] * (1.0 + sign * f[19]),
        }
        run = {"t": t, "CV": drivers[:, 0].copy()}
        for name, values in ideal.items():
            run[name] = np.clip(np.clip(values, 0.0, 1.0) + self._noise(t, rng), 0.0, 1.0)
        run |= {"x": x, "F_tph": flow, "Fvc": force, "Ps": pressure, "CVI": output}
        run["Ps_shown"] = np.clip(pressure / self.pressure_span, 0.0, 1.0) * (1.0 + sign * f[14])
        run["Pz_shown"] = drivers[:, 4] * (1.0 - f[16]) / self.pressure_span
        run["CVI_shown"] = 0.5 * (output + 1.0)
        return run | {f"f{number}": values for number, values in f.items()}
