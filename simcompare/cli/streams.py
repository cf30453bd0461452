"""The streams of a command: whoever reads them may go away, and a disk below them may be full."""

from __future__ import annotations

import errno
import io
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import typer

from simcompare.errors import OutputError

#: errors of the system that mean that a disk takes no more
_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
#: and that there is no terminal any more
_GONE = (errno.EPIPE, errno.EIO)


@contextmanager
def readers_may_leave(exit_code: int = 0, note: str = "") -> Iterator[None]:
    """The reader of a pipe may go away, as in ``simcompare list | head -1``; that is no failure.

    A disk that is full, to which the output goes, is one.

    Args:
        exit_code: with which the command ends where nobody reads any more.
        note: said then on stderr.
    """
    try:
        yield
        sys.stdout.flush()
    except OSError as error:
        if error.errno not in (*_FULL, *_GONE):
            raise
        _forget_stdout()
        fault = f"the output cannot be written ({error.strerror}); free some space"
        told = [fault] if error.errno in _FULL else []
        if told or note:
            typer.echo(f"simcompare: {'; '.join(filter(None, [*told, note]))}", err=True)
        raise typer.Exit(OutputError.exit_code if told else exit_code) from None


def _forget_stdout() -> None:
    """What is not printed yet goes nowhere, or Python would complain when it ends."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


class _Forgiving(io.FileIO):
    """A file that loses what it cannot take: where errors cannot be told, exit codes still hold."""

    def write(self, data: Any) -> int:  # noqa: ANN401
        try:
            return int(super().write(data))
        except OSError:
            return len(data)


def keep() -> None:
    """Streams that can always be written to, also where the caller has closed them."""
    sys.stdout = sys.stdout or Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115
    given = sys.__stderr__
    if given is None:
        sys.stderr = Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115
    elif sys.stderr is given:
        raw = _Forgiving(given.fileno(), "w", closefd=False)
        sys.stderr = io.TextIOWrapper(io.BufferedWriter(raw), given.encoding, line_buffering=True)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # a terminal without the signs for ± and ζ
            stream.reconfigure(errors="replace")
