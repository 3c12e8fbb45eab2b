# SPDX-License-Identifier: BSD-3-Clause
"""Effects inside the sheet's tolerance: drawn alike, small and large enough; tables of both methods."""

import json

import pytest

from benchmarks.concealed import within
from benchmarks.concealed.plant import EFFECTS, Plant
from benchmarks.concealed.report.with_history import with_history_report
from benchmarks.concealed.report.within import within_report
from benchmarks.concealed.within import INSIDE, case_of, made_inside, main
from sklvalve.simulation import Tolerance


def test_what_a_sheet_leaves_open_is_that_of_the_package():
    own = (within.CAPACITY, within.TRIM, within.RECOVERY, within.RESPONSE, within.STATIC, within.FLOW_ZERO)
    sheet = Tolerance()
    assert own == (
        sheet.capacity,
        sheet.trim,
        sheet.recovery,
        sheet.response,
        sheet.static_error,
        sheet.flow_zero,
    )
    assert sheet.opening_effect == sheet.flow_effect == within.COUNTS
    assert max(INSIDE[name].high for name in ("sensor_bias", "loop_bias")) < sheet.position_zero


def test_every_effect_comes_up_and_cases_are_drawn_again_alike():
    cases = [case_of(7, k) for k in range(2 * len(INSIDE))]
    assert cases == [case_of(7, k) for k in range(2 * len(INSIDE))]
    names = [case.effects[0] for case in cases]
    assert sorted(names[: len(INSIDE)]) == sorted(names[len(INSIDE) :]) == sorted(INSIDE)
    assert all(case.excitation in INSIDE[case.effects[0]].asks for case in cases)
    assert all(EFFECTS[name].told for name in INSIDE)


@pytest.mark.parametrize("name", ["capacity_error", "choked_flow", "meter_zero"])
def test_the_valve_with_the_effect_is_one_that_its_sheet_allows(name):
    case = next(case for k in range(100) if (case := case_of(7, k)).effects == (name,))
    made = made_inside(case, 7)
    size, plant = made.truth["strengths"][name], made.plant
    assert INSIDE[name].low <= abs(size) <= INSIDE[name].high
    assert made.truth["moved_share"] >= 0.0075
    if name == "capacity_error":
        assert plant.trim[-1] * (1.0 + size) == pytest.approx(plant.sheet["kv_rated"], rel=0.1)
    if name == "meter_zero":
        assert abs(plant.sound["meter_bias"] / plant.span + size) <= 0.005
    # there from the first row on, and not in the history
    assert made.truth["onset"] == 0.0
    assert made.truth["history"]["clean"]
    assert made.truth["history"]["allowed_change"] is None
    assert list(made.history) == list(made.table)
    # a valve that is known tells more than what its sheet leaves open
    assert made.truth["known_distance"] > max(made.truth["distances"]["nothing"], 25.0)


def test_a_plant_that_has_used_its_tolerance_has_no_room():
    fits = INSIDE["meter_gain"].fits
    plant = Plant(0, "wide", 60, 0)
    own = plant.trim[-1] / plant.sheet["kv_rated"]
    assert fits(plant, 1.0 / own - 1.0)
    assert not fits(plant, 1.2 / own - 1.0)


def test_records_are_drawn_once_and_judged_by_both(tmp_path, monkeypatch, capsys):
    def judged(folder, names, jobs):
        files = []
        for name in names:
            file = folder / f"scores_{name}.jsonl"
            lines = []
            for place in sorted(folder.glob("record_*")):
                truth = json.loads((place / "truth.json").read_text())
                told = [{"members": [{"name": truth["effects"][0], "probability": 0.9}]}]
                found = (
                    {"verdict": "named", "effects": told} if "history" in name else {"verdict": "no_mismatch"}
                )
                lines.append({"record": place.name, "method": name, "found": found, "truth": truth})
            file.write_text("".join(json.dumps(line) + "\n" for line in lines))
            files.append(file)
        return files

    monkeypatch.setattr(within, "judge_all", judged)
    assert main([str(tmp_path), "--seed", "7", "--records", "2"]) == 0
    text = capsys.readouterr().out
    assert text.count("written") == 2
    assert "### sklvalve_history" in text
    assert "| noticed | 0 of 2, 0 % (0-84) | 2 of 2, 100 % (16-100) | 0 | 2 | 0.50 |" in text
    assert main([str(tmp_path), "--seed", "7", "--records", "2"]) == 0
    assert "written" not in capsys.readouterr().out
    assert (tmp_path / "seal.txt").exists()


def _line(record, method, verdict, *classes, history, **truth):
    told = {"kind": "single", "effects": ["stiction"], "concealed": ["stiction"], "excitation": "wide"}
    return {
        "record": record,
        "method": method,
        "found": {
            "verdict": verdict,
            "effects": [{"members": [{"name": n} for n in names]} for names in classes],
            "mismatch": {"p_value": 0.3},
        },
        "truth": told | truth | {"history": history},
    }


CLEAN = {"clean": True, "holds": None, "allowed_change": None, "excitation": "wide"}
OTHER = CLEAN | {"excitation": "closed"}


def test_a_class_of_four_is_no_name():
    apart = {"known_distance": 900.0, "distances": {"nothing": 6.0}}
    long = ["stiction", "friction", "backlash", "presliding"]
    lines = [
        _line("a", "sklvalve", "named", long, history=CLEAN, moved_share=0.01, **apart),
        _line("b", "sklvalve", "named", long[:3], history=CLEAN, moved_share=0.03, **apart),
        _line("c", "sklvalve", "named", ["dead_time"], history=OTHER, moved_share=0.02, **apart),
    ]
    text = within_report(lines)
    assert "| all | 3 | 100 % (29-100) | 33 % (1-91) | 33 % (1-91) | 0 |" in text
    assert "| stiction | 3 | 2.00 % | 6 | 900 |" in text
    assert "| sheet leaves it open (D below 25) | 3 | 100 % (29-100) |" in text
    assert "history excited in another way | 1 |" in text


def test_both_judgements_are_told_by_size_and_by_history():
    healthy = {"kind": "healthy", "effects": [], "concealed": []}
    season = CLEAN | {"allowed_change": {"change": "season", "by": 12.0, "unit": "K"}}
    without = [
        _line("a", "sklvalve", "no_mismatch", history=CLEAN, size_step=1.0, distinguishable=True),
        _line("b", "sklvalve", "no_mismatch", history=season, **healthy),
    ]
    with_ = [
        _line(
            "a", "sklvalve_history", "named", ["stiction"], history=CLEAN, size_step=1.0, distinguishable=True
        ),
        _line("b", "sklvalve_history", "cannot_tell", history=season, **healthy),
    ]
    text = with_history_report(without, with_)
    for label in (
        "one effect noticed, 1 times the detectable size",
        "class right, distinguishable by the generator",
        "- by an allowed change alone",
        "season",
    ):
        assert f"| {label} | 0 of 1, 0 % (0-98) | 1 of 1, 100 % (2-100) | 0 | 1 |" in text
    assert "| without | D 0.70" in text
    assert "two effects" not in text
