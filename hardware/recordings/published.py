"""Published tables of measured bounces that ship with simcompare, by name; nothing is read here."""

from __future__ import annotations

from pathlib import Path

_FOLDER = Path(__file__).parent


def tables() -> dict[str, Path]:
    """Name -> file."""
    return {path.stem: path for path in sorted(_FOLDER.glob("*.csv"))}
