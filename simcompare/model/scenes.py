"""Small scenes in code, written as in a scenario's file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from simcompare.model.scenario import Scenario

#: standard gravity [m/s²]
G_M_S2 = 9.80665
#: a body, a joint, an input, … as it stands in a scenario's file, and several by name
Part = dict[str, Any]
Parts = Mapping[str, Any]


def scene(
    name: str,
    bodies: Parts,
    duration_s: float,
    step_s: float,
    gravity_m_s2: tuple[float, float, float] = (0.0, 0.0, -G_M_S2),
    **parts: Any,  # noqa: ANN401
) -> Scenario:
    """A scene of bodies, and of joints and so on by their names in the file."""
    world = {"gravity_m_s2": gravity_m_s2, "duration_s": duration_s, "step_s": step_s}
    title = name.replace("_", " ").capitalize()
    head = {"name": name, "title": title, "question": "What does an engine make of it?"}
    return Scenario.model_validate({**head, "world": world, "bodies": bodies, **parts})


def joint(kind: str, child: str, axis: tuple[float, float, float], **more: Any) -> Part:  # noqa: ANN401
    """A hinge or a slider; on the body ``frame`` if no other parent is named."""
    return {"type": kind, "parent": "frame", "child": child, "axis": axis, **more}


def pushed(joint: str, value: float, kind: str = "torque", **more: Any) -> Part:  # noqa: ANN401
    """A motor that pushes a joint steadily: the parts of a scene for it."""
    return {
        "inputs": {"push": {"signal": "constant", "value": value}},
        "actuators": {"motor": {"type": kind, "joint": joint, "input": "push", **more}},
    }
