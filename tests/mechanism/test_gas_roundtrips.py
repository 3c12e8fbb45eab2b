# SPDX-License-Identifier: BSD-3-Clause
"""Gas both ways: what one direction gives the other takes back, over 100 000 random duties of each kind."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from sklvalve.mechanism import (
    choked_drop_ratio,
    gas_flow,
    gas_inlet_pressure,
    gas_kv,
    gas_outlet_pressure,
)
from tests.mechanism.gas_duties import KINDS, duties

N = 100_000
EXACT = 1e-9


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("forward", [True, False], ids=["forward", "backward"])
def test_capacity(kind, forward):
    (kv, p1, p2, *gas), known = duties(kind, N, seed=1)
    p1, p2 = (p1, p2) if forward else (p2, p1)
    flow = gas_flow(kv, p1, p2, *gas, **known)
    assert np.all((flow > 0.0) == forward)
    assert_allclose(gas_kv(flow, p1, p2, *gas, **known), kv, rtol=EXACT)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("forward", [True, False], ids=["forward", "backward"])
def test_pressure_behind(kind, forward):
    # where the pressure behind is sought, whichever of the two it is
    (kv, p1, p2, *gas), known = duties(kind, N, seed=2)
    if forward:
        flow = gas_flow(kv, p1, p2, *gas, **known)
        found = gas_outlet_pressure(flow, kv, p1, *gas, warn=False, **known)
        again = gas_flow(kv, p1, found, *gas, **known)
    else:
        flow = gas_flow(kv, p2, p1, *gas, **known)
        found = gas_inlet_pressure(flow, kv, p1, *gas, warn=False, **known)
        again = gas_flow(kv, found, p1, *gas, **known)
    lost = np.isnan(found)
    assert_allclose(again[~lost], flow[~lost], rtol=EXACT)
    # nothing is lost but what is choked: there a lower pressure passes the same
    vacuum = (0.0, p1) if not forward else (p1, 0.0)
    assert_allclose(flow[lost], gas_flow(kv, *vacuum, *gas, **known)[lost], rtol=1e-12)
    assert 0.0 < np.mean(lost) < 0.2


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("forward", [True, False], ids=["forward", "backward"])
def test_pressure_before(kind, forward):
    # defined in choked flow too, and well conditioned but at a small drop
    (kv, p1, p2, *gas), known = duties(kind, N, seed=3)
    if forward:
        flow = gas_flow(kv, p1, p2, *gas, **known)
        found = gas_inlet_pressure(flow, kv, p2, *gas, **known)
        again = gas_flow(kv, found, p2, *gas, **known)
    else:
        flow = gas_flow(kv, p2, p1, *gas, **known)
        found = gas_outlet_pressure(flow, kv, p2, *gas, **known)
        again = gas_flow(kv, p2, found, *gas, **known)
    assert_allclose(again, flow, rtol=EXACT)
    assert_allclose(found, p1, rtol=EXACT)


@pytest.mark.parametrize("basis", ["actual", "normal", "standard"])
@pytest.mark.parametrize("kind", ["plain", "reducers"])
def test_every_basis(basis, kind):
    (kv, p1, p2, *gas), known = duties(kind, N, seed=4)
    known["basis"] = basis
    flow = gas_flow(kv, p1, p2, *gas, **known)
    assert_allclose(gas_kv(flow, p1, p2, *gas, **known), kv, rtol=EXACT)
    p2_found = gas_outlet_pressure(flow, kv, p1, *gas, warn=False, **known)
    passed = ~np.isnan(p2_found)
    assert_allclose(gas_flow(kv, p1, p2_found, *gas, **known)[passed], flow[passed], rtol=EXACT)
    p1_found = gas_inlet_pressure(flow, kv, p2, *gas, warn=False, **known)
    # a volume at the inlet does not say which pressure chokes it
    there = passed if basis == "actual" else np.full(N, True)
    assert np.all(~np.isnan(p1_found) == there)
    assert_allclose(p1_found[there], p1[there], rtol=EXACT)


def test_onset_of_choking_bounds_the_outlet_pressures():
    (kv, p1, p2, *gas), known = duties("plain", N, seed=5)
    found = gas_outlet_pressure(gas_flow(kv, p1, p2, *gas, **known), kv, p1, *gas, warn=False, **known)
    choked = p2 <= p1 * (1.0 - choked_drop_ratio(known["gamma"], known["xt"]))
    assert np.all(np.isnan(found[choked]))
    clear = p2 > p1 * (1.0 - (1.0 - 1e-6) * choked_drop_ratio(known["gamma"], known["xt"]))
    assert not np.any(np.isnan(found[clear]))


@pytest.mark.parametrize("kind", ["viscous", "viscous reducers"])
def test_capacity_without_the_rated_one(kind):
    # the kind of trim then depends on the answer: others may pass the same flow, a few are not found
    (kv, p1, p2, *gas), known = duties(kind, N, seed=6, rated=False)
    flow = gas_flow(kv, p1, p2, *gas, **known)
    found = gas_kv(flow, p1, p2, *gas, warn=False, **known)
    there = ~np.isnan(found)
    assert np.mean(there) > 0.99
    again = gas_flow(found, p1, p2, *gas, **known)
    assert_allclose(again[there], flow[there], rtol=EXACT)
