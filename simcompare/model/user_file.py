"""Files of users that are read whole: neither endless nor larger than such a file can be."""

from __future__ import annotations

import stat
from pathlib import Path

from simcompare.errors import InputError, NoSuchFile

_SPECIAL = (
    (stat.S_ISFIFO, "a named pipe"), (stat.S_ISSOCK, "a socket"),
    (stat.S_ISCHR, "a device"), (stat.S_ISBLK, "a device"),
)  # fmt: skip
_MB = 1_000_000


def check_is_stored(path: Path) -> None:
    """Refuses what is no file and may give bytes without end, or none for ever.

    Raises:
        InputError: it is a pipe, a socket or a device.
    """
    try:
        mode = path.stat().st_mode
    except (OSError, ValueError):
        return  # whoever reads it says what is wrong
    for is_so, name in _SPECIAL:
        if is_so(mode):
            raise InputError(
                str(path), [f"is {name}; expected a file: write what comes from it into one"]
            )


def content(path: Path, most_mb: float, expected: str) -> bytes:
    """All bytes of a file.

    Args:
        path: the file.
        most_mb: how large it may be.
        expected: what it should be, such as "a YAML file".

    Raises:
        InputError: there is none, it cannot be read, or it is too large.
    """
    check_is_stored(path)
    try:
        with path.open("rb") as file:
            found = file.read(int(most_mb * _MB) + 1)
    except FileNotFoundError:
        raise NoSuchFile(path) from None
    except IsADirectoryError:
        raise InputError(str(path), [f"is a folder; expected {expected}"]) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(str(path), [f"cannot be read: {reason}"]) from None
    if len(found) > most_mb * _MB:
        fault = f"has more than {most_mb:g} MB, which {expected} never needs; is it another file?"
        raise InputError(str(path), [fault])
    return found
