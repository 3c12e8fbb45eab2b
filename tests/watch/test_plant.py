# SPDX-License-Identifier: BSD-3-Clause
"""plant.toml: what it says, and one sentence for what it must not."""

import datetime as dt

import pytest

from sklvalve.recording import InputError
from sklvalve.watch.plant import Commissioning, read_plant

SHEET = '[valve]\nkv_rated = 40.0\n[recording]\ntime = "t"\n[recording.flow]\ncolumn = "F"\nunit = "m3/h"\n'


@pytest.fixture
def written(tmp_path):
    (tmp_path / "a.toml").write_text(SHEET)

    def write(text):
        file = tmp_path / "plant.toml"
        file.write_text(text)
        return file

    return write


def test_a_plant_is_read(written):
    plant = read_plant(
        written(
            'name = "North"\nfalse_calls = 0.1\n[commissioning]\ndays = 20\n'
            '[valve.FV-1]\nsheet = "a.toml"\n'
            '[valve.FV-2]\nsheet = "a.toml"\ndata = "two/rows"\n'
            "commissioning = {from = 2026-01-05, until = 2026-01-30}\n"
        )
    )
    assert (plant.name, plant.false_calls) == ("North", 0.1)
    one, two = plant.valves
    assert (one.tag, one.folder, one.commissioning) == ("FV-1", "FV-1", Commissioning(20))
    assert two.folder == "two/rows"
    assert two.commissioning.first == dt.date(2026, 1, 5)
    assert one.valve is two.valve


def test_the_plant_is_called_by_its_folder_unless_named(written):
    file = written('[valve.FV-1]\nsheet = "a.toml"\n')
    assert read_plant(file).name == file.parent.name


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "no valve is named"),
        ('valve = "FV-1"\n', "no valve is named"),
        ('valves = 1\n[valve.A]\nsheet = "a.toml"\n', "knows no key 'valves'; did you mean 'valve'"),
        ('[valve."../A"]\nsheet = "a.toml"\n', "no tag that a folder can be named by"),
        ('[valve."A."]\nsheet = "a.toml"\n', "no tag that a folder can be named by"),
        ("[valve]\nA = 1\n", "must be a section"),
        ("[valve.A]\n", "has no sheet"),
        ("[valve.A]\nsheet = 3\n", "sheet must be a path in quotes; got 3"),
        ('[valve.A]\nsheet = "b.toml"\n', "no such file"),
        ('[valve.A]\nsheet = "a.toml"\ndata = "/etc"\n', "must lie within the folder"),
        ('[valve.A]\nsheet = "a.toml"\ndata = "x/../../y"\n', "must lie within the folder"),
        ('[valve.A]\nsheet = "a.toml"\ndata = ""\n', "must be the name of a folder"),
        ('[valve.A]\nsheet = "a.toml"\ncolour = 1\n', "knows no key 'colour'"),
        (
            '[valve.A]\nsheet = "a.toml"\n[valve.B]\nsheet = "a.toml"\ndata = "a"\n',
            "have their rows in one folder",
        ),
        ('[commissioning]\ndays = 9\n[valve.A]\nsheet = "a.toml"\n', "whole number from 10"),
        ('[commissioning]\ndays = true\n[valve.A]\nsheet = "a.toml"\n', "whole number from 10"),
        ('[commissioning]\nfrom = "2026-01-01"\n[valve.A]\nsheet = "a.toml"\n', "date without quotes"),
        ('[commissioning]\nfrom = 2026-01-01T00:00:00\n[valve.A]\nsheet = "a.toml"\n', "date without quotes"),
        (
            '[commissioning]\nfrom = 2026-02-01\nuntil = 2026-01-01\n[valve.A]\nsheet = "a.toml"\n',
            "exchange the two",
        ),
        ('commissioning = 3\n[valve.A]\nsheet = "a.toml"\n', "must hold days"),
        ('false_calls = 0\n[valve.A]\nsheet = "a.toml"\n', "from 0.0001 to 10"),
        ('false_calls = "few"\n[valve.A]\nsheet = "a.toml"\n', "from 0.0001 to 10"),
        ('name = ""\n[valve.A]\nsheet = "a.toml"\n', "name must be a text"),
        ("[valve.A\n", "no valid TOML"),
    ],
)
def test_what_cannot_be_used_is_said_in_a_sentence(written, text, says):
    with pytest.raises(InputError) as error:
        read_plant(written(text))
    assert says.casefold() in str(error.value).casefold()
    assert "\n" not in str(error.value)


def test_commissioning_takes_the_first_days_with_rows():
    days = [dt.date(2026, 1, d) for d in (1, 2, 5, 6, 7, 9)]
    assert Commissioning(3).of(days) == days[:3]
    assert Commissioning(3, dt.date(2026, 1, 2)).of(days) == days[1:4]
    assert Commissioning(3, None, dt.date(2026, 1, 7)).of(days) == days[:5]
