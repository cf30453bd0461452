"""What may go wrong where a member of a zip archive is unpacked."""

from __future__ import annotations

import struct
import zipfile
import zlib

try:
    from lzma import LZMAError
except ModuleNotFoundError:  # a Python that was built without it cannot unpack such members
    LZMAError = zlib.error  # type: ignore[misc,assignment]

#: a member that is cut, damaged, encrypted, of an unknown method, or placed outside the file
ERRORS = (
    zipfile.BadZipFile, zlib.error, LZMAError, struct.error, EOFError, OSError, RuntimeError,
    NotImplementedError, UnicodeDecodeError,
)  # fmt: skip

#: a member may become so much larger, or at least this large, where it is unpacked as a whole
MAX_RATIO, MIN_LIMIT = 10, 1 << 24


def member(archive: zipfile.ZipFile, name: str, size: int) -> bytes:
    """A member as a whole.

    Args:
        archive: an open archive.
        name: of the member.
        size: of the archive in bytes.

    Raises:
        ValueError: it is too large to be kept in memory.
        KeyError: there is none.
    """
    length = archive.getinfo(name).file_size
    if length > max(MIN_LIMIT, MAX_RATIO * size):
        raise ValueError(f"{name} unpacks to {length} bytes, which is not plausible")
    return archive.read(name)
