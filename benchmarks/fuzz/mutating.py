# SPDX-License-Identifier: BSD-3-Clause
"""Mutations: bytes changed, moved and lost, tokens that break readers, and structures that lie."""

import copy
import gzip
import io
import json
import zipfile

import numpy as np

# what readers of numbers, times, tables and sheets stumble over
TOKENS = [
    b"1e308",
    b"-1e308",
    b"1e13",
    b"1e-320",
    b"nan",
    b"inf",
    b"-inf",
    b"0",
    b"-1",
    b"9" * 30,
    b"9" * 400,
    b"1_000",
    b"9999-12-31T23:59:59",
    b"0001-01-01 00:00:00",
    b"2024-02-30",
    b"00/00/0000",
    b"24:00:00",
    b"+99:99",
    b"2024-06-28T10:00:00+23:59",
    b"true",
    b"null",
    b"None",
    b"=1+1",
    b"@SUM(A1)",
    b"\x00",
    b"\x1b[2J",
    b"\x85",
    b"\xff\xfe",
    b"\xef\xbb\xbf",
    b"\xe2\x80\xae",
    b"\xed\xa0\x80",
    b'"',
    b"'",
    b"'''",
    b'"""',
    b";",
    b",",
    b"\t",
    b"\r",
    b"\n",
    b"\n\n",
    b"|",
    b"[",
    b"]",
    b"{",
    b"}",
    b"[" * 300,
    b"=",
    b"#",
    b"\\",
    b"sep=;\n",
    b"x" * 5000,
    b"1" * 5000,
    b"Bad",
    b"#N/A",
    b"%",
    b"degC",
    b"1,234.5",
    b"1.234,5",
    b"\xc5\x82",
    b"\xf0\x9f\x92\xa9",
]
_NUMBERS = [
    b"0",
    b"-1",
    b"1",
    b"7.5",
    b"100",
    b"1e5",
    b"1e12",
    b"1e150",
    b"1e305",
    b"-1e305",
    b"1e-300",
    b"1e-5",
    b"",
    b"NaN",
    b"99999",
    b"0.0001",
    b"253402300799",
    b"62135596800",
    b"-1e17",
    b"1719560000",
    b"45000.5",
]
_LEAVES = [
    float("nan"),
    float("inf"),
    -float("inf"),
    1e308,
    -1e308,
    1e13,
    -1.0,
    0.0,
    0,
    -1,
    10**18,
    1e-320,
    True,
    None,
    "",
    "x",
    "=1",
    "\x1b[2J",
    [],
    {},
    [1.0],
    [[1.0]],
    (1.0, 2.0),
    np.zeros(0),
    np.zeros((2, 2)),
    np.full(3, np.nan),
    np.array(["a"]),
    np.zeros(401),
    np.full(401, np.inf),
    [3.0, 2.0, 1.0],
    "nowhere",
    10**400,
]


def mutated(kind, seeds, rng):
    """One mutation of one of the seeds.

    Parameters
    ----------
    kind : str
    seeds : list of bytes
    rng : random.Random

    Returns
    -------
    content : bytes
    """
    seed = rng.choice(seeds)
    if kind == "gz":
        if rng.random() < 0.7:
            text = _bytes(gzip.decompress(seed), seeds, rng)
            return gzip.compress(text, compresslevel=1, mtime=0)
        return _bytes(seed, seeds, rng)
    if kind == "parquet" and rng.random() < 0.6:
        return _footer(seed, rng)
    if kind in ("model", "estimator") and rng.random() < 0.9:
        return _model(seed, rng)
    return _bytes(seed, seeds, rng)


def _bytes(content, seeds, rng):
    made = bytearray(content)
    if rng.random() < 0.5:  # most tables and sheets are still whole then, and get further
        for _ in range(rng.choice((1, 1, 2, 5))):
            _mild(made, rng)
        return bytes(made)
    for _ in range(rng.choice((1, 1, 1, 2, 3, 8, 20))):
        _once(made, seeds, rng)
    return bytes(made)


def _mild(made, rng):
    """A digit, or a number, in place of another."""
    digits = [k for k, byte in enumerate(made) if 48 <= byte <= 57]
    if not digits:
        return
    place = rng.choice(digits)
    if rng.random() < 0.6:
        made[place] = rng.choice(b"0123456789.-e")
        return
    end = place + 1
    while end < len(made) and made[end] in b"0123456789.":
        end += 1
    made[place:end] = rng.choice(_NUMBERS)


def _once(made, seeds, rng):
    size = len(made)
    place = rng.randrange(size + 1)
    span = min(rng.choice((1, 1, 2, 5, 20, 200)), size - place)
    choice = rng.randrange(10)
    if choice == 0 and size > place:
        made[place] ^= 1 << rng.randrange(8)
    elif choice == 1 and size > place:
        made[place] = rng.randrange(256)
    elif choice == 2:
        del made[place : place + span]
    elif choice == 3:
        made[place:place] = made[place : place + span] * rng.choice((1, 2, 50))
    elif choice == 4 and rng.random() < 0.2:
        del made[place:]
    elif choice == 5:
        other = rng.choice(seeds)
        begin = rng.randrange(len(other))
        made[place : place + span] = other[begin : begin + span]
    elif choice in (6, 7):
        made[place:place] = rng.choice(TOKENS)
    else:
        _cell(made, rng)


def _cell(made, rng):
    """A token in place of a whole cell or value."""
    marks = [k for k, byte in enumerate(made) if byte in b",;\t\n=|"]
    if len(marks) > 1:
        k = rng.randrange(len(marks) - 1)
        made[marks[k] + 1 : marks[k + 1]] = rng.choice(TOKENS)


def _footer(content, rng):
    """The part of a Parquet file in which it describes itself."""
    made = bytearray(content)
    length = int.from_bytes(made[-8:-4], "little")
    for _ in range(rng.choice((1, 1, 2, 4, 16))):
        place = rng.randrange(len(made) - 8 - length, len(made) - 4)
        made[place] = rng.choice(
            (0, 1, 127, 128, 255, made[place] ^ 1 << rng.randrange(8), rng.randrange(256))
        )
    return bytes(made)


def _model(content, rng):
    """A model that lies, with a right checksum: a value changed, or the description of the values."""
    import skops.io

    if rng.random() < 0.7:
        held = skops.io.loads(content)
        for _ in range(rng.choice((1, 1, 1, 2, 4))):
            _leaf(held, rng)
        try:
            return skops.io.dumps(held)
        except Exception:  # not everything can be written; the seed then
            return content
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    name = rng.choice([*parts, "schema.json", "schema.json"])
    if name == "schema.json" and rng.random() < 0.6:
        schema = json.loads(parts[name])
        for _ in range(rng.choice((1, 2))):
            _leaf(schema, rng)
        parts[name] = json.dumps(schema, default=str).encode()
    else:
        parts[name] = _bytes(parts[name], [parts[name]], rng)
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w") as archive:
        for part, text in parts.items():
            archive.writestr(part, text)
    return target.getvalue()


def _leaf(held, rng):
    """Change, remove or rename one thing somewhere in nested dicts and lists."""
    node = held
    while True:
        keys = list(node) if isinstance(node, dict) else list(range(len(node)))
        if not keys:
            return
        key = rng.choice(keys)
        child = node[key]
        if isinstance(child, dict | list) and len(child) and rng.random() < 0.9:
            node = child
            continue
        change = rng.randrange(8)
        if change == 0:
            del node[key]
        elif change == 1 and isinstance(node, dict):
            node[rng.choice(("x", "effects", "\x1b", "rise_0", "actuator_gain", "given_gain"))] = node.pop(
                key
            )
        elif isinstance(child, np.ndarray) and child.size and child.dtype.kind == "f" and rng.random() < 0.5:
            changed = child.copy()
            changed.flat[rng.randrange(child.size)] = rng.choice((np.nan, np.inf, 1e300, 0.0, -1.0))
            node[key] = changed
        else:
            # a copy, or a later change of it would change the next input too
            node[key] = copy.deepcopy(rng.choice(_LEAVES))
        return
