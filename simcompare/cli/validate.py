"""``simcompare validate``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from simcompare.cli import complete, console, ending, manner, opening, writing
from simcompare.errors import InputError

if TYPE_CHECKING:
    from simcompare.reports.render.tables import Table
    from simcompare.results.run import Run


def validate(
    scenario: str = typer.Argument(
        help="Name, folder or file of a scenario.", autocompletion=complete.scenarios
    ),
    recording: str = typer.Option(
        None,
        "--recording",
        "-r",
        help="A public recording (simcompare data list), an imported one, a log, or a table of"
        " results such as lengths and periods.",
        autocompletion=complete.recordings,
    ),
    engine: str = typer.Option(
        "all", help="'all' or names with commas.", autocompletion=complete.engines
    ),
    contact: str = typer.Option(
        "assisted", help="One contact level.", autocompletion=complete.contact_levels
    ),
    mapping: Path = typer.Option(
        None, "--map", help="YAML file that says which channel is which quantity (validate:)."
    ),
    settings: list[str] = typer.Option(
        [], "--set", metavar="P=V", help="Replace what is known of a parameter, such as mass=0.5kg."
    ),
    streams: str = typer.Option(None, help="Streams that are judged, with commas."),
    step: str = typer.Option(None, help="Time between samples, such as 1ms."),
    strict: bool = typer.Option(False, "--strict", help="Refuse a log with any defect."),
    template: bool = typer.Option(
        False, "--template", help="Write a mapping file for --map, to be filled in, and stop."
    ),
    out: Path = typer.Option(
        None, "--out", "-o", help="Folder for the run's own folder (runs); file of a --template."
    ),
    report: bool = typer.Option(True, help="Write report.html into the run's folder."),
    opened: bool = opening.OPTION,
    as_json: bool = typer.Option(False, "--json", help="Print one JSON object."),
    time_limit: float = typer.Option(120.0, help="Longest time for one simulation, in seconds."),
) -> None:
    """Hold simulations against a recording of a real device."""
    from simcompare.cli import table_shown
    from simcompare.model.plain import plain
    from simcompare.verbs import validate as validating
    from simcompare.verbs.tabled import Tabled

    if template:
        if as_json:
            raise InputError("--json", ["does not go with --template, which writes YAML"])
        _template(scenario, recording, mapping, out)
        return
    if recording is None:
        raise InputError("--recording", ["no recording is given; simcompare data list has some"])
    opening.check(opened, report=report)
    with console.progress_bar(scenario) as progress:
        result = validating.validate(
            scenario,
            recording=recording,
            engine=engine,
            contact=contact,
            mapping=mapping,
            set=console.pairs(settings),
            streams=streams.split(",") if streams else (),
            step=step,
            strict=strict,
            out=out or Path("runs"),
            time_limit_s=time_limit,
            progress=progress,
        )
    if isinstance(result, Tabled):
        table_shown.finish(result, report=report, opened=opened, as_json=as_json)
    ending.finish_run(
        result,
        lambda: {**plain(result.record), "exit_code": result.exit_code},
        lambda page: _print(result, page),
        report=report,
        opened=opened,
        as_json=as_json,
    )


def _template(scenario: str, recording: str | None, mapping: Path | None, out: Path | None) -> None:
    from simcompare.verbs.validation_template import template

    text = template(scenario, recording=recording, mapping=mapping)
    if out is None:
        console.print_wanted(text, nl=False)
        return
    name = f"{Path(scenario).stem}_map.yaml"
    typer.echo(str(writing.text_file(out, name, text, mark=text)))  # no filled-in one is replaced


def _print(result: Run, page: Path | None) -> None:
    from simcompare import glossary
    from simcompare.reports.validation import answer, short, summary_table, validations

    validation = validations.validation(result)
    console.print_wrapped(map(_printable, short.short(validation)))
    _show(summary_table.summary(validation))
    typer.echo()
    console.print_wrapped(glossary.legend(summary_table.words(validation)))
    for source in result.record.sources:
        if source.status != "ok":
            console.print_wrapped([_printable(f"{source.name}, {source.contact}: {source.reason}")])
    told = validation.sentences if manner.is_verbose() else answer.remarks(validation)
    said = short.short(validation)
    console.print_wrapped(_printable(text) for text in told if text not in said)
    if manner.is_verbose():
        _show_all(result)
    ending.show_places(result.folder, page)


def _show_all(result: Run) -> None:
    """The tables that only few want, and where the recording comes from."""
    from simcompare.reports.validation import events, parameter_tables, tables, validations

    validation = validations.validation(result)
    _show(parameter_tables.parameters(result, chosen=True))
    if validation.waveforms:
        _show(tables.waveforms(result))
    _show(events.summary(result))
    _show(tables.values(result))
    about = [validation.about[key] for key in ("title", "citation") if validation.about.get(key)]
    console.print_wrapped(map(_printable, about))


def _printable(text: str) -> str:
    """Text that may hold names from files, which must not steer the terminal."""
    from simcompare.reports.render.tables import printable

    return printable(text)


def _show(table: Table | None) -> None:
    if table is not None:
        typer.echo("")
        console.show_table(table)
