"""Every word of the output is explained once, shortly enough for a legend, in both languages."""

import re

import pytest

from simcompare import glossary
from simcompare.comparison.comparison import FAIL, INFO, PASS
from simcompare.engine.helps import HELPS
from simcompare.errors import InputError, UnknownName
from simcompare.model.settings import ASSISTED, COEFFICIENTS, DEFAULT, TUNED
from simcompare.model.trajectory import TRUTH
from simcompare.results.fit_file import FITTED
from simcompare.running.jobs import FAILED, MISSING, UNSUPPORTED

WORDS = [one.word for one in glossary.terms()]


@pytest.mark.parametrize(
    "word",
    [
        *(DEFAULT, COEFFICIENTS, TUNED, ASSISTED, FITTED),
        *(PASS, FAIL, INFO, "–"),
        *(UNSUPPORTED, MISSING, FAILED, TRUTH),
        *HELPS,
    ],
)
def test_what_stands_in_tables_is_explained(word):
    assert glossary.term(word).word == word


@pytest.mark.parametrize("language", glossary.LANGUAGES)
def test_an_explanation_is_short_and_has_an_example(language):
    for one in glossary.terms(language):
        assert len(one.short) <= 70, one.word
        assert not one.short.endswith("."), one.word
        sentences = re.split(r"[.?:] (?=[A-ZÄÖÜ–])", one.text)
        assert 2 <= len(sentences) <= 6, (one.word, sentences)
        assert re.search(r"\d|xample|Beispiel|such as|etwa", one.text), one.word


def test_both_languages_have_the_same_words_and_other_texts():
    for english, german in zip(glossary.terms("en"), glossary.terms("de"), strict=True):
        assert english.word == german.word
        assert english.text != german.text
        assert english.short != german.short or not re.search("[a-z]", english.short)


def test_related_words_exist():
    related = {word for one in glossary.terms() for word in one.see}
    assert related <= set(WORDS)


def test_no_spelling_belongs_to_two_words():
    seen: dict[str, str] = {}
    for one in glossary.terms():
        for spelling in one.also:
            assert seen.setdefault(spelling, one.word) == one.word
            assert spelling not in WORDS, spelling


@pytest.mark.parametrize(
    ("spelling", "word"),
    [
        ("En", "E_n"), ("e_n", "E_n"), ("E-n", "E_n"), ("|E_n|", "E_n"),
        ("ζ", "zeta"), ("Zeta", "zeta"), ("uncertainty", "u"), ("Streuung", "scatter"),
        ("u", "u"), ("U", "U"), ("Stoßzahl", "restitution"), ("TUNED", "tuned"), ("-", "–"),
        ("loss", "amplitude loss"), ("amplitude_loss", "amplitude loss"),
        ("mean_period", "mean period"), ("cutoff", "cutoff frequency"),
        ("before the fit", "known before"), ("largest gap", "sim2real gap"),
        ("values that agree", "E_n"), ("end_drift", "end drift"), ("Stufe", "level"),
        ("half-step start", "half_step_start"), ("95%", "95 %"), ("Value ± 95 %", "± 95 %"),
        ("beyond the uncertainty", "within the uncertainty"),
    ],
)  # fmt: skip
def test_other_spellings_are_understood(spelling, word):
    assert glossary.term(spelling).word == word


@pytest.mark.parametrize(
    ("unknown", "advice"),
    [
        ("tolerence", "did you mean tolerance?"),
        ("tunned", "did you mean tuned?"),
        ("Stoszahl", "did you mean restitution?"),
        ("lever", "did you mean level?"),
        ("spining", "all words: simcompare explain"),
        ("xyzzy", "all words: simcompare explain"),
    ],
)
def test_unknown_words_get_near_suggestions_as_tables_have_them(unknown, advice):
    for language in glossary.LANGUAGES:
        with pytest.raises(InputError) as refused:
            glossary.term(unknown, language)
        assert str(refused.value) == f"explain: no word is called {unknown!r}; {advice}"


def test_an_unknown_language_is_refused():
    with pytest.raises(UnknownName, match="language"):
        glossary.term("u", "fr")


def test_a_legend_has_a_line_for_each_word_once():
    assert glossary.legend(["brackets", "–", "-"]) == (
        "brackets: 0.7969(48) means 0.7969 ± 0.0048",
        "–: could not be measured",
    )
