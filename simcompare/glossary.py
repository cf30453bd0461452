"""The words of tables, legends and reports, explained once, in English and German."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import yaml

from simcompare.errors import InputError, UnknownName

#: languages in which every word is explained
LANGUAGES = ("en", "de")
#: how much alike a spelling must be for its word to be suggested, and how many are
_ALIKE, _MOST = 0.75, 3


@dataclass(frozen=True)
class Term:
    """A word with its explanation.

    Attributes:
        word: as it stands in tables, the same in all languages.
        name: what it is called in this language.
        group: what it is about.
        short: one line for legends.
        text: a few sentences with an example.
        source: the standard or article in which it is defined; empty where there is none.
        see: related words.
        also: other spellings that are understood.
    """

    word: str
    name: str
    group: str
    short: str
    text: str
    source: str = ""
    see: tuple[str, ...] = ()
    also: tuple[str, ...] = ()


def terms(language: str = "en") -> tuple[Term, ...]:
    """All words in the order of the file.

    Raises:
        UnknownName: no such language.
    """
    if language not in LANGUAGES:
        raise UnknownName("language", language, LANGUAGES)
    return _read()[language]


def term(word: str, language: str = "en") -> Term:
    """The explanation of a word.

    Args:
        word: as it stands in a table, or another spelling of it.
        language: ``en`` or ``de``.

    Raises:
        UnknownName: no such language.
        InputError: no such word; says which are spelt alike.
    """
    known = _spellings(language)
    for spelling in (word.strip(), _plain(word)):
        if spelling in known:
            return known[spelling]
    near = difflib.get_close_matches(_plain(word), known, n=_MOST, cutoff=_ALIKE)
    # the words as they stand in tables: another spelling may be of the other language
    meant = " or ".join(dict.fromkeys(known[spelling].word for spelling in near))
    advice = f"did you mean {meant}?" if meant else "all words: simcompare explain"
    raise InputError("explain", [f"no word is called {word!r}; {advice}"])


def legend(words: Iterable[str], language: str = "en") -> tuple[str, ...]:
    """One line for each word, to stand under a table; the same word stands there once."""
    found = dict.fromkeys(term(word, language) for word in words)
    return tuple(f"{one.word}: {one.short}" for one in found)


def _plain(spelling: str) -> str:
    """A spelling without what does not distinguish it: capitals, underscores, hyphens."""
    spaced = spelling.strip().replace("_", " ")
    return (spaced.replace("-", " ") if len(spaced) > 1 else spaced).casefold()


@cache
def _spellings(language: str) -> Mapping[str, Term]:
    """Term by every spelling; words themselves come before other spellings of others."""
    every = terms(language)
    plain = {_plain(name): one for one in reversed(every) for name in one.also}
    # u and U are two words: what is written exactly so goes first
    return plain | {_plain(one.word): one for one in reversed(every)} | {e.word: e for e in every}


@cache
def _read() -> Mapping[str, tuple[Term, ...]]:
    text = Path(__file__).with_suffix(".yaml").read_text(encoding="utf-8")
    # the safe loader written in C, five times as fast, where there is one
    groups = yaml.load(text, getattr(yaml, "CSafeLoader", yaml.SafeLoader))  # noqa: S506
    return {
        language: tuple(
            _term(word, entry, group["group"][language], language)
            for group in groups
            for word, entry in group["words"].items()
        )
        for language in LANGUAGES
    }


def _term(word: str, entry: Mapping[str, Any], group: str, language: str) -> Term:
    """A word as the file has it."""
    own = entry[language]
    return Term(
        word=word,
        name=own.get("word", word),
        group=group,
        short=own["short"],
        text=own["text"],
        source=entry.get("source", ""),
        see=tuple(entry.get("see", ())),
        also=tuple(map(str, entry.get("also", ()))),
    )
