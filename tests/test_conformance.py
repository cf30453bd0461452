"""Every scenario on every engine conforms to the contract that other people's backends have too."""

import functools
import re
from pathlib import Path

import pytest

from simcompare.backends import conformance, conformance_physics
from simcompare.backends.conformance_physics import Status
from simcompare.backends.conformance_run import MAX_STEPS as MAX_STEPS_BY_HAND
from simcompare.backends.conformance_run import with_world
from simcompare.engine import engines
from simcompare.engine.features import Feature, needs
from simcompare.errors import Unsupported
from simcompare.model.settings import CONTACT_LEVELS, Settings
from simcompare.scenarios import catalogue
from tests.present import need

ENGINES = engines.names()
SCENARIOS = catalogue.names()


#: most recorded steps of a run here, twice those that are taken by hand
MAX_STEPS = 2 * MAX_STEPS_BY_HAND


@functools.cache
def scenario_of(name):
    """A scenario, cut short where it is long: the contract is the same in every second of it."""
    scenario = catalogue.load(name).resolve()
    longest_s = MAX_STEPS * scenario.world.step_s
    return with_world(scenario, duration_s=min(scenario.world.duration_s, longest_s))


@pytest.mark.parametrize("contact", CONTACT_LEVELS)
@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("name", SCENARIOS)
def test_backend_conforms(name, engine, contact):
    backend, scenario = engines.get(engine), scenario_of(name)
    if needs(scenario).required - backend.features:
        with pytest.raises(Unsupported, match="has no"):
            backend.simulate(scenario, Settings(contact))
        return
    if not refusal(engine, name, contact):
        conformance.check(backend, scenario, Settings(contact))


@pytest.mark.parametrize("name", SCENARIOS)
def test_inputs_are_followed_to_their_end(name):
    """On one engine: what is cut short above never sees the later part of long inputs."""
    whole = catalogue.load(name).resolve()
    if not whole.inputs or whole.world.duration_s <= scenario_of(name).world.duration_s:
        return
    need("mujoco")
    conformance.check(engines.get("mujoco"), whole, Settings("tuned"))


@functools.cache
def refusal(engine, name, contact):
    """Why an engine that has the features refuses a scene all the same; it must say more."""
    try:
        engines.get(engine).open(scenario_of(name), Settings(contact)).close()
    except Unsupported as error:
        reason = str(error)
        assert engine in reason, "a reason names the engine"
        assert len(reason) > 40, "a reason is a sentence"
        return reason
    return ""


@pytest.mark.parametrize("name", SCENARIOS)
def test_every_scenario_runs_on_two_engines_or_more(name):
    scenario = scenario_of(name)
    able = [e for e in ENGINES if not needs(scenario).required - engines.get(e).features]
    assert len([e for e in able if not refusal(e, name, "assisted")]) >= 2


@pytest.mark.parametrize("check", conformance.PHYSICS, ids=lambda check: check.name)
@pytest.mark.parametrize("engine", ENGINES)
def test_engine_does_physics(engine, check):
    backend = engines.get(engine)
    for level in conformance_physics.judged_levels(backend):
        finding = conformance_physics.look(check, backend, level)
        assert finding.status is not Status.FAILED, str(finding)
        if finding.status is not Status.PASSED:
            assert engine in finding.reason, "what could not be asked says of whom"
            assert len(finding.reason) > 30, "and why, in a sentence"


@pytest.mark.parametrize("engine", ENGINES)
def test_an_engine_is_asked_most_of_physics_in_its_plain_loop(engine):
    findings = conformance_physics.check(engines.get(engine), ["tuned"])
    # motion in space is out of the reach of an engine that has a plane
    asked = [one for one in findings if Feature.SPATIAL.value not in one.reason]
    assert len(asked) >= len(conformance.PHYSICS) / 2
    open_questions = [str(finding) for finding in asked if finding.status is not Status.PASSED]
    assert len(open_questions) <= len(asked) // 3, "\n".join(open_questions)


def test_physics_asks_each_question_once_and_in_a_sentence():
    names = [check.name for check in conformance.PHYSICS]
    assert len(set(names)) == len(names)
    for check in conformance.PHYSICS:
        assert check.sentence.endswith(".")
        assert check.name not in SCENARIOS


@pytest.mark.parametrize("engine", ENGINES)
def test_known_limits_have_references(engine):
    backend = engines.get(engine)
    assert backend.known_limits
    for limit in backend.known_limits:
        assert limit.text.endswith(".")
        assert len(limit.reference) > 10


@pytest.mark.parametrize("engine", ENGINES)
def test_mapping_is_documented(engine):
    assert len(engines.get(engine).mapping) > 40


def test_no_scenario_is_named_in_a_backend_and_no_engine_in_a_scenario_or_the_contract():
    root = Path(conformance.__file__).parent
    for path in (*root.glob("*_.py"), *root.glob("*/*.py")):
        text = path.read_text(encoding="utf-8")
        for name in SCENARIOS:
            assert f'"{name}"' not in text, f"{path} names the scenario {name}"
    texts = [*root.glob("conformance*.py")]
    for path in catalogue.files().values():
        texts += filter(Path.is_file, (path, path.with_name("reference.py")))
    for file in texts:
        text = file.read_text(encoding="utf-8").lower()
        for engine in ENGINES:
            assert not re.search(rf"\b{engine}\b", text), f"{file} names {engine}"
