# SPDX-License-Identifier: BSD-3-Clause
"""How a message names a signal of a recording, and one of its values."""

from sklvalve.recording.recording import Recording


def column_of(recording: Recording, role: str) -> str:
    """File and column of a role, or the section of the valve.toml where it is a constant."""
    signal = recording.signal(role)
    if signal.column is None:
        return f"{recording.valve.source}: [recording.{role}]"
    return f"{recording.source}: column {signal.column!r} ({role})"


def written(recording: Recording, role: str, value: float) -> str:
    """A value in SI as the recording would hold it, with its unit."""
    unit = recording.unit(role)
    return f"{float(recording.in_recorded_units(role, value)):.6g}" + ("" if unit == "1" else f" {unit}")
