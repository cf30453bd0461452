"""Parameters of a scenario that follow from the file of a robot."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from simcompare.errors import InputError
from simcompare.hardware.robot import built, robot_file
from simcompare.scenarios.scenario_file import ScenarioFile, out_of_bounds


def of_file(file: ScenarioFile, robot: str | Path | None) -> Mapping[str, float]:
    """What a robot's file says of the parameters that a scenario has, SI; none without a file.

    Raises:
        InputError: no such file or no robot, a scenario without any of these parameters, or values
            that it does not take.
    """
    if robot is None:
        return {}
    known = built.parameters(robot_file.read(robot))
    values = {name: value for name, value in known.items() if name in file.parameters}
    if not values:
        raise InputError(
            f"--robot {robot}",
            [
                f"the scenario {file.name} has no parameter of a robot; it needs some of:"
                f" {', '.join(known)}"
            ],
        )
    faults = out_of_bounds(values, file.parameters)
    if faults:
        raise InputError(f"--robot {robot}, scenario {file.name}", list(faults.values()))
    return values
