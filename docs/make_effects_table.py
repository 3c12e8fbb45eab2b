# SPDX-License-Identifier: BSD-3-Clause
"""Make docs/effects.md from the catalogue: every effect, its equation, its parameters, what it needs."""

import inspect
import re
from itertools import groupby
from pathlib import Path

from sklvalve.mismatch.effects import CATALOGUE, EVENTS, Effect

TARGET = Path(__file__).with_name("effects.md")
BLOCKS = ("actuator", "valve", "line", "measurement")
HEAD = """# Effects

What a simulation may leave out, as far as `sklvalve` knows it: {names} effects in {forms} forms. Made by
`docs/make_effects_table.py` from the files in `sklvalve/mismatch/effects`; [extending.md](extending.md) shows
how to add one.

Forms are variants of an effect that act elsewhere or show otherwise; a diagnosis tells the effect's name.
Effects of one family share an equation, so an explanation holds one of them at most. Bounds are what is
physically possible; where none stand here they follow from the data sheet and the recording. The fault is the
one of the DAMADICS benchmark with the same physics.

The kind says what an effect is that is there from the start: a fault; a property of a sound valve, its
fluid or its line, that a simulation may lack; or either. What begins within the recording, or grows, is a
fault, unless the fluid changed. `slew_limit` is a property of a motor, and either where air is known to drive
the stem.
"""


def page():
    """The whole page as text."""
    names = len({effect.name for effect in CATALOGUE})
    parts = [HEAD.format(names=names, forms=len(CATALOGUE) + len(EVENTS)), _overview()]
    for block in BLOCKS:
        inside = sorted((e for e in (*CATALOGUE, *EVENTS) if e.block == block), key=lambda e: e.name)
        parts.append(f"## {block.capitalize()}\n")
        for name, forms in groupby(inside, key=lambda e: e.name):
            parts.append(f"### {name}\n")
            parts += [_entry(form) for form in forms]
    return "\n".join(parts)


def _overview():
    rows = ["| effect | block | kind | needs | family | fault |", "|---|---|---|---|---|---|"]
    for block in BLOCKS:
        for name in sorted({e.name for e in CATALOGUE if e.block == block}):
            forms = [e for e in (*CATALOGUE, *EVENTS) if e.name == name and e.block == block]
            kinds, needs, families, faults = (
                " or ".join(sorted({told for e in forms if (told := tell(e))}))
                for tell in (lambda e: e.kind, _needs, lambda e: e.family, lambda e: e.damadics)
            )
            place = f"[{name}](#{_anchor(name, block)}) | {block}"
            rows.append(f"| {place} | {kinds} | {needs} | {families} | {faults} |")
    return "\n".join(rows) + "\n"


def _anchor(name, block):
    # a name in two blocks has two headings, and the second gets a number
    before = [b for b in BLOCKS[: BLOCKS.index(block)] if (name, b) in {(e.name, e.block) for e in CATALOGUE}]
    return f"{name}-{len(before)}" if before else name


def _needs(effect):
    return ", ".join(effect.needs)


def _entry(effect):
    first, equation = _meaning(effect)
    lines = [first, ""]
    if equation:
        lines += ["$$", equation, "$$", ""]
    lines += [f"- {_parameter(effect, q)}" for q in effect.parameters]
    facts = [f"needs {_needs(effect)}"]
    facts += [f"family {effect.family}"] if effect.family else []
    facts += [f"fault {effect.damadics}"] if effect.damadics else []
    facts += [effect.source] if effect.source else []
    facts += [] if effect.may_begin else ["there from the start"]
    if type(effect).possible is not Effect.possible:
        facts.append(f"asks for {effect.requires}")
    lines += [f"- {'; '.join(facts)}", f"- told apart: {effect.separated_by}", ""]
    return "\n".join(lines)


def _parameter(effect, quantity):
    unit = "" if quantity.unit == "1" else f" [{quantity.unit}]"
    if type(effect).quantities is not Effect.quantities:
        return f"`{quantity.name}`{unit}"
    return f"`{quantity.name}`{unit}, {quantity.low:g} to {quantity.high:g}"


def _meaning(effect):
    """First sentence of an effect's description, and the equation that it shows first."""
    text = inspect.cleandoc(type(effect).__doc__)
    block = re.search(r"\.\. math::\s*(.*?)(?:\n\s*\n|\Z)", text, re.DOTALL)
    sentence = re.split(r"\n\s*\n", text)[0].replace("\n", " ")
    equation = " ".join(block[1].split()) if block else ""
    return re.sub(r":math:`(.*?)`", r"$\1$", sentence), equation


if __name__ == "__main__":
    TARGET.write_text(page(), encoding="utf-8")
