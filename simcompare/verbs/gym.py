"""A scenario with a task as an environment of Gymnasium."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from pathlib import Path

from simcompare import units
from simcompare.arguments import checked
from simcompare.errors import EngineMissing, UnknownName
from simcompare.model.settings import ASSISTED, CONTACT_LEVELS
from simcompare.scenarios import catalogue, robot_values

try:
    from simcompare.learning.environment import Asked, Environment
except ModuleNotFoundError as error:
    raise EngineMissing(
        "an environment", error.name or "gymnasium", "pip install 'simcompare[gym]'"
    ) from None


@checked
def gym(
    scenario: str,
    *,
    engine: str,
    sensors: float = 1.0,
    contact: str = ASSISTED,
    control_Hz: float | None = None,
    step: str | float | None = None,
    set: Mapping[str, str | float] | None = None,
    robot: str | Path | None = None,
) -> Environment:
    """Opens a scenario with a task as an environment in which something can be learnt.

    ::

        environment = simcompare.gym("robot_avoid", engine="mujoco")
        seen, told = environment.reset(seed=1)
        seen, reward, terminated, truncated, told = environment.step([0.5, 0.4])

    Args:
        scenario: name of a scenario with a task.
        engine: name of the engine.
        sensors: how large the errors of its sensors are: 0 for ideal ones, 1 as in their data
            sheets, 2 twice as large.
        contact: contact level.
        control_Hz: actions in a second; the task's own by default.
        step: the engine's step, "2ms" or in seconds; the scenario's own by default.
        set: parameters that are the same in all episodes; text may carry a unit.
        robot: file of a robot (``simcompare robot --template``), applied before ``set``; also the
            same in all episodes. What the scenario does not take of it is a warning.

    Returns:
        The environment, a ``gymnasium.Env``.

    Raises:
        InputError: numbers that make no sense; all of them are named.
        UnknownName: there is no such scenario with a task, engine, level or parameter.
        EngineMissing: Gymnasium or the engine is not installed.
        Unsupported: the engine lacks what the scenario needs.
    """
    if contact not in CONTACT_LEVELS:
        raise UnknownName("contact level", contact, CONTACT_LEVELS)
    taken = robot_values.taken(catalogue.load(scenario), robot)
    for caution in taken.left_out:
        warnings.warn(caution, stacklevel=3)  # whoever calls this, past the check of arguments
    given = {**taken.values, **taken.file.read_settings(set or {})}
    step_s = None if step is None else units.to_si(step, "s", "step")
    return Environment(Asked(scenario, engine, contact, sensors, control_Hz, given, step_s))
