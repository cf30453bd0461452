"""What drives the joints of a script: a few numbers, or tables in the file of inputs."""

from __future__ import annotations

import numpy as np

from simcompare.engine.drives import Drive
from simcompare.engine.scripting.contract import Effort
from simcompare.engine.scripting.text import number
from simcompare.model.scenario import Scenario
from simcompare.model.trajectory import Array

#: most pieces of constant input that are written as such; others go to the file of inputs
MAX_PIECES = 3


def efforts_of(scenario: Scenario) -> tuple[list[Effort], dict[str, Array]]:
    """Efforts on all driven joints, and the tables of those that change often."""
    world = scenario.world
    drive = Drive(scenario, world.engine_step_s, 0, exact=False)
    steps = round(world.duration_s / world.step_s) * world.substeps
    # one more: where forces act at the start of a step, one step follows the last sample
    table = drive.rows(steps + 1) if drive.names else np.zeros((0, 0))
    efforts, inputs = [], {}
    for j, (name, law) in enumerate(drive.laws.items()):
        given = ""
        if law.gains:
            given = pieces_of(table[:, j])
            if not given:
                inputs[name] = table[:, j]
                given = f"given_{name}[k]"
        efforts.append(Effort(name, law, given))
    return efforts, inputs


def pieces_of(values: Array) -> str:
    """A column that is constant in a few pieces, as an expression; else nothing."""
    edges = (np.flatnonzero(np.diff(values)) + 1).tolist()
    if len(edges) >= MAX_PIECES:
        return ""
    text = number(float(values[-1]))
    for edge in reversed(edges):
        text = f"{number(float(values[edge - 1]))} if k < {edge} else {text}"
    return f"({text})" if edges else text
