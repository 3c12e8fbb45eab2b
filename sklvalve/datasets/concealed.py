# SPDX-License-Identifier: BSD-3-Clause
"""Files of a recording with a concealed effect: what a diagnosis may read, and the truth beside it."""

import json
from pathlib import Path

from sklvalve.datasets.plant import make_valve_recording


def write_concealed(folder, effect=None, strength=None, *, name=None, **settings):
    """Make one recording and write it as files.

    `recording.csv.gz` and `valve.toml` are for the diagnosis, `later.csv.gz` for predictions; `truth.json`
    and `flow_without_noise.csv.gz` are for whoever judges them.

    Parameters
    ----------
    folder : str or path
        Where the five files go; made if absent, and files of these names in it are replaced.
    effect, strength
        See :func:`~sklvalve.datasets.make_valve_recording`.
    name : str or None, default=None
        What the truth and the valve's tag call the record. None: the folder's own name.
    **settings
        Further parameters of :func:`~sklvalve.datasets.make_valve_recording`.

    Returns
    -------
    truth : dict
        What is concealed.

    Raises
    ------
    ValueError
        If a setting is unknown to the plant, or `return_truth` is False.

    Examples
    --------
    >>> import tempfile
    >>> from sklvalve.datasets import write_concealed
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     truth = write_concealed(folder, "backlash", 0.04, name="blind_1", n_samples=300, random_state=0)
    >>> truth["name"], truth["verdict"]
    ('blind_1', 'named')
    """
    if not settings.get("return_truth", True):
        raise ValueError("return_truth must stay True here: the truth is one of the files written.")
    folder = Path(folder)
    made = make_valve_recording(effect, strength, **settings)
    truth = made.truth | {"name": folder.resolve().name if name is None else name}
    made.valve["valve"]["tag"] = truth["name"]
    folder.mkdir(parents=True, exist_ok=True)
    for table, stem in (
        (made.frame, "recording"),
        (made.later, "later"),
        (made.flow_without_noise, "flow_without_noise"),
    ):
        # a fixed time stamp inside the archive, so that one seed gives the same bytes
        table.to_csv(folder / f"{stem}.csv.gz", index=False, compression={"method": "gzip", "mtime": 1})
    (folder / "valve.toml").write_text(to_toml(made.valve), encoding="utf-8")
    (folder / "truth.json").write_text(json.dumps(truth, indent=1) + "\n", encoding="utf-8")
    return truth


def to_toml(tables, prefix=""):
    """TOML text of nested dicts of strings, numbers, truth values and lists of these."""
    plain = [f"{key} = {_toml_value(value)}" for key, value in tables.items() if not isinstance(value, dict)]
    text = "\n".join(plain) + ("\n" if plain else "")
    for key, value in tables.items():
        if isinstance(value, dict):
            text += f"\n[{prefix}{key}]\n" + to_toml(value, f"{prefix}{key}.")
    return text.lstrip("\n")


def _toml_value(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_toml_value(item) for item in value) + "]"
    # JSON's strings and numbers are TOML's too
    return json.dumps(value)
