"""Opening a report in the browser."""

from __future__ import annotations

import contextlib
import webbrowser
from pathlib import Path

import typer

from simcompare.errors import InputError, UnknownName

#: the option of every verb that writes a report
OPTION = typer.Option(False, "--open", help="Open the report in the browser.")


def check(wanted: bool, *, report: bool, figures: str | None = None) -> None:
    """Refuses to open a report that is not written, and formats that no figure has.

    Raises:
        InputError: --open and --no-report together.
        UnknownName: no such format.
    """
    if figures is not None:
        from simcompare.reports.render import matplotlib_

        if figures not in matplotlib_.FORMATS:
            raise UnknownName("figure format", figures, matplotlib_.FORMATS)
    if wanted and not report:
        raise InputError("--open", ["there is no page to open; leave out --no-report"])


def open_page(page: Path | None) -> None:
    """Opens a file in the browser; where there is none, says which file to open.

    Args:
        page: the file; nothing is done where it is ``None``.
    """
    if page is not None:
        open_address(page.resolve().as_uri(), str(page))


def open_address(address: str, shown: str = "") -> None:
    """Opens an address in the browser; where there is none, says what to open.

    Args:
        address: of the page.
        shown: what people call it.
    """
    if not _opened(address):
        typer.echo(f"No browser was found; open {shown or address}", err=True)


def _opened(address: str) -> bool:
    with contextlib.suppress(webbrowser.Error):
        return webbrowser.open(address)
    return False
