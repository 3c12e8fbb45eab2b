# SPDX-License-Identifier: BSD-3-Clause
"""Keys of a valve.toml that contradict each other, each of them possible by itself."""

from collections.abc import Mapping

import numpy as np

from sklvalve.recording._checks import shown
from sklvalve.recording.errors import InputError
from sklvalve.recording.signal import Signal

_WATER_CRITICAL = 22.064e6  # Pa
#: Roles that may be the process value of a loop themselves.
_CONTROLLED = ("opening", "p1", "p2", "temperature", "flow")


def require_agreement(
    fluid: Mapping[str, object],
    actuator: Mapping[str, object],
    roles: Mapping[str, Signal],
    time: str,
    source: str,
) -> None:
    """Refuse what cannot be true together.

    Raises
    ------
    InputError
        Naming the keys.
    """
    _require_liquid(fluid, source)
    _require_strong_air(actuator, source)
    _require_one_drive(actuator, source)
    _require_own_columns(roles, time, source)


def require_liquid_at_inlet(fluid: Mapping[str, object], p1: np.ndarray, source: str) -> None:
    """Refuse a vapour pressure that the inlet pressure does not exceed in most rows.

    Raises
    ------
    InputError
        Naming the key and the pressures.
    """
    vapour = fluid.get("vapour_pressure")
    known = p1[np.isfinite(p1)]
    if not isinstance(vapour, float) or not len(known) or np.mean(vapour >= known) <= 0.5:
        return
    raise InputError(
        f"{source}: [fluid] vapour_pressure = {vapour / 1e3:g} kPa, but p1 lies around "
        f"{np.median(known) / 1e3:.4g} kPa, absolute, where the liquid would boil before the valve; give the "
        "vapour pressure in kPa, absolute, or correct unit and gauge of [recording.p1]"
    )


def _require_liquid(fluid: Mapping[str, object], source: str) -> None:
    vapour, critical = fluid.get("vapour_pressure"), fluid.get("critical_pressure", _WATER_CRITICAL)
    if isinstance(vapour, float) and isinstance(critical, float) and vapour >= critical:
        of = "" if "critical_pressure" in fluid else " of water, which holds where none is given"
        raise InputError(
            f"{source}: [fluid] vapour_pressure = {vapour / 1e3:g} kPa is not below the critical "
            f"pressure{of}, {critical / 1e3:g} kPa, so there is no liquid; give both in kPa, absolute"
        )


def _require_strong_air(actuator: Mapping[str, object], source: str) -> None:
    supply, spring = actuator.get("supply_pressure"), actuator.get("spring_range")
    if isinstance(supply, float) and isinstance(spring, tuple) and supply <= spring[0]:
        raise InputError(
            f"{source}: [actuator] supply_pressure = {supply / 1e3:g} kPa does not exceed "
            f"{spring[0] / 1e3:g} kPa, where spring_range begins, so air could not move the stem; correct "
            "one of them"
        )


def _require_one_drive(actuator: Mapping[str, object], source: str) -> None:
    """What only air has belongs to no motor."""
    kind = actuator.get("kind")
    of_air = [key for key in ("supply_pressure", "spring_range", "effective_area") if key in actuator]
    if kind in ("electric", "hydraulic") and of_air:
        raise InputError(
            f'{source}: [actuator] kind = "{kind}", but {of_air[0]} belongs to an actuator driven by air; '
            f'leave {of_air[0]} out, or write kind = "pneumatic"'
        )


def _require_own_columns(roles: Mapping[str, Signal], time: str, source: str) -> None:
    """One column is one signal; only the value that a loop controls may have a role of its own besides."""
    owners = {time: "time"}
    # last, so that it may stand before or behind the role that it is
    for role in sorted(roles, key="process_value".__eq__):
        column = roles[role].column
        if column is None or (role == "process_value" and owners.get(column) in _CONTROLLED):
            continue
        if column in owners:
            raise InputError(
                f"{source}: [recording.{role}] names column {shown(column)}, which is the "
                f"{owners[column]} already; give each role its own column, or leave one out"
            )
        owners[column] = role
