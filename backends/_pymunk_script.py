"""A scene in pymunk as a standalone script."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from simcompare.backend import EngineBackend
from simcompare.backends._pymunk_forces import _carried_by
from simcompare.backends._pymunk_joints import Slider
from simcompare.scripts.contract import Parts, Plan, Traced, joint_parts, now_of_one, traced
from simcompare.scripts.source import Style
from simcompare.scripts.text import number
from simcompare.scripts.trace import Dialect

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
        held = scene.simulation._scene
        _name_all(scene, held)
        taken = {"pymunk", "slide", "impulse", "half", "x", "z"}
        wanted = [held.space, *held.bodies.values()]
        writer = scene.writer(Style(tidy=_tidy), wanted, taken)
        lines = writer.lines()
        body = {name: writer.text(scene.ref(one)) for name, one in held.bodies.items()}
        sliders = [j for j in held.joints.values() if isinstance(j, Slider)]
        return Parts(
            imports=["import pymunk"],
            helpers=_SLIDE if sliders else (),
            scene=lines,
            now=_now(plan, held, body),
            step=f"{writer.text(scene.ref(held.space))}.step(step_s)",
            forces=_forces(plan, body),
            drive=[*_drive(plan, held, body), *_drag(plan, body)],
            lead=1,
            before=["before = momentum()"] if plan.sensed_joints else [],
        )


def _name_all(scene: Traced, held: Any) -> None:
    scene.name(held.space, "space")
    for name, body in held.bodies.items():
        scene.name(body, name)
        for shape in held.shapes[name]:
            scene.name(shape, f"{name}_shape")
    for name, joint in held.joints.items():
        for constraint in joint.constraints:
            kind = type(constraint).__name__.removesuffix("Joint").lower()
            scene.name(constraint, f"{name}_{kind}")


def _now(plan: Plan, held: Any, body: dict[str, str]) -> list[str]:
    note = "Motion of all bodies; y of pymunk is z of the world, and its angles are about -y."
    sliders = any(isinstance(joint, Slider) for joint in held.joints.values())
    if len(plan.scenario.moving_bodies()) == 1 and not sliders:
        (name,) = plan.scenario.moving_bodies()
        one = body[name]
        seen = [
            "(x, 0, z)", "(np.cos(half), 0, np.sin(half), 0)", "(vx, 0, vz)",
            f"(0, -{one}.angular_velocity, 0)",
        ]  # fmt: skip
        for joint_name in joint_parts(plan):
            joint = held.joints[joint_name]
            pair = body[joint.joint.parent], body[joint.joint.child]
            seen += [_angle(joint, *pair), _rate(joint, *pair)]
        read = f"(x, z), (vx, vz), half = {one}.position, {one}.velocity, -{one}.angle / 2"
        return now_of_one(plan, note.replace("all bodies", "the body"), [read], seen)
    moving = ", ".join(f'"{name}": {body[name]}' for name in plan.scenario.moving_bodies())
    lines = [
        f"bodies = {{{moving}}}",
        "",
        "",
        "def now():",
        f'    """{note}"""',
        "    seen = {}",
        "    for name, body in bodies.items():",
        "        (x, z), (vx, vz), half = body.position, body.velocity, -body.angle / 2",
        '        seen[f"{name}.position_m"] = x, 0, z',
        '        seen[f"{name}.orientation_wxyz"] = np.cos(half), 0, np.sin(half), 0',
        '        seen[f"{name}.velocity_m_s"] = vx, 0, vz',
        '        seen[f"{name}.rate_rad_s"] = 0, -body.angular_velocity, 0',
    ]
    for name, (place, rate) in joint_parts(plan).items():
        joint = held.joints[name]
        parent, child = body[joint.joint.parent], body[joint.joint.child]
        if isinstance(joint, Slider):
            lines.append(
                f'    seen["{place}"], seen["{rate}"], _ = {_slide_of(joint, parent, child)})'
            )
        else:
            lines += [
                f'    seen["{place}"] = {_angle(joint, parent, child)}',
                f'    seen["{rate}"] = {_rate(joint, parent, child)}',
            ]
    return [*lines, "    return seen"]


def _slide_of(joint: Any, parent: str, child: str) -> str:
    """The call that tells a slider's motion, without its closing bracket."""
    return f"slide({parent}, {child}, {number(joint._heading)}, {number(joint._start)}"


def _angle(joint: Any, parent: str, child: str) -> str:
    turned = f" - {number(joint.turned)}" if joint.turned else ""
    away = f"{child}.angle - {parent}.angle{turned}"
    return away if joint.sign > 0 else f"-({away})"


def _rate(joint: Any, parent: str, child: str) -> str:
    away = f"{child}.angular_velocity - {parent}.angular_velocity"
    return away if joint.sign > 0 else f"-({away})"


def _drive(plan: Plan, held: Any, body: dict[str, str]) -> list[str]:
    """Efforts of the next step: motions are read before any of them is given."""
    read, push = [], []
    for effort in plan.efforts:
        joint, name = held.joints[effort.joint], effort.joint
        parent, child = body[joint.joint.parent], body[joint.joint.child]
        many = len(plan.efforts) > 1
        given = f"{'force' if isinstance(joint, Slider) else 'torque'}{f'_{name}' if many else ''}"
        if isinstance(joint, Slider):
            axis = f"axis_{name}" if many else "axis"
            moved = "q, v" if joint.senses else "*_"
            read.append(f"{moved}, {axis} = {_slide_of(joint, parent, child)}, step_s)")
            read.append(f"{given} = {effort.text('q', 'v')}")
            push.append(f"{child}.force += ({given} * {axis}[0], {given} * {axis}[1])")
            if not joint.fixed_parent:
                push.append(f"{parent}.force -= ({given} * {axis}[0], {given} * {axis}[1])")
                if joint._beside:
                    push.append(f"{parent}.torque += {given} * {number(joint._beside)}")
            continue
        if joint.senses:
            read.append(f"q, v = {_angle(joint, parent, child)}, {_rate(joint, parent, child)}")
        read.append(f"{given} = {effort.text('q', 'v')}")
        sign, other = ("+", "-") if joint.sign > 0 else ("-", "+")
        push.append(f"{child}.torque {sign}= {given}")
        if not joint.fixed_parent:
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


def _forces(plan: Plan, body: dict[str, str]) -> Sequence[str]:
    if not plan.force_sensors:
        return []
    lines = []
    scenario = plan.scenario
    carried = {
        name: _carried_by(scenario, scenario.joints[joint].child)
        for name, joint in plan.sensed_joints.items()
    }
    gx, _, gz = scenario.world.gravity_m_s2
    touching = any(scenario.bodies[one].shapes for names in carried.values() for one in names)
    if carried:
        lines += [
            "carried = {"
            + ", ".join(
                f'"{name}": [{", ".join(body[one] for one in names)}]'
                for name, names in carried.items()
            )
            + "}",
            "",
            "",
            "def momentum():",
            '    """Momentum of all that hangs on each sensed joint."""',
            "    return {n: [sum(b.mass * b.velocity[i] for b in c) for i in (0, 1)]"
            " for n, c in carried.items()}",
        ]
    lines += ["", "", "def forces():"]
    if carried:
        lines += [
            '    """Force through a joint: what changed the momentum, less weight'
            + (' and contacts."""' if touching else '."""'),
        ]
    else:
        lines += ['    """Normal force between bodies in the last step."""']
    lines += ["    seen = {}"]
    for name, pair in plan.sensed_pairs.items():
        first, second = pair
        if scenario.bodies[first].fixed:
            first, second = second, first
        lines += [
            "    impulses = []",
            f"    {body[first]}.each_arbiter(lambda a: impulses.append("
            f"abs(a.total_impulse.dot(a.normal)) if {body[second]} in a.bodies else 0))",
            f'    seen["{name}.normal_force_N"] = sum(impulses) / step_s',
        ]
    if carried:
        lines += [
            "    after = momentum()",
            "    for name, group in carried.items():",
            "        fx, fz = ((b - a) / step_s for a, b in zip(before[name], after[name]))",
            "        for body in group:",
            f"            fx, fz = fx - body.mass * {number(gx)}, fz - body.mass * {number(gz)}"
            if gx
            else f"            fz -= body.mass * {number(gz)}",
        ]
        if touching:
            lines += [
                "            pushes = []",
                "            body.each_arbiter(lambda a: pushes.append(a.total_impulse))",
                "            fx -= sum(x for x, _ in pushes) / step_s",
                "            fz -= sum(z for _, z in pushes) / step_s",
            ]
        lines += [
            "        c, s = np.cos(group[0].angle), np.sin(group[0].angle)",
            '        seen[f"{name}.force_N"] = c * fx + s * fz, 0, c * fz - s * fx',
        ]
    return [*lines, "    return seen"]


SCRIPT = PymunkScript()
