# SPDX-License-Identifier: BSD-3-Clause
"""Two histories made one: what their windows say stays the same, whichever point it is said about."""

import copy
from dataclasses import replace

import numpy as np
import pytest

from sklvalve.history import Allowance, ValveHistory
from sklvalve.history.merging import moved
from sklvalve.recording import InputError
from sklvalve.simulation.parameters import ParameterVector
from tests.history.plant import named, of_sheet, without


def test_both_are_in_it(learnt, learnt_after):
    both = copy.deepcopy(learnt).merge(learnt_after)
    assert both.rows == learnt.rows + learnt_after.rows == 2_400
    assert both.days == pytest.approx(learnt.days + learnt_after.days)
    assert len(both.windows_) == len(learnt.windows_) + len(learnt_after.windows_)
    assert len(both.recordings_) == 2
    for name, (low, high) in both.range_.limits(0.0).items():
        ends = [each.range_.limits(0.0)[name] for each in (learnt, learnt_after)]
        assert low <= min(end[0] for end in ends)
        assert high >= max(end[1] for end in ends)


def test_the_other_is_left_as_it_was(learnt, learnt_after):
    before = copy.deepcopy(learnt_after.to_state())
    copy.deepcopy(learnt).merge(learnt_after)
    after = learnt_after.to_state()
    for k, each in enumerate(after["windows"]["information"]):
        np.testing.assert_array_equal(each["pull"], before["windows"]["information"][k]["pull"])


def _said(history, windows, group, values):
    """What windows say of values, to second order, in the numbers of a history."""
    vector = ParameterVector(history._groups_[group].parameters)
    z = (vector.pack(values) - vector.pack(history.values_)) / vector.scale
    each = [w.information[group] for w in windows]
    return sum(0.5 * z @ i.hessian @ z - i.pull @ z for i in each)


@pytest.mark.parametrize("group", [0, 1])
def test_windows_say_the_same_about_another_point(learnt, learnt_after, group):
    rng = np.random.default_rng(0)
    windows = moved(learnt, learnt_after)
    parameters = learnt._groups_[group].parameters
    trials = []
    for _ in range(5):
        # well inside the bounds, which clip
        share = rng.uniform(0.4, 0.6, len(parameters))
        trials.append(
            {
                p.name: float(p.low ** (1.0 - s) * p.high**s if p.log else p.low + s * (p.high - p.low))
                for p, s in zip(parameters, share, strict=True)
            }
        )
    here = np.array([_said(learnt, windows, group, t) for t in trials])
    there = np.array([_said(learnt_after, learnt_after.windows_, group, t) for t in trials])
    # a constant is of no account
    np.testing.assert_allclose(np.diff(here), np.diff(there), rtol=1e-6, atol=1e-6 * np.abs(there).max())


def test_scales_of_the_two_differ(learnt, learnt_after):
    # else the test above would not see a wrong ratio
    one, two = (ParameterVector(h._groups_[0].parameters).scale for h in (learnt, learnt_after))
    assert not np.allclose(one, two, rtol=1e-6)


def test_merged_or_updated_is_nearly_the_same(learnt, learnt_after, after):
    merged, updated = copy.deepcopy(learnt).merge(learnt_after), copy.deepcopy(learnt).update(after)
    size = np.sqrt(np.diag(updated.prior_.covariance))
    at = updated.prior_.names.index("capacity")
    assert abs(merged.prior_.mean[at] - updated.prior_.mean[at]) < 2.0 * size[at]
    # two are surer than one
    alone = np.sqrt(np.diag(learnt.prior_.covariance))
    assert np.median(np.sqrt(np.diag(merged.prior_.covariance)) / alone) < 1.0


def _with(history, **attributes):
    other = copy.deepcopy(history)
    for name, value in attributes.items():
        setattr(other, name, value)
    return other


def test_what_cannot_be_merged(learnt, learnt_after, after):
    group = learnt_after._groups_[0]
    fewer = replace(group, parameters=group.parameters[:-1])
    trim = copy.copy(learnt_after.trim_)
    trim.known, trim.knots = False, np.array([0.0, 1.0])
    cases = {
        "got 'x'": "x",
        "one that has learnt nothing": ValveHistory(),
        "both histories hold these rows": learnt,
        "gives kv_rated as 25.0, and that of the history as 40.0": _with(
            learnt_after, valve_=replace(learnt_after.valve_, kv_rated=25.0)
        ),
        "gives tag as 'FV-102'": _with(learnt_after, valve_=replace(learnt_after.valve_, tag="FV-102")),
        "the list of signals": _with(learnt_after, roles_=("command", "opening", "flow")),
        "the kind of flow": _with(learnt_after, mass_flow_=True),
        "the list of known effects": _with(learnt_after, effects=(_Effect(),)),
        "the onset of a known effect": _with(learnt_after, onsets={"x": 1.0}),
        "the trim of its": _with(learnt_after, trim_=trim),
        "the list of parameters": _with(learnt_after, _groups_=(fewer, learnt_after._groups_[1])),
    }
    history = copy.deepcopy(learnt)
    for words, other in cases.items():
        with pytest.raises(InputError, match=words) as caught:
            history.merge(other)
        assert str(caught.value).isprintable()
    assert history.rows == learnt.rows
    del after


class _Effect:
    key = "mine"


def test_the_sheet_of_an_update_counts(learnt, after):
    history = copy.deepcopy(learnt)
    with pytest.raises(InputError, match=r"later\.csv: the data sheet gives fl as 0\.5"):
        history.update(of_sheet(named(after, "later"), fl=0.5))
    with pytest.raises(InputError, match=r"later\.csv: there is no opening"):
        history.update(without(named(after, "later"), "opening"))
    assert history.rows == learnt.rows


def test_an_allowance_of_ones_own_widens_what_is_expected(learnt, before):
    wide = ValveHistory(allowance=Allowance(capacity=0.05)).fit(before)
    at = learnt.prior_.names.index("capacity")
    assert wide.prior_.covariance[at, at] > 4.0 * learnt.prior_.covariance[at, at]
