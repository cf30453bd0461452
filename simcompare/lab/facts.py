"""What the page must know of a scenario: its parameters, levels, engines and their own values."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable
from typing import Any

from simcompare import glossary
from simcompare.engine import by_hand, engines
from simcompare.engine.contacts import bouncing_pairs
from simcompare.errors import SimcompareError
from simcompare.lab import published
from simcompare.lab.translation import translated
from simcompare.model.plain import Plain
from simcompare.model.settings import CONTACT_LEVELS
from simcompare.scenarios import catalogue
from simcompare.scenarios.scenario_file import ScenarioFile
from simcompare.verbs.show import ScenarioFacts, show


def scenarios(language: str) -> Plain:
    """Every scenario of the catalogue that can be run, by name."""
    of = functools.partial(translated, language=language)
    found = []
    for name in catalogue.names():
        scene = catalogue.load(name).resolve()
        found.append({"name": name, "title": of(scene.title), "question": of(scene.question)})
    return {"scenarios": found}


def scenario(name: str, language: str) -> Plain:
    """All that the page shows of one of them before it is run."""
    shown, file = show(name), catalogue.load(name)
    bounces, of = _bounces(file), functools.partial(translated, language=language)
    return {
        "name": shown.name,
        "title": of(shown.title),
        "question": of(shown.question),
        "parameters": [
            {"name": key, **dataclasses.asdict(value), "text": of(value.text)}
            for key, value in shown.parameters.items()
        ],
        "presets": [
            {"name": key, "text": of(preset.text), "set": dict(preset.set)}
            for key, preset in shown.presets.items()
        ],
        "levels": [
            {"name": level, "text": glossary.term(level, language).short}
            for level in CONTACT_LEVELS
        ],
        "engines": [_engine(key, shown, of, bounces=bounces) for key in shown.engines],
        "published": published.of_scenario(file, language),
        "can_fit": file.fit is not None and file.fit.by == "bounces",
    }


def _bounces(file: ScenarioFile) -> bool:
    """Whether a value of an engine for a bounce does anything in it."""
    return bool(bouncing_pairs(file.resolve()))


def _engine(name: str, shown: ScenarioFacts, of: Callable[[str], str], *, bounces: bool) -> Plain:
    contact = _contact(name, of) if bounces else []
    found: Plain = {"name": name, "contact": contact, "script": has_script(name)}
    lacking = shown.engines[name] or _not_there(name)
    return {**found, "missing": "; ".join(lacking)} if lacking else found


def has_script(name: str) -> bool:
    """Whether an engine can be written as a program of its own."""
    method = getattr(engines.get(name), "script", None)
    return method is not None and method() is not None


def _not_there(name: str) -> list[str]:
    try:
        engines.get(name).version()
    except SimcompareError as error:
        return [str(error)]
    return []


def _contact(name: str, of: Callable[[str], str]) -> list[dict[str, Any]]:
    try:
        return [{**dataclasses.asdict(one), "text": of(one.text)} for one in by_hand.known(name)]
    except SimcompareError:  # its backend is broken, which is told
        return []
