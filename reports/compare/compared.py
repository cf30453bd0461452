"""Runs beside each other: what differs between them, and what all of them measured."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import dataclass

from simcompare.errors import InputError, UnknownName
from simcompare.reports.compare.differences import (
    Difference,
    differences,
    in_titles,
    titles,
)
from simcompare.reports.run import runs as of_run
from simcompare.reports.run.lead import Lead, lead_as, lead_of
from simcompare.reports.run.listing import grouped, joined
from simcompare.results.run import Run

#: runs of which there is something to compare
_LEAST = 2
#: values of a parameter from which on a curve is drawn over it
_CURVE = 3


@dataclass(frozen=True)
class Compared:
    """Runs in the order in which they are shown.

    Attributes:
        runs: at least two.
        differences: what differs between them.
        told: those of the differences that titles name.
        titles: of the runs; each names what differs.
        measures: what all of them measured, the leading one first.
        left_out: which others could not be compared, and why; a sentence each.
    """

    runs: tuple[Run, ...]
    differences: tuple[Difference, ...]
    told: tuple[Difference, ...]
    titles: tuple[str, ...]
    measures: tuple[str, ...]
    left_out: tuple[str, ...] = ()

    @property
    def swept(self) -> Difference | None:
        """The one number that leads the titles, where it has enough values for a curve."""
        leading = [one for one in self.differences if one.leads]
        is_swept = len(leading) == 1 and leading[0].numeric
        return leading[0] if is_swept and len(set(leading[0].values)) >= _CURVE else None

    @property
    def untold(self) -> tuple[Difference, ...]:
        """What differs too, and stands in no title."""
        return tuple(one for one in self.differences if one not in self.told)

    @property
    def sources(self) -> list[tuple[str, str]]:
        """Engine and level, level by level, in the order of the runs; of those that ran once."""
        pairs = [(s.name, s.contact) for run in self.runs for s in run.record.sources if s.ran]
        levels = list(dict.fromkeys(level for _, level in pairs))
        return sorted(dict.fromkeys(pairs), key=lambda pair: levels.index(pair[1]))

    @property
    def levels(self) -> list[str]:
        """Contact levels of all runs."""
        return list(dict.fromkeys(level for _, level in self.sources))

    @property
    def engines(self) -> list[str]:
        """Names of all sources."""
        return list(dict.fromkeys(name for name, _ in self.sources))

    @property
    def scenarios(self) -> list[str]:
        """Of all runs, each once."""
        return list(dict.fromkeys(run.record.scenario for run in self.runs))

    def leads(self, measure: str) -> list[Lead]:
        """A measure in each of the runs."""
        return [lead_as(run, measure) for run in self.runs]

    def check(self, measure: str) -> None:
        """Refuses what was not measured in all runs.

        Raises:
            UnknownName: names what was.
        """
        if measure not in self.measures:
            raise UnknownName("measure of all these runs", measure, self.measures)


def compared(given: Sequence[Run], left_out: Sequence[str] = ()) -> Compared:
    """Runs beside each other, in the order of the number in which they differ if it is one.

    Args:
        given: at least two that measured something; others are left out.
        left_out: what was left out before, and why.

    Raises:
        InputError: fewer than two, other things than runs, or runs that measured nothing alike.
    """
    _check_kinds(given)
    useful = [run for run in given if of_run.measures(run)]
    empty = [f"{_name(run)}: no engine ran." for run in given if run not in useful]
    told = (*left_out, *empty)
    if len(useful) < _LEAST:
        raise InputError("compare", [_too_few(useful), *told])
    measures = _shared(useful)
    ordered, found = _ordered(useful)
    in_title = in_titles(found, len(ordered))
    names = [_name(run, number) for number, run in enumerate(ordered, start=1)]
    return Compared(ordered, found, in_title, titles(in_title, names), measures, told)


def _check_kinds(given: Sequence[Run]) -> None:
    """Fits and validations have other numbers than scores, and some are of a recording alone."""
    others = [run for run in given if run.record.kind != "run"]
    if not others:
        return
    faults = [f"{_name(run)} is a {run.record.kind}; expected runs" for run in others]
    if all(run.folder is not None for run in others):
        places = " ".join(shlex.quote(str(run.folder)) for run in others)
        faults[-1] += f"; for one page of all: simcompare report {places} -o comparison.html"
    raise InputError("compare", faults)


def _too_few(useful: Sequence[Run]) -> str:
    if useful:
        return f"{_name(useful[0])} has nothing to be compared with; name at least two runs"
    return "there is no run to compare; name at least two"


def _ordered(given: Sequence[Run]) -> tuple[tuple[Run, ...], tuple[Difference, ...]]:
    """Runs in the order of the number in which they differ, if it is one, and what differs."""
    found = differences([run.record for run in given])
    leading = [one for one in found if one.leads]
    if len(leading) != 1 or not leading[0].numeric:
        return tuple(given), found
    pairs = zip(leading[0].values, range(len(given)), strict=True)
    ordered = tuple(given[place] for _, place in sorted(pairs, key=lambda p: float(p[0] or 0)))
    return ordered, differences([run.record for run in ordered])


def _name(run: Run, number: int | str = "") -> str:
    return f"run {number}".strip() if run.folder is None else run.folder.name


def _shared(given: Sequence[Run]) -> tuple[str, ...]:
    """What all runs measured, what the first of them leads with first."""
    lead = lead_of(given[0])
    first = [lead.measure, *of_run.measures(given[0])] if lead is not None else []
    shared = [
        name for name in dict.fromkeys(first) if all(name in of_run.measures(r) for r in given)
    ]
    if not shared:
        raise InputError("compare", [_nothing_shared(given)])
    return tuple(shared)


def _nothing_shared(given: Sequence[Run]) -> str:
    """What to do where the runs are of scenarios that measure different things."""
    scenarios = grouped((run.record.scenario, run) for run in given)
    if len(scenarios) == 1:
        return "these runs have no measured value in common"
    counts = joined([f"{name} ({len(some)})" for name, some in scenarios.items()])
    fault = f"runs of different scenarios have nothing in common: {counts}"
    most = max(scenarios.values(), key=len)
    if len(most) < _LEAST or any(run.folder is None for run in most):
        return fault
    places = " ".join(shlex.quote(str(run.folder)) for run in most[:_LEAST])
    return f"{fault}; compare those of one scenario, such as: simcompare compare {places}"
