# SPDX-License-Identifier: BSD-3-Clause
"""Every example runs, a search over the models inside among them."""

import doctest
import importlib

import pytest


@pytest.mark.parametrize("name", ["outputs", "parallel", "series"])
def test_examples_run(name):
    found = doctest.testmod(importlib.import_module(f"sklvalve.hybrid.{name}"))
    assert found.attempted > 0
    assert found.failed == 0
