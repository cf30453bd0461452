"""What reaction forces hold too much where Coriolis and gyroscopic terms are taken in twice.

Bullet computes the accelerations of an articulated body twice in a step: without contacts, and then
what contacts and motors add. The reaction at a joint is the sum of both. The second pass, however,
takes in again what the motion alone gives: the Coriolis accelerations of the joints, gyroscopic
torques, and m·ω × v of a free base (bulletphysics/bullet3 issues 2966, 4451 and pull request 4583
tell of other terms that were taken in twice). The motion is right, the reaction is not. What the
second pass makes of these terms follows from the motion before the step, and is taken off here.

All of it is for engines in reduced coordinates whose passes are such. Beside it, forces of points
of contact are left out that an engine has left there, although they are too far apart to act.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from simcompare.engine.drives import laws_of
from simcompare.engine.helps.recoil import rotors_of, turning_bodies
from simcompare.engine.kinematics import add_children, mount_of, trees
from simcompare.errors import Unsupported
from simcompare.model.rotations import conjugate, cross, rotate
from simcompare.model.scenario import MOVABLE, Scenario
from simcompare.model.trajectory import BODY_SIGNALS, Array

if TYPE_CHECKING:
    from simcompare.engine.scene import Scene

#: motion of one body: position, orientation, velocity and rate, one row per step
Motion = tuple[Array, Array, Array, Array]
#: how a body turns and shifts with the freedoms of its tree (n, 3, freedoms), and its angular and
#: linear acceleration while these rest (n, 3)
Reach = tuple[Array, Array, Array, Array]


def sensed_wrongly(engine: str, scenario: Scenario) -> list[str]:
    """Joints with a force sensor whose reaction can hold too much.

    It holds nothing more where all joints that move are on bodies that do not.

    Raises:
        Unsupported: what is too much is not known.
    """
    sensed = set(scenario.sensed_joints().values())
    turning, found = turning_bodies(scenario), []
    for root, joints in trees(scenario).items():
        here = [name for name in joints if name in sensed]
        moving = set() if scenario.bodies[root].fixed else {root}
        carried = bool(moving)
        for name in joints:
            joint = scenario.joints[name]
            if here and joint.type == "slider" and joint.parent in turning:
                _refuse_friction(engine, scenario, name)
            carried |= joint.type in MOVABLE and joint.parent in moving
            if joint.type in MOVABLE or joint.parent in moving:
                moving.add(joint.child)
        found += here if carried else []
    return found


def acting_force(points: Iterable[tuple[float, float]], widest_gap_m: float) -> float:
    """Sum of the normal forces [N] of the points of contact that are near enough to act.

    Args:
        points: force [N] and gap [m] of each; some engines leave old forces on those far apart.
        widest_gap_m: gap up to which they act [m].
    """
    found = 0.0
    for force, gap_m in points:
        if gap_m <= widest_gap_m:
            found += force
    return found


def _refuse_friction(engine: str, scenario: Scenario, joint: str) -> None:
    if laws_of(scenario)[joint].friction:
        raise Unsupported(
            f"{engine} reads no forces through joints where {joint}, a slider with friction, is on"
            " a body that turns: it lets the friction act on the centres of both bodies"
        )


class Surplus:
    """What is too much in the reaction at some joints, from the motion before each step.

    Args:
        scene: what was built.
        joints: those whose reaction is wanted.
    """

    def __init__(self, scene: Scene, joints: Sequence[str]) -> None:
        self._scenario, self._wanted = scene.scenario, joints
        scenario = scene.scenario
        self._trees = {r: js for r, js in trees(scenario).items() if not set(js).isdisjoint(joints)}
        self._mounts = {name: mount_of(scenario, joint) for name, joint in scenario.joints.items()}
        self._rotors = rotors_of(scenario)
        self._mass = {n: float(b.mass_kg or 0.0) for n, b in scenario.moving_bodies().items()}
        self._rates = {
            name: f"{name}.{MOVABLE[joint.type][1]}"
            for name, joint in scenario.movable_joints().items()
        }
        self._moments = {name: scene.moments(name) for name in self._mass}

    def forces(
        self,
        signals: dict[str, Array],
        efforts: Mapping[str, Array],
        recoil: Array,
        count: int,
    ) -> dict[str, Array]:
        """Surplus of each joint's force on its child, in the child's frame [N] (n, 3).

        Args:
            signals: motion of the free bodies and of the joints before each step.
            efforts: given to joints in it.
            recoil: of armatures (n, rotors, 4): torque about the axis on the parent, and torque on
                the child in its frame.
            count: number of steps.
        """
        found = {}
        for root, joints in self._trees.items():
            loose = self._without_contacts(root, joints, signals, (efforts, recoil), count)
            reach, mass, force, motions = self._equations(root, joints, loose, count, second=True)
            freedoms = np.asarray(-np.linalg.solve(mass, force)[:, :, 0], dtype=float)
            pulls = {
                name: self._mass[name] * (_times(shift, freedoms) + linear)
                for name, (_, shift, _, linear) in reach.items()
                if name in self._mass
            }
            for name in reversed(joints):
                joint = self._scenario.joints[name]
                if joint.parent in pulls:
                    pulls[joint.parent] = pulls[joint.parent] + pulls[joint.child]
                if name in self._wanted:
                    turned = conjugate(motions[joint.child][1])
                    found[name] = rotate(turned, pulls[joint.child])
        return found

    def _without_contacts(
        self,
        root: str,
        joints: Sequence[str],
        signals: Mapping[str, Array],
        given: tuple[Mapping[str, Array], Array],
        count: int,
    ) -> dict[str, Array]:
        """The motion that the second pass starts from: the velocities that the first one gave."""
        reach, mass, force, motions = self._equations(root, joints, signals, count, second=False)
        drive = -force[:, :, 0]
        for name in reach:
            if name in self._mass:
                _, shift, _, _ = reach[name]
                pull = self._weight_and_drag(name, motions[name][2])
                drive += _times(shift.transpose(0, 2, 1), pull)
        for i, rotor in enumerate(self._rotors):
            on_parent = given[1][:, i, :1] * rotor.parent_axis
            for body, torque in ((rotor.parent, on_parent), (rotor.child, given[1][:, i, 1:])):
                if body in reach:
                    turn, *_ = reach[body]
                    drive += _times(turn.transpose(0, 2, 1), rotate(motions[body][1], torque))
        movable = [name for name in joints if name in self._rates]
        first = mass.shape[1] - len(movable)
        for column, name in enumerate(movable, start=first):
            drive[:, column] += given[0].get(name, 0.0)
        step_s = self._scenario.world.engine_step_s
        change = step_s * np.linalg.solve(mass, drive[:, :, None])[:, :, 0]
        found = dict(signals)
        for column, name in enumerate(movable, start=first):
            found[self._rates[name]] = signals[self._rates[name]] + change[:, column]
        if first:
            velocity, rate = (signals[f"{root}.{part}"] for part in ("velocity_m_s", "rate_rad_s"))
            turned = step_s * cross(rate, velocity)
            found[f"{root}.velocity_m_s"] = velocity + change[:, 3:6] + turned
            found[f"{root}.rate_rad_s"] = rate + change[:, :3]
        return found

    def _weight_and_drag(self, body: str, velocity: Array) -> Array:
        weight = self._mass[body] * np.array(self._scenario.world.gravity_m_s2)
        found: Array = np.tile(weight, (len(velocity), 1))
        drag = self._scenario.bodies[body].drag
        if drag is not None:
            speed = np.linalg.norm(velocity, axis=1, keepdims=True)
            found = found - drag.factor_kg_m * speed * velocity
        return np.asarray(found, dtype=float)

    def _equations(
        self,
        root: str,
        joints: Sequence[str],
        signals: Mapping[str, Array],
        count: int,
        *,
        second: bool,
    ) -> tuple[dict[str, Reach], Array, Array, dict[str, Motion]]:
        """How the bodies move with the freedoms u of the tree, and M and f in M·u + f = 0.

        f is what the accelerations and torques need that are there while u rests.
        """
        signals = dict(signals)
        add_children(self._scenario, signals, count)
        motions = {name: self._motion(name, signals, count) for name in self._scenario.bodies}
        reach = self._reach_of_all(root, joints, motions, signals)
        columns = reach[root][0].shape[2]
        mass, force = np.zeros((count, columns, columns)), np.zeros((count, columns, 1))
        for name in reach:
            if name not in self._mass:
                continue
            turn, shift, alpha, linear = reach[name]
            _, orientation, velocity, rate = motions[name]
            spin, heavy = self._spin(name, orientation), self._mass[name]
            torque = _times(spin, alpha) + cross(rate, _times(spin, rate))
            again = name == root or not second
            pull = heavy * (linear + cross(rate, velocity) if again else linear)
            back, down = turn.transpose(0, 2, 1), shift.transpose(0, 2, 1)
            mass += back @ spin @ turn + heavy * (down @ shift)
            force += back @ torque[:, :, None] + down @ pull[:, :, None]
        return reach, mass, force, motions

    def _motion(self, body: str, signals: Mapping[str, Array], count: int) -> Motion:
        still = self._scenario.bodies[body]
        p, o, v, r = (
            signals.get(f"{body}.{part}", np.tile(getattr(still, part), (count, 1)))
            for part in BODY_SIGNALS
        )
        return p, o, v, r

    def _reach_of_all(
        self,
        root: str,
        joints: Sequence[str],
        motions: Mapping[str, Motion],
        signals: Mapping[str, Array],
    ) -> dict[str, Reach]:
        count, first = len(motions[root][0]), 6 if root in self._mass else 0
        movable = [name for name in joints if name in self._rates]
        turn, shift = (np.zeros((count, 3, first + len(movable))) for _ in range(2))
        if first:
            turn[:, :, :3] = shift[:, :, 3:6] = np.eye(3)
        zero = np.zeros((count, 3))
        found = {root: (turn, shift, zero, zero)}
        for name in joints:
            joint = self._scenario.joints[name]
            above, below = motions[joint.parent], motions[joint.child]
            fixed = _carried(found[joint.parent], below[0] - above[0])
            if name in movable:
                column, rate = first + movable.index(name), signals[self._rates[name]]
                fixed = self._moved(name, column, fixed, (above, below), rate)
            found[joint.child] = fixed
        return found

    def _moved(
        self, name: str, column: int, fixed: Reach, motions: tuple[Motion, Motion], rate: Array
    ) -> Reach:
        """Adds a joint's own freedom and Coriolis acceleration to what its parent gives."""
        (place, _, velocity, spin), (position, orientation, _, _) = motions
        mount, (turn, shift, alpha, linear) = self._mounts[name], fixed
        turn, shift = turn.copy(), shift.copy()
        axis = rotate(orientation, np.tile(mount.axis, (len(position), 1)))
        moved = axis * rate[:, None]
        if self._scenario.joints[name].type == "slider":
            shift[:, :, column] = axis
            return turn, shift, alpha, linear + cross(spin, moved)
        arm = -rotate(orientation, np.tile(mount.anchor_m, (len(position), 1)))
        turn[:, :, column], shift[:, :, column] = axis, cross(axis, arm)
        carried = velocity + cross(spin, position - place)
        coriolis = cross(carried, moved) + cross(spin, cross(moved, arm))
        return turn, shift, alpha + cross(spin, moved), linear + coriolis

    def _spin(self, body: str, orientation: Array) -> Array:
        """Tensors of inertia in the world's frame (n, 3, 3)."""
        count = len(orientation)
        axes = [rotate(orientation, np.tile(unit, (count, 1))) for unit in np.eye(3)]
        turned = np.stack(axes, axis=2)
        moments = np.asarray(self._moments[body], dtype=float)
        return np.asarray((turned * moments) @ turned.transpose(0, 2, 1), dtype=float)


def _carried(parent: Reach, away: Array) -> Reach:
    """How what is fixed to a parent moves, ``away`` from its centre."""
    turn, shift, alpha, linear = parent
    swung = cross(turn.transpose(0, 2, 1), away[:, None, :]).transpose(0, 2, 1)
    return turn, shift + swung, alpha, linear + cross(alpha, away)


def _times(matrices: Array, vectors: Array) -> Array:
    return np.asarray((matrices @ vectors[:, :, None])[:, :, 0], dtype=float)
