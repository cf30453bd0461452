"""The streams of a command: whoever reads them may go away, and a disk below them may be full.

Names come from files, messages from engines: what a terminal would obey, or what would hide or turn
text, is printed escaped.
"""

from __future__ import annotations

import errno
import io
import json
import os
import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TextIO

import typer

from simcompare.errors import OutputError

#: errors of the system that mean that a disk takes no more
_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
#: characters that steer a terminal, turn the direction of text or are not seen; lines and tabs stay
_HIDDEN = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\xad\u061c\u180e\u200b-\u200f\u2028-\u202e\u2060-\u206f"
    "\ufeff\ufff9-\ufffb\U000e0000-\U000e007f]"
)
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
        if isinstance(sys.stdout, _Nowhere) and note:
            typer.echo(f"simcompare: {note}", err=True)
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


def escaped(text: str) -> str:
    """Text in which nothing is hidden; an escape stands for the same in JSON and in Python."""
    return _HIDDEN.sub(_escape, text)


def _escape(found: re.Match[str]) -> str:
    code = ord(found[0])
    if code < ord(" "):  # in JSON these are escaped already
        return f"\\x{code:02x}"
    return f"\\u{code:04x}" if code <= 0xFFFF else json.dumps(found[0])[1:-1]


class _Escaping(io.TextIOWrapper):
    """Where text goes to a terminal, a pipe or a file."""

    def write(self, text: str) -> int:
        super().write(escaped(text))
        return len(text)

    def steer(self, text: str) -> int:
        """Writes text as it is."""
        return super().write(text)


class Steering:
    """A stream for what we draw ourselves, such as a bar of progress.

    Args:
        stream: where it goes.
    """

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self.write = getattr(stream, "steer", stream.write)

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401
        return getattr(self._stream, name)


class _Nowhere(io.TextIOWrapper):
    """Where text goes that the caller has closed the output for."""

    def __init__(self) -> None:
        super().__init__(Path(os.devnull).open("wb"), "utf-8")  # noqa: SIM115


class _Forgiving(io.FileIO):
    """A file that loses what it cannot take: where errors cannot be told, exit codes still hold."""

    def write(self, data: Any) -> int:  # noqa: ANN401
        try:
            return int(super().write(data))
        except OSError:
            return len(data)


def keep() -> None:
    """Streams that can always be written to, also where the caller has closed them."""
    sys.stdout = sys.stdout or _Nowhere()
    given = sys.__stderr__
    if given is None:
        sys.stderr = _Nowhere()
    elif sys.stderr is given:
        raw = _Forgiving(given.fileno(), "w", closefd=False)
        sys.stderr = _Escaping(
            io.BufferedWriter(raw), given.encoding, "replace", line_buffering=True
        )
    own = sys.stdout
    if own is sys.__stdout__ and isinstance(own, io.TextIOWrapper):
        # a terminal may have no signs for ± and ζ
        sys.stdout = _Escaping(
            own.buffer,
            own.encoding,
            "replace",
            line_buffering=own.line_buffering,
            write_through=own.write_through,
        )
