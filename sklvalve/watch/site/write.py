# SPDX-License-Identifier: BSD-3-Clause
"""The pages as files: index.html, a page a valve, and the full reports beside them."""

from __future__ import annotations

import datetime as dt
import os
import shutil
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from importlib.resources import files
from pathlib import Path
from urllib.parse import quote

from sklvalve._replacing import replacing
from sklvalve.recording.errors import InputError
from sklvalve.watch.plant import Plant
from sklvalve.watch.processes import side_by_side
from sklvalve.watch.site.pages import STATES, ValvePage, headline_of, in_order, page_of
from sklvalve.watch.standing import epochs_of, standing_of
from sklvalve.watch.store import Store
from sklvalve.watch.valve import Watch


def write_site(
    folder: str | os.PathLike[str],
    plant: Plant,
    watches: Sequence[Watch],
    state: str | os.PathLike[str],
    *,
    n_jobs: int | None = 1,
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
    n_jobs : int, default=1
        Processes that write the valves' pages; None is one for each processor.

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
    newest = max((day for each in watches if (day := store.newest(each.tag)) is not None), default=None)
    template = _template("plant.html.j2")
    jobs = [(place, plant.name, plant.false_calls, each, store.folder, newest) for each in watches]
    pages = list(side_by_side(_valve, jobs, n_jobs))
    text = template.render(
        plant=plant.name,
        headline=headline_of(plant, pages),
        pages=in_order(pages),
        states=STATES,
        newest=newest,
        false_calls=plant.false_calls,
        style=_part("site.css"),
    )
    _write(place / "index.html", text)
    return place / "index.html"


def _valve(
    place: Path, plant: str, false_calls: float, watch: Watch, state: Path, newest: dt.date | None
) -> ValvePage:
    """Write a valve's page; what the plant's page says of it."""
    store = Store(state)
    standing = standing_of(watch.tag, store, epochs_of(watch.tag, store)[-1])
    page = page_of(watch, standing, store, false_calls, newest)
    text = _template("valve.html.j2").render(
        plant=plant, page=page, report=_report(place, store, page), style=_part("site.css")
    )
    _write(place / "valves" / f"{page.tag}.html", text)
    return replace(page, pictures=())


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


@cache
def _template(name: str):
    try:
        from jinja2 import Environment, StrictUndefined
    except ImportError:
        raise ImportError('the pages need jinja2: pip install "sklvalve[report]"') from None
    made = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    made.filters["address"] = quote
    return made.from_string(_part(name))


@cache
def _part(name: str) -> str:
    return (files("sklvalve.watch.site") / "templates" / name).read_text(encoding="utf-8")


def _write(file: Path, text: str) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    with replacing(file) as draft:
        draft.write_text(text, encoding="utf-8")
