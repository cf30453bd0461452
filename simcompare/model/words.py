"""Words of users in a scenario: names that code and files may hold, and texts of one line."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable
from typing import Annotated

from pydantic import AfterValidator

#: longest name; scripts write some of them many times
_LONGEST = 100


def _name(text: str) -> str:
    if len(text) > _LONGEST or not text.isidentifier():
        raise ValueError(
            "expected a name of letters, digits and _ that begins with no digit, such as left_wheel"
        )
    return text


def one_line(text: str) -> str:
    """A text without line breaks, and without signs that steer what shows it."""
    return "".join(one if one.isprintable() else " " for one in " ".join(text.split()))


#: what a part of a scenario is called: also names of variables, files and columns are made of it
Name = Annotated[str, AfterValidator(_name)]
#: a text of a scenario that is shown as one line
Line = Annotated[str, AfterValidator(one_line)]


def steering(part: object, place: str = "") -> dict[str, str]:
    """Texts that hold what steers a terminal, or what no file can hold, as place -> sentence."""
    faults: dict[str, str] = {}
    for key, value in _members(part):
        where = f"{place}.{key}" if place else str(key)
        found = [one for one in f"{key}{value if isinstance(value, str) else ''}" if _steers(one)]
        if found:
            faults[where] = f"holds the control character {found[0]!a}; delete it"
        faults.update(steering(value, where))
    return faults


def _members(part: object) -> Iterable[tuple[object, object]]:
    """Keys and values of a mapping, or places and members of a list."""
    if isinstance(part, dict):
        return part.items()
    return enumerate(part) if isinstance(part, list) else ()


def _steers(one: str) -> bool:
    """Whether a sign is a control character, or half of one."""
    return one not in "\n\t" and unicodedata.category(one) in ("Cc", "Cs")
