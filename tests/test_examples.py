# SPDX-License-Identifier: BSD-3-Clause
"""The examples of the gallery have the form of one; that they run is seen when the documentation is built."""

import ast
import re
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[1] / "docs" / "examples"
EXAMPLES = sorted(FOLDER.glob("*.py"))
LONGEST = 120


def _tree(path):
    return ast.parse(path.read_text(encoding="utf-8"))


def test_there_are_examples_and_a_header():
    assert len(EXAMPLES) >= 7
    assert re.match(r"\S.*\n=+\n", (FOLDER / "GALLERY_HEADER.rst").read_text(encoding="utf-8"))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
class TestExample:
    def test_is_found_by_the_gallery_and_short(self, path):
        assert path.name.startswith("plot_")
        assert len(path.read_text(encoding="utf-8").splitlines()) <= LONGEST

    def test_begins_with_a_title_and_says_for_whom(self, path):
        title, line, empty, *prose = ast.get_docstring(_tree(path)).splitlines()
        assert title
        assert line == "=" * len(title)
        assert not empty
        assert " ".join(prose).startswith("For ")

    def test_every_heading_is_underlined_in_full(self, path):
        text = path.read_text(encoding="utf-8")
        for heading, line in re.findall(r"^# %%\n# (.*)\n# (-{3,})$", text, re.MULTILINE):
            assert len(line) == len(heading)

    def test_ends_by_printing_a_number_that_it_measured(self, path):
        last = _tree(path).body[-1]
        assert isinstance(last, ast.Expr)
        assert isinstance(last.value, ast.Call)
        assert getattr(last.value.func, "id", "") == "print"
        shown = [node for node in ast.walk(last) if isinstance(node, ast.FormattedValue)]
        formats = "".join(ast.unparse(node.format_spec) for node in shown if node.format_spec is not None)
        assert re.search(r"\.\df", formats), "the last line prints no number with decimals"

    def test_ends_under_the_heading_of_its_number(self, path):
        cells = path.read_text(encoding="utf-8").split("# %%\n")
        assert cells[-1].startswith("# Its number\n")

    def test_draws_are_seeded(self, path):
        for node in ast.walk(_tree(path)):
            if isinstance(node, ast.Call):
                name = ast.unparse(node.func)
                given = {word.arg for word in node.keywords}
                if name in ("make_valve_recording", "make_damadics"):
                    assert "random_state" in given, f"line {node.lineno}"
                if name.endswith("default_rng"):
                    assert node.args, f"line {node.lineno}"
