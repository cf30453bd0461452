"""Python source as text: numbers, names and lines."""

from __future__ import annotations

import keyword
import re
from collections.abc import Iterator, Mapping, Sequence

#: longest line that is written
WIDTH = 100


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


def wrapped(head: str, call: str, args: Sequence[str] | None = None) -> list[str]:
    """A statement in lines that are not too long, broken between arguments."""
    if args is None:
        inner = re.fullmatch(r"([\w.=]*)([(\[{])(.*)([)\]}])", call)
        whole = head + call
        if len(whole) <= WIDTH or inner is None:
            return [whole]
        name, opening, text, closing = inner.groups()
        return _broken(head + name + opening, list(split(text)), closing)
    whole = f"{head}{call}({', '.join(args)})"
    return [whole] if len(whole) <= WIDTH else _broken(f"{head}{call}(", args, ")")


def _broken(start: str, args: Sequence[str], end: str) -> list[str]:
    lines = [start]
    row = "   "
    for arg in args:
        if len(arg) + 5 > WIDTH and arg[-1] in ")]":
            nested = wrapped("", arg)
            lines += [row] if row.strip() else []
            lines += [f"    {line}" for line in nested[:-1]] + [f"    {nested[-1]},"]
            row = "   "
            continue
        if len(row) + len(arg) + 2 > WIDTH and row.strip():
            lines.append(row)
            row = "   "
        row += f" {arg},"
    return [*lines, *([row] if row.strip() else []), end]


def split(text: str) -> Iterator[str]:
    """Parts between the commas that are in no bracket."""
    depth, part = 0, ""
    for sign in text:
        depth += (sign in "([{") - (sign in ")]}")
        if sign == "," and depth == 0:
            yield part.strip()
            part = ""
        else:
            part += sign
    if part.strip():
        yield part.strip()


def dictionary(entries: Mapping[str, str]) -> str:
    """A dictionary of names and source."""
    return "{" + ", ".join(f'"{name}": {text}' for name, text in entries.items()) + "}"


def names_of(names: Sequence[str]) -> str:
    """A tuple of texts."""
    return "(" + ", ".join(f'"{name}"' for name in names) + (",)" if len(names) == 1 else ")")
