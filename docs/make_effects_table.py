# SPDX-License-Identifier: BSD-3-Clause
"""Make docs/effects.md from the catalogue: every effect, its equation, its parameters, what it needs."""

import inspect
import re
import textwrap
from itertools import groupby
from pathlib import Path

from sklvalve.mismatch.effects import CATALOGUE, EVENTS, LATE, Effect

TARGET = Path(__file__).with_name("effects.md")
#: Longest line of the page outside its table.
WIDTH = 99
BLOCKS = ("actuator", "valve", "line", "measurement")
HEAD = """# Effects

Reference for engineers who read a diagnosis: the physics that a simulation may lack, with
equation, parameters, needed signals, and the test that separates each effect from the others.

The catalogue holds {names} effects in {forms} forms. A form is a variant that acts elsewhere or
shows differently; a diagnosis names the effect. Two more forms are seen [in the last
rows](#in-the-last-rows) alone. No sealed record held `stem_load` or `gas_expansion`.
[Extending](extending.md) shows how to add an effect. `docs/make_effects_table.py` generates this
page.

- **Kind**: what an effect is that is present from the start. It is a fault; or a property of a
  sound valve, its fluid or its line that a simulation may lack; or either. What begins or grows
  within the recording is a fault, unless the fluid changed. `slew_limit` is a property of a motor;
  it is either where air is known to drive the stem.
- **Needs**: the signals that the recording must contain.
- **Family**: effects that share an equation. An explanation holds at most one of them.
- **Fault**: the fault of the [DAMADICS benchmark](damadics.md) with the same physics.
- **Bounds**: the physically possible range of a parameter. Where none is given, the data sheet and
  the recording set it.
"""
LAST_ROWS = """## In the last rows

An event in the last 6 % of a recording is judged by itself, after the rows before it. These forms
are tried only there. `flow_meter_failure` is not among the {names}; no sealed record held it.
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
            parts += _entries(list(forms))
    parts.append(LAST_ROWS.format(names=names))
    for effect in sorted(LATE, key=lambda e: e.name):
        parts.append(f"**`{effect.name}`**\n")
        parts += _entries([effect])
    return "\n".join(parts)


def _overview():
    rows = ["| effect | block | kind | needs | family | fault |", "|---|---|---|---|---|---|"]
    for block in BLOCKS:
        for name in sorted({e.name for e in CATALOGUE if e.block == block}):
            forms = [e for e in (*CATALOGUE, *EVENTS) if e.name == name and e.block == block]
            kinds, needs, families, faults = (
                " or ".join(sorted({value for e in forms if (value := column(e))}))
                for column in (lambda e: e.kind, _needs, lambda e: e.family, lambda e: e.damadics)
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


def _entries(forms):
    """Every form of an effect, and the separating test once where they share it."""
    tests = {form.separated_by for form in forms}
    shared = len(forms) > 1 and len(tests) == 1
    entries = [_entry(form, with_test=not shared) for form in forms]
    if shared:
        entries.append(_fill(f"Separating test of all forms: {tests.pop()}") + "\n")
    return entries


def _entry(effect, with_test):
    first, equation = _meaning(effect)
    lines = [_fill(first), ""]
    if equation:
        lines += ["$$", equation, "$$", ""]
    lines += [f"- {_parameter(effect, q)}" for q in effect.parameters]
    facts = [f"needs {_needs(effect)}"]
    facts += [f"family {effect.family}"] if effect.family else []
    facts += [f"fault {effect.damadics}"] if effect.damadics else []
    facts += [effect.source] if effect.source else []
    facts += [] if effect.may_begin else ["present from the start"]
    if type(effect).possible is not Effect.possible:
        facts.append(f"requires {effect.requires}")
    lines.append(_fill("; ".join(facts), "- "))
    if with_test:
        lines.append(_fill(f"separating test: {effect.separated_by}", "- "))
    return "\n".join([*lines, ""])


def _fill(text, bullet=""):
    """The text in lines of at most WIDTH; formulas and code stay whole."""
    whole = re.sub(r"`[^`]+`|\$[^$]+\$", lambda span: span[0].replace(" ", "\0"), text)
    lines = textwrap.fill(
        whole,
        WIDTH,
        initial_indent=bullet,
        subsequent_indent=" " * len(bullet),
        break_long_words=False,
        break_on_hyphens=False,
    )
    return lines.replace("\0", " ")


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
