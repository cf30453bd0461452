"""Writing a text where the user wants it."""

from __future__ import annotations

from pathlib import Path


def text_file(out: Path, name: str, text: str, mark: str) -> Path:
    """Writes a text and returns its place.

    Args:
        out: the file, or a folder in which it gets its name.
        name: that name.
        text: what is written.
        mark: what each of our files of this kind holds; a file without it is not replaced.

    Raises:
        OutputError: a file of others is there, or it cannot be written.
    """
    from simcompare.reports.render import output

    path = out / name if out.is_dir() else out
    return output.write(path, text.encode("utf-8"), mark.encode("utf-8"))
