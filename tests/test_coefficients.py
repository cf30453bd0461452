"""The contact level ``coefficients``: these are given, and all else is the engine's."""

import pytest

import simcompare
from simcompare.engine import engines
from simcompare.engine.features import needs
from simcompare.model.settings import ASSISTED, COEFFICIENTS, DEFAULT, Settings
from simcompare.scenarios import catalogue

SPATIAL = [
    name
    for name in engines.names()
    if not needs(catalogue.load("robot").resolve()).required - engines.get(name).features
]


def audit_of(engine, scenario, mode):
    simulation = engines.get(engine).open(scenario, Settings(mode))
    simulation.close()
    return simulation.audit


@pytest.mark.parametrize("engine", engines.names())
def test_friction_is_given_with_coefficients_and_left_by_default(engine):
    scenario = catalogue.load("robot_planar").resolve()
    given = {
        mode: [
            row.set_value
            for row in audit_of(engine, scenario, mode)
            if row.quantity.endswith("floor friction")
        ]
        for mode in (DEFAULT, COEFFICIENTS, ASSISTED)
    }
    assert all(value is None for value in given[DEFAULT])
    assert given[COEFFICIENTS]
    assert None not in given[COEFFICIENTS]
    assert given[COEFFICIENTS] == given[ASSISTED]


@pytest.mark.parametrize("engine", SPATIAL)
def test_a_robot_stands_still_by_default_and_drives_with_coefficients(engine):
    file = catalogue.load("robot")
    ends = {}
    for mode in (DEFAULT, COEFFICIENTS):
        found = engines.get(engine).simulate(file.resolve(), Settings(mode))
        ends[mode] = found.signals["chassis.position_m"][-1, 0] + 0.02
    # an engine that takes the mean of two frictions lets the caster slip a little by default
    assert abs(ends[DEFAULT]) < (0.5 if engine == "rapier" else 0.02)
    assert 0.85 < ends[COEFFICIENTS] < 1.05


@pytest.mark.engines("pybullet")
def test_wheels_drawn_as_cylinders_tell_engines_apart_though_all_have_the_coefficients():
    # how far that goes hangs on the moments of inertia: it is 13 % with those of our robot
    shares = {"roll_inertia_share": 0.55, "pitch_inertia_share": 0.55}
    run = simcompare.run("robot_cylinder", contact="coefficients,assisted", set=shares)
    found = {(s.source, s.contact): s for s in run.record.scores if s.measure == "acceleration"}
    truth = found[SPATIAL[0], ASSISTED].truth
    apart = [abs(found[name, COEFFICIENTS].value / truth - 1) for name in SPATIAL]
    # measured: 46 % for the engine that finds one point of a line, less than 0.1 % for the others
    assert max(apart) > 0.3
    assert min(apart) < 0.003
    assert {found[name, COEFFICIENTS].verdict for name in SPATIAL} == {"info"}
    assert {found[name, ASSISTED].verdict for name in SPATIAL} == {"pass"}


def test_a_coefficient_of_restitution_alone_does_not_make_the_bounce():
    run = simcompare.run("ball", contact="coefficients", seeds=5)
    found = {
        s.source: s.value
        for s in run.record.scores
        if (s.measure, s.index) == ("restitution", None)
    }
    # a spring of its own, contacts that act while apart, a speed taken after gravity; a bounce that
    # begins where a step finds the body is 0.4 % off here, and more where it is slower
    off = {name: abs(value / 0.8 - 1) for name, value in found.items()}
    assert max(off.values()) == 1
    assert sum(value <= 0.01 for value in off.values()) <= 3
    assert all(value > 0.003 for value in off.values())
