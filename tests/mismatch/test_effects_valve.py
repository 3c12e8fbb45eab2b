# SPDX-License-Identifier: BSD-3-Clause
"""Effects of trim and fluid against computations of their own, by hand or from the definition."""

from types import SimpleNamespace

import numpy as np
import pytest

from sklvalve.mechanism import fluid_from, liquid_flow
from sklvalve.simulation import Tolerance

from .hand_chain import BY_KEY, Signals, apply, chain_of

KV_TO_SI = 1.0 / 3600.0 / np.sqrt(1e5 / 1000.0)  # by definition: 1 m3/h at 1 bar and 1000 kg/m3


def test_wear_adds_capacity_that_fades():
    chain = chain_of(3, plug=np.array([0.0, 0.1, 1.0]))
    made = apply("erosion", [0.0, 1.0, 10.0], {"wear_kv": 0.5, "reach": 0.1}, chain)
    np.testing.assert_allclose(made, [0.5, 1.0 + 0.5 / np.e, 10.0 + 0.5 * np.exp(-10.0)], rtol=1e-12)


def test_deposits_grow_from_their_onset_and_never_block_all():
    effect = BY_KEY["sedimentation"]
    clock = 1e9 + np.array([0.0, 1800.0, 3600.0, 5400.0, 360_000.0])
    chain = chain_of(clock=clock, onsets={effect.key: 1e9 + 1800.0})
    made = effect.apply(np.full(5, 8.0), {"rate": 0.1}, chain)
    np.testing.assert_allclose(made, [8.0, 8.0, 7.6, 7.2, 1.6], rtol=1e-9)
    without = effect.apply(np.full(5, 8.0), {"rate": 0.1}, chain_of(clock=clock))
    np.testing.assert_allclose(without[:4], [8.0, 7.6, 7.2, 6.8], rtol=1e-9)
    # the steepest that is possible ends at four fifths, whenever it began
    for one in (chain, chain_of(clock=clock)):
        (rate,) = effect.quantities(one)
        assert effect.apply(np.ones(5), {"rate": rate.high}, one)[-1] == pytest.approx(0.2, rel=1e-9)


def test_leak_to_the_outside_is_that_of_a_hole():
    chain = chain_of(p1=np.array([101_325.0, 201_325.0, 501_325.0, 5e4, 2e5]))
    lost = apply("external_leakage", np.zeros(5), {"leak_kv": 2.0}, chain)
    # 2 m3/h at 1 bar, twice that at 4 bar, nothing into a vacuum
    np.testing.assert_allclose(lost[:4] * 3600.0, [0.0, 2.0, 4.0, 0.0], rtol=5e-4, atol=1e-12)
    gone = apply("external_leakage_outlet", np.full(5, 0.02), {"leak_kv": 2.0}, chain_of())
    expected = 0.02 - 2.0 * KV_TO_SI * np.sqrt(298_675.0 / 1000.0)
    np.testing.assert_allclose(gone, expected, rtol=5e-4)
    heavy = chain_of(density=np.full(5, 900.0))
    heavy.recording.mass_flow = True
    by_mass = apply("external_leakage_outlet", np.full(5, 18.0), {"leak_kv": 2.0}, heavy)
    np.testing.assert_allclose(by_mass, 18.0 - 900.0 * 2.0 * KV_TO_SI * np.sqrt(298_675.0 / 900.0), rtol=5e-4)


def test_a_leak_at_one_pressure_is_no_case_for_a_leak():
    assert not BY_KEY["external_leakage"].possible(chain_of())
    assert BY_KEY["external_leakage"].possible(chain_of(p1=np.linspace(5e5, 7e5, 5)))
    assert not BY_KEY["external_leakage_outlet"].possible(chain_of(p2=np.full(5, 8e4)))


def test_cavitation_takes_capacity_beyond_its_pressure_ratio():
    vapour = np.full(5, 1e5)
    chain = chain_of(p1=np.full(5, 1.1e6), p2=1.1e6 - np.array([2e5, 4e5, 7e5, 1e6, 1.05e6]), vapour=vapour)
    made = apply("cavitation", np.ones(5), {"loss": 0.2, "begins": 0.4}, chain)
    np.testing.assert_allclose(made, [1.0, 1.0, 0.9, 0.8, 0.8], rtol=1e-9)
    assert BY_KEY["cavitation"].possible(chain)
    assert not BY_KEY["cavitation"].possible(chain_of(vapour=None))
    assert not BY_KEY["cavitation"].possible(chain_of(p2=np.full(5, 5.5e5), vapour=vapour))


def test_flashing_swells_what_the_meter_counts():
    chain = chain_of(p2=np.array([2e5, 1e5, 8e4, 5e4, 0.0]), vapour=np.full(5, 1e5))
    made = apply("flashing", np.full(5, 2.0), {"swelling": 3.0}, chain)
    np.testing.assert_allclose(made, [2.0, 2.0, 3.2, 5.0, 8.0], rtol=1e-9)
    assert BY_KEY["flashing"].possible(chain)
    assert not BY_KEY["flashing"].possible(chain_of(vapour=np.full(5, 1e5)))
    assert not BY_KEY["flashing"].possible(chain_of(vapour=None))


@pytest.mark.parametrize("size", [None, 0.05])
def test_viscous_flow_lies_near_the_standard(size):
    """Below its kink where laminar and transitional flow meet, and on it at both ends."""
    kv = np.geomspace(0.01, 10.0, 60)
    drop = np.geomspace(1e3, 3e5, 60)
    sheet = SimpleNamespace(fl=0.9, fd=0.42, nominal_size=size, inlet_pipe=None, fluid={})
    trim = SimpleNamespace(rated=40.0, known=True)
    chain = chain_of(60, p1=4e5 + drop, p2=np.full(60, 4e5), valve=sheet, trim=trim)
    for viscosity in (1e-6, 1e-5, 1e-4, 1e-3, 1e-1):
        share = apply("viscous_flow", kv, {"viscosity": viscosity, "sharpness": 2.0}, chain) / kv
        assert np.all((share > 0.0) & (share <= 1.0))
        if size is not None:
            pipe = {"fl": 0.9, "fd": 0.42, "nominal_size": size, "kv_rated": 40.0, "warn": False}
            flow = liquid_flow(kv, chain.p1, chain.p2, 1000.0, viscosity=viscosity, **pipe)
            expected = flow / (kv * KV_TO_SI * np.sqrt(drop / 1000.0))
            # three tenths where its laws meet in a kink, and nearly laminar flow as it has it
            near = np.where(expected < 1e-2, 0.03, 0.3)
            assert np.all(np.abs(share / expected - 1.0) < near)


def test_losses_of_laminar_and_turbulent_flow_add_up_with_a_sharpness_of_two():
    chain = chain_of(3, p1=4e5 + np.array([1e3, 1e4, 1e5]), p2=np.full(3, 4e5))
    flow = apply("viscous_flow", np.full(3, 0.5), {"viscosity": 2e-4, "sharpness": 2.0}, chain) * np.sqrt(
        chain.dp
    )
    # drop = a Q + b Q^2, through three points
    linear = chain.dp / flow
    slopes = np.diff(linear) / np.diff(flow)
    assert slopes[0] == pytest.approx(slopes[1], rel=1e-9)
    assert slopes[0] > 0.0


def test_far_below_turbulence_flow_is_proportional_to_drop_over_viscosity():
    chain = chain_of(3, p1=4e5 + np.array([1e3, 2e3, 2e3]), p2=np.full(3, 4e5))
    made = apply("viscous_flow", np.full(3, 0.1), {"viscosity": 5e-3, "sharpness": 2.0}, chain) * np.sqrt(
        chain.dp
    )
    assert made[1] / made[0] == pytest.approx(2.0, rel=1e-3)
    thicker = apply("viscous_flow", np.full(3, 0.1), {"viscosity": 1e-2, "sharpness": 2.0}, chain) * np.sqrt(
        chain.dp
    )
    np.testing.assert_allclose(thicker, 0.5 * made, rtol=1e-3)
    # nothing flows, nothing is lost
    still = chain_of(2, p1=np.full(2, 4e5), p2=np.full(2, 4e5))
    np.testing.assert_array_equal(
        apply("viscous_flow", [0.0, 3.0], {"viscosity": 1e-3, "sharpness": 2.0}, still), [0.0, 3.0]
    )


def test_viscosity_follows_the_fluid_or_its_own_law():
    warm = np.array([293.15, 333.15])
    water = chain_of(2, p1=np.full(2, 4.01e5), temperature=warm, fluid=fluid_from("water"))
    law = water.fluid.kinematic_viscosity(warm)
    by_fluid = apply("viscous_flow", [1.0, 1.0], {"viscosity": 1e-3, "sharpness": 2.0}, water)
    # an exponential through the same two viscosities
    fall = np.log(law[0] / law[1]) / 40.0
    by_law = apply("viscosity_change", [1.0, 1.0], {"viscosity": 1e-3, "fall": fall, "sharpness": 2.0}, water)
    np.testing.assert_allclose(by_fluid, by_law, rtol=1e-6)
    assert by_fluid[1] > 1.2 * by_fluid[0]
    constant = apply(
        "viscous_flow", [1.0, 1.0], {"viscosity": 1e-3, "sharpness": 2.0}, chain_of(2, p1=np.full(2, 4.01e5))
    )
    assert constant[0] == constant[1]


def test_a_gas_expands_as_the_standard_has_it():
    p1, xt, gamma = 1e6, 0.7, 1.3
    x = np.array([0.0, 0.1, 0.65, 0.8, 0.3])
    sheet = SimpleNamespace(fluid={"molar_mass": 0.017, "heat_capacity_ratio": gamma})
    chain = chain_of(p1=np.full(5, p1), p2=p1 * (1.0 - x), valve=sheet)
    made = apply("gas_expansion", np.ones(5), {"xt": xt}, chain) * np.sqrt(x)
    limit = 0.65  # 1.3 / 1.4 * 0.7
    expansion = np.array([1.0, 1.0 - 0.1 / (3 * limit), 2.0 / 3.0, 2.0 / 3.0, 1.0 - 0.3 / (3 * limit)])
    np.testing.assert_allclose(made, expansion * np.sqrt(np.minimum(x, limit)), rtol=1e-9)
    assert BY_KEY["gas_expansion"].possible(chain)
    assert not BY_KEY["gas_expansion"].possible(chain_of())
    assert BY_KEY["gas_expansion"].requires == "a gas"


def test_density_acts_by_its_root_on_volume_and_on_mass():
    np.testing.assert_allclose(apply("density_change", [3.0] * 5, {"ratio": 1.44}, chain_of()), 2.5)
    mass = chain_of()
    mass.recording.mass_flow = True
    np.testing.assert_allclose(apply("density_change", [3.0] * 5, {"ratio": 1.44}, mass), 3.6)
    warm = chain_of(temperature=np.array([293.15, 313.15, 343.15, 293.15, 293.15]))
    made = apply("density_change_thermal", np.ones(5), {"expansion": 0.002}, warm)
    np.testing.assert_allclose(made, np.exp([0.0, 0.02, 0.05, 0.0, 0.0]), rtol=1e-12)


def test_density_within_the_tolerance_of_capacity_is_calibration():
    effect = BY_KEY["density_change"]
    beyond = [effect.beyond_tolerance({"ratio": r}, chain_of(), Tolerance(), False) for r in (0.6, 1.1, 1.3)]
    assert beyond == [True, False, True]
    assert effect.beyond_tolerance({"ratio": 1.1}, chain_of(), Tolerance(), True)


@pytest.mark.parametrize("key", ["density_change_thermal", "viscosity_change"])
def test_what_hangs_on_temperature_needs_one_that_varies(key):
    effect, cold = BY_KEY[key], np.linspace(290.0, 290.5, 5)
    assert "temperature" in effect.needs
    signals = Signals(flow=np.ones(5), temperature=cold)
    assert not effect.possible(chain_of(temperature=cold, recording=signals))
    assert not effect.possible(chain_of(temperature=cold + 10.0 * np.arange(5)))
    warm = Signals(flow=np.ones(5), temperature=cold + 10.0 * np.arange(5))
    assert effect.possible(chain_of(temperature=warm["temperature"], recording=warm))


def test_something_between_plug_and_seat_stops_the_stem():
    made = apply("clogging_closing", [0.0, 0.2, 0.6, 1.0, np.nan], {"limit": 0.25}, chain_of())
    np.testing.assert_array_equal(made, [0.25, 0.25, 0.6, 1.0, np.nan])
