"""The containers of ROS messages, read from the front to the end without their index.

An index is missing or broken just where a recorder was stopped hard, and that of a long ROS 1 bag
needs more memory than its messages. So whole records are taken one after the other; what is broken
is named with its byte. The packages rosbags and mcap refuse such a bag or lose its last chunk. To
use them for whole bags would be a second way beside this one, and a slower one: 110 000 messages of
an IMU in an MCAP file take 0.09 s here, 0.16 s with rosbags and 0.32 s with mcap.
"""

from __future__ import annotations

import bz2
from dataclasses import dataclass, field
from typing import Any, BinaryIO

#: a chunk may become so much larger, or at least this large, when it is unpacked
MAX_RATIO, MIN_LIMIT = 256, 1 << 25

#: a message: its connection, when it was received [ns], its bytes
Message = tuple["Connection", int, bytes]


@dataclass(frozen=True)
class Connection:
    """Where messages come from.

    Attributes:
        topic: as the bag has it.
        kind: type of the messages ("sensor_msgs/msg/Imu").
        encoding: how they are packed: "ros1", "cdr" or another.
        schema: definition of the type as text, empty where the bag does not hold it.
        language: of the schema: "msg", "idl" or another.
        publisher: who sent them, where the bag says.
    """

    topic: str
    kind: str
    encoding: str
    schema: str = ""
    language: str = ""
    publisher: str = ""


@dataclass
class State:
    """What became known of a bag while it was read.

    Attributes:
        connections: all that the bag names, also those without messages.
        truncated: what is missing at the end, empty where the bag is whole.
        damaged: what had to be passed over before the end.
        expected: topic -> number of messages that the bag says it holds.
        joints: joint -> kind, where the bag holds a description of the robot.
        about: what the bag says of itself.
    """

    connections: dict[Connection, None] = field(default_factory=dict)
    truncated: str = ""
    damaged: list[str] = field(default_factory=list)
    expected: dict[str, int] = field(default_factory=dict)
    joints: dict[str, str] = field(default_factory=dict)
    about: dict[str, str] = field(default_factory=dict)


class Cut(Exception):
    """A record that is not whole."""


class Source:
    """A file or a chunk of which whole pieces are taken.

    Args:
        file: opened for reading.
        size: its length in bytes.
        start: byte of the bag at which it begins.
    """

    def __init__(self, file: BinaryIO, size: int, start: int = 0) -> None:
        self._file, self._size, self._start = file, size, start
        self.at = 0

    @property
    def rest(self) -> int:
        """Bytes that were not taken yet."""
        return self._size - self.at

    @property
    def place(self) -> str:
        """Where it stands, in words."""
        return f"byte {self._start + self.at}"

    def skip(self, at: int) -> None:
        """Goes on at another byte."""
        self._file.seek(at)
        self.at = at

    def take(self, count: int, what: str) -> bytes:
        """The next bytes.

        Raises:
            Cut: there are not so many.
        """
        if count > self.rest:
            raise Cut(f"{what} at {self.place} should have {count} bytes; {self.rest} are there")
        self.at += count
        return self._file.read(count)


def unpack(kind: str, data: bytes, size: int) -> bytes:
    """A chunk as it was before it was compressed.

    Raises:
        Cut: it is damaged, of another length, or of an unknown kind.
    """
    if size > max(MIN_LIMIT, MAX_RATIO * len(data)):
        raise Cut(f"says that it unpacks from {len(data)} to {size} bytes, which is not plausible")
    try:
        if kind in ("", "none"):
            unpacked = data
        elif kind == "bz2":
            unpacked = bz2.BZ2Decompressor().decompress(data, size + 1)
        elif kind == "lz4":
            import lz4.frame  # type: ignore[import-untyped]

            unpacked = lz4.frame.LZ4FrameDecompressor().decompress(data, size + 1)
        elif kind == "zstd":
            unpacked = _zstd(data, size + 1)
        else:
            raise Cut(f"is compressed with {kind[:20]!r}; known: bz2, lz4, zstd")
    except (OSError, EOFError, RuntimeError, ValueError) as error:
        raise Cut(f"cannot be unpacked ({kind}: {error})") from None
    if len(unpacked) != size:
        raise Cut(f"unpacks to {len(unpacked)} bytes; {size} were expected")
    return unpacked


def _zstd(data: bytes, most: int) -> bytes:
    zstd = zstandard()
    try:
        return bytes(zstd.ZstdDecompressor().decompress(data, max_length=most))
    except zstd.ZstdError as error:
        raise Cut(f"cannot be unpacked (zstd: {error})") from None


def zstandard() -> Any:  # noqa: ANN401  (a module)
    """The zstd module of Python, or what stands in for it before Python 3.14."""
    try:
        from compression import zstd  # type: ignore[import-not-found]
    except ModuleNotFoundError:
        from backports import zstd
    return zstd
