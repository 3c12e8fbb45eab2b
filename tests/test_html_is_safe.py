# SPDX-License-Identifier: BSD-3-Clause
"""What a notebook shows: no text that came with a file, a tag or a column becomes HTML."""

import importlib
import inspect
import json
import pkgutil

import pandas as pd
import pytest

import sklvalve
from sklvalve.history import ValveHistory
from sklvalve.hybrid import ParallelHybridRegressor, SeriesHybridRegressor
from sklvalve.lssvm import LSSVMRegressor, LSSVMRegressorCV
from sklvalve.mechanism import ValveMechanismTransformer
from sklvalve.mismatch import Diagnosis, MissingPhysicsFinder
from sklvalve.recording import Recording, Valve
from sklvalve.simulation import ValveSimulation
from tests.report import examples

EVIL = "<script>alert(1)</script><img src=x onerror=alert(2)>\"'&"


def _safe(page):
    return "<script>alert" not in page and "<img" not in page


def test_every_class_with_a_page_is_here():
    found = set()
    for module in pkgutil.walk_packages(sklvalve.__path__, "sklvalve."):
        if module.name.endswith("__main__"):
            continue
        for name, kind in inspect.getmembers(importlib.import_module(module.name), inspect.isclass):
            if kind.__module__.startswith("sklvalve.") and hasattr(kind, "_repr_html_"):
                found.add(name)
    assert found == {"Diagnosis", "Recording", "Showing", *(type(e).__name__ for e in ESTIMATORS)}


def _leaves(node, path=()):
    if isinstance(node, dict | list):
        for key, inner in node.items() if isinstance(node, dict) else enumerate(node):
            yield from _leaves(inner, (*path, key))
    elif isinstance(node, str):
        yield path


@pytest.mark.parametrize("found", [examples.named, examples.none_of_these, examples.no_mismatch])
def test_every_text_of_a_diagnosis(found):
    content = found()
    text = json.dumps(content)
    paths = [path for path in _leaves(content) if path != ("verdict",)]
    assert len(paths) > 10
    for path in paths:
        changed = json.loads(text)
        node = changed
        for key in path[:-1]:
            node = node[key]
        node[path[-1]] = EVIL
        assert _safe(Diagnosis(changed)._repr_html_()), path


def test_names_of_parameters_in_a_diagnosis():
    content = examples.named()
    for entry in content["effects"]:
        entry["parameters"] = {EVIL: {"value": 1.0, "unit": EVIL, "ci95": None}}
    page = Diagnosis(content)._repr_html_()
    assert _safe(page)
    assert "&lt;script&gt;" in page


def test_columns_of_a_recording():
    valve = Valve.from_dict(
        {"valve": {"tag": EVIL}, "recording": {"time": EVIL, "flow": {"column": "x" + EVIL, "unit": "m3/h"}}}
    )
    page = Recording.from_frame({EVIL: [0.0, 1.0], "x" + EVIL: [1.0, 2.0]}, valve)._repr_html_()
    assert _safe(page)
    assert "x&lt;script&gt;" in page


ESTIMATORS = [
    LSSVMRegressor(kernel_params={EVIL: EVIL}),
    LSSVMRegressorCV(kernel_params={EVIL: EVIL}),
    ValveMechanismTransformer(p1=EVIL),
    SeriesHybridRegressor(regressor_columns=[EVIL]),
    ParallelHybridRegressor(regressor_columns=[EVIL]),
    ValveSimulation(Valve(tag=EVIL)),
    ValveHistory(Valve(tag=EVIL)),
    MissingPhysicsFinder(ValveSimulation(Valve(tag=EVIL)), effects=EVIL),
]


@pytest.mark.parametrize("estimator", ESTIMATORS, ids=lambda estimator: type(estimator).__name__)
def test_parameters_of_an_estimator(estimator):
    page = estimator._repr_html_()
    assert _safe(page)
    assert "&lt;script&gt;" in page


def test_columns_of_a_fit():
    frame = pd.DataFrame({EVIL: [0.1, 0.5, 0.9], "b": [1.0, 2.0, 4.0]})
    assert _safe(LSSVMRegressor().fit(frame, frame["b"])._repr_html_())
