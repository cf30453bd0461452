"""What columns of a table of results may be called: our own names, and those that others use."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from simcompare import measures, units
from simcompare.model.scenario import Scenario
from simcompare.model.tabled import TabledColumn
from simcompare.scenarios.scenario_file import ScenarioFile

#: words that say nothing of what a column holds
_FILLERS = frozenset((
    "of", "the", "a", "an", "in", "for", "to", "at", "de", "der", "für", "fur", "von", "des",
    "die", "das", "mean", "average", "avg", "mittel", "mittelwert", "measured", "exp",
    "experimental", "value", "wert", "#", "no"
))  # fmt: skip
_WORDS = re.compile(r"[±+−ΔδσΣ]|[^\W\d_]+|\d+")
_ORDINALS = ("st", "nd", "rd", "th")


@dataclass(frozen=True)
class Entry:
    """A parameter or result that a column may hold.

    Attributes:
        name: of the parameter or result.
        unit: its SI unit.
        is_parameter: whether it is set, and not measured.
        called: what it is called, each as words.
        counted: what is counted where one time is that of many.
        event: which event of a value that is measured once per event.
    """

    name: str
    unit: str
    is_parameter: bool
    called: tuple[tuple[str, ...], ...]
    counted: tuple[tuple[str, ...], ...] = ()
    event: int | None = None


@dataclass(frozen=True)
class Vocabulary:
    """All names that columns may have for one scenario.

    Attributes:
        entries: parameters and results.
        fillers: words that say nothing.
        leading: results that a table of this scenario usually holds.
    """

    entries: tuple[Entry, ...]
    fillers: frozenset[str]
    leading: tuple[str, ...]


#: numbers in words
_NUMBERS = {"five": "5", "ten": "10", "twenty": "20", "fifty": "50", "fünf": "5", "zehn": "10",
            "zwanzig": "20"}  # fmt: skip


def words(text: str) -> tuple[str, ...]:
    """Words and numbers of a heading; single letters as they are written, all else small."""
    found = _WORDS.findall(text)
    ordinal = {i for i, one in enumerate(found) if i and one.lower() in _ORDINALS
               and found[i - 1].isdigit()}  # fmt: skip
    kept = [one for i, one in enumerate(found) if i not in ordinal]
    small = (one if len(one) == 1 else one.lower() for one in kept)
    return tuple(_NUMBERS.get(one, one) for one in small)


def of_scenario(file: ScenarioFile, scenario: Scenario) -> Vocabulary:
    """The names that columns may have.

    A parameter that the table tells is none of them: who writes it has calculated it.
    """
    said: Mapping[str, TabledColumn] = {} if file.table is None else file.table.columns
    told = None if file.table is None else file.table.tells
    names = {name: (units.unit_of(name), True) for name in file.parameters if name != told}
    names |= {
        name: (_plain(unit), False)
        for name, unit in measures.results_of(scenario).items()
        if name in said or name not in _series(scenario)
    }
    # what the scenario names comes first where a heading may be two things
    names = {name: names[name] for name in (*said, *names) if name in names}
    entries = [_entry(name, *names[name], said.get(name, TabledColumn())) for name in names]
    own = {*words(file.name.replace("_", " ")), *words(scenario.title)}
    leading = [name for name in said if name in names and not names[name][1]]
    answer = [scenario.answer.measure] if scenario.answer and not leading else []
    return Vocabulary(tuple(entries), _FILLERS | own, (*leading, *answer))


def _series(scenario: Scenario) -> set[str]:
    """What is measured once per event, of which a row cannot say the event."""
    return {
        measure.name_of(name)
        for measure in scenario.measures
        for name in measures.load(measure.function).series
    }


def _entry(name: str, unit: str, is_parameter: bool, said: TabledColumn) -> Entry:
    own = name.removesuffix(units.suffix_of(name)) if is_parameter else name
    called = tuple(dict.fromkeys(map(words, (own, *said.called))))
    return Entry(name, unit, is_parameter, called, tuple(map(words, said.counted)), said.event)


def _plain(unit: str) -> str:
    """A unit as it is converted: N·m is N*m, m/s² is m/s**2."""
    return unit.replace("·", "*").replace("²", "**2").replace("Ω", "ohm")


def spoken(entry: Entry) -> str:
    """The name of a parameter or result as people say it."""
    suffix = units.suffix_of(entry.name) if entry.is_parameter else ""
    return entry.name.removesuffix(suffix).replace("_", " ")


def told(heading: Sequence[str], phrases: Iterable[Sequence[str]], fillers: frozenset[str]) -> int:
    """How many words of a heading belong to one of some phrases; 0 where others are left."""
    left, count = list(heading), 0
    for phrase in sorted(phrases, key=len, reverse=True):
        place = _place(left, phrase)
        if place is not None:
            del left[place : place + len(phrase)]
            count += len(phrase)
    return count if all(word in fillers for word in left) else 0


def _place(heading: Sequence[str], phrase: Sequence[str]) -> int | None:
    size = len(phrase)
    for i in range(len(heading) - size + 1):
        if tuple(heading[i : i + size]) == tuple(phrase):
            return i
    return None
