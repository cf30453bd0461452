"""Stepping and reading a DART world."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from simcompare.backends.dart.variants import DETECTOR, SOLVER
from simcompare.backends.dart.world import FRICTION_TOLERANCE, build, parts_of
from simcompare.kit import (
    TUNED,
    Array,
    Audit,
    FreeCoordinates,
    Held,
    Numbers,
    ReducedSimulation,
    Scene,
    Table,
    Vector,
    unreadable,
)


class DartSimulation(ReducedSimulation):
    """A world and the skeletons in it that move."""

    # a free joint's velocities are in the world's frame, turning first (measured with 6.20)
    FREE = FreeCoordinates("vector", rotation_first=True)

    def __init__(self, dart: Any, scene: Scene) -> None:
        super().__init__(scene)
        self.built = build(dart, scene)
        self._dart, self._ray_groups = dart, dict[str, Any]()
        self._world, self._nodes = self.built.world, self.built.nodes
        self.take_step = self._world.step
        self._width, first = sum(tree.getNumDofs() for tree in self.built.trees), 0
        # a row holds all positions, then all velocities
        self._readers, firsts = [], {}
        for tree in filter(lambda tree: tree.getNumDofs(), self.built.trees):
            firsts[tree.getName()], end = first, first + tree.getNumDofs()
            rates = slice(first + self._width, end + self._width)
            self._readers += [(slice(first, end), tree.getPositions), (rates, tree.getVelocities)]
            first = end
        for name in self.slots:
            joint = self.built.joints[name]
            first = firsts[joint.getSkeleton().getName()] + joint.getIndexInSkeleton(0)
            self.slots[name] = (first, self._width + first)
        self._driven = [self.built.joints[name] for name in self.driven or ()]
        self._touching: dict[tuple[Any, Any], frozenset[str]] = {}
        self.place_all()

    def set_engine_step(self, step_s: float) -> None:
        self._world.setTimeStep(step_s)

    def get(self, name: str) -> tuple[Numbers, Numbers]:
        joint = self.built.joints[name]
        return joint.getPositions().tolist(), joint.getVelocities().tolist()

    def put(self, name: str, q: Numbers | None, v: Numbers) -> None:
        joint = self.built.joints[name]
        if q is not None:
            joint.setPositions(q)
        joint.setVelocities(v)

    def origin_of(self, body: str) -> Vector:
        x, y, z = self._nodes[body].getWorldTransform().translation().tolist()
        return x, y, z

    def give(self, efforts: Sequence[float]) -> None:
        for joint, effort in zip(self._driven, efforts, strict=True):
            joint.setForce(0, effort)

    def push(self, body: str, force: Vector) -> None:
        self._nodes[body].addExtForce(force)

    def twist(self, body: str, torque: Vector) -> None:
        self._nodes[body].addExtTorque(np.array(torque), True)

    def spin_of(self, body: str) -> Numbers:
        return [*self._nodes[body].getSpatialVelocity().tolist()[:3]]

    def joint_force(self, joint: str) -> Vector:
        # torque and force by the parent on the child, in the child's frame
        child = self.scenario.joints[joint].child
        _, _, _, x, y, z = self._nodes[child].getBodyForce().tolist()
        return x, y, z

    def contact_forces(self) -> dict[frozenset[str], float]:
        found: dict[frozenset[str], float] = {}
        for contact in self._world.getLastCollisionResult().getContacts():
            objects = (contact.collisionObject1, contact.collisionObject2)
            pair = self._touching.get(objects)
            if pair is None:
                bodies = [self.built.owners[one.getShapeFrame()] for one in objects]
                pair = self._touching[objects] = frozenset(bodies)
            found[pair] = found.get(pair, 0.0) + contact.force.dot(contact.normal)
        return found

    def cast_rays(
        self, origin_m: Vector, directions: Array, without_body: str, reach_m: float
    ) -> Sequence[float]:
        group = self._ray_groups.get(without_body) or self._group_without(without_body)
        raycast, option = group.raycast, self._dart.collision.RaycastOption()
        origin, found = np.asarray(origin_m), []
        for end in origin + reach_m * directions:
            result = self._dart.collision.RaycastResult()
            is_met = raycast(origin, end, option, result)
            found.append(reach_m * result.mRayHits[0].mFraction if is_met else math.inf)
        return found

    def _group_without(self, body: str) -> Any:
        """What rays can meet: of DART's detectors its own casts them, and exactly."""
        group = self._dart.collision.DARTCollisionDetector().createCollisionGroup()
        group.addShapeFrames([one for one, owner in self.built.owners.items() if owner != body])
        self._ray_groups[body] = group
        return group

    def row(self) -> Any:
        row = [0.0] * (2 * self._width)
        for place, read in self._readers:
            row[place] = read().tolist()
        return row

    def record(self, count: int) -> Any:
        if self._acts or self._force_sensors or self.substeps > 1:
            return super().record(count)
        step, readers = self._world.step, self._readers
        rows = np.empty((count, 2 * self._width))
        for row in rows:
            step()
            for place, read in readers:
                row[place] = read()
        return rows

    def held_of_world(self) -> Table:
        return {
            "step_s": Held("World.timeStep", self._world.getTimeStep()),
            "gravity_m_s2": Held("World.gravity", self._world.getGravity().tolist()),
        }

    def held_of_body(self, body: str) -> Table:
        inertia, wanted = self._nodes[body].getInertia(), self.scene.inertia(body)
        note = "with the armature of its joint about the joint's axis"
        return {
            "mass_kg": Held("BodyNode.mass", self._nodes[body].getMass()),
            "inertia_kg_m2": Held(
                "Inertia.moment", np.diag(inertia.getMoment()).tolist(), np.diag(wanted).tolist(),
                note if self.scene.armature_on(body) else "",
            ),
            "position_m": Held("worldTransform", self.origin_of(body)),
            "center_of_mass_m": Held("Inertia.localCOM", inertia.getLocalCOM().tolist()),
            "size_m": [_sizes(solid.getShape()) for solid in self.built.shapes_of(body)],
        }  # fmt: skip

    def held_of_joint(self, joint: str) -> Table:
        held, law = self.built.joints[joint], self.scene.joints[joint].law
        anchor = held.getTransformFromParentBodyNode().translation().tolist()
        if joint not in self._joints:
            return {"anchor_m": Held("transformFromParent", anchor)}
        given, note = "a force on the joint in every step", "in the child's moment of inertia"
        return {
            "anchor_m": Held("transformFromParent", anchor),
            "axis": Held("axis", held.getAxis().tolist(), note="in the child's frame"),
            "friction": Held("coulombFriction", held.getCoulombFriction(0)),
            "armature": unreadable("moment", f"{note}, about the axis; read back there"),
            **{
                part: Held(part, value) if put == getattr(law, part) else unreadable(part, given)
                for part, (put, value) in self._passive(joint).items()
            },
        }

    def held_of_pair(self, first: str, second: str) -> Table:
        aspects = {
            name: self.built.shapes_of(name)[0].getDynamicsAspect() for name in (first, second)
        }
        smaller = min(aspect.getFrictionCoeff() for aspect in aspects.values())
        return {
            "friction": Held("frictionCoeff", smaller, note="DART takes the smaller"),
            "restitution": [
                Held(
                    f"restitutionCoeff of {name}", aspect.getRestitutionCoeff(),
                    self.built.restitution.get(name), "DART multiplies the two",
                )
                for name, aspect in aspects.items()
            ],
        }  # fmt: skip

    def _passive(self, joint: str) -> dict[str, tuple[float, float]]:
        """What a joint was given, and what it holds, of springs and dampers."""
        own, held = self.scene.joints[joint].own, self.built.joints[joint]
        return {
            "stiffness": (own.stiffness, held.getSpringStiffness(0)),
            "damping": (own.damping, held.getDampingCoefficient(0)),
            "rest": (own.rest, held.getRestPosition(0)),
        }

    def own_parameters(self, audit: Audit) -> None:
        is_tuned, solver = self.scene.gives(TUNED), self._world.getConstraintSolver()
        sleeps = self._world.getDeactivationOptions().mEnabled
        values: tuple[float | None, float] = (0 if is_tuned else None, sleeps)
        audit.add("sleep", 0.0, "deactivation", values, "1", "what rests falls asleep")
        parts, lcp = parts_of(self.scene), solver.getBoxedLcpSolver()
        if DETECTOR in parts:
            held = f"{solver.getCollisionDetector().getType()}CollisionDetector"
            values = (1, held.lower() == parts[DETECTOR].lower())
            audit.add("contact", None, parts[DETECTOR], values, "1", "1 means used")
        if parts.get(SOLVER) == "NsgsFrictionSolver":
            values = (FRICTION_TOLERANCE, lcp.getOptions().tolerance)
            audit.add("friction solver", None, "NsgsFrictionSolver.tolerance", values, "1")
        elif SOLVER in parts:
            values = (1, type(lcp).__name__ == parts[SOLVER])
            audit.add("contact solver", None, parts[SOLVER], values, "1", "1 means used")
        for name in self._joints:
            for part, values in self._passive(name).items():
                if values[0] != getattr(self.scene.joints[name].law, part):
                    audit.add(f"{name} DART's own {part}", None, part, values, "SI")


def _sizes(shape: Any) -> Held:
    getters = [get for get in ("getRadius", "getHeight") if hasattr(shape, get)]
    sizes = [getattr(shape, get)() for get in getters] or shape.getSize().tolist()
    return Held(shape.getType(), sizes)
