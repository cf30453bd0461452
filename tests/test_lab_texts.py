"""The texts of the lab's page: in each language the same, and none that nobody says."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

from simcompare import lab
from simcompare.scenarios import catalogue

FOLDER = Path(lab.__file__).parent
LANGUAGES = ("en", "de")
#: keys of which a part is put together by the page
MADE = re.compile(r"words\(`(\w+\.\w*)\$\{")
#: words of parameters, which stand in scenarios
QUANTITIES = "quantities"


def _texts(language: str) -> dict[str, dict[str, str]]:
    text = (FOLDER / "texts" / f"{language}.yaml").read_text(encoding="utf-8")
    found: dict[str, dict[str, str]] = yaml.safe_load(text)
    return found


def _flat(texts: dict[str, Any]) -> dict[str, str]:
    return {
        f"{section}.{key}": text for section, all_ in texts.items() for key, text in all_.items()
    }


def _sources() -> Iterator[str]:
    for path in sorted((FOLDER / "static").glob("*.js")):
        yield path.read_text(encoding="utf-8")
    yield (FOLDER / "pages" / "index.html").read_text(encoding="utf-8")


def test_both_languages_say_the_same_things() -> None:
    english, german = (_flat(_texts(language)) for language in LANGUAGES)
    assert list(english) == list(german)
    holes = re.compile(r"\{\w+\}")
    for key, text in english.items():
        assert sorted(holes.findall(text)) == sorted(holes.findall(german[key])), key


@pytest.mark.parametrize("language", LANGUAGES)
def test_no_text_is_empty_or_no_text(language: str) -> None:
    """YAML takes no, on and 1 for other things than words."""
    assert not [key for key, text in _flat(_texts(language)).items() if not str(text).strip()]
    assert all(isinstance(text, str) for text in _flat(_texts(language)).values())


def test_every_text_is_said_and_every_said_text_is_there() -> None:
    source = "\n".join(_sources())
    keys = {key for key in _flat(_texts("en")) if not key.startswith(f"{QUANTITIES}.")}
    said = {*re.findall(r"texts\.(\w+\.\w+)", source), *re.findall(r'"(\w+\.\w+)"', source)}
    made = tuple(MADE.findall(source))
    assert {key for key in keys - said if not key.startswith(made)} == set()
    assert _asked(source) - keys == set()


def _asked(source: str) -> set[str]:
    """Keys that are asked for as they stand."""
    return set(re.findall(r'words\("(\w+\.\w+)"', source)) | set(
        re.findall(r"texts\.(?!quantities)(\w+\.\w+) ", source)
    )


def test_words_of_parameters_belong_to_parameters() -> None:
    names = " ".join(name for one in catalogue.names() for name in catalogue.load(one).parameters)
    assert [key for key in _texts("de")[QUANTITIES] if key not in names] == []


def test_no_page_names_a_foreign_address() -> None:
    """The page works without a network."""
    foreign = re.compile(r"""(?:https?:)?//[a-z0-9-]+\.[a-z]""")
    assert [found for source in _sources() for found in foreign.findall(source)] == []
