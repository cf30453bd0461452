"""Which reader a file of a bag needs."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

from simcompare.errors import InputError
from simcompare.hardware.logs.bags import mcap, ros1, sqlite
from simcompare.hardware.logs.bags.container import Message, State

#: gives all messages of a file in their order there
Reader = Callable[[Path, State], Iterator[Message]]

#: first bytes -> reader
_READERS: dict[bytes, Reader] = {
    ros1.MAGIC: ros1.messages, mcap.MAGIC: mcap.messages, sqlite.MAGIC: sqlite.messages,
}  # fmt: skip


def of_file(path: Path) -> Reader:
    """The reader of a file, by its content.

    Raises:
        InputError: it is no bag.
    """
    with path.open("rb") as file:
        start = file.read(16)
    for magic, reader in _READERS.items():
        if start.startswith(magic):
            return reader
    raise InputError(
        str(path),
        [f"is no bag: begins with {start!r}; expected '#ROSBAG V2.0', MCAP or SQLite (.db3)"],
    )
