# SPDX-License-Identifier: BSD-3-Clause
"""The account of an import as a short text for the terminal."""

from collections.abc import Mapping

_HEADINGS = ("tag", "reports", "bad", "doubled", "resampled", "filled", "missing", "gaps", "between reports")


def summary(account: Mapping) -> str:
    """Tell what was read, assumed and done.

    Parameters
    ----------
    account : mapping
        Of `import_export`.

    Returns
    -------
    text : str
        Lines of at most about 110 letters.
    """
    parts = [_files(account["files"]), *_times(account["times"])]
    notes = _assumed(account)
    if "runs" in account:
        parts += _runs(account)
        notes += _of_runs([_noted(run) for run in account["runs"]])
    else:
        parts += [_base(account["base"]), "", _table(account)]
        notes += _noted(account)
    if notes:
        parts += ["", *(f"- {note}" for note in notes)]
    return "\n".join(parts)


def _runs(account: Mapping) -> list[str]:
    """That the clock starts again, and what became of each run."""
    runs, empty = account["runs"], account["runs_left_out"]
    again = len(runs) + empty - 1
    lines = [
        f"The clock starts again {again} time{'s' if again > 1 else ''}: {len(runs)} "
        f"run{'s' if len(runs) > 1 else ''}, each a recording of its own."
    ]
    if empty:
        lines.append(f"{empty} more without values at two times {'are' if empty > 1 else 'is'} left out.")
    for number, run in enumerate(runs, start=1):
        called = f" ({run['recording']})" if "recording" in run else ""
        lines.append(f"Run {number}{called}, from line {run['line']}: {_base(run['base'])}")
    return lines


def _of_runs(noted: list[list[str]]) -> list[str]:
    """Notes of all runs, each with the numbers of those that it is about, where these are not all."""
    where: dict[str, list[int]] = {}
    for number, notes in enumerate(noted, start=1):
        for note in notes:
            where.setdefault(note, []).append(number)
    return [
        note if len(runs) == len(noted) else f"run {', '.join(map(str, runs))}: {note}"
        for note, runs in where.items()
    ]


def _files(files: list[dict]) -> str:
    lines = []
    for each in files:
        comma = ", decimal commas" if each["decimal"] == "," else ""
        lines.append(
            f"{each['file']}: {each['format']} format, {each['separator']}{comma}, {each['encoding']}; "
            f"{each['rows']} rows"
        )
    return "\n".join(lines)


def _times(times: dict) -> list[str]:
    lines = []
    if times["kind"] == "local":
        zone = times["zone"]
        lines.append(f"Local time of {zone}." if zone else "Local time, of a zone not given (--timezone).")
    for hour, stamps in times["repeated_hour"].items():
        lines.append(f"The hour from {hour} is there twice: {stamps} stamps told apart by their order.")
    for hour, stamps in times["repeated_hour_assumed_first"].items():
        lines.append(f"The hour from {hour} has two meanings: {stamps} stamps taken for the first of them.")
    for hour, stamps in times["missing_hour"].items():
        lines.append(f"The hour from {hour} does not exist: {stamps} stamps read as of a clock set late.")
    return lines


def _base(base: dict) -> str:
    how = "as asked" if base["chosen_by"] == "--period" else "chosen from the stamps"
    cut = (
        " Rows outside of the times asked for are left out; reports are counted of the whole export."
        if base["cut"]
        else ""
    )
    return (
        f"{base['rows']} rows from {base['first']} to {base['last']}, every {base['period']:g} s ({how}); "
        f"silences of more than {base['gap']:g} usual steps stay empty.{cut}"
    )


def _table(account: Mapping) -> str:
    rows = [_HEADINGS]
    for tag, each in account["tags"].items():
        unit = f" [{each['unit']}]" if each["unit"] else ""
        numbers = (
            each["reports"], sum(each["bad"].values()) + sum(each["states"].values()), each["doubled"],
            each["resampled"], each["filled"], each["missing"], each["gaps"],
        )  # fmt: skip
        rows.append((tag + unit, *map(str, numbers), each["method"]))
    widths = [max(len(row[place]) for row in rows) for place in range(len(_HEADINGS))]
    return "\n".join(
        "  ".join(
            cell.ljust(width) if place in (0, len(widths) - 1) else cell.rjust(width)
            for place, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    )


def _assumed(account: Mapping) -> list[str]:
    notes = []
    if account["times"]["day_first_assumed"]:
        notes.append("Dates such as 03/04 are taken as day/month: nothing tells (--dates month-first).")
    for each in account["files"]:
        if each["decimal_assumed"]:
            called = "decimal commas" if each["decimal"] == "," else "thousands"
            notes.append(f"{each['file']}: commas are taken for {called}: nothing tells (--decimal).")
        if each["encoding"] == "cp1252":
            notes.append(f"{each['file']}: no UTF-8, taken for Windows-1252 (--encoding).")
        if each["lines_skipped"]:
            notes.append(f"{each['file']}: {each['lines_skipped']} lines hold no row and were skipped.")
    return notes


def _noted(account: Mapping) -> list[str]:
    """Notes on tags, those that are alike in one line."""
    notes = [f"{tag} is left out: it {why}." for tag, why in account["left_out"].items()]
    alike: dict[str, list[str]] = {}
    for tag, each in account["tags"].items():
        for note in _of_tag(each):
            alike.setdefault(note, []).append(tag)
    notes += [f"{', '.join(tags)}: {note}" for note, tags in alike.items()]
    if account["base"]["rows_without_any_value"]:
        notes.append(f"{account['base']['rows_without_any_value']} rows without any value were left out.")
    return notes


def _of_tag(each: dict) -> list[str]:
    notes = []
    for what, counted in (("without a value", each["bad"]), ("no numbers", each["states"])):
        if counted:
            listed = ", ".join(f"{text} {count}" for text, count in list(counted.items())[:4])
            notes.append(f"{what}: {listed}{', ...' if len(counted) > 4 else ''}.")
    if each["out_of_order"]:
        notes.append(f"{each['out_of_order']} stamps ran back, and were put in order.")
    if each["contradicting"]:
        notes.append(f"{each['contradicting']} doubled stamps came with different values; the last stays.")
    if each["reports_by"] == "exception" and each["longest_bridged"] > 0.0:
        notes.append(
            f"reports by exception; up to {each['longest_bridged']:.4g} s of its silence were bridged."
        )
    if each["gaps"]:
        notes.append(f"the longest gap left empty lasts {each['longest_gap']:.4g} s.")
    if each["unused"]:
        notes.append(f"{each['unused']} reports fall between two rows and are not used as they are.")
    return notes
