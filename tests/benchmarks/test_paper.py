# SPDX-License-Identifier: BSD-3-Clause
import json

import numpy as np
import pytest

from benchmarks.paper import __main__ as command
from benchmarks.paper import dynamic, models, static
from benchmarks.paper.law import GeneratorsLaw
from benchmarks.paper.models import BLACK_BOXES, HYBRIDS
from benchmarks.paper.runs import TRAINED
from benchmarks.paper.stem import SlewingStem
from benchmarks.paper.tables import ratios, read, tables
from benchmarks.paper.valve import MechanismAlone, SheetValve

SECONDS = (900, 600)
FLOW, WARM = "F from P1, P2, X", "F from P1, P2, X, T"


@pytest.fixture(scope="module")
def drawn():
    return static.Drawn.of("normal", 0, SECONDS)


@pytest.fixture
def few_draws(monkeypatch):
    """Searches of three draws, for speed."""
    monkeypatch.setattr(models, "DRAWS", 3)


def best(lines, names, place):
    return min(line[place]["rmse"] for line in lines if line["model"] in names)


def test_training_keeps_to_the_box_and_the_test_leaves_it(drawn):
    trained = TRAINED.holds(drawn.training)
    assert trained.mean() > 0.9  # but for noise and overshoot
    assert 0.1 < drawn.inside.mean() < 0.7
    tons = 3600.0 * drawn.measured["flow"]
    assert tons.min() >= 2.0
    assert tons.max() <= 39.6


def test_rows_are_spread_over_the_training(drawn):
    some = drawn.rows(50)["opening"]
    assert len(some) == 50
    assert some[0] == drawn.training["opening"][0]
    assert some[-1] == drawn.training["opening"][-1]
    with pytest.raises(ValueError, match="holds no 5000 to train on"):
        drawn.rows(5000)


def test_generators_law_is_exact_without_noise(drawn):
    for name, most in ((WARM, 1e-3), ("P2 from P1, F, X, T", 0.05)):
        task = static.TASKS[name]
        X, y = task.table(drawn.clean)
        predicted = GeneratorsLaw(drawn.clean, task).predict(X)
        assert static.errors(y, predicted, task.per_unit)["rmse"] < most


def test_mechanism_counts_tons_and_inverts(drawn):
    X = np.array([[3.5e6, 2.6e6, 1.0, 333.15]])
    valve = SheetValve(static.TASKS[WARM].inputs).fit(X)
    # Kv 120 at 9 bar and 983.2 kg/m3: 120 sqrt(9 * 983.2 / 1000) t/h, by the standard's 999.1 kg/m3
    assert 3600.0 * valve.forward(X, np.array([120.0]))[0] == pytest.approx(357.0, rel=2e-3)
    X, flow = static.TASKS[WARM].table(drawn.training)
    np.testing.assert_allclose(valve.forward(X, valve.invert(X, flow)), flow, rtol=1e-12)
    X, p2 = static.TASKS["P2 from P1, F, X"].table(drawn.training)
    behind = SheetValve(static.TASKS["P2 from P1, F, X"].inputs, "outlet_pressure").fit(X)
    np.testing.assert_allclose(behind.forward(X, behind.invert(X, p2)), p2, rtol=1e-12)


def test_mechanism_alone_has_one_capacity(drawn):
    X, y = static.TASKS[FLOW].table(drawn.training)
    model = MechanismAlone(SheetValve(static.TASKS[FLOW].inputs)).fit(X, y)
    asked = model.mechanism_.invert(X, y)
    assert model.parameter_ == np.median(asked)
    assert static.errors(y, model.predict(X), 3600.0)["mape"] < 30.0


@pytest.mark.slow
def test_physics_pays_outside_the_box(few_draws):
    lines = static.lines_of("normal", FLOW, 50, 0, SECONDS)
    assert [line["model"] for line in lines] == ["mechanism", *HYBRIDS, *BLACK_BOXES, static.LAW]
    ratio = best(lines, HYBRIDS, "measured outside") / best(lines, BLACK_BOXES, "measured outside")
    assert ratio < 0.7
    # inside, noise of the signals is most of what is left, for the law that made them as well
    floor = best(lines, [static.LAW], "measured inside")
    assert 0.7 * floor < best(lines, HYBRIDS, "measured inside") < 1.6 * floor
    assert all(line[place]["lost"] == 0 for line in lines for place in ("measured inside", "clean outside"))


@pytest.mark.slow
def test_stem_learns_its_speed_in_the_difference_equation(few_draws):
    lines = dynamic.lines_of(60, 0, (900, 400))
    free = [line for line in lines if line["task"] == "X in free run"]
    place = "measured outside"
    assert best(free, HYBRIDS, place) < 0.7 * best(free, BLACK_BOXES, place)
    assert best(free, HYBRIDS, place) < 5.0  # % of travel


def test_stem_that_arrives_tells_no_speed():
    stem = SlewingStem()
    X = dynamic.columns(np.array([0.2, 0.2, 0.5]), np.array([0.6, 0.21, 0.2]), np.array([0.6, 0.21, 0.5]))
    now = stem.forward(X, np.array([0.1, 0.1, 0.12]))
    np.testing.assert_allclose(now, [0.3, 0.21, 0.38])
    np.testing.assert_allclose(stem.invert(X, now), [0.1, np.nan, 0.12])


def test_free_run_starts_at_what_is_measured_and_goes_by_itself():
    opening, command = np.linspace(0.2, 0.8, 140), np.full(140, 0.5)
    free = dynamic.free_run(lambda X: X[:, 0] + 0.001, opening, command)
    assert np.isnan(free[:2]).all()
    np.testing.assert_allclose(free[2:62], opening[1] + 0.001 * np.arange(1, 61))
    np.testing.assert_allclose(free[62], opening[61] + 0.001)


def made(model, seed, rmse, left_out):
    score = {"rmse": rmse, "mape": 1.0, "err_max": 2.0}
    where = {"scenario": "normal", "task": FLOW, "rows": 50, "seed": seed, "unit": "t/h"}
    return where | {"model": model, "left_out": left_out, "measured inside": score}


def test_tables_hold_best_against_best():
    lines = [made("mechanism", 0, 9.0, None)]
    lines += [made(name, 0, rmse, 1.0 / rmse) for name, rmse in zip(HYBRIDS, (1.0, 2.0, 4.0), strict=True)]
    lines += [made(name, 0, rmse, 1.0 / rmse) for name, rmse in zip(BLACK_BOXES, range(2, 7), strict=True)]
    scores = {line["model"]: {0: line["measured inside"]["rmse"]} for line in lines}
    assert ratios(scores) == pytest.approx([0.5])
    left_out = {line["model"]: {0: line["left_out"]} for line in lines}
    assert ratios(scores, left_out) == pytest.approx([4.0 / 6.0])
    text = tables(lines)
    assert "| normal | F from P1, P2, X | 50 | 0.50, 1 of 1 |  |  |  | 0.67, 1 of 1 |  |" in text


def test_a_stopped_run_goes_on(tmp_path, monkeypatch):
    asked = []

    def lines_of(scenario, task, rows, seed):
        asked.append(rows)
        return [made("series", seed, 1.0, 1.0)]

    monkeypatch.setattr(command.static, "lines_of", lines_of)
    wanted = [("normal", FLOW, rows, 0) for rows in (50, 200)]
    file = command.measure(tmp_path, wanted[:1], report=lambda text: None)
    with file.open("a") as out:
        out.write('{"cell": ["normal", "F fr')
    command.measure(tmp_path, wanted, report=lambda text: None)
    assert asked == [50, 200]
    assert [json.loads(line)["cell"][2] for line in file.read_text().splitlines()] == [50, 200]
    assert len(read(file)) == 2


def test_a_run_that_was_stopped_within_its_first_line_goes_on(tmp_path, monkeypatch):
    monkeypatch.setattr(command.static, "lines_of", lambda *cell: [made("series", cell[3], 1.0, 1.0)])
    (tmp_path / "results.jsonl").write_text('{"cell": ["normal", "F fr')
    file = command.measure(tmp_path, [("normal", FLOW, 50, 0)], report=lambda text: None)
    assert len(read(file)) == 1
    assert len(file.read_text().splitlines()) == 1


def test_quick_leaves_the_long_fits_out():
    assert {cell[2] for cell in command.cells(range(1), quick=True)} == {50, 200}
    assert 1500 in {cell[2] for cell in command.cells(range(1))}
