"""German for texts that stand elsewhere in English; what has none stays as it is."""

from __future__ import annotations

import functools
import re
from collections.abc import Iterable
from pathlib import Path

from simcompare.model import yaml_file

#: the language that has a catalogue
GERMAN = "de"
_CATALOGUE = Path(__file__).parent / "texts" / "german.yaml"
_HOLE = re.compile(r"\\\{(\w+)\\\}")


def translated(text: str, language: str) -> str:
    """A text in a language; also a note with numbers in it.

    Args:
        text: in English.
        language: "de"; any other leaves it as it is.
    """
    if language != GERMAN:
        return text
    if text in catalogue()["texts"]:
        return catalogue()["texts"][text]
    for pattern, german in _notes():
        if found := pattern.fullmatch(text):
            parts = {name: translated(one, language) for name, one in found.groupdict().items()}
            return german.format(**parts)
    return text


def each(some: Iterable[str], language: str) -> list[str]:
    """Several texts in a language."""
    return [translated(one, language) for one in some]


def filled(template: str, language: str, **values: object) -> str:
    """A template in a language, with values in it."""
    known = catalogue()["texts"] if language == GERMAN else {}
    return known.get(template, template).format(**values)


@functools.cache
def catalogue() -> dict[str, dict[str, str]]:
    """Texts and notes, each English -> German."""
    return dict(yaml_file.read_yaml(_CATALOGUE)[0])


@functools.cache
def _notes() -> list[tuple[re.Pattern[str], str]]:
    """How notes look that are made elsewhere, and what they are in German."""
    return [
        (re.compile(_HOLE.sub(r"(?P<\1>.+?)", re.escape(key)), re.DOTALL), german)
        for key, german in catalogue()["notes"].items()
    ]
