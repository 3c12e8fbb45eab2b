# SPDX-License-Identifier: BSD-3-Clause
"""The detector that knows everything knows the plant's own law, and tells a loop that sticks."""

import numpy as np
import pytest

from benchmarks.loop_alarms import measured
from benchmarks.loop_law import by_rows, law_of, whitened
from benchmarks.loop_limit import answers_of, limits_of
from benchmarks.loop_plant import draw_plant

pytestmark = pytest.mark.slow


@pytest.mark.parametrize(
    ("kind", "scene", "form"),
    [
        ("flow", "quiet", "choudhury"),
        ("pressure", "oscillation", "sliding"),
        ("level", "saw", "choudhury"),
        ("level", "drift", "sliding"),
        ("pressure", "curved", "choudhury"),
    ],
)
def test_behind_the_true_stem_only_noise_of_the_known_law_is_left(kind, scene, form):
    plant = draw_plant(96002, kind, scene, sticking=True, form=form)[1]
    true = np.array([[plant.friction["stick"], plant.friction["slip"] / plant.friction["stick"], 0.0]])
    left = plant.value - answers_of(plant, true)
    for rows, law in (
        (left, law_of(plant, 0.0)),
        (left[:, :: plant.steps], by_rows(law_of(plant, 1e-9), plant.steps)),
    ):
        new, _ = whitened(rows, law)
        # the first movements hang on where the stem stood before
        settled = new[0, len(new[0]) // 4 :]
        assert settled.std() == pytest.approx(1.0, abs=0.12)
        assert abs(np.corrcoef(settled[1:], settled[:-1])[0, 1]) < 0.15


def test_knowing_everything_tells_a_sticking_loop():
    evidence = limits_of(96005)
    assert evidence["sticking"]
    assert evidence["steps"] > 100.0
    assert evidence["rows"] > 100.0
    healthy = limits_of(96000)
    assert not healthy["sticking"]
    assert max(healthy["steps"], healthy["rows"], healthy["noise"]) < 0.0


def test_a_play_as_wide_as_the_movement_is_no_healthy_loop():
    # drawn as a small play, but the loop moves so little that it is half of the movement
    assert list(measured([98476])) == []
