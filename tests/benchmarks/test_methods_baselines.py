# SPDX-License-Identifier: BSD-3-Clause
import json
from unittest.mock import patch

import numpy as np
import pytest

from benchmarks.concealed.methods import no_noise_model, ours, public, sparse_regression, stepwise_bic
from benchmarks.concealed.methods.nominal import nominal_of
from sklvalve.simulation import noise_of_pieces
from sklvalve.simulation.noise_fit import fit_noise
from tests.benchmarks.methods_records import made, names, without

BASELINES = (stepwise_bic.diagnose, sparse_regression.diagnose)


def check_layout(found, recording):
    told = json.loads(json.dumps(public(found)))
    assert told["verdict"] in ("no_mismatch", "named", "cannot_tell", "none_of_these")
    assert told["mismatch"]["detected"] == (told["verdict"] != "no_mismatch")
    assert 0.0 < told["mismatch"]["p_value"] <= 1.0
    for effect in told["effects"]:
        assert 0.0 < effect["probability"] <= 1.0
        assert all(0.0 < m["probability"] <= 1.0 for m in effect["members"])
        assert effect["blocks"]
    if not told["mismatch"]["detected"]:
        assert told["effects"] == []
    for begin, end in told["location"]["intervals"]:
        assert 0.0 <= begin <= end <= recording.time[-1] - recording.time[0]


@pytest.mark.slow
@pytest.mark.parametrize("diagnose", BASELINES)
@pytest.mark.parametrize(
    ("effect", "strength"), [("sensor_lag", 20.0), ("dead_time", 12.0), ("backlash", 0.06)]
)
def test_large_effects_are_named(diagnose, effect, strength):
    recording = made(effect, strength)
    found = diagnose(recording)
    check_layout(found, recording)
    assert found["verdict"] == "named"
    assert any(effect in each for each in names(found))


@pytest.mark.parametrize("diagnose", BASELINES)
def test_a_healthy_record_stays_unnamed(diagnose):
    recording = made()
    found = diagnose(recording)
    check_layout(found, recording)
    assert found["verdict"] == "no_mismatch"


@pytest.mark.slow
@pytest.mark.parametrize("roles", [("opening",), ("p1", "p2"), ("command",)])
@pytest.mark.parametrize("diagnose", BASELINES)
def test_missing_signals_are_no_obstacle(diagnose, roles):
    recording = without(made("sensor_lag", 20.0), *roles)
    check_layout(diagnose(recording), recording)


@pytest.mark.slow
def test_gaps_count_for_nothing():
    recording = made("dead_time", 12.0)
    signals = {role: values.copy() for role, values in recording.signals.items()}
    signals["flow"][200:260] = np.nan
    signals["opening"][600:640] = np.nan
    gapped = recording.__class__(recording.time, recording.stamps, signals, recording.valve)
    assert any("dead_time" in each for each in names(sparse_regression.diagnose(gapped)))
    assert any("dead_time" in each for each in names(stepwise_bic.diagnose(gapped)))


@pytest.mark.slow
def test_a_baseline_does_not_depend_on_what_ran_before():
    recording = made("dead_time", 12.0)
    first = public(sparse_regression.diagnose(recording))
    stepwise_bic.diagnose(recording)
    assert public(sparse_regression.diagnose(recording)) == first
    assert nominal_of(recording) is nominal_of(recording)


def test_what_stepwise_names_lowers_the_error():
    recording = made("sensor_lag", 20.0)
    found = stepwise_bic.diagnose(recording)
    left = [
        np.mean((recording["flow"] - found[s](recording)["flow"]) ** 2)
        for s in ("simulate", "simulate_nominal")
    ]
    assert left[0] < left[1]


def test_without_the_practical_size_stepwise_tells_no_less():
    found = stepwise_bic.diagnose(made(), practical=False, most=1)
    assert len(found["effects"]) == 1


def test_names_that_bic_cannot_tell_apart_are_told_together():
    found = stepwise_bic.diagnose(made("seat_leakage", 0.06))
    assert {"seat_leakage", "bypass_open"} <= names(found)[0]


def test_white_noise_takes_every_row_alike():
    rng = np.random.default_rng(0)
    residuals = 0.02 * np.cumsum(rng.standard_normal(400))
    residuals[7] = np.nan
    noise = no_noise_model.white_noise(residuals, np.ones(400), np.ones(400), inadequacy=1.0, cautious=True)
    size = np.sqrt(np.nanmean(residuals**2))
    expected = np.nan_to_num(residuals / size)
    assert noise.whiten(residuals) == pytest.approx(expected, abs=1e-12)
    assert noise.total == pytest.approx(size, rel=1e-12)
    # where there is no residual at all, the resolution of the signal remains
    still = no_noise_model.white_noise(np.zeros(50), np.ones(50), np.ones(50), quantum=0.12)
    assert still.total == pytest.approx(0.12 / np.sqrt(12.0), rel=1e-12)


def test_the_noise_model_is_replaced_for_the_diagnosis_only():
    seen = []
    with patch.object(ours, "diagnose", lambda *a, **k: seen.append(noise_of_pieces.fit_noise)):
        no_noise_model.diagnose(None)
    assert seen == [no_noise_model.white_noise]
    assert noise_of_pieces.fit_noise is fit_noise


@pytest.mark.slow
def test_the_finder_brings_simulations_and_rows():
    recording = made("sensor_lag", 20.0)
    found = no_noise_model.diagnose(recording, effects=["sensor_lag", "seat_leakage"])
    check_layout(found, recording)
    assert found["verdict"] == "named"
    assert "sensor_lag" in names(found)[0]
    left = [
        np.mean((recording["flow"] - found[s](recording)["flow"]) ** 2)
        for s in ("simulate", "simulate_nominal")
    ]
    assert left[0] < left[1]
    assert found["flagged"].shape == found["boxes"].shape == recording.time.shape
    assert found["flagged"].any()
    assert found["boxes"].any()
