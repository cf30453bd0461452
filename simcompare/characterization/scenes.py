"""What the experiments are made of: a small scene in code, and running it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import TypeVar

from simcompare.engine.backend import Backend
from simcompare.errors import BackendError
from simcompare.model.scenario import Scenario
from simcompare.model.settings import Settings
from simcompare.model.trajectory import Trajectory

Row = TypeVar("Row")

#: standard gravity [m/s²]
G_M_S2 = 9.80665


def scene(
    name: str,
    bodies: Mapping[str, object],
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
    row: Callable[..., Row], steps_s: Sequence[float], look: Callable[[float], object]
) -> tuple[Row, ...]:
    """What an engine does at each step; where it refuses a step, the reason.

    Args:
        row: makes the record of a step.
        steps_s: the steps.
        look: tries it at a step; its record has the fields of ``row`` but ``step_s``.
    """
    found = []
    for step_s in steps_s:
        try:
            found.append(row(step_s=step_s, **vars(look(step_s))))
        except BackendError as error:
            found.append(row(step_s=step_s, reason=str(error)))
    return tuple(found)
