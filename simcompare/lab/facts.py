"""What the page must know of a scenario: its parameters, levels, engines and their own values."""

from __future__ import annotations

import dataclasses
from typing import Any

from simcompare import glossary
from simcompare.engine import by_hand, engines
from simcompare.engine.contacts import touching_pairs
from simcompare.errors import SimcompareError
from simcompare.lab import published
from simcompare.model.plain import Plain
from simcompare.model.settings import CONTACT_LEVELS
from simcompare.scenarios import catalogue
from simcompare.scenarios.scenario_file import ScenarioFile
from simcompare.verbs.show import ScenarioFacts, show


def scenarios() -> Plain:
    """Every scenario of the catalogue that can be run, by name."""
    found = []
    for name in catalogue.names():
        scene = catalogue.load(name).resolve()
        found.append({"name": name, "title": scene.title, "question": scene.question})
    return {"scenarios": found}


def scenario(name: str, language: str) -> Plain:
    """All that the page shows of one of them before it is run."""
    shown, file = show(name), catalogue.load(name)
    bounces = _bounces(file)
    return {
        "name": shown.name,
        "title": shown.title,
        "question": shown.question,
        "parameters": [
            {"name": key, **dataclasses.asdict(value)} for key, value in shown.parameters.items()
        ],
        "presets": [
            {"name": key, "text": preset.text, "set": dict(preset.set)}
            for key, preset in shown.presets.items()
        ],
        "levels": [
            {"name": level, "text": glossary.term(level, language).short}
            for level in CONTACT_LEVELS
        ],
        "engines": [_engine(key, shown, bounces=bounces) for key in shown.engines],
        "published": published.of_scenario(file),
        "can_fit": file.fit is not None and file.fit.by == "bounces",
    }


def _bounces(file: ScenarioFile) -> bool:
    """Whether a value of an engine for a bounce does anything in it."""
    return any(contact.restitution > 0 for contact in touching_pairs(file.resolve()))


def _engine(name: str, shown: ScenarioFacts, *, bounces: bool) -> Plain:
    contact = _contact(name) if bounces else []
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


def _contact(name: str) -> list[dict[str, Any]]:
    try:
        return [dataclasses.asdict(one) for one in by_hand.known(name)]
    except SimcompareError:  # its backend is broken, which is told
        return []
