# SPDX-License-Identifier: BSD-3-Clause
"""The plant is plausible, repeatable, and healthy where nothing is concealed."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sklvalve.datasets import CONCEALABLE, make_valve_recording
from sklvalve.datasets._plant_draw import jet_floor, sheet_trim, water

pytest.importorskip("pandas")
SHORT = {"n_samples": 1500, "n_later": 100}


@pytest.mark.parametrize("seed", range(6))
def test_healthy_stem_settles_within_three_seconds(seed):
    """Tolerances: static error 0.5 % of travel and zero 1 %, here without sensor noise."""
    frame = make_valve_recording(loop="wide", noise=0.0, random_state=seed).frame
    command, opening = frame["CV"].to_numpy(), frame["X"].to_numpy()
    still = np.array([k for k in range(10, len(frame)) if np.all(command[k - 3 : k + 1] == command[k])])
    error = (opening - command)[still]
    assert still.size > 500
    assert np.abs(error).max() < 0.6
    assert np.sqrt(np.mean(error**2)) < 0.3


@pytest.mark.parametrize("loop", ["wide", "closed", "mixed"])
@pytest.mark.parametrize("seed", [1, 2])
def test_healthy_signals_stay_within_what_a_loop_can_do(loop, seed):
    made = make_valve_recording(loop=loop, random_state=seed, concealed=False)
    frame, kv = made.frame, made.valve["valve"]["kv_rated"]
    assert len(frame) == 5760
    assert len(made.later) == 1440
    assert made.later["time"].iloc[0] == 5760
    assert frame["true_opening"].between(0.0, 100.0).all()
    assert frame["CV"].between(0.0, 100.0).all()
    assert (frame["P1"] > frame["P2"]).all()
    assert frame["P1"].between(600.0, 1000.0).all()
    assert frame["T1"].between(0.0, 100.0).all()
    assert frame["F"].between(-0.02 * kv, 3.0 * kv).all()
    # no more flow than the drop can push through the rated valve, capacity and trim at their tolerance
    most = 1.2 * kv * np.sqrt((frame["P1"] - frame["P2"]) / 100.0)
    assert (frame["flow_without_noise"] < most + 0.02 * kv).all()
    assert ("SP" in frame) == (loop != "wide")


@pytest.mark.parametrize("seed", range(4))
def test_healthy_valve_is_within_the_tolerance_of_its_sheet(seed):
    made = make_valve_recording(loop="wide", noise=0.0, random_state=seed)
    frame, sheet = made.frame, made.valve["valve"]
    x = frame["X"].to_numpy() / 100.0
    calm = (np.abs(np.gradient(x)) < 1e-3) & (np.abs(np.gradient(frame["F"])) < 0.002 * sheet["kv_rated"])
    steady = calm & np.roll(calm, 3) & np.roll(calm, 6) & (x > 0.1)
    density, vapour = water(frame["T1"].to_numpy())
    p1, p2 = 1e3 * frame["P1"].to_numpy(), 1e3 * frame["P2"].to_numpy()
    steady &= (p1 - p2) < 0.7 * sheet["fl"] ** 2 * (p1 - jet_floor(vapour))
    kv = (frame["F"].to_numpy() * np.sqrt(density / 1000.0) / np.sqrt((p1 - p2) / 1e5))[steady]
    phi = sheet_trim(sheet["characteristic"], sheet["rangeability"], sheet["shutoff"], x)[steady]
    ratio = kv / (sheet["kv_rated"] * phi)
    # trim, capacity, and the zeros of stem, plug and flow meter together
    slack = 0.1 + 0.1 * (1.0 / phi) ** 0.2 + 0.01 * np.log(sheet["rangeability"]) + 0.005 / phi
    assert steady.sum() > 200
    assert (np.abs(ratio - 1.0) < slack).all()
    assert np.abs(ratio - 1.0).max() > 0.005  # not the sheet itself: that would be an inverse crime


def test_noise_is_of_the_stated_size_and_correlated():
    made = make_valve_recording(loop="wide", random_state=5)
    residual = made.frame["F"] - made.flow_without_noise["flow"].iloc[:5760]
    span = made.frame["F"].max()
    assert 0.001 < residual.std() / span < 0.006
    slow = residual.rolling(100).mean().dropna().std()
    assert slow > 2.0 * residual.std() / np.sqrt(100.0)


def test_noise_zero_leaves_quantisation_and_zero_offsets_alone():
    made = make_valve_recording(loop="wide", noise=0.0, random_state=5)
    np.testing.assert_allclose(made.frame["F"], made.flow_without_noise["flow"].iloc[:5760], atol=0.0011)
    steps = made.frame["X"].to_numpy() / 0.05
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-6)


def test_same_seed_same_recording_and_another_seed_another():
    first, again = (make_valve_recording("backlash", random_state=3, **SHORT) for _ in range(2))
    assert first.frame.equals(again.frame)
    assert first.later.equals(again.later)
    assert first.truth == again.truth
    other = make_valve_recording("backlash", random_state=4, **SHORT)
    assert not first.frame["F"].equals(other.frame["F"])


@pytest.mark.parametrize("name", CONCEALABLE)
def test_strength_zero_is_the_healthy_plant(name):
    healthy = make_valve_recording(loop="mixed", random_state=9, **SHORT)
    made = make_valve_recording(name, 0.0, loop="mixed", random_state=9, **SHORT)
    assert made.frame.equals(healthy.frame)
    assert made.truth["verdict"] == "no_mismatch"
    assert made.truth["effects"] == []
    assert not made.truth["counts"]


@settings(max_examples=15, deadline=None)
@given(
    seed=st.integers(0, 2**31 - 1),
    name=st.sampled_from(CONCEALABLE),
    loop=st.sampled_from(["wide", "closed", "mixed"]),
    level=st.floats(0.0, 3.0),
)
def test_any_draw_is_finite_and_tells_its_truth(seed, name, loop, level):
    made = make_valve_recording(
        name, onset=None, loop=loop, noise=level, random_state=seed, n_samples=400, n_later=20
    )
    signals = made.frame.drop(columns="SP", errors="ignore")
    assert np.isfinite(signals.to_numpy(dtype=float)).all()
    assert signals["X"].between(-2.5, 102.5).all()
    assert made.truth["concealed"] == [name]
    assert made.truth["verdict"] in ("named", "none_of_these")
    assert 0.0 <= made.truth["onset"] < 400.0


@pytest.mark.parametrize(
    ("settings", "expected"),
    [
        ({"effect": "sticktion"}, "effect must be one of"),
        ({"effect": ["backlash", "backlash"]}, "once"),
        ({"effect": "backlash", "strength": [0.1, 0.2]}, "one number per effect"),
        ({"effect": "backlash", "strength": -0.1}, "zero or above"),
        ({"effect": "backlash", "strength": float("nan")}, "finite"),
        ({"loop": "open"}, "loop must be one of"),
        ({"onset": 1e6}, "onset must lie within"),
        ({"noise": -1.0}, "noise must be"),
        ({"n_samples": 0}, "n_samples must be"),
    ],
)
def test_bad_settings_are_told_in_one_sentence(settings, expected):
    with pytest.raises(ValueError, match=expected):
        make_valve_recording(**settings)


def test_water_agrees_with_published_values():
    """Values of the IAPWS tables, which these formulas were not fitted to."""
    density, vapour = water(np.array([20.0, 50.0, 75.0]))
    np.testing.assert_allclose(density, [998.21, 988.04, 974.84], atol=0.1)
    np.testing.assert_allclose(vapour, [2339.0, 12352.0, 38595.0], rtol=5e-3)
