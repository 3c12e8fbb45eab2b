# SPDX-License-Identifier: BSD-3-Clause
"""Groups of data defects that hide several effects, or look like them: what `Effect.hidden_by` is made of.

`mismatch.data.gate` asks it: an effect that a defect of the recording hides is not tried.
"""

from collections.abc import Mapping
from types import MappingProxyType

#: The roles of a defect that hides an effect whatever signal has it.
ANY = ("any",)

_DRIVE = ("command", "opening")
_PRESSURES = ("p1", "p2")


def hidden(
    *groups: Mapping[str, tuple[str, ...]], **defects: tuple[str, ...]
) -> Mapping[str, tuple[str, ...]]:
    """Defects of several groups, and further ones: to each the roles that any of them names.

    Parameters
    ----------
    *groups : mapping of str to tuple of str
    **defects : tuple of str
        By the defect's name.

    Returns
    -------
    merged : mapping of str to tuple of str

    Examples
    --------
    >>> dict(hidden({"frozen": ("flow",)}, frozen=("p1",), saturated=("flow",)))
    {'frozen': ('flow', 'p1'), 'saturated': ('flow',)}
    """
    merged: dict[str, tuple[str, ...]] = {}
    for group in (*groups, defects):
        for defect, roles in group.items():
            merged[defect] = tuple(dict.fromkeys((*merged.get(defect, ()), *roles)))
    return MappingProxyType(merged)


#: When and how far the stem moves: a record redrawn or shifted in time does not show it.
MOVES = hidden(compressed=_DRIVE, clock_shift=ANY, unmeasured=_DRIVE)
#: A stem that stays and then moves: so does a coarse or stale reading.
STICKS = hidden(MOVES, quantised=("opening",), frozen=("opening",))
#: What the actuator does with a command, up to the ends of the travel.
REACH = hidden(saturated=("opening",), unmeasured=_DRIVE)
#: What the position sensor makes of the stem.
READING = hidden(saturated=("opening",), unmeasured=("opening",))
#: How fast the flow follows the stem.
FOLLOWING = hidden(compressed=("opening", "flow", *_PRESSURES), clock_shift=ANY, held=("opening",))
#: Bubbles, told by the variance of flow and pressures.
UNSTEADY = hidden(compressed=("flow", *_PRESSURES), quantised=("flow", *_PRESSURES), unmeasured=_PRESSURES)
#: What bends the flow towards the end at which a meter saturates.
END_OF_FLOW = hidden(saturated=("flow",))
#: What hangs on the pressures themselves.
PRESSURES = hidden(unmeasured=_PRESSURES)
#: What hangs on a temperature that varies.
WARMTH = hidden(dict.fromkeys(("compressed", "frozen", "saturated", "unmeasured"), ("temperature",)))
