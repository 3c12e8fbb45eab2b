# SPDX-License-Identifier: BSD-3-Clause
"""The benchmark's indices on decisions made by hand; every expected number is worked out beside it."""

import numpy as np
import pytest

from sklvalve.damadics import (
    FAULTS,
    SCENARIOS,
    Profile,
    Zone,
    make_damadics,
    performance_indices,
    scenario_indices,
)

# set up for 2 s, sound for 8 s, with the fault for 10 s; a sample a second, the last held until 20 s
T = np.arange(20.0)
ZONE = Zone(set_up=2.0, begins=10.0, horizon=20.0)
# one tenth a second from 10 s on
STRENGTH = np.clip((T - 10.0) / 10.0, 0.0, 1.0)
OF_DETECTION = ("t_dt", "t_drt", "t_dm", "t_drm", "r_fd", "r_td", "fs_d")
OF_ISOLATION = ("t_it", "t_irt", "t_im", "t_irm", "r_fi", "r_ti", "fs_i")


def high(*spells, t=T):
    """A decision that is high from the first up to, not including, the second time of each spell."""
    return sum(((t >= low) & (t < top)).astype(float) for low, top in spells) + 0.0 * t


def pointing(**spells):
    """Decisions for the nineteen faults."""
    return np.column_stack([high(*spells.get(name, ())) for name in FAULTS])


def judged(detection, isolation=None, *, fault="f7", zone=ZONE, strength=STRENGTH, **more):
    return performance_indices(T, detection, isolation, fault=fault, zone=zone, strength=strength, **more)


def values(indices, names):
    told = indices.to_dict()
    return [told[name] for name in names]


def test_a_fault_found_at_the_second_attempt():
    detection = high((4.0, 6.0), (12.0, 14.0), (15.0, 20.0))
    isolation = pointing(f7=((5, 6), (13, 20)), f3=((3, 5), (13, 16)), f9=((13, 14),))
    found = judged(detection, isolation)
    # detection: the last rise is at 15 s, 5 s after the beginning, at half strength; false for 2 s of 8, true
    # for 2 + 5 s of 10; the fault never ends, so there is no recovery
    assert values(found, OF_DETECTION) == pytest.approx([5.0, -1, 15.0, -1, 0.25, 0.7, 0.5])
    # f7: the last rise is at 13 s; false for 1 s of 8, true for 7 s of 10
    assert values(found, OF_ISOLATION) == pytest.approx([3.0, -1, 13.0, -1, 0.125, 0.7, 0.3])
    # other faults: f3 for 2 + 3 s and f9 for 1 s, within 18 s
    assert found.r_mi == pytest.approx(6.0 / 18.0)
    # each diagnosis holds one fault, and no fault is left to "no fault"; at 13 s f7, f3 and f9 are pointed at
    assert (found.dacc_t, found.dacc_tm, found.dacc) == pytest.approx((1.0, 1.0, 1.0 / 3.0))


def test_there_are_eighteen_indices():
    told = judged(high((12, 20))).to_dict()
    assert len(told) == 18
    assert tuple(told)[:14] == OF_DETECTION + OF_ISOLATION


def test_never_detected():
    # the alarm from 4 s to 6 s is false, and told nowhere: a fault that is never detected has no rates
    found = judged(high((4, 6)), pointing(f3=((4, 6),)))
    assert values(found, (*OF_DETECTION, *OF_ISOLATION, "r_mi", "dacc")) == [-1.0] * 16
    # what the diagnoses are is known without a decision
    assert (found.dacc_t, found.dacc_tm) == (1.0, 1.0)


def test_detected_before_the_beginning():
    # high from 8 s on without a rise after 10 s: no time, no strength; false for 2 s of 8, true throughout
    before = judged(high((8, 20)))
    assert values(before, OF_DETECTION) == pytest.approx([-1, -1, -1, -1, 0.25, 1.0, -1])
    # it falls at 11 s and rises at 14 s for good: 4 s; true for 1 + 6 s of 10
    again = judged(high((8, 11), (14, 20)))
    assert values(again, OF_DETECTION) == pytest.approx([4.0, -1, 14.0, -1, 0.25, 0.7, 0.4])
    # high from the first sample of all: what lies before 2 s does not count, so false for 8 s of 8
    always = judged(high((0, 20)))
    assert values(always, OF_DETECTION) == pytest.approx([-1, -1, -1, -1, 1.0, 1.0, -1])


def test_detected_at_the_beginning():
    # no time passes, and the fault has no strength yet
    found = judged(high((10, 20)))
    assert values(found, OF_DETECTION) == pytest.approx([0.0, -1, 10.0, -1, 0.0, 1.0, 0.0])
    # before the file there is no decision; and no time without the fault
    whole = judged(high((0, 20)), zone=Zone(set_up=0.0, begins=0.0, horizon=20.0))
    assert values(whole, OF_DETECTION) == pytest.approx([0.0, -1, 0.0, -1, -1, 1.0, 0.0])


def test_without_isolation():
    found = judged(high((12, 20)))
    # 2 s after the beginning; true for 8 s of 10
    assert values(found, OF_DETECTION) == pytest.approx([2.0, -1, 12.0, -1, 0.0, 0.8, 0.2])
    assert list(found.to_dict().values())[7:] == [-1.0] * 11


def test_a_wrong_class_all_along():
    # f3 in place of f7 for 18 s of 18: one other diagnosis, in the mean over the zone
    found = judged(high((12, 20)), pointing(f3=((0, 20),)))
    assert found.t_dt == 2.0
    assert values(found, OF_ISOLATION) == [-1.0] * 7
    assert (found.r_mi, found.dacc_t, found.dacc) == (1.0, 1.0, -1.0)
    # a second wrong one for 9 s of the 18: 1 + 0.5
    found = judged(high((12, 20)), pointing(f3=((0, 20),), f19=((11, 20),)))
    assert found.r_mi == pytest.approx(1.5)


def test_the_true_class_among_wrong_ones_from_before():
    # f7 is pointed at from 9 s on and never rises again: no accuracy can be told; false for 1 s of 8
    found = judged(high((12, 20)), pointing(f7=((9, 20),), f3=((9, 20),)))
    assert values(found, OF_ISOLATION) == pytest.approx([-1, -1, -1, -1, 0.125, 1.0, -1])
    # f3 for 11 s of 18
    assert (found.r_mi, found.dacc) == (pytest.approx(11.0 / 18.0), -1.0)


def test_a_fault_that_ends_within_the_zone():
    ends = Zone(set_up=2.0, begins=10.0, ends=15.0, horizon=20.0)
    detection, isolation = high((3, 4), (11, 17), (18, 19)), pointing(f7=((12, 15),))
    found = judged(detection, isolation, zone=ends)
    # the rise at 18 s comes after the fault; so the last one is that of 11 s. The last fall is at 19 s, 4 s
    # after the end. Free of the fault are 8 + 5 s, high in them 1 + 2 + 1 s; with it 4 s of 5 are high
    assert values(found, OF_DETECTION) == pytest.approx([1.0, 4.0, 11.0, 19.0, 4.0 / 13.0, 0.8, 0.1])
    # f7: falls with the fault, 0 s after its end; nothing false; 3 s of 5
    assert values(found, OF_ISOLATION) == pytest.approx([2.0, 0.0, 12.0, 15.0, 0.0, 0.6, 0.2])
    assert found.dacc == 1.0
    # the fall at 17 s is the last one by then
    sooner = judged(detection, zone=Zone(set_up=2.0, begins=10.0, ends=15.0, horizon=17.0))
    assert (sooner.t_drt, sooner.t_drm) == (2.0, 17.0)


def test_low_again_before_the_fault_ends_or_high_beyond_the_horizon_is_no_recovery():
    ends = Zone(set_up=2.0, begins=10.0, ends=15.0, horizon=20.0)
    # 11 s to 13 s: true for 2 s of 5
    early = judged(high((11, 13)), zone=ends)
    assert values(early, OF_DETECTION) == pytest.approx([1.0, -1, 11.0, -1, 0.0, 0.4, 0.1])
    # 11 s to the end: false for the 5 s after the fault, of 8 + 5
    never = judged(high((11, 20)), zone=ends)
    assert values(never, OF_DETECTION) == pytest.approx([1.0, -1, 11.0, -1, 5.0 / 13.0, 0.8, 0.1])


def test_a_fault_that_begins_as_soon_as_decisions_count_has_no_false_rate():
    found = judged(high((12, 20)), zone=Zone(set_up=10.0, begins=10.0, horizon=20.0))
    assert (found.r_fd, found.r_td) == (-1.0, 0.8)


def test_diagnoses_of_several_faults():
    groups = [("f1", "f7"), ("f2",), ("f16", "f17", "f18", "f19")]
    isolation = np.column_stack([high((13, 20)), high((2, 11)), high((13, 17))])
    found = judged(high((12, 20)), isolation, diagnoses=groups)
    # f7 stands in the first; its rise is at 13 s
    assert found.t_it == 3.0
    # the second for 9 s and the third for 4 s, of 18
    assert found.r_mi == pytest.approx(13.0 / 18.0)
    # the first holds 2 faults, the others 1 and 4; the 12 faults that are left join "no fault" to be 13
    assert found.dacc_t == 0.5
    assert found.dacc_tm == pytest.approx((1 / 2 + 1 + 1 / 4 + 1 / 13) / 4)
    # at 13 s the first and the third are pointed at: 2 + 4 faults
    assert found.dacc == pytest.approx(1.0 / 6.0)
    # f5 stands in none: it cannot be isolated, and is one of the 13
    blind = judged(high((12, 20)), isolation, fault="f5", diagnoses=groups)
    assert values(blind, OF_ISOLATION) == [-1.0] * 7
    assert (blind.dacc_t, blind.dacc) == (pytest.approx(1.0 / 13.0), -1.0)
    # all three count as others: 7 + 9 + 4 s
    assert blind.r_mi == pytest.approx(20.0 / 18.0)


def test_a_frame_names_its_diagnoses():
    pd = pytest.importorskip("pandas")
    frame = pd.DataFrame(pointing(f7=((13, 20),), f3=((13, 16),)), columns=list(FAULTS))
    whole = judged(high((12, 20)), frame)
    assert whole == judged(high((12, 20)), frame.to_numpy())
    assert whole == judged(high((12, 20)), frame[list(FAULTS)[::-1]])
    # two diagnoses are left, and "no fault" holds 17 + 1
    part = judged(high((12, 20)), {"f3": frame["f3"], "f7": frame["f7"]})
    assert part.dacc_tm == pytest.approx((1.0 + 1.0 + 1.0 / 18.0) / 3.0)
    assert part.r_mi == whole.r_mi == pytest.approx(3.0 / 18.0)


def test_time_counts_and_not_samples():
    # rows at 0, 2, 4 s, ... and one at 13 s: high from 8 s to 10 s and from 13 s on, the last row for 2 s
    t = np.sort(np.append(np.arange(0.0, 20.0, 2.0), 13.0))
    decision = np.isin(t, (8.0, 13.0, 14.0, 16.0, 18.0))
    found = performance_indices(t, decision, fault="f7", zone=ZONE)
    assert values(found, OF_DETECTION) == pytest.approx([3.0, -1, 13.0, -1, 0.25, 0.7, -1])


def test_the_threshold_is_one_half():
    # 0.5 is low, more is high
    found = judged(np.where(T >= 14.0, 0.51, np.where(T >= 12.0, 0.5, 0.0)))
    assert (found.t_dt, found.r_td) == (4.0, 0.6)


def test_strength_is_told_without_its_sign():
    # a fault at full negative strength must not look as if it could not be had
    profile = Profile("f19", -1.0, begins=10.0)
    found = judged(high((12, 20)), fault="f19", strength=profile)
    assert found.fs_d == 1.0
    assert judged(high((12, 20)), strength=-STRENGTH).fs_d == 0.2
    assert judged(high((12, 20)), strength=None).fs_d == -1.0


def test_a_scenario_brings_its_zone_and_its_strength():
    frame = make_damadics("f13_incipient", noise=False)
    t = frame["time"].to_numpy()
    assert Zone.of(SCENARIOS["f13_incipient"]) == Zone(begins=900.0, horizon=2400.0)
    # high for 30 s of the 600 before, and from 1200 s on
    decision = ((t >= 500.0) & (t < 530.0)) | (t >= 1200.0)
    isolation = np.zeros((len(t), 19))
    isolation[t >= 1350.0, 12] = 1.0
    found = scenario_indices("f13_incipient", t, decision, isolation)
    # strength grows to one in 900 s: a third after 300 s, a half after 450 s; true for 1200 s of 1500
    assert values(found, OF_DETECTION) == pytest.approx([300.0, -1, 1200.0, -1, 0.05, 0.8, 1.0 / 3.0])
    assert values(found, OF_ISOLATION) == pytest.approx([450.0, -1, 1350.0, -1, 0.0, 0.7, 0.5])
    assert (found.r_mi, found.dacc) == (0.0, 1.0)
    known = SCENARIOS["f13_incipient"]
    assert scenario_indices(known, t, decision, isolation) == found
    # the strength that the recording itself tells is the same
    told = performance_indices(
        t, decision, isolation, fault="f13", zone=Zone.of(known), strength=frame["fault"]
    )
    assert told.to_dict() == pytest.approx(found.to_dict())


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"fault": "f20"}, "fault must be one of f1 to f19, got 'f20'"),
        ({"detection": np.zeros(19)}, r"detection must have the shape \(20,\), got \(19,\)"),
        ({"detection": np.where(T < 12, 1.0, -1.0)}, r"detection must lie in \[0, 1\].* got -1 to 1"),
        ({"detection": np.full(20, np.nan)}, "detection must be finite everywhere"),
        ({"strength": np.zeros(3)}, r"strength must have the shape \(20,\), got \(3,\)"),
        ({"isolation": np.zeros((20, 5))}, r"isolation must have the shape \(20, 19\), got \(20, 5\)"),
        ({"isolation": {"f20": T}}, "A diagnosis must hold faults of f1 to f19, got 'f20'"),
        ({"isolation": np.zeros((20, 1)), "diagnoses": [()]}, "Each diagnosis must hold a fault"),
        (
            {"isolation": np.zeros((20, 2)), "diagnoses": [("f1", "f2"), ("f2",)]},
            "no fault may stand in two of them",
        ),
        ({"isolation": {}}, "isolation must hold a column for each diagnosis, got none; leave it out"),
        ({"isolation": np.zeros((20, 0)), "diagnoses": []}, "isolation must hold a column"),
        ({"isolation": [], "diagnoses": []}, "isolation must hold a column"),
        ({"t": T + 3.0}, "must cover 2 s to 20 s; they go from 3 s to 23 s"),
        ({"t": T - 1.0}, "must cover 2 s to 20 s; they go from -1 s to 19 s"),
        ({"t": T[::-1]}, "each later than the one before"),
    ],
)
def test_what_cannot_be_judged_is_refused(changes, message):
    given = {"t": T, "detection": high((12, 20)), "isolation": None, "fault": "f7", "zone": ZONE} | changes
    with pytest.raises(ValueError, match=message):
        performance_indices(given.pop("t"), given.pop("detection"), given.pop("isolation"), **given)


@pytest.mark.parametrize(
    "times",
    [
        {"begins": 10.0, "horizon": 10.0, "set_up": 0.0},
        {"begins": 10.0, "horizon": 20.0, "set_up": 11.0},
        {"begins": 10.0, "horizon": 20.0, "set_up": 0.0, "ends": 10.0},
        {"begins": 10.0, "horizon": np.inf, "set_up": 0.0},
    ],
)
def test_a_zone_in_no_order_is_refused(times):
    with pytest.raises(ValueError, match="A zone must have set_up <= begins < horizon"):
        Zone(**times)
