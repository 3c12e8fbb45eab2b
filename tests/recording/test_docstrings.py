# SPDX-License-Identifier: BSD-3-Clause
"""Every public thing has an example, and every example runs."""

import doctest
import importlib
import pkgutil

import pytest

import sklvalve.recording as recording

MODULES = [info.name for info in pkgutil.walk_packages(recording.__path__, "sklvalve.recording.")]


@pytest.mark.parametrize("name", MODULES)
def test_examples_run(name):
    module = importlib.import_module(name)
    assert doctest.testmod(module).failed == 0


@pytest.mark.parametrize("name", recording.__all__)
def test_there_is_an_example(name):
    assert ">>>" in getattr(recording, name).__doc__
