"""Closed form of the robot that drives straight ahead under a torque at each wheel."""

from __future__ import annotations

from collections.abc import Iterator

from simcompare.gauging import scenario_values
from simcompare.gauging.check import Check
from simcompare.gauging.example import Example
from simcompare.scenarios.robot.straight import Straight

#: friction of the caster -> acceleration at 0.02 N·m
_CASTER = {0.0: "1.95360195", 0.1: "1.66255818", 0.3: "1.15462048", 0.5: "0.72620193"}


def _robot(name: str = "robot", **changed: float) -> Straight:
    return Straight.of(scenario_values.of(name, **changed))


def _checks() -> Iterator[Check]:
    for friction, exact in _CASTER.items():
        forces = _robot(caster_friction=friction).forces(0.02)
        quantity = f"acceleration, caster friction {friction:g} (m/s²)"
        yield Check(quantity, exact, forces.acceleration_m_s2)
    rest = _robot()
    caster_N = rest.forces(0.0).caster_N
    yield Check("load of the caster at rest (N)", "1.32389775", caster_N)
    weight_N = rest.mass_kg * rest.gravity_m_s2
    yield Check("load of the wheels at rest (N)", "4.56009225", weight_N - caster_N)
    yield Check(
        "torque at which the tyres slip, friction 0.6 (N·m)", "0.03573035688", rest.slip_torque
    )
    spinning = _robot(tyre_friction=0.5).sliding(0.06)
    yield Check(
        "tyres spinning, 0.06 N·m, friction 0.5 (m/s²)",
        "2.446850375",
        spinning.acceleration_m_s2,
    )


EXAMPLE = Example(
    "Robot under a torque: acceleration, loads, slip",
    "Newton and Euler for the robot and its wheels: forces along, moments about the axle's line on"
    " the floor; the linear equations solved with mpmath.",
    _checks,
    kind="exact",
    closed_form=True,
)
