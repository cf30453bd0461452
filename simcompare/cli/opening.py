"""Opening a report in the browser."""

from __future__ import annotations

import contextlib
import webbrowser
from pathlib import Path

import typer

from simcompare.errors import InputError

#: the option of every verb that writes a report
OPTION = typer.Option(False, "--open", help="Open the report in the browser.")


def check(wanted: bool, *, report: bool) -> None:
    """Refuses to open a report that is not written.

    Raises:
        InputError: --open and --no-report together.
    """
    if wanted and not report:
        raise InputError("--open", ["there is no page to open; leave out --no-report"])


def open_page(page: Path | None) -> None:
    """Opens a file in the browser; where there is none, says which file to open.

    Args:
        page: the file; nothing is done where it is ``None``.
    """
    if page is not None and not _opened(page.resolve().as_uri()):
        typer.echo(f"No browser was found; open {page}", err=True)


def _opened(address: str) -> bool:
    with contextlib.suppress(webbrowser.Error):
        return webbrowser.open(address)
    return False
