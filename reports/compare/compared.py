"""Runs beside each other: what differs between them, and what all of them measured."""

from __future__ import annotations

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
from simcompare.results.run import Run

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
    """

    runs: tuple[Run, ...]
    differences: tuple[Difference, ...]
    told: tuple[Difference, ...]
    titles: tuple[str, ...]
    measures: tuple[str, ...]

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
        """Engine and level, level by level, in the order of the runs."""
        pairs = [(s.name, s.contact) for run in self.runs for s in run.record.sources]
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


def compared(given: Sequence[Run]) -> Compared:
    """Runs beside each other, in the order of the number in which they differ if it is one.

    Raises:
        InputError: fewer than two, other things than runs, or runs that measured nothing alike.
    """
    if len(given) < 2:
        raise InputError("compare", ["one run has nothing to be compared with; name at least two"])
    kinds = dict.fromkeys(run.record.kind for run in given)
    if [*kinds] != ["run"]:
        raise InputError("compare", [f"expected runs, and found {_counted(given)}"])
    measures = _shared(given)
    ordered, found = _ordered(given)
    told = in_titles(found, len(ordered))
    names = [_name(run, number) for number, run in enumerate(ordered, start=1)]
    return Compared(ordered, found, told, titles(told, names), measures)


def _ordered(given: Sequence[Run]) -> tuple[tuple[Run, ...], tuple[Difference, ...]]:
    """Runs in the order of the number in which they differ, if it is one, and what differs."""
    found = differences([run.record for run in given])
    leading = [one for one in found if one.leads]
    if len(leading) != 1 or not leading[0].numeric:
        return tuple(given), found
    pairs = zip(leading[0].values, range(len(given)), strict=True)
    ordered = tuple(given[place] for _, place in sorted(pairs, key=lambda p: float(p[0] or 0)))
    return ordered, differences([run.record for run in ordered])


def _counted(given: Sequence[Run]) -> str:
    kinds = [run.record.kind for run in given]
    return " and ".join(f"{kinds.count(kind)} of kind {kind}" for kind in dict.fromkeys(kinds))


def _name(run: Run, number: int) -> str:
    return f"run {number}" if run.folder is None else run.folder.name


def _shared(given: Sequence[Run]) -> tuple[str, ...]:
    """What all runs measured, what the first of them leads with first."""
    lead = lead_of(given[0])
    first = [lead.measure, *of_run.measures(given[0])] if lead is not None else []
    shared = [
        name for name in dict.fromkeys(first) if all(name in of_run.measures(r) for r in given)
    ]
    if not shared:
        scenarios = dict.fromkeys(run.record.scenario for run in given)
        what = f"runs of {', '.join(scenarios)}" if len(scenarios) > 1 else "these runs"
        raise InputError("compare", [f"{what} have no measured value in common"])
    return tuple(shared)
