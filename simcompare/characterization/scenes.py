"""What the experiments are made of: a small scene in code, and running it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

from simcompare.engine.backend import Backend
from simcompare.errors import BackendError
from simcompare.model.scenario import Scenario
from simcompare.model.settings import Settings
from simcompare.model.trajectory import Trajectory

#: standard gravity [m/s²]
G_M_S2 = 9.80665


def scene(
    name: str,
    bodies: Mapping[str, Any],
    duration_s: float,
    step_s: float,
    gravity: tuple[float, float, float],
    **parts: object,
) -> Scenario:
    """A scene of bodies, joints and so on, written as in a scenario's file."""
    count = max(2, math.ceil(duration_s / step_s - 1e-9))
    world = {"gravity_m_s2": gravity, "duration_s": count * step_s, "step_s": step_s}
    head = {"name": name, "title": name, "question": "What does an engine make of it?"}
    return Scenario.model_validate({**head, "world": world, "bodies": bodies, **parts})


def run(backend: Backend, scenario: Scenario, level: str) -> Trajectory:
    """What an engine makes of a scene at a contact level."""
    return backend.simulate(scenario, Settings(level))


def over_steps(
    steps_s: tuple[float, ...], look: Callable[[float], dict[str, Any]]
) -> list[dict[str, Any]]:
    """What is found at each step; where the engine refuses a step, the reason."""
    found = []
    for step_s in steps_s:
        try:
            found.append({"step_s": step_s, "reason": "", **look(step_s)})
        except BackendError as error:
            found.append({"step_s": step_s, "reason": str(error)})
    return found
