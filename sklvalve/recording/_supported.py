# SPDX-License-Identifier: BSD-3-Clause
"""What a valve.toml may say, but no diagnosis can follow yet: refused, because ignoring it would mislead."""

from sklvalve.recording._layout import GAS_KEYS
from sklvalve.recording.errors import InputError
from sklvalve.recording.valve import Valve

#: Effects that the simulation can hold already.
HELD_PHYSICS = ("choked_flow",)

_THINNEST_LIQUID = 50.0  # kg/m3; liquid hydrogen has 71


def require_supported(valve: Valve) -> None:
    """Refuse a data sheet whose words would have to be ignored.

    Raises
    ------
    InputError
        Naming the key.
    """
    _require_liquid(valve)
    if valve.positioner is False:
        raise InputError(
            f"{valve.source}: [actuator] positioner = false, but only valves with a positioner can be "
            "diagnosed yet; take the line out if the valve has one"
        )
    for name in valve.physics:
        if name not in HELD_PHYSICS:
            raise InputError(
                f"{valve.source}: [simulation] physics names {name!r}, which the simulation cannot hold yet; "
                f"only {', '.join(HELD_PHYSICS)} can stand there, so take {name!r} out"
            )


def _require_liquid(valve: Valve) -> None:
    more = "but only liquids can be diagnosed yet"
    for key in GAS_KEYS:
        if key in valve.fluid:
            raise InputError(
                f"{valve.source}: [fluid] {key} says that a gas flows, {more}; "
                "take the key out if it is a liquid"
            )
    density = float(valve.fluid.get("density", 1000.0))
    if density < _THINNEST_LIQUID:
        raise InputError(
            f"{valve.source}: [fluid] density is {density:g} kg/m3, which is that of a gas, {more}; "
            "correct it if it is a liquid"
        )
