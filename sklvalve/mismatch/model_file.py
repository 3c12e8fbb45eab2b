# SPDX-License-Identifier: BSD-3-Clause
"""Models on disk: plain numbers, texts and arrays, read back without running code."""

import json
import os
import secrets
from pathlib import Path

from sklvalve.mismatch.effects import CATALOGUE, EVENTS, LATE
from sklvalve.mismatch.packed_model import require_plain_archive
from sklvalve.recording import InputError, Valve
from sklvalve.recording.errors import shown
from sklvalve.recording.files import read_plain_file
from sklvalve.simulation import ValveSimulation
from sklvalve.simulation.state import require_sound_state

_FORMAT = "sklvalve.model/1"
_LARGEST = 256 << 20  # bytes


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
    # not by tempfile, whose files are the owner's alone: a result is as readable as the umask has it
    draft = path.with_name(f".{path.name}.{secrets.token_hex(4)}")
    try:
        skops_io.dump(content, draft)
        os.replace(draft, path)
    except BaseException:
        draft.unlink(missing_ok=True)
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
    packed = read_plain_file(
        path,
        missing="give the corrected_model.skops of a diagnosis",
        folder="give the corrected_model.skops of a diagnosis",
        most=_LARGEST,
    )
    try:
        require_plain_archive(packed)
        content = skops_io.loads(packed, trusted=[])
        if content.get("format") != _FORMAT:
            raise ValueError("it has another format")
    except Exception as error:
        more = f" ({error})" if type(error) is ValueError and len(str(error)) < 100 else ""
        raise InputError(
            f"{path}: this is no model file of sklvalve{more}; give the corrected_model.skops that a "
            "diagnosis wrote"
        ) from error
    return _built(path, content, {e.key: e for e in (*CATALOGUE, *EVENTS, *LATE, *effects)})


def _built(path, content, known):
    """Simulations and diagnosis of what a file holds, each part checked before it is used."""
    try:
        keys = {kind: _effect_keys(content[kind]) for kind in ("corrected", "nominal")}
        strange = {key for several in keys.values() for key in several} - set(known)
        if strange:
            raise InputError(
                f"{path}: the model holds {shown(min(strange))[1:-1]}, which is no effect of the catalogue; "
                "give it to load_model as one of effects"
            )
        # no NaN, no infinity, nothing but plain data
        diagnosis = json.loads(json.dumps(content["diagnosis"], allow_nan=False))
        if not isinstance(diagnosis, dict) or not isinstance(diagnosis.get("effects"), list):
            raise ValueError("its diagnosis is none")
        valve = Valve.from_dict(content["valve"], source=str(path))
        made = {}
        for kind, several in keys.items():
            effects = tuple(known[key] for key in several)
            require_sound_state(content[kind], effects)
            made[kind] = ValveSimulation.from_state(valve, content[kind], effects)
    except InputError:
        raise
    except Exception as error:
        more = f": {error}" if type(error) is ValueError and len(str(error)) < 100 else ""
        raise InputError(
            f"{path}: this is no model file of sklvalve that can be used (a part of it is damaged{more}); "
            "diagnose the recording again"
        ) from error
    return made | {"diagnosis": diagnosis}


def _effect_keys(state):
    keys = state["effects"]
    if not isinstance(keys, list | tuple) or not all(isinstance(key, str) for key in keys):
        raise ValueError("its effects are no names")
    if len(set(keys)) < len(keys):
        raise ValueError("it names an effect twice")
    return keys


def _skops():
    try:
        import skops.io
    except ImportError:
        raise ImportError('model files need skops: pip install "sklvalve[skops]"') from None
    return skops.io
