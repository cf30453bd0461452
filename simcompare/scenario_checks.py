"""Faults between the parts of a scenario: names that point to nothing, scores that cannot be."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from simcompare import measures
from simcompare.errors import UnknownName
from simcompare.scenario import Scenario
from simcompare.trajectory import BODY_SIGNALS


def faults_between_parts(scenario: Scenario) -> dict[str, str]:
    """Every fault that no part of a scenario shows alone, as place -> sentence."""
    found = dangling_references(scenario)
    for checked in (_pairs_given_twice, _impossible_probes, _unjudged_tolerances):
        found.update(checked(scenario))
    return found


def dangling_references(scenario: Scenario) -> dict[str, str]:
    """Names in a scenario that point to nothing, as place -> sentence."""
    faults: dict[str, str] = {}

    for place, name, kind, known in _references(scenario):
        if name is not None and name not in known:
            have = ", ".join(known) or "none"
            faults[place] = f"no {kind} is called {name!r} (there are: {have})"
    return faults


def _references(
    scenario: Scenario,
) -> Iterator[tuple[str, str | None, str, Mapping[str, object]]]:
    """Every use of a name: place, name, kind of thing, and the things of that kind."""
    bodies, joints = ("body", scenario.bodies), ("joint", scenario.joints)
    for name, joint in scenario.joints.items():
        yield f"joints.{name}.parent", joint.parent, *bodies
        yield f"joints.{name}.child", joint.child, *bodies
    for name, actuator in scenario.actuators.items():
        yield f"actuators.{name}.joint", actuator.joint, *joints
        yield f"actuators.{name}.input", actuator.input, "input", scenario.inputs
    for name, sensor in scenario.sensors.items():
        yield f"sensors.{name}.body", sensor.body, *bodies
        yield f"sensors.{name}.joint", sensor.joint, *joints
    for i, contact in enumerate(scenario.contacts):
        for body in contact.pair:
            yield f"contacts.{i}.pair", body, *bodies
    observable = {**scenario.bodies, **scenario.joints, **scenario.sensors}
    for name, probe in scenario.probes.items():
        owner = probe.observe.partition(".")[0]
        yield f"probes.{name}.observe", owner, "body, joint or sensor", observable
    for i, measure in enumerate(scenario.measures):
        yield f"measures.{i}.probe", measure.probe, "probe", scenario.probes
    if scenario.dither is not None:
        yield "dither.parameter", scenario.dither.parameter, "parameter", scenario.parameters


def _pairs_given_twice(scenario: Scenario) -> dict[str, str]:
    found, seen = {}, set()
    for i, contact in enumerate(scenario.contacts):
        pair = frozenset(contact.pair)
        if pair in seen:
            found[f"contacts.{i}"] = f"the pair {'-'.join(contact.pair)} is given twice"
        seen.add(pair)
    return found


def _impossible_probes(scenario: Scenario) -> dict[str, str]:
    found = {}
    for name, probe in scenario.probes.items():
        owner, _, part = probe.observe.partition(".")
        if owner not in scenario.bodies:
            continue
        if part not in BODY_SIGNALS:
            known = ", ".join(BODY_SIGNALS)
            found[f"probes.{name}.observe"] = f"no body has a signal {part!r} (there are: {known})"
        elif probe.component is None or probe.component >= BODY_SIGNALS[part]:
            last = BODY_SIGNALS[part] - 1
            found[f"probes.{name}"] = f"{part} needs a component from 0 to {last}"
    return found


def _unjudged_tolerances(scenario: Scenario) -> dict[str, str]:
    """Measures that do not exist, and tolerances for what no measure gives."""
    found: dict[str, str] = {}
    measured: set[str] = set()
    for i, measure in enumerate(scenario.measures):
        try:
            measured.update(measures.load(measure.function).UNITS)
        except UnknownName as error:
            found[f"measures.{i}.function"] = str(error)
    if not found:
        for name in scenario.tolerances:
            if name not in measured:
                found[f"tolerances.{name}"] = str(UnknownName("measured value", name, measured))
    return found
