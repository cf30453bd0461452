"""A scene as PyBullet's bodies: what joints carry becomes links of one articulated body."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations
from types import ModuleType

from simcompare.backends._pybullet_parts import BASE, Scene
from simcompare.backends._pybullet_shapes import has_rims, minus, shape_of, xyzw
from simcompare.drives import JointLaw, laws_of
from simcompare.errors import Unsupported
from simcompare.kinematics import Mount, mount_of
from simcompare.pairs import (
    friction_per_body,
    restitution_per_body,
    touching_pairs,
    untouching_pairs,
)
from simcompare.scenario import Scenario
from simcompare.settings import Settings
from simcompare.shapes import Vector

#: largest speed of any coordinate; PyBullet's own 100 m/s or rad/s would be a wall
MOST_SPEED = 1.0e9
#: the solver sweeps over contacts and joints until they move each other by 1e-12 m/s or rad/s, but
#: not for ever; by default it stops at 50 sweeps or at 3e-4
SWEEPS, RESIDUAL = 500, 1.0e-24
#: gap [m] from which on a contact acts that does not bounce: at 0 it would alternate
CONTACT_GAP_M = 1.0e-5
#: softness of contacts where there are rims, in steps over the mass of all bodies: so the two rims
#: of a wheel share its load evenly, which else the order would decide in which they are found
SOFTNESS = 0.05


def build(engine: ModuleType, client: int, scenario: Scenario, settings: Settings) -> Scene:
    """Builds all bodies and joints in an empty client, with as much as the contact level gives.

    A joint's friction is a coefficient, in place of the motor that brakes each joint by default.
    """
    told = settings.gives_coefficients
    scene = Scene(engine, client, scenario, settings)
    _set_world(scene)
    if told:
        scene.restitution = restitution_per_body(scenario, settings, "pybullet")
        scene.friction = friction_per_body(scenario, "pybullet")
    laws = laws_of(scenario)
    for root, joints in trees(scenario).items():
        _add_tree(scene, root, joints)
        for name in (root, *(scenario.joints[joint].child for joint in joints)):
            _set_dynamics(scene, name, inertia_of(scenario, name, laws))
        for joint in joints:
            _set_joint(scene, joint, laws.get(joint))
        _filter_contacts(scene, root, joints)
    for first, second in untouching_pairs(scenario) if told else ():
        _filter(scene, first, second, touches=False)
    return scene


def trees(scenario: Scenario) -> dict[str, list[str]]:
    """Joints below each body that no joint carries, each after the one that carries its parent."""
    below: dict[str, list[str]] = {}
    for name, joint in scenario.joints.items():
        below.setdefault(joint.parent, []).append(name)

    def walk(body: str) -> list[str]:
        found = []
        for name in below.get(body, ()):
            found += [name, *walk(scenario.joints[name].child)]
        return found

    carried = {joint.child for joint in scenario.joints.values()}
    return {body: walk(body) for body in scenario.bodies if body not in carried}


def inertia_of(scenario: Scenario, body: str, laws: Mapping[str, JointLaw]) -> Vector | None:
    """Moments of inertia of a body, with the armature of the hinge that carries it.

    Raises:
        Unsupported: the armature cannot be added to one of the moments.
    """
    moments = scenario.bodies[body].inertia_kg_m2
    for name, joint in scenario.joints.items():
        armature = laws[name].armature if name in laws else 0.0
        if joint.child != body or not armature or moments is None:
            continue
        if joint.type != "hinge":
            raise Unsupported(f"pybullet has no armature, and {name}, a slider, has one")
        added = [
            armature if abs(abs(a) - 1) < 1e-9 else 0.0 for a in mount_of(scenario, joint).axis
        ]
        if not any(added):
            raise Unsupported(
                f"pybullet has no armature; it can be added to a moment of inertia of {body}, but"
                f" the axis of {name} is none of its principal axes"
            )
        first, second, third = (i + a for i, a in zip(moments, added, strict=True))
        moments = (first, second, third)
    return moments


def is_iterated(scenario: Scenario) -> bool:
    """Whether the solver sweeps until nothing changes: with joints, and where forces are read."""
    read = any(s.type in ("force", "contact_force") for s in scenario.sensors.values())
    return bool(scenario.joints) or read


def gap_of(scenario: Scenario) -> float:
    """Largest gap [m] at which a contact acts; a bounce must not begin before there is none."""
    return 0.0 if any(contact.restitution > 0 for contact in scenario.contacts) else CONTACT_GAP_M


def _set_world(scene: Scene) -> None:
    engine, client, world = scene.engine, scene.client, scene.scenario.world
    engine.setGravity(*world.gravity_m_s2, physicsClientId=client)
    engine.setTimeStep(world.engine_step_s, client)
    if not scene.settings.gives_all:
        return
    if any(contact.restitution > 0 for contact in scene.scenario.contacts):
        # without error reduction a bounce gets no energy from penetration; stacks need it
        engine.setPhysicsEngineParameter(erp=0, contactERP=0, physicsClientId=client)
    if is_iterated(scene.scenario):
        engine.setPhysicsEngineParameter(
            numSolverIterations=SWEEPS, solverResidualThreshold=RESIDUAL, globalCFM=softness(scene),
            physicsClientId=client,
        )  # fmt: skip
    engine.setPhysicsEngineParameter(
        contactSlop=0, restitutionVelocityThreshold=0, physicsClientId=client
    )


def softness(scene: Scene) -> float:
    """Bullet's constraint force mixing, 0 where no cylinder is built as rims.

    A contact that carries the weight of all bodies sinks by about g·dt² for it.
    """
    if not any(has_rims(scene, name) for name in scene.scenario.moving_bodies()):
        return 0.0
    mass = sum(body.mass_kg or 0.0 for body in scene.scenario.moving_bodies().values())
    return SOFTNESS * scene.scenario.world.engine_step_s / mass


def refresh_contacts(scene: Scene) -> None:
    """Lets Bullet forget its points of contact, by telling it anew which bodies may touch."""
    for first, second in _touching(scene):
        _filter(scene, first, second, touches=True)


def _touching(scene: Scene) -> list[tuple[str, str]]:
    """All pairs that may touch; by default also unnamed ones, where both move by themselves."""
    scenario = scene.scenario
    found = [contact.pair for contact in touching_pairs(scenario)]
    if not scene.restitution:
        known = {frozenset(pair) for pair in found}
        found += [
            pair
            for pair in untouching_pairs(scenario)
            if scene.bodies[pair[0]][0] != scene.bodies[pair[1]][0] and frozenset(pair) not in known
        ]
    return found


def _filter(scene: Scene, first: str, second: str, *, touches: bool) -> None:
    (uid, link), (other, end) = scene.bodies[first], scene.bodies[second]
    scene.engine.setCollisionFilterPair(uid, other, link, end, touches, scene.client)


def _add_tree(scene: Scene, root: str, joints: list[str]) -> None:
    """One articulated body: a base and, in its order, the child of each joint."""
    engine, client, bodies = scene.engine, scene.client, scene.scenario.bodies
    mounts = {name: mount_of(scene.scenario, scene.scenario.joints[name]) for name in joints}
    base = bodies[root]
    uid: int = engine.createMultiBody(
        base.mass_kg or 0.0,
        shape_of(scene, root, (0.0, 0.0, 0.0)),
        -1,
        base.position_m,
        xyzw(base.orientation_wxyz),
        **_links(scene, root, mounts),
        flags=engine.URDF_USE_SELF_COLLISION if _touching_within(scene, root, joints) else 0,
        physicsClientId=client,
    )
    scene.bodies[root] = (uid, BASE)
    # PyBullet may number the links in an order of its own; their names tell which is which
    names = [engine.getJointInfo(uid, i, client)[12].decode() for i in range(len(joints))]
    for i, name in enumerate(joints):
        place = (uid, names.index(f"link{i + 1}"))
        scene.joints[name] = scene.bodies[scene.scenario.joints[name].child] = place
    if not base.fixed:
        engine.resetBaseVelocity(uid, base.velocity_m_s, base.rate_rad_s, client)


def _links(scene: Scene, root: str, mounts: Mapping[str, Mount]) -> dict[str, list[object]]:
    """Link lists of a tree. A link's frame lies at its joint and is turned as its body is."""
    engine, scenario = scene.engine, scene.scenario
    kinds = {"hinge": engine.JOINT_REVOLUTE, "slider": engine.JOINT_PRISMATIC}
    order, anchors = {root: 0}, {root: (0.0, 0.0, 0.0)}
    lists: dict[str, list[object]] = {key: [] for key in _LINK_LISTS}
    for name, mount in mounts.items():
        joint = scenario.joints[name]
        child = scenario.bodies[joint.child]
        order[joint.child], anchors[joint.child] = len(order), mount.anchor_m
        from_joint = minus((0.0, 0.0, 0.0), mount.anchor_m)
        row = (
            child.mass_kg, shape_of(scene, joint.child, from_joint), -1,
            minus(joint.anchor_m, anchors[joint.parent]), xyzw(mount.orientation_wxyz),
            from_joint, (0.0, 0.0, 0.0, 1.0), order[joint.parent],
            kinds.get(joint.type, engine.JOINT_FIXED), mount.axis,
        )  # fmt: skip
        for key, value in zip(_LINK_LISTS, row, strict=True):
            lists[key].append(value)
    return lists if mounts else {}


_LINK_LISTS = (
    "linkMasses", "linkCollisionShapeIndices", "linkVisualShapeIndices", "linkPositions",
    "linkOrientations", "linkInertialFramePositions", "linkInertialFrameOrientations",
    "linkParentIndices", "linkJointTypes", "linkJointAxis",
)  # fmt: skip


def _set_dynamics(scene: Scene, name: str, inertia: Vector | None) -> None:
    engine, body, (uid, link) = scene.engine, scene.scenario.bodies[name], scene.bodies[name]
    at = {"physicsClientId": scene.client}
    if not body.fixed:
        # mass again with the inertia: setting the inertia alone has been seen to lose the mass
        engine.changeDynamics(uid, link, mass=body.mass_kg, localInertiaDiagonal=inertia, **at)
    if scene.restitution:
        engine.changeDynamics(
            uid, link, restitution=scene.restitution[name], lateralFriction=scene.friction[name],
            **at,
        )  # fmt: skip
    if scene.settings.gives_all:
        gap = gap_of(scene.scenario)
        engine.changeDynamics(
            uid, link, linearDamping=0, angularDamping=0, contactProcessingThreshold=gap, **at
        )
        # by itself: together with the friction it has been seen to leave that at its default
        engine.changeDynamics(uid, link, maxJointVelocity=MOST_SPEED, **at)


def _set_joint(scene: Scene, name: str, law: JointLaw | None) -> None:
    """Start, friction and sensor of a joint; by default PyBullet brakes it with a motor."""
    engine, at, (uid, link) = scene.engine, {"physicsClientId": scene.client}, scene.joints[name]
    if any(s.type == "force" and s.joint == name for s in scene.scenario.sensors.values()):
        engine.enableJointForceTorqueSensor(uid, link, True, **at)
    if law is None:
        return
    engine.resetJointState(uid, link, 0.0, scene.scenario.joints[name].rate, **at)
    if scene.settings.gives_all:
        engine.changeDynamics(uid, link, jointDamping=0, **at)
    if scene.restitution or law.friction:
        engine.setJointMotorControl2(
            uid, link, engine.VELOCITY_CONTROL, targetVelocity=0, force=law.friction, **at
        )


def _touching_within(scene: Scene, root: str, joints: list[str]) -> list[frozenset[str]]:
    """Pairs of one tree that are to touch; PyBullet's own default is that none does."""
    members = {root, *(scene.scenario.joints[joint].child for joint in joints)}
    pairs = [frozenset(contact.pair) for contact in touching_pairs(scene.scenario)]
    return [pair for pair in pairs if pair <= members]


def _filter_contacts(scene: Scene, root: str, joints: list[str]) -> None:
    """Leaves, of all pairs of a tree, only those that are to touch."""
    touching = _touching_within(scene, root, joints)
    if not touching:
        return
    members = [root, *(scene.scenario.joints[joint].child for joint in joints)]
    for first, second in combinations(members, 2):
        _filter(scene, first, second, touches=frozenset((first, second)) in touching)
