"""A scene as PyBullet's bodies: what joints carry becomes links of one articulated body."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from typing import Any

from simcompare.backends.pybullet.variants import VARIANTS, Recipe
from simcompare.kit import (
    TUNED,
    EngineBroken,
    Scene,
    Vector,
    minus,
    plus,
    trees,
    untouching_pairs,
    xyzw,
)

#: a body, as PyBullet calls it: number of the articulated body and of its link, -1 for its base
Place = tuple[int, int]
BASE, ORIGIN = -1, (0.0, 0.0, 0.0)
#: largest speed of any coordinate; PyBullet's own 100 m/s or rad/s would be a wall
MAX_SPEED = 1.0e9
#: the solver sweeps over contacts and joints until they move each other by 1e-12 m/s or rad/s, but
#: not for ever; by default it stops at 50 sweeps or at 3e-4
SWEEPS, RESIDUAL = 500, 1.0e-24
#: what PyBullet has to know of a shape, beside its kind and place
_SIZES: dict[str, Callable[[Any], dict[str, Any]]] = {
    "plane": lambda shape: {"planeNormal": shape.normal},
    "sphere": lambda shape: {"radius": shape.radius_m},
    "box": lambda shape: {"halfExtents": [edge / 2 for edge in shape.size_m]},
    "cylinder": lambda shape: {"radius": shape.radius_m, "height": shape.length_m},
    "capsule": lambda shape: {"radius": shape.radius_m, "height": shape.length_m},
}


class Client:
    """PyBullet's module as one physics client sees it; every run has a client of its own.

    Args:
        engine: the imported module.
    """

    def __init__(self, engine: Any) -> None:
        self.engine, self.number = engine, engine.connect(engine.DIRECT)
        if self.number < 0:
            raise EngineBroken("pybullet opened no physics client")

    def __getattr__(self, name: str) -> Any:
        found = getattr(self.engine, name)
        if callable(found) and self.number:  # client 0 is meant where none is named
            found = partial(found, physicsClientId=self.number)
        setattr(self, name, found)  # it is not looked for a second time
        return found


class World:
    """A scene in a client, with as much of it as the level gives.

    A joint's friction is a coefficient, in place of the motor that brakes each joint by default.

    Args:
        bullet: an empty client.
        scene: what is to be built.

    Attributes:
        bodies: place of every body.
        joints: place of every joint, which is that of its child.
        coefficients: what is given of restitution and friction, per body.
        touching: pairs that may touch.
        recipe: what the variant sets besides, or in place of that.
        is_iterated: whether the solver sweeps until nothing changes: with joints, and where forces
            are read.
    """

    def __init__(self, bullet: Client, scene: Scene) -> None:
        self.bullet, self.scene, self.scenario = bullet, scene, scene.scenario
        self.bodies: dict[str, Place] = {}
        self.joints: dict[str, Place] = {}
        self.coefficients = {
            "restitution": scene.contacts.restitution_per_body("product", scene.engine),
            "lateralFriction": scene.contacts.friction_per_body("product", scene.engine),
        }
        self.recipe: Recipe = VARIANTS[scene.variant].value if scene.variant else Recipe({}, {})
        self.is_iterated = bool(scene.joints or self.scenario.sensed_pairs())
        self._set_world()
        for root, joints in trees(self.scenario).items():
            members = [root, *(self.scenario.joints[joint].child for joint in joints)]
            self._add_tree(members, joints)
            for name in members:
                self._set_dynamics(name)
            for name in joints:
                self._set_joint(name)
        self._filter_contacts()

    def _set_world(self) -> None:
        bullet, scene = self.bullet, self.scene
        bullet.setGravity(*self.scenario.world.gravity_m_s2)
        bullet.setTimeStep(self.scenario.world.engine_step_s)
        if scene.gives(TUNED):
            if scene.contacts.bounces:
                # without error reduction a bounce gets no energy from penetration; stacks need it
                bullet.setPhysicsEngineParameter(erp=0, contactERP=0)
            if self.is_iterated:
                bullet.setPhysicsEngineParameter(
                    numSolverIterations=SWEEPS, solverResidualThreshold=RESIDUAL,
                    globalCFM=scene.contact_softness,
                )  # fmt: skip
            bullet.setPhysicsEngineParameter(contactSlop=0, restitutionVelocityThreshold=0)
            if scene.settings.own:
                bullet.setPhysicsEngineParameter(**dict(scene.settings.own))
        if self.recipe.world:
            bullet.setPhysicsEngineParameter(**self.recipe.world)

    def _add_tree(self, members: Sequence[str], joints: Sequence[str]) -> None:
        """One articulated body: a base and, in its order, the child of each joint."""
        bullet, base = self.bullet, self.scenario.bodies[members[0]]
        shape, links = self._shape_of(members[0], ORIGIN), self._links(members, joints)
        # by default no two bodies of a tree touch
        touches = any({*pair.bodies} <= {*members} for pair in self.scene.contacts.touching)
        uid = bullet.createMultiBody(
            base.mass_kg or 0.0, shape, -1, base.position_m, xyzw(base.orientation_wxyz), **links,
            flags=bullet.URDF_USE_SELF_COLLISION if touches else 0,
        )  # fmt: skip
        # PyBullet may number the links in an order of its own; their names tell which is which
        names = [bullet.getJointInfo(uid, i)[12].decode() for i in range(len(joints))]
        places = [(uid, names.index(f"link{i}")) for i in range(1, len(members))]
        self.bodies |= zip(members, [(uid, BASE), *places], strict=True)
        self.joints |= zip(joints, places, strict=True)
        if not base.fixed:
            bullet.resetBaseVelocity(uid, base.velocity_m_s, base.rate_rad_s)

    def _links(self, members: Sequence[str], joints: Sequence[str]) -> dict[str, list[Any]]:
        """Link lists of a tree. A link's frame lies at its joint and is turned as its body is."""
        kinds = {"hinge": self.bullet.JOINT_REVOLUTE, "slider": self.bullet.JOINT_PRISMATIC}
        anchors, lists = {members[0]: ORIGIN}, dict[str, list[Any]]()
        for name in joints:
            joint, mount = self.scenario.joints[name], self.scene.joints[name].mount
            anchors[joint.child] = mount.anchor_m
            from_joint = minus(ORIGIN, mount.anchor_m)
            link = {
                "linkMasses": self.scenario.bodies[joint.child].mass_kg,
                "linkCollisionShapeIndices": self._shape_of(joint.child, from_joint),
                "linkVisualShapeIndices": -1,
                "linkPositions": minus(joint.anchor_m, anchors[joint.parent]),
                "linkOrientations": xyzw(mount.orientation_wxyz),
                "linkInertialFramePositions": from_joint,
                "linkInertialFrameOrientations": (0.0, 0.0, 0.0, 1.0),
                "linkParentIndices": members.index(joint.parent),
                "linkJointTypes": kinds.get(joint.type, self.bullet.JOINT_FIXED),
                "linkJointAxis": mount.axis,
            }
            for key, value in link.items():
                lists.setdefault(key, []).append(value)
        return lists

    def _set_dynamics(self, name: str) -> None:
        bullet, place, body = self.bullet, self.bodies[name], self.scenario.bodies[name]
        if not body.fixed:
            # mass again with the inertia: setting the inertia alone has been seen to lose the mass
            bullet.changeDynamics(
                *place, mass=body.mass_kg, localInertiaDiagonal=self.scene.moments(name)
            )
        if self.scene.contacts.are_given:
            bullet.changeDynamics(
                *place, **{k: held[name] for k, held in self.coefficients.items()}
            )
        if self.scene.gives(TUNED):
            bullet.changeDynamics(
                *place, linearDamping=0, angularDamping=0,
                contactProcessingThreshold=self.scene.contact_gap_m,
            )  # fmt: skip
            # by itself: together with the friction it has been seen to leave that at its default
            bullet.changeDynamics(*place, maxJointVelocity=MAX_SPEED)
        if self.recipe.bodies:
            bullet.changeDynamics(*place, **self.recipe.bodies)

    def _set_joint(self, name: str) -> None:
        """Start, friction and sensor of a joint; by default PyBullet brakes it with a motor."""
        bullet, place, joint = self.bullet, self.joints[name], self.scene.joints[name]
        if name in self.scenario.sensed_joints().values():
            bullet.enableJointForceTorqueSensor(*place, True)
        if joint.is_movable:
            bullet.resetJointState(*place, 0.0, joint.joint.rate)
            if self.scene.gives(TUNED):
                bullet.changeDynamics(*place, jointDamping=0)
            if self.scene.contacts.are_given or joint.own.friction:
                bullet.setJointMotorControl2(
                    *place, bullet.VELOCITY_CONTROL, targetVelocity=0, force=joint.own.friction
                )

    def _filter_contacts(self) -> None:
        """Keeps unnamed pairs apart; by default only in trees where others are to touch."""
        given, tree = self.scene.contacts.are_given, {n: uid for n, (uid, _) in self.bodies.items()}
        named = [pair.bodies for pair in self.scene.contacts.touching]
        within = [(a, b) for a, b in named if tree[a] == tree[b]]
        touched, unnamed = {tree[a] for a, _ in within}, untouching_pairs(self.scenario)
        self.filter(within, touch=True)
        self.filter(
            [(a, b) for a, b in unnamed if given or tree[a] == tree[b] in touched], touch=False
        )
        self.touching = named + [(a, b) for a, b in unnamed if not given and tree[a] != tree[b]]

    def filter(self, pairs: Iterable[tuple[str, str]], *, touch: bool) -> None:
        """Says whether pairs of bodies may touch; Bullet forgets their points of contact."""
        for (uid, link), (other, end) in ((self.bodies[a], self.bodies[b]) for a, b in pairs):
            self.bullet.setCollisionFilterPair(uid, other, link, end, touch)

    def _shape_of(self, body: str, origin: Vector) -> Any:
        """Collision shape of a body whose origin is at ``origin`` in the link's frame; -1: none."""
        shapes: Sequence[Any] = self.scene.shapes[body]
        kinds = [getattr(self.bullet, f"GEOM_{shape.type.upper()}") for shape in shapes]
        places = [plus(origin, shape.position_m) for shape in shapes]
        turns = [xyzw(shape.orientation_wxyz) for shape in shapes if shape.type != "plane"]
        if not shapes:
            return -1
        if len(shapes) > 1:  # the rims that stand for a cylinder
            return self.bullet.createCollisionShapeArray(
                shapeTypes=kinds, radii=[shape.radius_m for shape in shapes],
                lengths=[shape.length_m for shape in shapes], collisionFramePositions=places,
                collisionFrameOrientations=turns,
            )  # fmt: skip
        turn = {"collisionFrameOrientation": turns[0]} if turns else {}
        size = _SIZES[shapes[0].type](shapes[0])
        return self.bullet.createCollisionShape(
            kinds[0], collisionFramePosition=places[0], **size, **turn
        )
