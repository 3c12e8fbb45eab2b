# SPDX-License-Identifier: BSD-3-Clause
"""Two thousand mutated files: nothing but the package's own error; and a harness that would notice else."""

import os
import random

import numpy as np
import pytest

for _module in ("pandas", "pyarrow", "skops"):
    pytest.importorskip(_module, reason='needs pip install "sklvalve[all]"')
if os.name != "posix":
    pytest.skip("watches processes as POSIX systems do", allow_module_level=True)

from benchmarks.fuzz import running  # noqa: E402
from benchmarks.fuzz.__main__ import main, table  # noqa: E402
from benchmarks.fuzz.mutating import _LEAVES, _leaf, mutated  # noqa: E402
from benchmarks.fuzz.seeds import KINDS, corpus  # noqa: E402
from benchmarks.fuzz.targets import NAMES, Unsound, _require_finite, reader  # noqa: E402

_SHARES = {"toml": 400, "csv": 400, "gz": 200, "parquet": 400, "export": 400, "model": 200, "estimator": 200}


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_nothing_but_the_own_error(kind):
    outcome = running.run(kind, _SHARES[kind], seed=1)
    assert not outcome.escaped, table([outcome])
    assert outcome.inputs == outcome.refused + outcome.accepted == _SHARES[kind]
    # else the mutations would not reach what lies behind the first check
    assert min(outcome.refused, outcome.accepted) >= 0.02 * _SHARES[kind]
    assert outcome.slowest < running.LONGEST
    assert outcome.memory < running.MOST_MEMORY


@pytest.mark.parametrize("kind", KINDS)
def test_the_seeds_themselves_are_read(tmp_path, kind):
    read, path = reader(kind), tmp_path / NAMES[kind]
    for content in corpus(kind):
        path.write_bytes(content)
        read(path, _Plain())


class _Plain:
    """Draws that leave every setting as it is found out."""

    def choice(self, options):
        return options[0]

    def random(self):
        return 0.5


def test_an_input_comes_again():
    one, other = (mutated("csv", corpus("csv"), random.Random("0 csv 7")) for _ in range(2))
    assert one == other == running.content_of("csv", 7, 0)


def test_an_input_is_the_same_whatever_came_before():
    before, rng = repr(_LEAVES), random.Random(0)
    for _ in range(200):
        held = {"a": [1.0, {"b": 2.0}], "c": 3.0}
        for _ in range(20):
            _leaf(held, rng)
    assert repr(_LEAVES) == before


_LINE = 'print(json.dumps({"at": at, "end": END, "took": 0.1, "memory": 9.0}), flush=True)'
_BEGIN = "import json, os, sys, time\nfor at in range(int(sys.argv[2]), int(sys.argv[3])):\n    "


@pytest.mark.parametrize(
    ("third", "words"),
    [("os.abort()", "ends the process"), ("time.sleep(60)", "hangs"), ("END = 'KeyError: x'", "KeyError: x")],
)
def test_what_escapes_is_counted_and_the_rest_goes_on(monkeypatch, third, words):
    code = f"{_BEGIN}END = 'refused' if at % 2 else 'accepted'\n    if at == 2: {third}\n    {_LINE}"
    monkeypatch.setattr(running, "WORKER", ("-c", code))
    monkeypatch.setattr(running, "LONGEST", 1.0)
    outcome = running.run("toml", 6, seed=0)
    assert (outcome.inputs, outcome.refused, outcome.accepted) == (6, 3, 2)
    assert [words in what for what in outcome.escaped] == [True]
    assert words in table([outcome])


def test_a_failure_is_the_exit_status(monkeypatch, tmp_path, capsys):
    code = f"{_BEGIN}END = 'ValueError: no'\n    {_LINE}"
    monkeypatch.setattr(running, "WORKER", ("-c", code))
    assert main(["--inputs", "2", "--only", "toml", "--keep", str(tmp_path)]) == 1
    assert "2 x 'ValueError: no'" in capsys.readouterr().out
    assert [path.name for path in tmp_path.iterdir()] == ["0-valve.toml"]


def test_memory_beyond_the_bound_is_a_failure(monkeypatch):
    line = _LINE.replace("9.0", "1025.0")
    monkeypatch.setattr(running, "WORKER", ("-c", f"{_BEGIN}END = 'refused'\n    {line}"))
    assert main(["--inputs", "1", "--only", "toml"]) == 1


@pytest.mark.parametrize("held", [{"x": [1.0, float("inf")]}, [np.array([np.nan])], {"y": {"z": -np.inf}}])
def test_an_infinity_is_unsound(held):
    with pytest.raises(Unsound):
        _require_finite(held)
    _require_finite([np.array([np.nan, 1.0])], gaps=True)
