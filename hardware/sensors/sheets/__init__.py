"""Data sheets of sensors, by name; nothing is read here."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from pathlib import Path

_FOLDER = Path(__file__).parent


@functools.cache
def files() -> Mapping[str, Path]:
    """Name -> file of every sheet that ships with simcompare."""
    return {path.stem: path for path in sorted(_FOLDER.glob("*.yaml"))}


def names() -> list[str]:
    """Their names."""
    return list(files())
