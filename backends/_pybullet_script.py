"""A scene in PyBullet as a standalone script."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import Any

from simcompare.backend import EngineBackend
from simcompare.backends._pybullet_parts import BASE
from simcompare.kinematics import mount_of
from simcompare.scripts.contract import Parts, Plan, joint_parts, now_of_one, traced
from simcompare.scripts.source import Style
from simcompare.scripts.text import WIDTH, identifier, number, wrapped
from simcompare.scripts.trace import Dialect


def _tidy(name: str, args: list[Any], kwargs: dict[str, Any]) -> None:
    """Leaves out what is PyBullet's default anyway."""
    if name == "createMultiBody":
        if kwargs.get("flags") == 0:
            del kwargs["flags"]
        if args[-1] == (0.0, 0.0, 0.0, 1.0):
            args.pop()
    if kwargs.get("collisionFramePosition") == (0.0, 0.0, 0.0):
        del kwargs["collisionFramePosition"]
    if kwargs.get("collisionFrameOrientation") == (0.0, 0.0, 0.0, 1.0):
        del kwargs["collisionFrameOrientation"]


class PybulletScript:
    """Writes scripts that import pybullet."""

    def parts(self, backend: EngineBackend, plan: Plan) -> Parts:
        dialect = Dialect("p", dropped=frozenset({"physicsClientId"}))
        scene = traced(backend, backend.load(), dialect, plan)
        held = scene.simulation._scene
        style = Style(hidden=frozenset({"connect"}), tidy=_tidy)
        for name, (uid, link) in held.bodies.items():
            if link == BASE:
                scene.name(uid, name)
        for call, name in _shapes(held, scene.events):
            scene.name_call(call, name)
        wanted = [uid for uid, _ in held.bodies.values()]
        writer = scene.writer(style, wanted, {"p"})
        lines = writer.lines()
        place = {
            name: (writer.text(scene.ref(uid)), link) for name, (uid, link) in held.bodies.items()
        }
        joint = {name: place[plan.scenario.joints[name].child] for name in plan.scenario.joints}
        return Parts(
            imports=["import pybullet as p"],
            scene=[*_links(plan, place), *lines],
            now=_now(plan, place, joint),
            step="p.stepSimulation()",
            forces=_forces(plan, place, joint),
            drive=[*_drag(plan, place), *_drive(plan, joint)],
        )


def _shapes(held: Any, events: Sequence[Any]) -> list[tuple[Any, str]]:
    """Calls that made collision shapes, in the order of the bodies that have some."""
    made = [
        event
        for event in events
        if getattr(getattr(event, "target", None), "name", "").startswith("createCollisionShape")
    ]
    return [(call, f"shape_{i}") for i, call in enumerate(made, start=1)] if held else []


def _links(plan: Plan, place: dict[str, tuple[str, int]]) -> list[str]:
    """Which link is what, where bodies are links of others."""
    found: dict[str, list[str]] = {}
    for name, joint in plan.scenario.joints.items():
        root, link = place[joint.child]
        found.setdefault(root, []).append(f"{link} {joint.child} (joint {name})")
    return [
        line
        for root, links in found.items()
        for line in textwrap.wrap(
            f"links of {root}: {', '.join(links)}",
            WIDTH,
            initial_indent="# ",
            subsequent_indent="# ",
        )
    ]


def _now(
    plan: Plan, place: dict[str, tuple[str, int]], joint: dict[str, tuple[str, int]]
) -> list[str]:
    moving = {name: place[name] for name in plan.scenario.moving_bodies()}
    base = [
        "place, turn = p.getBasePositionAndOrientation(body)",
        "velocity, rate = p.getBaseVelocity(body)",
    ]
    linked = ["place, turn, *_, velocity, rate = p.getLinkState(body, link, 1, 1)"]
    note = "Motion of all bodies and joints."
    if len(moving) == 1:
        ((body, link),) = moving.values()
        reads = [x.replace("body", body).replace("link,", f"{link},") for x in linked]
        if link == BASE:
            reads = [x.replace("body", body) for x in base]
        seen = ["place", "(turn[3], *turn[:3])", "velocity", "rate"]
        for name in joint_parts(plan):
            at, link = joint[name]
            reads.append(f"q, v, *_ = p.getJointState({at}, {link})")
            seen += ["q", "v"]
        return now_of_one(plan, "Motion of the body.", reads, seen)
    kinds = {link == BASE for _, link in moving.values()}
    if kinds == {True}:
        inside, loop = ", ".join(f'"{n}": {b}' for n, (b, _) in moving.items()), "name, body"
        read = base
    else:
        inside = ", ".join(f'"{n}": ({b}, {link})' for n, (b, link) in moving.items())
        loop, read = "name, (body, link)", linked
        if True in kinds:
            read = ["if link == -1:", *(f"    {x}" for x in base), "else:", f"    {linked[0]}"]
    lines = [
        *wrapped("bodies = ", f"{{{inside}}}"),
        "",
        "",
        "def now():",
        f'    """{note}"""',
        "    seen = {}",
        f"    for {loop} in bodies.items():",
        *(f"        {line}" for line in read),
        '        seen[f"{name}.position_m"] = place',
        '        seen[f"{name}.orientation_wxyz"] = turn[3], *turn[:3]',
        '        seen[f"{name}.velocity_m_s"], seen[f"{name}.rate_rad_s"] = velocity, rate',
    ]
    for name, (position, rate) in joint_parts(plan).items():
        body, link = joint[name]
        lines.append(
            f'    seen["{position}"], seen["{rate}"], *_ = p.getJointState({body}, {link})'
        )
    return [*lines, "    return seen"]


def _drive(plan: Plan, joint: dict[str, tuple[str, int]]) -> list[str]:
    """Efforts of the next step; PyBullet forgets them in every step."""
    lines: list[str] = []
    given: dict[str, tuple[list[int], list[str]]] = {}
    for effort in plan.efforts:
        body, link = joint[effort.joint]
        text = effort.text("q", "v")
        if effort.law.stiffness or effort.law.damping:
            lines.append(f"q, v, *_ = p.getJointState({body}, {link})")
            variable = identifier(f"effort_{effort.joint}")
            lines.append(f"{variable} = {text}")
            text = variable
        links, texts = given.setdefault(body, ([], []))
        links.append(link)
        texts.append(text)
    for body, (links, texts) in given.items():
        if len(links) == 1:
            head = f"p.setJointMotorControl2({body}, {links[0]}, p.TORQUE_CONTROL"
            lines.append(f"{head}, force={texts[0]})")
        else:
            head = f"p.setJointMotorControlArray({body}, {links}, p.TORQUE_CONTROL"
            forces = ", ".join(texts)
            array = [f"{head[len('p.setJointMotorControlArray(') :]}", f"forces=[{forces}]"]
            lines += wrapped("", "p.setJointMotorControlArray", array)
    return lines


def _drag(plan: Plan, place: dict[str, tuple[str, int]]) -> list[str]:
    lines = []
    for name, factor in plan.drags.items():
        body, _ = place[name]
        lines += [
            f"v = np.array(p.getBaseVelocity({body})[0])",
            f"drag = -{number(factor)} * np.sqrt(v[0] ** 2 + v[1] ** 2 + v[2] ** 2) * v",
            f"place = p.getBasePositionAndOrientation({body})[0]",
            f"p.applyExternalForce({body}, -1, drag.tolist(), place, p.WORLD_FRAME)",
        ]
    return lines


def _forces(
    plan: Plan, place: dict[str, tuple[str, int]], joint: dict[str, tuple[str, int]]
) -> list[str]:
    if not plan.force_sensors:
        return []
    lines = ["", "", "def forces():", '    """What the force sensors read in the last step."""']
    lines.append("    seen = {}")
    for name, (first, second) in plan.sensed_pairs.items():
        (a, la), (b, lb) = place[first], place[second]
        lines.append(
            f'    seen["{name}.normal_force_N"] = sum('
            f"c[9] for c in p.getContactPoints({a}, {b}, {la}, {lb}))"
        )
    for name, sensed in plan.sensed_joints.items():
        body, link = joint[sensed]
        held = plan.scenario.joints[sensed]
        lines.append(f"    *_, reaction, motor = p.getJointState({body}, {link})")
        if held.type == "slider":
            x, y, z = (number(a) for a in mount_of(plan.scenario, held).axis)
            lines.append("    # the friction of a slider acts as the force of a motor")
            lines.append(
                f'    seen["{name}.force_N"] = np.array(reaction[:3])'
                f" + motor * np.array(({x}, {y}, {z}))"
            )
        else:
            lines.append(f'    seen["{name}.force_N"] = reaction[:3]')
    return [*lines, "    return seen"]


SCRIPT = PybulletScript()
