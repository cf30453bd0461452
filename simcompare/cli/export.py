"""``simcompare export``."""

from __future__ import annotations

import functools
import io
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from simcompare.cli import complete, console, writing
from simcompare.errors import InputError

if TYPE_CHECKING:
    from simcompare.exporters.scripts.write import Script
    from simcompare.model.trajectory import Array


def _formats(incomplete: str) -> list[str]:
    from simcompare.exporters.twins import FORMATS, SCRIPT

    return [name for name in (*FORMATS, SCRIPT) if name.startswith(incomplete)]


def export(
    scenario: str = typer.Argument(
        help="Name, folder or file of a scenario.", autocompletion=complete.scenarios
    ),
    format: str = typer.Option(
        "urdf",
        help="urdf (the mechanism), sdf (the whole world, for Gazebo), mjcf (MuJoCo) or script"
        " (a program that needs only --engine and numpy).",
        autocompletion=_formats,
    ),
    settings: list[str] = typer.Option(
        [], "--set", metavar="P=V", help="Change a parameter, such as torque=10mN*m."
    ),
    robot: Path = console.ROBOT,
    preset: str = typer.Option(None, help="Named set of parameters, applied before --set."),
    fit: str = typer.Option(None, help="fit.json of simcompare fit, whose parameters are used."),
    contact_values: bool = typer.Option(
        False, "--contact-values", help="Print each engine's own contact values of the fit."
    ),
    engine: str = typer.Option(None, help="Engine of a script.", autocompletion=complete.engines),
    own: list[str] = typer.Option(
        [],
        metavar="ENGINE.VALUE=V",
        help="A contact value of the engine of a script, such as pymunk.elasticity=0.9.",
        autocompletion=complete.own_values,
    ),
    step: str = typer.Option(None, help="Engine's step of a script, such as 1ms."),
    contact: str = typer.Option(
        None,
        help="Contact level of a script: default, coefficients or tuned; with --fit: tuned, else"
        " default.",
    ),
    out: Path = typer.Option(
        None, "--out", "-o", help="File or folder to write; stdout by default."
    ),
    as_json: bool = typer.Option(False, "--json", help="Print one JSON object."),
) -> None:
    """Write a scenario for another simulator, or as a script."""
    from simcompare.exporters.scripts.write import script
    from simcompare.exporters.twins import FORMATS, SCRIPT, twin

    options = {
        "--engine": engine, "--step": step, "--contact": contact, "--own": ", ".join(own) or None,
    }  # fmt: skip
    if contact_values:
        given = {**options, "--set": settings or None, "--robot": robot, "--preset": preset}
        _print_contact_values(scenario, fit, given, out)
        return
    if format == SCRIPT:
        write = functools.partial(
            script, scenario, engine=engine, set=console.pairs(settings), robot=robot,
            preset=preset, fit=fit,
            own=console.pairs(own, "--own", "ENGINE.VALUE=number"), step=step, contact=contact,
        )  # fmt: skip
        _script(write, out, as_json=as_json)
        return
    _refuse_options(format, options)
    made = twin(
        scenario, format=format, set=console.pairs(settings), robot=robot, preset=preset, fit=fit
    )
    written = None
    if out is not None:
        name = f"{made.scenario}{FORMATS[format]}"
        written = writing.text_file(out, name, made.text, "by simcompare\n")
    if as_json:
        console.print_json(
            {
                "format": made.format,
                "file": None if written is None else str(written),
                "bodies": made.bodies,
                "joints": made.joints,
                "left_out": made.left_out,
            }
        )
        return
    if written is None:  # UTF-8 whatever the terminal's encoding is: the text may go into a file
        console.print_wanted(made.text.encode("utf-8"), nl=False)
    else:
        typer.echo(str(written))
    for sentence in made.left_out:
        typer.echo(f"left out: {sentence}", err=True)


def _refuse_options(format: str, options: Mapping[str, str | None]) -> None:
    given = [name for name, value in options.items() if value is not None]
    if given:
        faults = [f"{name} is for --format script, not for {format}" for name in given]
        raise InputError("export", faults)


def _script(write: Callable[..., Script], out: Path | None, *, as_json: bool) -> None:
    """Writes a script, and beside it the file of inputs that it may need."""
    if out is not None and not out.is_dir() and out.suffix != ".py":
        raise InputError(f"--out {out}", ["a script is a file that ends with .py"])
    name = None if out is None or out.is_dir() else out.stem
    made = write(name=name)
    files: list[Path] = []
    if out is None and made.inputs:
        raise InputError(
            "--out",
            [f"the script reads long inputs from a file beside it; say where: -o {made.name}.py"],
        )
    if out is not None:
        files = [writing.text_file(out, f"{made.name}.py", made.text, "\nWritten by simcompare ")]
        if made.inputs:
            files.append(_write_inputs(files[0].with_name(f"{made.name}_inputs.npz"), made.inputs))
    if as_json:
        console.print_json(
            {
                "format": "script",
                "file": str(files[0]) if files else None,
                "inputs": str(files[1]) if len(files) > 1 else None,
                "bodies": list(made.bodies),
                "joints": list(made.joints),
                "left_out": list(made.left_out),
            }
        )
        return
    if not files:
        console.print_wanted(made.text.encode("utf-8"), nl=False)
    for file in files:
        typer.echo(str(file))
    for sentence in made.left_out:
        typer.echo(f"left out: {sentence}", err=True)


def _write_inputs(path: Path, inputs: Mapping[str, Array]) -> Path:
    import numpy as np

    from simcompare.reports.render import output

    stream = io.BytesIO()
    np.savez(stream, allow_pickle=False, **inputs)
    return output.write(path, stream.getvalue(), f"{next(iter(inputs))}.npy".encode())


def _print_contact_values(
    scenario: str, fit: str | None, options: Mapping[str, object], out: Path | None
) -> None:
    """Prints, or writes, the contact values of a fit, which has all else in it."""
    from simcompare.results import contact_values, fit_file
    from simcompare.scenarios import catalogue

    if fit is None:
        raise InputError("--contact-values", ["needs a fit; give --fit fit.json"])
    given = [name for name, value in options.items() if value is not None]
    if given:
        cure = "the values are those of the fit; fit with another --step for another step"
        raise InputError("--contact-values", [f"takes no {name}: {cure}" for name in given])
    path = fit_file.find(fit) or Path(fit)
    fit_file.read(path).base(catalogue.load(scenario))  # is it of this scenario?
    text = contact_values.contact_values(path)
    if out is None:
        console.print_wanted(text, nl=False)
    else:
        name = f"{scenario}_contact_values.txt"
        typer.echo(str(writing.text_file(out, name, text, f"# {Path(scenario).stem}, fitted at ")))
