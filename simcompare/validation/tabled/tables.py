"""Which files are tables of results for a scenario, and what is wrong with one."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from simcompare import units
from simcompare.errors import InputError
from simcompare.hardware import mapping as mappings
from simcompare.hardware.logs.text import clocks
from simcompare.hardware.proposed_time import FEW_ROWS
from simcompare.hardware.recordings import results_table
from simcompare.hardware.recordings.results_table import Opened, ResultsTable
from simcompare.model.scenario import Scenario
from simcompare.scenarios import catalogue
from simcompare.scenarios.scenario_file import ScenarioFile
from simcompare.validation.tabled.experiments import (
    SCATTER,
    Experiment,
    above,
    basis_of,
    experiments,
)
from simcompare.validation.tabled.headings import meanings
from simcompare.validation.tabled.meaning import LEFT_OUT, MEASURED, PARAMETER, Meaning
from simcompare.validation.tabled.vocabulary import Entry, Vocabulary, of_scenario, spoken

#: more columns than somebody writes by hand
_MAX_COLUMNS = 100


@dataclass(frozen=True)
class Read:
    """A table that has been read for a scenario.

    Attributes:
        table: as it stands in the file.
        columns: what each of them holds.
        found: the experiments.
        entries: the results that were measured.
        above: parameters that lines above the table say, SI.
    """

    table: ResultsTable
    columns: tuple[Meaning, ...]
    found: tuple[Experiment, ...]
    entries: tuple[Entry, ...]
    above: dict[str, float]


def of(path: Path, file: ScenarioFile, mapping: Path | None = None) -> Opened | None:
    """A file as a table of results for a scenario; ``None`` where it is none.

    With a mapping it is one where each channel is a parameter or a result of the scenario, and no
    time and no plan are given.

    Raises:
        InputError: faults of the mapping file.
    """
    if mapping is None:
        table = _opened(path)
        return table if table is not None and is_one(table, file) else None
    reading = mappings.read(mapping)
    known = {one.name for one in of_scenario(file, file.resolve()).entries}
    names = [units.find_name(name, known) for name in reading.channels]
    if reading.time is not None or reading.validate_ is not None or None in names or not names:
        return None
    return results_table.opened(path, reading) if path.is_file() else None


def fitting(path: Path) -> list[str]:
    """Scenarios for which a file is a table of results, of those that say how one is read."""
    table = _opened(path)
    if table is None:
        return []
    names = []
    for name, place in catalogue.files().items():
        if "\ntable:" in place.read_text(encoding="utf-8", errors="replace"):
            file = catalogue.load(str(place))
            faults: list[str] = []
            columns = meanings(table.headings, of_scenario(file, file.resolve()), faults)
            if {PARAMETER, MEASURED} <= {one.role for one in columns} and not faults:
                names.append(name)
    return names


def _opened(path: Path) -> Opened | None:
    try:
        table = results_table.opened(path) if path.is_file() else None
    except (InputError, OSError):
        return None
    return table if table is not None and len(table.headings) <= _MAX_COLUMNS else None


def is_one(table: Opened, file: ScenarioFile) -> bool:
    """Whether a file holds a result in each row, and not a sample of a log.

    It has a parameter and a result of the scenario, or is short and has no clock at all.
    """
    known = of_scenario(file, file.resolve())
    columns = meanings(table.headings, known, [])
    roles = {one.role for one in columns}
    rest = [one.heading for one in columns if one.role in (LEFT_OUT, MEASURED)]
    has_clock = any(clocks.is_time(one.name) and one.holds_numbers for one in rest)
    fits = {PARAMETER, MEASURED} <= roles
    few = table.rows < FEW_ROWS
    return (fits and (few or not has_clock)) or (few and not has_clock and _has_span(table))


def _has_span(table: Opened) -> bool:
    """Whether some column says how long something takes, which is a result."""
    return any(clocks.is_span(one.name) for one in table.headings if one.holds_numbers)


def read(table: Opened, file: ScenarioFile, scenario: Scenario) -> Read:
    """A table as experiments.

    Raises:
        InputError: all that is wrong with it, each with its line or column.
    """
    faults: list[str] = []
    known = of_scenario(file, scenario)
    columns = meanings(table.headings, known, faults)
    faults += _missing(columns, known)
    used = [one.heading.number for one in columns if one.role != LEFT_OUT]
    label = table.source.label
    try:
        numbers = results_table.read(table, used)
    except InputError as error:
        raise InputError(label, [*faults, *error.faults]) from None
    said = above(table.about, known, faults, label)
    found = experiments(numbers, columns, file, faults)
    if not faults and not found:
        faults.append("holds no experiment; expected at least one row of numbers")
    if not faults:
        faults += _too_few(found, columns)
    if faults:
        raise InputError(label, sorted(faults, key=_line_of))
    entries = {one.entry.name: one.entry for one in columns if one.role == MEASURED and one.entry}
    return Read(numbers, (*columns,), (*found,), (*entries.values(),), said)


def _line_of(fault: str) -> int:
    """The line that a fault names, so that they stand as in the file."""
    match = re.match(r"line (\d+)", fault)
    return int(match[1]) if match else 0


def _missing(columns: Sequence[Meaning], known: Vocabulary) -> list[str]:
    """That nothing is set, or nothing measured, with what there could be."""
    roles = {one.role for one in columns}
    told = ", ".join(one.heading.text for one in columns)
    faults = []
    if PARAMETER not in roles:
        names = ", ".join(spoken(one) for one in known.entries if one.is_parameter)
        faults.append(f"no column ({told}) is a parameter; known: {names}")
    if MEASURED not in roles:
        names = ", ".join(spoken(one) for one in known.entries if not one.is_parameter)
        faults.append(f"no column ({told}) is a measured result; known: {names}")
    return faults


def _too_few(found: Sequence[Experiment], columns: Sequence[Meaning]) -> list[str]:
    """That a single value without an uncertainty tells nothing."""
    names = {one.entry.name: one for one in columns if one.role == MEASURED and one.entry}
    faults = []
    for name, one in names.items():
        measured = [each for each in found if name in each.readings]
        if len(measured) < 2 and basis_of(measured, name).kind == SCATTER:
            such = f"u({one.heading.name}) ({one.heading.unit})"
            faults.append(
                f"has one row, so nothing tells how well {one.heading.text} is known; expected two"
                f" rows or more, repeats, or a column such as {such}"
            )
    return faults
