"""A scene in DART as a standalone script."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from simcompare.backend import EngineBackend
from simcompare.scripts.contract import Parts, Plan, Traced, joint_parts, traced
from simcompare.scripts.source import Helper, Style, number
from simcompare.scripts.trace import Dialect

_HELPERS = (
    Helper(
        "Isometry3",
        ("set_translation", "set_rotation"),
        "pose",
        (
            "def pose(place, turn=np.eye(3)):",
            "    found = dart.math.Isometry3()",
            "    found.set_translation(place)",
            "    found.set_rotation(turn)",
            "    return found",
        ),
        (None, np.eye(3)),
    ),
    Helper(
        "Inertia",
        ("setMass", "setMoment", "setLocalCOM"),
        "inertia",
        (
            "def inertia(mass, moment, center=(0, 0, 0)):",
            "    found = dart.dynamics.Inertia()",
            "    found.setMass(mass)",
            "    found.setMoment(moment)",
            "    found.setLocalCOM(center)",
            "    return found",
        ),
        (None, None, (0.0, 0.0, 0.0)),
    ),
)
_QUATERNION = (
    "def quaternion(r):",
    '    """A rotation vector as w, x, y, z."""',
    "    half = np.sqrt(r @ r) / 2",
    "    return np.array((np.cos(half), *(0.5 * np.sinc(half / np.pi) * r)))",
)
_OF_MATRIX = (
    "def quaternion_of(m):",
    '    """A rotation matrix as w, x, y, z."""',
    "    w, x, y, z = 1 + m.trace(), *(1 + 2 * m.diagonal() - m.trace())",
    "    k = np.array((",
    "        (w, m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]),",
    "        (m[2, 1] - m[1, 2], x, m[0, 1] + m[1, 0], m[2, 0] + m[0, 2]),",
    "        (m[0, 2] - m[2, 0], m[0, 1] + m[1, 0], y, m[1, 2] + m[2, 1]),",
    "        (m[1, 0] - m[0, 1], m[2, 0] + m[0, 2], m[1, 2] + m[2, 1], z),",
    "    ))[np.argmax((w, x, y, z))]",
    "    return k / np.sqrt(k @ k)",
)


def _idle(owner: Any, name: str, args: tuple[Any, ...]) -> bool:
    """Whether a setter gives what its getter already returns."""
    if not args or not name.startswith("set"):
        return False
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
        scene = traced(backend, backend.load(), Dialect("dart", idle=_idle), plan)
        held = scene.simulation._scene
        _name_all(scene, held)
        wanted = [
            held.world, *held.nodes.values(), *held.joints.values(),
            *scene.simulation._roots.values(),
        ]  # fmt: skip
        taken = {"dart", "pose", "inertia", "quaternion", "quaternion_of", "free", "links"}
        writer = scene.writer(Style(_HELPERS), wanted, taken)
        lines = writer.lines()
        node = {name: writer.text(scene.ref(one)) for name, one in held.nodes.items()}
        joint = {name: writer.text(scene.ref(one)) for name, one in held.joints.items()}
        root = {
            name: writer.text(scene.ref(one)) for name, one in scene.simulation._roots.items()
        }
        linked = [name for name in plan.scenario.moving_bodies() if name not in root]
        helpers = [line for h in writer.used_helpers for line in ("", "", *h.lines)][2:]
        for needed, text in ((root, _QUATERNION), (linked, _OF_MATRIX)):
            helpers += ["", "", *text] if needed else []
        world = writer.text(scene.ref(held.world))
        return Parts(
            imports=["import dartpy as dart"],
            helpers=helpers,
            scene=lines,
            now=_now(plan, root, {name: node[name] for name in linked}, joint),
            step=f"{world}.step()",
            forces=_forces(plan, node, world),
            drive=[*_drag(plan, root, node), *_drive(plan, joint)],
        )


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


def _now(
    plan: Plan, root: dict[str, str], linked: dict[str, str], joint: dict[str, str]
) -> list[str]:
    lines = []
    if root:
        lines.append(f"free = {{{', '.join(f'{chr(34)}{n}{chr(34)}: {j}' for n, j in root.items())}}}")
    if linked:
        inside = ", ".join(f'"{name}": {one}' for name, one in linked.items())
        lines.append(f"links = {{{inside}}}")
    lines += ["", "", "def now():", '    """Motion of all bodies and joints."""', "    seen = {}"]
    if root:
        lines += [
            "    for name, joint in free.items():",
            "        q, v = joint.getPositions(), joint.getVelocities()",
            '        seen[f"{name}.position_m"] = q[3:]',
            '        seen[f"{name}.orientation_wxyz"] = quaternion(q[:3])',
            '        seen[f"{name}.velocity_m_s"], seen[f"{name}.rate_rad_s"] = v[3:], v[:3]',
        ]
    if linked:
        lines += [
            "    for name, body in links.items():",
            "        place = body.getWorldTransform()",
            '        seen[f"{name}.position_m"] = place.translation()',
            '        seen[f"{name}.orientation_wxyz"] = quaternion_of(place.rotation())',
            '        seen[f"{name}.velocity_m_s"] = body.getLinearVelocity()',
            '        seen[f"{name}.rate_rad_s"] = body.getAngularVelocity()',
        ]
    for name, (place, rate) in joint_parts(plan).items():
        one = joint[name]
        lines += [
            f'    seen["{place}"], seen["{rate}"] = {one}.getPosition(0), {one}.getVelocity(0)'
        ]
    return [*lines, "    return seen"]


def _drive(plan: Plan, joint: dict[str, str]) -> list[str]:
    """What follows the inputs; springs and dampers are DART's own."""
    return [
        f"{joint[effort.joint]}.setForce(0, {effort.given})"
        for effort in plan.efforts
        if effort.given
    ]


def _drag(plan: Plan, root: dict[str, str], node: dict[str, str]) -> list[str]:
    lines = []
    for name, factor in plan.drags.items():
        lines += [
            f"v = {root[name]}.getVelocities()[3:]",
            "speed = np.sqrt(v[0] ** 2 + v[1] ** 2 + v[2] ** 2)",
            f"{node[name]}.addExtForce(-{number(factor)} * speed * v)",
        ]
    return lines


def _forces(plan: Plan, node: dict[str, str], world: str) -> Sequence[str]:
    if not plan.force_sensors:
        return []
    lines: list[str] = []
    if plan.sensed_pairs:
        lines += [
            "",
            "",
            "def normal_force(*pair):",
            '    """Sum over the contacts of two bodies in the last step."""',
            f"    found, contacts = 0.0, {world}.getLastCollisionResult().getContacts()",
            "    for c in contacts:",
            "        shapes = c.collisionObject1.getShapeFrame(), c.collisionObject2.getShapeFrame()",
            "        if {s.asShapeNode().getBodyNodePtr().getName() for s in shapes} == set(pair):",
            "            found += c.force.dot(c.normal)",
            "    return found",
        ]
    lines += ["", "", "def forces():", '    """What the force sensors read in the last step."""']
    lines.append("    seen = {}")
    for name, (first, second) in plan.sensed_pairs.items():
        lines.append(f'    seen["{name}.normal_force_N"] = normal_force("{first}", "{second}")')
    for name, joint in plan.sensed_joints.items():
        child = node[plan.scenario.joints[joint].child]
        lines.append(f'    seen["{name}.force_N"] = {child}.getBodyForce()[3:]')
    return [*lines, "    return seen"]


SCRIPT = DartScript()
