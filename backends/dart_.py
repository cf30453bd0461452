"""DART through dartpy; free bodies are skeletons of one free joint."""

from __future__ import annotations

from types import ModuleType
from typing import Any

import numpy as np

from simcompare.audit import Audit
from simcompare.backend import MAPPED, SPATIAL_RIGID_BODIES, EngineBackend, KnownLimit, Settings
from simcompare.landing import ContactSteps
from simcompare.pairs import per_body_product, touching_pairs
from simcompare.rotations import matrix_of, quaternions_of, rotation_vector_of
from simcompare.scenario import Body, Scenario
from simcompare.shapes import Shape, Vector
from simcompare.free_motion import has_drag
from simcompare.simulation import Simulation
from simcompare.state import BodyState
from simcompare.trajectory import Array

#: longest step during an impact [s]
CONTACT_STEP_S = 2.0e-6


class DartSimulation(Simulation):
    """A world with one skeleton for every body."""

    def __init__(
        self,
        world: Any,
        skeletons: dict[str, Any],
        scenario: Scenario,
        audit: Audit,
        mapped: bool,
    ) -> None:
        steps = ContactSteps(stagger=-0.5, contact_step_s=CONTACT_STEP_S) if mapped else None
        super().__init__(scenario, audit.finish(), steps)
        self._world, self._skeletons = world, skeletons
        self._moving = [skeletons[name] for name in self._bodies]
        self._dragged = any(has_drag(body) for body in self._bodies.values())

    def advance(self, count: int) -> None:
        step = self._world.step
        for _ in range(count):
            if self._dragged:
                for name, force in self.drag_forces():
                    self._skeletons[name].getBodyNode(0).addExtForce(force)
            step()

    def set_engine_step(self, step_s: float) -> None:
        self._world.setTimeStep(step_s)

    def stored_motion(self, body: str) -> tuple[Vector, Vector]:
        skeleton = self._skeletons[body]
        _, _, _, x, y, z = skeleton.getPositions().tolist()
        _, _, _, vx, vy, vz = skeleton.getVelocities().tolist()
        return (x, y, z), (vx, vy, vz)

    def add_velocity(self, body: str, change_m_s: Vector) -> None:
        skeleton = self._skeletons[body]
        skeleton.setVelocities(skeleton.getVelocities() + np.array((0, 0, 0, *change_m_s)))

    def place(self, body: str, state: BodyState) -> None:
        skeleton = self._skeletons[body]
        _set_pose(skeleton, state.position_m, state.orientation_wxyz)
        skeleton.setVelocities([*state.rate_rad_s, *state.velocity_m_s])

    def row(self) -> Any:
        parts: list[Array] = []
        for skeleton in self._moving:
            parts += (skeleton.getPositions(), skeleton.getVelocities())
        return np.concatenate(parts)

    def record(self, count: int) -> Any:
        if self._dragged or len(self._moving) != 1:
            return super().record(count)
        step, skeleton = self._world.step, self._moving[0]
        positions, velocities = skeleton.getPositions, skeleton.getVelocities
        rows = np.empty((count, 12))
        for i in range(count):
            step()
            row = rows[i]
            row[:6] = positions()
            row[6:] = velocities()
        return rows

    def motions(self, rows: Array) -> dict[str, Array]:
        found: dict[str, Array] = {}
        for i, name in enumerate(self._bodies):
            q, v = rows[:, 12 * i : 12 * i + 6], rows[:, 12 * i + 6 : 12 * i + 12]
            found[f"{name}.position_m"] = q[:, 3:].copy()
            found[f"{name}.orientation_wxyz"] = quaternions_of(q[:, :3])
            # a free joint's velocities are in the world's frame, turning first (measured with 6.20)
            found[f"{name}.velocity_m_s"] = v[:, 3:].copy()
            found[f"{name}.rate_rad_s"] = v[:, :3].copy()
        return found


class DartBackend(EngineBackend):
    """DART through the package ``dartpy``."""

    name = "dart"
    module = "dartpy"
    distribution = "dartpy"
    install = "pip install 'simcompare[dart]'"
    libraries = (("libGL.so.1", "sudo apt-get install libgl1"),)
    features = SPATIAL_RIGID_BODIES
    known_limits = (
        KnownLimit(
            "Restitution is 0 by default, on the body and on the floor; both must be set.",
            "DART DynamicsAspect::getRestitutionCoeff; measured",
        ),
        KnownLimit(
            "A bounce that would leave the floor slower than about 0.1 m/s does not happen.",
            "measured; DART ContactConstraint.cpp, DART_BOUNCING_VELOCITY_THRESHOLD",
        ),
        KnownLimit(
            "The bounce speed is taken after gravity has acted: e·(1 + g·dt/v), so small hops at"
            " a long step never die out.",
            "measured: 0.8059 at 4 ms, 0.8015 at 1 ms, 0.8004 at 0.25 ms for 0.8 and 4.4 m/s",
        ),
        KnownLimit(
            "The default collision detector (FCL) approximates cylinders; ODE's does not.",
            "measured: a wheeled robot was 14 % short with FCL, 0.1 % off with ODE",
        ),
    )
    mapping = (
        "restitution of the moving body = e, of the fixed one = 1 (DART multiplies); ODE collision"
        " detector; impacts in steps of at most 2 µs, so that the bias g·dt/v is below 1e-4 down to"
        " 0.2 m/s"
    )

    def build(self, engine: ModuleType, scenario: Scenario, settings: Settings) -> Simulation:
        mapped = settings.contact == MAPPED
        world = engine.simulation.World()
        world.setGravity(scenario.world.gravity_m_s2)
        world.setTimeStep(scenario.world.step_s)
        if mapped:
            detector = engine.collision.OdeCollisionDetector()
            world.getConstraintSolver().setCollisionDetector(detector)
        restitution = per_body_product(scenario, "restitution", self.name) if mapped else {}
        skeletons = {}
        for name, body in scenario.bodies.items():
            skeleton = _skeleton(engine, name, body)
            world.addSkeleton(skeleton)
            skeletons[name] = skeleton
            for aspect in _aspects(skeleton) if mapped else ():
                aspect.setRestitutionCoeff(restitution[name])
        if mapped:
            _set_friction(scenario, skeletons)
        audit = Audit(self.name)
        _audit_world(audit, world, scenario)
        for name, body in scenario.moving_bodies().items():
            _audit_body(audit, name, body, skeletons[name])
        _audit_contacts(audit, scenario, skeletons, restitution)
        return DartSimulation(world, skeletons, scenario, audit, mapped)


BACKEND = DartBackend()


def _skeleton(engine: ModuleType, name: str, body: Body) -> Any:
    skeleton = engine.dynamics.Skeleton(name)
    if body.fixed:
        joint, node = skeleton.createWeldJointAndBodyNodePair()
        pose = engine.math.Isometry3()
        pose.set_translation(body.position_m)
        pose.set_rotation(matrix_of(body.orientation_wxyz))
        joint.setTransformFromParentBodyNode(pose)
    else:
        _, node = skeleton.createFreeJointAndBodyNodePair()
        inertia = engine.dynamics.Inertia()
        inertia.setMass(body.mass_kg)
        inertia.setMoment(np.diag(body.inertia_kg_m2 or ()))
        inertia.setLocalCOM(body.center_of_mass_m)
        node.setInertia(inertia)
        _set_pose(skeleton, body.position_m, body.orientation_wxyz)
        skeleton.setVelocities([*body.rate_rad_s, *body.velocity_m_s])
    for shape in body.shapes:
        solid = node.createShapeNode(_shape(engine, shape))
        pose = engine.math.Isometry3()
        pose.set_translation(shape.position_m)
        if shape.type != "plane":
            pose.set_rotation(matrix_of(shape.orientation_wxyz))
        solid.setRelativeTransform(pose)
        solid.createCollisionAspect()
        solid.createDynamicsAspect()
    return skeleton


def _shape(engine: ModuleType, shape: Shape) -> Any:
    match shape.type:
        case "plane":
            return engine.dynamics.PlaneShape(shape.normal, 0.0)
        case "sphere":
            return engine.dynamics.SphereShape(shape.radius_m)
        case "box":
            return engine.dynamics.BoxShape(shape.size_m)
        case "cylinder":
            return engine.dynamics.CylinderShape(shape.radius_m, shape.length_m)
        case _:
            return engine.dynamics.CapsuleShape(shape.radius_m, shape.length_m)


def _aspects(skeleton: Any) -> list[Any]:
    node = skeleton.getBodyNode(0)
    return [node.getShapeNode(i).getDynamicsAspect() for i in range(node.getNumShapeNodes())]


def _set_friction(scenario: Scenario, skeletons: dict[str, Any]) -> None:
    """DART takes the smaller of two coefficients, so a body holds the largest of its pairs."""
    largest = dict.fromkeys(skeletons, 0.0)
    for contact in touching_pairs(scenario):
        for name in contact.pair:
            largest[name] = max(largest[name], contact.friction)
    for name, skeleton in skeletons.items():
        for aspect in _aspects(skeleton):
            aspect.setFrictionCoeff(largest[name])


def _audit_world(audit: Audit, world: Any, scenario: Scenario) -> None:
    step_s = scenario.world.step_s
    audit.add("step_s", step_s, "World.timeStep", (step_s, world.getTimeStep()), "s")
    for axis, wanted, held in zip(
        "xyz", scenario.world.gravity_m_s2, world.getGravity(), strict=True
    ):
        audit.add(f"gravity_m_s2.{axis}", wanted, "World.gravity", (wanted, held), "m/s²")


def _audit_body(audit: Audit, name: str, body: Body, skeleton: Any) -> None:
    node = skeleton.getBodyNode(0)
    audit.add(
        f"{name}.mass_kg", body.mass_kg, "BodyNode.mass", (body.mass_kg, node.getMass()), "kg"
    )
    moments = np.diag(node.getInertia().getMoment())
    for axis, wanted, got in zip("123", body.inertia_kg_m2 or (), moments, strict=True):
        quantity = f"{name}.inertia_kg_m2.{axis}"
        audit.add(quantity, wanted, "Inertia.moment", (wanted, got), "kg·m²")
    position = node.getWorldTransform().translation()
    for axis, wanted, got in zip("xyz", body.position_m, position, strict=True):
        audit.add(f"{name}.position_m.{axis}", wanted, "worldTransform", (wanted, got), "m")
    for i, shape in enumerate(body.shapes):
        held = node.getShapeNode(i).getShape()
        match shape.type:
            case "sphere":
                audit.add_sizes(name, shape, "SphereShape", [held.getRadius()])
            case "box":
                audit.add_sizes(name, shape, "BoxShape", held.getSize().tolist())
            case "cylinder" | "capsule":
                audit.add_sizes(name, shape, "shape", [held.getRadius(), held.getHeight()])


def _audit_contacts(
    audit: Audit, scenario: Scenario, skeletons: dict[str, Any], restitution: dict[str, float]
) -> None:
    note = "DART multiplies the two" if restitution else "engine's default"
    for contact in touching_pairs(scenario):
        pair = "-".join(contact.pair)
        for name in contact.pair:
            held = _aspects(skeletons[name])[0]
            values = (restitution.get(name), held.getRestitutionCoeff())
            parameter = f"restitutionCoeff of {name}"
            audit.add(f"{pair} restitution", contact.restitution, parameter, values, "1", note)
        smaller = min(_aspects(skeletons[name])[0].getFrictionCoeff() for name in contact.pair)
        values = (contact.friction if restitution else None, smaller)
        parameter = "smaller frictionCoeff"
        audit.add(f"{pair} friction", contact.friction, parameter, values, "1", note)


def _set_pose(skeleton: Any, position: Any, orientation: Any) -> None:
    skeleton.setPositions(np.concatenate((rotation_vector_of(orientation), position)))
