"""Faults of what a scenario says under ``estimate:``."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from simcompare import units
from simcompare.errors import UnknownName
from simcompare.estimation import estimators
from simcompare.estimation.estimators import Estimator, Role
from simcompare.estimation.observing import ORIENTATION, observed
from simcompare.model.estimate_plan import EstimatePlan
from simcompare.model.scenario import Scenario

#: place and sentence of every fault
Faults = Iterator[tuple[str, str]]


def faults_of_estimates(scenario: Scenario) -> Faults:
    """Estimators that do not exist, or that lack or do not know something."""
    for name, plan in scenario.estimate.items():
        try:
            estimator = estimators.load(name)
        except UnknownName as error:
            yield f"estimate.{name}", str(error)
            continue
        place = f"estimate.{name}"
        yield from _of_roles(f"{place}.signals", plan.signals, estimator.signals, scenario)
        yield from _of_roles(f"{place}.truth", plan.truth, estimator.truths, scenario)
        yield from _of_options(place, plan, estimator)
        measured = {**scenario.sensors, **scenario.actuators}
        for sensor in plan.sensors:
            if sensor not in measured:
                fault = UnknownName("sensor", sensor, measured)
                yield f"{place}.sensors.{sensor}", str(fault)


def _of_roles(
    place: str, given: Mapping[str, str], known: Mapping[str, Role], scenario: Scenario
) -> Faults:
    for role, name in given.items():
        if role not in known:
            yield f"{place}.{role}", str(UnknownName("role of the estimator", role, known))
        elif fault := _fault(name, known[role], scenario):
            yield f"{place}.{role}", fault
    for role, wanted in known.items():
        if wanted.needed and role not in given:
            yield f"{place}.{role}", f"is missing: {wanted.text}"


def _fault(name: str, role: Role, scenario: Scenario) -> str:
    """What is wrong with the probe or signal in a role; empty where nothing is."""
    try:
        found = observed(name, scenario)
    except UnknownName as error:
        return str(error)
    unit, wanted = (units.symbol(one) for one in (found.unit, role.unit))
    if found.part == ORIENTATION and role.unit == "rad":  # its heading
        return ""
    if unit != wanted:
        return f"{name} is in {unit}; expected {role.text}, in {wanted}"
    if found.components != role.components:
        return f"{name} has {found.components} components; expected {role.components}: {role.text}"
    return ""


def _of_options(place: str, plan: EstimatePlan, estimator: Estimator) -> Faults:
    for option, sentence in estimators.option_faults(estimator, plan.options).items():
        yield f"{place}.options.{option}", sentence
