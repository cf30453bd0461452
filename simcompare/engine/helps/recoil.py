"""Armature in engines that have none: what turns with a joint and yet belongs to its parent.

An armature J resists nothing but the acceleration q̈ of its joint about the axis a: it gives -J·q̈·a
to the child and J·q̈·a to the parent. As a part of the child's moment of inertia, which is all that
such an engine can be given, it resists every turn of the child: by -J·(ṡ·a + s·ω × a) with s = ω·a,
where ω is the child's rate. With s = q̇ + ω_p·a, ω_p being the parent's, what is missing is

    J·q̈·a on the parent, J·(s·ω × a + d/dt(ω_p·a)·a) on the child.

Both accelerations are taken from the step before, as those of the coming one are not known yet.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from simcompare.engine.drives import laws_of
from simcompare.engine.kinematics import in_order, mount_of
from simcompare.errors import Unsupported
from simcompare.model.scenario import Scenario
from simcompare.model.shapes import Vector

#: steps by which recoil may lag behind the motion; and from how many on a run's notes tell of it
MAX_LAG, NOTED_LAG = 20.0, 5.0
#: largest part of a change in acceleration that is overshot, so that recoil settles in few steps
OVERSHOOT = 0.5

#: rate of the joint and turn of its parent about the axis before a step, or their accelerations
Pairs = tuple[tuple[float, float], ...]
#: motion of a rotor: rate of its joint, and rate of the child in the child's own frame
Motion = tuple[float, Sequence[float]]
#: about the axis on the parent, and on the child in its own frame [N·m]
Torques = tuple[float, float, float, float]


@dataclass(frozen=True)
class Rotor:
    """An armature on a body that can turn.

    Attributes:
        joint: name of its hinge.
        parent: body that feels its recoil.
        child: body to whose moment of inertia it was added.
        armature: [kg·m²].
        axis: the hinge's unit axis in the child's frame.
        parent_axis: the same in the parent's frame.
    """

    joint: str
    parent: str
    child: str
    armature: float
    axis: Vector
    parent_axis: Vector


def turning_bodies(scenario: Scenario) -> set[str]:
    """Bodies that can turn: the free ones, and what hinges carry."""
    found = set(scenario.free_bodies())
    for joint in in_order(scenario).values():
        if joint.type == "hinge" or joint.parent in found:
            found.add(joint.child)
    return found


def rotors_of(scenario: Scenario) -> list[Rotor]:
    """Armatures of hinges on bodies that can turn; on others nothing is missing."""
    found, turning, laws = [], turning_bodies(scenario), laws_of(scenario)
    for name, joint in scenario.joints.items():
        if joint.type == "hinge" and joint.parent in turning and laws[name].armature:
            length = math.hypot(*joint.axis)
            x, y, z = joint.axis
            unit = (x / length, y / length, z / length)
            axis = mount_of(scenario, joint).axis
            found.append(Rotor(name, joint.parent, joint.child, laws[name].armature, axis, unit))
    return found


class Recoil:
    """Torques that make an armature of what was added to a moment of inertia.

    Args:
        scenario: the scene.
        rotors: its armatures.

    Attributes:
        lag: steps by which the torques lag behind the motion.
        before: motions before the last step, ``None`` where they are not known.
        felt: accelerations in it, likewise.
        given: torques of the last step.

    Raises:
        Unsupported: that would be too many.
    """

    def __init__(self, scenario: Scenario, rotors: Sequence[Rotor]) -> None:
        self.rotors = rotors
        self.before: Pairs | None = None
        self.felt: Pairs | None = None
        self.given: list[Torques] = [(0.0, 0.0, 0.0, 0.0)] * len(rotors)
        self._step_s = scenario.world.engine_step_s
        least, most = _feedback(scenario, rotors)
        # taking less than all of a change lets torques settle that would else alternate and grow
        self._part = min(1.0, (1 + OVERSHOOT) / (1 - least))
        self.lag = 1 / (self._part * (1 - most))
        if self.lag > MAX_LAG:
            raise Unsupported(
                f"{_armatures(rotors)} too large for an engine without it:"
                f" {self._late('would lag')}"
            )
        #: steps in which it settles to a thousandth of a thousandth
        self.tries = math.ceil(14 * self.lag)

    def _late(self, lags: str) -> str:
        parents = ", ".join(dict.fromkeys(rotor.parent for rotor in self.rotors))
        return f"the recoil on {parents} {lags} behind the motion by up to {self.lag:.0f} steps"

    def notes(self) -> tuple[str, ...]:
        """What a run has to tell of it."""
        late = self.lag > NOTED_LAG
        return (f"{_armatures(self.rotors)} large: {self._late('lags')}",) if late else ()

    def torques(self, motions: Sequence[Motion]) -> list[Torques]:
        """Torques of the next step for each rotor.

        Args:
            motions: of the rotors, before the step.
        """
        self.look(motions)
        felt = self.felt or ((0.0, 0.0),) * len(self.rotors)
        found = []
        for rotor, (_, (x, y, z)), (turned, carried) in zip(
            self.rotors, motions, felt, strict=True
        ):
            (a, b, c), inertia = rotor.axis, rotor.armature
            spin, along = inertia * (a * x + b * y + c * z), inertia * carried
            found.append(
                (
                    inertia * turned,
                    spin * (y * c - z * b) + along * a,
                    spin * (z * a - x * c) + along * b,
                    spin * (x * b - y * a) + along * c,
                )
            )
        self.given = found
        return found

    def look(self, motions: Sequence[Motion]) -> None:
        """Takes the accelerations of the last step from what it made of the motion."""
        now = []
        for rotor, (rate, (x, y, z)) in zip(self.rotors, motions, strict=True):
            a, b, c = rotor.axis
            now.append((rate, a * x + b * y + c * z - rate))
        if self.before is not None:
            step_s, part = self._step_s, self._part
            new = [
                ((rate - rate_was) / step_s, (carried - was) / step_s)
                for (rate, carried), (rate_was, was) in zip(now, self.before, strict=True)
            ]
            old = self.felt or new
            self.felt = tuple(
                (turned + part * (t - turned), carried + part * (c - carried))
                for (turned, carried), (t, c) in zip(old, new, strict=True)
            )
        self.before = tuple(now)

    def begin(self, felt: Pairs | None) -> None:
        """Begins anew, with accelerations where they are known."""
        self.before, self.felt = None, felt


def note_without(rotors: Sequence[Rotor]) -> str:
    """What a run has to tell where recoil is not given."""
    where = "part of the child's moment of inertia, and has no recoil on the parent"
    return f"{_armatures(rotors)} {where}"


def _armatures(rotors: Sequence[Rotor]) -> str:
    return f"the armature of {', '.join(rotor.joint for rotor in rotors)} is"


def _feedback(scenario: Scenario, rotors: Sequence[Rotor]) -> tuple[float, float]:
    """Between which factors accelerations come back by the torques that they lead to.

    With M the moments of inertia that the engine has, armature included, and D what the torques
    make of accelerations, they are eigenvalues of M⁻¹·D. The translations of the bodies, the joints
    and whatever else constrains them only bring the extremes closer together.
    """
    names = list(dict.fromkeys(n for rotor in rotors for n in (rotor.parent, rotor.child)))
    if not names:
        return 0.0, 0.0
    size, laws = 3 * len(names), laws_of(scenario)
    held, torques = np.zeros((size, size)), np.zeros((size, size))
    for i, name in enumerate(names):
        place = slice(3 * i, 3 * i + 3)
        held[place, place] = np.diag(scenario.bodies[name].inertia_kg_m2 or ())
        for carrying, joint in scenario.joints.items():
            if joint.child == name and joint.type == "hinge":
                axis = np.array(mount_of(scenario, joint).axis)
                held[place, place] += laws[carrying].armature * np.outer(axis, axis)
    for rotor in rotors:
        child, parent = np.zeros(size), np.zeros(size)
        child[3 * names.index(rotor.child) :][:3] = rotor.axis
        parent[3 * names.index(rotor.parent) :][:3] = rotor.parent_axis
        joint_row = child - parent
        torques += rotor.armature * (np.outer(child, child) - np.outer(joint_row, joint_row))
    values = np.linalg.eigvals(np.linalg.solve(held, torques)).real
    return min(0.0, float(values.min())), max(0.0, float(values.max()))
