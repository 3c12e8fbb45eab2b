# SPDX-License-Identifier: BSD-3-Clause
"""A valve's days as they come: in order, late, twice, empty, after an inspection, and after a kill.

The diagnosis and the score of a day have stand-ins, so that a year takes a second: what is asked here is what
becomes of the days.
"""

import datetime as dt
import hashlib
import types

import numpy as np
import pytest

from sklvalve.history import ValveHistory
from sklvalve.recording import InputError
from sklvalve.watch import valve as module
from sklvalve.watch.plant import Commissioning, Plant, Watched
from sklvalve.watch.record import Epoch
from sklvalve.watch.run import inspected, watch
from sklvalve.watch.score import Score, Share
from sklvalve.watch.site import write_site
from sklvalve.watch.standing import standing_of
from tests.history.plant import made
from tests.watch.test_days import VALVE

FIRST = dt.date(2026, 1, 1)


def text(day, level, many=30):
    stamps = [f"{day}T{hour:02d}:{minute:02d}:00" for hour in range(24) for minute in range(many)]
    return "t,C,F\n" + "".join(f"{stamp},{50 + k % 7},{level:.9f}\n" for k, stamp in enumerate(stamps))


class Data:
    """Days of one valve whose flow is what its days tell."""

    verdict = "named"

    def __init__(self, root):
        self.root = root
        self.rng = np.random.default_rng(0)
        self.levels = 30.0 + self.rng.normal(size=400)

    def put(self, number, shift=0.0, text_of=text):
        day = FIRST + dt.timedelta(days=number)
        file = self.root / "data" / "FV-1" / f"{day}.csv"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text_of(day, self.levels[number] + shift))
        return day

    def run(self, **options):
        (self.root / "data").mkdir(exist_ok=True)
        return watch(self.plant, self.root / "data", self.root / "state", n_jobs=1, **options)[0]

    @property
    def plant(self):
        return Plant("Test", (Watched("FV-1", VALVE, "FV-1", Commissioning(10)),), 0.05)


@pytest.fixture(scope="module")
def history():
    return ValveHistory().fit(made()[0].slice(0, 900))


@pytest.fixture
def data(tmp_path, monkeypatch, history):
    class Finder:
        def __init__(self, **_):
            content = {"verdict": Data.verdict, "effects": [{"members": [{"name": "seat_leakage"}]}]}
            save = lambda path: path.write_text("")  # noqa: E731
            self.diagnosis_ = types.SimpleNamespace(to_dict=lambda: content, save=save)

        def history_of(self, recordings):
            Data.learnt_on = [each.source for each in recordings]
            return history

        def fit(self, recording):
            Data.diagnosed = recording.source
            return self

    def score(recording, _):
        size = 3.6e3 * float(np.mean(recording["flow"])) / 100.0
        shares = {"capacity_error": Share(size, 0.001), "friction": Share(0.01 * size**0.0, 0.001)}
        return Score(len(recording), 60.0, shares, {"flow": 0.01 + 1e-4 * size})

    monkeypatch.setattr(module, "MissingPhysicsFinder", Finder)
    monkeypatch.setattr(module, "write_report", lambda path, *_, **__: path.write_text("<p>"))
    monkeypatch.setattr(module, "headline", lambda _: "Likely fault: the seat leaks.")
    monkeypatch.setattr(module, "scored", score)
    return Data(tmp_path)


def tree(folder):
    """Checksums of all files of a folder."""
    return {
        file.relative_to(folder).as_posix(): hashlib.sha256(file.read_bytes()).hexdigest()
        for file in sorted(folder.rglob("*"))
        if file.is_file()
    }


def test_a_valve_is_learnt_watched_and_called(data):
    assert data.run().state == "no data"
    for k in range(9):
        data.put(k)
    told = data.run()
    assert told.state == "commissioning"
    assert "10 days and at least 10; so far there are 9." in told.said[0]
    data.put(9)
    # no day has come since its commissioning
    assert data.run().state == "sound"
    for k in range(10, 30):
        data.put(k)
    told = data.run()
    assert (told.state, told.said) == ("sound", ())
    # the first half is learnt, the other half is the reference
    assert Data.learnt_on == [f"FV-1 2026-01-0{d}" for d in range(1, 6)]
    for k in range(30, 45):
        data.put(k, shift=8.0)
    told = data.run()
    # two days are diagnosed, and two later ones bear the name out
    assert (told.state, told.read) == ("calls", 15 + 2 + 2)
    import pandas as pd

    found = pd.read_parquet(data.root / "state" / "findings.parquet")
    assert len(found) == 2
    finding = found.iloc[0]
    assert finding.onset == "2026-01-31"
    assert finding.called < "2026-02-06"
    assert finding["names"] == "seat_leakage"
    assert (data.root / "state" / finding.report).exists()
    trends = pd.read_parquet(data.root / "state" / "trends.parquet")
    assert len(trends) == 45
    # nothing is read again, and nothing changes
    before = tree(data.root / "state")
    assert data.run().read == 0
    assert tree(data.root / "state") == before


def test_a_morning_without_rows_does_not_load_the_history(data, monkeypatch):
    for k in range(12):
        data.put(k)
    assert data.run().state == "sound"
    loaded = []
    load = module.Store.history
    monkeypatch.setattr(module.Store, "history", lambda *args: loaded.append(1) or load(*args))
    assert (data.run().state, loaded) == ("sound", [])
    data.put(12)
    assert (data.run().state, loaded) == ("sound", [1])


def test_days_in_any_order_come_to_the_same_state(data, tmp_path):
    for k in range(30):
        data.put(k)
    data.run()
    straight = tree(tmp_path / "state")
    (tmp_path / "state").rename(tmp_path / "straight")
    late = tmp_path / "data" / "FV-1" / "2026-01-20.csv"
    kept, stat = late.read_text(), late.stat()
    late.unlink()
    data.run()
    late.write_text(kept)
    import os

    os.utime(late, ns=(stat.st_atime_ns, stat.st_mtime_ns))
    told = data.run()
    assert told.said == ("2026-01-20: came late",)
    there = tree(tmp_path / "state")
    apart = {name for name in straight if straight[name] != there[name]}
    # the late day alone says so
    assert apart == {"days/valve=FV-1/2026-01-20.parquet"}


def test_a_day_that_comes_again_is_read_again_only_where_its_rows_differ(data):
    for k in range(20):
        data.put(k)
    data.run()
    data.put(15)
    assert data.run().read == 0
    data.put(15, shift=0.1)
    told = data.run()
    assert told.read == 1
    assert "2026-01-16: came again with other rows" in told.said


@pytest.mark.parametrize(
    ("bad", "says"),
    [
        (lambda day, level: "", "the file is empty"),
        (lambda day, level: "t,C,F\n", "no row under it"),
        (lambda day, level: text(day, level, many=2), "fewer than 600"),
        (lambda day, level: text(day, level).replace("t,C,F", "t,C,G"), "F"),
    ],
)
def test_a_day_that_cannot_be_used_is_told_and_left_out(data, bad, says):
    for k in range(30):
        data.put(k)
    data.put(20, text_of=bad)
    told = data.run()
    assert told.state == "sound"
    assert told.said[0].startswith("2026-01-21: ")
    assert says in told.said[0]


def test_a_commissioning_day_that_cannot_be_read_is_replaced_by_the_next(data):
    for k in range(10):
        data.put(k)
    data.put(2, text_of=lambda day, level: "")
    told = data.run()
    assert told.state == "commissioning"
    assert told.said[0].startswith("2026-01-03: ")
    assert "so far there are 9." in told.said[1]
    data.put(10)
    assert data.run().state == "sound"
    assert Data.learnt_on == [f"FV-1 2026-01-0{d}" for d in (1, 2, 4, 5, 6)]


def test_no_inspection_lies_in_the_future(data):
    with pytest.raises(InputError, match="yet to come"):
        inspected(data.plant, data.root / "state", "FV-1", dt.date.today() + dt.timedelta(days=3))
    data.put(0)
    inspected(data.plant, data.root / "state", "FV-1", FIRST + dt.timedelta(days=30))
    told = data.run()
    assert (told.state, told.said) == ("no data", ("No day since its inspection on 2026-01-31.",))


def test_an_inspection_begins_a_new_history(data):
    for k in range(45):
        data.put(k, shift=8.0 * (k >= 30))
    assert data.run().state == "calls"
    day = FIRST + dt.timedelta(days=40)
    inspected(data.plant, data.root / "state", "FV-1", day, "seat renewed")
    told = data.run()
    assert told.state == "commissioning"
    for k in range(45, 70):
        data.put(k, shift=8.0)
    # what it is now is what it is held against
    assert data.run().state == "sound"
    with pytest.raises(InputError, match="no valve FV-2"):
        inspected(data.plant, data.root / "state", "FV-2", day)
    with pytest.raises(InputError, match="was inspected on 2026-02-10 already"):
        inspected(data.plant, data.root / "state", "FV-1", FIRST)


def test_another_programme_is_looked_at_and_no_call(data, monkeypatch):
    monkeypatch.setattr(Data, "verdict", "no_mismatch")
    for k in range(60):
        data.put(k, shift=8.0 * (k >= 30))
    assert data.run().state == "sound"
    import pandas as pd

    looks = pd.read_parquet(data.root / "state" / "findings.parquet")
    assert looks.verdict.tolist() == ["no_mismatch"]
    before = tree(data.root / "state")
    assert data.run().read == 0
    assert tree(data.root / "state") == before
    # what comes after the new days is compared with these
    monkeypatch.setattr(Data, "verdict", "named")
    for k in range(60, 75):
        data.put(k, shift=16.0)
    assert data.run().state == "calls"
    calls = pd.read_parquet(data.root / "state" / "findings.parquet")
    assert calls.onset.iloc[-1] == "2026-03-02"


def test_a_call_without_a_name_is_diagnosed_again_on_later_days_until_it_has_one(data, monkeypatch):
    monkeypatch.setattr(Data, "verdict", "cannot_tell")
    for k in range(45):
        data.put(k, shift=8.0 * (k >= 30))
    assert data.run().state == "calls"
    import pandas as pd

    def findings():
        return pd.read_parquet(data.root / "state" / "findings.parquet")

    first = dt.date.fromisoformat(findings().called.iloc[0])
    since = [(dt.date.fromisoformat(day) - first).days for day in findings().called]
    # the time until the next one doubles
    assert since == [0, 1, 2, 4, 8]
    assert findings().names.tolist() == [""] * 5
    assert data.run().read == 0
    monkeypatch.setattr(Data, "verdict", "named")
    for k in range(45, 60):
        data.put(k, shift=8.0)
    data.run()
    assert findings().names.tolist() == [""] * 5 + ["seat_leakage"]
    assert not standing_of("FV-1", module.Store(data.root / "state"), Epoch()).named_twice
    # it called on the day on which it called, and is diagnosed no more once it has a name
    standing = standing_of("FV-1", module.Store(data.root / "state"), Epoch())
    assert standing.called == first.isoformat()
    assert standing.call.names == ("seat_leakage",)
    assert data.run().read == 0


def test_a_name_is_sought_until_days_that_had_no_part_in_it_bear_it_out(data, monkeypatch):
    monkeypatch.setattr(Data, "verdict", "named")
    told = iter(["friction", "stiction", "seat_leakage", "stiction", "friction"])
    monkeypatch.setattr(module.MissingPhysicsFinder, "fit", _next_name(told))
    for k in range(75):
        data.put(k, shift=8.0 * (k >= 30))
    data.run()
    found = module.Store(data.root / "state").findings("FV-1")
    first = dt.date.fromisoformat(found[0].called)
    assert [(dt.date.fromisoformat(f.called) - first).days for f in found] == [0, 2, 4, 8]
    assert [f.names for f in found] == [("friction",), ("stiction",), ("seat_leakage",), ("stiction",)]
    standing = standing_of("FV-1", module.Store(data.root / "state"), Epoch())
    assert standing.named_twice
    assert standing.call == found[-1]


def _names(monkeypatch, data, told, days=75):
    monkeypatch.setattr(Data, "verdict", "named")
    monkeypatch.setattr(module.MissingPhysicsFinder, "fit", _next_name(iter(told)))
    for k in range(days):
        data.put(k, shift=8.0 * (k >= 30))
    data.run()
    return standing_of("FV-1", module.Store(data.root / "state"), Epoch())


def test_each_class_must_come_twice(data, monkeypatch):
    monkeypatch.setattr(module, "DIAGNOSED", 2)
    standing = _names(
        monkeypatch, data, ["friction", ("friction", "seat_leakage"), ("seat_leakage", "friction")]
    )
    assert len(standing.calls) == 3
    assert standing.named_twice == {"friction", "seat_leakage"}


def test_a_day_that_comes_again_without_rows_undoes_no_name(data, monkeypatch):
    standing = _names(monkeypatch, data, ["friction"] * 5)
    assert standing.named_twice == {"friction"}
    first = (dt.date.fromisoformat(standing.calls[0].called) - FIRST).days
    data.put(first, text_of=lambda *_: "")
    data.run()
    again = standing_of("FV-1", module.Store(data.root / "state"), Epoch())
    assert again.calls == standing.calls
    assert again.named_twice == {"friction"}


def test_what_was_refused_once_is_not_tried_again(data, monkeypatch):
    assert unnamed(data, monkeypatch, days=35).state == "calls"

    def refuses(*_):
        raise InputError("too few rows move; give other days")

    monkeypatch.setattr(module.MissingPhysicsFinder, "fit", refuses)
    for k in range(35, 75):
        data.put(k, shift=8.0)
    assert len(data.run().said) < 6
    told = data.run()
    assert (told.read, told.said) == (0, ())
    found = module.Store(data.root / "state").findings("FV-1")
    assert found[-1].verdict == "refused"
    assert "too few rows move" in found[-1].headline


def _next_name(told):
    """A diagnosis that names one thing after the other."""

    def fit(finder, recording):
        names = next(told)
        several = names if isinstance(names, tuple) else (names,)
        content = {"verdict": "named", "effects": [{"members": [{"name": name}]} for name in several]}
        finder.diagnosis_.to_dict = lambda: content
        return finder

    return fit


def unnamed(data, monkeypatch, days=45):
    """A valve that has called without a name."""
    monkeypatch.setattr(Data, "verdict", "cannot_tell")
    for k in range(days):
        data.put(k, shift=8.0 * (k >= 30))
    return data.run()


def test_a_look_that_is_refused_hides_no_call(data, monkeypatch):
    assert unnamed(data, monkeypatch, days=35).state == "calls"

    def refuses(*_):
        raise InputError("too few rows move; give other days")

    monkeypatch.setattr(module.MissingPhysicsFinder, "fit", refuses)
    for k in range(35, 42):
        data.put(k, shift=8.0)
    told = data.run()
    assert told.state == "calls"
    assert "the call was not diagnosed again: too few rows move" in told.said[-1]


def test_a_look_whose_rows_are_gone_is_made_on_the_next_day_that_has_some(data, monkeypatch):
    unnamed(data, monkeypatch, days=35)
    first = module.Store(data.root / "state").findings("FV-1")[0].called
    for k in range(35, 39):
        data.put(k, shift=8.0)
    data.run()
    gone = dt.date.fromisoformat(first) + dt.timedelta(days=8)
    for k in range(39, 50):
        if data.put(k, shift=8.0) == gone:
            (data.root / "data" / "FV-1" / f"{gone}.csv").unlink()
    assert data.run().state == "calls"


def refuse(days, monkeypatch):
    """Have diagnoses refused whose last day is one of these."""

    def fit(finder, recording):
        if recording.source.split()[-1] in days:
            raise InputError("the opening is nowhere where the history has been")
        return finder

    monkeypatch.setattr(module.MissingPhysicsFinder, "fit", fit)


def test_a_call_that_cannot_be_diagnosed_is_made_on_the_next_day_that_can(data, monkeypatch):
    refused = set()
    refuse(refused, monkeypatch)
    for k in range(20):
        data.put(k)
    days = [data.put(k, shift=8.0) for k in range(20, 32)]
    refused.update(map(str, days))
    told = data.run()
    assert told.state == "cannot tell"
    assert [said for said in told.said if "nowhere where the history has been" in said] == [told.said[-1]]
    refused.remove(str(days[-1]))
    assert data.run().state == "calls"
    [finding] = module.Store(data.root / "state").findings("FV-1")
    assert finding.called == str(days[-1])


def test_a_call_whose_reference_days_come_again_empty_is_still_a_call(data, monkeypatch):
    unnamed(data, monkeypatch)
    for k in range(5, 10):
        data.put(k, text_of=lambda *_: "")
    assert data.run().state == "calls"


def test_runs_on_every_day_and_one_run_in_the_end_keep_the_same_bytes(data, tmp_path, monkeypatch):
    monkeypatch.setattr(Data, "verdict", "cannot_tell")
    days = [(k, 8.0 * (k >= 20)) for k in range(32)]
    for k, shift in days:
        data.put(k, shift)
        data.run()
    daily = tree(tmp_path / "state")
    (tmp_path / "state").rename(tmp_path / "daily")
    data.run()
    assert tree(tmp_path / "state") == daily


def test_what_two_processes_find_is_kept_once(data, monkeypatch):
    unnamed(data, monkeypatch)
    store = module.Store(data.root / "state")
    kept = store.findings("FV-1")
    for finding in kept:
        store.save_finding(finding)
    assert store.findings("FV-1") == kept


def test_drafts_of_a_killed_run_are_swept_once_they_are_old(data):
    import os

    data.put(0)
    data.run()
    old, new = (data.root / "state" / "calls" / f".FV-1.json.{name}" for name in ("0badc0de", "deadbeef"))
    old.parent.mkdir(exist_ok=True)
    for each in (old, new):
        each.write_text("")
    os.utime(old, (1.0, 1.0))
    data.run()
    assert (old.exists(), new.exists()) == (False, True)


def test_what_was_killed_goes_on_to_the_same_state(data, tmp_path, monkeypatch):
    for k in range(45):
        data.put(k, shift=8.0 * (k >= 30))
    data.run()
    whole = tree(tmp_path / "state")
    (tmp_path / "state").rename(tmp_path / "whole")
    save, left = module.Store.save_day, [7]

    def killed(*args):
        left[0] -= 1
        if left[0] < 0:
            raise KeyboardInterrupt
        return save(*args)

    monkeypatch.setattr(module.Store, "save_day", killed)
    for _ in range(8):
        left[0] = 7
        try:
            data.run()
        except KeyboardInterrupt:
            continue
        break
    assert tree(tmp_path / "state") == whole


def test_one_valve_that_fails_keeps_no_other_from_being_watched(data, monkeypatch):
    class Refuses:
        def __init__(self, **_):
            pass

        def history_of(self, _):
            raise InputError("there is nothing to learn; give other rows")

    monkeypatch.setattr(module, "MissingPhysicsFinder", Refuses)
    for k in range(12):
        data.put(k)
    told = data.run()
    assert (told.state, told.said[-1]) == ("cannot tell", "there is nothing to learn; give other rows")


def test_two_runs_at_once_are_kept_apart(data, tmp_path):
    data.run()
    from sklvalve._locking import held

    with held(tmp_path / "state") as ours:
        assert ours
        with pytest.raises(InputError, match="another watch runs on it"):
            data.run()


def test_a_folder_of_something_else_is_no_state(data, tmp_path):
    (tmp_path / "state").mkdir()
    (tmp_path / "state" / "thesis.tex").write_text("")
    with pytest.raises(InputError, match="holds other files"):
        data.run()
    (tmp_path / "state" / "watch.json").write_text('{"schema": "sklvalve.watch/9"}')
    with pytest.raises(InputError, match="begin with a new folder"):
        data.run()
    (tmp_path / "state" / "watch.json").write_text("{")
    with pytest.raises(InputError, match="no JSON"):
        data.run()


def test_the_days_that_are_diagnosed_had_no_part_in_the_choice(data):
    for k in range(30):
        data.put(k)
    chosen = data.put(30, shift=10.0)
    assert data.run().state == "sound"
    import pandas as pd

    trends = pd.read_parquet(data.root / "state" / "trends.parquet")
    assert trends.evidence.iloc[-1] > 7305.0
    # one day unlike the others is no change yet
    data.put(31)
    data.put(32)
    assert data.run().state == "sound"
    fresh = [data.put(31, shift=10.0), data.put(32, shift=10.0)]
    assert data.run().state == "calls"
    assert str(chosen) not in Data.diagnosed
    assert all(str(day) in Data.diagnosed for day in fresh)


def test_a_damaged_history_spoils_no_day(data):
    for k in range(20):
        data.put(k)
    assert data.run().state == "sound"
    file = data.root / "state" / "histories" / "FV-1" / "first.history.skops"
    whole = file.read_bytes()
    file.write_bytes(whole[:100])
    for k in range(20, 24):
        data.put(k, shift=12.0)
    assert data.run().state == "cannot tell"
    file.write_bytes(whole)
    told = data.run()
    assert (told.state, told.read) == ("calls", 4 + 2)


def test_calls_that_cannot_be_read_keep_no_other_valve_from_being_watched(data):
    for k in range(20):
        data.put(k)
    assert data.run().state == "sound"
    calls = data.root / "state" / "calls" / "FV-1.json"
    calls.parent.mkdir()
    calls.write_text("{")
    now, standings = module.watch_valve(data.plant.valves[0], data.root / "data", data.root / "state", 0.05)
    assert (now.state, standings) == ("cannot tell", [])


def test_a_day_is_looked_at_once(data, monkeypatch):
    monkeypatch.setattr(Data, "verdict", "no_mismatch")
    refuse({str(FIRST + dt.timedelta(days=k)) for k in range(20, 38)}, monkeypatch)
    for k in range(45):
        data.put(k, shift=30.0 * (k >= 20) + 15.0 * (k >= 33))
    data.run()
    days = [each.called for each in module.Store(data.root / "state").findings("FV-1")]
    assert days == sorted(set(days))


def test_the_page_says_by_how_many_diagnoses_a_name_is_given(data, monkeypatch):
    def sure(told, days):
        _names(monkeypatch, data, told, days)
        write_site(data.root / "site", data.plant, [data.run()], data.root / "state")
        return (data.root / "site" / "index.html").read_text()

    assert "named by one diagnosis so far" in sure(["friction"] * 9, 35)
    assert "named by two diagnoses that share no day" in sure(["friction"] * 9, 45)
