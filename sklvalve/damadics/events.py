# SPDX-License-Identifier: BSD-3-Clause
"""The nineteen faults that were put into the running actuators of the Lublin sugar factory."""

from dataclasses import dataclass

import numpy as np

from sklvalve.damadics.days import iso_day


@dataclass(frozen=True)
class LublinEvent:
    """A fault of a real actuator.

    Attributes
    ----------
    item : int
        Its number in the list of the benchmark.
    actuator : {1, 2, 3}
    day : str
        In ISO 8601.
    fault : str
        ``"f16"`` (supply pressure drop of the positioner), ``"f17"`` (pressure change across the valve),
        ``"f18"`` (open bypass) or ``"f19"`` (flow sensor).
    begins, ends : float
        Seconds from midnight, as `read_lublin` has them [s]; the end of item 13 is not given, and
        infinite here.

    Examples
    --------
    >>> from sklvalve.damadics import LUBLIN_EVENTS
    >>> LUBLIN_EVENTS[0]
    LublinEvent(item=1, actuator=1, day='2001-10-30', fault='f18', begins=58800.0, ends=59800.0)
    """

    item: int
    actuator: int
    day: str
    fault: str
    begins: float
    ends: float


#: The faults in the order of the benchmark's list, in which item 4 comes before item 3 in time. It is taken
#: from transcriptions of the description of the data that agree with each other. While f19 is there, the flow
#: in the files of actuator 2 is that without the fault, which was put into the control loop only. Several
#: users of item 13 doubt what follows after about 45000 s. That there is no fault at other times is not said.
LUBLIN_EVENTS = tuple(
    LublinEvent(item, actuator, day, fault, float(begins), float(ends))
    for item, (actuator, day, fault, begins, ends) in enumerate(
        (
            (1, "2001-10-30", "f18", 58800, 59800),
            (1, "2001-11-09", "f16", 57275, 57550),
            (1, "2001-11-09", "f18", 58830, 58930),
            (1, "2001-11-09", "f18", 58520, 58625),
            (1, "2001-11-17", "f18", 54600, 54700),
            (1, "2001-11-17", "f16", 56670, 56770),
            (1, "2001-11-20", "f17", 37780, 38400),
            (2, "2001-11-17", "f17", 53780, 53794),
            (2, "2001-11-17", "f17", 54193, 54215),
            (2, "2001-11-17", "f19", 55482, 55517),
            (2, "2001-11-17", "f19", 55977, 56015),
            (2, "2001-11-17", "f19", 57030, 57072),
            (2, "2001-11-20", "f17", 44400, np.inf),
            (3, "2001-10-30", "f18", 57340, 57890),
            (3, "2001-11-09", "f16", 60650, 60700),
            (3, "2001-11-09", "f16", 60870, 60960),
            (3, "2001-11-17", "f16", 57475, 57530),
            (3, "2001-11-17", "f16", 57675, 57800),
            (3, "2001-11-17", "f19", 58150, 58325),
        ),
        start=1,
    )
)


def events_of(day, actuator=None):
    """Faults of a day in the order of time.

    Parameters
    ----------
    day : str or datetime.date
        A date, in ISO 8601, or as the files are named: ``"09112001"``.
    actuator : {1, 2, 3} or None, default=None
        None: of all three.

    Returns
    -------
    events : tuple of LublinEvent
        Empty where no fault is known.

    Raises
    ------
    ValueError
        If the day is not one of the recordings' period, or there is no such actuator.

    Examples
    --------
    >>> from sklvalve.damadics import events_of
    >>> [(event.fault, event.begins) for event in events_of("2001-11-09", actuator=1)]
    [('f16', 57275.0), ('f18', 58520.0), ('f18', 58830.0)]
    """
    if actuator not in (None, 1, 2, 3):
        raise ValueError(f"actuator must be 1, 2, 3 or None, got {actuator!r}.")
    wanted = iso_day(day)
    events = (e for e in LUBLIN_EVENTS if e.day == wanted and actuator in (None, e.actuator))
    return tuple(sorted(events, key=lambda event: event.begins))
