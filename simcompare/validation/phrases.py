"""Names and numbers of a validation as they stand in its sentences."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from simcompare import units

Record = Mapping[str, Any]
#: a share below this is nothing
NOTHING = 5e-4


def label(found: Record, probe: str) -> str:
    """The label of a compared quantity, in lower case unless it begins with an abbreviation."""
    text = str(found["compare"][probe]["label"])
    # DC and E_n stay as they are
    return text[:1].lower() + text[1:] if text[1:2].islower() else text


def who(row: Record) -> str:
    """An engine, and the stretch where the log has several."""
    where = "" if row["stream"] == "log" else f" on {row['stream']}"
    return f"{row['source']}{where}"


def spaced(name: str) -> str:
    """A name with spaces for its underscores."""
    return name.replace("_", " ")


def parameter(name: str) -> str:
    """A parameter without its unit."""
    return spaced(name.removesuffix(units.suffix_of(name)))


def listed(names: Sequence[str]) -> str:
    """Names with commas and an "and"."""
    if len(names) < 2:
        return "".join(names)
    return f"{', '.join(names[:-1])} and {names[-1]}"


def places(recording: str, streams: Sequence[str]) -> str:
    """Streams of a recording; one that has only one is called by its own name."""
    if list(streams) == ["log"]:
        return recording
    return f"{', '.join(streams)} of {recording}"


def span(shares: Sequence[float]) -> str:
    """The least and the greatest share in per cent."""
    low, high = percent(min(shares)), percent(max(shares))
    return low if low == high else f"{low} to {high}"


def percent(value: float) -> str:
    """A share of 1 in per cent, in two digits."""
    if 0 < value < NOTHING:
        return "below 0.05 %"
    return f"{100 * value:.2g} %" if value < 0.0995 else f"{100 * value:.0f} %"


def sized(value: float, unit: str) -> str:
    """A number with its unit, in three digits."""
    shown = units.symbol(unit)
    return f"{value:.3g}" + ("" if shown == "1" else f" {shown}")
