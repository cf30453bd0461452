"""What was typed in for a restitution, and how deep and long the contacts then are."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from simcompare.model.settings import TUNED
from simcompare.model.trajectory import AT
from simcompare.model.tuning import TuningRow
from simcompare.reports.render import numbers
from simcompare.reports.run import audit, runs
from simcompare.reports.run.listing import grouped, joined
from simcompare.results.records.run import SourceRecord
from simcompare.results.run import Run

#: contacts whose depths differ by less than this factor are told as one
_ALIKE_DEPTHS = 2.0
#: a depth below this part of the body's size is called small
_SHALLOW = 0.01


@dataclass(frozen=True)
class _Contact:
    """The first contact of a source in the drops that were tuned.

    Attributes:
        source: its name.
        depth_mm: how deep it sinks [mm].
        time_ms: how long it lasts [ms].
        shallow_mm: depths up to this are small beside the body [mm].
    """

    source: str
    depth_mm: float
    time_ms: float
    shallow_mm: float


def numbers_typed(source: SourceRecord, row: TuningRow, digits: int = 6) -> str:
    """The numbers of a tuning under the names of the engine's own parameters."""
    names = {
        given.set_value: given.engine_parameter
        for given in source.audit
        if given.quantity.endswith("restitution")
    }
    return ", ".join(
        f"{names[value]} = {numbers.plain(value, digits)}"
        if value in names
        else numbers.plain(value, digits)
        for value in row.numbers
    )


def contacts(run: Run) -> str:
    """How deep the first contact sinks and how long it lasts, engines alike together."""
    known = [
        _Contact(source.name, 1e3 * at.penetration_m, 1e3 * at.contact_s,
                 1e3 * _SHALLOW * source.tuning[0].size_m)
        for source in _tuned(run)
        for at in source.tuning[0].at[:1]
        if math.isfinite(at.penetration_m) and math.isfinite(at.contact_s)
    ]  # fmt: skip
    if not known:
        return ""
    head = "A tuned contact sinks in by up to"
    if runs.steps(run):
        return f"{head}, and lasts: {'; '.join(_over_steps(known))}."
    groups: list[list[_Contact]] = []
    for one in sorted(known, key=lambda contact: -contact.depth_mm):
        first = groups[-1][0] if groups else None
        if first and first.depth_mm <= max(_ALIKE_DEPTHS * one.depth_mm, first.shallow_mm):
            groups[-1].append(one)
        else:
            groups.append([one])
    order = runs.names(run)
    alike = [_alike(sorted(group, key=lambda c: order.index(c.source))) for group in groups]
    (depths, times, where), *others = alike
    phrases = [f"{depths} and lasts {times} in {where}"]
    phrases += [f"{deep} and {long} in {engines}" for deep, long, engines in others]
    return f"{head} {'; '.join(phrases)}."


def _over_steps(known: Iterable[_Contact]) -> list[str]:
    """Depths and times of each engine, in the order of the steps."""
    return [
        f"{_listed(contact.depth_mm for contact in contacts)} mm,"
        f" and {_listed(contact.time_ms for contact in contacts)} ms in {engine}"
        for engine, contacts in grouped((_engine(c.source), c) for c in known).items()
    ]


def _listed(values: Iterable[float]) -> str:
    return ", ".join(numbers.plain(value, 2) for value in values)


def _alike(group: Sequence[_Contact]) -> tuple[str, str, str]:
    """Contacts that are much the same: how deep, how long, and in which engines."""
    shallow_mm = group[0].shallow_mm
    times = _span([contact.time_ms for contact in group], "ms")
    depths = _span([contact.depth_mm for contact in group], "mm")
    if max(contact.depth_mm for contact in group) <= shallow_mm:
        depths = f"{numbers.plain(shallow_mm, 2)} mm"
    return depths, times, joined([contact.source for contact in group])


def _span(values: Sequence[float], unit: str) -> str:
    ends = dict.fromkeys(numbers.plain(value, 2) for value in (min(values), max(values)))
    return f"{' to '.join(ends)} {unit}"


def typed_in(run: Run) -> list[str]:
    """Which numbers stand for each restitution, engine by engine."""
    sources = sorted(_tuned(run), key=lambda source: source.engine_step_s or 0.0)
    rows = [(source, row) for source in sources for row in source.tuning]
    by_restitution = grouped((row.restitution, (source, row)) for source, row in rows)
    return [_typed_for(run, restitution, pairs) for restitution, pairs in by_restitution.items()]


def _typed_for(run: Run, restitution: float, rows: Sequence[tuple[SourceRecord, TuningRow]]) -> str:
    # at several steps, one after the other
    by_engine = grouped((_engine(source.name), _short(source, row)) for source, row in rows)
    phrases = [f"{', '.join(typed)} in {engine}" for engine, typed in by_engine.items()]
    goal = f" for a restitution of {numbers.plain(restitution)}"
    steps = sorted(runs.steps(run), key=lambda step: step.engine_step_s)
    at = f" at {joined([step.at.removeprefix(AT) for step in steps])}" if steps else _at_step(rows)
    return f"Typed in{goal}{at}: {('; ' if steps else ', ').join(phrases)}."


def _at_step(rows: Sequence[tuple[SourceRecord, TuningRow]]) -> str:
    """The step that all of them took, for the numbers hold at no other."""
    taken = (audit.step_of(source) for source, _ in rows)
    steps = {numbers.plain(1e3 * step_s, 4) for step_s in taken if step_s is not None}
    return f", at a step of {steps.pop()} ms" if len(steps) == 1 else ""


def _short(source: SourceRecord, row: TuningRow) -> str:
    """A coefficient alone; the numbers of a parameter with several under its name."""
    values = [numbers.plain(value) for value in row.numbers]
    if len(values) == 1:
        return numbers.plain(row.numbers[0], 4)
    parameter = numbers_typed(source, row).partition("[")[0]
    if "=" in parameter:
        return numbers_typed(source, row, 4)
    return f"{parameter} = ({', '.join(values)})"


def _tuned(run: Run) -> list[SourceRecord]:
    """Sources of the level tuned whose numbers were sought."""
    return [s for s in run.record.sources if s.contact == TUNED and s.tuning]


def _engine(source: str) -> str:
    """The source without its step."""
    return source.partition(AT)[0]
