"""Headings of tables of bounces: what a column holds, in our words and in those of telephones."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass

from simcompare import units
from simcompare.errors import InputError, UnknownName

#: quantities of which each bounce has an interval of its own, and a height that 0 has too
INTERVAL, HEIGHT, INSTANT = "interval", "rebound_height", "impact_time"
_MAX_HEADING = 100
#: what the number of a bounce is called; the first few can mean nothing else
_BOUNCE = ("bounce", "bounce_number", "bounce_no", "bounce_no.", "bounce_#", "impact", "aufprall",
           "aufprall_nr.", "sprung")  # fmt: skip
_NUMBER = (*_BOUNCE, "n", "#", "no", "no.", "nr", "nr.", "number", "nummer")
#: what others call a quantity
_CALLED = {
    INTERVAL: (
        "time_interval",
        "time_between_bounces",
        "flight_time",
        "delta_t",
        "δt",
        "dt",
        "zeitintervall",
        "zeitabstand",
        "intervall",
        "flugzeit",
    ),
    INSTANT: ("time", "t", "aufprallzeit", "zeit", "zeitpunkt"),
    HEIGHT: ("height", "h", "höhe", "sprunghöhe"),
}
_NAMES = sorted(
    ((name, quantity) for quantity, names in _CALLED.items() for name in names),
    key=lambda one: -len(one[0]),
)


@dataclass(frozen=True)
class Column:
    """What a heading says.

    Attributes:
        name: the quantity, or "bounce".
        role: "value", "u", "low", "high" or "bounce".
        factor: to SI.
        bounce: number of the bounce, where it stands in the heading: "Interval 3 (s)".
    """

    name: str
    role: str
    factor: float
    bounce: int | None = None


def is_table(headings: Collection[str]) -> bool:
    """Whether headings are those of a table of bounces, and not of a log."""
    names = [_split(text)[0] for text in headings]
    if not names:
        return False
    first = names[0].lower()
    if first in _BOUNCE:
        return True
    told = [_quantity(name)[0] for name in names]
    if first in _NUMBER:  # a log may be numbered too, but it has no intervals or bounces
        ours = [name.startswith((INSTANT, HEIGHT)) for name in names]
        # with no time beside it a height over a number is one of each bounce
        return any(ours) or INTERVAL in told or set(told[1:]) == {HEIGHT}
    return told[0] == INTERVAL


def columns(
    line: int, headings: list[str], known: Mapping[str, str], faults: list[str]
) -> list[Column]:
    """What every heading says; adds a fault for what does not belong together."""
    found = []
    for text in headings:
        try:
            found.append(_column(text.strip()[:_MAX_HEADING], known))
        except InputError as error:
            faults.extend(f"line {line}, {error.where}: {fault}" for fault in error.faults)
    if not faults:
        faults += [f"line {line}: {fault}" for fault in _together(found, known)]
    return found


def _together(found: list[Column], known: Mapping[str, str]) -> list[str]:
    """What is wrong with columns that are right each for itself."""
    faults = []
    places = [(column.name, column.bounce) for column in found if column.role != "bounce"]
    roles = [(column.name, column.bounce, column.role) for column in found]
    # limits alone are a measurement too
    measured = [role[:2] for role in roles if role[2] in ("value", "low", "high")]
    if not measured:
        faults.append(f"no measured quantity; known: {', '.join(known)}")
    for name, bounce, role in dict.fromkeys(roles):
        called = name if bounce is None else f"{name} {bounce}"
        if roles.count((name, bounce, role)) > 1:
            faults.append(f"{called} ({role}) stands twice")
        if role in ("u", "low", "high") and measured and (name, bounce) not in measured:
            faults.append(f"{role} of {called} is given, but {called} itself is not")
        if (name, bounce, {"low": "high", "high": "low"}.get(role, role)) not in roles:
            faults.append(f"only one limit of {called} is given; give both")
    wide = [bounce is not None for _, bounce in places]
    if any(wide) and (not all(wide) or len(places) < len(found)):
        faults.append("bounces are numbered in some headings and not in others; choose one way")
    return faults


def _split(text: str) -> tuple[str, str]:
    """Name and unit of a heading."""
    match = re.fullmatch(r"(.*?)\s*[\[(](.*)[\])]", text.strip())
    name, unit = (match[1], match[2]) if match else (text, "")
    return re.sub(r"[\s-]+", "_", name.strip()), unit


def _quantity(name: str) -> tuple[str, int | None, str]:
    """A quantity by our name or another, the number behind it, and what else is in the name."""
    if re.match(r"T(?![^\W\d_])", name):  # a flight lasts T, an impact comes at t
        name = INTERVAL + name[1:]
    lowered = name.lower()
    for other, quantity in ((INTERVAL, INTERVAL), *_NAMES):
        if re.match(re.escape(other) + r"(?![^\W\d_])", lowered):
            rest = name[len(other) :]
            number = re.match(r"_?(\d{1,4})(?=_|$)", rest) if quantity == INTERVAL else None
            bounce = int(number[1]) if number else None
            return quantity, bounce, rest[number.end() :] if number else rest
    return name, None, ""


def _column(text: str, known: Mapping[str, str]) -> Column:
    """What a column's heading says: quantity, role and factor to SI."""
    name, unit = _split(text)
    if name.lower() in _NUMBER:
        return Column("bounce", "bounce", 1.0)
    role, bounce = "value", None
    if name.startswith("u_"):
        name, role = name[2:], "u"
    for ending in ("low", "high"):
        if name.endswith(f"_{ending}"):
            name, role = name.removesuffix(f"_{ending}"), ending
    quantity, number, rest = _quantity(name)
    if quantity in known:
        name, bounce = quantity + rest, number
    known_as = next((q for q in known if name == q or name.startswith(f"{q}_")), None)
    if known_as is None:
        raise InputError(f"column {text!r}", [str(UnknownName("measured quantity", name, known))])
    stated = unit or name.removeprefix(known_as).removeprefix("_")
    stated = units.UNITS_BY_SUFFIX.get(f"_{stated}", stated)  # "m_s" as in our own names
    for ending in ("low", "high"):  # "rebound_height_low_cm"
        if stated.startswith(f"{ending}_"):
            stated, role = stated.removeprefix(f"{ending}_"), ending
    return Column(known_as, role, _factor(text, known_as, stated, known[known_as]), bounce)


def _factor(text: str, quantity: str, stated: str, si_unit: str) -> float:
    """Factor from the stated unit to SI; a number without a unit is one of itself alone."""
    if not stated and si_unit != "1":
        raise InputError(f"column {text!r}", [f"has no unit; write {quantity} [{si_unit}]"])
    return units.conversion_factor(stated, si_unit, f"column {text!r}") if stated else 1.0
