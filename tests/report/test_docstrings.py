# SPDX-License-Identifier: BSD-3-Clause
import doctest
from importlib import import_module

import pytest

plt = pytest.importorskip("matplotlib.pyplot", reason='needs pip install "sklvalve[plot]"')

MODULES = (
    "displays.explanation",
    "displays.improvement",
    "displays.recording",
    "displays.residual_map",
    "displays.signature",
    "headline",
    "html",
    "sentence",
    "text",
)


@pytest.mark.parametrize("module", MODULES)
def test_examples_run(module):
    result = doctest.testmod(import_module(f"sklvalve.report.{module}"))
    plt.close("all")
    assert result.attempted > 0
    assert result.failed == 0
