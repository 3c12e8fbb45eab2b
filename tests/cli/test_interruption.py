# SPDX-License-Identifier: BSD-3-Clause
"""Ctrl-C and its kin, sent in the midst of each command that takes long: nothing is half written."""

import os
import signal
import subprocess
import sys
import time

import pytest

from sklvalve.datasets import make_valve_recording
from sklvalve.datasets.concealed import to_toml
from tests.recording.historian.exports import course, iso, moments, wide_text

for _module in ("pandas", "jinja2", "matplotlib", "skops"):
    pytest.importorskip(_module, reason='needs pip install "sklvalve[all]"')
if os.name != "posix":
    pytest.skip("sends the signal of Ctrl-C as POSIX systems do", allow_module_level=True)

# a process started in the background may have been told to ignore the signal: not so here
CODE = (
    "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler); "
    "signal.signal(signal.SIGHUP, signal.SIG_DFL); "
    "from sklvalve.cli import main; sys.exit(main(sys.argv[1:]))"
)


@pytest.fixture(scope="module")
def inputs():
    """Files that keep each command busy for some seconds, by name."""
    made = make_valve_recording("clogging", 0.5, loop="wide", n_samples=2400, n_later=0, random_state=3)
    rows = 60_000
    values = course(rows)
    columns = ["FIC1.PV [m3/h]", "FIC1.OP [%]"]
    return {
        "recording.csv": made.frame.to_csv(index=False),
        "valve.toml": to_toml(made.valve),
        "export.csv": wide_text(columns, iso(moments("2024-06-28 10:00:00", rows, 10)), [values, values]),
    }


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "number"),
    [
        ("demo --out out", signal.SIGINT),
        ("diagnose recording.csv --out out", signal.SIGINT),
        ("diagnose recording.csv --out out", signal.SIGTERM),
        ("import export.csv --out clean.csv", signal.SIGHUP),
        ("import export.csv --out clean.csv", signal.SIGINT),
        ("simulate --duration 864000 --out made/run.csv", signal.SIGINT),
        ("simulate --duration 864000 --out made/run.csv", signal.SIGTERM),
    ],
    ids=lambda value: value.split()[0] if isinstance(value, str) else value.name,
)
def test_what_ends_a_run_leaves_nothing(tmp_path, inputs, words, number):
    for name, content in inputs.items():
        (tmp_path / name).write_text(content, encoding="utf-8")
    work = subprocess.Popen(
        [sys.executable, "-c", CODE, *words.split()],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    for _ in range(1200):
        if set(os.listdir(tmp_path)) - set(inputs):  # results are being made
            break
        time.sleep(0.05)
    time.sleep(0.5)
    assert work.poll() is None
    work.send_signal(number)
    _, shown = work.communicate(timeout=60)
    assert work.returncode == 128 + number
    assert [line for line in shown.splitlines() if not line.startswith("note: ")] == [
        "interrupted; nothing was written"
    ]
    assert sorted(os.listdir(tmp_path)) == sorted(inputs)


def test_an_interruption_while_the_commands_are_loaded_is_told_in_a_sentence():
    code = (
        "import sys\n"
        "class Ctrl:\n"
        "    def find_spec(self, name, path=None, target=None):\n"
        "        if name == 'sklvalve.cli.demo':\n"
        "            raise KeyboardInterrupt\n"
        "sys.meta_path.insert(0, Ctrl())\n"
        "from sklvalve.cli import main\n"
        "sys.exit(main(['--version']))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (130, "")
    assert done.stderr == "interrupted; nothing was written\n"


@pytest.mark.parametrize(
    ("falls", "run"),
    [
        ("into a callback that can raise nothing", "dropped"),
        ("where it becomes another error", "turned"),
        ("into what is half made, and breaks in its end", "broken"),
    ],
)
def test_an_interruption_that_a_library_drops_or_turns_into_an_error_ends_the_run_all_the_same(falls, run):
    code = (
        "import ctypes, os, signal, sys, time\n"
        "from sklvalve.cli import demo, main\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "def strike():\n"
        "    os.kill(os.getpid(), signal.SIGINT)\n"
        "    time.sleep(1)\n"
        "def dropped(args):\n"
        "    ctypes.CFUNCTYPE(None)(strike)()\n"
        "    for _ in range(300):\n"
        "        time.sleep(0.05)\n"
        "def turned(args):\n"
        "    try:\n"
        "        strike()\n"
        "    except KeyboardInterrupt:\n"
        "        raise SystemError('returned a result with an exception set') from None\n"
        "class Half:\n"
        "    def __del__(self):\n"
        "        raise AttributeError('never made whole')\n"
        "def broken(args):\n"
        "    half = Half()\n"
        "    strike()\n"
        f"demo.run = {run}\n"
        "sys.exit(main(['demo']))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=20)
    assert (done.returncode, done.stderr) == (130, "interrupted; nothing was written\n")
