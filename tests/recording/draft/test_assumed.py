# SPDX-License-Identifier: BSD-3-Clause
"""What a draft takes for granted is told for every role: as read, as guessed, or as left out."""

import numpy as np
import pytest

from sklvalve.recording.draft import Answers, assumptions, draft_valve, read_recording_columns

N = 400
TRAVEL = 50.0 + 40.0 * np.sin(np.arange(N) / 15.0)


def _told(columns, **answers):
    told = read_recording_columns({"time": np.arange(float(N))} | columns, "recording.csv")
    found = assumptions(draft_valve(told, Answers(**answers)))
    assert all(each["rows"] is None for each in found)
    return {each["role"]: (each["finding"], each["detail"]) for each in found}


def test_every_line_of_a_role_is_told_with_its_reason():
    told = _told({"FIC7.OP [%]": TRAVEL, "FIC7.PV [m3/h]": 0.3 * TRAVEL})
    assert told["command"] == (
        "assumed",
        "column 'FIC7.OP [%]' (the ending OP); unit '%' (in the name, and values from 10 to 90); "
        "sense 'opening' (correlation 1.00 with the flow)",
    )
    assert told["flow"][0] == "assumed"
    assert told["data_sheet"] == (
        "left_out",
        "no valve.toml was given: kv_rated (data sheet; without it a loss of capacity cannot be "
        "detected); characteristic (data sheet; without it, wear or a leak cannot be told from the trim's "
        "shape); the fluid is taken for water",
    )


@pytest.mark.parametrize(
    ("name", "role", "words"),
    [
        ("FIC7.PV", "flow", "unit 'm3/h' (no unit in the name"),
        ("P1", "p1", "gauge: is it above the atmosphere? (absolute without an answer)"),
    ],
)
def test_a_guess_is_called_one(name, role, words):
    kind, detail = _told({"FIC7.OP": TRAVEL, "FIC7.ZT": TRAVEL, name: 3.0 * TRAVEL})[role]
    assert kind == "guessed"
    assert words in detail


def test_what_neither_names_nor_values_tell_is_left_out():
    told = _told({"FIC7.OP": TRAVEL, "FIC7.PV": TRAVEL, "PT7": np.full(N, 8.0)})
    assert told["p1"][0] == "left_out"
    assert "before the valve (p1) or behind it (p2)?" in told["p1"][1]
    length = _told({"FIC7.OP": TRAVEL, "ZT7 [mm]": 0.3 * TRAVEL})["opening"]
    assert length == ("left_out", "it is recorded in mm: give the rated travel in [valve] travel, in mm")


def test_what_a_person_answered_is_no_question_any_more():
    told = _told({"FIC7.OP": TRAVEL, "FIC7.PV": TRAVEL}, kv_rated=25.0, units={"FIC7.PV": "t/h"})
    assert "kv_rated" not in told["data_sheet"][1]
    assert told["flow"][0] == "assumed"
