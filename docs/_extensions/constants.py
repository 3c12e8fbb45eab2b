# SPDX-License-Identifier: BSD-3-Clause
"""Constants are described where they are defined, and listed where they are public: this joins the two."""

import pkgutil
from importlib import import_module

from sphinx.pycode import ModuleAnalyzer
from sphinx.util import logging

# a catalogue of objects says nothing when it is printed
LONGEST_VALUE = 250

logger = logging.getLogger(__name__)


def setup(app):
    app.connect("autodoc-process-docstring", _describe, priority=100)
    return {"parallel_read_safe": True}


def _describe(app, what, name, obj, options, lines):
    if what == "data":
        package, _, constant = name.rpartition(".")
        lines[:] = [*_description(package, constant, obj), *_value(obj)]


def _description(package, constant, obj):
    """Lines of the description beside the definition of `constant`, in one of the modules of `package`."""
    for module in _modules(package):
        told = ModuleAnalyzer.for_module(module).find_attr_docs().get(("", constant))
        if told and getattr(import_module(module), constant) is obj:
            return told
    logger.warning("%s.%s has no description: write one after #: above its definition", package, constant)
    return []


def _value(obj):
    told = repr(obj)
    return ["", ".. code-block:: python", "", f"   {told}"] if len(told) <= LONGEST_VALUE else []


def _modules(package):
    found = import_module(package)
    inside = pkgutil.walk_packages(getattr(found, "__path__", ()), f"{package}.")
    return [package, *(module.name for module in inside)]
