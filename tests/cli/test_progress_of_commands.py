# SPDX-License-Identifier: BSD-3-Clause
"""Long commands tell how far they are, stage after stage, and only where a person watches."""

from contextlib import contextmanager

import pytest

import sklvalve.cli.progress
from sklvalve.cli import main
from tests.recording.historian.exports import course, iso, moments, wide_text


@pytest.fixture
def watched(folder, monkeypatch):
    """What the progress was told."""
    told = []

    @contextmanager
    def progress():
        yield lambda stage, done: told.append((stage, done))

    monkeypatch.setattr(sklvalve.cli.progress, "progress", progress)
    text = wide_text(["FIC1.PV"], iso(moments("2024-06-28 10:00:00", 200, 10)), [course(200)])
    (folder / "export.csv").write_text(text)
    return told


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "stages"),
    [
        ("diagnose recording.csv", {"calibrating"}),
        (
            "import export.csv --out clean.csv",
            {
                "reading export.csv",
                "reading the numbers",
                "reading the times",
                "joining the reports of each tag",
                "laying all tags on one time base",
                "writing",
            },
        ),
        ("simulate --duration 200 --out run/s.csv", {"simulating", "simulating the sound actuator"}),
        ("simulate --duration 200 --loop --out run/s.csv", {"simulating"}),
    ],
)
def test_each_stage_is_told_in_order(watched, words, stages):
    assert main(words.split()) == 0
    assert {stage for stage, _ in watched} == stages
    shares = [done for _, done in watched]
    assert shares == sorted(shares)
    assert 0.0 <= shares[0] <= shares[-1] <= 1.0
