"""``simcompare lab``."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from simcompare.cli import console, manner, opening
from simcompare.errors import BackendError, InputError, to_paste

if TYPE_CHECKING:
    from simcompare.lab.serving import Opened

#: what the extra [web] brings
_WEB = ("starlette", "uvicorn", "segno", "trustme")


def lab(
    port: int = typer.Option(8000, min=0, max=65535, help="Port of the page; 0 takes a free one."),
    share: bool = typer.Option(False, "--share", help="Let phones in: https, and a code to scan."),
    host: str = typer.Option(None, help="With --share: this computer's name or address to scan."),
    pin: str = typer.Option(None, help="With --share: the teacher's PIN; else one is made."),
    folder: Path = typer.Option(Path("lab"), help="Folder of all groups' recordings and results."),
    opened: bool = typer.Option(False, "--open/--no-open", help="Open the page in the browser."),
    language: str = typer.Option(
        None, help="Language of the page that is opened, en or de; else the browser's."
    ),
) -> None:
    """Open the lab: drop balls in all engines, and a real one."""
    _check(share=share, host=host, pin=pin, language=language)
    from simcompare.lab import serving, work

    wanted = serving.Wanted(folder, port, share, host or "", pin)
    made = serving.open_lab(wanted, work.perform)
    page = made.address + (f"?lang={language}" if language else "")

    def begun() -> None:
        _show(made, page, folder)
        if opened:
            opening.open_address(page)

    serving.serve(made, begun)
    is_used = made.lab.groups.leave()
    kept = f" What the groups have made is in {folder}." if is_used else ""
    console.print_wrapped([f"The lab is closed.{kept}"])


def _check(*, share: bool, host: str | None, pin: str | None, language: str | None) -> None:
    """Refuses what does not fit together, all of it at once.

    Raises:
        InputError: what.
        BackendError: the extra [web] is not installed.
    """
    given = {"--host": host, "--pin": pin}
    faults = [f"{name} needs --share beside it" for name in given if given[name] and not share]
    if pin is not None and not (pin.isascii() and pin.isdigit() and 4 <= len(pin) <= 12):
        faults.append("--pin must be 4 to 12 digits, such as 4711")
    if language not in (None, "en", "de"):
        faults.append(f"--language {language} is not spoken; choose en or de")
    if faults:
        raise InputError("lab", faults)
    missing = [name for name in _WEB if importlib.util.find_spec(name) is None]
    if missing:
        cure = to_paste("pip install 'simcompare[web]'")
        raise BackendError(f"the lab needs {', '.join(missing)}, not installed; cure: {cure}")


def _show(made: Opened, page: str, folder: Path) -> None:
    """Where the lab is, and how phones get in."""
    from simcompare.lab import refusals, share

    sentences = [f"The lab is open at {page} on this computer; Ctrl-C closes it."]
    if made.lab.address:
        typer.echo(share.code_as_text(made.lab.address))
        sentences = [
            f"Phones scan the code, or open {made.lab.address}",
            refusals.say("en", "share_warning"),
            f"The certificate begins with {made.fingerprint}.",
            f"The teacher's page is {made.address}teacher, with the PIN {made.pin}.",
            *sentences,
        ]
    console.print_wrapped([*sentences, f"Results are kept in {folder}."])
    if manner.is_verbose():
        typer.echo(f"{made.lab.queue.workers} jobs run at once.")
