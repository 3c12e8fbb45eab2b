# SPDX-License-Identifier: BSD-3-Clause
"""The smallest size of an effect that one record could tell, by the plant alone."""

from dataclasses import dataclass, replace

import numpy as np

from benchmarks.concealed.distances.calibration import nuisance_of
from benchmarks.concealed.distances.scene import Scene
from benchmarks.concealed.plant.effects import EFFECTS

DISTANCE = 25.0  # squared: five standard deviations of the best test of one known change
SHARE = 0.005  # of span or travel, rms where it acts: from there on a change matters in practice


@dataclass(frozen=True)
class Detectable:
    """Smallest size that a record tells, its distance from nothing, and what it moves (share of span)."""

    size: float
    distance: float
    share: float


def scene_of(plant, strengths, course, lacking=()):
    """The scene of a run with these effects."""
    schedule = plant.schedule(strengths, course)
    return Scene(plant, schedule, plant.run(schedule), lacking)


def standing_out(scene):
    """Distance of a scene from a sound plant, and the share of span or travel that it moves, calibrated."""
    distance = share = 0.0
    for channel in scene.channels():
        if not scene.touches(scene.schedule, channel):
            continue
        change = scene.seen(channel, scene.schedule) - scene.seen(channel, scene.sound)
        change = change[scene.recorded]
        alone, rest = nuisance_of(scene, channel).left(change)
        distance += alone
        share = max(share, acting_share(rest, scene, channel))
    return distance, share


def acting_share(change, scene, channel):
    """Rms of a change over the rows where it acts, as share of span or travel."""
    size = np.abs(change) / (np.ptp(scene.seen("flow", scene.schedule)) if channel == "flow" else 1.0)
    acting = size > 0.2 * np.quantile(size, 0.99)
    return float(np.sqrt(np.mean(size[acting] ** 2))) if acting.any() else 0.0


def detectable(plant, name, course, lacking=(), sign=1.0, factor=1.0):
    """Smallest size at which an effect stands out by five standard deviations and matters in practice.

    Parameters
    ----------
    plant : Plant
    name : str
        Of `EFFECTS`.
    course : Course
    lacking : sequence of str
    sign : float
    factor : float, default=1.0
        How many times as large the change must be, both against the noise and in practice.

    Returns
    -------
    found : Detectable
        To six percent of the size; infinite where no possible size is enough.
    """
    effect = EFFECTS[name]
    least = effect.free if course.kind == "start" else 0.0

    def at(size):
        distance, share = standing_out(scene_of(plant, {name: sign * size}, course, lacking))
        reached = min(distance / DISTANCE, (share / SHARE) ** 2) / factor**2
        return reached, Detectable(sign * size, distance, share)

    reached, best = at(effect.most)
    nothing = replace(best, size=np.inf)
    if reached < 1.0:
        return nothing
    low, high = least, effect.most
    tried = 0.5 * (low + high) if effect.limits else max(low * 1.05, 0.1 * high)
    for _ in range(9):
        reached, found = at(tried)
        low, high, best = (low, tried, found) if reached >= 1.0 else (tried, high, best)
        if high - low < (0.006 * effect.most if effect.limits else 0.06 * high):
            break
        guess = tried / np.sqrt(np.clip(reached, 0.04, 25.0)) * (1.03 if reached < 1.0 else 0.97)
        inside = 1.01 * low < guess < 0.99 * high
        tried = guess if inside and not effect.limits else 0.5 * (low + high)
    return best


def of_times(plant, name, course, times, lacking=(), sign=1.0):
    """Size so many times the detectable one, and that one; a size of None where it is not possible.

    What limits the travel does nothing up to some size and then much: there the change is so many times as
    large, and not the size.
    """
    found = detectable(plant, name, course, lacking, sign)
    if not np.isfinite(found.size):
        return None, found
    if EFFECTS[name].limits:
        larger = detectable(plant, name, course, lacking, sign, times) if times > 1.0 else found
        return (larger.size if np.isfinite(larger.size) else None), found
    size = times * found.size
    return (size if abs(size) <= EFFECTS[name].most else None), found
