"""PyBullet in DIRECT mode; every run has its own client and sets all global parameters itself."""

from __future__ import annotations

from types import ModuleType
from typing import Any

import numpy as np

from simcompare.audit import Audit
from simcompare.backend import MAPPED, SPATIAL_RIGID_BODIES, EngineBackend, KnownLimit, Settings
from simcompare.errors import EngineBroken
from simcompare.landing import ContactSteps
from simcompare.pairs import per_body_product, refuse_offsets, touching_pairs
from simcompare.scenario import Body, Scenario
from simcompare.shapes import Shape, Vector
from simcompare.free_motion import has_drag
from simcompare.simulation import Simulation
from simcompare.state import BodyState
from simcompare.trajectory import Array

#: longest step during an impact [s]; the bias g·dt/v of reduced coordinates stays below 1e-4 down
#: to 0.2 m/s
CONTACT_STEP_S = 2.0e-6
#: longest step at rest [s]: without error reduction a body rests up to g·dt² deep
REST_STEP_S = 2.5e-4


class PybulletSimulation(Simulation):
    """A physics client with its bodies."""

    def __init__(
        self,
        engine: ModuleType,
        client: int,
        ids: dict[str, int],
        scenario: Scenario,
        audit: Audit,
        mapped: bool,
    ) -> None:
        steps = ContactSteps(-0.5, CONTACT_STEP_S, rest_step_s=REST_STEP_S) if mapped else None
        super().__init__(scenario, audit.finish(), steps)
        self._bullet, self._client, self._ids = engine, client, ids
        self._moving = [ids[name] for name in self._bodies]
        self._dragged = any(has_drag(body) for body in self._bodies.values())

    def advance(self, count: int) -> None:
        step, client = self._bullet.stepSimulation, self._client
        for _ in range(count):
            if self._dragged:
                self._apply_drag()
            step(client)

    def _apply_drag(self) -> None:
        bullet, client = self._bullet, self._client
        for name, force in self.drag_forces():
            position, _ = bullet.getBasePositionAndOrientation(self._ids[name], client)
            bullet.applyExternalForce(
                self._ids[name], -1, force, position, bullet.WORLD_FRAME, physicsClientId=client
            )

    def set_engine_step(self, step_s: float) -> None:
        self._bullet.setTimeStep(step_s, self._client)

    def stored_motion(self, body: str) -> tuple[Vector, Vector]:
        uid = self._ids[body]
        position: Vector = self._bullet.getBasePositionAndOrientation(uid, self._client)[0]
        velocity: Vector = self._bullet.getBaseVelocity(uid, self._client)[0]
        return position, velocity

    def add_velocity(self, body: str, change_m_s: Vector) -> None:
        uid = self._ids[body]
        linear, angular = self._bullet.getBaseVelocity(uid, self._client)
        moved = [v + dv for v, dv in zip(linear, change_m_s, strict=True)]
        self._bullet.resetBaseVelocity(uid, moved, angular, self._client)

    def place(self, body: str, state: BodyState) -> None:
        uid, client = self._ids[body], self._client
        w, x, y, z = state.orientation_wxyz
        self._bullet.resetBasePositionAndOrientation(uid, state.position_m, (x, y, z, w), client)
        self._bullet.resetBaseVelocity(uid, state.velocity_m_s, state.rate_rad_s, client)

    def row(self) -> tuple[float, ...]:
        pose, motion, client = (
            self._bullet.getBasePositionAndOrientation,
            self._bullet.getBaseVelocity,
            self._client,
        )
        values: tuple[float, ...] = ()
        for uid in self._moving:
            position, orientation = pose(uid, client)
            linear, angular = motion(uid, client)
            values += (*position, *orientation, *linear, *angular)
        return values

    def record(self, count: int) -> Any:
        if self._dragged or len(self._moving) != 1:
            return super().record(count)
        bullet, client, uid = self._bullet, self._client, self._moving[0]
        step, pose, motion = (
            bullet.stepSimulation,
            bullet.getBasePositionAndOrientation,
            bullet.getBaseVelocity,
        )
        rows = []
        for _ in range(count):
            step(client)
            position, orientation = pose(uid, client)
            linear, angular = motion(uid, client)
            rows.append((*position, *orientation, *linear, *angular))
        return rows

    def motions(self, rows: Array) -> dict[str, Array]:
        found: dict[str, Array] = {}
        for i, name in enumerate(self._bodies):
            part = rows[:, 13 * i : 13 * i + 13]
            found[f"{name}.position_m"] = part[:, :3].copy()
            found[f"{name}.orientation_wxyz"] = np.roll(part[:, 3:7], 1, axis=1)
            found[f"{name}.velocity_m_s"] = part[:, 7:10].copy()
            found[f"{name}.rate_rad_s"] = part[:, 10:].copy()
        return found

    def close(self) -> None:
        self._bullet.disconnect(self._client)


class PybulletBackend(EngineBackend):
    """Bullet 3 through the package ``pybullet``."""

    name = "pybullet"
    module = "pybullet"
    distribution = "pybullet"
    install = "pip install 'simcompare[pybullet]'"
    features = SPATIAL_RIGID_BODIES
    known_limits = (
        KnownLimit(
            "Restitution is 0 by default, and bodies lose 4 % of their speed a second to damping.",
            "Bullet Physics SDK, btMultiBody; PyBullet Quickstart Guide, changeDynamics",
        ),
        KnownLimit(
            "With a restitution set and all else left alone, the bounce depends on where in the"
            " step the impact falls: 0.42 to 0.85 for 0.8, as contacts act that are still apart.",
            "measured over the impact phase; bulletphysics/bullet3 issues 1530, 3094",
        ),
        KnownLimit(
            "A contact slop of 10 µm, on by default, swallows the bounce at steps below 0.1 ms.",
            "measured: e = 0.5 gave 0.21 at 20 µs until contactSlop was set to 0",
        ),
        KnownLimit(
            "Bodies in reduced coordinates bounce with e·(1 + g·dt/v); bodies in maximal"
            " coordinates do not, but then neither restitution nor friction can be read back.",
            "measured; getDynamicsInfo returns the defaults for them whatever was set",
        ),
        KnownLimit(
            "Damping, contact thresholds and solver parameters have setters and no getters.",
            "PyBullet Quickstart Guide, getDynamicsInfo, getPhysicsEngineParameters",
        ),
    )
    mapping = (
        "restitution of the moving body = e, of the fixed one = 1 (Bullet multiplies);"
        " contactProcessingThreshold = 0, contactSlop = 0, erp = contactERP = 0,"
        " restitutionVelocityThreshold = 0, damping = 0; impacts in steps of at most 2 µs"
    )

    def build(self, engine: ModuleType, scenario: Scenario, settings: Settings) -> Simulation:
        refuse_offsets(scenario, self.name, shapes=1)
        client = engine.connect(engine.DIRECT)
        if client < 0:
            raise EngineBroken("pybullet opened no physics client")
        try:
            mapped = settings.contact == MAPPED
            return _build(engine, client, scenario, mapped)
        except BaseException:
            engine.disconnect(client)
            raise


BACKEND = PybulletBackend()


def _build(engine: ModuleType, client: int, scenario: Scenario, mapped: bool) -> Simulation:
    world = scenario.world
    engine.setGravity(*world.gravity_m_s2, physicsClientId=client)
    engine.setTimeStep(world.step_s, client)
    if mapped:
        bounces = any(contact.restitution > 0 for contact in scenario.contacts)
        engine.setPhysicsEngineParameter(
            # without error reduction a bounce gets no energy from penetration; stacks need it
            **({"erp": 0, "contactERP": 0} if bounces else {}),
            contactSlop=0,
            restitutionVelocityThreshold=0,
            physicsClientId=client,
        )
    restitution = per_body_product(scenario, "restitution", "pybullet") if mapped else {}
    friction = per_body_product(scenario, "friction", "pybullet") if mapped else {}
    audit = Audit("pybullet")
    _audit_world(engine, client, audit, scenario)
    ids = {}
    for name, body in scenario.bodies.items():
        uid = _add_body(engine, client, body)
        ids[name] = uid
        if mapped:
            engine.changeDynamics(
                uid, -1, restitution=restitution[name], lateralFriction=friction[name],
                linearDamping=0, angularDamping=0, contactProcessingThreshold=0,
                physicsClientId=client,
            )  # fmt: skip
        _audit_body(engine, client, audit, (name, uid), body)
    _audit_contacts(engine, client, audit, scenario, ids, (restitution, friction))
    return PybulletSimulation(engine, client, ids, scenario, audit, mapped)


def _add_body(engine: ModuleType, client: int, body: Body) -> int:
    shapes = [_shape(engine, client, shape) for shape in body.shapes]
    w, x, y, z = body.orientation_wxyz
    uid: int = engine.createMultiBody(
        body.mass_kg or 0.0,
        shapes[0] if shapes else -1,
        -1,
        body.position_m,
        (x, y, z, w),
        physicsClientId=client,
    )
    if not body.fixed:
        # mass again with the inertia: setting the inertia alone has been seen to lose the mass
        engine.changeDynamics(
            uid, -1, mass=body.mass_kg, localInertiaDiagonal=body.inertia_kg_m2,
            physicsClientId=client,
        )  # fmt: skip
        engine.resetBaseVelocity(uid, body.velocity_m_s, body.rate_rad_s, client)
    return uid


def _shape(engine: ModuleType, client: int, shape: Shape) -> int:
    pose: dict[str, Any] = {"collisionFramePosition": shape.position_m, "physicsClientId": client}
    if shape.type != "plane":
        w, x, y, z = shape.orientation_wxyz
        pose["collisionFrameOrientation"] = (x, y, z, w)
    create = engine.createCollisionShape
    match shape.type:
        case "plane":
            uid = create(engine.GEOM_PLANE, planeNormal=shape.normal, **pose)
        case "sphere":
            uid = create(engine.GEOM_SPHERE, radius=shape.radius_m, **pose)
        case "box":
            uid = create(engine.GEOM_BOX, halfExtents=[e / 2 for e in shape.size_m], **pose)
        case "cylinder":
            size = {"radius": shape.radius_m, "height": shape.length_m}
            uid = create(engine.GEOM_CYLINDER, **size, **pose)
        case _:
            size = {"radius": shape.radius_m, "height": shape.length_m}
            uid = create(engine.GEOM_CAPSULE, **size, **pose)
    return int(uid)


def _audit_world(engine: ModuleType, client: int, audit: Audit, scenario: Scenario) -> None:
    held = engine.getPhysicsEngineParameters(client)
    step = scenario.world.step_s
    audit.add("step_s", step, "fixedTimeStep", (step, held["fixedTimeStep"]), "s")
    for axis, wanted in zip("xyz", scenario.world.gravity_m_s2, strict=True):
        parameter = f"gravityAcceleration{axis.upper()}"
        audit.add(f"gravity_m_s2.{axis}", wanted, parameter, (wanted, held[parameter]), "m/s²")


def _audit_body(
    engine: ModuleType, client: int, audit: Audit, name_uid: tuple[str, int], body: Body
) -> None:
    name, uid = name_uid
    if body.fixed:
        return
    info = engine.getDynamicsInfo(uid, -1, client)
    audit.add(f"{name}.mass_kg", body.mass_kg, "mass", (body.mass_kg, info[0]), "kg")
    for axis, wanted, got in zip("123", body.inertia_kg_m2 or (), info[2], strict=True):
        quantity = f"{name}.inertia_kg_m2.{axis}"
        audit.add(quantity, wanted, "localInertiaDiagonal", (wanted, got), "kg·m²")
    position = engine.getBasePositionAndOrientation(uid, client)[0]
    for axis, wanted, got in zip("xyz", body.position_m, position, strict=True):
        audit.add(f"{name}.position_m.{axis}", wanted, "basePosition", (wanted, got), "m")
    for shape in body.shapes:
        held = engine.getCollisionShapeData(uid, -1, client)[0][3]
        # cylinders and capsules: length first
        order = {"plane": [], "sphere": held[:1], "box": held}.get(shape.type, [held[1], held[0]])
        audit.add_sizes(name, shape, "getCollisionShapeData", order)


def _audit_contacts(
    engine: ModuleType,
    client: int,
    audit: Audit,
    scenario: Scenario,
    ids: dict[str, int],
    per_body: tuple[dict[str, float], dict[str, float]],
) -> None:
    restitution, friction = per_body
    for contact in touching_pairs(scenario):
        for name in contact.pair:
            info = engine.getDynamicsInfo(ids[name], -1, client)
            note = "Bullet multiplies the two" if restitution else "engine's default"
            pair = "-".join(contact.pair)
            values = (restitution.get(name), info[5])
            quantity = f"{pair} restitution"
            parameter = f"restitution of {name}"
            audit.add(quantity, contact.restitution, parameter, values, "1", note)
            values = (friction.get(name), info[1])
            parameter = f"lateralFriction of {name}"
            audit.add(f"{pair} friction", contact.friction, parameter, values, "1", note)
    for parameter, default in _NO_GETTER.items():
        note = "PyBullet has no getter for it"
        if not restitution:
            note += "; left at its default" + (f" of {default:g}" if default else "")
        audit.add("contact", None, parameter, (0.0 if restitution else None, None), "", note)


#: parameters that are set in mapped mode and cannot be read back, with their defaults as known
_NO_GETTER = {
    "contactSlop": 1e-5,
    "restitutionVelocityThreshold": 0.2,
    "linearDamping": 0.04,
    "angularDamping": 0.04,
    "contactProcessingThreshold": None,
}
