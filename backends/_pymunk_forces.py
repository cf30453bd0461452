"""Forces through joints and between bodies, as Chipmunk's last step gave them.

A constraint tells only the magnitude of its impulse. The force through a joint is therefore taken
from the momentum of what the joint carries: all that changed it in a step, less what others gave.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from simcompare.backends._pymunk_scene import Scene
from simcompare.scenario import Scenario, Sensor
from simcompare.shapes import Vector

if TYPE_CHECKING:
    from pymunk import Arbiter, Body

Planar = tuple[float, float]


class ForceReader:
    """Reads the force sensors of a scene.

    Args:
        scenario: the scene.
        sensors: its sensors of forces, in order.
    """

    def __init__(self, scenario: Scenario, sensors: Mapping[str, Sensor]) -> None:
        self._sensors = sensors
        gx, _, gz = scenario.world.gravity_m_s2
        self._gravity = gx, gz
        self._children = {
            name: scenario.joints[sensor.joint].child
            for name, sensor in sensors.items()
            if sensor.joint is not None
        }
        self._carried = {
            name: _carried_by(scenario, child) for name, child in self._children.items()
        }
        self._before: dict[str, Planar] = {}

    def mark(self, scene: Scene) -> None:
        """Remembers the momenta before a step."""
        self._before = {name: _momentum(scene, on) for name, on in self._carried.items()}

    def read(self, scene: Scene, step_s: float) -> list[float]:
        """All readings after a step of this length [s]."""
        found: list[float] = []
        for name, sensor in self._sensors.items():
            if sensor.pair is not None:
                first, second = (scene.bodies[body] for body in sensor.pair)
                found.append(_normal_impulse(first, second) / step_s)
            else:
                found += self._through(name, scene, step_s)
        return found

    def _through(self, name: str, scene: Scene, step_s: float) -> Vector:
        """Force of a joint's parent on its child, in the child's frame."""
        before, after = self._before[name], _momentum(scene, self._carried[name])
        fx, fz = (after[0] - before[0]) / step_s, (after[1] - before[1]) / step_s
        for carried in self._carried[name]:
            body = scene.bodies[carried]
            fx, fz = fx - body.mass * self._gravity[0], fz - body.mass * self._gravity[1]
            if scene.shapes[carried]:
                jx, jz = _contact_impulse(body)
                fx, fz = fx - jx / step_s, fz - jz / step_s
        angle = scene.bodies[self._children[name]].angle
        c, s = math.cos(angle), math.sin(angle)
        return c * fx + s * fz, 0.0, c * fz - s * fx


def _carried_by(scenario: Scenario, body: str) -> list[str]:
    """A body and all that hangs on it."""
    found = [body]
    for joint in scenario.joints.values():
        if joint.parent == body:
            found += _carried_by(scenario, joint.child)
    return found


def _momentum(scene: Scene, names: Sequence[str]) -> Planar:
    x = z = 0.0
    for name in names:
        body = scene.bodies[name]
        (vx, vz), mass = body.velocity, body.mass
        x, z = x + mass * vx, z + mass * vz
    return x, z


def _normal_impulse(first: Body, second: Body) -> float:
    """Sum of the normal impulses [N·s] between two bodies in the last step."""
    if first.body_type == first.STATIC:
        first, second = second, first
    impulses: list[float] = []

    def add(arbiter: Arbiter) -> None:
        if second in arbiter.bodies:
            impulses.append(abs(arbiter.total_impulse.dot(arbiter.normal)))

    first.each_arbiter(add)
    return sum(impulses)


def _contact_impulse(body: Body) -> Planar:
    """Sum of all impulses [N·s] of contacts on a body in the last step."""
    impulses: list[Planar] = []

    def add(arbiter: Arbiter) -> None:
        # Chipmunk gives the impulse on the body whose contacts are asked for
        impulses.append(tuple(arbiter.total_impulse))

    body.each_arbiter(add)
    return sum(x for x, _ in impulses), sum(z for _, z in impulses)
