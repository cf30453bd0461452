"""The worked examples by their names: each file in ``examples/`` is one."""

from __future__ import annotations

import importlib
from pathlib import Path

from simcompare.gauging.example import Example

_FOLDER = Path(__file__).parent / "examples"


def names() -> list[str]:
    """Names of all examples; only a folder is looked at."""
    return sorted(path.stem for path in _FOLDER.glob("[!_]*.py"))


def load(name: str) -> Example:
    """The example of a name that exists."""
    module = importlib.import_module(f"simcompare.gauging.examples.{name}")
    example: Example = module.EXAMPLE
    return example
