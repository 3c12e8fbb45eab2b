# SPDX-License-Identifier: BSD-3-Clause
"""A trial of our own plant goes on where it stopped, and is shared by two processes."""

import json
import runpy
from pathlib import Path

FOLDER = Path(__file__).parents[2] / "benchmarks" / "trial"


def test_a_trial_goes_on_where_it_stopped_and_is_shared(tmp_path, monkeypatch, capsys, a_line):
    script = runpy.run_path(str(FOLDER / "score.py"))
    for i in range(5):
        (tmp_path / f"record_{i}").mkdir()
        (tmp_path / f"record_{i}" / "truth.json").write_text("{}")
    seen = []

    def quick(place):
        seen.append(place.name)
        errors = {"corrected": [1.0, 1.0], "nominal": [1.0, 1.0]}
        more = {"folder": "f", "record": place.name, "errors": errors, "seconds": 1.0}
        return a_line(loop="wide") | more

    main = script["main"]
    monkeypatch.setitem(main.__globals__, "score", quick)
    main([str(tmp_path), "--part", "1/2"])
    assert seen == ["record_0", "record_2", "record_4"]
    out = tmp_path / "scores_1_of_2.jsonl"
    lines = out.read_text().splitlines()
    # stopped while it wrote the last line
    out.write_text("\n".join([*lines[:2], lines[2][:40]]))
    main([str(tmp_path), "--part", "1/2"])
    assert seen[3:] == ["record_4"]
    assert [json.loads(line)["record"] for line in out.read_text().splitlines()] == seen[:3]
    main([str(tmp_path), "--part", "2/2"])
    capsys.readouterr()
    main(["--combine", str(out), str(tmp_path / "scores_2_of_2.jsonl")])
    told = capsys.readouterr().out
    assert sum(line.startswith("| record_") for line in told.splitlines()) == 5
    assert "| all | 5 | 5 | 0 | 0 | 0 % (0-52) |" in told
