"""A scene in DART as a standalone script."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from simcompare.backend import EngineBackend
from simcompare.scripts.contract import Parts, Plan, Traced, joint_parts, now_of_one, traced
from simcompare.scripts.source import Helper, Style
from simcompare.scripts.text import dictionary, number
from simcompare.scripts.trace import Dialect

_HELPERS = (
    Helper(
        "Inertia",
        {"setMass": "", "setMoment": "momentOfInertia", "setLocalCOM": "com"},
        "dart.dynamics.Inertia",
        least=1,
    ),
    Helper(
        "Isometry3",
        {"set_translation": "", "set_rotation": "turn"},
        "pose",
        (
            "def pose(place, turn=np.eye(3)):",
            "    return dart.math.Isometry3(turn, place)",
        ),
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
        held = scene.simulation._scene
        _name_all(scene, held)
        movable = {name: held.joints[name] for name in plan.scenario.movable_joints()}
        nodes = {name: held.nodes[name] for name in _asked(plan)}
        shapes = [s for s, owner in held.owners.items() if owner in _touching(plan)]
        roots = scene.simulation._roots
        taken = {"dart", "pose", "inertia", "add_shape", "quaternion", "joint"}
        wanted = [held.world, *movable.values(), *roots.values(), *shapes]
        pushed = [name for name in nodes if name not in roots or name in plan.drags]
        wanted += [nodes[name] for name in pushed]
        writer = scene.writer(Style(_HELPERS), wanted, taken)
        lines = writer.lines()
        node = {name: writer.text(scene.ref(one)) for name, one in nodes.items()}
        root = {name: writer.text(scene.ref(one)) for name, one in roots.items()}
        joint = {name: writer.text(scene.ref(one)) for name, one in movable.items()}
        shape: dict[str, list[str]] = {}
        for one in shapes:
            shape.setdefault(held.owners[one], []).append(writer.text(scene.ref(one)))
        world = writer.text(scene.ref(held.world))
        functions = [helper.lines for helper in writer.used_helpers if helper.lines]
        functions += [_QUATERNION] if root else []
        return Parts(
            imports=["import dartpy as dart"],
            helpers=[line for lines in functions for line in ("", "", *lines)][2:],
            scene=lines,
            now=_now(plan, root, node, joint),
            step=f"{world}.step()",
            forces=_forces(plan, node, shape, world),
            drive=[
                *_drag(plan, root, node),
                *_drive(plan, joint, follows=scene.simulation._follows),
            ],
        )


def _asked(plan: Plan) -> list[str]:
    """Bodies that the loop reads or pushes."""
    return list(plan.scenario.moving_bodies())


def _touching(plan: Plan) -> set[str]:
    """Bodies whose contacts are sensed."""
    return {name for pair in plan.sensed_pairs.values() for name in pair}


def _name_all(scene: Traced, held: Any) -> None:
    scene.name(held.world, "world")
    for name, node in held.nodes.items():
        scene.name(node, name)
    for name, joint in held.joints.items():
        scene.name(joint, name)
    for name, joint in scene.simulation._roots.items():
        scene.name(joint, f"{name}_joint")
    for tree in held.trees:
        scene.name(tree, f"{tree.getName()}_tree")
    for shape, owner in held.owners.items():
        scene.name(shape, f"{owner}_shape")
        scene.name(shape.getDynamicsAspect(), f"{owner}_surface")


_QUATERNION = (
    "def quaternion(r):",
    '    """A rotation vector as w, x, y, z."""',
    "    half = np.linalg.norm(r) / 2",
    "    return np.append(np.cos(half), 0.5 * np.sinc(half / np.pi) * r)",
)


def _now(
    plan: Plan, root: dict[str, str], node: dict[str, str], joint: dict[str, str]
) -> list[str]:
    """Free bodies by their coordinates; DART's own transforms round small angles to 1e-10."""
    motion = {
        one: (f"{text}.getPosition(0)", f"{text}.getVelocity(0)") for one, text in joint.items()
    }
    linked = {name: one for name, one in node.items() if name not in root}
    if len(node) == 1:
        if root:
            (one,) = root.values()
            read = [f"q, v = {one}.getPositions(), {one}.getVelocities()"]
            seen = ["q[3:]", "quaternion(q[:3])", "v[3:]", "v[:3]"]
        else:
            (one,) = linked.values()
            read = [f"place = {one}.getWorldTransform()"]
            seen = ["place.translation()", "place.quaternion().wxyz()"]
            seen += [f"{one}.getLinearVelocity()", f"{one}.getAngularVelocity()"]
        seen += [text for pair in motion.values() for text in pair]
        return now_of_one(plan, "Motion of the body.", read, seen)
    lines = ["", "", "def now():", '    """Motion of all bodies and joints."""', "    seen = {}"]
    if root:
        lines += [
            f"    for name, joint in {dictionary(root)}.items():",
            "        q, v = joint.getPositions(), joint.getVelocities()",
            '        seen[f"{name}.position_m"], seen[f"{name}.rate_rad_s"] = q[3:], v[:3]',
            '        seen[f"{name}.orientation_wxyz"] = quaternion(q[:3])',
            '        seen[f"{name}.velocity_m_s"] = v[3:]',
        ]
    if linked:
        lines += [
            f"    for name, body in {dictionary(linked)}.items():",
            "        place = body.getWorldTransform()",
            '        seen[f"{name}.position_m"] = place.translation()',
            '        seen[f"{name}.orientation_wxyz"] = place.quaternion().wxyz()',
            '        seen[f"{name}.velocity_m_s"] = body.getLinearVelocity()',
            '        seen[f"{name}.rate_rad_s"] = body.getAngularVelocity()',
        ]
    for name, (place, rate) in joint_parts(plan).items():
        q, v = motion[name]
        lines.append(f'    seen["{place}"], seen["{rate}"] = {q}, {v}')
    return [*lines, "    return seen"]


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


def _forces(
    plan: Plan, node: dict[str, str], shape: dict[str, list[str]], world: str
) -> Sequence[str]:
    if not plan.force_sensors:
        return []
    lines: list[str] = []
    if plan.sensed_pairs:
        lines += [
            "",
            "",
            "def normal_force(first, second):",
            '    """Sum over the contacts between two bodies\' shapes in the last step."""',
            "    found = 0",
            f"    for c in {world}.getLastCollisionResult().getContacts():",
            "        one, other = c.collisionObject1, c.collisionObject2",
            "        touch = {one.getShapeFrame(), other.getShapeFrame()}",
            "        found += c.force.dot(c.normal) if touch & first and touch & second else 0",
            "    return found",
        ]
    lines += ["", "", "def forces():", '    """What the force sensors read in the last step."""']
    lines.append("    seen = {}")
    for name, pair in plan.sensed_pairs.items():
        first, second = (f"{{{', '.join(shape[one])}}}" for one in pair)
        lines.append(f'    seen["{name}.normal_force_N"] = normal_force({first}, {second})')
    for name, joint in plan.sensed_joints.items():
        child = node[plan.scenario.joints[joint].child]
        lines.append(f'    seen["{name}.force_N"] = {child}.getBodyForce()[3:]')
    return [*lines, "    return seen"]


SCRIPT = DartScript()
