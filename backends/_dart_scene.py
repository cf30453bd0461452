"""A scenario as a DART world: one skeleton for every tree of bodies that hang on one another."""

from __future__ import annotations

from dataclasses import dataclass, field
from types import ModuleType
from typing import Any

import numpy as np

from simcompare.audit import Audit
from simcompare.drives import JointLaw, laws_of
from simcompare.errors import Unsupported
from simcompare.helps import CENTRED_EFFORTS
from simcompare.kinematics import Mount, in_order, mount_of
from simcompare.pairs import restitution_per_body, touching_pairs, untouching_pairs
from simcompare.rotations import matrix_of, rotation_vector_of
from simcompare.scenario import Body, Joint, Scenario
from simcompare.settings import Settings
from simcompare.shapes import Shape
from simcompare.trajectory import Array

#: relative violation of Coulomb's cone at which its solver stops
FRICTION_TOLERANCE = 1e-6


@dataclass
class Scene:
    """A world and the parts of it that a simulation asks.

    Attributes:
        world: DART's world.
        trees: skeletons, each a body and all that hang on it by joints.
        nodes: the BodyNode of every body.
        joints: DART's joint of every joint.
        dofs: the degree of freedom of every movable joint.
        owners: the body that each ShapeNode belongs to.
        restitution: what every body was given of it; empty where the engine's own was left.
        armature: what was added to a child's moments of inertia (3, 3) for its joint [kg·m²].
    """

    world: Any
    trees: list[Any] = field(default_factory=list)
    nodes: dict[str, Any] = field(default_factory=dict)
    joints: dict[str, Any] = field(default_factory=dict)
    dofs: dict[str, Any] = field(default_factory=dict)
    owners: dict[Any, str] = field(default_factory=dict)
    restitution: dict[str, float] = field(default_factory=dict)
    armature: dict[str, Array] = field(default_factory=dict)

    def aspects(self, body: str) -> list[Any]:
        """What DART holds of friction and restitution for every shape of a body."""
        return [shape.getDynamicsAspect() for shape, owner in self.owners.items() if owner == body]


def build_scene(engine: ModuleType, scenario: Scenario, settings: Settings) -> Scene:
    """Builds the whole scene at its start, with as much of the scenario as the level gives."""
    world = engine.simulation.World()
    world.setGravity(scenario.world.gravity_m_s2)
    world.setTimeStep(scenario.world.engine_step_s)
    scene = Scene(world)
    carried = {joint.child for joint in scenario.joints.values()}
    for name, body in scenario.bodies.items():
        if name not in carried:
            _add_root(engine, scene, name, body)
    laws = laws_of(scenario)
    for name, joint in in_order(scenario).items():
        law = laws.get(name, JointLaw())
        _add_link(engine, scene, scenario, name, law)
        if joint.type != "fixed":
            _set_law(scene.joints[name], law, settings.takes(CENTRED_EFFORTS))
    for name in scenario.movable_joints():  # once the trees are whole
        held = scene.joints[name]
        scene.dofs[name] = held.getSkeleton().getDof(held.getIndexInSkeleton(0))
    _let_trees_touch_themselves(scene, scenario)
    for tree in scene.trees:
        world.addSkeleton(tree)
    if settings.gives_coefficients:
        _set_contacts(scene, scenario, settings)
        _keep_apart(scene, scenario)
    if settings.gives_all:
        detector = engine.collision.OdeCollisionDetector()
        world.getConstraintSolver().setCollisionDetector(detector)
        # what sleeps is frozen, and its time at rest is not part of any state
        options = world.getDeactivationOptions()
        options.mEnabled = False
        world.setDeactivationOptions(options)
        if _touches_at_points(scenario):
            _solve_friction_exactly(engine, world)
    return scene


def _add_root(engine: ModuleType, scene: Scene, name: str, body: Body) -> None:
    tree = engine.dynamics.Skeleton(name)
    if body.fixed:
        joint, node = tree.createWeldJointAndBodyNodePair()
        pose = _isometry(engine, body.position_m, matrix_of(body.orientation_wxyz))
        joint.setTransformFromParentBodyNode(pose)
    else:
        joint, node = tree.createFreeJointAndBodyNodePair()
        joint.setPositions([*rotation_vector_of(body.orientation_wxyz), *body.position_m])
        # velocities of a free joint are in the world's frame, also where others hang on it
        joint.setVelocities([*body.rate_rad_s, *body.velocity_m_s])
    scene.trees.append(tree)
    _furnish(engine, scene, name, body, node)


def _add_link(
    engine: ModuleType, scene: Scene, scenario: Scenario, name: str, law: JointLaw
) -> None:
    """Adds a joint and its child; the joint's frame is turned as the child's."""
    joint = scenario.joints[name]
    mount, parent = mount_of(scenario, joint), scene.nodes[joint.parent]
    tree = parent.getSkeleton()
    match joint.type:
        case "hinge":
            held, node = tree.createRevoluteJointAndBodyNodePair(parent)
        case "slider":
            held, node = tree.createPrismaticJointAndBodyNodePair(parent)
        case _:
            held, node = tree.createWeldJointAndBodyNodePair(parent)
    held.setName(name)
    turn = matrix_of(mount.orientation_wxyz)
    held.setTransformFromParentBodyNode(_isometry(engine, joint.anchor_m, turn))
    held.setTransformFromChildBodyNode(_isometry(engine, mount.anchor_m, np.eye(3)))
    scene.joints[name] = held
    if joint.type != "fixed":
        held.setAxis(mount.axis)
        held.setVelocity(0, joint.rate)
    if law.armature:
        scene.armature[joint.child] = _armature(joint, law, mount)
    _furnish(engine, scene, joint.child, scenario.bodies[joint.child], node)


def _armature(joint: Joint, law: JointLaw, mount: Mount) -> Array:
    """Moment of inertia (3, 3) about nothing but the joint's axis, in the child's frame."""
    if joint.type != "hinge":
        raise Unsupported("dart has no armature; on a slider a mass in its place would have weight")
    axis = np.array(mount.axis)
    return np.asarray(law.armature * np.outer(axis, axis), dtype=float)


def _furnish(engine: ModuleType, scene: Scene, name: str, body: Body, node: Any) -> None:
    """Gives a node its name, mass and shapes."""
    node.setName(name)
    scene.nodes[name] = node
    if not body.fixed:
        inertia = engine.dynamics.Inertia()
        inertia.setMass(body.mass_kg)
        inertia.setMoment(np.diag(body.inertia_kg_m2 or ()) + scene.armature.get(name, 0.0))
        inertia.setLocalCOM(body.center_of_mass_m)
        node.setInertia(inertia)
    for shape in body.shapes:
        solid = node.createShapeNode(_shape(engine, shape))
        turn = np.eye(3) if shape.type == "plane" else matrix_of(shape.orientation_wxyz)
        solid.setRelativeTransform(_isometry(engine, shape.position_m, turn))
        solid.createCollisionAspect()
        solid.createDynamicsAspect()
        scene.owners[solid] = name


def _isometry(engine: ModuleType, position: Any, turn: Array) -> Any:
    pose = engine.math.Isometry3()
    pose.set_translation(position)
    pose.set_rotation(turn)
    return pose


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


def _set_law(held: Any, law: JointLaw, outside: bool) -> None:
    """What a joint does by itself; ``outside``: springs and dampers are forces of our own."""
    held.setCoulombFriction(0, law.friction)
    held.setSpringStiffness(0, 0.0 if outside else law.stiffness)
    held.setRestPosition(0, 0.0 if outside else law.rest)
    held.setDampingCoefficient(0, 0.0 if outside else law.damping)


def _let_trees_touch_themselves(scene: Scene, scenario: Scenario) -> None:
    """Bodies of one skeleton pass through one another unless it is told otherwise."""
    for contact in touching_pairs(scenario):
        first, second = (scene.nodes[name].getSkeleton() for name in contact.pair)
        if first is second:
            first.enableSelfCollisionCheck()
            first.disableAdjacentBodyCheck()  # those that a joint connects


def _keep_apart(scene: Scene, scenario: Scenario) -> None:
    """Lets pairs pass through one another that are not to touch."""
    known = scene.world.getConstraintSolver().getCollisionOption().collisionFilter
    for first, second in untouching_pairs(scenario):
        known.addBodyNodePairToBlackList(scene.nodes[first], scene.nodes[second])


def _set_contacts(scene: Scene, scenario: Scenario, settings: Settings) -> None:
    """DART multiplies restitutions, and takes the smaller of two coefficients of friction."""
    scene.restitution = restitution_per_body(scenario, settings, "dart")
    largest = dict.fromkeys(scenario.bodies, 0.0)
    pairs = touching_pairs(scenario)
    for contact in pairs:
        for name in contact.pair:
            largest[name] = max(largest[name], contact.friction)
    for contact in pairs:
        first, second = contact.pair
        smaller = min(largest[first], largest[second])
        if smaller != contact.friction:
            raise Unsupported(
                "dart holds friction per body and takes the smaller: no values give"
                f" {first}-{second} = {contact.friction:g} together with the other pairs"
            )
    for solid, name in scene.owners.items():
        aspect = solid.getDynamicsAspect()
        aspect.setRestitutionCoeff(scene.restitution[name])
        aspect.setFrictionCoeff(largest[name])


def _touches_at_points(scenario: Scenario) -> bool:
    """Whether there is friction, and all that rubs are single spheres, or free boxes on planes."""
    rubbing = [contact.pair for contact in touching_pairs(scenario) if contact.friction > 0]
    shapes = {name: [*(s.type for s in body.shapes)] for name, body in scenario.bodies.items()}
    kinds = [(shapes[a], shapes[b]) for a, b in rubbing]
    free = not scenario.joints
    return bool(kinds) and all(
        ["sphere"] in pair or (free and ["box"] in pair and ["plane"] in pair) for pair in kinds
    )


def _solve_friction_exactly(engine: ModuleType, world: Any) -> None:
    """Coulomb's cone by a nonsmooth Gauss-Seidel solver.

    DART's default one (Dantzig) limits friction by the normal force as it would be without
    friction. This one lets contacts along a line slip, so it is used where there are none.
    """
    options = engine.constraint.NsgsFrictionSolver.Options()
    options.tolerance, options.maxSweeps = FRICTION_TOLERANCE, 100
    solver = engine.constraint.NsgsFrictionSolver(options)
    world.getConstraintSolver().setBoxedLcpSolver(solver)


def audit_scene(scene: Scene, scenario: Scenario, settings: Settings) -> Audit:
    """What was set and what the world holds."""
    audit = Audit("dart")
    world = scenario.world
    step_s, held_s = world.engine_step_s, scene.world.getTimeStep()
    audit.add("engine step_s", step_s, "World.timeStep", (step_s, held_s), "s")
    gravity = zip("xyz", world.gravity_m_s2, scene.world.getGravity(), strict=True)
    for axis, wanted, held in gravity:
        audit.add(f"gravity_m_s2.{axis}", wanted, "World.gravity", (wanted, held), "m/s²")
    sleeps = scene.world.getDeactivationOptions().mEnabled
    awake = settings.gives_all
    note = "" if awake else "engine's default: what rests on something falls asleep"
    audit.add("sleep", None, "deactivation", (0 if awake else None, sleeps), "1", note)
    if settings.gives_all:
        found = scene.world.getConstraintSolver().getCollisionDetector().getType()
        audit.add("contact", None, "OdeCollisionDetector", (1, found == "ode"), "1", "1 means used")
    for name, body in scenario.moving_bodies().items():
        _audit_body(audit, scene, name, body)
    laws = laws_of(scenario)
    for name, joint in scenario.joints.items():
        _audit_mount(audit, scene, scenario, name, joint)
        if name in laws:
            outside = settings.takes(CENTRED_EFFORTS)
            _audit_law(audit, scene.joints[name], name, laws[name], outside)
    _audit_contacts(audit, scene, scenario)
    if settings.gives_all and _touches_at_points(scenario):
        held = scene.world.getConstraintSolver().getBoxedLcpSolver().getOptions().tolerance
        values = (FRICTION_TOLERANCE, held)
        audit.add("friction solver", None, "NsgsFrictionSolver.tolerance", values, "1")
    return audit


def _audit_body(audit: Audit, scene: Scene, name: str, body: Body) -> None:
    node = scene.nodes[name]
    mass = (body.mass_kg, node.getMass())
    audit.add(f"{name}.mass_kg", body.mass_kg, "BodyNode.mass", mass, "kg")
    _audit_moments(audit, scene, name, body)
    position = node.getWorldTransform().translation()
    if node.getParentBodyNode() is None:  # those on joints are compared at the start
        for axis, wanted, got in zip("xyz", body.position_m, position, strict=True):
            audit.add(f"{name}.position_m.{axis}", wanted, "worldTransform", (wanted, got), "m")
    solids = [solid for solid, owner in scene.owners.items() if owner == name]
    for shape, solid in zip(body.shapes, solids, strict=True):
        held = solid.getShape()
        match shape.type:
            case "sphere":
                audit.add_sizes(name, shape, "SphereShape", [held.getRadius()])
            case "box":
                audit.add_sizes(name, shape, "BoxShape", held.getSize().tolist())
            case "cylinder" | "capsule":
                audit.add_sizes(name, shape, "shape", [held.getRadius(), held.getHeight()])


def _audit_moments(audit: Audit, scene: Scene, name: str, body: Body) -> None:
    held = scene.nodes[name].getInertia().getMoment()
    wanted = np.diag(body.inertia_kg_m2 or ()) + scene.armature.get(name, 0.0)
    note = "with the armature of its joint about the joint's axis" if name in scene.armature else ""
    for i, told in enumerate(body.inertia_kg_m2 or ()):
        values = (wanted[i, i], held[i, i])
        quantity = f"{name}.inertia_kg_m2.{i + 1}"
        audit.add(quantity, told, "Inertia.moment", values, "kg·m²", note)


def _audit_mount(audit: Audit, scene: Scene, scenario: Scenario, name: str, joint: Joint) -> None:
    held, mount = scene.joints[name], mount_of(scenario, joint)
    anchor = held.getTransformFromParentBodyNode().translation()
    for axis, wanted, got in zip("xyz", joint.anchor_m, anchor, strict=True):
        audit.add(f"{name}.anchor_m.{axis}", wanted, "transformFromParent", (wanted, got), "m")
    if joint.type != "fixed":
        note = "in the child's frame"
        for axis, wanted, got in zip("xyz", mount.axis, held.getAxis(), strict=True):
            audit.add(f"{name}.axis.{axis}", None, "axis", (wanted, got), "1", note)


def _audit_law(audit: Audit, held: Any, name: str, law: JointLaw, outside: bool) -> None:
    note = "a force on the joint in every step; DART's own is 0" if outside else ""
    for part, wanted, got in (
        ("stiffness", law.stiffness, held.getSpringStiffness(0)),
        ("damping", law.damping, held.getDampingCoefficient(0)),
    ):
        if outside:
            audit.add(f"{name} DART's own {part}", None, part, (0.0, got), "SI")
        if wanted:
            values = (wanted, None if outside else got)
            audit.add(f"{name}.{part}", wanted, part, values, "SI", note)
    if law.friction:
        values = (law.friction, held.getCoulombFriction(0))
        audit.add(f"{name}.friction", law.friction, "coulombFriction", values, "SI")
    if law.armature:
        note = "added to the child's moment of inertia about the axis, and read back there"
        audit.add(f"{name}.armature", law.armature, "moment", (law.armature, None), "kg·m²", note)


def _audit_contacts(audit: Audit, scene: Scene, scenario: Scenario) -> None:
    told = bool(scene.restitution)
    for contact in touching_pairs(scenario):
        pair = "-".join(contact.pair)
        first, second = (scene.aspects(name)[0] for name in contact.pair)
        note = "DART multiplies the two" if told else "engine's default"
        for name, aspect in zip(contact.pair, (first, second), strict=True):
            values = (scene.restitution.get(name), aspect.getRestitutionCoeff())
            parameter = f"restitutionCoeff of {name}"
            audit.add(f"{pair} restitution", contact.restitution, parameter, values, "1", note)
        smaller = min(first.getFrictionCoeff(), second.getFrictionCoeff())
        values = (contact.friction if told else None, smaller)
        note = "DART takes the smaller" if told else "engine's default"
        audit.add(f"{pair} friction", contact.friction, "frictionCoeff", values, "1", note)
