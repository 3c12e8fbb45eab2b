# SPDX-License-Identifier: BSD-3-Clause
"""What historians say of a value instead of it, or beside it: good, uncertain, bad."""

import re
from collections import Counter

_BAD = re.compile(
    r"""\[-?\d+\].*|no[ _]?good.*|bad.*|i/?o[ ]?time-?out.*|no[ _]?data.*|pt[ _]created|comm.*fail.*|
    scan[ _](off|timeout)|configure|not[ _]conn.*|intf[ _]shut|calc[ _]?(failed|off|crash)|arc[ _]off-?line|
    invalid.*|shut[ ]?down|error.*|(over|under)[ _]?range|out[ _]of[ _](service|range)|filtered|
    fail.*|timeout|stale.*|disconnected.*|unreliable.*|inactive|\#.*|nan|n/?a|null|none|[+-]?inf|\(null\)|-+|\*+|\?+|
    ungültig.*|schlecht.*|fehler.*|kein.*|gestört.*|störung.*|
    bł[aą]d.*|zł[aey].*|brak.*|nieprawidłow.*|
    mauvais.*|erreur.*|invalide.*|pas[ ]de.*|malo|mala|sin[ ].*""",
    re.IGNORECASE | re.VERBOSE,
)
_UNCERTAIN = re.compile(
    r"""uncertain.*|questionable.*|substituted.*|last[ ]?usable.*|doubtful.*|
    unsicher.*|niepewn.*|incertain.*|inciert.*""",
    re.IGNORECASE | re.VERBOSE,
)
_GOOD = re.compile(
    r"""(?:\d+[\s,:-]+)?good.*|g|ok|valid|true|raw|normal|no[ ]?error|s_ok|0x0+|
    gut.*|g[uü]ltig|dobr[aey].*|bonn?e?|buen[ao]|""",
    re.IGNORECASE | re.VERBOSE,
)
_NAMED_FAULT = re.compile(r"question|bad|invalid|error|fault", re.IGNORECASE)
_NAMED_GOOD = re.compile(r"good|(?<!in)valid", re.IGNORECASE)
GOOD, UNCERTAIN, BAD = "good", "uncertain", "bad"


def is_bad_text(text: str) -> bool:
    """Whether a text in a value's place says that there is none."""
    return _BAD.fullmatch(text) is not None


def is_uncertain_text(text: str) -> bool:
    """Whether a text in a value's place says that it is uncertain."""
    return _UNCERTAIN.fullmatch(text) is not None


def judge(cells: list[str], name: str) -> dict[str, str]:
    """What each text of a quality column means.

    Parameters
    ----------
    cells : list of str
        All cells of the column; numbers are read as the set of them suggests: OPC DA (192 and above good, 64
        to 191 uncertain), OPC UA status codes (top two bits), percent good (100), a flag of 0 and 1 (by its
        name, else the more frequent one is good), a status (nought good).
    name : str
        Of the column.

    Returns
    -------
    meaning : dict
        Text -> ``"good"``, ``"uncertain"`` or ``"bad"``. A text that is not known means bad.
    """
    counted = Counter(cells)
    codes = {text: code for text in counted if (code := _code(text)) is not None}
    good_flag = _good_flag({code: counted[text] for text, code in codes.items()}, name)
    return {
        text: _of_code(codes[text], set(codes.values()), good_flag) if text in codes else _of_text(text, name)
        for text in counted
    }


def speaks_of_quality(cells: list[str], name: str) -> bool:
    """Whether cells beside values can say how good these are.

    Parameters
    ----------
    cells : list of str
    name : str
        Of their column.

    Returns
    -------
    speaks : bool
        False where a text stands among them that no historian uses for a quality, or where they would call
        most of the values bad by numbers alone: then they are the states of something.
    """
    counted = Counter(cell for cell in cells if cell)
    if not counted:
        return False
    texts = {text for text in counted if _code(text) is None}
    if not all(_is_known(text) for text in texts):
        return False
    meaning = judge(list(counted.elements()), name)
    good = sum(count for text, count in counted.items() if meaning[text] == GOOD)
    return bool(texts) or 2 * good > counted.total()


def _is_known(text: str) -> bool:
    known = _GOOD.fullmatch(text) or _UNCERTAIN.fullmatch(text) or _BAD.fullmatch(text)
    return bool(known) or text.casefold() in ("true", "false")


def _of_text(text: str, name: str) -> str:
    if _UNCERTAIN.fullmatch(text):
        return UNCERTAIN
    if text.casefold() in ("true", "false"):
        return GOOD if (text.casefold() == "true") != bool(_NAMED_FAULT.search(name)) else BAD
    return GOOD if _GOOD.fullmatch(text) else BAD


def _code(text: str) -> int | None:
    try:
        return int(text, 16) if text.casefold().startswith("0x") else int(float(text.replace(",", ".")))
    except (ValueError, OverflowError):
        return None


def _good_flag(counted: dict[int, int], name: str) -> int:
    """Which of 0 and 1 means good."""
    if _NAMED_FAULT.search(name):
        return 0
    if _NAMED_GOOD.search(name):
        return 1
    return max(counted, key=counted.__getitem__, default=0)


def _of_code(code: int, codes: set[int], good_flag: int) -> str:
    if max(codes) >= 1 << 30:
        return (GOOD, UNCERTAIN, BAD, BAD)[(code >> 30) & 3]
    if max(codes) >= 192:
        return GOOD if code >= 192 else UNCERTAIN if code >= 64 else BAD
    if 100 in codes:
        return GOOD if code == 100 else UNCERTAIN if code > 0 else BAD
    return GOOD if code == (good_flag if codes <= {0, 1} else 0) else BAD
