# SPDX-License-Identifier: BSD-3-Clause
"""Pages stay short and plain: few words, narrow lines, the language of the field."""

import re
from itertools import pairwise
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGES = sorted((ROOT / "docs").glob("*.md"))
# a record of changes keeps the words of its time
RECORDS = ("changelog.md",)
WORDS, WIDTH = 30_000, 100
# archaic, or private where the field has a name
BANNED = (
    "afresh",
    "borne out",
    "foreseen",
    "is told apart",
    "sifting",
    "slow rest",
    "what comes back differs",
    "what stands",
    "wherefore",
    "whereof",
    "withholding",
    "in its midst",
    "counts for nothing",
)

pytestmark = pytest.mark.skipif(not PAGES, reason="the pages are not beside the tests")


def prose(page):
    """Lines of a page without code, formulas, tables and addresses."""
    text = re.sub(r"^(```|\$\$).*?^\1", "", page.read_text(encoding="utf-8"), flags=re.S | re.M)
    text = re.sub(r"\]\([^)]*\)", "]", text)
    return [line for line in text.splitlines() if not line.lstrip().startswith("|")]


def test_all_pages_together_are_short():
    count = {page.name: sum(len(line.split()) for line in prose(page)) for page in PAGES}
    assert sum(count.values()) <= WORDS, count


@pytest.mark.parametrize("page", [*PAGES, ROOT / "README.md", ROOT / "CONTRIBUTING.md"], ids=lambda p: p.name)
def test_lines_are_narrow(page):
    wide = [line for line in prose(page) if len(line) > WIDTH]
    assert not wide


@pytest.mark.parametrize("page", [*PAGES, ROOT / "README.md"], ids=lambda p: p.name)
def test_words_are_the_fields(page):
    if page.name in RECORDS:
        pytest.skip("it is a record")
    text = " ".join(" ".join(prose(page)).split()).casefold()
    found = [words for words in BANNED if words in text]
    assert not found


@pytest.mark.parametrize("page", [*PAGES, ROOT / "README.md", ROOT / "CONTRIBUTING.md"], ids=lambda p: p.name)
def test_no_line_is_lost_as_a_comment(page):
    # MyST drops a line that begins with a percent sign, and what stood in it
    assert not [line for line in prose(page) if line.lstrip().startswith("%")]


@pytest.mark.parametrize("page", [*PAGES, ROOT / "README.md", ROOT / "CONTRIBUTING.md"], ids=lambda p: p.name)
def test_a_table_begins_after_an_empty_line(page):
    text = re.sub(r"^(```|\$\$).*?^\1", "", page.read_text(encoding="utf-8"), flags=re.S | re.M)
    lines = text.splitlines()
    begins = [above for above, line in pairwise(lines) if line.startswith("|")]
    assert not [above for above in begins if above.strip() and not above.startswith(("|", "<!--"))]


def test_the_readme_is_a_page():
    assert len((ROOT / "README.md").read_text(encoding="utf-8").splitlines()) < 120
