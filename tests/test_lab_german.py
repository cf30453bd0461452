"""German for what stands elsewhere in English: nothing lacks it, and nothing is stale."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest

from simcompare import lab
from simcompare.engine import by_hand, engines
from simcompare.errors import InputError
from simcompare.hardware.recordings import bounce_table, published
from simcompare.lab import faults
from simcompare.lab.translation import catalogue, translated
from simcompare.lab.work import perform
from simcompare.scenarios import catalogue as scenarios
from simcompare.verbs.show import show

FOLDER = Path(lab.__file__).parent
HOLE = re.compile(r"\{\w*\}")
#: scenarios of which a result leads with each kind of sentence
RAN = {"engines": ["pymunk", "mujoco"], "levels": ["default", "tuned"]}


def shown() -> Iterator[str]:
    """All that the page shows of scenarios and of engines' own values."""
    for name in scenarios.names():
        scene, facts = scenarios.load(name).resolve(), show(name)
        yield from (facts.title, facts.question, next(iter(scene.probes.values())).label)
        yield from (one.text for one in facts.parameters.values())
        yield from (one.text for one in facts.presets.values())
        if scene.answer is not None:
            yield scene.answer.measure.replace("_", " ")
    for path in published.tables().values():
        head = bounce_table.read(path, {"rebound_height": "m", "restitution": "1"}).head
        yield from (head["title"], head["note"])
    for engine in engines.names():
        yield from (one.text for one in by_hand.known(engine))


def said(source: str) -> set[str]:
    """Every text in a source, with holes for what is filled in."""
    tree = ast.parse(source)
    constants = {
        target.id: statement.value.value
        for statement in tree.body
        if isinstance(statement, ast.Assign) and isinstance(statement.value, ast.Constant)
        for target in statement.targets
        if isinstance(target, ast.Name)
    }
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            found.add(HOLE.sub("{}", node.value))
        if isinstance(node, ast.JoinedStr):
            found.add("".join(_part(one, constants) for one in node.values))
    return found


def _part(one: ast.expr, constants: Mapping[str, object]) -> str:
    if isinstance(one, ast.Constant):
        return str(one.value)
    assert isinstance(one, ast.FormattedValue)
    name = one.value.id if isinstance(one.value, ast.Name) else ""
    return str(constants[name]) if isinstance(constants.get(name), str) else "{}"


def test_all_that_is_shown_of_scenarios_and_engines_has_its_german() -> None:
    known = catalogue()["texts"]
    assert [text for text in dict.fromkeys(shown()) if text and text not in known] == []


def test_no_german_is_of_what_nobody_says_any_more() -> None:
    sources = {path.name: said(path.read_text(encoding="utf-8")) for path in FOLDER.glob("*.py")}
    used = {*shown(), *(text for one in sources.values() for text in one)}
    assert [text for text in catalogue()["texts"] if HOLE.sub("{}", text) not in used] == []
    assert [text for text in catalogue()["notes"] if HOLE.sub("{}", text) not in used] == []


def test_german_fills_in_what_the_english_does() -> None:
    for part in catalogue().values():
        for english, german in part.items():
            assert sorted(HOLE.findall(english)) == sorted(HOLE.findall(german)), english
            assert german.strip() == german != ""


def test_notes_are_told_with_their_numbers() -> None:
    note = "Impact 3 at 1.204 s is left out: it is too weak."
    assert translated(note, "de") == "Aufprall 3 bei 1.204 s wird weggelassen: it is too weak."
    assert translated(note, "en") == note
    assert translated("never said anywhere", "de") == "never said anywhere"


@pytest.mark.parametrize(
    ("fault", "german"),
    [
        ("is no sound that is read here; record with the page, or export it as WAV or FLAC",
         "a.wav: ist kein Ton, der hier gelesen wird; nimm mit der Seite auf, oder exportiere ihn"),
        ("has 3 pictures; expected a film of a second or more, in which a ball bounces",
         "a.wav: hat 3 Bilder; erwartet wird ein Film"),
        ("is of no known format; name it: simcompare import", "a.wav: is of no known format"),
    ],
)  # fmt: skip
def test_faults_of_the_lab_are_told_in_german(fault: str, german: str) -> None:
    told = faults.told(InputError("a.wav", [fault]), {"path": "/x/a.wav", "language": "de"})
    assert told[0].startswith(german)
    assert ("Sende einen Ton als WAV" in told[-1]) == ("simcompare" in fault)


@pytest.mark.parametrize(
    ("scenario", "sentence"),
    [
        ("ball", "Wie sie kommen: Stoßzahl 0 statt 0.800 in pymunk und mujoco."),
        ("sliding_block", "Endlage 0.382 bis 0.383 m in pymunk und mujoco, wie es sein soll."),
    ],
)
def test_results_are_told_in_german(scenario: str, sentence: str) -> None:
    found = perform("run", {"scenario": scenario, **RAN, "language": "de"})
    assert sentence in found["sentence"]
    assert found["y_label"].startswith(("Höhe des tiefsten Punkts", "Ort entlang der Ebene"))


def test_scenarios_are_told_in_german() -> None:
    listed = perform("scenarios", {"language": "de"})["scenarios"]
    assert "Springender Ball" in [one["title"] for one in listed]
    ball = perform("scenario", {"name": "ball", "language": "de"})
    assert ball["question"].startswith("Springt der Ball")
    texts = {one["name"]: one["text"] for one in ball["parameters"]}
    assert texts["mass_kg"] == "Masse des Balls."
    own = next(one for one in ball["engines"] if one["name"] == "pymunk")["contact"]
    assert own[1]["text"].startswith("Wie tief Körper")
