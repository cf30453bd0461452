"""What differs between runs, and the title of each run that names just that."""

from __future__ import annotations

import functools
import itertools
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from simcompare import units
from simcompare.reports.render import numbers
from simcompare.reports.run import audit
from simcompare.results.records.run import Record, RunRecord, SourceRecord

#: shown of a value
_DIGITS = 6
#: so many engines are named in a title
_FEW = 3
#: what stands where a run has nothing of it
NONE = "–"


@dataclass(frozen=True)
class Difference:
    """One thing that is not the same in all runs.

    Attributes:
        name: such as "drop_height_m", "step_s" or "preset".
        label: as people say it, such as "drop_height".
        values: one for each run: numbers in SI, or words; ``None`` where a run has none.
        unit: of the numbers as they are written, empty for words.
        factor: from SI to that unit.
        leads: whether it belongs in titles; all else only where titles would be the same.
        alone: whether its words need no label before them.
        absent: what a title says where a run has none.
    """

    name: str
    label: str
    values: tuple[float | str | None, ...]
    unit: str = ""
    factor: float = 1.0
    leads: bool = True
    alone: bool = False
    absent: str = ""

    @property
    def numeric(self) -> bool:
        """Whether every run has a number of it."""
        return all(isinstance(value, float) for value in self.values)

    @property
    def head(self) -> str:
        """Label and unit."""
        return f"{self.label} ({self.unit})" if self.unit else self.label

    def number(self, run: int) -> str:
        """What one run has of it, without unit."""
        value = self.values[run]
        if isinstance(value, float):
            return numbers.plain(value * self.factor, _DIGITS)
        return NONE if value is None else value

    def text(self, run: int) -> str:
        """What one run has of it, in a title."""
        value = self.values[run]
        if isinstance(value, float):
            return f"{self.label} = {self.number(run)} {self.unit}".rstrip()
        if value is None:
            return self.absent or f"no {self.label}"
        many = value.count(", ") + 1
        if self.name == "engines" and many > _FEW:
            return f"{many} engines"
        return value if self.alone else f"{self.label} {value}"


def differences(records: Sequence[Record]) -> tuple[Difference, ...]:
    """Everything that differs, what the user chose first."""
    fits = tuple(r.fit_asked if isinstance(r, RunRecord) else None for r in records)
    found = [
        Difference("scenario", "scenario", tuple(r.scenario for r in records), alone=True),
        Difference("preset", "preset", tuple(r.preset for r in records)),
        *_parameters(records),
        Difference("step_s", "step", tuple(map(_steps, records)), "ms", 1e3),
        Difference("helps", "helps", tuple(r.assist for r in records), absent="all helps"),
        Difference("fit", "fit", fits),
        *_sources(records),
    ]
    return tuple(one for one in found if len(set(one.values)) > 1)


def in_titles(found: Sequence[Difference], runs: int) -> tuple[Difference, ...]:
    """What leads, and as much more as tells the runs apart."""
    told = [one for one in found if one.leads]
    for one in found:
        if not one.leads and _count([*told, one], runs) > _count(told, runs):
            told.append(one)
    return tuple(told)


def titles(told: Sequence[Difference], names: Sequence[str]) -> tuple[str, ...]:
    """One title for each run.

    Args:
        told: what they name.
        names: of the runs, for the case that this is nothing.
    """
    if not told:
        return _numbered(names)
    return _numbered([", ".join(one.text(run) for one in told) for run in range(len(names))])


def _count(told: Sequence[Difference], runs: int) -> int:
    """How many runs these differences tell apart."""
    return len({tuple(one.values[run] for one in told) for run in range(runs)})


def _numbered(texts: Sequence[str]) -> tuple[str, ...]:
    """Those that are the same get a number."""
    total, seen = Counter(texts), Counter[str]()
    numbered = []
    for text in texts:
        seen[text] += 1
        numbered.append(f"{text} ({seen[text]})" if total[text] > 1 else text)
    return tuple(numbered)


def _parameters(records: Sequence[Record]) -> list[Difference]:
    """Values of parameters that all runs have, but those that follow from the preset alone."""
    shared = [
        name
        for name in records[0].parameters
        if all(name in record.parameters for record in records)
    ]
    found = []
    for name in shared:
        values = tuple(float(record.parameters[name]) for record in records)
        if not _follows(records, name, values):
            suffix = units.suffix_of(name)
            unit = units.symbol(units.unit_of(name)) if suffix else ""
            found.append(Difference(name, name.removesuffix(suffix), values, unit))
    return found


def _follows(records: Sequence[Record], name: str, values: Sequence[float | str | None]) -> bool:
    """Whether a value is told by the scenario and preset of a run, and nobody set it."""
    pairs = {(record.scenario, record.preset) for record in records}
    told = {(r.scenario, r.preset, value) for r, value in zip(records, values, strict=True)}
    return 1 < len(pairs) == len(told) and not any(_is_set(record, name) for record in records)


def _is_set(record: Record, name: str) -> bool:
    words = record.command or ()
    texts = [b for a, b in itertools.pairwise(words) if a == "--set"]
    given = {text.partition("=")[0].strip() for text in texts}
    return bool(given & {name, name.removesuffix(units.suffix_of(name))})


def _steps(record: Record) -> float | str:
    """The engines' step as the scenario asks for it [s]; of several, as words."""
    if record.steps:
        each = sorted(step.engine_step_s for step in record.steps)
        return f"{', '.join(numbers.plain(1e3 * step_s, _DIGITS) for step_s in each)} ms"
    rows = [row for source in record.sources for row in source.audit if row.quantity == audit.STEP]
    known = next((row.scenario_value for row in rows if row.scenario_value is not None), None)
    return float(record.step_s if known is None else known)


def _sources(records: Sequence[Record]) -> list[Difference]:
    """What differs of those that were compared, and how often they ran."""
    engines, levels = (
        tuple(", ".join(dict.fromkeys(map(part, record.sources))) for record in records)
        for part in (_engine, lambda source: source.contact)
    )
    measured = tuple(r.against_asked if isinstance(r, RunRecord) else None for r in records)
    repeats = tuple(float(record.repeats) for record in records)
    made = tuple(record.software.simcompare for record in records)
    of = functools.partial(Difference, leads=False)
    return [
        of("engines", "engines", engines, alone=True),
        of("levels", "levels", levels, alone=True),
        of("versions", "versions", _versions(records), alone=True, absent="the same versions"),
        of("simcompare", "simcompare", made),
        of("against", "against", measured, absent="against nothing"),
        of("repeats", "repeats", repeats),
    ]


def _engine(source: SourceRecord) -> str:
    return source.engine or source.name


def _versions(records: Sequence[Record]) -> tuple[str | None, ...]:
    """Versions of the engines that have not the same one in all runs."""
    every = [{_engine(s): s.version for s in r.sources if s.version} for r in records]
    known: dict[str, set[str]] = {}
    for versions in every:
        for name, version in versions.items():
            known.setdefault(name, set()).add(version)
    apart = [name for name, found in known.items() if len(found) > 1]
    return tuple(
        ", ".join(f"{name} {one[name]}" for name in apart if name in one) or None for one in every
    )
