# SPDX-License-Identifier: BSD-3-Clause
"""Fitted estimators as plain data: numbers, texts and arrays, and the names of known classes.

What is read back is made of classes that stand in a list here, and of nothing else. An attribute is a number,
a text, an array, a collection of these or another such estimator, and never code.
"""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Callable
from functools import partial
from numbers import Integral, Real
from typing import Any

import numpy as np
from sklearn.base import BaseEstimator
from sklearn.pipeline import FeatureUnion, Pipeline

from sklvalve.hybrid import ParallelHybridRegressor, SeriesHybridRegressor
from sklvalve.lssvm import LSSVMRegressor, LSSVMRegressorCV
from sklvalve.mechanism import ValveMechanismTransformer
from sklvalve.mismatch.effects.base import Effect
from sklvalve.recording import InputError, Valve
from sklvalve.simulation import ValveSimulation
from sklvalve.simulation.state import require_sound_state

_CLASSES = {
    kind.__name__: kind
    for kind in (
        LSSVMRegressor,
        LSSVMRegressorCV,
        ParallelHybridRegressor,
        SeriesHybridRegressor,
        ValveMechanismTransformer,
    )
}
# of scikit-learn: what predicts with numpy alone; compiled code trusts the sizes of what it is given
_OF_SKLEARN = (
    "compose",
    "decomposition",
    "dummy",
    "feature_selection",
    "impute",
    "kernel_ridge",
    "linear_model",
    "pipeline",
    "preprocessing",
)
_MARK = "sklvalve"
_DEEPEST, _MOST_THREADS = 40, 4096
# arrays of the LS-SVM that must hold numbers, all of them finite
_FINITE = ("dual_coef_", "intercept_", "X_fit_", "offset_", "_right_")


def plain_of(model: Any) -> Any:
    """Plain data that `estimator_of` makes an equal estimator of.

    Parameters
    ----------
    model : estimator

    Returns
    -------
    content : dict

    Raises
    ------
    InputError
        If it holds something that a model file does not hold, such as a function.
    """
    return _plain(model, type(model).__name__, 0)


def estimator_of(content: Any, known: dict[str, Effect]) -> BaseEstimator:
    """The estimator that plain data stand for, each part checked.

    Parameters
    ----------
    content : dict
        Of `plain_of`, as it was read back.
    known : dict
        Effects by key.

    Returns
    -------
    model : estimator

    Raises
    ------
    ValueError
        With a few words that name the part that is wrong.
    """
    model = _made(content, known, 0)
    if not isinstance(model, BaseEstimator):
        raise ValueError("it holds no estimator")
    return model


def _plain(value: Any, where: str, depth: int) -> Any:
    if depth > _DEEPEST:
        raise InputError(f"{where} is nested too deep for a model file; save the parts by themselves")
    if value is None or type(value) in (bool, int, float, str):
        return value
    if isinstance(value, np.bool_ | np.integer | np.floating):
        return value.item()
    if isinstance(value, np.ndarray):
        return _plain_array(value, where)
    inner = partial(_plain, depth=depth + 1)
    if type(value) in (list, tuple):
        return type(value)(inner(each, f"{where}[{k}]") for k, each in enumerate(value))
    if type(value) is dict:
        items = [[inner(k, where), inner(v, f"{where}[{k!r}]")] for k, v in value.items()]
        return {_MARK: "dict", "items": items}
    if type(value) is ValveSimulation:
        return _plain_simulation(value, where, depth)
    setting = _plain_setting(value, where, inner)
    return _plain_estimator(value, where, inner) if setting is None else setting


def _plain_setting(value: Any, where: str, inner: Callable[..., Any]) -> dict[str, Any] | None:
    """A data type, a slice or the state of a random generator; None of anything else."""
    if isinstance(value, np.dtype) and value.kind in "biuf":
        return {_MARK: "dtype", "name": value.name}
    if type(value) is slice:
        return {_MARK: "slice", "ends": [inner(e, where) for e in (value.start, value.stop, value.step)]}
    if isinstance(value, np.random.RandomState):
        name, keys, place, has_gauss, gauss = value.get_state()
        return {_MARK: "random state", "state": [name, keys, place, has_gauss, gauss]}
    return None


def _plain_estimator(value: Any, where: str, inner: Callable[..., Any]) -> dict[str, Any]:
    name = _name_of(type(value))
    if name is None:
        raise InputError(_refusal(value, where))
    state = {key: each for key, each in vars(value).items() if key != "_metadata_request"}
    for key in state:
        if not _may_hold(type(value), key):
            raise InputError(f"{where} holds {key!r}, which no model file takes back; keep it by joblib.dump")
    content: dict[str, Any] = {_MARK: "estimator", "class": name}
    if "_metadata_request" in vars(value):
        content["requests"] = inner(value._metadata_request._serialize(), f"{where}.requests")
    return content | {"state": {key: inner(each, f"{where}.{key}") for key, each in state.items()}}


def _plain_array(value: np.ndarray, where: str) -> np.ndarray | dict[str, Any]:
    if value.dtype.kind in "biuf":
        return np.asarray(value)
    if value.dtype.kind in "OU" and all(isinstance(each, str) for each in value.flat):
        return {_MARK: "texts", "values": [str(each) for each in value.flat], "shape": list(value.shape)}
    raise InputError(f"{where} is an array of other things than numbers or texts; a model file holds none")


def _plain_simulation(simulation: ValveSimulation, where: str, depth: int) -> dict[str, Any]:
    external = getattr(simulation, "given_", None)
    return {
        _MARK: "simulation",
        "valve": simulation.valve_.to_dict() if hasattr(simulation, "valve_") else None,
        "state": simulation.to_state(),
        "given": None if external is None else _plain(external, f"{where}.given_", depth + 1),
    }


def _name_of(kind: type) -> str | None:
    if _CLASSES.get(kind.__name__) is kind:
        return kind.__name__
    package, _, module = kind.__module__.partition(".")
    place = module.split(".")[0]
    if package == "sklearn" and place in _OF_SKLEARN and issubclass(kind, BaseEstimator):
        name = f"sklearn.{place}.{kind.__name__}"
        return name if _class_of(name, missing=None) is kind else None
    return None


def _class_of(name: Any, missing: type[Exception] | None = ValueError) -> type | None:
    """A class by its name in the list; none of its own accord is imported but parts of scikit-learn."""
    if name in _CLASSES:
        return _CLASSES[name]
    parts = name.split(".") if isinstance(name, str) else []
    if len(parts) == 3 and parts[0] == "sklearn" and parts[1] in _OF_SKLEARN:
        module = importlib.import_module(f"sklearn.{parts[1]}")
        kind = getattr(module, parts[2], None)
        public = isinstance(kind, type) and issubclass(kind, BaseEstimator) and parts[2].isidentifier()
        # not all of these modules say what is public; what they import from elsewhere is not theirs
        if public and not parts[2].startswith("_") and kind.__module__.startswith(module.__name__):
            return kind
    if missing is None:
        return None
    raise missing("it names a class that is none of a model file's")


def _refusal(value: Any, where: str) -> str:
    kind = type(value)
    if isinstance(value, BaseEstimator):
        what = f"a {kind.__name__}, a kind of which model files hold none"
        mend = "take an estimator of the package or a linear one, or keep this one by joblib.dump"
    elif inspect.isroutine(value) or isinstance(value, np.ufunc | partial):
        what = f"a function ({getattr(value, '__name__', kind.__name__)}), and a model file holds no code"
        mend = "give numbers or the name of what the package knows, or keep the model by joblib.dump"
    else:
        name = value.__name__ if isinstance(value, type) else kind.__name__
        what = f"{'the class' if isinstance(value, type) else 'a'} {name}, and a model file holds none"
        mend = "keep the model by joblib.dump"
    return f"{where} is {what}; {mend}"


def _made(value: Any, known: dict[str, Effect], depth: int) -> Any:
    if depth > _DEEPEST:
        raise ValueError("it is nested too deep")
    inner = partial(_made, known=known, depth=depth + 1)
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, np.ndarray) and value.dtype.kind in "biuf":
        return value
    if isinstance(value, list | tuple):
        return type(value)(inner(each) for each in value)
    if not isinstance(value, dict):
        raise ValueError("it holds something that is no plain data")
    if value.get(_MARK) == "simulation":
        return _made_simulation(value, known, depth)
    return _made_of_mark(value, inner)


def _made_of_mark(value: dict[str, Any], inner: Callable[[Any], Any]) -> Any:
    """What a dict with a mark stands for."""
    kind = value.get(_MARK)
    if kind == "dict":
        return {inner(key): inner(each) for key, each in value["items"]}
    if kind == "dtype":
        return np.dtype(str(value["name"]))
    if kind == "slice":
        return slice(*(None if end is None else int(end) for end in value["ends"]))
    if kind == "texts":
        return np.array([str(each) for each in value["values"]], dtype=object).reshape(value["shape"])
    if kind == "random state":
        made = np.random.RandomState()
        made.set_state(tuple(value["state"]))
        return made
    if kind == "estimator":
        return _made_estimator(value, inner)
    raise ValueError("it holds something that is no part of a model")


def _made_simulation(value: dict[str, Any], known: dict[str, Effect], depth: int) -> ValveSimulation:
    keys = value["state"]["effects"]
    strange = set(keys) - set(known)
    if strange:
        raise ValueError(f"it holds {min(strange)!r}, which is no effect of the catalogue")
    effects = tuple(known[key] for key in keys)
    require_sound_state(value["state"], effects)
    made = ValveSimulation.from_state(Valve.from_dict(value["valve"]), value["state"], effects)
    external = None if value["given"] is None else _made(value["given"], known, depth + 1)
    if external is not None and not isinstance(external, BaseEstimator):
        raise ValueError("the simulation of one's own is no estimator")
    made.given_ = external
    return made


def _made_estimator(value: dict[str, Any], inner: Callable[[Any], Any]) -> BaseEstimator:
    kind: Any = _class_of(value["class"])
    state = value["state"]
    made: Any = object.__new__(kind)
    allowed = set(kind._get_param_names())
    if not isinstance(state, dict) or not allowed <= set(state):
        raise ValueError(f"parameters of {kind.__name__} are missing")
    attributes = {}
    for name, each in state.items():
        if not _may_hold(kind, name):
            raise ValueError(f"{kind.__name__} has no such attribute")
        attributes[name] = inner(each)
    made.__dict__.update(attributes)
    _require_sound(made, kind)
    for method, asked in (inner(value["requests"]) if value.get("requests") else {}).items():
        getattr(made, f"set_{method}_request")(**asked)
    return made


def _may_hold(kind: Any, name: str) -> bool:
    """Whether a class may hold an attribute: a parameter, or what is learnt, named with an underscore."""
    usual = name.endswith("_") or name.startswith("_") or name in kind._get_param_names()
    return (
        usual
        and name.isidentifier()
        and not name.startswith("__")
        and not callable(getattr(kind, name, None))
    )


def _require_sound(made: Any, kind: Any) -> None:
    """Parameters in their ranges, numbers that are finite, parts that are estimators."""
    if hasattr(kind, "_parameter_constraints") and not issubclass(kind, Pipeline | FeatureUnion):
        made._validate_params()
    if issubclass(kind, Pipeline) and not (
        isinstance(made.steps, list) and made.steps and all(_is_step(step) for step in made.steps)
    ):
        raise ValueError("a pipeline has no steps")
    _require_counts(made)
    if kind is LSSVMRegressor:
        _require_finite(made)


def _require_counts(made: Any) -> None:
    """Numbers of threads and of columns that may be."""
    jobs: Any = getattr(made, "n_jobs", None)
    if jobs is not None and not (isinstance(jobs, Integral) and abs(int(jobs)) <= _MOST_THREADS):
        raise ValueError("the number of threads is out of range")
    width: Any = getattr(made, "n_features_in_", 1)
    if isinstance(width, bool) or not isinstance(width, Integral) or not int(width) > 0:
        raise ValueError("the number of columns is none")


def _require_finite(regressor: LSSVMRegressor) -> None:
    for name in _FINITE:
        part: Any = getattr(regressor, name, None)
        if part is not None and not (
            isinstance(part, Real | np.ndarray) and np.isfinite(np.asarray(part)).all()
        ):
            raise ValueError(f"{name} of the LS-SVM holds no finite numbers")


def _is_step(step: Any) -> bool:
    """Whether a step of a pipeline is a name and an estimator, or nothing to be done."""
    if not (isinstance(step, list | tuple) and len(step) == 2 and isinstance(step[0], str)):
        return False
    return step[1] is None or step[1] == "passthrough" or isinstance(step[1], BaseEstimator)
