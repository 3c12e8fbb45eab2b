# SPDX-License-Identifier: BSD-3-Clause
"""Models on disk: plain numbers, texts and arrays, read back without running code."""

import os
import tempfile
from pathlib import Path

from sklvalve.mismatch.effects import CATALOGUE, EVENTS, LATE
from sklvalve.recording import InputError, Valve
from sklvalve.simulation import ValveSimulation

_FORMAT = "sklvalve.model/1"


def save_model(path, finder):
    """Save what a finder found, as a skops file.

    Parameters
    ----------
    path : str or path-like
    finder : MissingPhysicsFinder
        Fitted.

    Raises
    ------
    ImportError
        If skops is not installed.
    """
    skops_io = _skops()
    content = {
        "format": _FORMAT,
        "valve": finder.corrected_simulation_.valve_.to_dict(),
        "corrected": finder.corrected_simulation_.to_state(),
        "nominal": finder.nominal_simulation_.to_state(),
        "diagnosis": finder.diagnosis_.to_dict(),
    }
    recordings = content["diagnosis"].get("provenance", {}).get("recordings", [])
    if any(each["assumed"] for each in recordings):
        # the clock on which an onset stands was made up: later recordings hold what has begun by now
        for kind in ("corrected", "nominal"):
            content[kind] = content[kind] | {"onsets": {}, "seen": None}
    path = Path(path)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    os.close(handle)
    try:
        skops_io.dump(content, name)
        # a temporary file is the owner's alone; a result is as readable as any other file
        os.chmod(name, 0o644)
        os.replace(name, path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def load_model(path, effects=()):
    """Load a model file; nothing in it is executed.

    Parameters
    ----------
    path : str or path-like
    effects : sequence of Effect, default=()
        Those of one's own that the model was found with.

    Returns
    -------
    model : dict
        ``corrected`` and ``nominal``, each a `ValveSimulation`; ``diagnosis``, a dict.

    Raises
    ------
    InputError
        If the file is missing or no model of this package, or holds an effect that is neither of the
        catalogue nor among `effects`.
    ImportError
        If skops is not installed.
    """
    skops_io = _skops()
    if not Path(path).is_file():
        raise InputError(f"{path}: no such file; give the corrected_model.skops of a diagnosis")
    try:
        content = skops_io.load(path, trusted=[])
        if content.get("format") != _FORMAT:
            raise ValueError("other format")
        known = {e.key: e for e in (*CATALOGUE, *EVENTS, *LATE, *effects)}
        strange = {key for kind in ("corrected", "nominal") for key in content[kind]["effects"]} - set(known)
        if strange:
            raise InputError(
                f"{path}: the model holds {min(strange)}, which is no effect of the catalogue; give it to "
                "load_model as one of effects"
            )
        valve = Valve.from_dict(content["valve"], source=str(path))
        simulations = {
            kind: ValveSimulation.from_state(
                valve, content[kind], tuple(known[key] for key in content[kind]["effects"])
            )
            for kind in ("corrected", "nominal")
        }
    except InputError:
        raise
    except Exception as error:
        raise InputError(
            f"{path}: this is no model file of sklvalve; give the corrected_model.skops that a diagnosis "
            "wrote"
        ) from error
    return simulations | {"diagnosis": content["diagnosis"]}


def _skops():
    try:
        import skops.io
    except ImportError:
        raise ImportError('model files need skops: pip install "sklvalve[skops]"') from None
    return skops.io
