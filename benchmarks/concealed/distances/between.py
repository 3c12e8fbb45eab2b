# SPDX-License-Identifier: BSD-3-Clause
"""Distances from what is true of a record to every other explanation of it.

The distance to an explanation is the least squared sum of the whitened difference between what the record
holds and what it would hold under that explanation, over the explanation's size, its course, and everything
that calibration may take up. Two explanations are told apart from 14 on (3 % of mistakes).
"""

from itertools import pairwise

import numpy as np

from benchmarks.concealed.distances.calibration import nuisance_of
from benchmarks.concealed.plant.effects import EFFECTS, NAMED
from benchmarks.concealed.plant.rig import WARM_UP, Course

APART = 14.0
# what is further off than this, and than a coarse grid of sizes gets wrong, is looked at no closer
HOPELESS = 100.0
_SIZES = 7
# between two sizes tried an effect is taken as a line in its size
_STRETCH = (0.75, 1.35)


def between(scene, course, true, others=None):
    """Distances from the truth of a scene.

    Parameters
    ----------
    scene : Scene
        Of the run with all that is concealed.
    course : Course
        When it acts.
    true : sequence of str
        What is concealed, by the plant's names.
    others : sequence of str, default=None
        Names of the catalogue that are asked for; all unless given.

    Returns
    -------
    distances : dict
        "nothing" and every name of the catalogue that is not the truth's own -> least distance.
    """
    told = {EFFECTS[name].told for name in true}
    change: dict = {}
    nuisance: dict = {}
    for channel in scene.channels():
        if scene.touches(scene.schedule, channel):
            difference = scene.seen(channel, scene.schedule) - scene.seen(channel, scene.sound)
            nuisance[channel] = nuisance_of(scene, channel)
            change[channel] = nuisance[channel].law(difference[scene.recorded][:, None])[:, 0]
    alone = {channel: nuisance[channel].distance(white) for channel, white in change.items()}
    nothing = sum(alone.values())
    found = {"nothing": nothing}
    for name in NAMED:
        effect = EFFECTS[name]
        asked = others is None or effect.told in others
        if not asked or effect.told in told or not _possible(effect, scene, course):
            continue
        least = min(_least(scene, name, c, change, nuisance, alone) for c in _courses(effect, course))
        found[effect.told] = min(least, found.get(effect.told, np.inf))
    return {name: round(float(distance), 1) for name, distance in found.items()}


def _possible(effect, scene, course):
    """Whether an explanation could be given here at all."""
    if effect.when == "start" and course.kind != "start":
        return False
    return effect.fluid in ("water", scene.plant.fluid)


def _courses(effect, course):
    """Courses an explanation may take: that of the truth, and throughout or from its onset on."""
    known = [course]
    if course.kind in ("on_and_off", "mended"):
        known.append(Course("within", course.onset))
    if course.kind == "start" and effect.when == "within":
        return [Course("within", 1.0)]
    if course.kind != "start" and effect.when == "any" and not effect.grows:
        known.append(Course())
    return known


def _least(scene, name, course, change, nuisance, alone):
    """Least distance over the sizes of one explanation."""
    effect = EFFECTS[name]
    probe = scene.scheduled({name: 0.5 * effect.most}, course)
    touched = [channel for channel in scene.channels() if scene.touches(probe, channel)]
    if not set(touched) & set(change):
        return sum(alone.values())
    for channel in set(touched) - set(change):
        # where nothing has moved, what an explanation would move speaks against it
        nuisance[channel] = nuisance_of(scene, channel)
        change[channel], alone[channel] = np.zeros(scene.n - WARM_UP), 0.0
    low = max(effect.free if course.kind == "start" else 0.0, 0.004 * effect.most)
    signs = (1.0, -1.0) if effect.signed else (1.0,)
    best = sum(alone.values())
    for sign in signs:
        tried = {}
        grid = np.linspace if effect.limits else np.geomspace
        for size in grid(low, effect.most, _SIZES + 2 * effect.limits):
            tried[size] = _at(scene, name, sign * size, course, touched, change, nuisance, alone)
        for _ in range(5 if effect.limits else 3):
            # what limits the travel does all within a narrow span of its sizes
            if min(tried.values()) > HOPELESS + (0.5 if effect.limits else 0.06) * best:
                break
            sizes = sorted(tried)
            middle = sizes.index(min(tried, key=tried.get))
            around = sizes[max(middle - 1, 0) : middle + 2]
            for a, b in pairwise(around):
                size = float(0.5 * (a + b) if effect.limits else np.sqrt(a * b))
                tried[size] = _at(scene, name, sign * size, course, touched, change, nuisance, alone)
        best = min(best, *tried.values())
    return best


def _at(scene, name, size, course, touched, change, nuisance, alone):
    schedule = scene.scheduled({name: size}, course)
    total = sum(value for channel, value in alone.items() if channel not in touched)
    for channel in touched:
        made = scene.seen(channel, schedule) - scene.seen(channel, scene.sound)
        white = nuisance[channel].law(made[scene.recorded][:, None])[:, 0]
        total += _with_stretch(change[channel], white, nuisance[channel])
    return total


def _with_stretch(change, white, nuisance):
    """Least distance over a small stretch of the explanation's size, on a line."""
    rest = [change - share * white for share in (_STRETCH[0], 1.0, _STRETCH[1])]
    found = [nuisance.distance(series) for series in rest]
    # a parabola through the three
    fit = np.polyfit((_STRETCH[0], 1.0, _STRETCH[1]), found, 2)
    if fit[0] > 0.0:
        share = float(np.clip(-0.5 * fit[1] / fit[0], *_STRETCH))
        found.append(nuisance.distance(change - share * white))
    return min(found)
