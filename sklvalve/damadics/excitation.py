# SPDX-License-Identifier: BSD-3-Clause
"""What drives the actuator: command, pressures, temperature and supply in the course of time."""

from dataclasses import dataclass

import numpy as np

#: Signals that drive the actuator, with their units.
DRIVERS = {"CV": "1", "P1": "Pa", "P2": "Pa", "T1": "degC", "Pz": "Pa"}
#: What they may be: the spans of the benchmark's transducers and a tenth more to both sides.
LIMITS = {
    "CV": (-0.1, 1.1),
    "P1": (-4e5, 4.4e6),
    "P2": (-4e5, 4.4e6),
    "T1": (-20.0, 220.0),
    "Pz": (-1e5, 1.1e6),
}
_UNITS = {
    "CV": "a share of closing, 1 where the valve is shut; divide percents by 100",
    "T1": "in degrees Celsius",
} | dict.fromkeys(("P1", "P2", "Pz"), "in pascals")


def standard(t):
    """Excitation of the benchmark's data generator.

    Parameters
    ----------
    t : ndarray of shape (n,)
        [s].

    Returns
    -------
    drivers : dict of ndarray of shape (n,) or float
        Command CV [1, closed is 1], pressures P1 and P2 [Pa], temperature T1 [degC].
    """
    return {
        "CV": 0.5 + 0.25 * np.sin(2.0 * np.pi * 0.01 * t),
        "P1": 3.5e6 + 1.75e5 * np.sin(2.0 * np.pi * 0.1 * t),
        "P2": 2.6e6 + 2.6e4 * np.sin(2.0 * t),
        "T1": 43.0,
    }


def in_range(pressure_range):
    """The standard excitation with pressures in proportion to the range of other transmitters, *proposed*.

    Parameters
    ----------
    pressure_range : float
        [Pa]; 4e6 is the benchmark's own.
    """
    share = pressure_range / 4e6

    def excitation(t):
        drivers = standard(t)
        return drivers | {"P1": share * drivers["P1"], "P2": share * drivers["P2"]}

    return excitation


def step_test(t):
    """Example I of the benchmark: the command goes from 0.5 to 1 at 25 s."""
    return {"CV": np.where(t < 25.0, 0.5, 1.0), "P1": 3.5e6, "P2": 2.6e6, "T1": 20.0}


@dataclass(frozen=True, eq=False)
class Recorded:
    """Drivers that were recorded, linear between two samples.

    Attributes
    ----------
    t : ndarray of shape (n,)
        Increasing [s].
    drivers : dict of ndarray of shape (n,) or float
        As `standard` gives them.
    """

    t: np.ndarray
    drivers: dict

    def __post_init__(self):
        if len(self.t) < 2 or not (np.diff(self.t) > 0.0).all():
            raise ValueError("t must hold two times or more, each later than the one before.")
        for name, values in self.drivers.items():
            if name not in DRIVERS:
                raise ValueError(f"drivers must be among {', '.join(DRIVERS)}; got {name!r}.")
            if not np.isfinite(values).all():
                raise ValueError(f"{name} must be finite everywhere; fill its gaps first.")
            if np.ndim(values) and len(values) != len(self.t):
                raise ValueError(
                    f"{name} must have as many values as t, got {len(values)} and {len(self.t)}."
                )

    def __call__(self, t):
        """Values at some times."""
        return {
            name: np.interp(t, self.t, values) if np.ndim(values) else values
            for name, values in self.drivers.items()
        }


def at_steps(excitation, t, supply):
    """Drivers at some times as the columns that `march.march` wants, of shape (n, 5).

    Raises
    ------
    ValueError
        If it is no function of time, one that has no default is missing, or a value is not finite or far
        outside what a transducer shows, as percents are.
    """
    made = excitation(t) if callable(excitation) else excitation
    if not isinstance(made, dict):
        raise ValueError(
            "The excitation must be a function of times that returns a dict of CV, P1, P2 and T1, or a "
            f"LevelLoop, got {excitation!r}."
        )
    given = {"Pz": supply} | made
    if missing := [name for name in DRIVERS if name not in given]:
        raise ValueError(f"The excitation must give {', '.join(DRIVERS)}; there is no {', '.join(missing)}.")
    return np.column_stack([_sound(name, given[name], t) for name in DRIVERS])


def _sound(name, values, t):
    """A driver as floats, of the shape of the times."""
    values, (low, high) = np.asarray(values, float), LIMITS[name]
    whole = np.broadcast_to(values, t.shape)
    if low <= values.min() and values.max() <= high:
        return whole
    at = np.flatnonzero(~((whole >= low) & (whole <= high)))[0]
    value, when = whole[at], t[at]
    if np.isfinite(value):
        raise ValueError(
            f"{name} must lie in [{low:g}, {high:g}], {_UNITS[name]}, got {value:g} at {when:g} s."
        )
    raise ValueError(f"{name} must be finite everywhere, got {value} at {when:g} s; fill its gaps first.")
