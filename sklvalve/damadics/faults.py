# SPDX-License-Identifier: BSD-3-Clause
"""The nineteen faults of the benchmark: what they are called, what they do, and how strong they are when."""

from dataclasses import dataclass
from numbers import Real

import numpy as np

from sklvalve.damadics.checks import number


@dataclass(frozen=True)
class Fault:
    """A fault of the benchmark.

    Attributes
    ----------
    number : int
        1 to 19.
    title : str
        As the benchmark calls it, which is not always what it does.
    does : str
        What it does in the simulator.
    group : {"valve", "servo-motor", "positioner", "external"}
    signed : bool
        Whether its strength lies in [-1, 1], and not in [0, 1].
    direction : int
        Sign of its strength in the scenarios.
    """

    number: int
    title: str
    does: str
    group: str
    signed: bool = False
    direction: int = 1

    @property
    def name(self):
        """``"f7"`` for the seventh."""
        return f"f{self.number}"


#: The faults by name.
FAULTS = {
    fault.name: fault
    for fault in (
        Fault(1, "valve clogging", "an end stop keeps the valve from closing", "valve"),
        Fault(2, "plug or seat sedimentation", "less stroke, less opening and less capacity", "valve"),
        Fault(3, "plug or seat erosion", "more stroke, more opening and more capacity", "valve"),
        Fault(
            4, "increased friction of bushings", "more play between diaphragm and stem", "valve", signed=True
        ),
        Fault(5, "external leakage", "up to 5 % of the flow is lost", "valve"),
        Fault(6, "internal leakage", "a flow past the closed plug", "valve"),
        Fault(7, "medium evaporation or critical flow", "the medium is 200 to 300 degC hotter", "valve"),
        Fault(8, "twisted stem", "more play, up to half, towards the open end", "servo-motor"),
        Fault(9, "leaking housing of the servo-motor", "air leaks from the chamber", "servo-motor"),
        Fault(10, "perforated diaphragm", "air leaks, and less area moves the stem", "servo-motor"),
        Fault(11, "spring fault", "a softer spring", "servo-motor"),
        Fault(12, "electro-pneumatic transducer fault", "another gain of the relay", "positioner", True, -1),
        Fault(
            13,
            "stem position sensor fault",
            "another gain of the sensor, in the loop too",
            "positioner",
            True,
        ),
        Fault(
            14,
            "pressure sensor fault",
            "another gain of a pressure that is only shown",
            "positioner",
            True,
            -1,
        ),
        Fault(15, "positioner feedback fault", "play in the feedback", "positioner"),
        Fault(16, "positioner supply pressure drop", "less supply; below 120 kPa none", "external"),
        Fault(
            17, "unexpected pressure change", "less outlet pressure, or less inlet pressure", "external", True
        ),
        Fault(18, "open bypass", "a flow past the valve", "external"),
        Fault(19, "flow sensor fault", "another gain of the flow sensor", "external", True, -1),
    )
}

#: Faults of what flows, which the transmitters of pressure and temperature see.
OF_THE_MEDIUM = ("f7", "f17")


@dataclass(frozen=True)
class Profile:
    """Strength of a fault in the course of time.

    Attributes
    ----------
    fault : str
        ``"f1"`` to ``"f19"``.
    strength : float
        Largest, with its sign [1].
    begins : float
        [s].
    takes : float
        Time in which a strength of one would be reached [s]; zero is at once.
    ends : float
        After which it is gone [s].

    Raises
    ------
    ValueError
        If there is no such fault, its strength is outside its range, or its times are none that can be.
    """

    fault: str
    strength: float
    begins: float = 0.0
    takes: float = 0.0
    ends: float = np.inf

    def __post_init__(self):
        if self.fault not in FAULTS:
            raise ValueError(f"fault must be one of f1 to f19, got {self.fault!r}.")
        number(
            f"The strength of {self.fault}", self.strength, -1.0 if FAULTS[self.fault].signed else 0.0, 1.0
        )
        told = all(isinstance(time, Real) for time in (self.begins, self.takes, self.ends))
        if not (told and self.begins >= 0.0 and 0.0 <= self.takes < np.inf and self.ends > self.begins):
            raise ValueError(
                f"{self.fault} must begin at 0 or later, take no negative time, and end after it begins; got "
                f"begins={self.begins!r}, takes={self.takes!r}, ends={self.ends!r}."
            )

    def row(self):
        """As `march.strengths` wants it."""
        slope = 1.0 / self.takes if self.takes > 0.0 else 1e12
        place, size = FAULTS[self.fault].number, abs(self.strength)
        # at once means at once, also at the very first step
        begins = self.begins if self.takes > 0.0 else self.begins - 1e-9
        return [place, begins, self.ends, slope, size, float(np.sign(self.strength))]
