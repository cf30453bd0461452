"""Events and single values of simulations against those of a recording, in words."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Sequence
from dataclasses import dataclass
from typing import TypeVar

from simcompare.reports.validation import phrases
from simcompare.results.records.validation import SAME, TimingRecord, Validation, ValueRecord

R = TypeVar("R")
LEVEL = "within the noise level (|E_n| ≤ 1, k = 2)"
#: parts of an uncertainty and what they come from
_SOURCES = {"u_num": "the steps", "u_input": "the parameters", "u_data": "the measurement"}
#: groups of engines and segments that are named one by one; of more, only the worst
_MAX_NAMED = 4
#: below this part of an uncertainty its numerical part is not worth a word
_WORTH = 0.05
#: a parameter with less than this share of a budget leads by chance
_LEADING = 0.3


@dataclass(frozen=True)
class _Judged:
    """One value, or one interval between events, of one engine."""

    source: str
    stream: str
    measure: str
    e_n: float
    within_noise: bool


def judged(values: Sequence[ValueRecord]) -> list[ValueRecord]:
    """Single values of which the count uncertainty is known."""
    return [row for row in values if row.e_n is not None]


def sentences(validation: Validation) -> list[str]:
    """When things happened, and how sure single values are."""
    return [*_when(validation), *_how_sure(validation)]


# events


def _when(validation: Validation) -> Iterator[str]:
    rows = validation.timings
    if not rows:
        return
    text = ""
    if any(_is_lost(row) for row in rows):
        text = (
            "Fewer than half of the events belong together, so either the clocks are not aligned or"
            " other things happened; the errors of the rest say little. "
        )
    text += f"{phrases.first_up(phrases.spaced(rows[0].series))}: {_pairs(validation, rows)}."
    if any(row.matched for row in rows) and validation.align.by == "events":
        text += " The clocks were aligned by these very events, so that only intervals are judged."
    yield " ".join([text, *_intervals(rows)])


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
    both = row.matched
    text = (
        f"in {names}{phrases.where(validation, row)} {both} of {both + row.missed} measured events"
        f" belong to {both} of {both + row.extra} simulated ones"
    )
    sizes = [one.rmse_s for one in group if one.rmse_s is not None]
    return text + (f", {phrases.size_span(sizes, 's')} apart (root mean square)" if sizes else "")


def _intervals(rows: Sequence[TimingRecord]) -> Iterator[str]:
    scores = [
        _Judged(row.source, row.stream, str(one.number), one.e_n, abs(one.e_n) <= 1)
        for row in rows
        for one in row.intervals
        if one.e_n is not None
    ]
    if scores:
        yield f"{_agreeing(scores, 'interval')}."


# single values


def _how_sure(validation: Validation) -> Iterator[str]:
    if not validation.values:
        if validation.waveforms:
            yield "No single value of the scenario can be read off this recording."
        return
    scores = [
        _Judged(row.source, row.stream, row.measure, row.e_n, bool(row.within_noise))
        for row in validation.values
        if row.e_n is not None
    ]
    if not scores:
        yield "No single value can be judged, because a part of its uncertainty is not known."
        return
    text = _agreeing(scores, "single value") + _differing(validation, scores)
    if not all(score.within_noise for score in scores):
        text += f"; the furthest is the {_furthest(validation, scores)}"
    elif validation.basis != SAME:
        text += "; that shows no fault, and proves no model"
    rows = judged(validation.values)
    yield " ".join([f"{text}.", _budget(rows), *_steps(validation, rows)])


def _grouped(rows: Sequence[R], key: Callable[[R], Hashable]) -> list[list[R]]:
    groups: dict[Hashable, list[R]] = {}
    for row in rows:
        groups.setdefault(key(row), []).append(row)
    return list(groups.values())


def _cells(rows: Sequence[_Judged]) -> list[list[_Judged]]:
    """Rows of all engines on one quantity of one segment: one thing that was measured."""
    return _grouped(rows, lambda row: (row.stream, row.measure))


def _agreeing(rows: Sequence[_Judged], noun: str) -> str:
    """How many measured things agree; each counts once, however many engines simulate it."""
    cells = _cells(rows)
    within = sum(all(row.within_noise for row in cell) for cell in cells)
    engines = phrases.engines_of(rows)
    mixed = any(_is_mixed(cell) for cell in cells)
    alike = f"{' ' if mixed else ', alike '}in all {len(engines)} engines"
    alike = alike if len(engines) > 1 else ""
    measures = len({row.measure for row in rows})
    streams = len({row.stream for row in rows})
    made = f"{measures} {'quantity' if measures == 1 else 'quantities'}"
    made = "" if noun == "interval" else f" ({made} on {_on(streams)})"
    if len(cells) == 1:
        agrees = "agrees" if within else "does not agree"
        return f"The one {noun}{made} {agrees} {LEVEL}{alike}"
    if within == 0:
        return f"None of {len(cells)} {noun}s{made} agrees {LEVEL}{alike}"
    if within == len(cells):
        return f"All {within} {noun}s{made} agree {LEVEL}{alike}"
    agree = "agrees" if within == 1 else "agree"
    return f"Of {len(cells)} {noun}s{made} {within} {agree} {LEVEL}{alike}"


def _on(streams: int) -> str:
    return f"{streams} segment{'' if streams == 1 else 's'}"


def _is_mixed(cell: Sequence[_Judged]) -> bool:
    return len({row.within_noise for row in cell}) > 1


def _differing(validation: Validation, rows: Sequence[_Judged]) -> str:
    """Engines that do not agree where others do."""
    places = []
    for cell in _cells(rows):
        if _is_mixed(cell):
            beyond = [row.source for row in cell if not row.within_noise]
            measure = phrases.spaced(cell[0].measure)
            places.append(
                f"{phrases.listed(beyond)} in {measure}{phrases.where(validation, cell[0])}"
            )
    if not places:
        return ""
    more = f" and {len(places) - _MAX_NAMED} more" if len(places) > _MAX_NAMED else ""
    return f"; beyond it where others agree: {', '.join(places[:_MAX_NAMED])}{more}"


def _furthest(validation: Validation, rows: Sequence[_Judged]) -> str:
    worst = max(rows, key=lambda row: abs(row.e_n))
    # one just outside must not look like one just inside
    digits = 2 if abs(worst.e_n) < 2 else 1
    e_n = _e_n(worst.e_n, digits)
    same = next(cell for cell in _cells(rows) if worst in cell)
    alike = [row.source for row in same if _e_n(row.e_n, digits) == e_n]
    names = phrases.whose(alike, phrases.engines_of(same))
    measure = phrases.spaced(worst.measure)
    return f"{measure} of {names}{phrases.where(validation, worst)}, E_n = {e_n}"


def _e_n(value: float, digits: int) -> str:
    return f"{value:+.{digits}f}".replace("-", "−")


def _budget(rows: Sequence[ValueRecord]) -> str:
    """Where most of the uncertainty comes from, and from which parameter."""
    source, share = dominant(rows)
    most = "Nearly all" if share > 0.99 else phrases.percent(share)
    text = f"{most} of the squared uncertainty comes from {_SOURCES[source]}"
    name, part = leading_parameter(rows)
    if source == "u_input" and part > _LEADING:
        text += f", of which {phrases.percent(part)} from the {phrases.parameter(name)}"
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
    u_num, u_val = (phrases.sized(size, worst.unit) for size in (worst.u_num, worst.u_val))
    yield (
        f"Numerical error weighs most in the {phrases.spaced(worst.measure)} of"
        f" {worst.source}{phrases.where(validation, worst)}: u = {u_num} of {u_val}."
    )
