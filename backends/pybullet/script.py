"""A scene in PyBullet as a standalone script."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import Any

from simcompare.backends.pybullet.world import BASE
from simcompare.engine.backend import EngineBackend
from simcompare.engine.kinematics import mount_of
from simcompare.engine.scripting.contract import Parts, Plan, traced
from simcompare.engine.scripting.reading import Group, Reading, reading
from simcompare.engine.scripting.source import Style
from simcompare.engine.scripting.text import WIDTH, identifier, number
from simcompare.engine.scripting.trace import Dialect

#: names of arguments in loops
_NAMES = {
    "changeDynamics": ("body", "link"),
    "createMultiBody": ("mass",),
    "resetJointState": ("body", "link", "angle", "rate"),
    "setCollisionFilterPair": ("body", "other_body", "link", "other"),
    "setJointMotorControl2": ("body", "link"),
    "localInertiaDiagonal": ("inertia",),
    "lateralFriction": ("friction",),
}


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
        held = scene.simulation.built
        style = Style(hidden=frozenset({"connect"}), tidy=_tidy, names=_NAMES)
        for name, (uid, link) in held.bodies.items():
            if link == BASE:
                scene.name(uid, name)
        for call, name in _shapes(scene.events):
            scene.name_call(call, name)
        wanted = [uid for uid, _ in held.bodies.values()]
        writer = scene.writer(style, wanted, {"p"})
        lines = writer.lines()
        place = {
            name: (writer.text(scene.ref(uid)), link) for name, (uid, link) in held.bodies.items()
        }
        joint = {name: place[plan.scenario.joints[name].child] for name in plan.scenario.joints}
        forces, felt = _forces(plan, place, joint)
        return Parts(
            imports=["import pybullet as p"],
            scene=[*_links(plan, place), *lines],
            reading=_read(plan, place, joint),
            step="p.stepSimulation()",
            forces=forces,
            felt=felt,
            drive=[*_drag(plan, place), *_drive(plan, joint)],
        )


def _shapes(events: Sequence[Any]) -> list[tuple[Any, str]]:
    """Calls that made collision shapes, in the order of the bodies that have some."""
    made = [
        event
        for event in events
        if getattr(getattr(event, "target", None), "name", "").startswith("createCollisionShape")
    ]
    return [(call, f"shape_{i}") for i, call in enumerate(made, start=1)]


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


def _read(
    plan: Plan, place: dict[str, tuple[str, int]], joint: dict[str, tuple[str, int]]
) -> Reading:
    moving = {n: (place[n][0], str(place[n][1])) for n in plan.scenario.moving_bodies()}
    seen = ["place", "(turn[3], *turn[:3])", "velocity", "rate"]
    free = Group(
        ("body",),
        {name: (body,) for name, (body, link) in moving.items() if link == str(BASE)},
        seen,
        [
            "place, turn = p.getBasePositionAndOrientation(body)",
            "velocity, rate = p.getBaseVelocity(body)",
        ],
    )
    linked = Group(
        ("body", "link"),
        {name: told for name, told in moving.items() if told[1] != str(BASE)},
        seen,
        ["place, turn, *_, velocity, rate = p.getLinkState(body, link, 1, 1)"],
    )
    at = {name: (joint[name][0], str(joint[name][1])) for name in plan.scenario.movable_joints()}
    moved = Group(("body", "link"), at, ["*p.getJointState(body, link)[:2]"])
    return reading([free, linked], [moved])


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
            lines.append(f"{head}, forces=[{', '.join(texts)}])")
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
) -> tuple[list[str], list[str]]:
    """Lines that read what force sensors read, and what they give."""
    lines, felt = [], []
    for first, second in plan.sensed_pairs.values():
        (a, la), (b, lb) = place[first], place[second]
        felt.append(f"sum(c[9] for c in p.getContactPoints({a}, {b}, {la}, {lb}))")
    for sensed in plan.sensed_joints.values():
        body, link = joint[sensed]
        held = plan.scenario.joints[sensed]
        read = f"p.getJointState({body}, {link})"
        if held.type == "slider":
            x, y, z = (number(a) for a in mount_of(plan.scenario, held).axis)
            lines.append(f"*_, reaction, motor = {read}  # friction acts as the force of a motor")
            felt.append(f"np.array(reaction[:3]) + motor * np.array(({x}, {y}, {z}))")
        else:
            felt.append(f"{read}[2][:3]")
    return lines, felt


SCRIPT = PybulletScript()
