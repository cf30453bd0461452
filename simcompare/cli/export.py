"""``simcompare export``."""

from __future__ import annotations

from pathlib import Path

import typer

from simcompare.cli import complete


def _formats(incomplete: str) -> list[str]:
    from simcompare.exporters import FORMATS

    return [name for name in FORMATS if name.startswith(incomplete)]


def export(
    scenario: str = typer.Argument(
        help="Name, folder or file of a scenario.", autocompletion=complete.scenarios
    ),
    format: str = typer.Option(
        "urdf",
        help="urdf (the mechanism), sdf (the whole world, for Gazebo) or mjcf (MuJoCo).",
        autocompletion=_formats,
    ),
    settings: list[str] = typer.Option(
        [], "--set", metavar="P=V", help="Change a parameter, such as torque=10mN*m."
    ),
    preset: str = typer.Option(None, help="Named set of parameters, applied before --set."),
    fit: str = typer.Option(None, help="fit.json of simcompare fit, whose parameters are used."),
    contact_values: bool = typer.Option(
        False, "--contact-values", help="Print each engine's own contact values of the fit."
    ),
    out: Path = typer.Option(
        None, "--out", "-o", help="File or folder to write; stdout by default."
    ),
    as_json: bool = typer.Option(False, "--json", help="Print one JSON object."),
) -> None:
    """Write a scenario as a digital twin for another simulator."""
    from simcompare import exporters
    from simcompare.cli import console

    if contact_values:
        typer.echo(_contact_values(fit), nl=False)
        return
    twin = exporters.twin(
        scenario, format=format, set=console.pairs(settings), preset=preset, fit=fit
    )
    written = None
    if out is not None:
        written = _write(out, f"{twin.scenario}{exporters.FORMATS[format]}", twin.text)
    if as_json:
        console.print_json(
            {
                "format": twin.format,
                "file": None if written is None else str(written),
                "bodies": twin.bodies,
                "joints": twin.joints,
                "left_out": twin.left_out,
            }
        )
        return
    if written is None:  # UTF-8 whatever the terminal's encoding is: the text may go into a file
        typer.echo(twin.text.encode("utf-8"), nl=False)
    else:
        typer.echo(str(written))
    for sentence in twin.left_out:
        typer.echo(f"left out: {sentence}", err=True)


def _contact_values(fit: str | None) -> str:
    from simcompare.errors import InputError
    from simcompare.fitting import fit_file

    if fit is None:
        raise InputError("--contact-values", ["needs a fit; give --fit fit.json"])
    return fit_file.contact_values(fit_file.find(fit) or Path(fit))


def _write(out: Path, name: str, text: str) -> Path:
    from simcompare.errors import OutputError

    path = out / name if out.is_dir() else out
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise OutputError(
            f"--out {path}: cannot be written ({error.strerror or error}); choose another place"
        ) from None
    return path
