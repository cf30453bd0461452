"""Faults between the parts of a scenario: names that point to nothing, scores that cannot be."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from simcompare import measures, units
from simcompare.errors import SimcompareError, UnknownName
from simcompare.hardware.sensors import data_sheet, drawn
from simcompare.model import sensor_errors
from simcompare.model.scenario import Joint, Measure, Probe, Scenario
from simcompare.scenarios.estimate_checks import faults_of_estimates

#: place and sentence of every fault
Faults = Iterator[tuple[str, str]]


def faults_between_parts(scenario: Scenario) -> dict[str, str]:
    """Every fault that no part of a scenario shows alone, as place -> sentence."""
    faults = dict(_dangling_references(scenario))
    if faults:  # what follows walks along the names
        return faults
    for checked in (
        _doubled_names,
        _doubled_pairs,
        _impossible_joints,
        _impossible_drives,
        _impossible_contacts,
        _without_effect,
        _impossible_probes,
        _impossible_measures,
        _unjudged_tolerances,
        _impossible_answer,
        _impossible_errors,
        faults_of_estimates,
    ):
        faults.update(checked(scenario))
    return faults


def _dangling_references(scenario: Scenario) -> Faults:
    """Names in a scenario that point to nothing."""
    for place, name, kind, known in _references(scenario):
        if name is not None and name not in known:
            have = ", ".join(known) or "none"
            yield place, f"no {kind} is called {name!r} (there are: {have})"


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
        for body in sensor.pair or ():
            yield f"sensors.{name}.pair", body, *bodies
    for i, contact in enumerate(scenario.contacts):
        for body in contact.pair:
            yield f"contacts.{i}.pair", body, *bodies
    yield from _observed(scenario)
    if scenario.dither is not None:
        yield "dither.parameter", scenario.dither.parameter, "parameter", scenario.parameters


def _observed(
    scenario: Scenario,
) -> Iterator[tuple[str, str | None, str, Mapping[str, object]]]:
    """Names that probes and measures use."""
    observable = {
        **scenario.bodies, **scenario.joints, **scenario.sensors, **scenario.actuators
    }  # fmt: skip
    for name, probe in scenario.probes.items():
        owner = probe.observe.partition(".")[0]
        yield f"probes.{name}.observe", owner, "body, joint, actuator or sensor", observable
    for i, measure in enumerate(scenario.measures):
        yield f"measures.{i}.probe", measure.probe, "probe", scenario.probes
        for role, probe_name in measure.also.items():
            yield f"measures.{i}.also.{role}", probe_name, "probe", scenario.probes


def _doubled_pairs(scenario: Scenario) -> Faults:
    earlier: set[frozenset[str]] = set()
    for i, contact in enumerate(scenario.contacts):
        pair = frozenset(contact.pair)
        if pair in earlier:
            yield f"contacts.{i}", f"the pair {'-'.join(contact.pair)} is given twice"
        earlier.add(pair)


def _doubled_names(scenario: Scenario) -> Faults:
    """Signals are called by their owner's name, so no two owners may share one."""
    kinds = dict.fromkeys(scenario.bodies, "body")
    for kind in ("joints", "actuators", "sensors"):
        for name in getattr(scenario, kind):
            if name in kinds:
                yield f"{kind}.{name}", f"a {kinds[name]} is called {name} too"
            kinds.setdefault(name, kind[:-1])


def _impossible_joints(scenario: Scenario) -> Faults:
    """Children of the world, of two parents or of themselves, and motion that a joint gives."""
    parents: dict[str, tuple[str, Joint]] = {}
    for name, joint in scenario.joints.items():
        child = scenario.bodies[joint.child]
        if child.fixed:
            yield f"joints.{name}.child", f"{joint.child} is fixed to the world already"
        elif joint.child in parents:
            other = parents[joint.child][0]
            yield f"joints.{name}.child", f"{joint.child} is the child of {other} already"
        elif any((*child.velocity_m_s, *child.rate_rad_s)):
            yield (
                f"bodies.{joint.child}",
                f"its motion at the start follows from the joint {name}; give that a rate",
            )
        parents.setdefault(joint.child, (name, joint))
    for body in scenario.bodies:
        above, passed = body, {body}
        while above in parents:
            above = parents[above][1].parent
            if above in passed:
                yield f"joints.{parents[above][0]}", f"{above} hangs, in a circle, on itself"
                break
            passed.add(above)


def _impossible_drives(scenario: Scenario) -> Faults:
    for name, actuator in scenario.actuators.items():
        kind = scenario.joints[actuator.joint].type
        wanted = "slider" if actuator.type == "force" else "hinge"
        if kind != wanted:
            yield f"actuators.{name}", f"a {actuator.type} drives a {wanted}, not a {kind}"
    for name, sensor in scenario.sensors.items():
        if sensor.type == "encoder" and sensor.joint is not None:
            kind = scenario.joints[sensor.joint].type
            if kind != "hinge":
                yield f"sensors.{name}", f"an encoder needs a hinge, not a {kind}"


def _without_effect(scenario: Scenario) -> Faults:
    """What would be read and left out by every engine, so that nobody counts on it."""
    used = {actuator.input for actuator in scenario.actuators.values()}
    for name in scenario.inputs:
        if name not in used:
            yield f"inputs.{name}", "no actuator follows it"
    for joint in scenario.joints.values():
        drag = scenario.bodies[joint.child].drag
        if drag is not None and drag.factor_kg_m > 0:
            yield f"bodies.{joint.child}.drag", "drag acts on bodies that hang on no joint"


def _impossible_contacts(scenario: Scenario) -> Faults:
    """Pairs that never touch, though something is said of their contact."""
    jointed = {frozenset((j.parent, j.child)): name for name, j in scenario.joints.items()}
    touching = {f"contacts.{i}": contact.pair for i, contact in enumerate(scenario.contacts)}
    touching.update({f"sensors.{name}": s.pair for name, s in scenario.sensors.items() if s.pair})
    for place, pair in touching.items():
        bare = [name for name in pair if not scenario.bodies[name].shapes]
        if frozenset(pair) in jointed:
            yield (
                place,
                f"{' and '.join(pair)} never touch: {jointed[frozenset(pair)]} joins them",
            )
        elif bare:
            yield place, f"{' and '.join(bare)} cannot touch anything without a shape"


def _impossible_probes(scenario: Scenario) -> Faults:
    for name, probe in scenario.probes.items():
        owner, _, part = probe.observe.partition(".")
        known = scenario.signals_of(owner)
        if part not in known:
            have = ", ".join(known) or "none"
            yield f"probes.{name}.observe", f"{owner} has no signal {part!r} (there are: {have})"
        elif fault := _component_fault(probe, part, known[part]) or _unit_fault(probe, part):
            yield f"probes.{name}", fault


def _component_fault(probe: Probe, part: str, width: int) -> str | None:
    if width == 1:
        return None if probe.component is None else f"{part} is one number and has no component"
    if probe.component is None or probe.component >= width:
        return f"{part} needs a component from 0 to {width - 1}"
    return None


def _unit_fault(probe: Probe, part: str) -> str | None:
    """A probe shows a signal as it is recorded, so its unit is that of the signal."""
    unit = units.symbol(units.unit_of(part))
    return None if probe.unit == unit else f"{part} is in {unit}, not in {probe.unit}"


def _impossible_measures(scenario: Scenario) -> Faults:
    """Measures that do not exist or lack something."""
    measured: set[str] = set()
    for i, measure in enumerate(scenario.measures):
        try:
            function = measures.load(measure.function)
        except UnknownName as error:
            yield f"measures.{i}.function", str(error)
            continue
        yield from _measure_faults(f"measures.{i}", measure, function)
        names = [measure.name_of(name) for name in function.units]
        for name in names:
            if name in measured:
                yield f"measures.{i}", f"{name} is measured twice; give it another name in names"
        measured.update(names)


def _unjudged_tolerances(scenario: Scenario) -> Faults:
    """Tolerances for what no measure gives, where all measures are possible."""
    if any(_impossible_measures(scenario)):
        return
    measured = [name for measure in scenario.measures for name in _names_of(measure)]
    for name in scenario.tolerances:
        if name not in measured:
            yield f"tolerances.{name}", str(UnknownName("measured value", name, measured))


def _measure_faults(place: str, measure: Measure, function: measures.Function) -> Faults:
    """Roles and options that are missing or unknown, and new names for what is not measured."""
    for key, needed, present in (
        ("also", function.roles, measure.also),
        ("options", function.options, measure.options),
    ):
        for name in sorted(set(needed) ^ set(present)):
            fault = "is missing" if name in needed else "is not known"
            have = ", ".join(needed) or "none"
            yield f"{place}.{key}.{name}", f"{fault}; {measure.function} needs: {have}"
    for name in measure.names:
        if name not in function.units:
            yield f"{place}.names.{name}", str(UnknownName("measured value", name, function.units))


def _impossible_errors(scenario: Scenario) -> Faults:
    """Devices that cannot be, and data sheets that do not fit what they are said of."""
    rate = 1 / scenario.world.step_s
    for owner, errors in scenario.sensor_errors().items():
        place, signals = _place_of_errors(scenario, owner), scenario.signals_of(owner)
        faults = dict(sensor_errors.faults_of(errors, signals, rate))
        yield from ((f"{place}.{key}".rstrip("."), text) for key, text in faults.items())
        if errors.sheet is None or faults:
            continue
        try:
            named = {f"{owner}.{part}": width for part, width in signals.items()}
            drawn.parts_of(data_sheet.load(errors.sheet), errors, named)
        except SimcompareError as error:
            yield f"{place}.sheet", str(error)


def _place_of_errors(scenario: Scenario, owner: str) -> str:
    kinds = ("joints", "actuators", "sensors")
    kind = next(kind for kind in kinds if owner in getattr(scenario, kind))
    return f"{kind}.{owner}.errors"


def _impossible_answer(scenario: Scenario) -> Faults:
    """An answer made of what is not measured, or with causes that nobody is asked for."""
    if scenario.answer is None:
        return
    measured = [name for measure in scenario.measures for name in _names_of(measure)]
    wrong = scenario.answer.faults(measured, list(_held(scenario)))
    for place, sentence in wrong.items():
        yield f"answer.{place}", sentence


def _names_of(measure: Measure) -> list[str]:
    """What a measure finds, as the scenario calls it; nothing of one that does not exist."""
    if measure.function not in measures.FUNCTIONS:
        return []
    return [measure.name_of(name) for name in measures.load(measure.function).units]


def _held(scenario: Scenario) -> Iterator[str]:
    """Quantities of which an engine may hold a value of its own: contacts, joints, sleep."""
    yield "sleep"
    for contact in scenario.contacts:
        for coefficient in ("restitution", "friction"):
            yield f"{'-'.join(contact.pair)} {coefficient}"
    for name in scenario.movable_joints():
        for part in ("friction", "damping", "stiffness", "armature"):
            yield f"{name}.{part}"
