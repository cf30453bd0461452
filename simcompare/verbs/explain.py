"""The verb ``explain``: what a word of the output means."""

from __future__ import annotations

import html
import os
import textwrap
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import groupby

from simcompare import glossary
from simcompare.arguments import checked
from simcompare.engine import engines
from simcompare.errors import InputError
from simcompare.glossary import Term
from simcompare.scenarios import catalogue

#: letters on a line where nobody says how many there are
_WIDTH = 80
#: what stands before the source, before related words, and below all words
_DEFINED = {"en": "Defined in", "de": "Definiert in"}
_SEE = {"en": "See also", "de": "Siehe auch"}
_MORE = {
    "en": "More about one of them: simcompare explain WORD (auf Deutsch: --language de)",
    "de": "Mehr zu einem davon: simcompare explain WORT (in English: --language en)",
}
#: variables that name the language of a user, the first that is set counts
_VARIABLES = ("LC_ALL", "LC_MESSAGES", "LANG")


@dataclass(frozen=True, repr=False)
class Explanation:
    """One word in full, or all words with a line each; shown as text, or in a notebook.

    Attributes:
        terms: the words.
        language: in which they are explained.
    """

    terms: tuple[Term, ...]
    language: str

    def lines(self, width: int = _WIDTH) -> Iterator[str]:
        """The text in lines of at most so many letters."""
        if len(self.terms) == 1:
            yield from self._one(self.terms[0], width)
        else:
            yield from self._all(width)

    def _one(self, term: Term, width: int) -> Iterator[str]:
        yield from textwrap.wrap(_line(term), width, subsequent_indent="  ")
        yield ""
        yield from textwrap.wrap(term.text, width, break_long_words=False, break_on_hyphens=False)
        yield ""
        yield from (f"{what}: {words}" for what, words in self._more(term))

    def _more(self, term: Term) -> Iterator[tuple[str, str]]:
        if term.source:
            yield _DEFINED[self.language], term.source
        if term.see:
            yield _SEE[self.language], ", ".join(term.see)

    def _all(self, width: int) -> Iterator[str]:
        for group, terms in groupby(self.terms, lambda term: term.group):
            yield f"{group}:"
            for term in terms:
                yield from textwrap.wrap(
                    _line(term), width, initial_indent="  ", subsequent_indent="    "
                )
        yield _MORE[self.language]

    def __str__(self) -> str:
        return "\n".join(self.lines())

    def __repr__(self) -> str:
        return str(self)

    def _repr_html_(self) -> str:
        """What a notebook shows."""
        return "".join(self._paragraphs())

    def _paragraphs(self) -> Iterator[str]:
        alone = len(self.terms) == 1
        for term in self.terms:
            yield f"<p><b>{html.escape(_titled(term))}</b>: {html.escape(term.short)}</p>"
            if alone:
                yield f"<p>{html.escape(term.text)}</p>"
                yield from (f"<p>{html.escape(f'{w}: {t}')}</p>" for w, t in self._more(term))


@checked
def explain(word: str | None = None, *, language: str | None = None) -> Explanation:
    """What a word of a table, a legend or a report means.

    ::

        simcompare.explain("tuned")
        simcompare.explain("E_n", language="de")
        simcompare.explain()  # all words

    Args:
        word: such as ``"E_n"`` or ``"tuned"``; all words, a line each, where it is left out.
        language: ``"en"`` or ``"de"``; that of the environment where it is left out.

    Returns:
        The explanation; it prints as text, and a notebook shows it.

    Raises:
        UnknownName: no such language.
        InputError: no such word; says which are spelt alike, or what else is called so.
    """
    chosen = language or language_of(os.environ)
    if word is None:
        return Explanation(glossary.terms(chosen), chosen)
    try:
        return Explanation((glossary.term(word, chosen),), chosen)
    except InputError:
        _refuse_names(word.strip())
        raise


def language_of(environment: Mapping[str, str]) -> str:
    """The language of a user: German where the environment says so, else English."""
    named = next((text for name in _VARIABLES if (text := environment.get(name))), "")
    return "de" if named.startswith("de") else "en"


def _refuse_names(word: str) -> None:
    """Names of scenarios, engines and what single scenarios measure are told elsewhere."""
    if word in catalogue.names():
        raise InputError("explain", [f"{word!r} is a scenario; simcompare show {word}"])
    if word in engines.names():
        raise InputError("explain", [f"{word!r} is an engine; simcompare doctor"])
    measure = word.replace(" ", "_").replace("-", "_").lower()
    for name in catalogue.names():
        if measure in catalogue.load(name).resolve().tolerances:
            raise InputError("explain", [f"{word!r} is measured by {name}; simcompare show {name}"])


def _titled(term: Term) -> str:
    """The word, and what it is called in this language."""
    return term.word if term.name == term.word else f"{term.word} ({term.name})"


def _line(term: Term) -> str:
    return f"{_titled(term)}: {term.short}"
