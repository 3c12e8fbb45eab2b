# SPDX-License-Identifier: BSD-3-Clause
"""``sklvalve completion``: scripts that the shells take, and what bash then completes."""

import shutil
import subprocess
import sys

import pytest

from sklvalve.cli import main
from sklvalve.cli.completion import SHELLS

pytest.importorskip("shtab", reason='needs pip install "sklvalve[cli]"')

COMMANDS = [
    "completion",
    "demo",
    "diagnose",
    "import",
    "init",
    "learn",
    "predict",
    "screen",
    "simulate",
    "watch",
]


@pytest.fixture
def script(capsys):
    """Give the script for a shell."""

    def printed(shell):
        assert main(["completion", shell]) == 0
        return capsys.readouterr().out

    return printed


@pytest.mark.parametrize("shell", SHELLS)
def test_script_is_valid_and_names_every_command(script, shell, tmp_path):
    text = script(shell)
    assert all(command in text for command in COMMANDS)
    if shutil.which(shell) is None:
        pytest.skip(f"the rest needs {shell}")
    (tmp_path / "script").write_text(text)
    check = subprocess.run(
        [shell, "-n", str(tmp_path / "script")], capture_output=True, text=True, check=False
    )
    assert (check.returncode, check.stderr) == (0, "")


@pytest.mark.skipif(shutil.which("bash") is None, reason="needs bash")
@pytest.mark.parametrize(
    ("typed", "completed"),
    [
        (["sklvalve", ""], COMMANDS),
        (["sklvalve", "di"], ["diagnose"]),
        (
            ["sklvalve", "diagnose", "--"],
            [
                *("--allow", "--exit-code", "--help", "--history", "--json", "--out", "--seed", "--until"),
                "--valve",
            ],
        ),
        (["sklvalve", "diagnose", "rec"], ["recording.csv"]),
        (["sklvalve", "diagnose", "recording.csv", "--valve", "v"], ["valve.toml"]),
        (["sklvalve", "diagnose", "recording.csv", "--out", ""], ["results"]),
        (["sklvalve", "simulate", "--profile", ""], ["abrupt", "incipient", "long", "medium", "short"]),
        (["sklvalve", "completion", "f"], ["fish"]),
    ],
    ids=lambda value: value[-2:] if isinstance(value, list) and value[0] == "sklvalve" else None,
)
def test_bash_completes(script, tmp_path, typed, completed):
    (tmp_path / "script").write_text(script("bash"))
    (tmp_path / "recording.csv").write_text("")
    (tmp_path / "valve.toml").write_text("")
    (tmp_path / "results").mkdir()
    program = "\n".join(
        [
            "source ./script",
            'COMP_WORDS=("$@")',
            "COMP_CWORD=$(($# - 1))",
            # the name of the function stands behind -F in what complete -p says
            "function=$(complete -p sklvalve | sed 's/.*-F \\([^ ]*\\).*/\\1/')",
            '"$function" sklvalve "${COMP_WORDS[COMP_CWORD]}" "${COMP_WORDS[COMP_CWORD - 1]}"',
            'printf "%s\\n" "${COMPREPLY[@]}"',
        ]
    )
    shell = subprocess.run(
        ["bash", "--norc", "-c", program, "bash", *typed],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert shell.stderr == ""
    assert sorted(shell.stdout.split()) == sorted(completed)


def test_without_shtab_the_extra_is_named(monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "shtab", None)
    assert main(["completion", "bash"]) == 2
    assert 'the completion needs shtab: pip install "sklvalve[cli]"' in capsys.readouterr().err
    assert main(["completion", "cmd"]) == 2
    assert "invalid choice: 'cmd'" in capsys.readouterr().err
