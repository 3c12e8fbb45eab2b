# SPDX-License-Identifier: BSD-3-Clause
"""Tables in Markdown."""


def row(cells):
    """A row; what would end a cell is told apart."""
    return "| " + " | ".join(str(cell).replace("|", "\\|").replace("\n", " ") for cell in cells) + " |"


def table(head, rows):
    """A table; "-" where it has no rows."""
    rows = list(rows)
    return "\n".join([row(head), "|" + "---|" * len(head), *map(row, rows)]) if rows else "-"


def section(title, *parts):
    """Parts under a title, those that are empty left out; nothing where all are."""
    held = [part for part in parts if part and part != "-"]
    return "\n\n".join([f"### {title}", *held]) if held else ""
