# SPDX-License-Identifier: BSD-3-Clause
"""The pages as files: index.html, a page a valve, and the full reports beside them."""

from __future__ import annotations

import os
import shutil
from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path
from urllib.parse import quote

from sklvalve._replacing import replacing
from sklvalve.recording.errors import InputError
from sklvalve.watch.plant import Plant
from sklvalve.watch.site.pages import STATES, ValvePage, headline_of, in_order, page_of
from sklvalve.watch.standing import epochs_of, standing_of
from sklvalve.watch.store import Store
from sklvalve.watch.valve import Watch


def write_site(
    folder: str | os.PathLike[str], plant: Plant, watches: Sequence[Watch], state: str | os.PathLike[str]
) -> Path:
    """Write the pages of a plant.

    Parameters
    ----------
    folder : path-like
        Where they go; made if it is not there. Each page is replaced whole.
    plant : Plant
    watches : sequence of Watch
        As `watch` gives them.
    state : path-like
        The state of the same watch.

    Returns
    -------
    index : Path

    Raises
    ------
    InputError
        If the folder is a file.
    ImportError
        If jinja2 is not installed.
    """
    place, store = Path(folder), Store(state)
    if place.exists() and not place.is_dir():
        raise InputError(f"--site {place}: this is a file; name a folder")
    now = [standing_of(each.tag, store, epochs_of(each.tag, store)[-1]) for each in watches]
    newest = max((each.records[-1].day for each in now if each.records), default=None)
    pages = [
        page_of(each, standing, store, plant.false_calls, newest)
        for each, standing in zip(watches, now, strict=True)
    ]
    environment = _environment()
    style = _part("site.css")
    for page in pages:
        report = _report(place, store, page)
        text = environment.from_string(_part("valve.html.j2")).render(
            plant=plant.name, page=page, report=report, style=style
        )
        _write(place / "valves" / f"{page.tag}.html", text)
    text = environment.from_string(_part("plant.html.j2")).render(
        plant=plant.name,
        headline=headline_of(plant, pages),
        pages=in_order(pages),
        states=STATES,
        newest=newest,
        false_calls=plant.false_calls,
        style=style,
    )
    _write(place / "index.html", text)
    return place / "index.html"


def _report(place: Path, store: Store, page: ValvePage) -> str:
    """Copy a call's full report beside the pages; its address as the valve's page has it."""
    source = store.folder / page.report
    if not page.report or not source.is_file():
        return ""
    day = Path(page.report).parent.name
    target = place / "reports" / page.tag / f"{day}.html"
    target.parent.mkdir(parents=True, exist_ok=True)
    with replacing(target) as draft:
        shutil.copyfile(source, draft)
    return f"../reports/{quote(page.tag)}/{day}.html"


def _environment():
    try:
        from jinja2 import Environment, StrictUndefined
    except ImportError:
        raise ImportError('the pages need jinja2: pip install "sklvalve[report]"') from None
    made = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    made.filters["address"] = quote
    return made


def _part(name: str) -> str:
    return (files("sklvalve.watch.site") / "templates" / name).read_text(encoding="utf-8")


def _write(file: Path, text: str) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    with replacing(file) as draft:
        draft.write_text(text, encoding="utf-8")
