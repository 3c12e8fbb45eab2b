# SPDX-License-Identifier: BSD-3-Clause
"""Files of a recording with a concealed effect: what a diagnosis may read, and the truth beside it."""

import json
from numbers import Integral
from pathlib import Path

from sklearn.utils import check_random_state

from sklvalve.datasets._plant_detectable import beyond
from sklvalve.datasets._plant_parameters import catalogue_parameters
from sklvalve.datasets.plant import draw_plant, make_valve_recording


class UnreachableSize(ValueError):
    """So many times its detectable size an effect cannot have in this record: draw another one."""


def write_concealed(folder, effect=None, strength=None, *, name=None, times=None, **settings):
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
    times : tuple of two floats or None, default=None
        Draw each effect's size between so many times the smallest one that this record could tell, instead of
        a `strength`. The truth then holds under `detectable` that size, how many times it was taken, and the
        squared sum of the whitened change at it (25) with its rms where it acts, as share of the span.
    **settings
        Further parameters of :func:`~sklvalve.datasets.make_valve_recording`.

    Returns
    -------
    truth : dict
        What is concealed; `parameters` holds the catalogue's own main parameter of each effect, where it is
        the same quantity.

    Raises
    ------
    ValueError
        If a setting is unknown to the plant, `return_truth` is False, or `strength` and `times` are given.
    UnreachableSize
        If an effect so many times its detectable size is not possible in this record; nothing is written.

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
    if times is not None and strength is not None:
        raise ValueError("strength or times sets the size of an effect, not both; leave one of them out.")
    folder, more = Path(folder), {}
    names = [] if effect is None else [effect] if isinstance(effect, str) else list(effect)
    if not isinstance(settings.get("random_state"), Integral):
        # the plant is drawn more than once
        settings["random_state"] = check_random_state(settings.get("random_state")).randint(2**31 - 1)
    if times is not None and names:
        strength, more = _sizes(names, times, settings)
    made = make_valve_recording(effect, strength, **settings)
    truth = made.truth | {"name": folder.resolve().name if name is None else name} | more
    plant, onset, _ = _plant(names, settings)
    truth["parameters"] = catalogue_parameters(plant, truth["strengths"], onset)
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


def _plant(names, settings):
    """The plant that these settings draw, the onset, and the seed of what the effects draw themselves."""
    given = {"onset": 0.0, "n_samples": 5760, "n_later": 1440, "loop": None, "noise": 1.0}
    given["random_state"] = settings["random_state"]
    given |= {key: settings[key] for key in given if key in settings}
    return draw_plant(names, **given)[:3]


def _sizes(names, times, settings):
    plant, onset, seed = _plant(names, settings)
    level, rows = settings.get("noise", 1.0), settings.get("n_samples", 5760)
    sizes, told = [], {}
    for name in names:
        size, factor, found = beyond(plant, name, onset, seed, level, rows, times)
        if size is None:
            raise UnreachableSize(f"{name} of {times[0]:g} times its detectable size is not possible here.")
        sizes.append(size)
        told[name] = {
            "size": round(float(found.size), 6),
            "times": round(float(factor), 3),
            "distance": round(found.distance, 1),
            "share": round(found.share, 5),
        }
    return sizes, {"detectable": told}


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
