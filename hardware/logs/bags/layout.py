"""Where the numbers of a ROS message stand among its bytes.

Messages of a topic that have equal length, equal texts and equal lengths of arrays have their
numbers at equal places. A layout is worked out once for such messages; then all of them are read
at once, as columns of a table of bytes. The package rosbags would make Python code of a definition
in the bag, which may hold anything, and an object of every message: that alone takes three times
as long.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from simcompare.model.trajectory import Array

#: longest array that becomes columns, and most points of a cloud
MAX_COLUMNS = 256


class Misfit(Exception):
    """A message does not have the form that its definition says."""


class TooMuch(Exception):
    """A topic holds more than can become columns."""


@dataclass(frozen=True)
class Number:
    """A number of a message, and what is known of it.

    Attributes:
        name: path of its field ("twist.twist.linear.x").
        at: byte in the message.
        dtype: numpy's type, with the order of the bytes.
        unit: of the field, empty where the type does not say.
        child: whether it is given in ``child_frame_id``.
        infinite: whether ±infinity means "out of range".
        of: for a variance: columns that it belongs to (their common beginning), else empty.
        split: "time" or "duration" where seconds stand here and nanoseconds four bytes further.
    """

    name: str
    at: int
    dtype: str
    unit: str = ""
    child: bool = False
    infinite: bool = False
    of: str = ""
    split: str = ""


@dataclass
class Layout:
    """Places of all numbers of messages that look alike.

    Attributes:
        numbers: what becomes columns, variances included.
        texts: path -> text that all these messages hold.
        stamp: byte of ``header.stamp``, -1 where there is none.
        skipped: path -> why a field is left out.
        guards: bytes that must be the same in all messages of this layout.
        off_diagonal: covariance -> bytes that are zero where it is diagonal.
        positions: every byte of the guards.
        expected: what stands there.
        order: of the bytes, as numpy writes it.
    """

    numbers: list[Number] = field(default_factory=list)
    texts: dict[str, str] = field(default_factory=dict)
    stamp: int = -1
    skipped: dict[str, str] = field(default_factory=dict)
    guards: list[tuple[int, int]] = field(default_factory=list)
    off_diagonal: dict[str, NDArray[np.int64]] = field(default_factory=dict)
    positions: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, np.int64))
    expected: NDArray[np.uint8] = field(default_factory=lambda: np.empty(0, np.uint8))
    order: str = "<"

    def fits(self, table: NDArray[np.uint8]) -> NDArray[np.bool_]:
        """Which rows of a table of messages have this layout."""
        return np.asarray((table[:, self.positions] == self.expected).all(axis=1))

    def seal(self, data: bytes) -> None:
        """Remembers the bytes that all messages of the layout share."""
        spans = [np.arange(start, stop) for start, stop in self.guards]
        self.positions = np.concatenate([np.empty(0, np.int64), *spans]).astype(np.int64)
        self.expected = np.frombuffer(data, np.uint8)[self.positions]


def pick(table: NDArray[np.uint8], at: int, dtype: str) -> Array:
    """One number of every row of a table of messages."""
    size = np.dtype(dtype).itemsize
    return np.ascontiguousarray(table[:, at : at + size]).view(dtype)[:, 0]
