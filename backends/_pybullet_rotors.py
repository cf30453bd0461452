"""What turns with a joint and belongs to its parent: armature, which Bullet does not have.

It is added to the child's moment of inertia, so that the joint accelerates as it should. But what
speeds up an armature is on the parent, where its reaction has to go as well: that is given back to
the parent as a torque, from how the joint accelerated in the step before. It is exact but for this
step while the parent does not turn about the joint's axis.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from simcompare.backends._pybullet_scene import Scene, inertia_of, turning_bodies
from simcompare.drives import laws_of
from simcompare.shapes import Vector

#: rates before the last step, and the accelerations that the parents feel
Memory = tuple[list[float] | None, list[float] | None]


class Rotors:
    """Armatures on bodies that can turn.

    Args:
        scene: what was built.
        order: joints, in the order in which their states will be given.

    Attributes:
        names: joints that have one.
        torques: what was given back in the last step [N·m].
    """

    def __init__(self, scene: Scene, order: Sequence[str]) -> None:
        scenario, laws = scene.scenario, laws_of(scene.scenario)
        turning = turning_bodies(scenario) if scene.mapped else set()
        joints = {name: scenario.joints[name] for name in order}
        self.names = [n for n, j in joints.items() if laws[n].armature and j.parent in turning]
        self.torques = [0.0 for _ in self.names]
        self._engine, self._client = scene.engine, scene.client
        self._step_s = scenario.world.engine_step_s
        self._slots = [order.index(name) for name in self.names]
        self._axes = [_unit(joints[name].axis) for name in self.names]
        self._parents = [scene.bodies[joints[name].parent] for name in self.names]
        self._armatures = [laws[name].armature for name in self.names]
        self._before: list[float] | None = None
        self._felt: list[float] | None = None
        # A parent that is light follows the torque, and so changes what the next one is taken from.
        # Taking so much of each new value ends that at once, and is stable for all heavier ones.
        loads: dict[str, float] = {}
        for name, axis, armature in zip(self.names, self._axes, self._armatures, strict=True):
            parent = joints[name].parent
            moments = inertia_of(scenario, parent, laws) or ()
            load = armature * sum(a * a / i for a, i in zip(axis, moments, strict=True))
            loads[parent] = loads.get(parent, 0.0) + load
        self._parts = [1 / (1 + loads[joints[name].parent]) for name in self.names]

    @property
    def memory(self) -> Memory:
        """What ``remember`` brings back."""
        return self._before, self._felt

    def remember(self, memory: Memory) -> None:
        """Goes on from what was kept."""
        self._before, self._felt = memory

    def begin(self, rates_before: Mapping[str, float]) -> None:
        """Begins with the rates of one step earlier, where they are known."""
        known = [rates_before[name] for name in self.names if name in rates_before]
        self._before = known if len(known) == len(self.names) else None
        self._felt = None

    def push(self, states: Sequence[Sequence[Any]]) -> None:
        """Gives the reactions to the parents for the next step."""
        rates = [states[i][1] for i in self._slots]
        if self._before is not None:
            new = [(v - was) / self._step_s for v, was in zip(rates, self._before, strict=True)]
            old = self._felt or new
            self._felt = [a + p * (b - a) for a, b, p in zip(old, new, self._parts, strict=True)]
            self.torques = [j * a for j, a in zip(self._armatures, self._felt, strict=True)]
            push, frame = self._engine.applyExternalTorque, self._engine.LINK_FRAME
            for (uid, link), (x, y, z), t in zip(
                self._parents, self._axes, self.torques, strict=True
            ):
                push(uid, link, (t * x, t * y, t * z), frame, self._client)
        else:
            self.torques = [0.0 for _ in self.names]
        self._before = rates


def _unit(axis: Vector) -> Vector:
    length = math.hypot(*axis)
    return axis[0] / length, axis[1] / length, axis[2] / length
