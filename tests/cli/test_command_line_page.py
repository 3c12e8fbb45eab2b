# SPDX-License-Identifier: BSD-3-Clause
"""docs/command_line.md is what the parser makes of it today."""

import importlib.util
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"

pytestmark = pytest.mark.skipif(not DOCS.is_dir(), reason="the pages are not beside the tests")


@pytest.fixture
def maker():
    """The script that makes the page."""
    spec = importlib.util.spec_from_file_location("make_command_line", DOCS / "make_command_line.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_page_is_current(maker):
    written = (DOCS / "command_line.md").read_text(encoding="utf-8")
    assert written == maker.page(), "run: python docs/make_command_line.py"


def test_page_shows_every_command_and_option(maker):
    page = maker.page()
    for name, parser, _ in maker.commands():
        assert f"## {name}\n" in page
        section = page.split(f"## {name}\n")[1].split("\n## ")[0]
        for action in parser._actions:
            assert all(
                f"`{each}" in section
                for each in action.option_strings
                if each.startswith("--") and each != "--help"
            )
