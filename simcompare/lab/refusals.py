"""What the lab refuses, and its sentences in each language."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from pathlib import Path

from simcompare.glossary import LANGUAGES
from simcompare.model import yaml_file

_TEXTS = Path(__file__).parent / "texts"


class Refused(Exception):
    """A request that is not met.

    Args:
        status: of HTTP.
        key: of the sentence.
        values: that stand in it.
    """

    def __init__(self, status: int, key: str, **values: object) -> None:
        self.status, self.key, self.values = status, key, values
        super().__init__(say("en", key, **values))


class Faulty(Exception):
    """A request that is not met, for reasons that stand in sentences already.

    Args:
        status: of HTTP.
        faults: the sentences.
    """

    def __init__(self, status: int, faults: Sequence[str]) -> None:
        self.status, self.faults = status, [*faults]
        super().__init__("; ".join(faults))


def say(language: str, key: str, **values: object) -> str:
    """A sentence of the server.

    Args:
        language: "en" or "de".
        key: of the sentence.
        values: that stand in it.
    """
    return sentences(language)[key].format(**values)


@functools.cache
def sentences(language: str) -> dict[str, str]:
    """All sentences of the server in one language."""
    return dict(yaml_file.read_yaml(_TEXTS / f"server_{language}.yaml")[0])


def language_of(wish: object, accepted: str) -> str:
    """The language to be spoken.

    Args:
        wish: what was asked for by name.
        accepted: what the browser says, the most wanted first.
    """
    if wish in LANGUAGES:
        return str(wish)
    asked = [part.split(";")[0].strip().lower()[:2] for part in accepted.split(",")]
    return next((one for one in asked if one in LANGUAGES), LANGUAGES[0])
