# SPDX-License-Identifier: BSD-3-Clause
"""Models on disk: plain numbers, texts and arrays, read back without running code."""

from __future__ import annotations

import json
from collections.abc import Sequence
from os import PathLike
from typing import Any

from numpy.typing import ArrayLike
from sklearn.base import BaseEstimator
from sklearn.exceptions import NotFittedError
from sklearn.utils.validation import check_is_fitted

from sklvalve.mismatch.effects.base import Effect
from sklvalve.mismatch.files.estimator_file import content_of_estimator, estimator_of_content
from sklvalve.mismatch.files.plain_file import (
    ESTIMATOR,
    MODEL,
    Kind,
    damaged,
    effect_keys,
    effects_by_key,
    read_plain,
    require_known,
    skops_of,
    write_plain,
)
from sklvalve.mismatch.finder import MissingPhysicsFinder
from sklvalve.recording import InputError, Valve
from sklvalve.simulation import ValveSimulation
from sklvalve.simulation.state import require_sound_state

_KIND = Kind(
    "model file",
    (MODEL, ESTIMATOR),
    "give the corrected_model.skops that a diagnosis wrote",
    {
        "sklvalve.history/": "this is the history of a valve, and no model that predicts; give the "
        "corrected_model.skops that a diagnosis wrote, and the history to diagnose as --history"
    },
)


def save_model(path: str | PathLike[str], model: Any, *, rows: ArrayLike | None = None) -> None:
    """Save what a finder found, or another fitted estimator, as a skops file of plain data.

    Parameters
    ----------
    path : str or path-like
    model : MissingPhysicsFinder or another estimator
        Fitted. Estimators of the package, and pipelines and hybrids of them; beside them scikit-learn's
        pipelines, preprocessing, linear models, and others that predict with numpy alone.
    rows : array-like of shape (n_samples, n_features), default=None
        Rows, some of the fit for example, on which an estimator is tried whenever the file is read; the first
        eight are kept in it, with what it predicts of them. None makes some up. A finder needs none.

    Raises
    ------
    InputError
        If the model holds what a model file does not: a function, or an estimator of another kind. So it is
        for a finder that was handed such a simulation.
    NotFittedError
        If the model is not fitted.
    ImportError
        If skops is not installed.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> import numpy as np
    >>> from sklearn.pipeline import make_pipeline
    >>> from sklearn.preprocessing import StandardScaler
    >>> from sklvalve import LSSVMRegressor
    >>> from sklvalve.mismatch import load_model, save_model
    >>> opening = np.linspace(0.0, 1.0, 21)[:, None]
    >>> model = make_pipeline(StandardScaler(), LSSVMRegressor()).fit(opening, opening[:, 0] ** 2)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     save_model(pathlib.Path(folder) / "trim.skops", model, rows=opening)
    ...     again = load_model(pathlib.Path(folder) / "trim.skops")
    >>> bool(np.all(again.predict(opening) == model.predict(opening)))
    True
    """
    skops_of(_KIND)  # its absence is told before anything else
    content = _content_of_finder(model) if hasattr(model, "diagnosis_") else _content_of(model, rows)
    write_plain(path, content, _KIND)


def _content_of(model: Any, rows: ArrayLike | None) -> dict[str, Any]:
    if isinstance(model, MissingPhysicsFinder):
        check_is_fitted(model, "diagnosis_")
    if not isinstance(model, BaseEstimator):
        raise InputError(f"expected a fitted estimator, got {type(model).__name__}")
    return content_of_estimator(model, rows)


def _content_of_finder(finder: MissingPhysicsFinder) -> dict[str, Any]:
    if not hasattr(finder, "corrected_simulation_"):
        raise InputError(
            "this finder diagnosed a loop without pressures, and there is no simulation to save; save the "
            "diagnosis, by diagnosis_.save(...)"
        )
    content = {
        "format": MODEL,
        "valve": finder.corrected_simulation_.valve_.to_dict(),
        "corrected": finder.corrected_simulation_.to_state(),
        "nominal": finder.nominal_simulation_.to_state(),
        "given": _content_of_external(finder.corrected_simulation_.given_),
        "diagnosis": finder.diagnosis_.to_dict(),
    }
    recordings = content["diagnosis"].get("provenance", {}).get("recordings", [])
    if any(each["assumed"] for each in recordings):
        # the clock on which an onset stands was made up: later recordings hold what has begun by now
        for kind in ("corrected", "nominal"):
            content[kind] = content[kind] | {"onsets": {}, "seen": None}
    return content


def _content_of_external(external: Any) -> dict[str, Any] | None:
    """The user's own simulation, without which the corrected one cannot go on; refused here and not then."""
    if external is None:
        return None
    try:
        return content_of_estimator(external)
    except (InputError, NotFittedError, TypeError) as error:
        what = f"a {type(external).__name__}" if hasattr(external, "predict") else "a function"
        raise InputError(
            f"the simulation handed to the finder is {what}, which a model file cannot hold; record what it "
            "predicts as the column simulated_flow, or simulated_opening, and diagnose that, or keep the "
            "finder by joblib.dump"
        ) from error


def load_model(path: str | PathLike[str], effects: Sequence[Effect] = ()) -> Any:
    """Load a model file; nothing in it is executed.

    Parameters
    ----------
    path : str or path-like
    effects : sequence of Effect, default=()
        Those of one's own that the model was found with.

    Returns
    -------
    model : dict or estimator
        Of a finder ``corrected`` and ``nominal``, each a `ValveSimulation`, and ``diagnosis``, a dict; else
        the estimator that was saved.

    Raises
    ------
    InputError
        If the file is missing or no model of this package, holds an effect that is neither of the catalogue
        nor among `effects`, is damaged, or predicts otherwise than when it was saved.
    ImportError
        If skops is not installed.
    """
    content = read_plain(path, _KIND)
    known = effects_by_key(effects)
    return (_built if content["format"] == MODEL else _built_estimator)(path, content, known)


def _built(path: str | PathLike[str], content: dict[str, Any], known: dict[str, Effect]) -> dict[str, Any]:
    """Simulations and diagnosis of what a file holds, each part checked before it is used."""
    try:
        keys = {kind: effect_keys(content[kind]) for kind in ("corrected", "nominal")}
        require_known(path, [key for several in keys.values() for key in several], known, load_model)
        diagnosis = _plain_diagnosis(content["diagnosis"])
        valve = Valve.from_dict(content["valve"], source=str(path))
        simulations = {
            kind: _built_simulation(valve, content[kind], tuple(known[key] for key in several))
            for kind, several in keys.items()
        }
        if content.get("given") is not None:
            external = estimator_of_content(content["given"], known)
            for simulation in simulations.values():
                simulation.given_ = external
    except InputError:
        raise
    except Exception as error:
        raise damaged(path, error, _KIND, "diagnose the recording again") from error
    return simulations | {"diagnosis": diagnosis}


def _plain_diagnosis(content: Any) -> dict[str, Any]:
    # no NaN, no infinity, nothing but plain data
    diagnosis = json.loads(json.dumps(content, allow_nan=False))
    if not isinstance(diagnosis, dict) or not isinstance(diagnosis.get("effects"), list):
        raise ValueError("its diagnosis is none")
    return diagnosis


def _built_simulation(valve: Valve, state: dict[str, Any], effects: tuple[Effect, ...]) -> ValveSimulation:
    require_sound_state(state, effects)
    return ValveSimulation.from_state(valve, state, effects)


def _built_estimator(
    path: str | PathLike[str], content: dict[str, Any], known: dict[str, Effect]
) -> BaseEstimator:
    """The estimator that a file holds, checked and tried before it is used."""
    try:
        return estimator_of_content(content, known)
    except Exception as error:
        raise damaged(path, error, _KIND, "save the model again") from error
