"""Python source as text: numbers, names and lines."""

from __future__ import annotations

import keyword
import re
from collections.abc import Sequence

from simcompare.model.words import one_line

#: longest line that is written
WIDTH = 100
#: a line may be broken before these
_SIGNS = (" + ", " - ", " * ", " / ", " ** ", " for ")
#: but not where they come so early
_SHORT = 12


def number(value: float) -> str:
    """The shortest text that is read as the same number."""
    if value == round(value) and abs(value) < 1e15 and not (value == 0 and str(value)[0] == "-"):
        return str(round(value))
    return repr(float(value))


def identifier(text: str) -> str:
    """A name as Python allows it."""
    name = re.sub(r"\W", "_", text)
    return f"{name}_" if keyword.iskeyword(name) or not name.isidentifier() else name


def unused(wanted: str, taken: set[str]) -> str:
    """The wanted name, or the first of it with a number that nobody has."""
    name, tried = identifier(wanted), 1
    while name in taken:
        tried += 1
        name = f"{identifier(wanted)}_{tried}"
    return name


def in_docstring(text: str) -> str:
    """A text as it stands between triple quotes: neither ends them, nor is code."""
    return one_line(text).replace("\\", "\\\\").replace('"""', "'''")


def called(call: str, args: Sequence[str]) -> str:
    """Source of a call."""
    return f"{call}({', '.join(args)})"


def filled(text: str, *, indent: str = "") -> list[str]:
    """A statement in as few lines as it needs, broken inside brackets."""
    lines, start, room, margin = [], 0, WIDTH - len(indent), indent
    assigned = re.match(r"[\w, ]+ = ", text)
    if len(text) > room and assigned and not _commas(text, 0, room):
        head = len(assigned.group())
        if text[head] != "(" or 0 in _depths(text)[head:-1]:
            text = f"{text[:head]}({text[head:]})"
    while len(text) - start > room:
        place = _break(text, start, room)
        if place is None:
            break
        lines.append(margin + text[start:place].rstrip())
        start, margin = place, indent + " " * (8 if text.endswith(":") else 4)
        room = WIDTH - len(margin)
    return [*lines, margin + text[start:]]


def _break(text: str, start: int, room: int) -> int | None:
    """Where a line is best broken: where few brackets are open, unless it is short then; late."""
    depth, breaks = _depths(text), _breaks(text, start, room)
    if not breaks:
        return None
    late = [place for place in breaks if place - start > room / 3] or breaks[-1:]
    return min(late, key=lambda place: (depth[place - 1], text[place] in "*/", -place))


def _breaks(text: str, start: int, room: int) -> list[int]:
    """Places at which a line may end: after commas, else before operators, else after brackets."""
    depth = _depths(text)
    inside = [i for i in range(start + 1, min(start + room + 1, len(text))) if depth[i - 1] > 0]
    found = [i for i in inside if text[i - 1 :].startswith(_SIGNS) and i - start > _SHORT]
    return _commas(text, start, room) or found or [i for i in inside if text[i - 1] in "(["]


def _commas(text: str, start: int, room: int) -> list[int]:
    """Places after commas inside brackets, but for those of a slice."""
    depth, end = _depths(text), min(start + room + 1, len(text))
    return [
        i
        for i in range(start + 3, end)
        if text[i - 2 : i] == ", " and depth[i - 1] > 0 and text[i - 3] != ":"
    ]


def _depths(text: str) -> list[int]:
    """How many brackets are open at each sign; -1 inside quotes."""
    found, depth, quote = [], 0, ""
    for sign in text:
        if quote:
            quote = "" if sign == quote else quote
            found.append(-1)
            continue
        quote = sign if sign in "\"'" else ""
        depth += (sign in "([{") - (sign in ")]}")
        found.append(depth)
    return found
