"""A scene in MuJoCo as a standalone script around the MJCF that the adapter compiles."""

from __future__ import annotations

import re
from typing import Any
from xml.etree import ElementTree as ET

from simcompare.backend import EngineBackend
from simcompare.backends._mujoco_scene import contact_points
from simcompare.errors import Unsupported
from simcompare.scripts.contract import Parts, Plan, joint_parts, now_of_one
from simcompare.scripts.text import names_of, number

#: attributes that are left out where they have MuJoCo's own default
_DEFAULTS = {
    "pos": "0 0 0", "quat": "1 0 0 0", "stiffness": "0", "springref": "0", "damping": "0",
    "frictionloss": "0", "armature": "0",
}  # fmt: skip
_NUMBER = re.compile(r"[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?")


class MujocoScript:
    """Writes scripts that import mujoco."""

    def parts(self, backend: EngineBackend, plan: Plan) -> Parts:
        engine = backend.load()
        watched = _Compiler(engine)
        simulation: Any = backend.build(watched, plan.scenario, plan.settings)  # type: ignore[arg-type]
        text = watched.text
        shifted = text
        if plan.shifted is not None:
            backend.build(watched, plan.shifted, plan.settings)  # type: ignore[arg-type]
            shifted = watched.text
        return Parts(
            imports=["import mujoco"],
            scene=[*_model(text, shifted), *_start(simulation)],
            now=_now(plan),
            step="mujoco.mj_step(model, data)",
            forces=_forces(plan),
            drive=[*_drag(plan), *_drive(plan)],
        )


class _Compiler:
    """Stands in for the module ``mujoco`` and keeps the text of the scene's model."""

    def __init__(self, engine: Any) -> None:
        self._engine, self._texts = engine, list[str]()
        self.MjModel = self

    def __getattr__(self, name: str) -> Any:
        return getattr(self._engine, name)

    def from_xml_string(self, text: str) -> Any:
        """Compiles a text and keeps it."""
        self._texts.append(text)
        return self._engine.MjModel.from_xml_string(text)

    @property
    def text(self) -> str:
        """The scene's text: the first that was compiled since this was last asked for."""
        found, self._texts = self._texts[0], []
        return found


def _model(text: str, shifted: str) -> list[str]:
    first, last = _laid_out(text), _laid_out(shifted)
    if len(first) != len(last):
        raise Unsupported("the scene has other parts at the other end of the phase")
    lines = [_merged(a, b) for a, b in zip(first, last, strict=True)]
    mark = "f" if first != last else ""
    return [
        f'model = mujoco.MjModel.from_xml_string({mark}"""',
        *lines,
        '""")',
        "data = mujoco.MjData(model)",
    ]


def _merged(first: str, last: str) -> str:
    """A line of MJCF whose numbers follow the phase where they differ."""
    if first == last:
        return first
    others = iter(_NUMBER.findall(last))

    def replace(match: re.Match[str]) -> str:
        a, b = match.group(), next(others)
        if a == b:
            return a
        return f"{{{a} + phase * {number(float(b) - float(a))}!r}}"

    return _NUMBER.sub(replace, first)


def _laid_out(text: str) -> list[str]:
    """The text in lines, without what is MuJoCo's default anyway."""
    root = ET.fromstring(text)
    for child in list(root):
        if child.tag in ("contact", "actuator", "sensor") and not len(child):
            root.remove(child)
    for element in root.iter():
        for key, value in list(element.attrib.items()):
            short = _NUMBER.sub(lambda m: _short(m.group()), value) if _numeric(value) else value
            element.set(key, short)
            if _DEFAULTS.get(key) == short and element.tag != "inertial":
                del element.attrib[key]
    ET.indent(root)
    return ET.tostring(root, encoding="unicode").split("\n")


def _numeric(value: str) -> bool:
    return all(_NUMBER.fullmatch(word) for word in value.split())


def _short(text: str) -> str:
    return number(float(text)) if re.search(r"[.eE]", text) else text


def _start(simulation: Any) -> list[str]:
    speeds = simulation._data.qvel.tolist()
    if not any(speeds):
        return []
    return [f"data.qvel[:] = [{', '.join(number(value) for value in speeds)}]"]


def _now(plan: Plan) -> list[str]:
    free = list(plan.scenario.free_bodies())
    linked = [name for name in plan.scenario.moving_bodies() if name not in free]
    if [*free, *linked] == free[:1]:
        (name,) = free
        reads = [
            f'q, v, rate = data.joint("{name}").qpos, data.joint("{name}").qvel, np.zeros(3)',
            "mujoco.mju_rotVecQuat(rate, v[3:], q[3:])  # it is stored in the body's frame",
        ]
        seen = ["q[:3].copy()", "q[3:].copy()", "v[:3].copy()", "rate"]
        return now_of_one(plan, "Motion of the body.", reads, seen)
    if len(linked) == 1 and not free:
        reads = [
            "for update in (mujoco.mj_kinematics, mujoco.mj_comPos, mujoco.mj_comVel):",
            "    update(model, data)",
            f'body, kind, speed = data.body("{linked[0]}"), mujoco.mjtObj.mjOBJ_XBODY, np.zeros(6)',
            "mujoco.mj_objectVelocity(model, data, kind, body.id, speed, 0)",
        ]
        seen = ["body.xpos.copy()", "body.xquat.copy()", "speed[3:]", "speed[:3]"]
        for name in joint_parts(plan):
            seen += [f'data.joint("{name}").qpos[0]', f'data.joint("{name}").qvel[0]']
        return now_of_one(plan, "Motion of the body.", reads, seen)
    lines = ["", "", "def now():", '    """Motion of all bodies and joints."""', "    seen = {}"]
    if linked:  # what follows from the joints' coordinates
        lines += [
            "    for update in (mujoco.mj_kinematics, mujoco.mj_comPos, mujoco.mj_comVel):",
            "        update(model, data)",
            f"    for name in {names_of([*free, *linked])}:",
            "        body, kind, speed = data.body(name), mujoco.mjtObj.mjOBJ_XBODY, np.zeros(6)",
            "        mujoco.mj_objectVelocity(model, data, kind, body.id, speed, 0)",
            '        seen[f"{name}.position_m"] = body.xpos.copy()',
            '        seen[f"{name}.orientation_wxyz"] = body.xquat.copy()',
            '        seen[f"{name}.velocity_m_s"] = speed[3:]',
            '        seen[f"{name}.rate_rad_s"] = speed[:3]',
        ]
    else:
        lines += [
            f"    for name in {names_of(free)}:",
            "        q, v, rate = data.joint(name).qpos, data.joint(name).qvel, np.zeros(3)",
            "        mujoco.mju_rotVecQuat(rate, v[3:], q[3:])  # it is stored in the body's frame",
            '        seen[f"{name}.position_m"] = q[:3].copy()',
            '        seen[f"{name}.orientation_wxyz"] = q[3:].copy()',
            '        seen[f"{name}.velocity_m_s"] = v[:3].copy()',
            '        seen[f"{name}.rate_rad_s"] = rate',
        ]
    for name, (place, rate) in joint_parts(plan).items():
        joint = f'data.joint("{name}")'
        lines.append(f'    seen["{place}"], seen["{rate}"] = {joint}.qpos[0], {joint}.qvel[0]')
    return [*lines, "    return seen"]


def _drive(plan: Plan) -> list[str]:
    """What follows the inputs; springs and dampers are MuJoCo's own."""
    given = [effort.given or "0" for effort in plan.efforts]
    if not given or set(given) == {"0"}:
        return []
    return [f"data.ctrl[:] = {', '.join(given)}"]


def _drag(plan: Plan) -> list[str]:
    lines = []
    for name, factor in plan.drags.items():
        lines += [
            f'v = data.joint("{name}").qvel[:3]',
            "speed = np.sqrt(v[0] ** 2 + v[1] ** 2 + v[2] ** 2)",
            f'data.body("{name}").xfrc_applied[:3] = -{number(factor)} * speed * v',
        ]
    return lines


def _forces(plan: Plan) -> list[str]:
    if not plan.force_sensors:
        return []
    lines = ["", "", "def forces():", '    """What the force sensors read in the last step."""']
    lines.append("    seen = {}")
    for name, sensor in plan.force_sensors.items():
        read = f'data.sensor("{name}").data'
        if sensor.type == "force":
            lines.append(f'    seen["{name}.force_N"] = {read}.copy()')
        else:  # three components of each point, the first along the normal
            assert contact_points(plan.scenario, sensor)
            lines.append(f'    seen["{name}.normal_force_N"] = {read}[::3].sum()')
    return [*lines, "    return seen"]


SCRIPT = MujocoScript()
