"""What a scenario looks like, before any engine runs it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from simcompare.comparison.repeats import truths_of
from simcompare.errors import InputError
from simcompare.model.drawing import POSITION, DrawnBody, drawn
from simcompare.model.scenario import Scenario
from simcompare.model.trajectory import Array, Trajectory
from simcompare.reports.render.replays import Replay
from simcompare.reports.render.staging import Source, staged
from simcompare.scenarios import trust
from simcompare.scenarios.scenario_file import ScenarioFile

#: of no engine and of no truth
_COLOUR = "#4477AA"


def scene_of(file: ScenarioFile) -> Replay | None:
    """The scene as the truth moves it, where one of ours tells of all bodies; else as it starts.

    ``None`` where nothing of it can be seen.
    """
    scenario = file.resolve()
    scene = drawn(scenario)
    trajectory = _true(file, scenario, scene) or _at_rest(scenario, scene)
    return staged(scene, [Source("", _COLOUR, "", trajectory)], "")


def _true(
    file: ScenarioFile, scenario: Scenario, scene: Mapping[str, DrawnBody]
) -> Trajectory | None:
    if not trust.is_ours(file.path):  # to look at a scenario runs no code that came with it
        return None
    try:
        (found,) = truths_of(file.path, [scenario])
    except InputError:  # it refuses the parameters
        return None
    moving = [name for name, body in scene.items() if not body.fixed]
    told = found is not None and all(f"{name}.{POSITION}" in found.signals for name in moving)
    return found if told else None


def _at_rest(scenario: Scenario, scene: Mapping[str, DrawnBody]) -> Trajectory:
    """All bodies where they start."""
    signals: dict[str, Array] = {
        f"{name}.{POSITION}": np.tile(body.position_m, (2, 1)) for name, body in scene.items()
    }
    return Trajectory("start", np.array([0.0, scenario.world.step_s]), signals)
