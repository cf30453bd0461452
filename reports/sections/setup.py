"""How the run was made, and how to make it again."""

from __future__ import annotations

from collections.abc import Iterator

from simcompare import units
from simcompare.reports.render import numbers
from simcompare.reports.render.parts import Part
from simcompare.reports.render.tables import Column, Group, Table, of_engines
from simcompare.reports.run import not_run, runs
from simcompare.reports.run.reproduce import command, scripts
from simcompare.results.records.run import SourceRecord
from simcompare.results.run import Run

_PARAMETERS = (
    Column("Parameter", text=True), Column("Value"), Column("Unit", text=True, nowrap=True),
    Column("Meaning", text=True),
)  # fmt: skip
_SOURCES = (
    Column("Version", text=True), Column("Mode", text=True), Column("Status", text=True),
    Column("Repeats"), Column("Samples"), Column("Build (ms)"), Column("Run (ms)"),
    Column("µs per sample"),
)  # fmt: skip
_FINDING = "the command, parameters, settings, versions and times"
_TIMES = (
    "Times are wall times of one repeat, the mean over the repeats. A sample may hold many inner"
    " steps of the engine; the notes above say so."
)


def setup(run: Run) -> Part:
    """Everything that is needed to repeat and to cite the run."""
    record = run.record
    parameters = tuple(_parameter(run, name) for name in record.parameters)
    sources = of_engines(_SOURCES, [Group("", tuple(map(_times, record.sources)))], _TIMES)
    versions = {**vars(record.software), **vars(record.machine)}
    facts = {name.replace("_", " "): value or "–" for name, value in versions.items()}
    return Part("How it was made", "setup", folded=True, finding=_FINDING, parts=(
        Part("To make it again", code=command(run), parts=tuple(_scripts(run)),
             tables=not_run.tables(run)),
        Part("Parameters", tables=(Table("", _PARAMETERS, (Group("", parameters),)),)),
        Part("Settings", facts=_settings(run)),
        Part("Versions and wall times", tables=(sources,), parts=(Part(facts=facts),)),
    ))  # fmt: skip


def _scripts(run: Run) -> Iterator[Part]:
    title = "Each row as a script that needs only its engine and numpy"
    if commands := scripts(run):
        yield Part(title, code="\n".join(commands), folded=True)


def _dither(run: Run) -> str | None:
    """How the repeats differ."""
    dither = run.record.dither
    if not dither or run.record.repeats < 2:
        return None
    name = dither.parameter
    unit = units.symbol(units.unit_of(name))
    each = [step.dither for step in runs.steps(run) if step.dither] or [dither]
    spans = " or ".join(dict.fromkeys(numbers.plain(one.span, 3) for one in each))
    span = spans + ("" if unit == "1" else f" {unit}")
    return f"{name.removesuffix(units.suffix_of(name))}, spread over {span}. {dither.reason}"


def _parameter(run: Run, name: str) -> tuple[str, ...]:
    unit = units.symbol(units.unit_of(name))
    return (
        name.removesuffix(units.suffix_of(name)),
        numbers.plain(run.record.parameters[name]),
        "" if unit == "1" else unit,
        run.record.parameter_texts.get(name, ""),
    )


def _settings(run: Run) -> dict[str, str]:
    record = run.record
    dither = _dither(run)
    return {
        "scenario": f"{record.scenario} (SHA-256 {record.scenario_sha256[:12]}…)",
        "made": str(record.created),
        "stored in": str(record.run or "was not stored"),
        "preset": str(record.preset or "none"),
        "time between samples": f"{_samples(run)} s",
        "simulated time": f"{numbers.plain(record.duration_s, 4)} s",
        "repeats": str(record.repeats),
        "seed": str(record.seed),
        "truth": str(record.truth or "none"),
        **({"repeats differ in": dither} if dither else {}),
    }


def _samples(run: Run) -> str:
    each = [step.step_s for step in runs.steps(run)] or [run.record.step_s]
    return " or ".join(dict.fromkeys(map(numbers.plain, each)))


def _times(source: SourceRecord) -> tuple[str, ...]:
    # times are those of one simulation, like the steps
    wall, total = source.wall_s, source.steps or 0
    return (
        source.name,
        source.version or "–",
        runs.mode_words(source.contact),
        source.status,
        str(source.repeats),
        "–" if source.steps is None else str(source.steps),
        _ms(wall.build),
        _ms(wall.step),
        numbers.plain(1e6 * (wall.step or 0) / total, 3) if total else "–",
    )


def _ms(seconds: float | None) -> str:
    return numbers.plain(None if seconds is None else 1e3 * seconds, 3)
