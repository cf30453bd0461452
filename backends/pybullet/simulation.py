"""Stepping and reading a physics client of PyBullet."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from simcompare.backends.pybullet.world import BASE, MAX_SPEED, ORIGIN, SWEEPS, Client, World
from simcompare.kit import (
    TUNED,
    Array,
    Audit,
    FreeCoordinates,
    Held,
    Keeper,
    Numbers,
    ReducedSimulation,
    Scene,
    Table,
    Vector,
    turned_back,
    unreadable,
)

#: asks for the nearest hit of a ray; numbers from 0 on for each of them, in any order
FIRST_HIT = -1
#: what is set where everything is given: value, and PyBullet's default
_SET: dict[str, tuple[float, float | None]] = {
    "contactSlop": (0.0, 1e-5),
    "restitutionVelocityThreshold": (0.0, 0.2),
    "linearDamping": (0.0, 0.04),
    "angularDamping": (0.0, 0.04),
    "maxJointVelocity": (MAX_SPEED, 100.0),
}
#: the same where something bounces
_SET_BOUNCING: dict[str, tuple[float, float | None]] = {"erp": (0.0, 0.2), "contactERP": (0.0, 0.2)}


class PybulletSimulation(ReducedSimulation):
    """A physics client with its bodies."""

    FREE = FreeCoordinates("xyzw")

    def __init__(self, engine: Any, scene: Scene) -> None:
        super().__init__(scene)
        self._bullet = Client(engine)
        self.take_step = self._bullet.stepSimulation
        self._states = Keeper(self._bullet.removeState)

    def set_up(self) -> None:
        self.built = World(self._bullet, self.scene)
        self._driven = [self.built.joints[name] for name in self.driven or ()]

    def set_engine_step(self, step_s: float) -> None:
        self._bullet.setTimeStep(step_s)

    def get(self, name: str) -> tuple[Numbers, Numbers]:
        if name in self._joints:
            coordinate, speed, *_ = self._bullet.getJointState(*self.built.joints[name])
            return [coordinate], [speed]
        uid, _ = self.built.bodies[name]
        pose = self._bullet.getBasePositionAndOrientation(uid)
        motion = self._bullet.getBaseVelocity(uid)
        return (*pose[0], *pose[1]), (*motion[0], *motion[1])

    def put(self, name: str, q: Numbers | None, v: Numbers) -> None:
        if name in self._joints:
            self._bullet.resetJointState(*self.built.joints[name], *(q or self.get(name)[0]), *v)
        else:
            uid, _ = self.built.bodies[name]
            if q is not None:
                self._bullet.resetBasePositionAndOrientation(uid, q[:3], q[3:])
            self._bullet.resetBaseVelocity(uid, v[:3], v[3:])

    def origin_of(self, body: str) -> Vector:
        (uid, link), bullet = self.built.bodies[body], self._bullet
        position: Vector = (
            bullet.getBasePositionAndOrientation(uid)[0] if link == BASE
            else bullet.getLinkState(uid, link, 0, 1)[0]
        )  # fmt: skip
        return position

    def spin_of(self, body: str) -> Numbers:
        _, (x, y, z, w), *_, rate = self._bullet.getLinkState(*self.built.bodies[body], 1, 1)
        return turned_back((w, x, y, z), rate)

    def give(self, efforts: Sequence[float]) -> None:
        control, mode = self._bullet.setJointMotorControl2, self._bullet.TORQUE_CONTROL
        for place, effort in zip(self._driven, efforts, strict=True):
            control(*place, mode, force=effort)

    def push(self, body: str, force: Vector) -> None:
        self._bullet.applyExternalForce(
            *self.built.bodies[body], force, self.origin_of(body), self._bullet.WORLD_FRAME
        )

    def twist(self, body: str, torque: Vector) -> None:
        self._bullet.applyExternalTorque(*self.built.bodies[body], torque, self._bullet.LINK_FRAME)

    def joint_force(self, joint: str) -> Vector:
        _, _, (x, y, z, *_), motor = self._bullet.getJointState(*self.built.joints[joint])
        # the friction of a slider acts as the force of a motor, which is no part of the reaction
        held = self.scene.joints[joint]
        a, b, c = held.mount.axis if held.joint.type == "slider" else ORIGIN
        return x + motor * a, y + motor * b, z + motor * c

    def cast_rays(
        self, origin_m: Vector, directions: Array, without_body: str, reach_m: float
    ) -> Sequence[float]:
        own = self.built.bodies.get(without_body)
        ends = (np.asarray(origin_m) + reach_m * directions).tolist()
        found, left, number = [math.inf] * len(ends), [*range(len(ends))], FIRST_HIT
        while left:  # what lies behind the own body is told as one hit after another
            hits = self._bullet.rayTestBatch(
                [origin_m] * len(left), [ends[i] for i in left], reportHitNumber=number
            )
            for i, (uid, link, fraction, *_) in zip(left, hits, strict=True):
                if uid >= 0 and (uid, link) != own:
                    found[i] = min(found[i], reach_m * fraction)
            is_met = [uid >= 0 for uid, *_ in hits]
            if number == FIRST_HIT:
                is_met = [own is not None and hit[:2] == own for hit in hits]
            left, number = [i for i, met in zip(left, is_met, strict=True) if met], number + 1
        return found

    def contact_points(self, first: str, second: str) -> Iterable[tuple[float, float]]:
        (uid, link), (other, end) = self.built.bodies[first], self.built.bodies[second]
        return [
            (point[9], point[8]) for point in self._bullet.getContactPoints(uid, other, link, end)
        ]

    def record(self, count: int) -> Any:
        """The core's loop, with as little around it as can be for a single body."""
        if not self.is_plain:
            return super().record(count)
        ((uid, _),) = (self.built.bodies[name] for name in self._free)
        engine, client, rows = self._bullet.engine, self._bullet.number, []
        step, pose, motion = (
            engine.stepSimulation, engine.getBasePositionAndOrientation, engine.getBaseVelocity
        )  # fmt: skip
        for _ in range(count):
            step(client)
            position, orientation = pose(uid, client)
            velocity, rate = motion(uid, client)
            rows.append((*position, *orientation, *velocity, *rate))
        return rows

    def forget_placed(self) -> None:
        """Has Bullet forget its points of contact, by telling it anew which bodies may touch."""
        self.built.filter(self.built.touching, touch=True)
        # the new ones are found at once, as a copy without any is not brought back exactly
        self._bullet.performCollisionDetection()

    def snapshot(self) -> object:
        """PyBullet's own copy, which also has the points of contact, and whether there are any."""
        return self._states.hold(self._bullet.saveState()), bool(self._bullet.getContactPoints())

    def take_back(self, snapshot: Any) -> None:
        kept, has_points = snapshot
        self._bullet.restoreState(kept.number)
        if not has_points:  # then PyBullet leaves those that there are
            self.built.filter(self.built.touching, touch=True)

    def release(self) -> None:
        self._states.close()
        self._bullet.disconnect()

    def held_of_world(self) -> Table:
        held = self._bullet.getPhysicsEngineParameters()
        axes = [f"gravityAcceleration{axis}" for axis in "XYZ"]
        return {
            "step_s": Held("fixedTimeStep", held["fixedTimeStep"]),
            "gravity_m_s2": [
                Held(one, [held[axis] if axis == one else None for axis in axes]) for one in axes
            ],
        }

    def held_of_body(self, body: str) -> Table:
        place, shapes = self.built.bodies[body], self.scene.shapes[body]
        mass, _, moments, *_ = self._bullet.getDynamicsInfo(*place)
        solids = self._bullet.getCollisionShapeData(*place)
        armature = "with the armature of its hinge" if self.scene.armature_on(body) else ""
        rim = "one of two rims that stand for the cylinder" if len(shapes) > 1 else ""
        # of cylinders and capsules PyBullet tells the length first
        sizes = [
            {"sphere": size[:1], "box": size}.get(shape.type, size[1::-1])
            for shape, (_, _, _, size, *_) in zip(shapes, solids, strict=True)
        ]
        return {
            "mass_kg": Held("mass", mass),
            "inertia_kg_m2": Held(
                "localInertiaDiagonal", moments, self.scene.moments(body), armature
            ),
            "position_m": Held("basePosition", self.origin_of(body)),
            "size_m": [Held("getCollisionShapeData", size, note=rim) for size in sizes],
        }

    def held_of_joint(self, joint: str) -> Table:
        info, held = self._bullet.getJointInfo(*self.built.joints[joint]), self.scene.joints[joint]
        child, along = held.joint.child, [abs(part) for part in held.mount.axis]
        axis, note = along.index(max(along)), "added to this moment; assisted gives the recoil"
        moment = self._bullet.getDynamicsInfo(*self.built.bodies[child])[2][axis]
        return {
            "anchor_m": Held("parentFramePos", info[14]),
            "axis": Held("jointAxis, in the child's frame", info[13]),
            "friction": unreadable("VELOCITY_CONTROL force", "most of a motor towards rest"),
            "armature": Held(
                f"localInertiaDiagonal of {child}", moment, self.scene.moments(child)[axis], note
            ),
            **dict.fromkeys(
                ("stiffness", "rest", "damping"),
                unreadable("TORQUE_CONTROL", "an effort, given anew before each step"),
            ),
        }

    def held_of_pair(self, first: str, second: str) -> Table:
        infos = {n: self._bullet.getDynamicsInfo(*self.built.bodies[n]) for n in (first, second)}
        put, note = self.built.coefficients, "Bullet multiplies the two"
        parts = {"restitution": ("restitution", 5), "friction": ("lateralFriction", 1)}
        return {
            kind: [Held(f"{of} of {n}", infos[n][i], put[of].get(n), note) for n in infos]
            for kind, (of, i) in parts.items()
        }

    def own_parameters(self, audit: Audit) -> None:
        is_tuned, given = self.scene.gives(TUNED), self.scene.contacts.are_given
        if self.built.is_iterated:
            sweeps = self._bullet.getPhysicsEngineParameters()["numSolverIterations"]
            audit.add(
                "solver", None, "numSolverIterations", (SWEEPS if is_tuned else None, sweeps), "1"
            )
        for name in self._joints:
            damping = self._bullet.getJointInfo(*self.built.joints[name])[6]
            audit.add(
                f"{name}.jointDamping", None, "jointDamping", (0 if is_tuned else None, damping),
                "SI", "the engine's own; damping is an effort",
            )  # fmt: skip
            if not self.scene.joints[name].law.friction:
                motor = {"VELOCITY_CONTROL force": (0.0, None)}
                audit.add_without_getter(f"{name}.friction", motor, is_given=given, stated=0.0)
        usual = {
            **_SET, **(_SET_BOUNCING if self.scene.contacts.bounces else {}),
            "contactProcessingThreshold": (self.scene.contact_gap_m, None),
        }  # fmt: skip
        own = {
            name: (value, None)
            for part in (*self.built.recipe, dict(self.scene.settings.own))
            for name, value in part.items()
        }
        other = {k: v for k, v in usual.items() if k not in own}
        audit.add_without_getter("contact", other, is_given=is_tuned)
        audit.add_without_getter("contact", own, is_given=True)
