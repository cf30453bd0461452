"""Writing a text where the user wants it."""

from __future__ import annotations

from pathlib import Path

from simcompare.errors import OutputError


def text_file(out: Path, name: str, text: str) -> Path:
    """Writes a text and returns its place.

    Args:
        out: the file, or a folder in which it gets its name.
        name: that name.
        text: what is written.

    Raises:
        OutputError: it cannot be written.
    """
    path = out / name if out.is_dir() else out
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise OutputError(
            f"--out {path}: cannot be written ({error.strerror or error}); choose another place"
        ) from None
    return path
