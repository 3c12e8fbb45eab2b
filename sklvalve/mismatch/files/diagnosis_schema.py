# SPDX-License-Identifier: BSD-3-Clause
"""What diagnosis.json may hold, as a JSON Schema."""

from __future__ import annotations

import json
from importlib.resources import files
from typing import Any


def diagnosis_schema() -> dict[str, Any]:
    """JSON Schema (draft 2020-12) of diagnosis.json, format ``sklvalve.diagnosis/1``.

    It holds every key with its type, its range and its unit; a key that it does not hold is refused. Nothing
    here checks a file by it: that is the work of a validator, such as the package ``jsonschema``.

    Returns
    -------
    schema : dict
        A copy. Names of effects are those of the catalogue; add your own to the ``enum`` of
        ``$defs.effect_name`` and their keys to that of ``$defs.effect_form``.

    Examples
    --------
    >>> from sklvalve.mismatch import diagnosis_schema
    >>> diagnosis_schema()["$defs"]["verdict"]["enum"]
    ['no_mismatch', 'named', 'none_of_these', 'cannot_tell']
    """
    return json.loads(files(__package__).joinpath("diagnosis.schema.json").read_text(encoding="utf-8"))
