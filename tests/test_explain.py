"""``simcompare explain``: a word in full, all words, other spellings, other languages."""

import sys

import pytest

import simcompare
from simcompare.errors import InputError
from simcompare.verbs.explain import language_of

SCATTER = """\
scatter: standard deviation of single repeats

Scatter tells how much single repeats differ from each other. Nine drops with
restitutions around 0.797 and a scatter of 0.005 are written 0.797 ± 0.005. Your
own single run may be off by that much. It does not tell how far the mean is
from the truth.

Defined in: JCGM 100:2008, 4.2.2
See also: u, repeat, ±"""


@pytest.fixture(autouse=True)
def _english(monkeypatch):
    for name in ("LC_ALL", "LC_MESSAGES", "LANG"):
        monkeypatch.delenv(name, raising=False)


def test_a_word_is_told_with_its_source_and_its_relatives():
    assert str(simcompare.explain("scatter")) == SCATTER
    assert repr(simcompare.explain("Streuung")) == SCATTER


def test_german_by_option_and_by_environment(monkeypatch):
    german = str(simcompare.explain("scatter", language="de"))
    assert german.startswith("scatter (Streuung): Standardabweichung")
    assert german.endswith("Siehe auch: u, repeat, ±")
    monkeypatch.setenv("LANG", "de_AT.UTF-8")
    assert str(simcompare.explain("scatter")) == german


@pytest.mark.parametrize(
    ("environment", "language"),
    [
        ({}, "en"),
        ({"LANG": "de_DE.UTF-8"}, "de"),
        ({"LANG": "de_DE.UTF-8", "LC_ALL": "C"}, "en"),
        ({"LC_ALL": "", "LC_MESSAGES": "de_CH"}, "de"),
    ],
)
def test_language_of_an_environment(environment, language):
    assert language_of(environment) == language


def test_all_words_have_a_line_in_their_group():
    lines = str(simcompare.explain()).splitlines()
    assert lines[0] == "How much an engine is given:"
    assert "  tuned: the engine alone, with its own settings chosen well" in lines
    assert lines[-1].startswith("More about one of them: simcompare explain WORD")
    assert max(map(len, lines)) <= 80


def test_a_notebook_shows_paragraphs():
    shown = simcompare.explain("E_n")._repr_html_()
    assert shown.startswith("<p><b>E_n</b>: ")
    assert "ISO 13528:2022, 9.7" in shown


def test_names_of_other_things_lead_there():
    with pytest.raises(InputError, match="is a scenario; simcompare show ball"):
        simcompare.explain("ball")
    with pytest.raises(InputError, match="is an engine; simcompare doctor"):
        simcompare.explain("mujoco")
    with pytest.raises(InputError, match="is measured by barometer; simcompare show barometer"):
        simcompare.explain("pressure error")
    with pytest.raises(InputError, match=r"did you mean tuned\?"):
        simcompare.explain("tunned")


@pytest.mark.parametrize("words", [["closed", "form"], ["closed form"]])
def test_two_words_need_no_quotes(words, monkeypatch, capsys):
    from simcompare.cli import main

    monkeypatch.setattr(sys, "argv", ["simcompare", "explain", *words])
    with pytest.raises(SystemExit) as ended:
        main()
    assert not ended.value.code
    assert capsys.readouterr().out.startswith("closed form: the truth from a formula")
