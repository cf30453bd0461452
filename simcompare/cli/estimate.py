"""``simcompare estimate``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from simcompare.cli import complete, console, ending, manner, opening

if TYPE_CHECKING:
    from simcompare.results.records.estimation import Estimation


def estimate(
    scenario: str = typer.Argument(
        help="Name, folder or file of a scenario.", autocompletion=complete.scenarios
    ),
    recording: str = typer.Option(
        None,
        "--recording",
        "-r",
        help="A public recording, an imported one, or a log, in place of engines.",
        autocompletion=complete.recordings,
    ),
    mapping: Path = typer.Option(None, "--map", help="Mapping file with estimate:."),
    estimator: str = typer.Option(
        None,
        help="One that the scenario is prepared for; the first where left out.",
        autocompletion=complete.estimators,
    ),
    engine: str = typer.Option(
        "all", help="'all' or names with commas.", autocompletion=complete.engines
    ),
    contact: str = typer.Option(
        "assisted", help="Contact level.", autocompletion=complete.contact_levels
    ),
    sensors: str = typer.Option(
        None,
        metavar="S=SHEET",
        help="Data sheets of sensors with commas, such as imu=mpu6050; for the angle of a joint"
        " also chips to compare, such as adxl345,mpu6050.",
    ),
    option: list[str] = typer.Option(
        [], "--option", metavar="N=V", help="A number of the estimator, such as bias=0."
    ),
    settings: list[str] = typer.Option(
        [], "--set", metavar="P=V", help="Change a parameter of the scenario."
    ),
    robot: Path = console.ROBOT,
    preset: str = typer.Option(None, help="Named set of parameters, applied before --set."),
    step: str = typer.Option(None, help="Time step of the engines, such as 1ms."),
    draws: int = typer.Option(40, help="How often each motion is measured by other devices."),
    seed: int = typer.Option(0, help="Of the draws: the same one draws the same devices."),
    out: Path = typer.Option(Path("runs"), "--out", "-o", help="Folder for the results' folder."),
    report: bool = typer.Option(True, help="Write report.html into the results' folder."),
    opened: bool = opening.OPTION,
    details: bool = typer.Option(False, "--details", help="Print every state and every test."),
    as_json: bool = typer.Option(False, "--json", help="Print one JSON object."),
    time_limit: float = typer.Option(120.0, help="Longest time for one simulation, in seconds."),
) -> None:
    """Filter what sensors tell, and judge the filter by the truth."""
    from simcompare.model.plain import plain
    from simcompare.reports.estimation import page
    from simcompare.verbs import estimate as verb

    opening.check(opened, report=report)
    with console.progress_bar(scenario) as progress:
        result = verb.estimate(
            scenario,
            recording=recording,
            mapping=mapping,
            estimator=estimator,
            engine=engine,
            contact=contact,
            sensors=sensors,
            options=dict(console.pairs(option, "--option")),
            set=console.pairs(settings),
            robot=robot,
            preset=preset,
            step=step,
            draws=draws,
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


def _show(result: Estimation, page: Path | None, *, details: bool) -> None:
    """The answer in sentences, the table, and what its words mean."""
    from simcompare.reports.estimation import chips, tables
    from simcompare.reports.estimation import page as pages
    from simcompare.reports.render import numbers

    console.print_wrapped(map(numbers.tied, result.sentences))
    for asked in filter(None, (chips.table(result), chips.budget(result))):
        typer.echo(f"\n{asked.title}")
        console.show_table(asked)
    if result.done:
        table = tables.lead(result)
        typer.echo(f"\n{table.title}")
        console.show_table(table)
        console.print_wrapped(pages.legend(result))
    if result.done and (details or manner.is_verbose()):
        for table in (tables.of_tests(result), *tables.of_states(result)):
            typer.echo(f"\n{table.title}")
            console.show_table(table)
    console.print_wrapped(
        f"{one.source}: {one.reason}" for one in result.sources if one.reason and result.done
    )
    ending.show_places(result.folder, page)
