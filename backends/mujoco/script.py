"""A scene in MuJoCo as a standalone script around the MJCF that the adapter compiles."""

from __future__ import annotations

from typing import Any

from simcompare.backends.mujoco.mjcf import mjcf
from simcompare.backends.mujoco.script_layout import laid_out
from simcompare.engine.backend import EngineBackend
from simcompare.engine.scripting.contract import Parts, Plan
from simcompare.engine.scripting.reading import Group, Reading, reading
from simcompare.engine.scripting.text import number


class MujocoScript:
    """Writes scripts that import mujoco."""

    def parts(self, backend: EngineBackend, plan: Plan) -> Parts:
        engine = backend.load()
        simulation: Any = backend.build(engine, plan.scenario, plan.settings)
        text = shifted = mjcf(simulation.scene)
        if plan.shifted is not None:
            shifted = mjcf(backend.scene(plan.shifted, plan.settings))
        return Parts(
            imports=["import mujoco"],
            scene=[*_model(laid_out(engine, text, shifted)), *_start(simulation)],
            reading=_read(plan),
            step="mujoco.mj_step(model, data)",
            felt=_felt(plan),
            drive=[*_drag(plan), *_drive(plan)],
        )


def _model(lines: list[str]) -> list[str]:
    mark = "f" if any("phase" in line for line in lines) else ""
    first, *rest = lines
    return [
        f'model = mujoco.MjModel.from_xml_string({mark}"""{first}',
        *rest[:-1],
        f'{rest[-1]}""")',
        "data = mujoco.MjData(model)",
    ]


def _start(simulation: Any) -> list[str]:
    speeds = simulation.data.qvel.tolist()
    if not any(speeds):
        return []
    return [f"data.qvel[:] = [{', '.join(number(value) for value in speeds)}]"]


def _read(plan: Plan) -> Reading:
    """Free bodies alone by their coordinates; where some hang on others, by what follows."""
    free = list(plan.scenario.free_bodies())
    linked = [name for name in plan.scenario.moving_bodies() if name not in free]
    joints = Group(
        ("name",),
        {name: (f'"{name}"',) for name in plan.scenario.movable_joints()},
        ["*data.joint(name).qpos", "*data.joint(name).qvel"],
    )
    if not linked:
        alone = Group(
            ("name",),
            {name: (f'"{name}"',) for name in free},
            ["q[:3]", "q[3:]", "v[:3]", "rate"],
            [
                "q, v = data.joint(name).qpos.copy(), data.joint(name).qvel.copy()",
                "rate = np.zeros(3)",
                "mujoco.mju_rotVecQuat(rate, v[3:], q[3:])  # v[3:] is in the body's frame",
            ],
        )
        return reading([alone], [joints])
    bodies = Group(
        ("name",),
        {name: (f'"{name}"',) for name in (*free, *linked)},
        ["body.xpos.copy()", "body.xquat.copy()", "v[3:]", "v[:3]"],
        [
            "body, v = data.body(name), np.zeros(6)",
            "mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_XBODY, body.id, v, 0)",
        ],
    )
    update = [
        "for update in (mujoco.mj_kinematics, mujoco.mj_comPos, mujoco.mj_comVel):",
        "    update(model, data)",
    ]
    return reading([bodies], [joints], update)


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


def _felt(plan: Plan) -> list[str]:
    # three components of each point, the first along the normal
    normals = [f'data.sensor("{name}").data[::3].sum()' for name in plan.sensed_pairs]
    return [*normals, *(f'data.sensor("{name}").data.copy()' for name in plan.sensed_joints)]


SCRIPT = MujocoScript()
