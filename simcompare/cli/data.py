"""``simcompare data``."""

from __future__ import annotations

import typer

from simcompare.cli import complete, console, manner

data = typer.Typer(
    cls=manner.Group, help="Public recordings of real hardware.", no_args_is_help=True
)


@data.command("list")
def list_(
    as_json: bool = typer.Option(False, "--json", help="Print one JSON object."),
) -> None:
    """Every public recording: what it is, its licence, whether it is here."""
    from simcompare.hardware.recordings import registry

    sets = {name: registry.get(name) for name in registry.files()}
    if as_json:
        rows = {
            name: {
                **found.model_dump(mode="json", by_alias=True, exclude={"read", "validation"}),
                "urls": [found.url(file) for file in found.files],
                "here": registry.place(name) is not None,
            }
            for name, found in sets.items()
        }
        console.print_json({"recordings": rows})
        return
    for name, found in sets.items():
        size = sum(file.size_bytes for file in found.files) / 1e6
        folder = registry.place(name)
        here = f"in {folder}" if folder else f"not here: simcompare data fetch {name}"
        scenarios = ", ".join(str(entry.get("scenario")) for entry in found.validation)
        lines = [f"{name}: {found.title}"]
        if manner.is_verbose():
            lines += [f"  {found.text}", f"  {found.citation}"]
        source = f"github.com/{found.source.repository} at {found.source.commit[:12]}"
        lines.append(f"  {found.licence}, {size:.2g} MB from {source}; {here}")
        if scenarios:
            lines.append(f"  scenario: {scenarios}")
        console.print_wrapped(lines)
    console.print_wrapped(
        [
            "simcompare validate SCENARIO --recording NAME holds engines against one.",
            "simcompare data list -v tells what each is, and whose it is.",
        ]
    )


@data.command("fetch")
def fetch(
    names: list[str] = typer.Argument(
        None, help="Names of recordings.", autocompletion=complete.recordings
    ),
) -> None:
    """Fetch recordings into the user's cache, checked by SHA-256."""
    from simcompare.hardware.recordings import registry

    registry.check_names(names or [])
    for name in names:
        for path in registry.fetch(name):
            typer.echo(str(path))
