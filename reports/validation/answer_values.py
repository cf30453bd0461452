"""Events and single values of simulations against those of a recording, in words."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Sequence
from dataclasses import dataclass
from typing import TypeVar

from simcompare.reports.validation import phrases
from simcompare.results.records.validation import SAME, TimingRecord, Validation, ValueRecord

R = TypeVar("R")
LEVEL = "within the uncertainty (|E_n| ≤ 1)"
#: parts of an uncertainty and what they come from
_SOURCES = {"u_num": "the step", "u_input": "the parameters", "u_data": "the measurement"}
#: groups of engines and segments that are named one by one; of more, only the worst
_MAX_NAMED = 4
#: below this part of an uncertainty its numerical part is not worth a word
_WORTH = 0.05
#: a parameter with less than this share of a budget leads by chance
_LEADING = 0.3
#: a part above this share is nearly all
_ALL = 0.99


@dataclass(frozen=True)
class Judged:
    """One value, or one interval between events, of one engine."""

    source: str
    stream: str
    measure: str
    e_n: float
    within_noise: bool


def judged(values: Sequence[ValueRecord]) -> list[ValueRecord]:
    """Single values of which the count uncertainty is known."""
    return [row for row in values if row.e_n is not None]


def scores(validation: Validation) -> list[Judged]:
    """Every single value that is judged."""
    return [
        Judged(row.source, row.stream, row.measure, row.e_n, bool(row.within_noise))
        for row in validation.values
        if row.e_n is not None
    ]


def sentences(validation: Validation) -> list[str]:
    """When things happened, and how sure single values are."""
    return [*_when(validation), *_how_sure(validation)]


# events


def _when(validation: Validation) -> Iterator[str]:
    rows = validation.timings
    if not rows:
        return
    if any(_is_lost(row) for row in rows):
        yield ("Fewer than half of the events have a partner: the clocks are not aligned, or other"
               " things happened.")  # fmt: skip
    yield f"{phrases.first_up(phrases.spaced(rows[0].series))}: {_pairs(validation, rows)}."
    if any(row.matched for row in rows) and validation.align.by == "events":
        yield "The clocks were aligned by these very events, so only intervals are judged."
    yield from _intervals(rows)


def _is_lost(row: TimingRecord) -> bool:
    return max(row.missed, row.extra) > row.matched


def _pairs(validation: Validation, rows: Sequence[TimingRecord]) -> str:
    """How many events belong together, engines with the same numbers as one."""
    groups = _grouped(rows, lambda row: (row.stream, row.matched, row.missed, row.extra))
    if len(groups) <= _MAX_NAMED:
        return "; ".join(_paired(validation, rows, group) for group in groups)
    worst = min(groups, key=lambda group: group[0].matched / max(_counts(group[0])))
    return f"{_paired(validation, rows, worst)} (the worst; the table has all)"


def _counts(row: TimingRecord) -> tuple[int, int]:
    """How many events were measured and how many simulated; 1 for none."""
    return max(row.matched + row.missed, 1), max(row.matched + row.extra, 1)


def _paired(
    validation: Validation, rows: Sequence[TimingRecord], group: Sequence[TimingRecord]
) -> str:
    row = group[0]
    there = [one for one in rows if one.stream == row.stream]
    names = phrases.whose(phrases.engines_of(group), phrases.engines_of(there))
    text = f"in {names}{phrases.where(validation, row)} {row.matched} of" \
           f" {phrases.counted(row.matched + row.missed, 'measured event')}"  # fmt: skip
    sizes = [one.rmse_s for one in group if one.rmse_s is not None]
    text += f", {phrases.size_span(sizes, 's')} apart (root mean square)" if sizes else ""
    return text + (f", and {row.extra} that were not measured" if row.extra else "")


def _intervals(rows: Sequence[TimingRecord]) -> Iterator[str]:
    found = [
        Judged(row.source, row.stream, str(one.number), one.e_n, abs(one.e_n) <= 1)
        for row in rows
        for one in row.intervals
        if one.e_n is not None
    ]
    if found:
        yield f"{agreeing(found, 'interval')}."


# single values


def _how_sure(validation: Validation) -> Iterator[str]:
    if not validation.values:
        if validation.waveforms:
            yield "No single value of the scenario can be read off this recording."
        return
    found = scores(validation)
    if not found:
        yield "No single value is judged: a part of its uncertainty is not known."
        return
    yield f"{agreeing(found, 'value')}."
    yield from _differing(validation, found)
    if not all(score.within_noise for score in found):
        yield f"The furthest is the {furthest(validation, found)}."
    elif validation.basis != SAME:
        yield "That shows no fault; it does not prove the model."
    rows = judged(validation.values)
    yield _budget(rows)
    yield from _steps(validation, rows)


def _grouped(rows: Sequence[R], key: Callable[[R], Hashable]) -> list[list[R]]:
    groups: dict[Hashable, list[R]] = {}
    for row in rows:
        groups.setdefault(key(row), []).append(row)
    return list(groups.values())


def _cells(rows: Sequence[Judged]) -> list[list[Judged]]:
    """Rows of all engines on one quantity of one segment: one thing that was measured."""
    return _grouped(rows, lambda row: (row.stream, row.measure))


def within(rows: Sequence[Judged]) -> tuple[int, int]:
    """How many measured things agree in every engine, and of how many."""
    cells = _cells(rows)
    return sum(all(row.within_noise for row in cell) for cell in cells), len(cells)


def agreeing(rows: Sequence[Judged], noun: str) -> str:
    """How many measured things agree; each counts once, however many engines simulate it.

    Args:
        rows: of all engines.
        noun: what they are, "value" or "interval".
    """
    good, count = within(rows)
    engines = phrases.engines_of(rows)
    who = f" in {phrases.whose(engines, engines)}" if len(engines) > 1 else ""
    if count == 1:
        name = phrases.spaced(rows[0].measure) if noun == "value" else noun
        yes = sum(row.within_noise for row in rows)
        if 0 < yes < len(rows):
            return f"The {name} agrees {LEVEL} in {yes} of {len(rows)} engines"
        return f"The {name} {'agrees' if yes else 'does not agree'} {LEVEL}{who}"
    if good in (0, count):
        subject = f"None of {count} {noun}s agrees" if good == 0 else f"All {count} {noun}s agree"
        return f"{subject} {LEVEL}{who}"
    agree = "agrees" if good == 1 else "agree"
    return f"{good} of {count} {noun}s {agree} {LEVEL}{who}"


def _differing(validation: Validation, rows: Sequence[Judged]) -> Iterator[str]:
    """Engines that do not agree where others do."""
    places = []
    for cell in _cells(rows):
        beyond = [row.source for row in cell if not row.within_noise]
        if 0 < len(beyond) < len(cell):
            measure = phrases.spaced(cell[0].measure)
            places.append(
                f"{phrases.listed(beyond)} in {measure}{phrases.where(validation, cell[0])}"
            )
    if places:
        more = f" and {len(places) - _MAX_NAMED} more" if len(places) > _MAX_NAMED else ""
        yield f"Beyond it, where others agree: {', '.join(places[:_MAX_NAMED])}{more}."


def furthest(validation: Validation, rows: Sequence[Judged]) -> str:
    """The value that is furthest off, of whom, and how far."""
    worst = max(rows, key=lambda row: abs(row.e_n))
    e_n = e_n_words(worst.e_n)
    same = next(cell for cell in _cells(rows) if worst in cell)
    alike = [row.source for row in same if e_n_words(row.e_n) == e_n]
    names = phrases.whose(alike, phrases.engines_of(same))
    measure = phrases.spaced(worst.measure)
    return f"{measure} in {names}{phrases.where(validation, worst)}: E_n = {e_n}"


def e_n_words(value: float) -> str:
    """E_n with its sign; one just outside of ±1 does not look like one just inside."""
    return f"{value:+.{2 if abs(value) < 2 else 1}f}".replace("-", "−")


def _budget(rows: Sequence[ValueRecord]) -> str:
    """Where most of the uncertainty comes from, and from which parameter."""
    source, share = dominant(rows)
    most = "nearly all" if share > _ALL else phrases.percent(share)
    text = f"Most of the uncertainty comes from {_SOURCES[source]} ({most} of u²)"
    name, part = leading_parameter(rows)
    if source == "u_input" and part > _LEADING:
        text += f", above all from the {phrases.parameter(name)} ({phrases.percent(part)})"
    return f"{text}."


def dominant(rows: Sequence[ValueRecord]) -> tuple[str, float]:
    """The part that makes up most of the squared uncertainty, and its mean share.

    Args:
        rows: single values that are judged.
    """
    known = [row for row in rows if row.u_val > 0]
    shares = {key: sum((getattr(row, key) / row.u_val) ** 2 for row in known) for key in _SOURCES}
    shares = {key: share / max(len(known), 1) for key, share in shares.items()}
    return max(shares.items(), key=lambda item: item[1])


def leading_parameter(rows: Sequence[ValueRecord]) -> tuple[str, float]:
    """The parameter with the largest part of the values' budgets, and its mean share of squares.

    Without any budget that is no parameter with no share.

    Args:
        rows: single values.
    """
    parts: dict[str, float] = {}
    count = 0
    for row in rows:
        squares: dict[str, float] = {}
        for key, one in row.budget.items():
            # a fitted parameter stands for an axis of the covariance
            name = key.rstrip("'").removesuffix(" (fitted)")
            squares[name] = squares.get(name, 0.0) + one**2
        total = sum(squares.values())
        if total > 0:
            count += 1
            for name, square in squares.items():
                parts[name] = parts.get(name, 0.0) + square / total
    if not count:
        return "", 0.0
    name = max(parts, key=lambda key: parts[key])
    return name, parts[name] / count


def _steps(validation: Validation, rows: Sequence[ValueRecord]) -> Iterator[str]:
    """The value in which the engines' own error weighs most."""
    worst = max(rows, key=lambda row: (row.u_num or 0.0) / (row.u_val or 1.0))
    if not worst.u_num or worst.u_num <= _WORTH * worst.u_val:
        return
    share = phrases.percent(worst.u_num / worst.u_val)
    yield (
        f"The step matters most in the {phrases.spaced(worst.measure)} of"
        f" {worst.source}{phrases.where(validation, worst)}: {share} of its uncertainty."
    )
