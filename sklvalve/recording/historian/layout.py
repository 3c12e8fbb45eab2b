# SPDX-License-Identifier: BSD-3-Clause
"""From a table to series: which column holds times, tags, values and quality, in long or wide format."""

import re
import unicodedata
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording.errors import InputError, hint, listed, shown
from sklvalve.recording.historian.decimals import looks_numeric, unit_behind
from sklvalve.recording.historian.moments import looks_like_clock, looks_like_time
from sklvalve.recording.historian.quality import speaks_of_quality
from sklvalve.recording.historian.table import Table
from sklvalve.recording.tags import bare, read_time_name, split_unit, words

_TAG = words.word_set(
    """tag tagname tagid name pointname point pointid item itemid signal signalname variable varname
    variablename series messstelle znacznik nazwa zmienna sygnal etiqueta nombre senal nom repere
    mnemonique path nodeid browsename parameter sensor"""
)
_VALUE = words.word_set(
    """value val values wert istwert wartosc valeur valor dane reading data processvalue"""
)
_QUALITY = words.word_set(
    """quality qual qualitat qualitaet status state opcquality good isgood valid questionable jakosc
    qualite calidad estado statut statuscode qualitycode zustand"""
)
# of these a quality is called, and nothing else; a status may be that of a pump
_QUALITY_ALONE = words.word_set(
    "quality qual qualitat qualitaet opcquality jakosc qualite calidad statuscode qualitycode isgood"
)
_UNIT = words.word_set("unit units uom eu engunits engineeringunits einheit jednostka unite unidad")
_SAMPLE = 50


@dataclass(frozen=True)
class Clock:
    """Times of a table: cells that stand for whole moments, and the unit where they are counted."""

    cells: list[str]
    unit: str
    name: str


@dataclass(frozen=True)
class Series:
    """Cells of one tag in one file, in the order of its rows.

    `rows` are rows of the table; `clock` the place of its times among the table's clocks; `quality` is None
    where the file gives none, and `quality_name` what its column is called; `stated` tells whether an empty
    cell says that there was no value, as it does in long format, instead of that nothing was reported.
    """

    tag: str
    unit: str
    clock: int
    rows: NDArray[np.intp]
    values: list[str]
    quality: list[str] | None
    quality_name: str
    stated: bool


@dataclass(frozen=True)
class Layout:
    """A table understood: its format, ``"long"`` or ``"wide"``, its clocks and its series."""

    format: str
    clocks: list[Clock]
    series: list[Series]


def read_layout(table: Table, time_column: str | None = None) -> Layout:
    """Tell times, tags, values and qualities of a table apart.

    Parameters
    ----------
    table : Table
    time_column : str or None, default=None
        Name of the column of the times; None finds it.

    Returns
    -------
    layout : Layout

    Raises
    ------
    InputError
        If no column holds times, or none values, there is no column of the name given, or the columns have
        no names in wide format.
    """
    plain = [_plain(name) for name in table.names]
    headed = any(plain)
    times: list[tuple[int, ...]] = [] if time_column is None else [(_asked(table, time_column),)]
    times = times or _time_columns(table)
    if not times:
        known = f" (columns: {listed(table.names)})" if headed else ""
        raise InputError(
            f"{table.file}: no column holds times{known}; name it by --time-column, or export with time "
            "stamps, best like 2024-06-28 14:35:00"
        )
    if not headed:
        return _long(table, times, *_unnamed_long(table, times))
    tag = _find(plain, _TAG)
    value = _find(plain, _VALUE)
    if tag is not None and value is None:
        raise InputError(
            f"{table.file}: column {shown(table.names[tag])} holds tags, but none is named value (columns: "
            f"{listed(table.names)}); name the column of the values so"
        )
    if tag is not None and value is not None and tag not in times:
        quality = _find(plain, _QUALITY)
        if quality is not None and not speaks_of_quality(table.columns[quality], table.names[quality]):
            quality = None
        return _long(table, times, tag, value, quality, _find(plain, _UNIT))
    return _wide(table, times, plain)


def _asked(table: Table, name: str) -> int:
    """Place of the column that is asked for by its name, with or without the unit in it."""
    for names in (table.names, [split_unit(each)[0] for each in table.names]):
        for place, each in enumerate(names):
            if each and each.casefold() == name.strip().casefold():
                return place
    known = [each for each in table.names if each]
    near = hint(name, known) if known else "its columns have no names"
    raise InputError(f"--time-column {name}: {table.file} has no such column; {near}")


def _plain(name: str) -> str:
    """A column's name in small letters, without accents, blanks and signs."""
    text = unicodedata.normalize("NFKD", split_unit(name)[0].casefold().translate({ord("ł"): "l"}))
    return re.sub(r"[^a-z0-9]", "", text.encode("ascii", "ignore").decode())


def _find(plain: list[str], known: frozenset[str]) -> int | None:
    return next((place for place, name in enumerate(plain) if name in known), None)


def _time_columns(table: Table) -> list[tuple[int, ...]]:
    """Columns of whole moments; a date and the time of day beside it count as one."""
    found: list[tuple[int, ...]] = []
    kinds = [_kind(column) for column in table.columns]
    for place, kind in enumerate(kinds):
        if kind == "time":
            bare = ":" not in next(filter(None, table.columns[place]), "")
            beside = place + 1 < len(kinds) and kinds[place + 1] == "clock"
            found.append((place, place + 1) if bare and beside else (place,))
    if not found:
        named = [place for place, name in enumerate(table.names) if read_time_name(name) is not None]
        counted = [place for place in named if kinds[place] == "number"]
        # a column that is named for the time is one, whatever stands in it: its cells get their own message
        found = [(place,) for place in (counted or named)[:1]]
    return found


def _kind(column: list[str]) -> str:
    cells = [cell for cell in column[: 20 * _SAMPLE] if cell][:_SAMPLE]
    for kind, test in (("time", looks_like_time), ("clock", looks_like_clock), ("number", looks_numeric)):
        if cells and 2 * sum(map(test, cells)) > len(cells):
            return kind
    return "text" if cells else "empty"


def _unnamed_long(table: Table, times: list[tuple[int, ...]]) -> tuple[int, int, int | None, int | None]:
    """Columns of a long table without a header, told by what they hold."""
    free = [place for place in range(len(table.columns)) if place not in times[0]]
    kinds = {place: _kind(table.columns[place]) for place in free}
    tags = [place for place in free if kinds[place] == "text"]
    numbers = [place for place in free if kinds[place] == "number"]
    if not tags or not numbers:
        raise InputError(
            f"{table.place(0)}: values begin without names of columns above them; put a line above, such as "
            "time;FIC101.PV;FIC101.OP, or export with a header"
        )
    rest = [place for place in free if place not in (tags[0], numbers[0])]
    return tags[0], numbers[0], (rest[0] if rest else None), None


def _clock(table: Table, columns: tuple[int, ...]) -> Clock:
    cells = table.columns[columns[0]]
    if len(columns) == 2:
        beside = table.columns[columns[1]]
        cells = [f"{day} {clock}".strip() for day, clock in zip(cells, beside, strict=True)]
    name = table.names[columns[0]]
    return Clock(cells, read_time_name(name) or split_unit(name)[1] or bare(table.units[columns[0]]), name)


def _long(
    table: Table, times: list[tuple[int, ...]], tag: int, value: int, quality: int | None, unit: int | None
) -> Layout:
    clock = _clock(table, times[0])
    rows_of: dict[str, list[int]] = {}
    for row, name in enumerate(table.columns[tag]):
        rows_of.setdefault(name, []).append(row)
    if "" in rows_of:
        raise InputError(
            f"{table.place(rows_of[''][0])}: the tag is missing; write it there, or leave the line out"
        )
    series = []
    for name, rows in rows_of.items():
        text, inside = split_unit(name)
        values = [table.columns[value][row] for row in rows]
        given = table.columns[unit][rows[0]] if unit is not None else ""
        series.append(
            Series(
                tag=text,
                unit=given or inside or unit_behind(values[:_SAMPLE]),
                clock=0,
                rows=np.array(rows, dtype=np.intp),
                values=values,
                quality=None if quality is None else [table.columns[quality][row] for row in rows],
                quality_name="" if quality is None else table.names[quality],
                stated=True,
            )
        )
    return Layout("long", [clock], series)


def _wide(table: Table, times: list[tuple[int, ...]], plain: list[str]) -> Layout:
    taken = {place for columns in times for place in columns}
    series: list[Series] = []
    rows = np.arange(len(table.lines))
    for place, name in enumerate(table.names):
        if place in taken or not name:
            continue
        taken.add(place)
        # times to its left, as trend exports have them, else the first
        clock = max((k for k, columns in enumerate(times) if columns[0] < place), default=0)
        tag, unit = split_unit(name)
        if plain[place] in _VALUE or _value_of(tag):
            tag = _value_of(tag) or table.file.name.split(".")[0]
        beside = place + 1
        has_quality = beside < len(table.names) and beside not in taken and _is_quality(table, beside, tag)
        if has_quality:
            taken.add(beside)
        series.append(
            Series(
                tag=tag,
                unit=unit or bare(table.units[place]) or unit_behind(table.columns[place][:_SAMPLE]),
                clock=clock,
                rows=rows,
                values=table.columns[place],
                quality=table.columns[beside] if has_quality else None,
                quality_name=table.names[beside] if has_quality else "",
                stated=False,
            )
        )
    if not series:
        raise InputError(
            f"{table.file}: beside the time there is no column with a name and values; export the signals too"
        )
    return Layout("wide", [_clock(table, columns) for columns in times], series)


def _is_quality(table: Table, place: int, tag: str) -> bool:
    """Whether a column tells how good the values of the tag on its left are.

    A tag of the plant may end so too: the status of a pump says nothing of the flow beside it. So a column
    with more in its name than such a word belongs to the tag only where it repeats the tag's name, or, called
    a quality, the beginning of it; and what stands in it must be what historians say of a value.
    """
    name = table.names[place].strip()
    parts = re.split(r"[\s._/|-]+", name)
    ending = next((len(parts) - k for k in (2, 1) if _plain("".join(parts[-k:])) in _QUALITY), None)
    if ending is None or not speaks_of_quality(table.columns[place], name):
        return False
    alone = _plain("".join(parts[ending:])) in _QUALITY_ALONE
    if not alone and {*table.columns[place]} <= {"0", "1", "0.0", "1.0", ""}:
        return False  # of a status that is 0 and 1 nobody knows which is good, or whether it is of the tag
    before, own = _plain("".join(parts[:ending])), _plain(tag)
    return not before or before == own or (alone and own.startswith(before))


def _value_of(tag: str) -> str:
    """Tag of a column that a trend export calls `FIC101 ValueY`."""
    match = re.fullmatch(r"(.+?)[\s._]+(?:ValueY|Value|Wert)", tag)
    return match[1] if match else ""
