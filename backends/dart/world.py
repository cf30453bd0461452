"""A scene as a DART world: one skeleton for every tree of bodies that hang on one another."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from simcompare.backends.dart.variants import DETECTOR, SOLVER, VARIANTS
from simcompare.kit import COEFFICIENTS, TUNED, Array, Scene, SceneJoint, matrix_of

#: relative violation of Coulomb's cone at which its solver stops
FRICTION_TOLERANCE = 1e-6


@dataclass
class World:
    """A world and the parts of it that a simulation asks.

    Attributes:
        world: DART's world.
        trees: skeletons, each a body and all that hang on it by joints.
        nodes: the BodyNode of every body.
        joints: DART's joint of every joint, and of every free body.
        owners: the body that each ShapeNode belongs to.
        restitution: what every body was given of it; empty where the engine's own was left.
    """

    world: Any
    trees: list[Any] = field(default_factory=list)
    nodes: dict[str, Any] = field(default_factory=dict)
    joints: dict[str, Any] = field(default_factory=dict)
    owners: dict[Any, str] = field(default_factory=dict)
    restitution: dict[str, float] = field(default_factory=dict)

    def shapes_of(self, body: str) -> list[Any]:
        """ShapeNodes of a body."""
        return [shape for shape, owner in self.owners.items() if owner == body]


def build(dart: Any, scene: Scene) -> World:
    """Builds the whole scene, with as much of it as the level gives."""
    built = World(dart.simulation.World())
    built.world.setGravity(scene.scenario.world.gravity_m_s2)
    built.world.setTimeStep(scene.scenario.world.engine_step_s)
    # before there are shapes, which the default detector would not know
    _set_world(dart, built.world, scene)
    for name in scene.roots:
        _add_root(dart, built, scene, name)
    for joint in scene.joints.values():
        _add_link(dart, built, scene, joint)
    _let_trees_touch_themselves(built, scene)
    for tree in built.trees:
        built.world.addSkeleton(tree)
    if scene.gives(COEFFICIENTS):
        _set_contacts(built, scene)
    return built


def parts_of(scene: Scene) -> dict[str, str]:
    """Classes that take the place of DART's own: those of tuned, and the variant's."""
    found = {DETECTOR: "OdeCollisionDetector"} if scene.gives(TUNED) else {}
    if scene.gives(TUNED) and touches_at_points(scene):
        # Coulomb's cone by a nonsmooth Gauss-Seidel solver, which lets contacts along a line slip
        found[SOLVER] = "NsgsFrictionSolver"
    return found | dict([VARIANTS[scene.variant].value] if scene.variant else ())


def _set_world(dart: Any, world: Any, scene: Scene) -> None:
    solver, parts = world.getConstraintSolver(), parts_of(scene)
    if DETECTOR in parts:
        solver.setCollisionDetector(getattr(dart.collision, parts[DETECTOR])())
    if scene.gives(TUNED):
        _keep_awake(world)
    if parts.get(SOLVER) == "NsgsFrictionSolver":
        friction = dart.constraint.NsgsFrictionSolver.Options()
        friction.tolerance, friction.maxSweeps = FRICTION_TOLERANCE, 100
        solver.setBoxedLcpSolver(dart.constraint.NsgsFrictionSolver(friction))


def _keep_awake(world: Any) -> None:
    # what sleeps is frozen, and its time at rest is not part of any state
    options = world.getDeactivationOptions()
    options.mEnabled = False
    world.setDeactivationOptions(options)


def _add_root(dart: Any, built: World, scene: Scene, name: str) -> None:
    tree, body = dart.dynamics.Skeleton(name), scene.scenario.bodies[name]
    if body.fixed:
        joint, node = tree.createWeldJointAndBodyNodePair()
        pose = _isometry(dart, body.position_m, matrix_of(body.orientation_wxyz))
        joint.setTransformFromParentBodyNode(pose)
    else:
        built.joints[name], node = tree.createFreeJointAndBodyNodePair()
    built.trees.append(tree)
    _furnish(dart, built, scene, name, node)


def _add_link(dart: Any, built: World, scene: Scene, joint: SceneJoint) -> None:
    """Adds a joint and its child; the joint's frame is turned as the child's."""
    mount, parent = joint.mount, built.nodes[joint.joint.parent]
    tree = parent.getSkeleton()
    add = {
        "hinge": tree.createRevoluteJointAndBodyNodePair,
        "slider": tree.createPrismaticJointAndBodyNodePair,
        "fixed": tree.createWeldJointAndBodyNodePair,
    }
    held, node = add[joint.joint.type](parent)
    held.setName(joint.name)
    turn = matrix_of(mount.orientation_wxyz)
    held.setTransformFromParentBodyNode(_isometry(dart, joint.joint.anchor_m, turn))
    held.setTransformFromChildBodyNode(_isometry(dart, mount.anchor_m, np.eye(3)))
    built.joints[joint.name] = held
    if joint.is_movable:
        held.setAxis(mount.axis)
        held.setCoulombFriction(0, joint.own.friction)
        held.setSpringStiffness(0, joint.own.stiffness)
        held.setRestPosition(0, joint.own.rest)
        held.setDampingCoefficient(0, joint.own.damping)
    _furnish(dart, built, scene, joint.joint.child, node)


def _furnish(dart: Any, built: World, scene: Scene, name: str, node: Any) -> None:
    """Gives a node its name, mass and shapes."""
    node.setName(name)
    built.nodes[name], body = node, scene.scenario.bodies[name]
    if not body.fixed:
        inertia = dart.dynamics.Inertia()
        inertia.setMass(body.mass_kg)
        inertia.setMoment(scene.inertia(name))
        inertia.setLocalCOM(body.center_of_mass_m)
        node.setInertia(inertia)
    for shape in scene.shapes[name]:
        solid = node.createShapeNode(_shape(dart.dynamics, shape))
        turn = np.eye(3) if shape.type == "plane" else matrix_of(shape.orientation_wxyz)
        solid.setRelativeTransform(_isometry(dart, shape.position_m, turn))
        solid.createCollisionAspect()
        solid.createDynamicsAspect()
        built.owners[solid] = name


def _isometry(dart: Any, position: Any, turn: Array) -> Any:
    pose = dart.math.Isometry3()
    pose.set_translation(position)
    pose.set_rotation(turn)
    return pose


def _shape(dynamics: Any, shape: Any) -> Any:
    make = {
        "plane": lambda: dynamics.PlaneShape(shape.normal, 0.0),
        "sphere": lambda: dynamics.SphereShape(shape.radius_m),
        "box": lambda: dynamics.BoxShape(shape.size_m),
        "cylinder": lambda: dynamics.CylinderShape(shape.radius_m, shape.length_m),
        "capsule": lambda: dynamics.CapsuleShape(shape.radius_m, shape.length_m),
    }
    return make[shape.type]()


def _let_trees_touch_themselves(built: World, scene: Scene) -> None:
    """Bodies of one skeleton pass through one another unless it is told otherwise."""
    for pair in scene.contacts.touching:
        first, second = (built.nodes[name].getSkeleton() for name in pair.bodies)
        if first is second:
            first.enableSelfCollisionCheck()
            first.disableAdjacentBodyCheck()  # those that a joint connects


def _set_contacts(built: World, scene: Scene) -> None:
    built.restitution = scene.contacts.restitution_per_body("product", scene.engine)
    friction = scene.contacts.friction_per_body("min", scene.engine)
    for solid, name in built.owners.items():
        aspect = solid.getDynamicsAspect()
        aspect.setRestitutionCoeff(built.restitution[name])
        aspect.setFrictionCoeff(friction[name])
    known = built.world.getConstraintSolver().getCollisionOption().collisionFilter
    for first, second in scene.contacts.apart:
        known.addBodyNodePairToBlackList(built.nodes[first], built.nodes[second])


def touches_at_points(scene: Scene) -> bool:
    """Whether there is friction, and all that rubs are single spheres, or free boxes on planes."""
    rubbing = [pair.bodies for pair in scene.contacts.touching if pair.friction > 0]
    kinds = [[[s.type for s in scene.shapes[name]] for name in pair] for pair in rubbing]
    return bool(kinds) and all(
        ["sphere"] in pair or (not scene.joints and ["box"] in pair and ["plane"] in pair)
        for pair in kinds
    )
