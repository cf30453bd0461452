"""A scene in pymunk as a standalone script."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from simcompare.engine.backend import EngineBackend
from simcompare.engine.helps.momentum import carried_by
from simcompare.engine.planar_joints import PlanarSlider
from simcompare.engine.scripting.contract import Parts, Plan, Traced, traced
from simcompare.engine.scripting.reading import Group, Reading, reading
from simcompare.engine.scripting.source import Style
from simcompare.engine.scripting.text import number
from simcompare.engine.scripting.trace import Dialect

_SLIDE = (
    "def slide(parent, child, heading, start, ahead_s=0):",
    '    """Coordinate and rate of a slider along an axis of its parent, and that axis."""',
    "    (dx, dz), (vx, vz) = child.position - parent.position, child.velocity - parent.velocity",
    "    angle, spin = parent.angle + heading, parent.angular_velocity",
    "    x, z = np.cos(angle), np.sin(angle)",
    "    place = x * dx + z * dz - start",
    "    if not ahead_s:",
    "        return place, x * vx + z * vz + spin * (x * dz - z * dx), (x, z)",
    "    # the axis as it will be when the next step's forces act, and the mean rate until then",
    "    ax, az = np.cos(angle + ahead_s * spin), np.sin(angle + ahead_s * spin)",
    "    return place, ((ax - x) * dx + (az - z) * dz) / ahead_s + ax * vx + az * vz, (ax, az)",
)


#: the same where no parent can move
_SLIDE_FIXED = (
    "def slide(parent, child, heading, start):",
    '    """Coordinate and rate of a slider along a fixed axis, and that axis."""',
    "    (dx, dz), (vx, vz) = child.position - parent.position, child.velocity",
    "    x, z = np.cos(parent.angle + heading), np.sin(parent.angle + heading)",
    "    return x * dx + z * dz - start, x * vx + z * vz, (x, z)",
)


def _idle(owner: Any, name: str, args: tuple[Any, ...]) -> bool:
    return len(args) == 1 and getattr(owner, name, None) == args[0]


def _tidy(name: str, args: list[Any], kwargs: dict[str, Any]) -> None:
    del kwargs
    if name == "Circle" and args[-1] == (0, 0):
        args.pop()


#: functions of Chipmunk that change nothing
_PURE = frozenset(
    ("identity", "translated", "rotated", "local_to_world", "world_to_local", "normalized",
     "perpendicular", "dot")
)  # fmt: skip


class PymunkScript:
    """Writes scripts that import pymunk."""

    def parts(self, backend: EngineBackend, plan: Plan) -> Parts:
        engine = backend.load()
        dialect = Dialect("pymunk", (engine.Vec2d,), _PURE, _idle)
        scene = traced(backend, engine, dialect, plan)
        held, joints = scene.simulation.built, scene.simulation.linkages
        _name_all(scene, held)
        taken = {"pymunk", "slide", "normal_force", "joint_force"}
        wanted = [held.space, *held.bodies.values()]
        writer = scene.writer(Style(tidy=_tidy), wanted, taken)
        lines = writer.lines()
        body = {name: writer.text(scene.ref(one)) for name, one in held.bodies.items()}
        sliders = [j for j in joints.values() if isinstance(j, PlanarSlider)]
        helpers: list[str] = []
        if sliders:
            fixed = all(joint.is_fixed for joint in sliders)
            helpers += _SLIDE_FIXED if fixed else _SLIDE
        if plan.sensed_pairs:
            helpers += [*["", ""][: 2 * len(helpers)], *_NORMAL]
        after = "map(joint_force, carried, before, momentum())"
        joint_forces = [f"*{after}"] if plan.sensed_joints else []
        return Parts(
            imports=["import pymunk"],
            helpers=helpers,
            scene=[*lines, *_momentum(plan, body)],
            reading=_read(plan, joints, body),
            step=f"{writer.text(scene.ref(held.space))}.step(step_s)",
            felt=[*_impulses(plan, body), *joint_forces],
            drive=[*_drive(plan, joints, body), *_drag(plan, body)],
            lead=1,
            before=["before = momentum()"] if plan.sensed_joints else [],
        )


def _name_all(scene: Traced, held: Any) -> None:
    scene.name(held.space, "space")
    for name, body in held.bodies.items():
        scene.name(body, name)
        for shape in held.shapes[name]:
            scene.name(shape, f"{name}_shape")
    for name, constraints in held.constraints.items():
        for constraint in constraints:
            kind = type(constraint).__name__.removesuffix("Joint").lower()
            scene.name(constraint, f"{name}_{kind}")


def _read(plan: Plan, joints: Mapping[str, Any], body: dict[str, str]) -> Reading:
    """Angles of pymunk are about -y, as its y is z of the world."""
    moving = Group(
        ("body",),
        {name: (body[name],) for name in plan.scenario.moving_bodies()},
        [
            "(x, 0, z)", "(np.cos(half), 0, np.sin(half), 0)", "(vx, 0, vz)",
            "(0, -body.angular_velocity, 0)",
        ],
        ["(x, z), (vx, vz), half = body.position, body.velocity, -body.angle / 2"],
    )  # fmt: skip
    groups = []
    for name in plan.scenario.movable_joints():
        joint = joints[name]
        pair = body[joint.parent], body[joint.child]
        seen = (
            [_angle(joint, *pair), _rate(joint, *pair)]
            if not isinstance(joint, PlanarSlider)
            else [f"*{_slide_of(joint, *pair)})[:2]"]
        )
        groups.append(Group((), {name: ()}, seen))
    return reading([moving], groups)


def _slide_of(joint: Any, parent: str, child: str) -> str:
    """The call that tells a slider's motion, without its closing bracket."""
    return f"slide({parent}, {child}, {number(joint.heading)}, {number(joint.start)}"


def _angle(joint: Any, parent: str, child: str) -> str:
    turned = f" - {number(joint.turned)}" if joint.turned else ""
    away = f"{child}.angle - {parent}.angle{turned}"
    return away if joint.sign > 0 else f"-({away})"


def _rate(joint: Any, parent: str, child: str) -> str:
    away = f"{child}.angular_velocity - {parent}.angular_velocity"
    return away if joint.sign > 0 else f"-({away})"


def _drive(plan: Plan, joints: Mapping[str, Any], body: dict[str, str]) -> list[str]:
    """Efforts of the next step: motions are read before any of them is given."""
    read, push = [], []
    fixed = all(j.is_fixed for j in joints.values() if isinstance(j, PlanarSlider))
    for effort in plan.efforts:
        joint, name = joints[effort.joint], effort.joint
        parent, child = body[joint.parent], body[joint.child]
        many = len(plan.efforts) > 1
        kind = "force" if isinstance(joint, PlanarSlider) else "torque"
        given = f"{kind}{f'_{name}' if many else ''}"
        if isinstance(joint, PlanarSlider):
            axis = f"axis_{name}" if many else "axis"
            moved = "q, v" if joint.senses else "*_"
            ahead = ", step_s" if not fixed else ""
            read.append(f"{moved}, {axis} = {_slide_of(joint, parent, child)}{ahead})")
            read.append(f"{given} = {effort.text('q', 'v')}")
            push.append(f"{child}.force += ({given} * {axis}[0], {given} * {axis}[1])")
            if not joint.is_fixed:
                push.append(f"{parent}.force -= ({given} * {axis}[0], {given} * {axis}[1])")
                if joint.beside:
                    push.append(f"{parent}.torque += {given} * {number(joint.beside)}")
            continue
        if joint.senses:
            read.append(f"q, v = {_angle(joint, parent, child)}, {_rate(joint, parent, child)}")
        read.append(f"{given} = {effort.text('q', 'v')}")
        sign, other = ("+", "-") if joint.sign > 0 else ("-", "+")
        push.append(f"{child}.torque {sign}= {given}")
        if not joint.is_fixed:
            push.append(f"{parent}.torque {other}= {given}")
    return read + push


def _drag(plan: Plan, body: dict[str, str]) -> list[str]:
    lines = []
    for name, factor in plan.drags.items():
        lines += [
            f"drag = {number(factor)} * {body[name]}.velocity.length",
            f"{body[name]}.apply_force_at_world_point("
            f"-drag * {body[name]}.velocity, {body[name]}.position)",
        ]
    return lines


def _impulses(plan: Plan, body: dict[str, str]) -> list[str]:
    """Source of the normal forces between bodies."""
    lines = []
    for first, second in plan.sensed_pairs.values():
        if plan.scenario.bodies[first].fixed:
            first, second = second, first
        lines.append(f"normal_force({body[first]}, {body[second]})")
    return lines


_NORMAL = (
    "def normal_force(first, second):",
    '    """Sum over the contacts between two bodies in the last step."""',
    "    found = []",
    "    first.each_arbiter(lambda a: found.append((a.bodies, a.total_impulse.dot(a.normal))))",
    "    return sum(abs(impulse) for bodies, impulse in found if second in bodies) / step_s",
)


def _carried(plan: Plan) -> dict[str, list[str]]:
    """Joints whose force is sensed -> bodies that hang on it."""
    scenario = plan.scenario
    return {name: carried_by(scenario, joint) for name, joint in plan.sensed_joints.items()}


def _momentum(plan: Plan, body: dict[str, str]) -> list[str]:
    """Functions that tell the force through a joint from what hangs on it."""
    carried = _carried(plan)
    if not carried:
        return []
    gx, _, gz = plan.scenario.world.gravity_m_s2
    touching = any(plan.scenario.bodies[b].shapes for names in carried.values() for b in names)
    inside = ", ".join(f"({', '.join(body[n] for n in names)},)" for names in carried.values())
    lines = [
        f"carried = ({inside},)  # what hangs on each joint whose force is sensed",
        "",
        "",
        "def momentum():",
        "    return [[sum(b.mass * b.velocity[i] for b in c) for i in (0, 1)] for c in carried]",
        "",
        "",
        "def joint_force(group, before, after):",
        '    """What changed the momentum of a group, less weight'
        + (' and contacts."""' if touching else '."""'),
        "    fx, fz = ((b - a) / step_s for a, b in zip(before, after))",
        "    for body in group:",
        f"        fx, fz = fx - body.mass * {number(gx)}, fz - body.mass * {number(gz)}"
        if gx
        else f"        fz -= body.mass * {number(gz)}",
    ]
    if touching:
        lines += [
            "        pushes = []",
            "        body.each_arbiter(lambda a: pushes.append(a.total_impulse))",
            "        fx -= sum(x for x, _ in pushes) / step_s",
            "        fz -= sum(z for _, z in pushes) / step_s",
        ]
    return [
        *lines,
        "    c, s = np.cos(group[0].angle), np.sin(group[0].angle)",
        "    return c * fx + s * fz, 0, c * fz - s * fx",
        "",
        "",
    ]


SCRIPT = PymunkScript()
