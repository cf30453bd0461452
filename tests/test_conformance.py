"""Every scenario on every engine conforms to the contract that other people's backends have too."""

import functools

import pytest

from simcompare import catalogue, engines
from simcompare.backend import needs
from simcompare.backends import conformance
from simcompare.errors import Unsupported
from simcompare.settings import CONTACT_LEVELS, Settings

ENGINES = engines.names()
SCENARIOS = catalogue.names()


@pytest.fixture(scope="module")
def scenario_of():
    files = {name: catalogue.load(name) for name in SCENARIOS}
    return lambda name: files[name].resolve()


@pytest.mark.parametrize("contact", CONTACT_LEVELS)
@pytest.mark.parametrize("check", conformance.CHECKS, ids=lambda check: check.__name__)
@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("name", SCENARIOS)
def test_backend_conforms(name, engine, check, contact, scenario_of):
    backend, scenario = engines.get(engine), scenario_of(name)
    if needs(scenario) - backend.features:
        with pytest.raises(Unsupported, match="has no"):
            backend.simulate(scenario, Settings(contact))
        return
    if refusals(engine, name, contact):
        return
    check(backend, scenario, Settings(contact))


@functools.cache
def refusals(engine, name, contact):
    """Why an engine that has the features refuses a scene all the same; it must say more."""
    backend, scenario = engines.get(engine), catalogue.load(name).resolve()
    reasons = []
    for mode in {contact, "assisted"}:
        try:
            backend.open(scenario, Settings(mode)).close()
        except Unsupported as error:
            reasons.append(str(error))
    for reason in reasons:
        assert engine in reason, "a reason names the engine"
        assert len(reason) > 40, "a reason is a sentence"
    return reasons


@pytest.mark.parametrize("name", SCENARIOS)
def test_every_scenario_runs_on_two_engines_or_more(name, scenario_of):
    scenario = scenario_of(name)
    able = [e for e in ENGINES if not needs(scenario) - engines.get(e).features]
    assert len([e for e in able if not refusals(e, name, "assisted")]) >= 2


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


def test_no_scenario_is_named_in_a_backend_and_no_engine_in_a_scenario():
    from pathlib import Path

    root = Path(conformance.__file__).parent.parent
    for path in root.glob("backends/*_.py"):
        text = path.read_text(encoding="utf-8")
        for name in SCENARIOS:
            assert f'"{name}"' not in text, f"{path} names the scenario {name}"
    for name, path in catalogue.files().items():
        for file in filter(Path.is_file, (path, path.with_name("reference.py"))):
            text = file.read_text(encoding="utf-8").lower()
            for engine in ENGINES:
                assert engine not in text, f"{file} of {name} names {engine}"
