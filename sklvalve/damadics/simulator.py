# SPDX-License-Identifier: BSD-3-Clause
"""The benchmark's actuator in the course of time, with faults and with the noise of its sensors."""

import numpy as np

from sklvalve.damadics import march
from sklvalve.damadics.actuator import constants_of
from sklvalve.damadics.checks import generator, number
from sklvalve.damadics.excitation import at_steps, standard
from sklvalve.damadics.faults import FAULTS, Profile
from sklvalve.damadics.loop import LevelLoop, march_loop

#: Noise of a transducer, as a share of its span [1].
SIGMA = 1.414e-3
_HUM, _HUM_HERTZ = 2.5e-3, 50.0
#: Span of the temperature transducer [degC]; those of pressures and flow belong to the actuator.
TEMPERATURE_SPAN = 200.0
#: The six signals that a diagnosis may use.
SIGNALS = ("CV", "P1", "P2", "T1", "X", "F")
#: What the simulator knows beyond them, with its units.
EXTENDED = {
    "x": "m",
    "F_tph": "t/h",
    "Fvc": "N",
    "Ps": "Pa",
    "Pz": "Pa",
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
    actuator : Actuator, {1, 2, 3} or None, default=None
        Its constants, or those of a `preset`; None are those of the benchmark, 3.
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
        self.actuator, self.noise, self.hum = constants_of(actuator), noise, hum
        self.sign, self.pressure_span = sign, number("pressure_span", pressure_span, 0.0, above=True)

    def simulate(
        self, duration, excitation=standard, faults=(), *, step=1.0, random_state=None, callback=None
    ):
        """Simulate from rest.

        Parameters
        ----------
        duration : float
            [s]; the last row is the last multiple of `step` before it.
        excitation : callable or LevelLoop, default=standard
            Of an array of times [s], as in `sklvalve.damadics.excitation`; or a loop that the valve closes.
        faults : iterable of Profile, default=()
        step : float, default=1.0
            Between two rows [s], a multiple of 0.0025 s.
        random_state : int, Generator or None, default=None
            Of the noise. It is drawn signal after signal, as long as each is: runs of one seed that differ in
            their length or in the loop differ in their sensors' noise from the first row on.
        callback : callable, default=None
            Called as ``callback(done)`` with the share done.

        Returns
        -------
        run : dict of ndarray of shape (n,)
            ``t`` [s]; the six signals over their spans [1], stem X and command CV as a share of closing; what
            `EXTENDED` has; ``f1`` to ``f19``, strengths of the faults; of a loop also ``level`` [m] and
            ``PV``, the level as measured [1].

        Raises
        ------
        ValueError
            If times are not what they should be, the excitation misses a signal or gives one that cannot be,
            or a loop does not fit the actuator.
        """
        every = round(number("step", step) / march.STEP)
        if every < 1 or abs(every * march.STEP - step) > 1e-9:
            raise ValueError(f"step must be a multiple of {march.STEP} s, got {step!r}.")
        if not number("duration", duration) >= step:
            raise ValueError(f"duration must be at least one step of {step} s, got {duration!r}.")
        if isinstance(excitation, LevelLoop):
            excitation.require_fit(self.actuator)
        faults, rng = _profiles(faults), generator(random_state)
        table = self._marched(round(duration / march.STEP), excitation, faults, every, rng, callback)
        names = (*march.COLUMNS, *(fault.fault for fault in faults), "level", "PV")
        told = dict(zip(names, table.T, strict=False))
        # of faults that are not there only what is never written, and so takes no memory
        told |= {name: np.zeros(len(table)) for name in FAULTS if name not in told}
        t = step * np.arange(len(table))
        return {"t": t} | told | self._shown(t, told, rng)

    def _marched(self, many, excitation, faults, every, rng, callback):
        """Rows of a march; a loop's have the level [m] and the measured level [1] behind."""
        par, state = self.actuator.packed(), self.actuator.at_rest()
        profiles = np.array([fault.row() for fault in faults]).reshape(-1, 6)
        loop = excitation if isinstance(excitation, LevelLoop) else None
        tank = loop.at_rest() if loop else None
        out = np.empty((-(-many // every), len(march.COLUMNS) + len(profiles) + (2 if loop else 0)))
        chunk = every * max(1, round(_CHUNK / march.STEP / every))
        for first in range(0, many, chunk):
            t = march.STEP * np.arange(first, min(first + chunk, many))
            noise, rows = self._noise(t, rng), out[first // every :]
            if loop:
                of_level = self._noise(t, rng)
                given = (loop.packed(), self.actuator.supply, par, profiles, every)
                march_loop(first, noise, of_level, state, tank, *given, rows)
            else:
                inputs = at_steps(excitation, t, self.actuator.supply)
                march.march(first, inputs, noise, state, par, profiles, every, rows)
            if callback is not None:
                callback(min(first + chunk, many) / many)
        return out

    def _noise(self, t, rng):
        noise = SIGMA * rng.standard_normal(len(t)) if self.noise else np.zeros(len(t))
        if self.hum:
            noise += _HUM * np.sin(2.0 * np.pi * _HUM_HERTZ * t)
        return noise

    def _shown(self, t, told, rng):
        """What the transducers make of what a march told."""
        sign = -1.0 if self.sign == "library" else 1.0
        ideal = {
            "P1": told["P1"] / self.actuator.pressure_range,
            "P2": told["P2"] / self.actuator.pressure_range,
            "T1": told["T1"] / TEMPERATURE_SPAN,
            "X": told["x"] / self.actuator.stroke * (1.0 + 1.25 * told["f13"]),
            "F": told["F_tph"] / self.actuator.flow_range * (1.0 + sign * told["f19"]),
        }
        shown = {
            name: np.clip(np.clip(values, 0.0, 1.0) + self._noise(t, rng), 0.0, 1.0)
            for name, values in ideal.items()
        }
        shown["CV"] = np.clip(told["CV"], 0.0, 1.0)
        pressures = {
            "Ps_shown": told["Ps"] * (1.0 + sign * told["f14"]),
            "Pz_shown": told["Pz"] * (1.0 - told["f16"]),
        }
        shown |= {name: np.clip(values / self.pressure_span, 0.0, 1.0) for name, values in pressures.items()}
        shown["CVI_shown"] = 0.5 * (told["CVI"] + 1.0)
        return shown


def _profiles(faults):
    faults = tuple(faults) if hasattr(faults, "__iter__") else (faults,)
    for fault in faults:
        if not isinstance(fault, Profile):
            raise ValueError(
                f"faults must be several Profile, as `course` or a scenario's profile is, got {fault!r}."
            )
    return faults
