"""Rows of a table become experiments: what was set, what was measured, and how well."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from simcompare import units
from simcompare.errors import InputError
from simcompare.hardware.recordings.results_table import ResultsTable
from simcompare.model.trajectory import Array
from simcompare.scenarios.scenario_file import ScenarioFile, out_of_bounds
from simcompare.validation.tabled.meaning import (
    COUNT,
    MEASURED,
    PARAMETER,
    UNCERTAINTY,
    Meaning,
)
from simcompare.validation.tabled.vocabulary import Vocabulary, spoken, told, words

STATED, REPEATS, SCATTER = "stated", "repeats", "scatter of the rows"
#: half-width of a range in which a value certainly lies, over its standard uncertainty
_ROOT_3 = math.sqrt(3)
#: a last digit over its standard uncertainty
_ROOT_12 = math.sqrt(12)


@dataclass(frozen=True)
class Reading:
    """A result as it was measured in one experiment.

    Attributes:
        values: all repeats.
        u: standard uncertainty as the table states it, ``None`` where it does not.
        digit: size of the last digit that is written.
    """

    values: tuple[float, ...]
    u: float | None = None
    digit: float = 0.0

    @property
    def mean(self) -> float:
        """Of all repeats."""
        return float(np.mean(self.values))


@dataclass(frozen=True)
class Experiment:
    """One experiment: rows in which the same was set.

    Attributes:
        lines: of the file.
        set: parameter -> value that the rows say, SI.
        u_set: parameter -> its standard uncertainty, where the rows say it.
        readings: result -> what was measured.
    """

    lines: tuple[int, ...]
    set: Mapping[str, float]
    u_set: Mapping[str, float]
    readings: Mapping[str, Reading]


@dataclass(frozen=True)
class Basis:
    """Where the uncertainty of a measured result comes from.

    Attributes:
        kind: stated, repeats, or scatter of the rows where the table says nothing.
        u: of a single value, where one number stands for all; ``None`` where each row says its own.
        degrees_of_freedom: behind it.
        least: what the last digit that is written leaves open at least.
    """

    kind: str
    u: float | None = None
    degrees_of_freedom: float = math.inf
    least: float = 0.0


@dataclass
class _Row:
    line: int
    set: dict[str, float] = field(default_factory=dict)
    u_set: dict[str, float] = field(default_factory=dict)
    values: dict[str, list[float]] = field(default_factory=dict)
    u: dict[str, float] = field(default_factory=dict)


def experiments(
    table: ResultsTable, columns: Sequence[Meaning], file: ScenarioFile, faults: list[str]
) -> list[Experiment]:
    """The experiments of a table, in the order in which they first stand there.

    Args:
        table: the table.
        columns: what its columns hold.
        file: the scenario.
        faults: what is wrong is added here, each with its line.
    """
    used = [one for one in columns if one.role in (PARAMETER, MEASURED, UNCERTAINTY, COUNT)
            and one.heading.number in table.values]  # fmt: skip
    digits = _digits(used, table)
    rows = []
    for place, line in enumerate(table.lines.tolist()):
        cells = [(one, float(table.values[one.heading.number][place])) for one in used]
        if not all(math.isnan(cell) for _, cell in cells):
            rows.append(_row(line, cells, faults))
    for row in rows:
        known = {name: value for name, value in row.set.items() if math.isfinite(value)}
        wrong = out_of_bounds(known, file.parameters)
        faults += [f"line {row.line}: {text}" for text in wrong.values()]
    return [_experiment(group, digits) for group in _groups(rows)]


def _digits(used: Sequence[Meaning], table: ResultsTable) -> dict[str, float]:
    """Result -> size of the last digit with which it is written."""
    digits: dict[str, float] = {}
    for one in used:
        if one.role == MEASURED and one.entry is not None:
            values = table.values[one.heading.number]
            texts = [f"{value:.9g}" for value in values[np.isfinite(values)]]
            places = max((len(text.partition(".")[2]) for text in texts), default=0)
            size = 10.0**-places * one.factor / (_fewest(used, table) if one.of_total else 1.0)
            digits[one.entry.name] = min(size, digits.get(one.entry.name, size))
    return digits


def _fewest(used: Sequence[Meaning], table: ResultsTable) -> float:
    """The smallest number of what was timed together."""
    counts = [table.values[one.heading.number] for one in used if one.role == COUNT]
    known = np.concatenate(counts) if counts else np.ones(1)
    return float(np.min(known[known > 0], initial=np.inf))


def _row(line: int, cells: Sequence[tuple[Meaning, float]], faults: list[str]) -> _Row:
    row = _Row(line)
    count = next((cell for one, cell in cells if one.role == COUNT), 1.0)
    count = count if count > 0 else math.nan  # which is a fault of its own
    for one, cell in cells:
        if one.entry is None:
            continue
        name, value = one.entry.name, cell * one.factor
        if one.role == PARAMETER:
            row.set[name] = value
        elif one.role == MEASURED:
            value = value / count if one.of_total else value
            row.values.setdefault(name, []).append(value)
    for one, cell in cells:
        if one.role == UNCERTAINTY and one.entry is not None:
            _add_u(row, one, cell / count if one.of_total and not one.relative else cell, faults)
    faults += [f"line {line}: {text}" for text in _faults_of(row, cells)]
    return row


def _add_u(row: _Row, one: Meaning, cell: float, faults: list[str]) -> None:
    assert one.entry is not None
    name = one.entry.name
    if math.isnan(cell):
        faults.append(f"line {row.line}: {one.heading.text} holds no number; fill it in")
        return
    if not 0 < cell < math.inf:
        faults.append(
            f"line {row.line}: {one.heading.text} is {cell:g}; an uncertainty must be above 0"
        )
        return
    own = row.set.get(name) if one.entry.is_parameter else _mean(row.values.get(name, []))
    u = cell * one.factor * (abs(own or 0.0) if one.relative else 1.0)
    (row.u_set if one.entry.is_parameter else row.u)[name] = u / (_ROOT_3 if one.limits else 1.0)


def _mean(values: Sequence[float]) -> float:
    known = [value for value in values if math.isfinite(value)]
    return sum(known) / len(known) if known else math.nan


def _faults_of(row: _Row, cells: Sequence[tuple[Meaning, float]]) -> Iterator[str]:
    """Cells without which the row says nothing."""
    for one, cell in cells:
        if one.role in (PARAMETER, COUNT) and not math.isfinite(cell):
            yield f"{one.heading.text} holds no finite number; fill it in or delete the row"
        if one.role == COUNT and cell <= 0:
            yield f"{one.heading.text} is {cell:g}; expected a number above 0"
        if one.role == MEASURED and math.isinf(cell):
            yield f"{one.heading.text} is not finite"
        if one.role == MEASURED and one.entry and one.entry.counted and cell <= 0:
            yield f"{one.heading.text} is {cell:g}; expected a time above 0"
    for name, values in row.values.items():
        if all(map(math.isnan, values)):
            texts = [one.heading.text for one, _ in cells if one.entry and one.entry.name == name
                     and one.role == MEASURED]  # fmt: skip
            yield f"{', '.join(texts)} holds no number; fill it in or delete the row"


def _groups(rows: Sequence[_Row]) -> list[list[_Row]]:
    """Rows in which the same was set."""
    groups: dict[tuple[tuple[str, float], ...], list[_Row]] = {}
    for row in rows:
        groups.setdefault(tuple(row.set.items()), []).append(row)
    return list(groups.values())


def _experiment(rows: Sequence[_Row], digits: Mapping[str, float]) -> Experiment:
    readings = {}
    for name in rows[0].values:
        values = [value for row in rows for value in row.values[name] if math.isfinite(value)]
        stated = [row.u[name] for row in rows if name in row.u]
        if values:
            u = math.sqrt(sum(u * u for u in stated) / len(stated)) if stated else None
            readings[name] = Reading(tuple(values), u, digits.get(name, 0.0))
    u_set = {name: u for row in rows for name, u in row.u_set.items()}
    return Experiment(tuple(row.line for row in rows), rows[0].set, u_set, readings)


def basis_of(found: Sequence[Experiment], result: str) -> Basis:
    """Where the uncertainty of a result comes from: what is stated, else repeats, else the rows."""
    readings = [one.readings[result] for one in found if result in one.readings]
    # repeats that agree to the last digit are no better than that digit
    least = min(reading.digit for reading in readings) / _ROOT_12
    if all(reading.u is not None for reading in readings):
        return Basis(STATED, least=least)
    degrees = sum(len(reading.values) - 1 for reading in readings)
    if not degrees:
        return Basis(SCATTER, least=least)
    squares = sum((value - reading.mean) ** 2 for reading in readings for value in reading.values)
    return Basis(REPEATS, max(math.sqrt(squares / degrees), least), degrees, least)


def u_of(reading: Reading, basis: Basis) -> float:
    """Standard uncertainty of a mean, where single rows tell it."""
    if basis.u is not None:
        return basis.u / math.sqrt(len(reading.values))
    return reading.u or basis.least


def above(
    about: Mapping[str, str], known: Vocabulary, faults: list[str], label: str
) -> dict[str, float]:
    """Parameters that lines above a table say, such as ``# angle: 8 deg``; others are remarks."""
    values = {}
    for key, text in about.items():
        plain = [word for word in words(key) if not word.isdigit()]
        entry = next((one for one in known.entries if one.is_parameter
                      and told(plain, one.called, known.fillers)), None)  # fmt: skip
        if entry is None or not any(sign.isdigit() for sign in text[:2]):
            continue
        try:
            values[entry.name] = units.to_si(
                units.with_point(text) or text, entry.unit, spoken(entry)
            )
        except InputError as error:
            faults.append(f"above the table, {key}: {error.faults[0]}")
    return values


def column(found: Sequence[Experiment], name: str) -> Array:
    """What was set in every experiment (n,)."""
    return np.array([one.set[name] for one in found])


def varied(found: Sequence[Experiment]) -> list[str]:
    """Parameters that differ between experiments, in the order of the columns."""
    names = list(dict.fromkeys(itertools.chain.from_iterable(one.set for one in found)))
    return [name for name in names if len({one.set.get(name) for one in found}) > 1] or names[:1]
