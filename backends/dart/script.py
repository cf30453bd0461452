"""A scene in DART as a standalone script."""

from __future__ import annotations

from typing import Any

import numpy as np

from simcompare.engine.backend import EngineBackend
from simcompare.engine.scripting.contract import Parts, Plan, Traced, traced
from simcompare.engine.scripting.reading import Group, Reading, reading
from simcompare.engine.scripting.source import Helper, Style
from simcompare.engine.scripting.text import number
from simcompare.engine.scripting.trace import Dialect

_HELPERS = (
    Helper(
        "Inertia",
        {"setMass": "", "setMoment": "momentOfInertia", "setLocalCOM": "com"},
        "dart.dynamics.Inertia",
        least=1,
    ),
    Helper(
        "Isometry3",
        {"set_translation": "", "set_rotation": ""},
        "dart.math.Isometry3",
        order=("set_rotation", "set_translation"),
        least=1,
    ),
    Helper(
        "createShapeNode",
        {
            "setRelativeTransform": "place",
            "setFrictionCoeff": "friction",
            "setRestitutionCoeff": "restitution",
        },
        "add_shape",
        (
            "def add_shape(body, solid, place=None, friction=1, restitution=0):",
            "    shape = body.createShapeNode(solid)",
            "    if place is not None:",
            "        shape.setRelativeTransform(place)",
            "    shape.createCollisionAspect()",
            "    surface = shape.createDynamicsAspect()",
            "    surface.setFrictionCoeff(friction)",
            "    surface.setRestitutionCoeff(restitution)",
            "    return shape",
        ),
        receiver=True,
        swallowed=frozenset({"createCollisionAspect", "createDynamicsAspect"}),
        nested="createDynamicsAspect",
        least=3,
    ),
)


#: names of arguments in loops
_NAMES = {"addBodyNodePairToBlackList": ("one", "other"), "addSkeleton": ("tree",)}


def _idle(owner: Any, name: str, args: tuple[Any, ...]) -> bool:
    """Whether a setter gives what its getter already returns; names do not matter either."""
    if name == "setName":
        return True
    if not args or not name.startswith("set"):
        return False
    if name == "set_rotation":
        return bool(np.array_equal(args[0], np.eye(3)))
    try:
        held = getattr(owner, f"get{name[3:]}")(*args[:-1])
        if hasattr(held, "translation"):
            return bool(np.array_equal(held.matrix(), args[-1].matrix()))
        return bool(np.array_equal(held, args[-1]))
    except (AttributeError, TypeError, ValueError):
        return False


class DartScript:
    """Writes scripts that import dartpy."""

    def parts(self, backend: EngineBackend, plan: Plan) -> Parts:
        pure = frozenset({"translation", "rotation", "matrix"})
        scene = traced(backend, backend.load(), Dialect("dart", pure=pure, idle=_idle), plan)
        held = scene.simulation.built
        _name_all(scene, held, [*plan.scenario.free_bodies()])
        movable = {name: held.joints[name] for name in plan.scenario.movable_joints()}
        nodes = {name: held.nodes[name] for name in plan.scenario.moving_bodies()}
        shapes = [s for s, owner in held.owners.items() if owner in _touching(plan)]
        roots = {name: held.joints[name] for name in plan.scenario.free_bodies()}
        taken = {"dart", "inertia", "add_shape", "normal_force", "joint"}
        wanted = [held.world, *movable.values(), *roots.values(), *shapes]
        pushed = [name for name in nodes if name not in roots or name in plan.drags]
        wanted += [nodes[name] for name in pushed]
        writer = scene.writer(Style(_HELPERS, names=_NAMES), wanted, taken)
        lines = writer.lines()
        node = {name: writer.text(scene.ref(one)) for name, one in nodes.items()}
        root = {name: writer.text(scene.ref(one)) for name, one in roots.items()}
        joint = {name: writer.text(scene.ref(one)) for name, one in movable.items()}
        shape: dict[str, list[str]] = {}
        for one in shapes:
            shape.setdefault(held.owners[one], []).append(writer.text(scene.ref(one)))
        world = writer.text(scene.ref(held.world))
        functions = [helper.lines for helper in writer.used_helpers if helper.lines]
        if plan.sensed_pairs:
            functions.append(tuple(line.replace("{world}", world) for line in _NORMAL))
        return Parts(
            imports=["import dartpy as dart"],
            helpers=[line for lines in functions for line in ("", "", *lines)][2:],
            scene=lines,
            reading=_read(root, node, joint),
            step=f"{world}.step()",
            felt=_felt(plan, node, shape),
            drive=[
                *_drag(plan, root, node),
                *_drive(plan, joint, follows=scene.simulation.follows),
            ],
        )


def _touching(plan: Plan) -> set[str]:
    """Bodies whose contacts are sensed."""
    return {name for pair in plan.sensed_pairs.values() for name in pair}


def _name_all(scene: Traced, held: Any, free: list[str]) -> None:
    scene.name(held.world, "world")
    for name, node in held.nodes.items():
        scene.name(node, name)
    for name, joint in held.joints.items():
        scene.name(joint, f"{name}_joint" if name in free else name)
    for name, node in held.nodes.items():
        scene.name_beside(node, 0, f"{name}_joint")
    for tree in held.trees:
        scene.name(tree, f"{tree.getName()}_tree")
    for shape, owner in held.owners.items():
        scene.name(shape, f"{owner}_shape")
        scene.name(shape.getDynamicsAspect(), f"{owner}_surface")


def _read(root: dict[str, str], node: dict[str, str], joint: dict[str, str]) -> Reading:
    """Free bodies by their coordinates; DART's own transforms round small angles to 1e-10."""
    free = Group(
        ("joint",),
        {name: (text,) for name, text in root.items()},
        ["q[3:]", "turn", "v[3:]", "v[:3]"],
        [
            "q, v = joint.getPositions(), joint.getVelocities()",
            "half = np.linalg.norm(q[:3]) / 2  # q[:3] is a rotation vector",
            "turn = np.append(np.cos(half), 0.5 * np.sinc(half / np.pi) * q[:3])",
        ],
    )
    linked = Group(
        ("body",),
        {name: (text,) for name, text in node.items() if name not in root},
        ["place.translation()", "turn", "body.getLinearVelocity()", "body.getAngularVelocity()"],
        ["place = body.getWorldTransform()", "turn = place.quaternion().wxyz()"],
    )
    joints = {name: (text,) for name, text in joint.items()}
    moved = Group(("joint",), joints, ["joint.getPosition(0)", "joint.getVelocity(0)"])
    return reading([free, linked], [moved])


def _drive(plan: Plan, joint: dict[str, str], *, follows: bool) -> list[str]:
    """Efforts of the next step; unless they follow the motion, springs and dampers are DART's."""
    lines = []
    for effort in plan.efforts:
        one, moved = joint[effort.joint], effort.law.stiffness or effort.law.damping
        text = effort.text("q", "v") if follows else effort.given
        if follows and moved:
            lines.append(f"q, v = {one}.getPosition(0), {one}.getVelocity(0)")
        if text:
            lines.append(f"{one}.setForce(0, {text})")
    return lines


def _drag(plan: Plan, root: dict[str, str], node: dict[str, str]) -> list[str]:
    lines = []
    for name, factor in plan.drags.items():
        lines += [
            f"v = {root[name]}.getVelocities()[3:]",
            "speed = np.sqrt(v[0] ** 2 + v[1] ** 2 + v[2] ** 2)",
            f"{node[name]}.addExtForce(-{number(factor)} * speed * v)",
        ]
    return lines


_NORMAL = (
    "def normal_force(first, second):",
    '    """Sum over the contacts between two bodies\' shapes in the last step."""',
    "    found = 0",
    "    for c in {world}.getLastCollisionResult().getContacts():",
    "        one, other = c.collisionObject1, c.collisionObject2",
    "        touch = {one.getShapeFrame(), other.getShapeFrame()}",
    "        found += c.force.dot(c.normal) if touch & first and touch & second else 0",
    "    return found",
)


def _felt(plan: Plan, node: dict[str, str], shape: dict[str, list[str]]) -> list[str]:
    felt = []
    for pair in plan.sensed_pairs.values():
        first, second = (f"{{{', '.join(shape[one])}}}" for one in pair)
        felt.append(f"normal_force({first}, {second})")
    for joint in plan.sensed_joints.values():
        felt.append(f"{node[plan.scenario.joints[joint].child]}.getBodyForce()[3:]")
    return felt


SCRIPT = DartScript()
