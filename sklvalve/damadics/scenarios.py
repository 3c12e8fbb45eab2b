# SPDX-License-Identifier: BSD-3-Clause
"""The forty-four scenarios of the benchmark's first step, by name."""

from dataclasses import dataclass

from sklvalve.damadics.faults import FAULTS, Profile

#: When a scenario is set up, when its fault begins, and how long it goes on after it has developed [s].
SET_UP, BEGINS, GOES_ON = 300.0, 900.0, 600.0
_SIZES = {"small": 0.25, "medium": 0.5, "big": 0.75}
#: Time in which an incipient fault of a speed reaches full strength [s].
SPEEDS = {"short": 900.0, "medium": 3600.0, "long": 86400.0}
# what the benchmark counts as the time to develop [s]
_DEVELOPS = SPEEDS | {"long": 84000.0}
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


def course(fault, strength=None, profile="abrupt", begins=BEGINS):
    """Course of a fault as the benchmark's generator makes it.

    Parameters
    ----------
    fault : str
        ``"f1"`` to ``"f19"``.
    strength : float or None, default=None
        Largest, with its sign [1]. None: 0.75 where it comes at once, else 1, of the sign that it has in the
        benchmark's scenarios.
    profile : {"abrupt", "incipient", "short", "medium", "long"}, default="abrupt"
        At once; growing as fast as the benchmark has it for this fault; growing to a strength of one in 900,
        3600 or 86400 s.
    begins : float, default=900.0
        [s].

    Returns
    -------
    profile : Profile

    Raises
    ------
    ValueError
        If there is no such fault or profile, or the strength is outside the fault's range.

    Examples
    --------
    >>> from sklvalve.damadics import course
    >>> course("f19")
    Profile(fault='f19', strength=-0.75, begins=900.0, takes=0.0, ends=inf)
    """
    if fault not in FAULTS:
        raise ValueError(f"fault must be one of f1 to f19, got {fault!r}.")
    if profile == "incipient" and fault not in _INCIPIENT:
        raise ValueError(
            f"The benchmark has no incipient {fault}; give a speed instead, one of {', '.join(SPEEDS)}."
        )
    speed = _INCIPIENT[fault] if profile == "incipient" else profile
    if speed not in ("abrupt", *SPEEDS):
        raise ValueError(f"profile must be one of abrupt, incipient, {', '.join(SPEEDS)}; got {profile!r}.")
    if strength is None:
        strength = FAULTS[fault].direction * (_SIZES["big"] if speed == "abrupt" else 1.0)
    return Profile(fault, float(strength), begins, SPEEDS.get(speed, 0.0))


def _scenarios():
    for fault, known in FAULTS.items():
        for size in _ABRUPT.get(fault, ()):
            sudden = course(fault, known.direction * _SIZES[size])
            yield Scenario(f"{fault}_{size}", fault, size, sudden, BEGINS + GOES_ON)
        if fault in _INCIPIENT:
            horizon = BEGINS + _DEVELOPS[_INCIPIENT[fault]] + GOES_ON
            growing = course(fault, profile="incipient")
            yield Scenario(f"{fault}_incipient", fault, "incipient", growing, horizon)


#: The scenarios by name.
SCENARIOS = {scenario.name: scenario for scenario in _scenarios()}


def scenario_of(name):
    """A scenario by its name; a ValueError tells which there are."""
    if name not in tuple(SCENARIOS):
        raise ValueError(f"scenario must be one of {', '.join(SCENARIOS)}; got {name!r}.")
    return SCENARIOS[name]
