"""``simcompare robot``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from simcompare.cli import console

if TYPE_CHECKING:
    from simcompare.verbs.robot import RobotParts


def robot(
    robot: Path = typer.Option(
        None, metavar="FILE", help="File of a robot; our own where it is left out."
    ),
    out: Path = typer.Option(
        None, "--out", "-o", help="Folder for models, drawings, tables and the ROS 2 package."
    ),
    template: bool = typer.Option(
        False, "--template", help="Print our own robot's file, to be changed."
    ),
    as_json: bool = typer.Option(False, "--json", help="Print one JSON object."),
) -> None:
    """Write models, drawings and tables of a robot from one file."""
    from simcompare.model.plain import plain
    from simcompare.verbs import robot as verb

    if template:
        console.print_wanted(verb.template(), nl=False)
        return
    made = verb.robot(robot, out=out)
    if as_json:
        console.print_json({**plain(made), "files": [str(path) for path in made.files]})
        return
    _show(made)


def _show(made: RobotParts) -> None:
    known = made.parameters
    count = len(made.unconfirmed)
    console.print_wrapped(
        [
            f"{made.title}: {made.mass_kg:.4g} kg. Without the wheels, its centre of mass is"
            f" {1000 * known['center_behind_m']:.3g} mm behind the axle and"
            f" {1000 * known['center_height_m']:.3g} mm above the floor."
        ]
    )
    table = console.Rows("parameter of a scenario", "value")
    for name, value in known.items():
        table.add_row(name, f"{value:.6g}")
    typer.echo()
    console.show_table(table)
    typer.echo()
    told = [f"left out: {sentence}" for sentence in made.left_out]
    if count:
        told.append(
            f"not confirmed, so weigh and measure your own ({count}): {', '.join(made.unconfirmed)}"
        )
    console.print_wrapped(told)
    for path in made.files:
        typer.echo(str(path))
    if not made.files:
        typer.echo("nothing is written without --out FOLDER")
