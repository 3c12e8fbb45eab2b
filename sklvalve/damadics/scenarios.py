# SPDX-License-Identifier: BSD-3-Clause
"""The forty-four scenarios of the benchmark's first step, by name."""

from dataclasses import dataclass

from sklvalve.damadics.faults import FAULTS, Profile

#: When a scenario is set up, when its fault begins, and how long it goes on after it has developed [s].
SET_UP, BEGINS, GOES_ON = 300.0, 900.0, 600.0
_SIZES = {"small": 0.25, "medium": 0.5, "big": 0.75}
# time to full strength, and what the benchmark counts as the time to develop [s]
_SPEEDS = {"short": (900.0, 900.0), "medium": (3600.0, 3600.0), "long": (86400.0, 84000.0)}
_ABRUPT = {
    **dict.fromkeys(("f1", "f7", "f8", "f10", "f12", "f13", "f14", "f16", "f18", "f19"), tuple(_SIZES)),
    **dict.fromkeys(("f2", "f11", "f15", "f17"), ("big",)),
}
_INCIPIENT = {
    **dict.fromkeys(("f2", "f3", "f5", "f6", "f9", "f11", "f18"), "long"),
    "f4": "medium",
    "f13": "short",
    "f17": "medium",
}


@dataclass(frozen=True)
class Scenario:
    """A fault of a size that begins after 900 s.

    Attributes
    ----------
    name : str
        ``"f13_big"``, ``"f13_incipient"``.
    fault : str
    size : {"small", "medium", "big", "incipient"}
    profile : Profile
    horizon : float
        End of the benchmark's zone [s].
    """

    name: str
    fault: str
    size: str
    profile: Profile
    horizon: float


def _scenarios():
    for fault, known in FAULTS.items():
        for size in _ABRUPT.get(fault, ()):
            profile = Profile(fault, known.direction * _SIZES[size], BEGINS)
            yield Scenario(f"{fault}_{size}", fault, size, profile, BEGINS + GOES_ON)
        if fault in _INCIPIENT:
            takes, counts = _SPEEDS[_INCIPIENT[fault]]
            profile = Profile(fault, float(known.direction), BEGINS, takes)
            yield Scenario(f"{fault}_incipient", fault, "incipient", profile, BEGINS + counts + GOES_ON)


#: The scenarios by name.
SCENARIOS = {scenario.name: scenario for scenario in _scenarios()}


def scenario_of(name):
    """A scenario by its name; a ValueError tells which there are."""
    if name not in SCENARIOS:
        raise ValueError(f"scenario must be one of {', '.join(SCENARIOS)}; got {name!r}.")
    return SCENARIOS[name]
