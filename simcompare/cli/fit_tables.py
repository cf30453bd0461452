"""What ``simcompare fit`` prints."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from simcompare import glossary
from simcompare.cli import console, ending, manner
from simcompare.engine import engines
from simcompare.model.settings import TUNED
from simcompare.notation import sentence
from simcompare.reports.fit import (
    budget,
    engine_words,
    fits,
    form_words,
    short,
    summary_tables,
    tosses,
    tuned,
    waveforms,
)
from simcompare.reports.fit import tables as fitted_tables
from simcompare.reports.render.tables import printable
from simcompare.reports.validation import phrases
from simcompare.results import fit_file
from simcompare.results.records.fit_bounces import BouncesFit
from simcompare.results.records.fit_tosses import TossFit
from simcompare.results.records.fit_waveforms import WaveformFit
from simcompare.scenarios import catalogue

if TYPE_CHECKING:
    from simcompare.reports.render.tables import Table
    from simcompare.results.records.fit import AnyFit
    from simcompare.results.run import Run

#: remarks that are printed without being asked for
_FEW = 3


def show(result: Run, written: Path | None) -> None:
    """Prints the answer in short, what was found, and what each engine must be given."""
    found = fits.of_any(result)
    console.print_wrapped(short.short(result))
    for table in (summary_tables.found(result), summary_tables.given(result)):
        if table is not None:
            typer.echo()
            console.show_table(table)
    if isinstance(found, BouncesFit):
        console.print_wrapped(engine_words.one_number(found))
    typer.echo()
    console.print_wrapped(glossary.legend(_words(found)))
    _show_remarks(found)
    if manner.is_verbose():
        _show_all(result, found)
    _show_places(result, found)
    ending.show_places(result.folder, written)


def _show(table: Table | None) -> None:
    if table is not None:
        typer.echo()
        if table.title:
            typer.echo(table.title)
        console.show_table(table)


def _words(found: AnyFit) -> tuple[str, ...]:
    """Words of the tables that a legend explains."""
    if isinstance(found, BouncesFit):
        slope = ("exponent",) if fits.EXPONENT in found.closed_form.parameters else ()
        own = ("first restitution", "u in brackets") if found.is_tuned else ("u",)
        return ("± 95 %", *slope, *own)
    return ("± 95 %", "u in brackets") if isinstance(found, WaveformFit) else ("held out",)


def _show_remarks(found: AnyFit) -> None:
    """What was left out, what failed, and what the reader must not miss."""
    rows = [f"{s.name}: {s.failure}" for s in found.sources if s.status != "ok"]
    console.print_wrapped(map(printable, rows))
    console.print_wrapped(sentence(printable(text)) for text in _limits(found))
    remarks = list(_remarks(found))
    most = len(remarks) if manner.is_verbose() else _FEW
    console.print_wrapped(sentence(printable(text)) for text in remarks[:most])
    if len(remarks) > most:
        more = phrases.counted(len(remarks) - most, "more remark")
        typer.echo(f"{more}: -v, or the report.")


def _limits(found: AnyFit) -> Iterator[str]:
    """How far a fit of bounces can be trusted; every reader is told."""
    if isinstance(found, BouncesFit):
        if found.choice.rivals:
            yield from form_words.cure(found.choice, found.closed_form)
        yield from budget.words(found)
        yield found.holdout.text


def _remarks(found: AnyFit) -> Iterator[str]:
    if isinstance(found, BouncesFit):
        yield from found.dropped
        yield from found.closed_form.warnings
        yield from (found.identifiability.words if _is_weak(found) else ())
    elif isinstance(found, WaveformFit):
        yield from found.chosen_words
        yield from (found.identifiability.words if _is_weak(found) else ())
        yield found.holdout.text
    else:
        yield from found.told[:1]


def _is_weak(found: BouncesFit | WaveformFit) -> bool:
    return any(one.weak for one in found.identifiability.directions)


def _show_all(result: Run, found: AnyFit) -> None:
    """Every sentence, and the tables that only few want."""
    typer.echo()
    console.print_wrapped(map(printable, short.others(result, found.sentences)))
    for table in _tables(result, found):
        _show(table)


def _tables(result: Run, found: AnyFit) -> Sequence[Table | None]:
    if isinstance(found, TossFit):
        return [tosses.scales(found)]
    if isinstance(found, WaveformFit):
        return [fitted_tables.parameters(result), waveforms.effective(result),
                waveforms.holdout(result)]  # fmt: skip
    own = [tuned.contacts(result), tuned.impacts(result)] if found.is_tuned else []
    more = [fitted_tables.parameters(result), fitted_tables.forms(result)]
    return [*own, budget.table(result), *more, fitted_tables.holdout(result)]


def _show_places(result: Run, found: AnyFit) -> None:
    """How the stored fit is used again."""
    able = short.able(found.sources)
    if result.folder is None or isinstance(found, WaveformFit) or not able:
        return
    place = shlex.quote(str(result.folder / fit_file.FILE))
    scenario = shlex.quote(str(result.record.scenario_asked))
    again = f"{scenario} --engine {','.join(able)} --contact {place}{_scene(result, found)}"
    typer.echo(f"Use it again: simcompare run {again}")
    if isinstance(found, BouncesFit) and found.contact == TUNED:
        export = f"simcompare export {scenario} --fit {place}"
        typer.echo(f"All settings to type in: {export} --contact-values")
        for writer in [one for one in able if _has_scripts(one)][:1]:
            script = f"--format script --engine {writer} -o {result.record.scenario}_{writer}.py"
            typer.echo(f"As a script that needs no simcompare: {export} {script}")


def _scene(result: Run, found: AnyFit) -> str:
    """Options with which a run is the scene that was fitted: its step, or how high it falls."""
    if isinstance(found, TossFit):
        return f" --step {found.valid.engine_step_s!r}s"
    assert result.folder is not None
    file = catalogue.load(str(result.record.scenario_asked))
    heights = fit_file.read(result.folder / fit_file.FILE).drop(file)
    return "".join(f" --set {name}={value!r}" for name, value in heights.items())


def _has_scripts(engine: str) -> bool:
    """Whether scenes of an engine can be written as scripts."""
    backend = engines.get(engine) if engine in engines.names() else None
    return bool(getattr(backend, "script_module", ""))
