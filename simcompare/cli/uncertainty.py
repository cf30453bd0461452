"""``simcompare uncertainty``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from simcompare.cli import complete, console, ending, manner, opening

if TYPE_CHECKING:
    from simcompare.results.records.uncertainty import Uncertainty


def uncertainty(
    scenario: str = typer.Argument(
        None,
        help="Name, folder or file of a scenario; none for a formula alone.",
        autocompletion=complete.scenarios,
    ),
    of: str = typer.Option(
        None, help="A result of the scenario, or a formula; its leading result without it."
    ),
    engine: str = typer.Option(
        "",
        help="Engines beside the closed form: 'all' or names with commas.",
        autocompletion=complete.engines,
    ),
    settings: list[str] = typer.Option(
        [], "--set", metavar="P=V", help="A value, such as wheel_radius=3cm."
    ),
    u: list[str] = typer.Option(
        [],
        "--u",
        metavar="P=U",
        help="Uncertainty of an input: 2%, 0.1mm (standard), ±5g (limits), '1g, dof 4' or exact.",
    ),
    inputs: Path = typer.Option(None, help="YAML file with more inputs."),
    correlation: list[str] = typer.Option(
        [], "--correlation", metavar="A,B=R", help="Correlation of two inputs, -1 to 1."
    ),
    contact: str = typer.Option(
        "assisted", help="Contact level of the engines.", autocompletion=complete.contact_levels
    ),
    robot: Path = console.ROBOT,
    preset: str = typer.Option(None, help="Named set of parameters, applied before --set."),
    step: str = typer.Option(None, help="Time step of the engines, such as 1ms."),
    seeds: int = typer.Option(None, help="Number of repeats, each with a slightly other start."),
    trials: int = typer.Option(
        None, help="Trials of Monte Carlo; given, they are made on the engines, too."
    ),
    probability: float = typer.Option(0.95, help="That the value lies in the interval."),
    seed: int = typer.Option(1, help="Of the random draws."),
    out: Path = typer.Option(Path("runs"), "--out", "-o", help="Folder for the results' folder."),
    report: bool = typer.Option(True, help="Write report.html into the results' folder."),
    opened: bool = opening.OPTION,
    details: bool = typer.Option(False, "--details", help="Print each engine's budget, too."),
    as_json: bool = typer.Option(False, "--json", help="Print one JSON object."),
    time_limit: float = typer.Option(120.0, help="Longest time for one simulation, in seconds."),
) -> None:
    """Tell how well a result is known, and which input matters."""
    from simcompare.model.plain import plain
    from simcompare.reports.uncertainty import page
    from simcompare.verbs import uncertainty as verb

    opening.check(opened, report=report)
    with console.progress_bar("uncertainty") as progress:
        result = verb.uncertainty(
            scenario,
            of=of,
            engine=engine,
            set=console.pairs(settings),
            robot=robot,
            u=console.pairs(u, "--u"),
            inputs=inputs,
            correlation=console.pairs(correlation, "--correlation"),
            contact=contact,
            preset=preset,
            step=step,
            seeds=seeds,
            trials=trials,
            probability=probability,
            seed=seed,
            out=out,
            time_limit_s=time_limit,
            progress=progress,
        )
    ending.finish_block(
        lambda: page.block_of(result),
        result.folder,
        lambda: {**plain(result), "exit_code": result.exit_code},
        lambda file: _show(result, file, details=details),
        result.exit_code,
        report=report,
        opened=opened,
        as_json=as_json,
    )


def _show(result: Uncertainty, page: Path | None, *, details: bool) -> None:
    """The answer, the budget, and the ways to the result side by side."""
    from simcompare import glossary
    from simcompare.reports.render import numbers
    from simcompare.reports.uncertainty import answer, tables

    console.print_wrapped(map(numbers.tied, answer.sentences(result)))
    console.print_wrapped(f"Did not run: {why}" for why in answer.not_run(result))
    shown = len(result.known) if details or manner.is_verbose() else 1
    for number in range(min(shown, len(result.known))):
        typer.echo("")
        console.show_table(tables.budget_of(result, number))
    words: tuple[str, ...] = tables.BUDGET_WORDS
    if len(result.known) > 1 or details:
        typer.echo("")
        console.show_table(tables.ways_of(result))
        words = (*words, *tables.WAYS_WORDS)
    typer.echo("")
    console.print_wrapped(f"{note}." for note in answer.notes(result))
    console.print_wrapped(glossary.legend(words))
    ending.show_places(result.folder, page)
