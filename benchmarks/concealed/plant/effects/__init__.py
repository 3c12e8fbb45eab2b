# SPDX-License-Identifier: BSD-3-Clause
"""All that the plant can conceal, by name."""

from benchmarks.concealed.plant.effects import actuator, measurement, outside, valve

EFFECTS = {e.name: e for part in (actuator, valve, measurement, outside) for e in part.EFFECTS}
OUTSIDE = tuple(name for name, effect in EFFECTS.items() if effect.told is None)
NAMED = tuple(name for name, effect in EFFECTS.items() if effect.told is not None)
