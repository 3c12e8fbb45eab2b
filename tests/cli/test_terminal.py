# SPDX-License-Identifier: BSD-3-Clause
import os
import sys

import pytest

from sklvalve.cli.terminal import text_width


@pytest.mark.parametrize(("columns", "width"), [(60, 60), (96, 96), (200, 96)])
def test_lines_are_as_long_as_the_terminal_has_room(monkeypatch, columns, width):
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)
    monkeypatch.setattr("shutil.get_terminal_size", lambda fallback: os.terminal_size((columns, 24)))
    assert text_width() == width


def test_a_file_is_not_narrow_because_a_terminal_is(monkeypatch):
    monkeypatch.setattr(sys.stdout, "isatty", lambda: False, raising=False)
    monkeypatch.setenv("COLUMNS", "40")
    assert text_width() == 96
