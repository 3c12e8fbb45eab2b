# SPDX-License-Identifier: BSD-3-Clause
"""Every code block of the README and the docs works: python runs, toml parses."""

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import NamedTuple

import pytest

ROOT = Path(__file__).parents[1]
MADE_BY_SPHINX = {"_build", "auto_examples", "generated"}
FENCE = re.compile(r"^```(\w+)[^\n]*\n(.*?)^```\s*$", re.MULTILINE | re.DOTALL)


class Block(NamedTuple):
    """A fenced code block and the page it stands on."""

    page: Path
    line: int
    language: str
    code: str


def _pages() -> list[Path]:
    docs = ROOT / "docs"
    written = [p for p in docs.rglob("*.md") if not MADE_BY_SPHINX & set(p.relative_to(docs).parts)]
    return [ROOT / "README.md", *sorted(written)]


def _blocks(language: str) -> list[Block]:
    found = []
    for page in _pages():
        text = page.read_text(encoding="utf-8")
        for match in FENCE.finditer(text):
            if match[1] == language:
                line = text[: match.start()].count("\n") + 1
                found.append(Block(page, line, language, match[2]))
    return found


def _pages_with(language: str) -> list[Path]:
    return sorted({block.page for block in _blocks(language)})


def _name(item: object) -> str:
    if isinstance(item, Block):
        return f"{item.page.relative_to(ROOT)}:{item.line}"
    return str(item.relative_to(ROOT)) if isinstance(item, Path) else str(item)


@pytest.mark.slow
@pytest.mark.parametrize("page", _pages_with("python"), ids=_name)
def test_python_blocks_of_a_page_run_in_order(page, tmp_path):
    # one program a page: a later block may go on with what an earlier one made
    blocks = [block for block in _blocks("python") if block.page == page]
    program = "\n".join(block.code for block in blocks)
    file = tmp_path / "page.py"
    file.write_text(program, encoding="utf-8")
    surroundings = os.environ | {"MPLBACKEND": "Agg", "PYTHONPATH": str(ROOT)}
    run = subprocess.run(
        [sys.executable, file.name],
        cwd=tmp_path,
        env=surroundings,
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, f"{page.relative_to(ROOT)}\n{run.stderr[-3000:]}"


@pytest.mark.parametrize("block", _blocks("toml"), ids=_name)
def test_toml_block_parses(block):
    assert tomllib.loads(block.code)


def test_described_valve_files_are_accepted():
    from sklvalve import Valve

    pages = [block for block in _blocks("toml") if block.page.name == "valve_toml.md"]
    assert pages, "docs/valve_toml.md shows no example"
    for block in pages:
        Valve.from_dict(tomllib.loads(block.code), source=_name(block))
