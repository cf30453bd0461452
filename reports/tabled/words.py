"""The answer of a table of results in sentences."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from simcompare import notation, units
from simcompare.reports.render import numbers
from simcompare.reports.run.listing import joined
from simcompare.results.records.tabled import (
    AGREES,
    CLOSED_FORM,
    DISAGREES,
    Given,
    TabledResult,
    TableValidation,
    Told,
    Verdict,
)

LEFT_OUT = "left out"
#: parts of a ratio below which two sources say the same
_SAME = 5e-4
#: what the tables and figures need explained
WORDS = ("u", "residual", "agrees", "± 95 %")
#: how the uncertainty of what was measured is known
_BASIS = {
    "stated": "as the table states it",
    "repeats": "from the scatter of repeats, taken together",
    "scatter of the rows": "from how the rows scatter about a multiple of {standard}, for the table"
    " states none; so it tells of all rows together, and little of a single one",
}  # fmt: skip


def sentences(found: TableValidation) -> list[str]:
    """Which sources agree with the table, then what the table itself says."""
    said: list[str] = []
    several = len(found.results) > 1
    for result in found.results:
        said += _verdicts(result)
        said += _timed(result)
        if result.timed is None:
            said += _told(result, f"measured {spoken(result.name)}" if several else "table itself")
    said += [f"The closed form does not hold in some rows: {why}" for why in found.beyond]
    return said


def notes(found: TableValidation) -> list[str]:
    """What was assumed, what u comes from, and what was left out."""
    said = [f"{capital(_given(one))}: {one.reason}" for one in found.given]
    said += [_basis(result) for result in found.results]
    said += [f"Left out: {one.heading} {one.note}" for one in found.columns if one.role == LEFT_OUT]
    read = [one for one in found.columns if one.role != LEFT_OUT and one.note]
    for note in dict.fromkeys(one.note for one in read):
        said.append(f"{joined([one.heading for one in read if one.note == note])}: {note}")
    return [*said, *found.remarks]


def not_run(found: TableValidation) -> list[str]:
    """Why some sources have no value, each once."""
    rows = (one for result in found.results for one in result.verdicts)
    return list(dict.fromkeys(
        one.reason if one.reason.startswith(f"{one.source}:") else f"{one.source}: {one.reason}"
        for one in rows if one.reason
    ))  # fmt: skip


def spoken(name: str) -> str:
    """The name of a parameter or result as people say it."""
    return name.removesuffix(units.suffix_of(name)).replace("_", " ")


def capital(text: str) -> str:
    """The same with a capital at its start."""
    return notation.capital(text)


def amount(value: float, u: float | None, unit: str) -> str:
    """A value with its uncertainty, angles in degrees."""
    if unit == "rad":
        text = numbers.with_u(math.degrees(value), u and math.degrees(u), digits=3)
        return text.replace(" ±", "° ±") + "°"
    return numbers.with_u(value, u, units.symbol(unit), digits=3)


def ratio(one: Verdict) -> str:
    """Measured over simulated with its expanded uncertainty."""
    return numbers.with_u(one.ratio, one.expanded)


def _verdicts(result: TabledResult) -> Iterator[str]:
    groups: dict[tuple[str, float], list[Verdict]] = {}
    for one in result.verdicts:
        if one.ratio is not None:
            key = next((k for k in groups if k[0] == one.verdict and abs(k[1] - one.ratio) < _SAME),
                       (one.verdict, one.ratio))  # fmt: skip
            groups.setdefault(key, []).append(one)
    for (verdict, _), same in groups.items():
        yield _verdict(result, verdict, same)


def _verdict(result: TabledResult, verdict: str, same: Sequence[Verdict]) -> str:
    first, who = same[0], _who([one.source for one in same])
    many = len(same) > 1
    name = spoken(result.name)
    agree = ("agree" if many else "agrees") if verdict == AGREES else (
        "do not agree" if many else "does not agree")  # fmt: skip
    text = (
        f"{who} {agree} with the measured {name}: measured over simulated is {ratio(first)}"
        f" (95 %), and {min(one.within for one in same)} of {first.points} rows are within 2 u"
    )
    if verdict == DISAGREES and _is_even(first):
        times = numbers.plain(first.scatter, 2)
        text += f"; about that ratio the rows scatter {times} times as much as they are known to"
    return text + "."


def _is_even(one: Verdict) -> bool:
    """Whether the ratio is 1 within its uncertainty, so that it is the scatter that disagrees."""
    return abs((one.ratio or 0.0) - 1) <= (one.expanded or 0.0)


def _who(sources: Sequence[str]) -> str:
    """Engines by number where they are many, with the closed form beside them."""
    engines = [name for name in sources if name != CLOSED_FORM]
    closed = ["the closed form"] if CLOSED_FORM in sources else []
    named = [joined(engines)] if 0 < len(engines) <= 3 else []
    counted = [f"{len(engines)} engines"] if len(engines) > 3 else []
    if named and closed:
        return joined([*engines, *closed])
    # a name of an engine stays as it is written
    return named[0] if named else capital(joined([*counted, *closed]))


def _timed(result: TabledResult) -> Iterator[str]:
    if result.timed is not None:
        yield (
            f"The measured values are about {result.timed} times the simulated ones. If"
            f" {result.timed} were timed together, write so into the heading, such as"
            f" {result.timed} {spoken(result.name).split()[-1]}s ({units.symbol(result.unit)})."
        )


def _told(result: TabledResult, by: str) -> Iterator[str]:
    for one in result.told[:1]:
        yield (
            f"By the closed form the {by} says {spoken(one.name)} ="
            f" {amount(one.value, one.expanded, one.unit)} (95 %)."
        )
    for one in result.told[1:]:
        if matters(one):
            yield _offset(one)


def matters(one: Told) -> bool:
    """Whether an offset is more than its uncertainty."""
    value, expanded = one.offset_value, one.offset_expanded
    return value is not None and expanded is not None and abs(value) > expanded


def _offset(one: Told) -> str:
    assert one.offset_value is not None
    unit = units.unit_of(one.offset)
    scale, shown = (1e3, "mm") if unit == "m" else (1.0, units.symbol(unit))
    off = numbers.with_u(scale * one.offset_value, scale * (one.offset_expanded or 0.0), shown)
    return (
        f"The rows fit better where {off} is added to every {spoken(one.offset)}; then"
        f" {spoken(one.name)} = {amount(one.value, one.expanded, one.unit)} (95 %). A"
        f" {spoken(one.offset)} that is measured to the wrong place does that."
    )


def _given(one: Given) -> str:
    u = "" if one.u is None else " (u)"
    return f"{spoken(one.name)} = {amount(one.value, one.u, one.unit)}{u}"


def _basis(result: TabledResult) -> str:
    closed = any(one.source == CLOSED_FORM and one.ratio is not None for one in result.verdicts)
    standard = "the closed form" if closed else "what the engines give"
    degrees = result.degrees_of_freedom
    count = "" if degrees is None else f" ({degrees:g} degrees of freedom)"
    text = _BASIS[result.basis].format(standard=standard)
    return f"Uncertainty of the measured {spoken(result.name)}{count}: {text}"
