"""Forces through joints from momentum, where an engine tells no more than their magnitude.

The force is taken from the momentum of what the joint carries: all that changed it in a step, less
weight, and less what contacts gave.
"""

from __future__ import annotations

from collections.abc import Mapping

from simcompare.engine.steppable import Planar
from simcompare.model.scenario import Scenario
from simcompare.model.sensor import Sensor

Momentum = tuple[float, float]


class MomentumForces:
    """Forces through joints of a planar engine.

    Args:
        scenario: the scene.
        sensors: its sensors of forces.
    """

    def __init__(self, scenario: Scenario, sensors: Mapping[str, Sensor]) -> None:
        gx, _, gz = scenario.world.gravity_m_s2
        self._gravity, self._bodies = (gx, gz), scenario.bodies
        joints = [sensor.joint for sensor in sensors.values() if sensor.joint is not None]
        self._carried = {name: carried_by(scenario, name) for name in joints}
        self._before: dict[str, Momentum] = {}

    def mark(self, simulation: Planar) -> None:
        """Remembers the momenta before a step."""
        self._before = {name: self._momentum(simulation, name) for name in self._carried}

    def force(self, simulation: Planar, joint: str, step_s: float) -> Momentum:
        """Force of a joint's parent on its child in the last step, in the world's frame."""
        before, after = self._before[joint], self._momentum(simulation, joint)
        fx, fz = (after[0] - before[0]) / step_s, (after[1] - before[1]) / step_s
        for carried in self._carried[joint]:
            body = self._bodies[carried]
            assert body.mass_kg is not None
            fx, fz = fx - body.mass_kg * self._gravity[0], fz - body.mass_kg * self._gravity[1]
            if body.shapes:
                jx, jz = simulation.contact_impulse(carried)
                fx, fz = fx - jx / step_s, fz - jz / step_s
        return fx, fz

    def _momentum(self, simulation: Planar, joint: str) -> Momentum:
        x = z = 0.0
        for name in self._carried[joint]:
            (_, _, vx, vz, _, _), mass = simulation.get(name), self._bodies[name].mass_kg
            assert mass is not None
            x, z = x + mass * vx, z + mass * vz
        return x, z


def carried_by(scenario: Scenario, joint: str) -> list[str]:
    """Bodies that hang on a joint."""
    child = scenario.joints[joint].child
    found = [child]
    for name, other in scenario.joints.items():
        if other.parent == child:
            found += carried_by(scenario, name)
    return found
