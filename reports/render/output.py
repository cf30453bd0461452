"""Files that are either complete or not there."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

from simcompare.errors import OutputError


def write(path: Path, content: bytes) -> Path:
    """Writes a file beside its place and renames it; makes the folder where there is none.

    Raises:
        OutputError: it cannot be written; nothing half-written is left behind.
    """
    path = path.resolve() if path.is_symlink() else path
    if path.exists() and not path.is_file():
        raise OutputError(f"{path}: is no file, and is left as it is; choose another place")
    # several reports may be written at once, so the name holds the process
    partial = path.with_name(f".{path.name}.{os.getpid()}.partial")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        partial.write_bytes(content)
        partial.replace(path)
    except OSError as error:
        raise OutputError(
            f"{path}: the report cannot be written ({error.strerror or error});"
            " nothing was kept, free some space or choose another place"
        ) from None
    finally:
        with contextlib.suppress(OSError):
            partial.unlink()
    return path
