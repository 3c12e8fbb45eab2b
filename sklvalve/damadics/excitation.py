# SPDX-License-Identifier: BSD-3-Clause
"""What drives the actuator: command, pressures, temperature and supply in the course of time."""

from dataclasses import dataclass

import numpy as np

#: Signals that drive the actuator, with their units.
DRIVERS = {"CV": "1", "P1": "Pa", "P2": "Pa", "T1": "degC", "Pz": "Pa"}


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
        If one that has no default is missing.
    """
    given = {"Pz": supply} | excitation(t)
    if missing := [name for name in DRIVERS if name not in given]:
        raise ValueError(f"The excitation must give {', '.join(DRIVERS)}; there is no {', '.join(missing)}.")
    return np.column_stack([np.broadcast_to(np.asarray(given[name], float), t.shape) for name in DRIVERS])
