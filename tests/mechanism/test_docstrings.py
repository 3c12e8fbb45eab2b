# SPDX-License-Identifier: BSD-3-Clause
"""Every public thing has an example, and every example runs."""

import doctest
import importlib
import pkgutil

import pytest

import sklvalve.mechanism as mechanism

MODULES = [info.name for info in pkgutil.iter_modules(mechanism.__path__)]


@pytest.mark.parametrize("name", MODULES)
def test_examples_run(name):
    module = importlib.import_module(f"sklvalve.mechanism.{name}")
    assert doctest.testmod(module).failed == 0


@pytest.mark.parametrize("name", [name for name in mechanism.__all__ if callable(getattr(mechanism, name))])
def test_there_is_an_example(name):
    assert ">>>" in getattr(mechanism, name).__doc__
